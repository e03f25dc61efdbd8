//! Renders that stop and resume, and images made in parts: they give the same bytes as one render.
//!
//! ```text
//! cargo test --test all checkpoints::
//! ```

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use abbe::film::{Layer, Overscan, Shard, Window};
use abbe::trace::Method;
use abbe::{Advance, Error, Image, Options, Rendering, Resumed, Scene, merge};

use crate::support::random::Random;
use crate::support::scenes::scene;

mod command;
mod damage;

/// A glass ball and a mirror on a floor under a small lamp. The size of the film is not a multiple of any tile size.
pub const GLASS: &str = r#"
camera = { position = [0, 1.5, 6], look_at = [0, 0.7, 0], vertical_fov = 35 }
film = { width = 37, height = 21 }
render = { samples = 20, seed = 3 }
[material]
floor.diffuse.reflectance = 0.6
glass.dielectric.index = 1.5
silver.mirror.reflectance = 0.9
lamp.emissive.radiance = 800
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
shape.sphere = { center = [-1, 2.5, 1], radius = 0.02 }
material = "lamp"
"#;

/// The caustic of a ball outside the view.
pub const CAUSTIC: &str = r#"
camera = { position = [0, 1.5, 6], look_at = [0, 0, 0], vertical_fov = 12 }
film = { width = 37, height = 21 }
render = { samples = 20, seed = 3 }
[material]
floor.diffuse.reflectance = 0.6
glass.dielectric.index = 1.5
lamp.emissive.radiance = 800
[[object]]
shape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }
material = "floor"
[[object]]
shape.sphere = { center = [0, 4, 0], radius = 0.1 }
material = "glass"
[[object]]
shape.sphere = { center = [0, 5, 0], radius = 0.02 }
material = "lamp"
"#;

/// A closed room under a lamp.
pub const ROOM: &str = r#"
camera = { position = [1.3, 1.6, 2.2], look_at = [-0.6, 1, -1], vertical_fov = 75 }
film = { width = 21, height = 18 }
render = { samples = 40 }
[material]
wall.diffuse.reflectance = 0.7
lamp.emissive.radiance.rgb = [9, 8, 6]
[[object]]
shape.quad = { center = [0, 0, 0], u = [2, 0, 0], v = [0, 0, -2.5] }
material = "wall"
[[object]]
shape.quad = { center = [0, 3, 0], u = [2, 0, 0], v = [0, 0, 2.5] }
material = "wall"
[[object]]
shape.quad = { center = [2, 1.5, 0], u = [0, 0, 2.5], v = [0, 1.5, 0] }
material = "wall"
[[object]]
shape.quad = { center = [-2, 1.5, 0], u = [0, 0, 2.5], v = [0, 1.5, 0] }
material = "wall"
[[object]]
shape.quad = { center = [0, 1.5, -2.5], u = [2, 0, 0], v = [0, 1.5, 0] }
material = "wall"
[[object]]
shape.quad = { center = [0, 1.5, 2.5], u = [2, 0, 0], v = [0, 1.5, 0] }
material = "wall"
[[object]]
shape.quad = { center = [0.3, 2.9, -0.4], u = [0.5, 0, 0], v = [0, 0, 0.4] }
material = "lamp"
"#;

/// A ball under the sky, in 64 tiles.
const LIT: &str = r#"
camera = { position = [0, 0, 4], look_at = [0, 0, 0], vertical_fov = 40 }
film = { width = 128, height = 128 }
render = { samples = 2 }
material.matte.diffuse.reflectance = 0.6
light = [{ environment = { radiance = 1 } }]
[[object]]
shape.sphere = { center = [0, 0, 0], radius = 1 }
material = "matte"
"#;

