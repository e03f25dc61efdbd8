//! Light that passes through the holes of masks, and through panes that do not bend it.

use std::cell::Cell;

use super::interaction::{SurfaceHit, context};
use super::path::{ObjectSet, Path};
use super::polarization::{PassThrough, Polarization};
use super::polarized::Polarized;
use super::shading;
use crate::material::Scatter;
use crate::math::{Ray, Sampler};
use crate::scene::{MaterialId, RayEnds, Visibility};
use crate::spectrum::{Draw, Lanes};
use crate::trace::{Transport, World, media};

/// Use of the random numbers of a camera ray that hits a surface with holes.
const CUTOUT: u32 = 4;

/// Returns the part of a path's light that passes through a see-through surface; `None` if nothing does.
#[cold]
#[inline(never)]
pub fn pass_through_of_path<const N: usize, P: Polarization<N>>(
    world: &World,
    draw: &Draw<N>,
    path: &Path<N, P>,
    surface_hit: &SurfaceHit,
) -> Option<PassThrough<N, P>> {
    let present = path.throughput.present();
    let straight_ray = StraightRay { ray: &path.ray, surface_hit, present, inside: path.media.inside(&world.scene) };
    let pass_through = pass_through_of_ray(world, draw, &straight_ray, path.polarization)?;
    (!(pass_through.straight.share() * present).is_zero()).then_some(pass_through)
}

/// Returns the share of each lane that goes through the holes of a surface, which a ray inside a medium has hit.
pub fn hole_transmittance<const N: usize>(
    world: &World,
    draw: &Draw<N>,
    ray: &Ray,
    inside: Option<MaterialId>,
    surface_hit: &SurfaceHit,
) -> Lanes<N> {
    if !world.is_see_through(surface_hit.hit.object) {
        return Lanes::ZERO;
    }
    let straight_ray = StraightRay { ray, surface_hit, present: draw.start(), inside };
    pass_through_of_ray(world, draw, &straight_ray, Polarized::NONE)
        .map_or(Lanes::ZERO, |pass_through| pass_through.straight.holes)
}

/// Whether a camera ray hits a surface that may be cut out: it hits panes, but not holes.
pub struct Cutout {
    pub is_hit: bool,
    /// Probability of this outcome.
    pub chance: f64,
    /// The part of the path's weight that belongs to a path to what is hit. Beyond a surface, a path that goes through
    /// its holes goes through its panes as well.
    pub weight: f64,
}

/// Decides whether a camera ray counts as having hit a surface.
pub fn sample_cutout<const N: usize, P: Polarization<N>>(
    world: &World,
    draw: &Draw<N>,
    sampler: &Sampler,
    path: &Path<N, P>,
    pass_through: Option<&PassThrough<N, P>>,
) -> Cutout {
    let straight = pass_through.map(|pass_through| &pass_through.straight);
    let Some(straight) = straight.filter(|straight| !straight.holes.is_zero()) else {
        return Cutout { is_hit: true, chance: 1.0, weight: 1.0 };
    };
    let u = match world.method.transport {
        Transport::Deterministic { .. } => 0.5,
        Transport::Random { .. } => sampler.get_random_4d(path.key, CUTOUT)[0],
    };
    let shares = draw.shares(path.parted);
    let share_of = |part: Lanes<N>| path.throughput.through(part).weight(shares) / path.throughput.weight(shares);
    let holes = share_of(straight.holes);
    match holes <= u {
        true => Cutout { is_hit: true, chance: 1.0 - holes, weight: 1.0 - holes },
        false => Cutout { is_hit: false, chance: holes, weight: share_of(straight.share()) },
    }
}

/// The segment between a place and a light, which something may occlude.
pub struct VisibilityTest<'a> {
    /// The ray from the place toward the light.
    pub ray: &'a Ray,
    /// Distance to the light.
    pub distance: f64,
    pub ends: RayEnds,
    /// The medium around the ray.
    pub inside: Option<MaterialId>,
    /// The objects that may occlude it.
    pub occluders: Occluders,
    /// The object that last occluded a light.
    pub last_occluder: &'a Cell<Option<u32>>,
}

/// The objects that may occlude a segment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Occluders {
    /// Objects that exist for a path.
    Objects(ObjectSet),
    /// Objects that the camera sees, if the segment leads to it.
    Seen(SeenThrough),
}

/// What the camera sees a place through. Beyond a pane it sees holdouts and shadow catchers like everything else.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SeenThrough {
    All,
    /// Only holes.
    Holes,
    /// At least one pane.
    Panes,
}

impl Occluders {
    fn is_all(self, world: &World) -> bool {
        self == Self::Objects(ObjectSet::All) || !world.hides_objects
    }

    fn has(self, world: &World, object: u32) -> bool {
        match self {
            _ if !world.hides_objects => true,
            Self::Objects(ObjectSet::All) => true,
            Self::Objects(ObjectSet::Plate) => world.scene.is_of_plate(object),
            Self::Seen(_) => world.scene.is_seen(object),
        }
    }
}

