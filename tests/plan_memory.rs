//! The memory of the plan does not grow with pixels or samples, and that of a merge does not grow with parts or rows.

mod support;

#[path = "fuzz/allocator.rs"]
mod allocator;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use abbe::film::{Layer, Shard};
use abbe::plan::plan;
use abbe::{Options, Parts, Rendering};
use allocator::{Memory, memory_of};
use support::scenes::scene;

/// Memory is counted over all threads together.
static MEMORY_LOCK: Mutex<()> = Mutex::new(());

/// Returns the memory that the plan takes for a glass ball on a floor under a small lamp.
fn memory_of_plan(width: u32, height: u32, samples: u32) -> Memory {
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

/// The plan holds photons while it learns where they land, the same number for any image. The memory varies with the
/// threads.
#[test]
fn w8_the_plan_takes_no_more_memory_for_more_pixels_and_samples() {
    const MAX_BYTES: usize = 200_000_000;
    let _alone = MEMORY_LOCK.lock();
    let small = memory_of_plan(640, 360, 64);
    let large = [(3840, 2160, 256), (16384, 16384, 16), (640, 360, 65_536)]
        .map(|(w, h, samples)| memory_of_plan(w, h, samples));
    let most = large.into_iter().fold(Memory::default(), Memory::max);
    println!("{small:?} for a small image, {most:?} for large ones");
    assert!(most.peak <= MAX_BYTES.min(2 * small.peak) && most.largest <= 2 * small.largest, "{small:?} and {most:?}");
}

/// Renders an image with all layers in `count` parts.
fn parts(folder: &Path, height: u32, count: u32) -> Vec<PathBuf> {
    let scene = scene(&format!(
        "[camera]\nposition = [0, 0, 4]\nlook_at = [0, 0, 0]\nvertical_fov = 40\n\
         [film]\nwidth = 160\nheight = {height}\n[render]\nsamples = 1\nmodel = \"rgb\"\n\
         [material.white]\ndiffuse = {{ reflectance = 0.7 }}\n[[light]]\nenvironment = {{ radiance = 1 }}\n\
         [[object]]\nmaterial = \"white\"\nshape.sphere = {{ center = [0, 0, 0], radius = 1 }}\n"
    ));
    let part = |number| {
        let path = folder.join(format!("{height}.{number}-of-{count}.part"));
        let shard = Shard::new(number, count).expect("there is such a part");
        let options = Options { shard, layers: Some(Layer::all()), ..Options::default() };
        let mut rendering = Rendering::new(&scene, &options).expect("it can be rendered");
        while rendering.advance(&|_| ()) {}
        rendering.write_part(&path).expect("a part can be written");
        path
    };
    (1..=count).map(part).collect()
}

/// Returns the memory of a merge, with the bytes of the image's numbers and of its largest part.
fn merged(height: u32, count: u32) -> (Memory, usize, usize) {
    let folder = tempfile::tempdir().expect("a folder");
    let paths = parts(folder.path(), height, count);
    let exr = folder.path().join("image.exr");
    let merge = || Parts::open(&paths).and_then(|parts| parts.write_exr(&exr));
    let (done, memory) = memory_of(merge);
    done.expect("the parts belong together");
    let channels = 5 + Layer::all().iter().map(|layer| layer.channels().len()).sum::<usize>();
    let size = |path: &PathBuf| fs::metadata(path).expect("it was written").len() as usize;
    let part = paths.iter().map(size).max().expect("there are parts");
    (memory, channels * 4 * 160 * height as usize, part)
}

/// Rows go from the parts to the file as they arrive. The number of blocks in memory varies with the threads.
#[test]
fn w10_a_merge_takes_no_more_memory_for_more_parts_and_rows() {
    let _alone = MEMORY_LOCK.lock();
    let (few, image, part) = merged(512, 3);
    let ((many, ..), (tall, ..)) = (merged(512, 60), merged(2048, 3));
    println!("{few:?} for 3 parts, {many:?} for 60, {tall:?} for 4 times as many rows; an image has {image} bytes");
    assert!(few.peak < image + 2 * part && few.peak < image / 2, "{few:?}, an image of {image}, a part of {part}");
    assert!(many.peak < few.peak * 3 / 2 && tall.peak < few.peak * 3 / 2, "{few:?}, {many:?} and {tall:?}");
}

/// Splatted photons are stored as they are sent, not once for each pixel that a filter reaches.
#[test]
fn photons_take_no_more_memory_under_a_wide_filter() {
    let _alone = MEMORY_LOCK.lock();
    let memory_of_plan = |radius: u32| {
        let scene = scene(&format!(
            "[camera]\nposition = [0, 1.2, 6]\nlook_at = [0, 1, 0]\nvertical_fov = 35\n\
             [film]\nwidth = 32\nheight = 18\nfilter = {{ tent = {{ radius = {radius} }} }}\n[render]\nsamples = 1\n\
             [material.white]\ndiffuse = {{ reflectance = 0.7 }}\n[material.glass]\ndielectric = {{ index = 1.5 }}\n\
             [[object]]\nmaterial = \"white\"\nshape.plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}\n\
             [[object]]\nmaterial = \"glass\"\nshape.sphere = {{ center = [0, 1, 0], radius = 1 }}\n\
             [[light]]\nsun = {{ toward = [1, 2, 1], irradiance = 3 }}\n"
        ));
        let mut rendering = Rendering::new(&scene, &Options::default()).expect("it can be rendered");
        memory_of(|| while rendering.advance(&|_| ()) {}).1
    };
    let [narrow, wide] = [1, 4].map(memory_of_plan);
    assert!(wide.peak <= 2 * narrow.peak, "{narrow:?} and {wide:?}");
}
