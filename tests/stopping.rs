//! Renders that stop when their error is small enough, or when their time is over.
//!
//! `tools/stopping.py` compares many renders of larger scenes with references that find their light in another way.
//!
//! ```text
//! cargo test --test all stopping::
//! ```

use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Duration;

use abbe::film::{ExrFile, Layer, Shard};
use abbe::trace::{Method, Stopped};
use abbe::{Advance, Image, Options, Rendering, Resumed, Scene, render};

use crate::checkpoints::{CAUSTIC, GLASS, Kind, ROOM, advance, bytes, planned, rendering};
use crate::support::parallel::parallel_map;
use crate::support::random::Random;
use crate::support::scenes::scene;

fn stop_at(error: f64, most: u32) -> Options {
    Options { error: Some(error), samples: Some(most), ..Options::default() }
}

/// Returns scenes for all ways to find light.
fn kinds() -> [Kind; 3] {
    let splats = |method: &Method| method.light_pass.as_ref().is_some_and(|pass| pass.map.is_none());
    let gathers = |method: &Method| method.light_pass.as_ref().is_some_and(|pass| pass.map.is_some());
    let room = ROOM.replace("width = 21, height = 18", "width = 42, height = 36, filter = \"mitchell\"");
    let all = |error| Options { layers: Some(Layer::all()), spectral: true, ..stop_at(error, 256) };
    [
        ("photons that are shown, all layers", CAUSTIC.into(), all(0.5), splats),
        ("photons that are gathered", GLASS.into(), stop_at(0.3, 128), gathers),
        ("light vertices, a filter with negative lobes", room, stop_at(0.02, 256), |method| method.light_vertices),
    ]
}

#[test]
fn any_threads_and_stops_on_the_way_make_the_same_bytes() {
    let (folder, mut random) = (tempfile::tempdir().expect("a folder"), Random::new(5));
    let path = folder.path().join("image.checkpoint");
    for (kind, text, options, is_meant) in kinds() {
        let scene = scene(&text);
        let mut whole = rendering(&scene, &options, 2);
        assert!(is_meant(&whole.plan().method), "{kind}: {:?}", whole.plan().because);
        let calls = advance(&mut whole, u64::MAX);
        let (expected, report) = (bytes(&whole.image(), folder.path()), whole.image().report().clone());
        assert!(report.noise.is_some_and(|noise| noise.samples >= 64), "{kind}");
        let gathers = whole.plan().method.light_pass.as_ref().is_some_and(|pass| pass.map.is_some());
        assert_eq!(report.blur.is_some_and(|blur| blur.at_most > 0.0), gathers, "{kind}");
        let options = planned(&scene, &options, folder.path());
        for threads in [1, 3, 7] {
            let mut first = rendering(&scene, &options, threads);
            for _ in 0..2 {
                advance(&mut first, (random.number() * 0.6 * calls as f64) as u64);
                first.save(&path).expect("a checkpoint can be written");
                let mut next = rendering(&scene, &options, 9 - threads);
                let resumed = next.resume(&path).expect("a checkpoint can be read");
                assert!(!matches!(resumed, Resumed::HasMore(_)), "{kind}");
                assert_eq!(next.done(), first.done(), "{kind}");
                assert!(next.image().film() == first.image().film(), "{kind}");
                first = next;
            }
            let image = first.run(&|_| ());
            assert!(bytes(&image, folder.path()) == expected, "{kind}: {threads} threads");
            assert_eq!(*image.report(), report, "{kind}: {threads} threads");
        }
    }
}

#[test]
fn a_smaller_error_can_be_asked_for_later() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("image.checkpoint");
    let scene = scene(ROOM);
    let [mut rough, mut same, mut fine, whole] =
        [0.08, 0.1, 0.02, 0.02].map(|error| rendering(&scene, &stop_at(error, 8192), 2));
    advance(&mut rough, u64::MAX);
    rough.save(&path).expect("a checkpoint can be written");
    assert_eq!(same.resume(&path).expect("it can be read"), Resumed::Finished);
    assert!(same.image().film() == rough.image().film(), "the same error makes another film");
    assert_eq!(fine.resume(&path).expect("it can be read"), Resumed::Continues);
    let fine = fine.run(&|_| ());
    assert!(fine.report().samples > rough.image().report().samples);
    assert!(fine.film() == whole.run(&|_| ()).film(), "an error that is asked for later makes another film");
    // A checkpoint with more samples than a render may take is good enough for it.
    let mut few = rendering(&scene, &stop_at(0.02, 64), 2);
    let mut more = rendering(&scene, &stop_at(1e-6, 128), 2);
    advance(&mut more, u64::MAX);
    more.save(&path).expect("a checkpoint can be written");
    assert_eq!(few.resume(&path).expect("it can be read"), Resumed::HasMore(128));
    let mut plain = rendering(&scene, &Options { samples: Some(64), ..Options::default() }, 2);
    let refused = plain.resume(&path).expect_err("it is of another kind").to_string();
    assert!(refused.contains("its stop rule is error or time, not samples alone"), "{refused}");
}

