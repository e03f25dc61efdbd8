//! Adaptive sampling, which takes more samples where the noise is: when the plan asks for it, what it saves, and that
//! it changes no mean.
//!
//! ```text
//! cargo test --test all adaptive::
//! ```

use abbe::film::{Film, Window};
use abbe::plan::{Plan, plan};
use abbe::trace::{LightPass, Method, SampleDensity, Smoothness, Stop, World, adaptive, prepare, render};

use crate::support::scenes::{
    GROUND, SPLITTING, body, film_of, films_of, mean_and_variance, method, scene, sigma_limit, view,
};

/// Returns a scene of a floor below a point light, without noise, and a ball in front of a lamp, which is noisy.
fn partly_noisy(size: [u32; 2], samples: u32, render: &str) -> String {
    large_view(size)
        + &format!("[render]\nmodel = \"rgb\"\nsamples = {samples}\ndiffuse_bounces = 0\n{render}\n")
        + &body("floor", "diffuse = { reflectance = 0.6 }", &[GROUND])
        + &body("ball", "conductor = { n = 1, k = 5, roughness = 0.5 }", &[BALL])
        + &body("lamp", LAMP, &["quad = { center = [0, 1, 1.5], u = [0.3, 0, 0], v = [0, -0.3, 0] }"])
        + "[[light]]\npoint = { position = [1, 5, 4], intensity = 60 }\n"
}

fn large_view([width, height]: [u32; 2]) -> String {
    let small = view([0.0, 3.0, 6.0], [0.0, 0.5, 0.0], 50.0, 12);
    small.replace("width = 12\nheight = 12", &format!("width = {width}\nheight = {height}"))
}

const BALL: &str = "sphere = { center = [0, 0.6, 0], radius = 0.6 }";
const LAMP: &str = "emissive = { radiance = 5, sides = \"front\" }";

fn is_adaptive(text: &str) -> (bool, Plan) {
    let plan = plan(&scene(text));
    (plan.method.density.is_some(), plan)
}

/// Large images with uneven noise get uneven sample counts, and the plan says so. Small, even and noiseless images do
/// not.
#[test]
fn the_plan_asks_for_more_samples_where_the_noise_is() {
    let large = [256, 256];
    let (adaptive, decided) = is_adaptive(&partly_noisy(large, 64, ""));
    assert!(adaptive, "{:?}", decided.because);
    assert!(decided.because.iter().any(|line| line.starts_with("adaptive sampling")), "{:?}", decided.because);
    assert!(!is_adaptive(&partly_noisy(large, 64, "adaptive = \"off\"")).0, "off");
    assert!(!is_adaptive(&partly_noisy([64, 64], 64, "")).0, "too small");
    let furnace = large_view(large)
        + "[render]\nsamples = 64\n[[light]]\nenvironment = { radiance = 1 }\n"
        + &body("floor", "diffuse = { reflectance = 1 }", &[GROUND]);
    assert!(!is_adaptive(&furnace).0, "a furnace");
    // The number of samples of an image does not change how they are distributed.
    let measure = |samples| plan(&scene(&partly_noisy(large, samples, ""))).method.density;
    assert_eq!(measure(64), measure(256));
}

/// A lamp's light on a shadow catcher is noisy but not seen. Only bodies that block some of it make visible noise.
#[test]
fn light_on_shadow_catchers_asks_for_samples_only_where_there_are_shadows() {
    let noisy = |floor: &str, ball: &str| {
        let text = large_view([256, 256])
            + &body("lamp", LAMP, &["quad = { center = [0, 1, 1.5], u = [0.3, 0, 0], v = [0, -0.3, 0] }"])
            + ball
            + &body("floor", "diffuse = { reflectance = 0.6 }", &[GROUND])
            + floor;
        let scene = scene(&text);
        adaptive(&World::new(&scene, method(&scene, SPLITTING))).is_some()
    };
    let ball = body("ball", "diffuse = { reflectance = 0 }", &[BALL]);
    assert!(noisy("", ""));
    assert!(!noisy("shadow_catcher = true\n", ""));
    assert!(noisy("shadow_catcher = true\n", &ball));
}