/// A name, a scene, options, and whether a method is the intended one.
pub type Kind = (&'static str, String, Options, fn(&Method) -> bool);

/// Returns scenes for all ways to find light.
fn kinds() -> Vec<Kind> {
    let splats = |method: &Method| method.light_pass.as_ref().is_some_and(|pass| pass.map.is_none());
    let gathers = |method: &Method| method.light_pass.as_ref().is_some_and(|pass| pass.map.is_some());
    let all = || Options { layers: Some(Layer::all()), spectral: true, ..Options::default() };
    let cut = Options {
        overscan: Some(Overscan { left: 3, top: 0, right: 5, bottom: 2 }),
        crop: Some(Window { left: -2, top: 4, width: 35, height: 18 }),
        ..all()
    };
    let polarized = Layer::STOKES.into_iter().chain([Layer::Polarization]).collect::<Vec<_>>();
    let stokes = || Options { layers: Some(polarized.clone()), ..all() };
    let sharp = GLASS.replace("height = 21", "height = 21, filter = \"mitchell\"");
    let mitchell = sharp.clone();
    let split = GLASS.replace("index = 1.5", "index = \"SF11\"");
    let still = GLASS
        .replace("height = 21", "height = 21, filter = \"center\"")
        .replace("floor.diffuse.reflectance = 0.6", "floor.diffuse.reflectance = 0");
    // Light vertices pay off only in large images.
    let large = ROOM.replace("width = 21, height = 18", "width = 420, height = 360");
    let crop = Some(Window { left: 200, top: 150, width: 21, height: 18 });
    let part = Options { crop, ..Options::default() };
    let noisy = GLASS.replace("width = 37, height = 21", "width = 740, height = 420");
    let noisy = noisy.replace("seed = 3", "seed = 3, caustics = \"off\"");
    let ball_options = Options { crop: Some(Window { left: 320, top: 180, width: 37, height: 21 }), ..all() };
    vec![
        ("photons that are shown", CAUSTIC.into(), Options::default(), splats),
        ("photons that are gathered, all layers", GLASS.into(), all(), gathers),
        ("a filter with negative lobes, a crop in the overscan", mitchell, cut, gathers),
        ("Stokes vectors, of photons that are gathered", GLASS.into(), stokes(), gathers),
        ("Stokes vectors, of a filter with negative lobes", sharp, stokes(), gathers),
        ("light vertices", large, part, |method| method.light_vertices),
        ("adaptive sampling", noisy, ball_options, |method| method.density.is_some()),
        ("wavelengths that are drawn", split, all(), |method| method.basis.draws_wavelengths()),
        ("one sample per pixel", still.replace("samples = 20", "samples = 1"), all(), |method| method.samples == 1),
    ]
}

/// Returns the bytes of the files that an image is written to.
pub fn bytes(image: &Image, folder: &Path) -> Vec<Vec<u8>> {
    let [exr, spectral] = ["image.exr", "image.spectral.exr"].map(|name| folder.join(name));
    image.write_exr(&exr).expect("an image can be written");
    image.write_spectral_exr(&spectral).expect("an image can be written");
    [exr, spectral].iter().filter_map(|path| std::fs::read(path).ok()).collect()
}

/// Returns whether two images have the same pixels and the same report. Their expected durations may differ.
fn is_same(a: &Image, b: &Image) -> bool {
    (a.film(), a.report()) == (b.film(), b.report())
}

/// Returns the options with a plan from a file, so that renders of one scene need not plan again.
pub fn planned(scene: &Scene, options: &Options, folder: &Path) -> Options {
    let (path, mut planned) = (folder.join("image.plan"), scene.clone());
    options.apply(&mut planned).expect("the options fit");
    abbe::write_plan(&abbe::plan::plan(&planned), &planned, &path).expect("a plan can be written");
    Options { plan: Some(path), ..options.clone() }
}

/// Returns the options with the plan of one of the [`kinds`] from a file. Each plan is made once for all tests.
fn planned_once(kind: &'static str, scene: &Scene, options: &Options, folder: &Path) -> Options {
    static PLANS: Mutex<BTreeMap<&str, Vec<u8>>> = Mutex::new(BTreeMap::new());
    let path = folder.join("image.plan");
    let mut plans = PLANS.lock().expect("no other test has panicked");
    let plan = plans.entry(kind).or_insert_with(|| {
        planned(scene, options, folder);
        std::fs::read(&path).expect("it was written")
    });
    std::fs::write(&path, plan).expect("a plan can be written");
    Options { plan: Some(path), ..options.clone() }
}

pub fn rendering(scene: &Scene, options: &Options, threads: usize) -> Rendering {
    Rendering::new(scene, &Options { threads: Some(threads), ..options.clone() }).expect("it can be rendered")
}

/// Renders until the stop condition has been polled `most` times. Returns how often it was polled.
pub fn advance(rendering: &mut Rendering, most: u64) -> u64 {
    let calls = AtomicU64::new(0);
    let is_due = || calls.fetch_add(1, Ordering::Relaxed) >= most;
    while rendering.advance_until(&|_| (), &is_due) == Advance::Passed {}
    calls.into_inner()
}

#[test]
fn a_render_that_stops_anywhere_goes_on_to_the_same_bytes() {
    let (folder, mut random) = (tempfile::tempdir().expect("a folder"), Random::new(11));
    let path = folder.path().join("image.checkpoint");
    for (kind, text, options, is_meant) in kinds() {
        let scene = scene(&text);
        let options = planned_once(kind, &scene, &options, folder.path());
        let mut whole = rendering(&scene, &options, 2);
        assert!(is_meant(&whole.plan().method), "{kind}: {:?}", whole.plan().because);
        let calls = advance(&mut whole, u64::MAX);
        let (expected, report) = (bytes(&whole.image(), folder.path()), whole.image().report().clone());
        for threads in [1, 7] {
            let mut first = rendering(&scene, &options, threads);
            // Twice, so that a resumed render stops again.
            for _ in 0..2 {
                advance(&mut first, (random.number() * 0.6 * calls as f64) as u64);
                first.save(&path).expect("a checkpoint can be written");
                let mut next = rendering(&scene, &options, 9 - threads);
                let resumed = next.resume(&path).expect("a checkpoint can be read");
                assert_eq!(resumed == Resumed::Finished, next.done() == next.work(), "{kind}");
                assert_eq!(next.done(), first.done(), "{kind}: {threads} threads");
                assert!(is_same(&next.image(), &first.image()), "{kind}: {threads} threads");
                first = next;
            }
            let before = first.done();
            let (work, done) = (first.work(), AtomicU64::new(before));
            let image = first.run(&|more| {
                done.fetch_add(more, Ordering::Relaxed);
            });
            assert_eq!(done.into_inner(), work, "{kind}");
            assert!(
                bytes(&image, folder.path()) == expected,
                "{kind}: {threads} threads, stopped at {before} of {work}"
            );
            assert_eq!(*image.report(), report, "{kind}: {threads} threads");
        }
    }
}

#[test]
fn a_render_that_stops_and_goes_on_in_one_run_makes_the_same_image() {
    let folder = tempfile::tempdir().expect("a folder");
    for (kind, text, options, _) in kinds() {
        let scene = scene(&text);
        let options = planned_once(kind, &scene, &options, folder.path());
        let (mut whole, mut often) = (rendering(&scene, &options, 2), rendering(&scene, &options, 2));
        let calls = advance(&mut whole, u64::MAX);
        while often.done() < often.work() {
            advance(&mut often, calls / 7 + 1);
        }
        let [whole, often] = [whole, often].map(|rendering| bytes(&rendering.image(), folder.path()));
        assert!(whole == often, "{kind}");
    }
}

#[test]
fn parts_of_an_image_are_together_the_same_bytes_as_the_whole() {
    let folder = tempfile::tempdir().expect("a folder");
    // An image of six tiles leaves some of 16 parts empty. An image of 64 tiles does not.
    let few: &[(u32, usize)] = &[(3, 7)];
    let many = [few, &[(1, 1), (2, 3), (16, 2)]].concat();
    let all = [&*many, &[(64, 2)]].concat();
    let tiles = ("64 tiles", LIT.into(), Options::default(), (|_| true) as fn(&Method) -> bool);
    for (number, (kind, text, options, _)) in [tiles].into_iter().chain(kinds()).enumerate() {
        let scene = scene(&text);
        let options = planned_once(kind, &scene, &options, folder.path());
        let whole = bytes(&rendering(&scene, &options, 2).run(&|_| ()), folder.path());
        let counts = match number {
            0 => &all[..],
            1 => &many,
            _ => few,
        };
        for &(count, threads) in counts {
            let paths: Vec<_> =
                (1..=count).map(|number| folder.path().join(format!("{number}-of-{count}.part"))).collect();
            for (number, path) in (1..).zip(&paths) {
                let shard = Shard::new(number, count).expect("there is such a part");
                let mut rendering = rendering(&scene, &Options { shard, ..options.clone() }, threads);
                assert!(rendering.write_part(path).is_err(), "{kind}: an unfinished part");
                let done = AtomicU64::new(0);
                let count_done = |more| {
                    done.fetch_add(more, Ordering::Relaxed);
                };
                while rendering.advance(&count_done) {}
                assert_eq!((done.into_inner(), rendering.done()), (rendering.work(), rendering.work()), "{kind}");
                rendering.write_part(path).expect("a part can be written");
            }
            let merged = merge(&paths).expect("the parts belong together");
            assert!(bytes(&merged, folder.path()) == whole, "{kind}: {count} parts");
        }
    }
}

#[test]
fn a_part_that_stops_goes_on_to_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a folder");
    let [checkpoint, part, other] = ["a.checkpoint", "a.part", "b.part"].map(|name| folder.path().join(name));
    let shard = Shard::new(2, 3).expect("there is such a part");
    for (kind, text, options, _) in kinds() {
        let scene = scene(&text);
        let options = planned_once(kind, &scene, &Options { shard, ..options }, folder.path());
        let [mut whole, mut first, mut next] = [2, 3, 1].map(|threads| rendering(&scene, &options, threads));
        let calls = advance(&mut whole, u64::MAX);
        whole.write_part(&part).expect("a part can be written");
        advance(&mut first, calls / 2);
        first.save(&checkpoint).expect("a checkpoint can be written");
        assert_eq!(next.resume(&checkpoint).expect("a checkpoint can be read"), Resumed::Continues, "{kind}");
        advance(&mut next, u64::MAX);
        next.write_part(&other).expect("a part can be written");
        let read = |path| std::fs::read(path).expect("it was written");
        assert!(read(&part) == read(&other), "{kind}");
    }
}

