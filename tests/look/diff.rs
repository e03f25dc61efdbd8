use abbe::film::ExrFile;
use abbe::look::{Difference, compare};
use abbe::plan::plan;
use abbe::{Options, Scene};

use super::files::{Exr, ramp};
use crate::support::pictures::read_png;
use crate::support::run::{Answer, Folder, render};
use crate::support::scenes::{films_of, mean_and_variance, scene};

/// A lamp above matte balls: noise in nearly every pixel, and a sky without noise.
const SCENE: &str = r#"
camera = { position = [0, 1, 6], look_at = [0, 1, 0], vertical_fov = 35 }
film = { width = 32, height = 24 }
material.white.diffuse = { reflectance = 0.7 }
material.lamp.emissive = { radiance = 20 }
[[object]]
shape.sphere = { center = [0, 1, 0], radius = 1 }
material = "white"
[[object]]
shape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }
material = "white"
[[object]]
shape.sphere = { center = [2, 4, 1], radius = 0.5 }
material = "lamp"
[[light]]
environment = { radiance = 0.2 }
"#;
const COLORS: [&str; 3] = ["R", "G", "B"];
const VARIANCES: [&str; 3] = ["variance.R", "variance.G", "variance.B"];

/// Returns the mean of 16 renders of 2 samples each, with its variance from their spread.
fn with_variance(first_seed: u64) -> Exr {
    let mut scene = scene(SCENE);
    scene.render.samples = Some(2);
    let films = films_of(&scene, &plan(&scene).method, first_seed..first_seed + 16);
    let count = films[0].pixels.len();
    let (mut means, mut variances) = (vec![vec![0.0; count]; 3], vec![vec![0.0; count]; 3]);
    for channel in 0..3 {
        for pixel in 0..count {
            let (mean, variance) =
                mean_and_variance(films.iter().map(|film| f64::from(film.pixels[pixel].rgb[channel])));
            means[channel][pixel] = mean as f32;
            variances[channel][pixel] = (variance / 16.0) as f32;
        }
    }
    let mut channels: Vec<_> = COLORS.into_iter().zip(means).collect();
    channels.extend(VARIANCES.into_iter().zip(variances));
    channels.push(("samples.V", vec![16.0; count]));
    Exr::new([32, 24], channels)
}

/// Returns an even gray of 20 x 10 pixels with a known variance, except in the last row, which has none.
fn gray() -> Exr {
    let mut channels: Vec<_> = COLORS.map(|name| (name, vec![0.5; 200])).to_vec();
    let variance: Vec<f32> = (0..200).map(|i| if i < 180 { 1e-4 } else { 0.0 }).collect();
    channels.extend(VARIANCES.map(|name| (name, variance.clone())));
    Exr::new([20, 10], channels)
}

fn diff(folder: &Folder, a: &Exr, b: &Exr, more: &[&str]) -> Answer {
    folder.write("a.exr", a.bytes());
    folder.write("b.exr", b.bytes());
    render(folder, &[&["diff", "a.exr", "b.exr"], more].concat())
}

fn difference(a: &Exr, b: &Exr) -> Difference {
    let folder = Folder::new();
    diff(&folder, a, b, &[]);
    let [a, b] = ["a.exr", "b.exr"].map(|name| ExrFile::read(folder.path_of(name)).expect("an image"));
    compare([&a, &b], None, ["a.exr", "b.exr"]).expect("they can be compared")
}

fn assert_says(answer: &Answer, code: i32, lines: &[&str]) {
    assert_eq!((answer.code, &*answer.stderr), (Some(code), ""), "{}", answer.stdout);
    let printed = answer.stdout.lines().map(|line| line.split_whitespace().collect::<Vec<_>>().join(" "));
    let printed: Vec<String> = printed.collect();
    for line in lines {
        assert!(printed.iter().any(|found| found.starts_with(line)), "{line:?} is not in\n{}", answer.stdout);
    }
}

