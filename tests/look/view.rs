use std::process::Command;

use exr::meta::attribute::Chromaticities;
use exr::prelude::Vec2;

use super::files::{Exr, ramp};
use crate::support::pictures::read_png;
use crate::support::run::{Folder, render};

pub const SCENE: &str = r#"
camera = { position = [0, 1, 6], look_at = [0, 1, 0], vertical_fov = 35 }
film = { width = 6, height = 4, color_space = "lin_ap1_scene" }
render.samples = 1
material.red.diffuse = { reflectance = { rgb = [0.7, 0.2, 0.1] } }
[[object]]
shape.sphere = { center = [0, 1, 0], radius = 1 }
material = "red"
[[light]]
environment = { radiance = 1 }
"#;

/// Writes a layer as a PNG. Returns its pixels and the messages.
pub fn pixels(folder: &Folder, arguments: &[&str]) -> (Vec<[u8; 3]>, String) {
    let answer = render(folder, &[&["view", "a.exr", "--png", "look.png"], arguments].concat());
    assert_eq!((answer.code, &*answer.stdout), (Some(0), ""), "{}", answer.stderr);
    let message = answer.stderr.strip_suffix("wrote look.png\n").expect("the last line").to_owned();
    (read_png(&folder.path_of("look.png")).pixels, message)
}

/// Writes color, alpha, two normals, a position, a depth and an albedo of two pixels.
fn layers(folder: &Folder) {
    let mut channels: Vec<_> = ["R", "G", "B"].map(|name| (name, vec![0.5, 2.0])).to_vec();
    channels.push(("A", vec![1.0, 0.0]));
    channels.push(("Z", vec![3.0, 1e10]));
    channels.extend([("N.X", vec![0.0, -1.0]), ("N.Y", vec![0.0, 1.0]), ("N.Z", vec![1.0, 0.0])]);
    channels.extend([("Nd.X", vec![0.0, -1.0]), ("Nd.Y", vec![0.0, 1.0]), ("Nd.Z", vec![1.0, 0.0])]);
    channels.extend([("P.X", vec![5.0, 7.0]), ("P.Y", vec![f32::NAN, 1.0])]);
    channels.extend([("albedo.R", vec![1.0, 0.0]), ("albedo.G", vec![0.0; 2]), ("albedo.B", vec![0.0; 2])]);
    folder.write("a.exr", Exr::new([2, 1], channels).bytes());
}

#[test]
fn a_picture_of_an_image_is_the_one_that_its_render_writes() {
    let folder = Folder::with("ball.toml", SCENE);
    assert_eq!(render(&folder, &["ball.toml", "--exr", "a.exr", "--png", "b.png", "--exposure", "-1"]).code, Some(0));
    pixels(&folder, &["--exposure", "-1"]);
    let read = |name: &str| folder.read(name);
    assert!(read("look.png") == read("b.png"));
}

#[test]
fn each_layer_is_shown_as_what_it_is() {
    let folder = Folder::new();
    layers(&folder);
    // sRGB of 0.5 is 188. Anything brighter than white is white.
    assert_eq!(pixels(&folder, &[]), (vec![[188; 3], [255; 3]], String::new()));
    assert_eq!(pixels(&folder, &["beauty", "--exposure", "-2"]).0[1], [188; 3]);
    assert_eq!(pixels(&folder, &["albedo"]).0, [[255, 0, 0], [0; 3]]);
    for normals in ["N", "Nd"] {
        assert_eq!(pixels(&folder, &[normals]), (vec![[128, 128, 255], [0, 255, 128]], String::new()));
    }
    let span = "the 1st and 99th percentile of the finite values below 1e9\n";
    // Only one depth is finite. It is shown in the middle of the range, and empty pixels are white.
    assert_eq!(pixels(&folder, &["Z"]), (vec![[128; 3], [255; 3]], format!("Z: black is 3.0, white 3.0, {span}")));
    assert_eq!(pixels(&folder, &["A"]).0, [[255; 3], [0; 3]]);
    assert_eq!(pixels(&folder, &["albedo.R"]).0, [[255; 3], [0; 3]]);
    let (shown, message) = pixels(&folder, &["P"]);
    assert_eq!(shown, [[0, 0, 0], [255, 128, 0]]);
    assert_eq!(message, format!("P.X: black is 5.0, white 7.0, {span}P.Y: black is 1.0, white 1.0, {span}"));
}