/// Returns the squared difference of two images relative to the square of the second.
fn relative_squares(pixels: &[[f32; 3]], truth: &[[f64; 3]]) -> f64 {
    let squares = |x: f64| x * x;
    let pairs = pixels.iter().flatten().zip(truth.iter().flatten());
    let difference: f64 = pairs.map(|(&x, y)| squares(f64::from(x) - y)).sum();
    difference / truth.iter().flatten().map(|&x| squares(x)).sum::<f64>()
}

/// Returns a room for light vertices, which make noise that pixels share, under a lamp that few surfaces of the room
/// see.
fn small_room() -> Scene {
    let shaded = ROOM.replace("v = [0, 0, 0.4] }", "v = [0, 0, -0.4] }");
    scene(&shaded.replace("width = 21, height = 18", "width = 32, height = 32"))
}

/// Returns the mean of long renders without replicates and without light vertices, which images with so few samples do
/// not use. The second result is the square of the mean's own noise, relative to its square.
fn truth(scene: &Scene) -> (Vec<[f64; 3]>, f64) {
    const RENDERS: u64 = 12;
    let render_seed = |seed: u64| {
        let options = Options { samples: Some(225), seed: Some(1000 + seed), ..Options::default() };
        let rendering = Rendering::new(scene, &options).expect("it can be rendered");
        assert!(!rendering.plan().method.light_vertices);
        rendering.run(&|_| ()).rgb()
    };
    let images: Vec<Vec<[f32; 3]>> = parallel_map(RENDERS, render_seed);
    let mean = |pixel: usize| {
        [0, 1, 2].map(|i| images.iter().map(|image| f64::from(image[pixel][i])).sum::<f64>() / RENDERS as f64)
    };
    let truth: Vec<[f64; 3]> = (0..images[0].len()).map(mean).collect();
    let difference = |image: &Vec<[f32; 3]>| relative_squares(image, &truth);
    let noise = images.iter().map(difference).sum::<f64>() / (RENDERS * (RENDERS - 1)) as f64;
    (truth, noise)
}

#[test]
fn the_reported_noise_is_the_true_noise_and_the_bound_holds() {
    const RENDERS: u64 = 40;
    let scene = small_room();
    let (truth, noise_of_truth) = truth(&scene);
    let render_seed = |seed: u64| {
        let image = render(&scene, &Options { seed: Some(seed), ..stop_at(1e-6, 64) }).expect("it can be rendered");
        let noise = image.report().noise.expect("there are replicates");
        [
            relative_squares(&image.rgb(), &truth) - noise_of_truth,
            noise.expected * noise.expected,
            noise.at_most * noise.at_most,
        ]
    };
    let found: Vec<[f64; 3]> = parallel_map(RENDERS, render_seed);
    let difference: Vec<f64> = found.iter().map(|[true_error, reported, _]| true_error - reported).collect();
    let mean = difference.iter().sum::<f64>() / RENDERS as f64;
    let variance = difference.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (RENDERS - 1) as f64;
    let z = mean / (variance / RENDERS as f64).sqrt();
    let mean_reported = found.iter().map(|[_, reported, _]| reported).sum::<f64>() / RENDERS as f64;
    assert!(z.abs() < 4.0 && mean.abs() < 0.25 * mean_reported, "z = {z:.2}, {:.2} of the noise", mean / mean_reported);
    // The bound holds for 95 of 100. Fewer than 34 of 40 occur by chance once in 300 times.
    let within_bound = found.iter().filter(|[true_error, _, bound]| true_error <= bound).count();
    assert!(within_bound >= 34, "{within_bound} of {RENDERS}");
    // This rejects a bound that is far too wide, for which the test above would hold as well.
    let mut ratios: Vec<f64> = found.iter().map(|[true_error, _, bound]| (true_error / bound).sqrt()).collect();
    ratios.sort_by(f64::total_cmp);
    assert!(ratios[ratios.len() / 2] > 0.5, "median {:.2}", ratios[ratios.len() / 2]);
}