#[test]
fn renders_of_a_scene_with_other_seeds_agree_and_one_of_a_brighter_lamp_does_not() {
    let (folder, [a, mut b]) = (Folder::new(), [with_variance(0), with_variance(100)]);
    let noise = difference(&a, &b).noise.expect("both files say their variance");
    assert!(noise.worst != 0.0 && noise.agrees(), "{noise:?}");
    assert_says(&diff(&folder, &a, &b, &[]), 0, &["a.exr and b.exr agree", "relMSE ", "z worst "]);
    // One percent more light is far below the noise of a pixel, but above that of the image's mean.
    for name in COLORS {
        b.channel(name).iter_mut().for_each(|x| *x *= 1.01);
    }
    let noise = difference(&a, &b).noise.expect("both files say their variance");
    assert!(noise.means.iter().all(|z| *z < -noise.threshold), "{noise:?}");
    assert_says(&diff(&folder, &a, &b, &[]), 1, &["a.exr and b.exr differ"]);
}

#[test]
fn a_pixel_that_is_ten_standard_deviations_off_is_found() {
    let folder = Folder::new();
    let (a, mut b) = (gray(), gray());
    // Ten times the deviation sqrt(1e-4 + 1e-4) of a difference, in green of pixel (7, 3).
    b.channel("G")[67] -= 10.0 * 2e-4_f32.sqrt();
    let noise = difference(&a, &b).noise.expect("both files say their variance");
    assert!((noise.worst - 10.0).abs() < 1e-4 && noise.worst_place == [67, 1] && noise.beyond == 1, "{noise:?}");
    // 540 values: 1 - 0.99^(1/540) is 1.8612e-5, whose two-sided quantile is 4.281.
    assert!((noise.threshold - 4.281).abs() < 2e-3, "{noise:?}");
    let lines = [
        "a.exr and b.exr differ",
        "z worst 10.0 in G of (7, 3), chance explains up to 4.3; 1 above that",
        "worst pixel (7, 3): 0.5 0.5 0.5 and 0.5 0.35858 0.5",
    ];
    assert_says(&diff(&folder, &a, &b, &[]), 1, &lines);
    // Photons that many samples share add noise that is only partly stated.
    let mut gathered = b.clone();
    gathered.texts.push(("render/photonRadius", "4.000 pixels".into()));
    assert_says(
        &diff(&folder, &a, &gathered, &[]),
        1,
        &["a.exr and b.exr differ", "photon map its noise is only partly known"],
    );
    // Four deviations are within the largest of so many values by chance.
    b.channel("G")[67] = 0.5 - 4.0 * 2e-4_f32.sqrt();
    assert_says(&diff(&folder, &a, &b, &[]), 0, &["a.exr and b.exr agree"]);
}

#[test]
fn it_is_the_same_where_layers_are_parts_of_their_own() {
    let (a, mut b) = (gray(), gray());
    b.channel("R")[5] += 0.5;
    let channels = b.parts[0].1.clone();
    let (colors, variances) = channels.into_iter().partition(|(name, _)| COLORS.contains(name));
    b.parts = vec![("beauty", colors), ("variance", variances)];
    let noise = difference(&a, &b).noise.expect("both files say their variance");
    assert_eq!((noise.worst_place, noise.beyond, noise.changed), ([5, 0], 1, 0));
}

#[test]
fn few_samples_estimate_their_own_spread_badly() {
    let with_samples = |image: &Exr, count: f32| {
        let mut image = image.clone();
        image.parts[0].1.push(("samples.V", vec![count; 200]));
        image
    };
    let (a, mut b) = (gray(), gray());
    b.channel("G")[67] += 6.0 * 2e-4_f32.sqrt();
    for (count, agree) in [(4.0, true), (1000.0, false)] {
        let noise = difference(&with_samples(&a, count), &with_samples(&b, count)).noise.expect("variance");
        assert_eq!(noise.agrees(), agree, "{count}: {noise:?}");
    }
}