#[test]
fn a_part_that_follows_a_plan_from_a_file_has_the_same_bytes() {
    let folder = tempfile::tempdir().expect("a folder");
    let [part, other] = ["a.part", "b.part"].map(|name| folder.path().join(name));
    for (kind, text, options, _) in kinds() {
        let scene = scene(&text);
        let shard = Shard::new(2, 3).expect("there is such a part");
        let alone = Options { shard, ..options };
        let planned = planned_once(kind, &scene, &alone, folder.path());
        for (options, path) in [(alone, &part), (planned, &other)] {
            let mut rendering = rendering(&scene, &options, 2);
            advance(&mut rendering, u64::MAX);
            rendering.write_part(path).expect("a part can be written");
        }
        let read = |path| std::fs::read(path).expect("it was written");
        assert!(read(&part) == read(&other), "{kind}");
    }
}

/// The expected duration of a part is proportional to its pixels.
#[test]
fn a_part_of_an_image_is_expected_to_take_a_part_of_the_time() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = GLASS.replace("width = 37, height = 21", "width = 370, height = 210");
    let scene = scene(&text.replace("seed = 3", "seed = 3, caustics = \"off\""));
    let options = planned(&scene, &Options { samples: Some(4), ..Options::default() }, folder.path());
    let expected = |options: &Options| rendering(&scene, options, 1).expected().as_secs_f64();
    let shard = Shard::new(2, 4).expect("there is such a part");
    let share = expected(&Options { shard, ..options.clone() }) / expected(&options);
    assert!((0.2..0.3).contains(&share), "{share}");
}

