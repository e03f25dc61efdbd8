use super::damaged::subsampled;
use super::files::{Exr, ramp};
use crate::support::run::{Folder, render};

const SCENE: &str = r#"
camera = { position = [0, 1, 6], look_at = [0, 1, 0], vertical_fov = 35 }
film = { width = 12, height = 8, color_space = "lin_ap1_scene" }
render.samples = 3
material.white.diffuse = { reflectance = 0.7 }
[[object]]
shape.sphere = { center = [0, 1, 0], radius = 1 }
material = "white"
[[light]]
environment = { radiance = 1 }
"#;

/// Returns the lines of the output, with one space between words.
fn lines(folder: &Folder, file: &str) -> Vec<String> {
    let answer = render(folder, &["info", file]);
    assert_eq!((answer.code, &*answer.stderr), (Some(0), ""));
    answer.stdout.lines().map(|line| line.split_whitespace().collect::<Vec<_>>().join(" ")).collect()
}

fn assert_says(lines: &[String], expected: &[&str]) {
    for line in expected {
        assert!(lines.iter().any(|found| found.starts_with(line)), "{line:?} is not in\n{}", lines.join("\n"));
    }
}

#[test]
fn info_shows_the_overscan_of_a_render() {
    let folder = Folder::with("ball.toml", SCENE);
    assert_eq!(render(&folder, &["ball.toml", "--overscan", "4,2,6,5"]).code, Some(0));
    let expected = ["size 12 x 8 pixels", "overscan 22 x 15 pixels are stored, (-4, -2) to (17, 12)"];
    assert_says(&lines(&folder, "ball.exr"), &expected);
}

#[test]
fn info_shows_size_crop_color_camera_origin_and_channels_of_a_render() {
    let folder = Folder::with("ball.toml", SCENE);
    let rate = ["--set", "film.metadata.frames_per_second=23.976"];
    assert_eq!(render(&folder, &[&["ball.toml", "--crop", "4,2,6,5"], &rate[..]].concat()).code, Some(0));
    let lines = lines(&folder, "ball.exr");
    assert_says(
        &lines,
        &[
            "ball.exr: OpenEXR, 1 part, ",
            "size 12 x 8 pixels",
            "crop 6 x 5 pixels are stored, (4, 2) to (9, 6)",
            "storage zip, scan lines from the top",
            "chromaticities red 0.7130 0.2930, green 0.1650 0.8300, blue 0.1280 0.0440, white 0.3217 0.3377 (lin_ap1_scene)",
            "camera at (0, 1, 6), looks along (0, 0, -1)",
            // 2 atan(1.5 tan(17.5 degrees)).
            "field of view 50.62 degrees across, 35.00 up",
            "colorInteropID lin_ap1_scene",
            "framesPerSecond 24000/1001",
            "render/samples 3",
            "render/seed 0",
            "layer channel type min mean max",
            "beauty R float ",
            "Z Z float ",
        ],
    );
    assert!(!lines.iter().any(|line| line.contains("NaN") || line.contains("infinite")));
}

#[test]
fn values_that_are_no_numbers_are_counted_and_left_out() {
    let folder = Folder::new();
    let values = vec![f32::NAN, 1.0, 2.0, f32::INFINITY, f32::NAN, f32::NEG_INFINITY];
    let image = Exr::new([3, 2], vec![("Y", values), ("broken.X", vec![f32::NAN; 6])]);
    folder.write("a.exr", image.bytes());
    assert_says(&lines(&folder, "a.exr"), &["Y Y float 1 1.5 2 2 NaN, 2 infinite", "broken X float - - - 6 NaN"]);
}

#[test]
fn overscan_and_parts_of_other_programs_are_described() {
    let folder = Folder::new();
    let flat = |value: f32| vec![value; 12];
    let mut image = Exr::new([4, 3], Vec::new());
    (image.corner, image.full, image.half) = ([-1, -1], [2, 1], true);
    image.texts.push(("comments2", "two\nlines \u{1b}[31m and \u{e9}".into()));
    image.parts = vec![
        ("rgba", vec![("R", flat(0.5)), ("G", flat(0.5)), ("B", flat(0.5))]),
        ("albedo", vec![("R", flat(0.25)), ("G", flat(0.25)), ("B", flat(0.25))]),
        ("depth", vec![("Z", flat(7.0))]),
    ];
    folder.write("a.exr", image.bytes());
    assert_says(
        &lines(&folder, "a.exr"),
        &[
            "a.exr: OpenEXR, 3 parts, ",
            "part 1 rgba",
            "overscan 4 x 3 pixels are stored, (-1, -1) to (2, 1)",
            "storage not compressed, scan lines from the top",
            // Nothing in a file can control the terminal.
            "comments2 two\u{fffd}lines \u{fffd}[31m and \u{e9}",
            "beauty R half 0.5 0.5 0.5",
            "part 2 albedo",
            "albedo G half 0.25 0.25 0.25",
            "Z Z half 7 7 7",
        ],
    );
}