/// A glowing disc, of which only the edge is noisy. All samples of a pixel there may agree by chance. With a stop rule,
/// the variance is that of eight renders, whose samples are so evenly spread that they may differ by one.
#[test]
fn edges_agree_whatever_tells_their_variance() {
    let scene = Scene::parse(
        "camera = { position = [0, 0, 5], look_at = [0, 0, 0], vertical_fov = 40 }\n\
         film = { width = 40, height = 30, layers = [\"variance\"] }\nmaterial.lamp.emissive.radiance = 1\n\
         [[object]]\nshape.disc = { center = [0, 0, 0], normal = [0, 0, 1], radius = 1.2 }\nmaterial = \"lamp\"\n",
        "",
    )
    .expect("a scene");
    let folder = Folder::new();
    let file = |seed: u64, options: Options| {
        let path = folder.path_of(format!("{seed}.exr"));
        let image = abbe::render(&scene, &Options { seed: Some(seed), ..options }).expect("an image");
        image.write_exr(&path).expect("the folder takes files");
        ExrFile::read(&path).expect("an image")
    };
    let few = |seed: u64| file(seed, Options { samples: Some(16), ..Options::default() });
    let enough = |seed: u64| file(seed, Options { error: Some(0.003), ..Options::default() });
    for seed in 0..12 {
        for [a, b] in [[few(seed), enough(seed + 100)], [enough(seed + 200), enough(seed + 300)]] {
            let noise = compare([&a, &b], None, ["a", "b"]).expect("they can be compared").noise.expect("variance");
            assert!(noise.agrees(), "{seed}: {noise:?}");
        }
    }
}

/// Glass under a uniform sky: most samples of a pixel are nearly the same. A few samples without a rare different one
/// show a thousandth of the variance.
#[test]
fn glass_agrees_with_itself_however_few_samples_there_are() {
    let scene = Scene::parse(
        "camera = { position = [3, 2, 4], look_at = [0, 0, 0], vertical_fov = 25 }\n\
         film = { width = 60, height = 40, layers = [\"variance\"] }\nmaterial.glass.dielectric.index = 1.5\n\
         light = [{ environment.radiance = 1 }]\n[[object]]\nmaterial = \"glass\"\n\
         shape.cube = { center = [0, 0, 0], size = 1.4 }\ntransform = [{ rotate = { axis = [1, 2, 3], degrees = 40 } }]\n",
        "",
    )
    .expect("a scene");
    let folder = Folder::new();
    let file = |samples: u32, seed: u64| {
        let path = folder.path_of("image.exr");
        let options = Options { samples: Some(samples), seed: Some(seed), ..Options::default() };
        abbe::render(&scene, &options).expect("an image").write_exr(&path).expect("the folder takes files");
        ExrFile::read(&path).expect("an image")
    };
    let differ = |samples: u32, seed: u64| {
        let [a, b] = [seed, seed + 1000].map(|seed| file(samples, seed));
        let noise = compare([&a, &b], None, ["a", "b"]).expect("they can be compared").noise.expect("variance");
        !noise.agrees()
    };
    let alarms = [4, 8, 16, 32].map(|samples| (0..20).filter(|&seed| differ(samples, seed)).count());
    println!("false alarms of 20 at 4, 8, 16 and 32 samples: {alarms:?}");
    // Each has a false alarm with a chance of at most one in a hundred. More than three of 80 occur by chance once in
    // 100 times.
    assert!(alarms.iter().sum::<usize>() <= 3, "{alarms:?}");
}

#[test]
fn values_without_variance_differ_only_beyond_rounding() {
    let (a, mut b) = (gray(), gray());
    b.channel("R")[190] = 0.5 * (1.0 + 5e-6);
    assert!(difference(&a, &b).agrees(None));
    b.channel("R")[190] = 0.5 * (1.0 + 2e-5);
    let noise = difference(&a, &b).noise.expect("variance");
    assert!(noise.changed == 1 && !noise.agrees());
    // A variance that is NaN counts as missing and hides nothing.
    let mut c = gray();
    c.channel("variance.R")[190] = f32::NAN;
    c.channel("R")[190] = 0.6;
    assert!(!difference(&a, &c).agrees(None));
}

/// A shadow pass has nothing but alpha.
#[test]
fn images_whose_alpha_alone_differs_do_not_agree() {
    let folder = Folder::new();
    let with_alpha = |alpha: f32| {
        let mut image = gray();
        image.parts[0].1.push(("A", vec![alpha; 200]));
        image
    };
    let (a, b) = (with_alpha(0.3), with_alpha(0.7));
    // 0.4^2 / (0.7^2 + 0.01).
    let lines = ["a.exr and b.exr differ", "alpha up to 0.4 apart, relMSE 0.32; its noise is unknown"];
    assert_says(&diff(&folder, &a, &b, &[]), 1, &lines);
    assert_says(&diff(&folder, &a, &b, &["--tolerance", "0.1"]), 1, &lines);
    assert_says(&diff(&folder, &a, &b, &["--tolerance", "0.4"]), 0, &["a.exr and b.exr agree"]);
    // If the colors differ by their noise, noise in alpha is allowed as well.
    let mut noisy = b.clone();
    noisy.channel("G")[67] += 2e-4_f32.sqrt();
    assert_says(&diff(&folder, &a, &noisy, &[]), 0, &["a.exr and b.exr agree", "alpha up to 0.4 apart"]);
    let same = diff(&folder, &a, &a, &[]);
    assert_eq!((same.code, &*same.stdout), (Some(0), "a.exr and b.exr agree: all values are equal\n"));
}

