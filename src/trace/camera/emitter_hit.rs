//! Light that a path hits by itself: of the sky, or of an emissive surface.

use super::direct::weight_of_hit;
use crate::light::{Light, LightId};
use crate::math::DVec3;
use crate::spectrum::{Draw, Lanes};
use crate::trace::World;
use crate::trace::walk::{Path, Polarization, SurfaceHit};

pub struct EmitterHit<const N: usize, P> {
    pub light: LightId,
    pub lanes: Lanes<N>,
    /// The unit normal on the front of the emissive surface; `None` for a sky.
    pub normal: Option<DVec3>,
    /// The polarization of the path there.
    pub polarization: P,
}

impl<const N: usize, P: Polarization<N>> EmitterHit<N, P> {
    /// Returns the sky or a sun at the end of a path; `None` if the path misses the sun.
    pub fn of_sky(world: &World, draw: &Draw<N>, path: &Path<N, P>, light: LightId) -> Option<Self> {
        let sky = &world.scene.lights[light];
        let factor = match sky {
            Light::Sun(sun) => sun.pdf(&path.ray).map(|_| sun.radiance_factor())?,
            _ => 1.0,
        };
        let weight = weight_of_hit(world, light, path.scatter.as_ref(), &path.ray, None);
        let mut emission = sky.toward(draw, path.ray.direction, [0.0; 2]);
        let polarization = path.polarization.at_polarized_light(sky, path.ray.direction, &mut emission);
        let lanes = path.throughput.scaled(weight * factor).of(emission);
        Some(Self { light, lanes, normal: None, polarization: polarization.unwrap_or(path.polarization) })
    }

    /// Returns the light of a surface that a path has hit; `None` if this side does not emit.
    pub fn of_surface(world: &World, draw: &Draw<N>, path: &Path<N, P>, surface_hit: &SurfaceHit) -> Option<Self> {
        let SurfaceHit { hit, point } = surface_hit;
        let object = &world.scene.objects[hit.object as usize];
        let light = object.light?;
        let Light::Area(area) = &world.scene.lights[light] else { return None };
        if !area.sides.shine(point.normal.dot(path.ray.direction) < 0.0) {
            return None;
        }
        let weight = weight_of_hit(world, light, path.scatter.as_ref(), &path.ray, Some(&hit.intersection));
        let uv = object.uv(&hit.intersection, point);
        let lanes = path.throughput.scaled(weight).of(draw.read_at(&area.radiance, uv));
        Some(Self { light, lanes, normal: Some(point.normal), polarization: path.polarization })
    }
}