/// The deep image was written by OpenEXR 3.5.3.
#[test]
fn of_a_file_whose_values_are_not_read_all_else_is_described() {
    let folder = Folder::new();
    folder.write("deep.exr", include_bytes!("deep.exr"));
    folder.write("chroma.exr", subsampled());
    let printed = lines(&folder, "deep.exr");
    assert!(
        printed[0].ends_with("; its values are not read: a deep image, which has many values per pixel"),
        "{printed:?}"
    );
    assert_says(&printed, &["size 8 x 4 pixels", "storage zips, ", "R R half - - -", "Z Z float - - -"]);
    let printed = lines(&folder, "chroma.exr");
    let why = "channel subsampling, by which several pixels share a value";
    assert!(printed[0].ends_with(&format!("; its values are not read: {why}")), "{printed:?}");
    assert_says(&printed, &["size 4 x 2 pixels", "beauty B float - - - one value per 2 x 2 pixels"]);
    let refusal = "error: cannot read chroma.exr: OpenEXR images of this kind are not supported: ";
    let viewed = render(&folder, &["view", "chroma.exr"]);
    assert_eq!((viewed.code, viewed.stderr), (Some(1), format!("{refusal}{why}\n")));
}

#[test]
fn a_file_that_cannot_be_read_is_reported_in_one_line() {
    let folder = Folder::new();
    folder.write("ramp.exr", ramp().bytes());
    folder.write("text.exr", "no image");
    folder.write("empty.exr", "");
    let whole = folder.read("ramp.exr");
    folder.write("half.exr", &whole[..whole.len() - 20]);
    let info = |file: &str| render(&folder, &["info", file]);
    let help = "help: an image is an OpenEXR file, such as prism.exr\n";
    let missing = "error: there is no image file rampe.exr\nhelp: did you mean ramp.exr?\n";
    info("rampe.exr").assert_refused(2, missing);
    info("no/a.exr").assert_refused(2, &format!("error: there is no image file no/a.exr\n{help}"));
    info(".").assert_refused(2, &format!("error: . is a folder, not an image\n{help}"));
    for file in ["text.exr", "empty.exr"] {
        let refusal =
            format!("error: cannot read {file}: it is not a complete OpenEXR image (it does not begin like one)\n");
        info(file).assert_refused(1, &refusal);
    }
    let answer = info("half.exr");
    assert_eq!((answer.code, &*answer.stdout), (Some(1), ""));
    assert!(answer.stderr.starts_with("error: cannot read half.exr: it is not a complete OpenEXR image ("));
    assert_eq!(answer.stderr.lines().count(), 1, "{}", answer.stderr);
    assert_eq!(folder.file_names(), ["empty.exr", "half.exr", "ramp.exr", "text.exr"]);
}

#[test]
fn a_file_that_is_no_openexr_image_is_identified() {
    let folder = Folder::with("ball.toml", SCENE);
    folder.write("a.png", *b"\x89PNG\r\n\x1a\n");
    folder.write("a.jpg", *b"\xff\xd8\xff\xe0");
    folder.write("a.hdr", "#?RADIANCE\n");
    let scene = "error: ball.toml is a scene, not an image\n\
                 help: render ball.toml makes the image, and render --plan ball.toml says how\n";
    render(&folder, &["info", "ball.toml"]).assert_refused(2, scene);
    render(&folder, &["view", "ball.toml"]).assert_refused(2, scene);
    for (file, kind) in [("a.png", "PNG"), ("a.jpg", "JPEG"), ("a.hdr", "Radiance picture")] {
        let refusal = format!(
            "error: {file} is a {kind}, not an OpenEXR image\n\
             help: an image is an OpenEXR file, such as prism.exr; --exr writes one beside the picture\n"
        );
        render(&folder, &["info", file]).assert_refused(2, &refusal);
    }
}