/// If the model of color is exact, all of the error is left for noise. Otherwise, at least as much is left as if the
/// model missed a third.
#[test]
fn the_error_that_the_model_of_color_does_not_use_is_left_for_noise() {
    for (model, is_exact) in [("", true), (", model = { bands = 8 }", false)] {
        let text = ROOM.replace("samples = 40", &format!("samples = 4096, error = 0.02{model}"));
        let plan = abbe::plan::plan(&scene(&text));
        let noise = plan.method.stop.and_then(|stop| stop.noise).expect("an error is asked for");
        assert_eq!(plan.model_error == 0.0, is_exact, "{}", plan.model_error);
        let left = (0.02_f64 * 0.02 - plan.model_error * plan.model_error).max(0.0).sqrt();
        assert!((noise - left.max(0.02 * (8.0_f64 / 9.0).sqrt())).abs() < 1e-12, "{noise}, model {}", plan.model_error);
    }
}

/// A lamp that covers a 256th of the pixel gives half of its light. In three of four renders, 64 samples miss it, and
/// all replicates are alike.
#[test]
fn an_image_of_one_pixel_does_not_end_before_a_small_lamp_is_found() {
    const RENDERS: u64 = 20;
    let scene = scene(
        "[camera]\nposition = [0, 0, 1]\nlook_at = [0, 0, 0]\nvertical_fov = 90\n[film]\nwidth = 1\nheight = 1\n\
         [material.lamp]\nemissive = { radiance = 257 }\n[[object]]\nmaterial = \"lamp\"\n\
         shape.quad = { center = [0.3, -0.4, 0], u = [0.0625, 0, 0], v = [0, 0.0625, 0] }\n\
         [[light]]\nenvironment = { radiance = 1 }\n",
    );
    let render_seed = |seed: u64| {
        let image = render(&scene, &Options { seed: Some(seed), ..stop_at(0.1, 65_536) }).expect("it can be rendered");
        (f64::from(image.rgb()[0][1]) - 2.0).abs() / 2.0
    };
    let off: Vec<f64> = parallel_map(RENDERS, render_seed);
    // The error holds for 95 of 100. More than 4 of 20 occur by chance once in 390 times.
    assert!(off.iter().filter(|&&off| off > 0.1).count() <= 4, "{off:?}");
}

/// Nothing but a shadow: the image is black, and only alpha shows anything. A disc blocks b^2 / (b^2 + k^2) of a lamp
/// that contributes a^2 / (a^2 + h^2), for radii and heights of the discs (Howell, Menguc, Daun & Siegel 2020, *Thermal
/// Radiation Heat Transfer*, configuration factor of an element parallel to a disk).
#[test]
fn the_reported_noise_of_alpha_under_a_shadow_catcher_is_true_and_a_render_ends_by_it() {
    const RENDERS: u64 = 40;
    let truth = (0.0625 / 1.0625) / 0.2;
    for filter in ["box", "mitchell"] {
        let scene = scene(&format!(
            "camera = {{ projection = \"orthographic\", height = 0.04, position = [0, 6, 0], look_at = [0, 0, 0], \
             up = [0, 0, -1] }}\nfilm = {{ width = 12, height = 12, filter = \"{filter}\" }}\n[material]\n\
             lamp.emissive.radiance = 5\ngray.diffuse.reflectance = 0.5\nblack.diffuse.reflectance = 0\n\
             [[object]]\nshape.disc = {{ center = [0, 2, 0], normal = [0, -1, 0], radius = 1 }}\nmaterial = \"lamp\"\n\
             visible_to_camera = false\n\
             [[object]]\nshape.disc = {{ center = [0, 1, 0], normal = [0, 1, 0], radius = 0.25 }}\n\
             material = \"black\"\nvisible_to_camera = false\n\
             [[object]]\nshape.plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}\nmaterial = \"gray\"\n\
             shadow_catcher = true\n"
        ));
        let render_seed = |seed: u64| {
            let image =
                render(&scene, &Options { seed: Some(seed), ..stop_at(0.02, 4096) }).expect("it can be rendered");
            let error = image.error().expect("there are replicates").clone();
            assert!(error.is_reached() && error.noise.at_most == 0.0 && error.noise.samples > 64, "{error:?}");
            let alpha = image.layer("A").expect("every image has it");
            let square = |alpha: &f32| (f64::from(*alpha) / truth - 1.0).powi(2);
            let reported = error.alpha.expect("there is a shadow catcher");
            [
                alpha.iter().map(square).sum::<f64>() / alpha.len() as f64,
                reported.expected.powi(2),
                reported.at_most.powi(2),
            ]
        };
        let found: Vec<[f64; 3]> = parallel_map(RENDERS, render_seed);
        let mean = |i: usize| found.iter().map(|numbers| numbers[i]).sum::<f64>() / RENDERS as f64;
        assert!((mean(0) / mean(1) - 1.0).abs() < 0.1, "{filter}: {:e} is told as {:e}", mean(0), mean(1));
        let within_bound = found.iter().filter(|[true_error, _, bound]| true_error <= bound).count();
        assert!(within_bound >= 34, "{filter}: {within_bound} of {RENDERS}");
        assert!(found.iter().all(|[_, _, bound]| (0.01..=0.02).contains(&bound.sqrt())), "{filter}");
    }
}