/// In a half-covered pixel, four samples are all empty and four others all full in 2 of 256 cases. No image of 200
/// pixels has more than 100 times the 1.6 pixels that this makes.
#[test]
fn alpha_that_is_empty_here_and_full_there_is_no_noise() {
    let folder = Folder::new();
    let [told_apart, unknown] = ["more than chance explains", "its noise is unknown"];
    for (samples, opposite, code, verdict) in
        [("4", 157, 1, told_apart), ("4", 156, 0, unknown), ("16", 1, 1, told_apart), ("", 200, 0, unknown)]
    {
        let with_alpha = |alpha: fn(usize) -> f32, opposite: usize| {
            let mut image = gray();
            image.texts.extend((!samples.is_empty()).then(|| ("render/samples", samples.to_owned())));
            image.parts[0]
                .1
                .push(("A", (0..200).map(|i| if i < opposite { 1.0 - alpha(i) } else { alpha(i) }).collect()));
            image
        };
        let alpha = |i: usize| (i % 2) as f32;
        let (a, mut b) = (with_alpha(alpha, 0), with_alpha(alpha, opposite));
        b.channel("G")[67] += 1e-3;
        let answer = diff(&folder, &a, &b, &[]);
        assert!(
            answer.code == Some(code) && answer.stdout.contains(verdict),
            "{samples}, {opposite}: {}",
            answer.stdout
        );
    }
}

#[test]
fn without_variance_equality_or_a_tolerance_decides() {
    let folder = Folder::new();
    let (a, mut b) = (ramp(), ramp());
    let equal = diff(&folder, &a, &b, &[]);
    assert_eq!((equal.code, &*equal.stdout), (Some(0), "a.exr and b.exr agree: all values are equal\n"));
    b.channel("B")[3] = 0.4;
    // (0.3 - 0.4)^2 / (0.4^2 + 0.01) over 24 values. The brightness of all the others is 2.8.
    let lines = [
        "a.exr and b.exr differ",
        "relMSE 0.002451",
        "brightness 0.98824 times that of the second",
        "dE2000 mean ",
        "judged by equality: ",
        "worst pixel (3, 0): 0.3 0.3 0.3 and 0.3 0.3 0.4",
    ];
    assert_says(&diff(&folder, &a, &b, &[]), 1, &lines);
    let tolerated = ["a.exr and b.exr agree", "relMSE 0.002451, 0.0025 is tolerated"];
    assert_says(&diff(&folder, &a, &b, &["--tolerance", "0.0025"]), 0, &tolerated);
    assert_says(&diff(&folder, &a, &b, &["--tolerance", "0.0024"]), 1, &["a.exr and b.exr differ"]);
}

#[test]
fn values_that_are_not_finite_agree_only_with_their_like() {
    let folder = Folder::new();
    let (mut a, mut b) = (ramp(), ramp());
    a.channel("R")[2] = f32::NAN;
    let printed = ["a.exr and b.exr differ", "not finite 1 of 8 pixels, left out; 1 of them differ"];
    assert_says(&diff(&folder, &a, &b, &["--tolerance", "1"]), 1, &printed);
    b.channel("R")[2] = f32::NAN;
    assert_says(&diff(&folder, &a, &b, &[]), 0, &["a.exr and b.exr agree: all values are equal"]);
}