#[test]
fn a_band_of_a_spectrum_is_shown_by_its_wavelength_and_bands_are_not_taken_for_colors() {
    let folder = Folder::new();
    let band = |name, values: [f32; 2]| (name, values.to_vec());
    let spectra = [
        band("S0.380,000000nm", [0.0, 1.0]),
        band("S0.385,000000nm", [1.0, 3.0]),
        band("S0.390,000000nm", [2.0, 2.0]),
        band("S1.385,000000nm", [4.0, 5.0]),
    ];
    folder.write("a.exr", Exr::new([2, 1], spectra.to_vec()).bytes());
    let message = |layer: &[&str]| pixels(&folder, layer).1;
    for name in ["385nm", "383.1nm", "387,4 nm", "S0.385nm", "S0.386.5nm", "S0.385,000000nm"] {
        let message = message(&[name]);
        assert!(message.starts_with("S0.385,000000nm: black is 1.0, white 3.0"), "{name}: {message}");
    }
    assert!(message(&["S1.385nm"]).starts_with("S1.385,000000nm: black is 4.0"));
    assert!(message(&[]).starts_with("there are no R, G and B: showing S0.385,000000nm\n"));
    let refused = |layer: &str| render(&folder, &["view", "a.exr", layer, "--png", "look.png"]);
    refused("S0")
        .assert_refused(2, "error: S0 holds the 3 bands of a spectrum\nhelp: name one by its wavelength: S0.385nm\n");
    refused("370nm").assert_refused(2, "error: a.exr has no layer 370nm\nhelp: it has S0, S1\n");
}

#[test]
fn where_there_are_no_colors_the_first_layer_is_shown_and_named() {
    let folder = Folder::new();
    folder.write("a.exr", Exr::new([2, 1], vec![("Y", vec![1.0, 3.0])]).bytes());
    let (shown, message) = pixels(&folder, &[]);
    assert_eq!(shown, [[0; 3], [255; 3]]);
    assert!(message.starts_with("there are no R, G and B: showing Y\nY: black is 1.0, white 3.0, "), "{message}");
}

#[test]
fn a_gray_comes_before_its_alpha_and_small_letters_are_colors() {
    let folder = Folder::new();
    let path = folder.path_of("a.exr");
    Exr::new([2, 1], vec![("A", vec![1.0; 2]), ("Y", vec![1.0, 3.0])]).write(&path);
    let (shown, message) = pixels(&folder, &[]);
    assert_eq!(shown, [[0; 3], [255; 3]]);
    assert!(message.starts_with("there are no R, G and B: showing Y\nY: black is 1.0, white 3.0, "), "{message}");
    Exr::new([1, 1], vec![("b", vec![0.0]), ("g", vec![0.5]), ("r", vec![1.0])]).write(&path);
    assert_eq!(pixels(&folder, &[]), (vec![[255, 188, 0]], String::new()));
}

/// Hable's curve at 1: (0.704 / 1.66 - 1 / 15) / (19.38 / 24.476 - 1 / 15) = 0.49292, in sRGB 186.3.
#[test]
fn a_tone_is_chosen_by_name() {
    let folder = Folder::new();
    layers(&folder);
    let (shown, _) = pixels(&folder, &["--tone", "hable", "--exposure", "1"]);
    assert_eq!(shown[0], [186; 3]);
    assert_eq!(pixels(&folder, &["--tone", "srgb"]).0[0], [188; 3]);
    let answer = render(&folder, &["view", "a.exr", "--tone", "habel"]);
    assert_eq!(answer.code, Some(2));
    assert!(answer.stderr.contains("[possible values: srgb, hable]"), "{}", answer.stderr);
}