/// Noise, blur and the noise of alpha, each in a scene that has it.
#[test]
fn a_file_records_what_is_known_of_its_error() {
    let camera = "camera = { position = [0, 4, 4], look_at = [0, 0, 0], vertical_fov = 30 }\n\
                  film = { width = 16, height = 16 }\n[material]\nlamp.emissive.radiance = 5\n\
                  gray.diffuse.reflectance = 0.5\nwater.dielectric.index = 1.33\n\
                  [[object]]\nshape.disc = { center = [0.5, 4, 0], normal = [0, -1, 0], radius = 0.3 }\nmaterial = \"lamp\"\n\
                  [[object]]\nshape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }\nmaterial = \"gray\"\n";
    let water = "[[object]]\nshape.cube = { center = [0, 0.5, 0], size = [4, 1.2, 4] }\nmaterial = \"water\"\n";
    let shadow = "shadow_catcher = true\n[[object]]\nshape.sphere = { center = [0, 0.5, 0], radius = 0.5 }\nmaterial = \"gray\"\n";
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.exr");
    for (what, blurs, has_shadow) in [(water, true, false), (shadow, false, true)] {
        let image = render(&scene(&format!("{camera}{what}")), &stop_at(0.5, 256)).expect("it can be rendered");
        image.write_exr(&path).expect("it can be written");
        let (error, file) = (image.error().expect("it has a stop rule"), ExrFile::read(&path).expect("it was written"));
        let fact = |name: &str| file.attribute(&format!("render/{name}")).map(str::to_owned);
        let number = |name: &str| fact(name).map(|text| text.parse::<f64>().expect("a number"));
        assert_eq!(number("errorAtMost"), Some(error.at_most()));
        assert_eq!(number("noise"), Some(error.noise.expected));
        assert_eq!(number("modelError"), Some(error.model));
        assert_eq!(number("blur"), blurs.then_some(error.blur.expected));
        assert_eq!(number("alphaNoise"), error.alpha.map(|alpha| alpha.expected));
        assert_eq!((error.blur.expected > 0.0, error.alpha.is_some()), (blurs, has_shadow), "{error:?}");
        assert!(error.noise.expected > 0.0 && error.alpha.is_none_or(|alpha| alpha.expected > 0.0), "{error:?}");
    }
}