#[test]
fn a_layer_is_compared_by_its_name_and_a_picture_shows_where() {
    let folder = Folder::new();
    let mut a = ramp();
    a.parts[0].1.push(("Z", vec![1.0; 8]));
    let mut b = a.clone();
    b.channel("Z")[5] = 3.0;
    let apart = "a.exr and b.exr differ: the image is equal, the layer Z is not; --layer Z compares it";
    assert_says(&diff(&folder, &a, &b, &[]), 1, &[apart]);
    assert_says(&diff(&folder, &a, &b, &["--tolerance", "0"]), 0, &["a.exr and b.exr agree"]);
    let answer = diff(&folder, &a, &b, &["--layer", "Z", "--png", "where.png"]);
    assert_eq!(answer.code, Some(1), "{}", answer.stderr);
    assert_eq!(answer.stderr, "wrote where.png: white is a difference of 2 or more\n");
    assert!(answer.stdout.contains("\nworst pixel  (1, 1): 1 and 3\n"), "{}", answer.stdout);
    let picture = read_png(&folder.path_of("where.png"));
    let white: Vec<usize> = (0..8).filter(|&i| picture.pixels[i] == [255; 3]).collect();
    assert_eq!(white, [5]);
}

#[test]
fn layers_in_windows_of_their_own_are_compared_where_both_have_pixels() {
    let folder = Folder::new();
    let mut a = ramp();
    a.parts[0].0 = "rgb";
    a.parts.push(("depth", vec![("Z", (0..8).map(|i| i as f32).collect())]));
    let mut b = Exr { later_corner: [1, 0], ..a.clone() };
    let apart = "a.exr and b.exr differ: the image is equal, the layer Z is not; --layer Z compares it";
    assert_says(&diff(&folder, &a, &b, &[]), 1, &[apart]);
    // It has the columns 1 to 4, of which the other image has 3.
    *b.channel("Z") = vec![1.0, 2.0, 3.0, 9.0, 5.0, 6.0, 7.0, 9.0];
    assert_says(&diff(&folder, &a, &b, &[]), 0, &["a.exr and b.exr agree: all values are equal"]);
}

#[test]
fn what_only_one_of_the_files_has_is_listed() {
    let folder = Folder::new();
    let (mut a, mut b) = (ramp(), ramp());
    a.parts[0].1.extend([("N.X", vec![0.0; 8]), ("N.Y", vec![0.0; 8]), ("Z", vec![1.0; 8])]);
    b.parts[0].1.extend([("A", vec![1.0; 8]), ("N.X", vec![0.0; 8])]);
    let lines = ["a.exr and b.exr agree: all values are equal", "only in a.exr Z, N.Y", "only in b.exr A"];
    assert_says(&diff(&folder, &a, &b, &[]), 0, &lines);
    b.channel("R")[3] = 0.9;
    assert_says(&diff(&folder, &a, &b, &[]), 1, &["a.exr and b.exr differ", "only in a.exr Z, N.Y", "only in b.exr A"]);
    let crop = |image: &Exr| Exr { corner: [-1, 0], ..image.clone() };
    assert!(diff(&folder, &a, &crop(&a), &[]).stdout.find("only in").is_none());
    assert!(diff(&folder, &a, &a, &["--layer", "Z"]).stdout.find("only in").is_none());
}

#[test]
fn a_pixel_that_is_no_number_in_one_image_alone_is_white_and_named() {
    let folder = Folder::new();
    let (a, mut b) = (ramp(), ramp());
    b.channel("G")[6] = f32::NAN;
    let answer = diff(&folder, &a, &b, &["--png", "where.png"]);
    assert_eq!(answer.stderr, "wrote where.png: white marks pixels that differ and are not finite\n");
    assert!(answer.stdout.contains("\nfirst of them  (2, 1): "), "{}", answer.stdout);
    let picture = read_png(&folder.path_of("where.png"));
    assert_eq!((0..8).filter(|&i| picture.pixels[i] == [255; 3]).collect::<Vec<_>>(), [6]);
    assert_eq!(
        diff(&folder, &a, &a, &["--png", "same.png"]).stderr,
        "wrote same.png: all of it is black, as nothing differs\n"
    );
}