/// The look traces at most 4096 cells and at least 16.
#[test]
fn fewer_cells_are_looked_at_where_samples_follow_many_rays() {
    let cells = |panes: u32| {
        let pane = |pane: u32| {
            format!("quad = {{ center = [0, 0.6, {}], u = [9, 0, 0], v = [0, 9, 0] }}", 0.1 * f64::from(pane))
        };
        let panes: Vec<String> = (0..panes).map(pane).collect();
        let panes: Vec<&str> = panes.iter().map(String::as_str).collect();
        let text = large_view([1024, 768])
            + &body("glass", "thin = { index = 1.8 }", &panes)
            + &body(
                "wall",
                "diffuse = { reflectance = 0.5 }",
                &["quad = { center = [0, 0, -9], u = [40, 0, 0], v = [0, 40, 0] }"],
            )
            + &body("lamp", LAMP, &["sphere = { center = [0, 20, 0], radius = 1 }"]);
        let scene = scene(&text);
        let [columns, rows] =
            adaptive(&World::new(&scene, method(&scene, SPLITTING))).expect("there is noise").density.cells;
        columns * rows
    };
    let (many, few) = (cells(1), cells(60));
    assert!((3968..=4096).contains(&many), "{many}");
    assert!(few < 2048 && few > 16, "{few}");
}

/// Returns sample rates that vary over an image of 12 x 12.
fn density() -> SampleDensity {
    let power = |cell: i32| (cell * 7 % 4) as i8 + SampleDensity::LEAST;
    SampleDensity { cells: [5, 4], powers: (0..20).map(power).collect() }
}

fn films(text: &str, density: Option<&SampleDensity>, change: impl Fn(Method) -> Method, seeds: u64) -> Vec<Film> {
    let scene = scene(text);
    let setup = change(Method { density: density.cloned(), ..method(&scene, SPLITTING) });
    films_of(&scene, &setup, 0..seeds)
}

/// Every pixel takes the number of samples of its cell, also if they are divided among replicates.
#[test]
fn every_pixel_takes_the_samples_of_its_cell() {
    let density = density();
    let stop =
        |method| Method { stop: Some(Stop { noise: None, time: None, min_samples: 64, max_samples: 64 }), ..method };
    for (name, film, each) in [
        ("one render", films(&partly_noisy([12, 12], 20, ""), Some(&density), |method| method, 1).remove(0), [20, 1]),
        ("replicates", films(&partly_noisy([12, 12], 20, ""), Some(&density), stop, 1).remove(0), [8, 8]),
        ("one sample", films(&partly_noisy([12, 12], 1, ""), Some(&density), |method| method, 1).remove(0), [1, 1]),
    ] {
        for (i, pixel) in (0..).zip(&film.pixels) {
            let [x, y] = [i % 12, i / 12];
            let power = density.powers[(y * 4 / 12 * 5 + x * 5 / 12) as usize];
            let expected = f64::from(each[1]) * (f64::from(each[0]) * f64::from(power).exp2()).ceil();
            assert_eq!(f64::from(pixel.samples), expected, "{name}: pixel {x}, {y}");
        }
    }
}

/// Quarters of images have the same means at any sample density, in one render and in replicates, with photons, light
/// vertices and a filter with negative lobes.
#[test]
fn the_density_of_samples_changes_no_mean() {
    const SEEDS: u64 = 24;
    type Change = fn(Method) -> Method;
    let vertices = |method| Method { light_vertices: true, ..method };
    let stop =
        |method| Method { stop: Some(Stop { noise: None, time: None, min_samples: 32, max_samples: 32 }), ..method };
    let plain: Change = |method| method;
    let photons = |method| Method {
        light_pass: Some(LightPass {
            photons: 4096,
            lights: vec![0, 1],
            openings: Vec::new(),
            to: vec![Smoothness::Whole],
            map: None,
        }),
        ..method
    };
    let sharp = partly_noisy([12, 12], 24, "").replace("height = 12", "height = 12\nfilter = \"mitchell\"");
    let lit_around = partly_noisy([12, 12], 24, "").replace("diffuse_bounces = 0", "diffuse_bounces = 2")
        + &body(
            "wall",
            "diffuse = { reflectance = 0.8 }",
            &["quad = { center = [0, 2, -2], u = [4, 0, 0], v = [0, 2, 0] }"],
        );
    let over_glass = partly_noisy([12, 12], 24, "")
        + &body("glass", "dielectric = { index = 1.5 }", &["sphere = { center = [0.9, 1.2, 0.8], radius = 0.4 }"]);
    let cases: [(&str, String, Change); 5] = [
        ("one render", partly_noisy([12, 12], 24, ""), plain),
        ("light vertices", lit_around, vertices),
        ("photons", over_glass, photons),
        ("replicates", partly_noisy([12, 12], 24, ""), stop),
        ("a filter", sharp, plain),
    ];
    for (name, text, change) in &cases {
        let [even, uneven] = [None, Some(density())].map(|density| films(text, density.as_ref(), change, SEEDS));
        if ["light vertices", "photons"].contains(name) {
            assert!(even[0] != films(text, None, plain, 1)[0], "{name}: it is another image");
        }
        for (quarter, band) in (0..4).flat_map(|quarter| (0..3).map(move |band| (quarter, band))) {
            let measure = |films: &[Film]| {
                let mean = |film: &Film| {
                    let inside = |i: &usize| (i % 12) / 6 + 2 * (i / 72) == quarter;
                    (0..144).filter(inside).map(|i| f64::from(film.pixels[i].rgb[band])).sum::<f64>() / 36.0
                };
                let (mean, variance) = mean_and_variance(films.iter().map(mean));
                (mean, variance / SEEDS as f64)
            };
            let [(a, variance_a), (b, variance_b)] = [measure(&even), measure(&uneven)];
            let off = (a - b).abs() / (variance_a + variance_b).sqrt();
            // Means of 24 films have the heavier tails of Student's t distribution.
            let bound = 1.2 * sigma_limit(12 * cases.len());
            assert!(off < bound, "{name}: quarter {quarter}, band {band}: {b} for {a}, off by {off:.1} sigma");
        }
    }
}

