//! The ways that light takes to the camera, as far as they tint it: which surfaces and bodies it meets, and how often.

use super::World;
use super::branching::pixels_of_objects;
use super::route_walk::Walker;
use crate::light::LightId;
use crate::math::{DVec2, Sampler};
use crate::scene::MaterialId;

/// Something that light meets on its way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The material.
    pub material: MaterialId,
    /// Which of the materials that it is made of, in the order of [`Material::with_parts`](crate::material::Material::with_parts).
    pub part: usize,
    /// What light does there.
    pub way: Way,
}

/// What light does at a surface, or in a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Way {
    /// It is mirrored, by a surface or a facet of it met under an angle of this cosine.
    Reflected(f64),
    /// It goes through the surface.
    Crossed,
    /// It is scattered in every direction.
    Scattered,
    /// It goes this distance through the body.
    Inside(f64),
}

/// A way of light from a light to the camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Route {
    /// What it meets, the nearest to the camera first.
    pub steps: Vec<Step>,
    /// Where it comes from.
    pub light: LightId,
    /// What is left of it but for the steps.
    pub weight: f64,
    /// Diffuse surfaces among the steps.
    pub scattered: u32,
}

/// Wavelengths in nm of the lanes that decide which ways matter.
pub const ROUTES_NM: [f64; 4] = [450.0, 520.0, 590.0, 650.0];
/// Pixels along each side of the image.
const SIDE: u32 = 24;
/// Surfaces that are met for all pixels over the image or on objects.
const ALL_SURFACES: usize = 16_384;

/// The routes to a few hundred pixels, those of each together, in a world of the lanes [`ROUTES_NM`].
pub fn routes(world: &World) -> Vec<Vec<Route>> {
    let film = world.scene.film.whole();
    // A stride that is coprime to the number of places visits them all, far ones first.
    let places = (0..SIDE * SIDE).map(|i| (i * 229) % (SIDE * SIDE));
    let all_over = places.map(|place| film.middle_of_cell(SIDE, place));
    let objects = pixels_of_objects(world, |material| material.has_single_directions());
    let of_pixel = |(number, [x, y]): (u32, [u32; 2])| {
        let ray = world.scene.camera.ray(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5));
        let sampler = Sampler::new(world.method.seed, [x, y], number);
        let mut walker = Walker::new(world, sampler);
        let met = walker.walk(ray);
        (met, walker.found)
    };
    let until_enough = |met: &mut usize, (more, found): (usize, Vec<Route>)| {
        let before = *met;
        *met += more;
        (before < ALL_SURFACES).then_some(found)
    };
    let mut routes: Vec<Vec<Route>> = (0..).zip(all_over).map(of_pixel).scan(0, until_enough).collect();
    routes.extend((SIDE * SIDE..).zip(objects).map(of_pixel).scan(0, until_enough));
    routes
}