#[test]
fn of_a_crop_the_pixels_that_both_have_are_compared() {
    let folder = Folder::with("room.toml", SCENE);
    let make_file = |name: &str, more: &[&str]| {
        let words = [&["room.toml", "--quiet", "--samples", "16", "--layers", "variance,samples", "--exr", name], more];
        assert_eq!(render(&folder, &words.concat()).code, Some(0));
    };
    make_file("whole.exr", &[]);
    make_file("crop.exr", &["--crop", "6,4,9,5"]);
    make_file("wide.exr", &["--overscan", "3"]);
    make_file("other.exr", &["--crop", "6,4,9,5", "--seed", "7"]);
    make_file("beside.exr", &["--crop", "0,0,3,3"]);
    make_file("small.exr", &["--set", "film.width=16"]);
    let compare_files = |a: &str, b: &str| render(&folder, &["diff", a, b, "--png", "where.png"]);
    let overlap = "in the 9 x 5 pixels at (6, 4) that both have";
    for (a, b) in [("whole.exr", "crop.exr"), ("crop.exr", "whole.exr"), ("wide.exr", "crop.exr")] {
        let same = compare_files(a, b);
        let printed = format!("{a} and {b} agree {overlap}: all values are equal\n");
        assert_eq!((same.code, same.stdout), (Some(0), printed));
    }
    let noisy = compare_files("whole.exr", "other.exr");
    assert!(noisy.code == Some(0) && noisy.stdout.starts_with(&format!("whole.exr and other.exr agree {overlap}\n")));
    assert!(noisy.stdout.contains("\nz "), "{}", noisy.stdout);
    assert_eq!(read_png(&folder.path_of("where.png")).pixels.len(), 45);
    let wide = compare_files("wide.exr", "whole.exr");
    assert!(wide.stdout.starts_with("wide.exr and whole.exr agree in the 32 x 24 pixels at (0, 0)"), "{}", wide.stdout);
    for (other, pixels) in
        [("beside.exr", "3 x 3 pixels at (0, 0) of 32 x 24"), ("small.exr", "16 x 24 pixels at (0, 0)")]
    {
        let refused = compare_files("crop.exr", other);
        assert!(refused.code == Some(2) && refused.stderr.contains(pixels), "{}", refused.stderr);
    }
}

#[test]
fn what_cannot_be_compared_is_refused_with_an_exit_code_of_its_own() {
    let folder = Folder::new();
    let mut crop = ramp();
    (crop.corner, crop.full) = ([2, 1], [8, 4]);
    let size = "error: a.exr has 4 x 2 pixels at (0, 0) of 4 x 2, b.exr 4 x 2 pixels at (2, 1) of 8 x 4\n\
                help: images of the same full size can be compared where both have pixels\n";
    diff(&folder, &ramp(), &crop, &[]).assert_refused(2, size);
    let mut aces = ramp();
    aces.texts.push(("colorInteropID", "lin_ap1_scene".into()));
    let space = "error: b.exr has the color space lin_ap1_scene, a.exr no color space, which means lin_rec709_scene\n\
         help: colors of different color spaces cannot be compared\n";
    diff(&folder, &ramp(), &aces, &[]);
    render(&folder, &["diff", "b.exr", "a.exr", "--png", "c.png"]).assert_refused(2, space);
    let layer = "error: a.exr has no layer Z\nhelp: it has beauty\n";
    diff(&folder, &ramp(), &ramp(), &["--layer", "Z"]).assert_refused(2, layer);
    let tolerance = "error: a tolerance is a finite number, 0 or more\nhelp: for instance: --tolerance 1e-4\n";
    for number in ["-1", "nan", "inf"] {
        diff(&folder, &ramp(), &ramp(), &["--tolerance", number]).assert_refused(2, tolerance);
    }
    folder.write("b.exr", "no image");
    let broken = "error: cannot read b.exr: it is not a complete OpenEXR image (it does not begin like one)\n";
    render(&folder, &["diff", "a.exr", "b.exr", "--png", "c.png"]).assert_refused(2, broken);
    let missing = "error: there is no image file A.exr\nhelp: did you mean a.exr?\n";
    render(&folder, &["diff", "a.exr", "A.exr"]).assert_refused(2, missing);
    assert_eq!(render(&folder, &["diff", "a.exr"]).code, Some(2));
    assert_eq!(folder.file_names(), ["a.exr", "b.exr"]);
}

#[test]
fn a_layer_called_beauty_that_is_no_color_has_no_noise() {
    let names = ["beauty.V", "beauty.W", "beauty.X", "beauty.Y"];
    let mut channels: Vec<_> = names.map(|name| (name, vec![0.5; 200])).to_vec();
    channels.extend(VARIANCES.map(|name| (name, vec![1e-4; 200])));
    let a = Exr::new([20, 10], channels.clone());
    channels[3].1[7] = 0.6;
    let b = Exr::new([20, 10], channels);
    assert!(difference(&a, &b).noise.is_none());
}