#[test]
fn colors_of_any_space_are_brought_to_rec709() {
    let folder = Folder::new();
    let path = folder.path_of("a.exr");
    // A green of Rec.2020 is outside of Rec.709: all channels but green are clipped to 0.
    let green = Exr::new([1, 1], vec![("R", vec![0.0]), ("G", vec![0.2]), ("B", vec![0.0])]);
    let rec2020 = Chromaticities {
        red: Vec2(0.708, 0.292),
        green: Vec2(0.170, 0.797),
        blue: Vec2(0.131, 0.046),
        white: Vec2(0.3127, 0.3290),
    };
    // ITU-R BT.2087: it has 1.1329 times as much of Rec.709's green, in sRGB 131.5 instead of the 123.6 of 0.2.
    let text = |id: &str| vec![("colorInteropID", id.to_owned())];
    Exr { chromaticities: Some(rec2020), ..green.clone() }.write(&path);
    assert_eq!(pixels(&folder, &[]), (vec![[0, 131, 0]], String::new()));
    Exr { texts: text("lin_rec2020_scene"), ..green.clone() }.write(&path);
    assert_eq!(pixels(&folder, &[]), (vec![[0, 131, 0]], String::new()));
    Exr { texts: text("lin_other_scene"), ..green.clone() }.write(&path);
    let message = "the color space \"lin_other_scene\" is not known: it is shown as linear Rec.709\n";
    assert_eq!(pixels(&folder, &[]), (vec![[0, 124, 0]], message.to_owned()));
    Exr { texts: text("unknown"), ..green.clone() }.write(&path);
    assert_eq!(pixels(&folder, &[]), (vec![[0, 124, 0]], String::new()));
    Exr { texts: text("data"), ..green.clone() }.write(&path);
    let message = "it says that it holds data, not colors: it is shown as linear Rec.709\n";
    assert_eq!(pixels(&folder, &[]), (vec![[0, 124, 0]], message.to_owned()));
    let none = Chromaticities { green: Vec2(0.708, 0.292), ..rec2020 };
    Exr { chromaticities: Some(none), ..green }.write(&path);
    let message = "its chromaticities define no color space: it is shown as linear Rec.709\n";
    assert_eq!(pixels(&folder, &[]), (vec![[0, 124, 0]], message.to_owned()));
}

#[test]
fn without_a_terminal_pixels_are_halves_of_characters_in_so_many_columns() {
    let folder = Folder::new();
    folder.write("a.exr", ramp().bytes());
    let answer = render(&folder, &["view", "a.exr"]);
    assert_eq!((answer.code, &*answer.stderr), (Some(0), ""));
    assert_eq!(answer.stdout.matches('▀').count(), 4);
    assert!(answer.stdout.starts_with("\x1b[38;2;0;0;0;48;2;170;170;170m▀"), "{:?}", answer.stdout);
    assert!(answer.stdout.ends_with("▀\x1b[0m\n"), "{:?}", answer.stdout);
    let mut command = Command::new(env!("CARGO_BIN_EXE_render"));
    let output = command.current_dir(folder.path()).env("COLUMNS", "2").args(["view", "a.exr"]).output();
    let text = String::from_utf8(output.expect("the command can be started").stdout).expect("UTF-8");
    // Two columns in a single row. The mean of all four pixels in linear light is (0 + 0.1 + 0.4 + 0.5) / 4.
    assert_eq!(text.matches('▀').count(), 2);
    let sixels = render(&folder, &["view", "a.exr", "--sixel"]).stdout;
    assert!(sixels.starts_with("\x1bP0;1q\"1;1;4;2#0;2;0;0;0") && sixels.ends_with("\x1b\\\n"), "{sixels:?}");
}