impl VisibilityTest<'_> {
    /// Returns the light that arrives through holes, panes and the medium, and its polarization beyond them; `None` if
    /// something occludes it. `polarization`, of the path at the place, and `light` are only called if nothing does.
    #[inline]
    pub fn arriving_light<const N: usize, P: Polarization<N>>(
        &self,
        world: &World,
        draw: &Draw<N>,
        polarization: impl FnOnce() -> P,
        light: impl FnOnce() -> Lanes<N>,
    ) -> Option<(Lanes<N>, P)> {
        let Self { ray, distance, ends, inside, occluders, last_occluder } = *self;
        let (mut arriving, polarization_after);
        if !occluders.is_all(world) || world.has_see_through() {
            let is_opaque = |object| !world.is_see_through(object) && occluders.has(world, object);
            if world.scene.is_occluded_by(ray, distance, ends, last_occluder, &is_opaque) {
                return None;
            }
            let (share, polarization) = self.transmittance(world, draw, polarization())?;
            (arriving, polarization_after) = (light() * share, polarization);
        } else if world.scene.is_occluded(ray, distance, ends, last_occluder) {
            return None;
        } else {
            (arriving, polarization_after) = (light(), polarization());
        }
        if let Some(material) = inside {
            arriving = arriving * media::medium(&world.scene, material).transmission(draw, distance);
        }
        Some((arriving, polarization_after))
    }

    /// Returns the share of each lane that passes all surfaces before the light, and its polarization; `None` if it is
    /// 0.
    #[cold]
    #[inline(never)]
    fn transmittance<const N: usize, P: Polarization<N>>(
        &self,
        world: &World,
        draw: &Draw<N>,
        mut polarization: P,
    ) -> Option<(Lanes<N>, P)> {
        let (mut ray, mut remaining) = (*self.ray, self.distance);
        let (mut all, mut by_holes, mut by_panes) = (Lanes::ONE, Lanes::ONE, Lanes::ZERO);
        let may_attenuate = |object: u32| world.is_see_through(object) && self.occluders.has(world, object);
        while let Some(hit) = world.scene.nearest(&ray, remaining, &may_attenuate) {
            let surface_hit = SurfaceHit::new(world, &ray, hit);
            let straight_ray =
                StraightRay { ray: &ray, surface_hit: &surface_hit, present: Lanes::ONE, inside: self.inside };
            let pass_through = pass_through_of_ray(world, draw, &straight_ray, polarization)?;
            let share = pass_through.straight.share();
            // The last surface is the first one that the camera sees. Behind a holdout it sees only what holes show,
            // and a surface that lets all light through does not exist for it.
            let [holes, panes] = match world.visibility(hit.object) {
                Visibility::Holdout => [pass_through.straight.holes, Lanes::ZERO],
                _ if share == Lanes::ONE => [share, Lanes::ZERO],
                _ => [pass_through.straight.holes, pass_through.straight.panes],
            };
            by_panes = by_panes * holes + panes * all;
            by_holes = by_holes * holes;
            (all, polarization) = (all * share, pass_through.polarization);
            if all.is_zero() {
                return None;
            }
            remaining -= hit.intersection.t;
            ray = surface_hit.point.leave(ray.direction);
        }
        let share = match self.occluders {
            Occluders::Seen(SeenThrough::Holes) => by_holes,
            Occluders::Seen(SeenThrough::Panes) => by_panes,
            Occluders::Seen(SeenThrough::All) if world.has_mattes => by_holes + by_panes,
            _ => all,
        };
        (!share.is_zero()).then_some((share, polarization))
    }
}

/// A ray that hits a surface which may let some of its light pass through.
struct StraightRay<'a, const N: usize> {
    ray: &'a Ray,
    surface_hit: &'a SurfaceHit,
    present: Lanes<N>,
    /// The medium around it.
    inside: Option<MaterialId>,
}

/// Returns what a material lets pass through where a ray hits it, for all kinds of rays.
fn pass_through_of_ray<const N: usize, P: Polarization<N>>(
    world: &World,
    draw: &Draw<N>,
    straight_ray: &StraightRay<N>,
    polarization: P,
) -> Option<PassThrough<N, P>> {
    let StraightRay { ray, surface_hit: SurfaceHit { hit, point }, present, inside } = *straight_ray;
    let (wo, uv) = (-ray.direction, world.scene.objects[hit.object as usize].uv(&hit.intersection, point));
    let [_, normal] = shading::normals(point, wo);
    let context = context(world, draw, wo, normal, uv, present, [inside; 2]);
    let material = world.scene.material_of(hit.object);
    let mut straight = material.straight(&context)?;
    let polarization = polarization.pass(material, &context, &mut straight);
    Some(PassThrough { straight, polarization })
}