#[test]
fn light_that_only_one_of_eight_replicates_finds_is_reported_and_ends_no_render_early() {
    // A glossy ball throws the light of a tiny lamp onto the floor, where only random paths find it.
    let text = r#"
render.caustics = "off"
camera = { position = [0, 3, 5], look_at = [0, 0, 0], vertical_fov = 30 }
film = { width = 64, height = 64 }
[material]
floor.diffuse.reflectance = 0.8
steel.conductor = { metal = "Ag", roughness = 0.02 }
lamp.emissive.radiance = 4e5
[[object]]
shape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }
material = "floor"
[[object]]
shape.sphere = { center = [0, 1, 0], radius = 0.4 }
material = "steel"
[[object]]
shape.sphere = { center = [0, 3, -1], radius = 0.01 }
material = "lamp"
"#;
    let scene = scene(text);
    let reported = |seed: u64| {
        let stop_at = |error: f64| {
            let image =
                render(&scene, &Options { seed: Some(seed), ..stop_at(error, 128) }).expect("it can be rendered");
            let (error, samples) = (image.error().expect("there are replicates").clone(), image.report().samples);
            (image, error, samples)
        };
        let (image, error, samples) = stop_at(0.02);
        error.noise.outlier.map(|outlier| {
            let (noise, share) = (error.noise, outlier.share);
            // Light that only one replicate found may be missing almost five times elsewhere.
            assert!(share > 0.1 && noise.at_most > 4.74 * share.sqrt() * noise.expected, "{error:?}");
            assert!(
                !error.is_reached() && image.warnings().iter().any(|reported| reported.contains("no other did")),
                "{error:?}"
            );
            let larger = 1.5 * error.at_most();
            assert!(larger >= 1.0 || stop_at(larger).1.is_reached(), "{error:?}");
            let light = error.rare_light.as_ref().expect("a sample met it");
            assert!(light.name.as_deref() == Some("object 3") && light.bounces > 0, "{light:?}");
            assert_eq!((error.stopped_by, samples), (Some(Stopped::Samples), 128 * 64 * 64));
            // The pixel is a bright one.
            let [x, y] = outlier.pixel.map(|place| place as u32);
            assert!(image.rgb_at(x, y)[0] > 1.3 * image.rgb_at((x + 8) % 64, y)[0], "{error:?}");
        })
    };
    let found: Vec<_> = parallel_map(24, reported);
    let outliers: Vec<_> = found.iter().flatten().collect();
    assert!(outliers.len() >= 4, "{} of 24 renders met it", outliers.len());
}

/// A speck gives all light that the pixel shows. The catcher behind it is as bright, but shows none.
#[test]
fn rare_light_beside_shadow_catchers_is_reported_however_bright_they_are() {
    let scene = scene(
        "camera = { position = [0, 0, 5], look_at = [0, 0, 0], vertical_fov = 30 }\n\
         film = { width = 16, height = 16 }\n\
         [material]\nwall.diffuse.reflectance = 0.8\nlamp.emissive.radiance = 100\n\
         [[object]]\nshape.quad = { center = [0, 0, -1], u = [9, 0, 0], v = [0, 9, 0] }\n\
         material = \"wall\"\nshadow_catcher = true\n\
         [[object]]\nname = \"speck\"\nshape.sphere = { center = [0, 0, 0], radius = 0.012 }\nmaterial = \"lamp\"\n\
         [[light]]\nenvironment.radiance = 100\n",
    );
    let reported = |seed: u64| {
        let image = render(&scene, &Options { seed: Some(seed), ..stop_at(0.9, 64) }).expect("it can be rendered");
        let error = image.error().expect("there are replicates").clone();
        error.noise.outlier.map(|_| error.rare_light.map(|light| (light.name, light.bounces)))
    };
    let found: Vec<_> = (0..6).filter_map(reported).collect();
    assert!(found.len() >= 3, "{found:?}");
    assert!(found.iter().all(|light| *light == Some((Some("speck".into()), 0))), "{found:?}");
}

#[test]
fn the_first_of_error_time_and_samples_ends_a_render() {
    let scene = scene(ROOM);
    let ends = |options: Options| {
        let image = render(&scene, &options).expect("it can be rendered");
        let samples = image.report().samples / (21 * 18);
        (image.error().and_then(|error| error.stopped_by), samples)
    };
    let in_time = |millis: u64| Options { time: Some(Duration::from_millis(millis)), ..Options::default() };
    assert_eq!(ends(stop_at(0.9, 4096)), (Some(Stopped::Noise), 64));
    assert_eq!(ends(stop_at(1e-6, 100)), (Some(Stopped::Samples), 96));
    // There are at least eight samples. With so few, the error is not reported.
    assert_eq!(ends(in_time(1)), (None, 8));
    let (by, samples) = ends(Options { samples: Some(64), ..in_time(3_600_000) });
    assert_eq!((by, samples), (Some(Stopped::Samples), 64));
    let (by, _) = ends(Options { error: Some(0.9), ..in_time(3_600_000) });
    assert_eq!(by, Some(Stopped::Noise));
    // Fewer than 64 samples give no error.
    assert_eq!(ends(stop_at(0.9, 40)), (None, 40));
}