/// Renders to the end with some samples and resumes with a different number.
fn resume_with_samples(text: &str, options: &Options, samples: [u32; 2]) -> Result<(Image, Image, Resumed), Error> {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("image.checkpoint");
    let scene = scene(text);
    let [mut few, mut more, whole] = [samples[0], samples[1], samples[1]]
        .map(|n| rendering(&scene, &Options { samples: Some(n), ..options.clone() }, 2));
    advance(&mut few, u64::MAX);
    few.save(&path)?;
    let resumed = more.resume(&path)?;
    Ok((more.run(&|_| ()), whole.run(&|_| ()), resumed))
}

#[test]
fn more_samples_are_added_to_those_that_were_taken() {
    let layers =
        Options { layers: Some(vec![Layer::Variance, Layer::Lights, Layer::CryptoObject]), ..Options::default() };
    // More samples splat different photons.
    for (text, samples) in [(CAUSTIC, [16, 64]), (CAUSTIC, [32, 50]), (ROOM, [32, 100])] {
        let (image, whole, resumed) =
            resume_with_samples(text, &layers, samples).expect("there is a pass that ends there");
        assert!(is_same(&image, &whole) && resumed == Resumed::Continues, "{samples:?}");
    }
}

#[test]
fn samples_that_cannot_become_those_that_are_asked_for_are_refused() {
    let halves = Options { layers: Some(vec![Layer::HalfA]), ..Options::default() };
    for (text, options, samples, why) in [
        (CAUSTIC, Options::default(), [50, 64], "no pass that ends there"),
        (CAUSTIC, Options::default(), [50, 100], "no pass that ends there"),
        (CAUSTIC, halves, [16, 32], "half_a and half_b are halves of 16 samples"),
        // The radius of the photon map shrinks with more samples.
        (GLASS, Options::default(), [16, 32], "another plan"),
    ] {
        let refused = resume_with_samples(text, &options, samples).map(|_| ()).expect_err("it is refused");
        let Error::Arguments { message, help: Some(help) } = refused else { panic!("{refused}") };
        assert!(message.contains(why), "{samples:?}: {message}");
        // The render resumes with the number of samples that the message names.
        let named = format!("ask for {} samples per pixel, or delete it to start over", samples[0]);
        assert!(help == named || why == "another plan", "{samples:?}: {help}");
        assert_eq!(resume_with_samples(text, &options, [samples[0]; 2]).expect("it goes on").2, Resumed::Finished);
    }
}

#[test]
fn a_checkpoint_with_more_samples_than_are_asked_for_is_good_enough() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("image.checkpoint");
    let scene = scene(ROOM);
    let [mut many, mut few] =
        [64, 20].map(|n| rendering(&scene, &Options { samples: Some(n), ..Options::default() }, 2));
    advance(&mut many, u64::MAX);
    many.save(&path).expect("a checkpoint can be written");
    assert_eq!(few.resume(&path).expect("it can be read"), Resumed::HasMore(64));
}
