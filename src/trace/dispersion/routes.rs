//! The routes of light to the camera, as far as they tint it: which surfaces and bodies light hits, and how often.

use super::route::Route;
use super::route_walk::RouteWalker;
use crate::material::Lobes;
use crate::math::{DVec2, Sampler};
use crate::trace::World;
use crate::trace::probe::pixels_of_objects;

/// Number of pixels along each side of the image.
const PIXELS_PER_SIDE: u32 = 24;
/// Number of surfaces after which no more pixels are traced, over the image and again on objects.
const MAX_SURFACES: usize = 16_384;

/// Returns the routes to a few hundred pixels, grouped by pixel, in a world whose lanes are
/// [`ROUTES_NM`](super::route::ROUTES_NM).
pub fn routes(world: &World) -> Vec<Vec<Route>> {
    let film = world.scene.film.whole();
    let grid = film.middles_of_cells(PIXELS_PER_SIDE);
    let objects = pixels_of_objects(world, Lobes::has_delta);
    let routes_of_pixel = |(number, [x, y]): (u32, [i32; 2])| {
        let ray = world.scene.camera.ray(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5));
        let sampler = Sampler::of_pixel(world.method.seed, [x, y], number);
        let mut walker = RouteWalker::new(world, sampler);
        let surfaces = walker.walk(ray);
        (surfaces, walker.routes)
    };
    let until_enough = |surfaces: &mut usize, (more, found): (usize, Vec<Route>)| {
        let before = *surfaces;
        *surfaces += more;
        (before < MAX_SURFACES).then_some(found)
    };
    let mut routes: Vec<Vec<Route>> = (0..).zip(grid).map(routes_of_pixel).scan(0, until_enough).collect();
    routes.extend((PIXELS_PER_SIDE * PIXELS_PER_SIDE..).zip(objects).map(routes_of_pixel).scan(0, until_enough));
    routes
}
