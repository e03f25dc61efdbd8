//! The interaction of a ray with a surface.

use super::shading;
use crate::material::{Incoming, Lobes, Material, Scatter, ScatterContext};
use crate::math::{DVec3, Ray};
use crate::scene::{Hit, MaterialId};
use crate::shape::SurfacePoint;
use crate::spectrum::{Draw, Lanes, Table};
use crate::trace::media::Boundary;
use crate::trace::{World, media};

/// Where a ray first hits a surface.
pub struct SurfaceHit {
    pub hit: Hit,
    pub point: SurfacePoint,
}

impl SurfaceHit {
    #[inline(always)]
    pub fn new(world: &World, ray: &Ray, hit: Hit) -> Self {
        Self { hit, point: world.scene.objects[hit.object as usize].point(ray, &hit.intersection) }
    }
}

/// A ray that arrives at a surface.
pub struct IncidentRay<'a, const N: usize> {
    pub ray: &'a Ray,
    pub present: Lanes<N>,
    /// Whether lanes have parted on the way.
    pub parted: bool,
}

/// Where a path hits a surface, and everything the surface's response depends on: for camera paths, photons and probes.
pub struct Interaction<'a, const N: usize> {
    pub object: u32,
    pub point: &'a SurfacePoint,
    pub material: &'a Material<Table>,
    pub lobes: Lobes,
    /// The geometric unit normal, of the triangle in a smooth mesh, on the side that the path comes from.
    pub flat: DVec3,
    /// The media on both sides.
    pub boundary: Boundary,
    pub context: ScatterContext<'a, N>,
    pub is_parting: bool,
}

impl<'a, const N: usize> Interaction<'a, N> {
    /// Returns the interaction of an arriving ray with the surface that it has hit, at a boundary of media.
    #[inline(always)]
    pub fn new(
        world: &'a World,
        draw: &'a Draw<N>,
        arriving: &IncidentRay<N>,
        surface_hit: &'a SurfaceHit,
        boundary: Boundary,
    ) -> Self {
        let SurfaceHit { hit, point } = surface_hit;
        let object = &world.scene.objects[hit.object as usize];
        let (wo, uv, number) = (-arriving.ray.direction, object.uv(&hit.intersection, point), object.material as usize);
        let (material, lobes) = (&world.scene.materials[number].material, world.lobes[number]);
        let [flat, normal] = shading::normals_for_lobes(lobes, point, wo);
        let (sides, present) = (boundary.sides(), arriving.present);
        let mut interaction = Self {
            object: hit.object,
            point,
            material,
            lobes,
            flat,
            boundary,
            context: context(world, draw, wo, normal, uv, present, sides),
            is_parting: false,
        };
        interaction.context.from_inside = point.normal.dot(wo) < 0.0;
        interaction.context.is_alone = arriving.parted && present.sum() == 1.0;
        interaction.is_parting = parts_lanes(lobes, material, &interaction.context);
        interaction
    }

    /// Returns the interaction with another normal by which the surface scatters.
    pub fn with_normal(self, normal: DVec3) -> Self {
        if normal == self.context.normal {
            return self;
        }
        let context = ScatterContext { normal, ..self.context };
        let is_parting = parts_lanes(self.lobes, self.material, &context);
        Self { context, is_parting, ..self }
    }

    /// Returns the surface as viewed from another direction, on either side. The media stay those of this interaction.
    pub fn viewed_from(&self, wo: DVec3) -> Self {
        let [flat, normal] = shading::normals_for_lobes(self.lobes, self.point, wo);
        let turned = ScatterContext { wo, normal, ..self.context };
        let context = if wo.dot(self.flat) > 0.0 { turned } else { turned.turned_around() };
        Self { flat, context, ..*self }
    }

    /// Returns a surface that has only some of its material's lobes.
    pub fn with_lobes(&self, lobes: Lobes) -> Self {
        Self { context: ScatterContext { lobes, ..self.context }, ..*self }
    }

    /// Returns the surface as the light that excites a dye sees it: white, in lanes that stand for what excites it.
    pub fn as_dye(&self, white: &'a Material<Table>, draw: &'a Draw<N>) -> Self {
        let context = ScatterContext { draw, present: draw.start(), ..self.context };
        Self { material: white, lobes: Lobes::DIFFUSE_REFLECTION, context, is_parting: false, ..*self }
    }

    /// Whether the surface scatters by another normal than its geometric one.
    #[inline(always)]
    pub fn is_smoothed(&self) -> bool {
        self.flat != self.context.normal
    }

    /// Returns the part of unpolarized light from a direction that leaves, by the normal by which the surface scatters.
    pub fn bsdf_value(&self, wi: DVec3) -> Lanes<N> {
        self.material.evaluate(&self.context, wi).map_or(Lanes::ZERO, |(light, _)| light)
    }

    /// Returns the direction that the material was evaluated for, if shading normals have folded it to `incoming`.
    #[inline(always)]
    pub fn unfolded(&self, incoming: Incoming) -> Option<Incoming> {
        let is_folded = self.is_smoothed() && (incoming.wi.dot(self.context.normal) < 0.0) != incoming.crosses;
        is_folded.then(|| Incoming { wi: shading::folded_direction(incoming.wi, self.flat), ..incoming })
    }

    /// Returns the direction that a shading normal folds to `incoming`, if the material also sends light there
    /// unfolded.
    #[inline(always)]
    pub fn folded_to(&self, incoming: Incoming) -> Option<Incoming> {
        if !self.is_smoothed() || incoming.single {
            return None;
        }
        let folded = shading::folded_direction(incoming.wi, self.flat);
        let is_on_side = |wi: DVec3| (wi.dot(self.context.normal) < 0.0) == incoming.crosses;
        (is_on_side(incoming.wi) && is_on_side(folded)).then_some(Incoming { wi: folded, ..incoming })
    }
}

/// Returns whether lanes part that cross a surface.
pub fn parts_lanes<const N: usize>(lobes: Lobes, material: &Material<Table>, context: &ScatterContext<N>) -> bool {
    lobes.is_transmissive() && material.parts_lanes(context)
}

/// Returns what the response of a surface depends on, between media on the viewer's side and beyond. `wo` points to the
/// viewer. `normal` is the one by which the surface scatters, on the viewer's side. `uv` is where it is hit.
#[inline(always)]
pub fn context<'a, const N: usize>(
    world: &'a World,
    draw: &'a Draw<N>,
    wo: DVec3,
    normal: DVec3,
    uv: [f64; 2],
    present: Lanes<N>,
    sides: [Option<MaterialId>; 2],
) -> ScatterContext<'a, N> {
    ScatterContext {
        wo,
        normal,
        uv,
        draw,
        waves: &world.waves,
        present,
        from_inside: false,
        is_alone: false,
        incident: media::index_around(&world.scene, sides[0]),
        beyond: media::index_around(&world.scene, sides[1]),
        direction_indices: media::direction_indices(&world.scene, sides),
        together: world.method.together,
        lobes: Lobes::ALL,
    }
}