#[test]
fn a_render_that_ends_at_the_first_look_says_what_it_measured_and_a_later_one_no_less_than_was_asked_for() {
    let at_most = |options: Options| {
        let image = render(&scene(ROOM), &options).expect("it can be rendered");
        let error = image.error().expect("it has a stop rule").clone();
        assert_eq!(error.stopped_by, Some(Stopped::Noise));
        (error.noise.samples, error.at_most(), error.noise.at_most.hypot(error.blur.at_most).hypot(error.model))
    };
    let (samples, first, measured) = at_most(stop_at(0.9, 4096));
    assert!(samples == 64 && first == measured && first < 0.5, "{first}");
    let requested = 0.7 * first;
    let (samples, later, measured) = at_most(stop_at(requested, 4096));
    assert!(samples > 64 && measured <= requested && later == requested, "{later} for {requested}");
}

#[test]
fn how_much_there_is_to_do_is_known_at_the_first_look_and_is_the_most_there_may_be_before() {
    let mut rendering = Rendering::new(&scene(ROOM), &stop_at(0.05, 4096)).expect("it can be rendered");
    let all = rendering.work();
    assert!(!rendering.is_work_known() && all >= 4096 * 21 * 18, "{all}");
    let mut before = 0.0;
    while rendering.advance(&|_| ()) {
        let share = rendering.done() as f64 / rendering.work() as f64;
        assert_eq!(rendering.is_work_known(), rendering.error().is_some());
        assert!(share >= before || rendering.is_work_known(), "{share} after {before}");
        before = share;
    }
    assert!(rendering.is_work_known() && rendering.work() == rendering.done());
}

#[test]
fn an_image_without_noise_has_none_and_its_halves_and_variance_are_of_replicates() {
    let black = scene(&ROOM.replace("radiance.rgb = [9, 8, 6]", "radiance = 1e-300"));
    let image = render(&black, &stop_at(1e-6, 128)).expect("it can be rendered");
    assert!(image.error().is_some_and(|error| error.noise.samples == 64), "{:?}", image.error());
    let layers = Some(vec![Layer::HalfA, Layer::HalfB, Layer::Variance]);
    for text in [CAUSTIC, ROOM] {
        let options = Options { layers: layers.clone(), ..stop_at(1e-6, 128) };
        let image = render(&scene(text), &options).expect("it can be rendered");
        let layer = |name: &str| image.layer(name).expect("it was asked for");
        let (mut difference, mut variance) = (0.0, 0.0);
        for name in ["R", "G", "B"] {
            let [a, b, reported, both] =
                [format!("half_a.{name}"), format!("half_b.{name}"), format!("variance.{name}"), name.into()]
                    .map(|name| layer(&name));
            for pixel in 0..both.len() {
                let [a, b, reported, both] = [&a, &b, &reported, &both].map(|values| f64::from(values[pixel]));
                assert!((0.5 * (a + b) - both).abs() <= 1e-6 * (both.abs() + 1e-6), "{a} {b} {both}");
                difference += 0.25 * (a - b) * (a - b);
                variance += reported;
            }
        }
        // Over all pixels, halves and replicates give the same variance.
        assert!((difference / variance - 1.0).abs() < 0.35, "{difference} {variance}");
    }
}

/// Returns the mean of the red, green and blue of a layer or of the image.
fn mean(image: &Image, layer: &str) -> f64 {
    let channels = ["R", "G", "B"].map(|name| image.layer(&format!("{layer}{name}")).expect("it was asked for"));
    let values = channels.iter().flatten();
    values.map(|&value| f64::from(value)).sum::<f64>()
        / channels.map(|values| values.len()).iter().sum::<usize>() as f64
}