/// Parts of an image take the same samples as the whole. Pixels beyond the format take as many as the nearest pixel on
/// its edge.
#[test]
fn parts_of_an_image_take_the_samples_of_the_whole() {
    let (text, density) = (partly_noisy([12, 12], 6, ""), density());
    let whole = films(&text, Some(&density), |method| method, 1).remove(0);
    for (crop, overscan) in [(Some(Window { left: 5, top: 4, width: 3, height: 2 }), 0), (None, 3)] {
        let mut part = scene(&text);
        (part.film.crop, part.film.overscan) = (crop, abbe::film::Overscan::even(overscan));
        let setup = Method { density: Some(density.clone()), ..method(&part, SPLITTING) };
        let part = film_of(&part, setup);
        for (i, pixel) in (0_i32..).zip(&part.pixels) {
            let [x, y] = [part.corner[0] + i % part.width as i32, part.corner[1] + i / part.width as i32];
            let inside = (0..12).contains(&x) && (0..12).contains(&y);
            let same = whole.at(x.clamp(0, 11) as u32, y.clamp(0, 11) as u32);
            assert_eq!(pixel.samples, same.samples, "pixel {x}, {y}");
            assert!(!inside || pixel.rgb == same.rgb, "pixel {x}, {y}");
        }
    }
}

/// The plan saves as many rays as it says, judged by variances over images of many seeds. It may save more: evenly
/// spread samples gain more from their number than the plan assumes.
#[test]
fn the_plan_predicts_the_gain() {
    const SEEDS: u64 = 12;
    let text = partly_noisy([192, 144], 160, "");
    let (adaptive, Plan { method: decided, because, .. }) = is_adaptive(&text);
    assert!(adaptive, "{because:?}");
    let line = because.iter().find(|line| line.starts_with("adaptive")).expect("it is told");
    let predicted: f64 =
        line.split("about ").nth(1).and_then(|end| end.split(' ').next()).and_then(|x| x.parse().ok()).expect("a gain");
    let scene = scene(&text);
    let [even, uneven] = [None, decided.density.clone()].map(|density| {
        let of_seed = |seed| {
            let method = Method { seed, samples: 16, density: density.clone(), ..decided.clone() };
            render(&prepare(&scene, method), &|_| ())
        };
        let images: Vec<_> = (0..SEEDS).map(of_seed).collect();
        let rays = images.iter().map(|(_, report)| report.rays as f64).sum::<f64>();
        let scale = images[0].0.pixels.iter().map(|pixel| f64::from(pixel.rgb[1]).powi(2)).sum::<f64>() / 27_648.0;
        let error = |i: usize| {
            let (mean, variance) = mean_and_variance(images.iter().map(|(film, _)| f64::from(film.pixels[i].rgb[1])));
            variance / (mean * mean + 0.1 * scale)
        };
        rays * (0..27_648).map(error).sum::<f64>()
    });
    println!("the plan says {predicted} times as long, it is {:.2} times", even / uneven);
    assert!((0.75..2.0).contains(&(even / uneven / predicted)), "{} for {predicted}", even / uneven);
}
