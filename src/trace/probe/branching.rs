//! Estimates how many rays a camera sample takes when all branches are followed.

use crate::material::Lobes;
use crate::math::{DVec2, DVec3, Sampler};
use crate::trace::World;
use crate::trace::camera::{PathTracer, take_sample};
use crate::trace::width::in_lanes;

/// The cost of following all branches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Branching {
    /// Number of surfaces that a camera sample hits on average.
    Affordable(f64),
    /// More surfaces than allowed, and the pixel where this was found.
    Beyond([i32; 2]),
}

/// Pixels along each side of the image that are tested.
const PIXELS_PER_SIDE: u32 = 16;
/// Most objects that are tested one by one.
const MAX_OBJECTS: usize = 64;

/// Follows all branches in pixels spread over the image, and in pixels where the camera would see transmissive objects
/// if nothing were in front of them. Stops as soon as it is known whether a mean sample hits more than `max` surfaces.
/// A sample that had to continue by chance exceeds the limit, whatever the mean is.
pub fn branching(world: &World, max: f64) -> Branching {
    in_lanes!(&world.method.basis, N => trace_branches::<N>(world, max))
}

fn trace_branches<const N: usize>(world: &World, max: f64) -> Branching {
    let mut tracer = PathTracer::<N>::new(world);
    let film = world.scene.film.whole();
    let mut trace_branches = |[x, y]: [i32; 2]| {
        let before = tracer.walker.stats.rays;
        take_sample(&mut tracer, &Sampler::of_pixel(world.method.seed, [x, y], 0), [x, y]);
        (tracer.walker.stats.rays - before, tracer.walker.stats.by_chance > 0)
    };
    let max_total = max * f64::from(PIXELS_PER_SIDE * PIXELS_PER_SIDE);
    let mut surfaces = 0;
    for pixel in film.middles_of_cells(PIXELS_PER_SIDE) {
        let (more, by_chance) = trace_branches(pixel);
        surfaces += more;
        if by_chance || surfaces as f64 > max_total {
            return Branching::Beyond(pixel);
        }
    }
    match pixels_of_objects(world, Lobes::is_transmissive).into_iter().find(|&pixel| trace_branches(pixel).1) {
        Some(pixel) => Branching::Beyond(pixel),
        None => Branching::Affordable(surfaces as f64 / f64::from(PIXELS_PER_SIDE * PIXELS_PER_SIDE)),
    }
}

/// Returns the pixels in which the camera would see objects of some materials if nothing hid them: at the center of
/// their bounds and toward their corners.
pub fn pixels_of_objects(world: &World, is_match: impl Fn(Lobes) -> bool) -> Vec<[i32; 2]> {
    let scene = &world.scene;
    let is_wanted = |object: &u32| is_match(scene.material_of(*object).lobes());
    let matching: Vec<u32> = (0..scene.objects.len() as u32).filter(is_wanted).collect();
    let stride = matching.len().div_ceil(MAX_OBJECTS).max(1);
    let mut pixels = Vec::new();
    for &object in matching.iter().step_by(stride) {
        let Some(bounds) = scene.objects[object as usize].shape.bounds() else { continue };
        let (middle, half) = (bounds.center(), 0.5 * bounds.size());
        let sign = |corner: u32, axis: u32| if corner >> axis & 1 == 0 { -1.0 } else { 1.0 };
        let corners =
            (0..8).map(|corner| middle + 0.6 * half * DVec3::new(sign(corner, 0), sign(corner, 1), sign(corner, 2)));
        for point in std::iter::once(middle).chain(corners) {
            let Some(DVec2 { x, y }) = scene.camera.see(point, [0.5; 2]).map(|seen| seen.film) else { continue };
            let inside = |at: f64, size: u32| at >= 0.0 && at < f64::from(size);
            if inside(x, scene.film.width) && inside(y, scene.film.height) {
                pixels.push([x as i32, y as i32]);
            }
        }
    }
    pixels.sort_unstable();
    pixels.dedup();
    pixels
}