#[test]
fn what_cannot_be_shown_is_refused_and_nothing_is_written() {
    let folder = Folder::new();
    layers(&folder);
    let view = |arguments: &[&str]| render(&folder, &[&["view"], arguments].concat());
    let has = "it has beauty, Z, N, Nd, P, albedo\n";
    let refusal = format!("error: a.exr has no layer albdo\nhelp: did you mean albedo? {has}");
    view(&["a.exr", "albdo", "--png", "b.png"]).assert_refused(2, &refusal);
    for (elsewhere, here) in [("depth", "Z"), ("normals", "N"), ("position", "P"), ("rgb", "beauty")] {
        let refusal = format!("error: a.exr has no layer {elsewhere}\nhelp: did you mean {here}? {has}");
        view(&["a.exr", elsewhere]).assert_refused(2, &refusal);
    }
    view(&["a.exr", "variance"]).assert_refused(2, &format!("error: a.exr has no layer variance\nhelp: {has}"));
    let png = "error: --png writes a file that ends in .png, not b.jpg\nhelp: for instance: --png look.png\n";
    view(&["a.exr", "--png", "b.jpg"]).assert_refused(2, png);
    let exposure = "error: an exposure is a finite number of stops\nhelp: for instance: --exposure 1\n";
    view(&["a.exr", "--exposure", "nan"]).assert_refused(2, exposure);
    let depth = "error: --exposure is for colors, and Z has none\nhelp: leave it out\n";
    view(&["a.exr", "Z", "--exposure", "1"]).assert_refused(2, depth);
    let missing = "error: there is no image file A.exr\nhelp: did you mean a.exr?\n";
    view(&["A.exr", "--png", "b.png"]).assert_refused(2, missing);
    assert_eq!(view(&["a.exr", "--png", "b.png", "--sixel"]).code, Some(2));
    let place = "error: cannot write a.exr/b.png: there is a file where its folder should be\n";
    view(&["a.exr", "--png", "a.exr/b.png"]).assert_refused(1, place);
    std::fs::copy(folder.path_of("a.exr"), folder.path_of("a.png")).expect("files can be copied");
    let itself = "error: a.png is the image itself\nhelp: name another file\n";
    view(&["a.png", "--png", "a.png"]).assert_refused(2, itself);
    assert_eq!(folder.file_names(), ["a.exr", "a.png"]);
}

/// A sky of 2^9 or 2^-11 on a ball with reflectances of 0.7, 0.2 and 0.1.
#[test]
fn for_a_picture_nearly_all_white_or_black_a_better_exposure_is_suggested() {
    for (radiance, what, stops) in [("512", "brighter than white", -11), ("0.00048828125", "too dark to be seen", 9)] {
        let folder = Folder::with("ball.toml", SCENE.replace("radiance = 1", &format!("radiance = {radiance}")));
        let warned = |arguments: &[&str]| {
            let answer = render(&folder, &[&["ball.toml", "--png", "look.png"], arguments].concat());
            let warnings = answer.stderr.lines().filter(|line| line.starts_with("warning: "));
            warnings.map(str::to_owned).collect::<Vec<_>>()
        };
        let flag = format!("--exposure {stops}");
        assert_eq!(warned(&[]), [format!("warning: nearly all of look.png is {what}: {flag} shows more")]);
        let again = format!("`render view a.exr --png look.png {flag}`");
        let warning = format!("warning: nearly all of look.png is {what}: {again} shows more");
        assert_eq!(warned(&["--exr", "a.exr"]), [warning]);
        assert_eq!(warned(&["--exposure", &stops.to_string()]), [""; 0]);
        assert_eq!(pixels(&folder, &[]).1, format!("nearly all of it is {what}: {flag} shows more\n"));
        assert_eq!(pixels(&folder, &["--exposure", &stops.to_string()]).1, "");
    }
}
