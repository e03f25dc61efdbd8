//! The image depends only on the scene and the seed, not on the number of threads or on the run.
//!
//! ```text
//! cargo test --test all determinism::
//! ```

use abbe::{Options, Scene};
use exr::prelude::{AttributeValue, LayerAttributes, Text, read_first_flat_layer_from_file};
use rayon::prelude::*;

use crate::support::run::{Folder, render};

/// Random choices everywhere: a glass ball, a mirror and metal on a diffuse floor under two lamps and a sky. The size
/// of the film is not a multiple of any tile size.
const RANDOM: &str = r#"
camera = { position = [0, 1.5, 6], look_at = [0, 0.7, 0], vertical_fov = 35 }
film = { width = 75, height = 43 }
render = { samples = 9, seed = 3 }
[material]
floor.diffuse.reflectance = 0.6
glass.dielectric.index.rgb = [1.5, 1.52, 1.55]
silver.mirror.reflectance = 0.9
gold.conductor.metal = "Au"
lamp.emissive.radiance = 8
[[object]]
shape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }
material = "floor"
[[object]]
shape.sphere = { center = [0, 0.8, 0], radius = 0.8 }
material = "glass"
[[object]]
shape.sphere = { center = [-1.8, 0.7, -0.5], radius = 0.7 }
material = "silver"
[[object]]
shape.cube = { center = [1.7, 0.5, -0.4], size = 1 }
material = "gold"
[[object]]
shape.quad = { center = [0.5, 3, 0], u = [0.5, 0, 0], v = [0, 0, 0.5] }
material = "lamp"
[[object]]
shape.sphere = { center = [-1, 2.5, 1], radius = 0.2 }
material = "lamp"
[[light]]
environment.radiance = 0.2
"#;

/// Renders a scene with the command and returns the bytes of the EXR and the PNG.
fn render_files(folder: &Folder, scene: &str, flags: &[&str]) -> (Vec<u8>, Vec<u8>) {
    folder.write("scene.toml", scene);
    let answer = render(folder, &[&["scene.toml", "--exr", "image.exr", "--png", "image.png"], flags].concat());
    assert_eq!(answer.code, Some(0), "{}", answer.stderr);
    (folder.read("image.exr"), folder.read("image.png"))
}

#[test]
fn any_number_of_threads_and_any_run_write_the_same_bytes() {
    let folder = Folder::new();
    let deterministic = RANDOM
        .replace("height = 43", "height = 43, filter = \"center\"")
        .replace("[material]", "[material]\nplain.diffuse.reflectance = 0")
        .replace("material = \"floor\"", "material = \"silver\"");
    for scene in [RANDOM, deterministic.as_str()] {
        let first = render_files(&folder, scene, &["--layers", "all", "--threads", "1"]);
        for threads in ["1", "2", "3", "7"] {
            let again = render_files(&folder, scene, &["--layers", "all", "--threads", threads]);
            assert!(again == first, "{threads} threads write other bytes");
        }
    }
}

#[test]
fn another_seed_gives_another_image_of_the_same_scene() {
    let folder = Folder::new();
    let red = |flags: &[&str]| {
        render_files(&folder, RANDOM, flags);
        let image = read_first_flat_layer_from_file(folder.path_of("image.exr")).expect("an EXR");
        let channels = image.layer_data.channel_data.list;
        let red = channels.iter().find(|channel| channel.name.eq("R")).expect("a red channel");
        red.sample_data.values_as_f32().collect::<Vec<f32>>()
    };
    let (of_scene, again, other) = (red(&[]), red(&["--seed", "3"]), red(&["--seed", "4"]));
    assert_eq!(of_scene, again);
    let differing = of_scene.iter().zip(&other).filter(|(a, b)| a != b).count();
    assert!(differing * 2 > other.len(), "only {differing} pixels differ");
    let mean = |image: &[f32]| image.iter().sum::<f32>() / image.len() as f32;
    assert!((mean(&of_scene) / mean(&other) - 1.0).abs() < 0.1, "{} and {}", mean(&of_scene), mean(&other));
}

#[test]
fn only_a_stamp_says_when_and_how_an_image_was_made() {
    let folder = Folder::new();
    let header = |flags: &[&str]| {
        render_files(&folder, RANDOM, flags);
        let image = read_first_flat_layer_from_file(folder.path_of("image.exr")).expect("an EXR");
        image.layer_data.attributes
    };
    let value = |header: &LayerAttributes, name: &str| header.other.get(&Text::from(name)).cloned();
    let plain = header(&["--threads", "2"]);
    assert_eq!((plain.capture_date.clone(), plain.utc_offset), (None, None));
    assert!(["render/threads", "render/renderTime"].iter().all(|name| value(&plain, name).is_none()));
    let stamped = header(&["--stamp", "--threads", "2"]);
    let date = stamped.capture_date.clone().expect("a date").to_string();
    let form: Vec<usize> = date.split([':', ' ']).map(str::len).collect();
    assert_eq!((form, stamped.utc_offset), (vec![4, 2, 2, 2, 2, 2], Some(0.0)), "{date}");
    assert_eq!(value(&stamped, "render/threads"), Some(AttributeValue::I32(2)));
    let Some(AttributeValue::F64(seconds)) = value(&stamped, "render/renderTime") else {
        panic!("no time of rendering")
    };
    assert!(seconds > 0.0 && seconds < 3600.0, "{seconds}");
    // Everything else is the same.
    let rest = |header: &LayerAttributes| header.other.len();
    assert_eq!(rest(&plain) + 2, rest(&stamped));
}

#[test]
fn renders_that_a_program_starts_in_parallel_neither_overflow_its_stacks_nor_disturb_each_other() {
    let text = r#"
    camera = { position = [0, 0, 4], look_at = [0, 0, 0], vertical_fov = 40 }
    film = { width = 8, height = 8 }
    render.samples = 1
    material.glass.dielectric.index = 1.5
    object = [{ shape.sphere = { center = [0, 0, 0], radius = 1 }, material = "glass" }]
    light = [{ environment.radiance = 1 }]
    "#;
    let scene = Scene::parse(text, "").expect("it is a scene");
    let render = |seed: u64| {
        let options = Options { seed: Some(seed % 3), threads: Some(1), ..Options::default() };
        abbe::render(&scene, &options).expect("it renders").rgb()
    };
    // 200 renders on the stack of one of two threads would overflow it.
    let threads = rayon::ThreadPoolBuilder::new().num_threads(2).build().expect("threads can be started");
    let images: Vec<_> = threads.install(|| (0..200).into_par_iter().map(render).collect());
    assert!(images[0] != images[1], "seeds differ");
    for (seed, image) in images.iter().enumerate() {
        assert!(*image == images[seed % 3], "render {seed}");
    }
}
