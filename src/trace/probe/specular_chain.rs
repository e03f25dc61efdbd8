//! Follows points of the film to the surface that sends light of a small source toward the camera.

use crate::material::{Index, Interface, Material, reflect};
use crate::math::{DVec2, DVec3, Ray};
use crate::scene::{Hit, MaterialId, Scene};
use crate::shape::SurfacePoint;
use crate::spectrum::Table;
use crate::trace::walk::{SurfaceHit, shading};
use crate::trace::{World, media};

/// What becomes of a ray at a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// It passes straight through.
    Pass,
    /// The surface mirrors it.
    Mirror,
    /// It enters or leaves a clear body.
    Cross,
}

/// The events on the way from the camera to a light, in order: a mirror behind up to two panes of two faces each, a
/// mirror in a mirror, a surface or a whole body of glass, and what is mirrored inside it.
pub const CHAINS: [&[Event]; 10] = {
    use Event::{Cross, Mirror, Pass};
    [
        &[Mirror],
        &[Pass, Mirror],
        &[Pass, Pass, Mirror],
        &[Pass, Pass, Pass, Mirror],
        &[Pass, Pass, Pass, Pass, Mirror],
        &[Mirror, Mirror],
        &[Pass, Mirror, Mirror],
        &[Cross],
        &[Cross, Cross],
        &[Cross, Mirror, Cross],
    ]
};

/// Most events of a chain.
const MAX_EVENTS: usize = 5;

/// Events that are followed in a world.
pub struct SpecularChain<'a> {
    pub world: &'a World,
    pub events: &'static [Event],
    /// The width of each material's slopes, 0 if it is smooth; `None` if it mirrors nothing sharply.
    pub slopes: &'a [Option<f64>],
}

/// The surface at which the last event of a chain happens, or the camera if there are none.
pub struct ChainEnd {
    /// The objects at which all events happen.
    pub objects: [Option<u32>; MAX_EVENTS],
    pub point: SurfacePoint,
    /// The unit vector to where the ray comes from, and the unit normal of the surface on that side. At the camera, the
    /// normal is the direction of the ray.
    pub wo: DVec3,
    pub normal: DVec3,
    /// The direction in which a smooth surface or the camera sends the ray.
    pub outgoing: DVec3,
    /// The width of the surface's slopes, 0 if it is smooth.
    pub slopes: f64,
}

impl ChainEnd {
    fn at_camera(ray: &Ray) -> Self {
        Self {
            objects: [None; MAX_EVENTS],
            point: SurfacePoint::in_space(ray.origin),
            wo: -ray.direction,
            normal: ray.direction,
            outgoing: ray.direction,
            slopes: 0.0,
        }
    }
}

impl SpecularChain<'_> {
    /// Returns whether the world has surfaces for all events.
    pub fn is_possible(&self) -> bool {
        self.events.iter().all(|event| match event {
            Event::Pass => self.world.has_see_through(),
            Event::Mirror => self.slopes.iter().any(Option::is_some),
            Event::Cross => self.world.has_media,
        })
    }

    /// Returns how often surfaces send the light on.
    pub fn bounces(&self) -> u32 {
        self.events.iter().filter(|event| **event != Event::Pass).count() as u32
    }

    /// Follows the ray of a point of the film and a point of the lens; `None` if other things become of it, or if a
    /// surface before the last is rough.
    pub fn trace(&self, film: DVec2, place: DVec2) -> Option<ChainEnd> {
        let scene = &self.world.scene;
        let mut ray = scene.camera.ray_from_lens(film, place);
        if self.events.is_empty() {
            return Some(ChainEnd::at_camera(&ray));
        }
        let mut media = self.world.media_at_camera(&ray);
        let mut hit = scene.intersect_seen(&ray, None)?;
        let (mut objects, mut is_from_camera) = ([None; MAX_EVENTS], true);
        for (i, event) in self.events.iter().enumerate() {
            let wo = -ray.direction;
            let SurfaceHit { point, .. } = SurfaceHit::new(self.world, &ray, hit);
            let [_, normal] = shading::normals(&point, wo);
            let material = scene.objects[hit.object as usize].material;
            let slopes = match event {
                Event::Mirror => self.slopes[material as usize]?,
                Event::Pass | Event::Cross => 0.0,
            };
            let outgoing = match event {
                Event::Pass => self.world.is_see_through(hit.object).then_some(ray.direction)?,
                Event::Mirror => reflect(wo, normal),
                Event::Cross => {
                    let (boundary, _) = media.at_surface(scene, material, &point, ray.direction);
                    media = media.after_crossing(&boundary);
                    refract(scene, material, boundary.sides(), wo, normal)?
                }
            };
            objects[i] = Some(hit.object);
            if i + 1 == self.events.len() {
                return Some(ChainEnd { objects, point, wo, normal, outgoing, slopes });
            }
            if slopes != 0.0 {
                return None;
            }
            is_from_camera &= *event == Event::Pass;
            ray = point.leave(outgoing);
            hit = next_hit(scene, &ray, hit, is_from_camera)?;
        }
        None
    }
}

/// Returns what a ray hits that leaves another hit. Rays of the camera do not meet what it does not see.
fn next_hit(scene: &Scene<Table>, ray: &Ray, last: Hit, is_from_camera: bool) -> Option<Hit> {
    let from = Some(last.primitive());
    if is_from_camera { scene.intersect_seen(ray, from) } else { scene.intersect_from(ray, from) }
}

/// Returns the direction in which light crosses a smooth clear surface that a ray has hit; `None` under total
/// reflection, at another surface, and where colors part.
fn refract(
    scene: &Scene<Table>,
    material: MaterialId,
    sides: [Option<MaterialId>; 2],
    wo: DVec3,
    normal: DVec3,
) -> Option<DVec3> {
    let Material::Dielectric(glass) = &scene.materials[material as usize].material else { return None };
    if glass.roughness.interface().is_some() || sides[0] == sides[1] {
        return None;
    }
    let given = media::direction_indices(scene, sides);
    let index = |side: usize| match (given[side], media::index_around(scene, sides[side])) {
        (Some(index), _) | (None, Index::Same(index)) => Some(index),
        (None, Index::Own(_)) => None,
    };
    let interface = Interface::new(index(0)?, index(1)?, wo.dot(normal));
    (interface.transmittance > 0.0).then(|| interface.refract(wo, normal))
}
