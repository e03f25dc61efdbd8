//! Time and memory for writing an image as OpenEXR, compared with the library's own writer for the same channels.
//!
//! ```text
//! MALLOC_MMAP_THRESHOLD_=65536 cargo bench --bench exr
//! ```
//!
//! With that threshold, glibc returns memory at once, and the peak is that of the writer alone. Both write to a file,
//! on all threads. What the library is given has been converted before the clock starts.

use std::fs;
use std::path::Path;
use std::time::Instant;

use abbe::{Image, Options, Scene};
use exr::prelude::{FlatImage, ReadChannels, ReadLayers, WritableImage, read};

/// Number of times that each of them writes; the medians count.
const RUNS: usize = 7;

/// A glass ball and a ball of rough gold on a matte floor: noise, smooth numbers and empty places.
const SCENE: &str = r#"
camera = { position = [0, 1.6, 6], look_at = [0, 0.7, 0], vertical_fov = 38 }
material.floor.diffuse.reflectance = { rgb = [0.7, 0.5, 0.3] }
material.glass.dielectric.index = 1.5
material.gold.conductor = { metal = "Au", roughness = 0.3 }
object = [
    { shape.disc = { center = [0, 0, 0], normal = [0, 1, 0], radius = 4 }, material = "floor" },
    { shape.sphere = { center = [-0.8, 0.8, 0], radius = 0.8 }, material = "glass" },
    { shape.sphere = { center = [0.9, 0.7, 0], radius = 0.7 }, material = "gold" },
]
light = [
    { environment.radiance = 0.3 },
    { sun = { toward = [1, 2, 1], irradiance = 3 } },
]
"#;

fn main() {
    println!(
        "{:<44} {:>8} {:>8} {:>6} {:>7} {:>7} {:>7}",
        "", "ours s", "bare s", "ratio", "data MB", "file MB", "peak"
    );
    let film =
        |size: &str, keys: &str| format!("film = {{ {size}, {keys} }}\nrender = {{ samples = 1, model = \"rgb\" }}\n");
    let twelve_channels = "layers = [\"direct\", \"N\", \"samples\"], precision = \"half\"";
    for compression in ["zip", "zips", "piz", "rle", "none"] {
        let keys = format!("{twelve_channels}, compression = \"{compression}\"");
        compare(&format!("1920 x 1080, 12 channels, half, {compression}"), &film("width = 1920, height = 1080", &keys));
    }
    let large = film("width = 4096, height = 2160", "compression = \"zip\"");
    compare("4096 x 2160, R G B A Z, float, zip", &large);
}

fn compare(name: &str, film: &str) {
    let scene = Scene::parse(&format!("{film}{SCENE}"), "").expect("the scene is valid");
    let image = abbe::render(&scene, &Options::default()).expect("it renders");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("ours.exr");
    image.write_exr(&path).expect("it can be written");
    let bare = read_back(&path);
    let data: usize =
        bare.layer_data.iter().map(|layer| layer.channel_data.list.iter().map(bytes).sum::<usize>()).sum();
    let [mut ours, mut theirs] = [Vec::new(), Vec::new()];
    for _ in 0..RUNS {
        ours.push(seconds(|| {
            image.write_exr(&path).expect("it can be written");
        }));
        let other = folder.path().join("bare.exr");
        theirs.push(seconds(|| bare.write().to_file(&other).expect("it can be written")));
    }
    let [ours, theirs] = [ours, theirs].map(median);
    drop(bare);
    let peak = peak(&image, &path).map_or("-".into(), |peak| format!("{:.2} x", peak / data as f64));
    let size = fs::metadata(&path).expect("it was written").len();
    let [data, size] = [data as f64, size as f64].map(|bytes| bytes * 1e-6);
    println!("{name:<44} {ours:>8.3} {theirs:>8.3} {:>6.2} {data:>7.1} {size:>7.1} {peak:>7}", ours / theirs);
}

fn read_back(path: &Path) -> FlatImage {
    let file = read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
    file.from_file(path).expect("it can be read")
}

fn bytes(channel: &exr::prelude::AnyChannel<exr::prelude::FlatSamples>) -> usize {
    let is_float = !matches!(channel.sample_data, exr::prelude::FlatSamples::F16(_));
    channel.sample_data.len() * if is_float { 4 } else { 2 }
}

fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

/// Returns the bytes of memory that writing takes beside the image, if the system reports them. The peak is reset
/// first.
fn peak(image: &Image, path: &Path) -> Option<f64> {
    fs::write("/proc/self/clear_refs", "5").ok()?;
    let before = kilobytes("VmRSS:")?;
    image.write_exr(path).expect("it can be written");
    Some((kilobytes("VmHWM:")? - before) * 1024.0)
}

fn kilobytes(key: &str) -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with(key))?;
    line.split_whitespace().nth(1)?.parse().ok()
}