/// An unfinished image shows the light of photons as bright as it will be, also while they are being sent, and while
/// some replicates have more samples than others, or none.
#[test]
fn on_the_way_caustics_are_as_bright_as_in_the_end_and_so_are_halves_and_variance() {
    const PIXELS: u64 = 148 * 84;
    let text = CAUSTIC.replace("width = 37, height = 21", "width = 148, height = 84");
    let layers = Some(vec![Layer::Caustics, Layer::HalfA, Layer::HalfB, Layer::Variance]);
    let mut rendering = rendering(&scene(&text), &Options { layers, ..stop_at(1e-6, 96) }, 2);
    let (mut looks, mut samples) = (Vec::new(), 0);
    loop {
        // A few batches as long as photons are sent, then many pixels at once.
        let (calls, most) = (AtomicU64::new(0), if samples % PIXELS == 0 { 3 } else { 6000 });
        if rendering.advance_until(&|_| (), &|| calls.fetch_add(1, Ordering::Relaxed) >= most) == Advance::Finished {
            break;
        }
        let image = rendering.image();
        samples = image.report().samples;
        if samples >= PIXELS {
            let means = ["caustics.", "half_a.", "half_b.", "variance."].map(|layer| mean(&image, layer));
            looks.push((samples, means));
        }
    }
    let image = rendering.image();
    let [caustics, light, variance] = ["caustics.", "", "variance."].map(|layer| mean(&image, layer));
    assert!(looks.iter().filter(|(samples, _)| samples % PIXELS == 0).count() > 32, "{}", looks.len());
    for (samples, [shown, a, b, noise]) in looks {
        let samples_per_pixel = samples as f64 / PIXELS as f64;
        let [shown, a, b, noise] =
            [shown / caustics, a / light, b / light, noise * samples_per_pixel / variance / 96.0];
        assert!((shown - 1.0).abs() < 0.02, "{samples_per_pixel} samples: {shown} times the caustics");
        assert!(samples_per_pixel < 8.0 || (a - 1.0).abs() < 0.02, "{samples_per_pixel} samples: {a} times the light");
        assert!(samples_per_pixel < 40.0 || (b - 1.0).abs() < 0.02, "{samples_per_pixel} samples: {b} times the light");
        assert!(
            samples_per_pixel < 24.0 || (0.7..1.4).contains(&noise),
            "{samples_per_pixel} samples: {noise} times the variance"
        );
    }
}

#[test]
fn however_long_it_may_take_the_work_is_known() {
    let options = Options { time: Some(Duration::from_secs(1 << 40)), samples: Some(256), ..Options::default() };
    let mut rendering = rendering(&scene(ROOM), &options, 2);
    while rendering.advance(&|_| ()) {
        assert_eq!(rendering.work(), 256 * 21 * 18);
    }
}

#[test]
fn a_time_for_less_samples_than_it_may_end_after_says_so() {
    let reported = |options: Options| {
        let rendering = Rendering::new(&scene(ROOM), &options).expect("it can be rendered");
        rendering.plan().because.iter().find(|line| line.starts_with("takes all")).cloned()
    };
    let in_time = Options { time: Some(Duration::from_secs(3600)), samples: Some(4), ..Options::default() };
    assert_eq!(reported(in_time).as_deref(), Some("takes all 4 samples: a time limit never ends a render before 8"));
    assert_eq!(
        reported(stop_at(0.1, 40)).as_deref(),
        Some("takes all 40 samples: the error cannot be estimated from fewer than 64")
    );
}

#[test]
fn parts_take_all_samples_and_say_so() {
    let text = scene(ROOM);
    let shard = Shard::new(1, 2).expect("there is such a part");
    let refused = Rendering::new(&text, &Options { shard, error: Some(0.1), ..Options::default() });
    let message = refused.map(|_| ()).expect_err("no part tells the error of the whole").to_string();
    assert!(message.contains("shows neither the error of the whole nor how many"), "{message}");
    let part = Rendering::new(&text, &Options { shard, ..stop_at(0.1, 128) }).expect("so many samples are taken");
    assert!(part.plan().method.stop.is_none() && part.plan().method.samples == 128);
    assert!(part.plan().because.iter().any(|line| line.starts_with("takes all 128 samples")));
}

/// Three numbers miss the color of paint under a fluorescent lamp by more than the error. Noise is not all that counts.
#[test]
fn an_error_that_the_model_of_color_alone_exceeds_is_not_reached() {
    let text = "camera = { position = [0, 0, 4], look_at = [0, 0, 0], vertical_fov = 40 }\n\
        film = { width = 8, height = 8 }\nrender.model = \"rgb\"\n\
        material.paint.diffuse.reflectance = \"blue sky\"\nlight = [{ environment.radiance = { illuminant = \"FL11\" } }]\n\
        object = [{ shape.sphere = { center = [0, 0, 0], radius = 1 }, material = \"paint\" }]\n";
    let image = render(&scene(text), &stop_at(0.003, 1 << 14)).expect("it can be rendered");
    let error = image.error().expect("it was measured");
    assert!(error.model > 0.003 && error.stopped_by == Some(Stopped::Noise) && !error.is_reached(), "{error:?}");
    let reported = image.warnings().join("\n");
    assert!(reported.contains("is not reached: the model of color alone may be off by"), "{reported}");
}
