//! What the plan holds in memory does not grow with pixels or samples.

mod support;

#[path = "fuzz/allocator.rs"]
mod allocator;

use abbe::plan::plan;
use allocator::{Memory, memory_of};
use support::scenes::scene;

/// A glass ball on a floor under a small lamp.
fn held(width: u32, height: u32, samples: u32) -> Memory {
    let scene = scene(&format!(
        "[camera]\nposition = [0, 2.2, 5]\nlook_at = [0, 0.5, 0]\nvertical_fov = 40\n\
         [film]\nwidth = {width}\nheight = {height}\n[render]\nsamples = {samples}\n\
         [material.white]\ndiffuse = {{ reflectance = 0.7 }}\n[material.lamp]\nemissive = {{ radiance = 5 }}\n\
         [material.glass]\ndielectric = {{ index = \"N-BK7\" }}\n\
         [[object]]\nmaterial = \"white\"\nshape.plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}\n\
         [[object]]\nmaterial = \"glass\"\nshape.sphere = {{ center = [0, 0.8, 0], radius = 0.5 }}\n\
         [[object]]\nmaterial = \"lamp\"\nshape.sphere = {{ center = [-1, 3.5, 0], radius = 0.1 }}\n"
    ));
    let (plan, memory) = memory_of(|| plan(&scene));
    let pass = plan.method.light_pass.expect("a glass ball under a small lamp throws a caustic");
    assert!(pass.map.is_some(), "{:?}", plan.because);
    memory
}

/// Photons are held while it is learned where they land: as many for any image. Threads may hold some more at a time or
/// less.
#[test]
fn w8_the_plan_holds_as_much_for_any_number_of_pixels_and_samples() {
    const MOST: usize = 200_000_000;
    let small = held(640, 360, 64);
    let large = [(3840, 2160, 256), (16384, 16384, 16), (640, 360, 65_536)].map(|(w, h, samples)| held(w, h, samples));
    let most = large.into_iter().fold(Memory::default(), Memory::max);
    println!("{small:?} for a small image, {most:?} for large ones");
    assert!(most.peak <= MOST.min(2 * small.peak) && most.largest <= 2 * small.largest, "{small:?} and {most:?}");
}
