//! The command line: its arguments, its messages, and the files that it leaves behind.

#[allow(dead_code)]
#[path = "support/pictures.rs"]
mod pictures;
#[allow(dead_code)]
#[path = "support/run.rs"]
mod run;

use std::fs;

use pictures::read_png;
use run::{Folder, render};

const SCENE: &str = r#"
[camera]
position = [0, 1, 6]
look_at = [0, 1, 0]
vertical_fov = 35

[film]
width = 6
height = 4

[render]
samples = 1

[material.white]
diffuse = { reflectance = 0.7 }

[[object]]
shape.sphere = { center = [0, 1, 0], radius = 1 }
material = "white"

[[object]]
shape.sphere = { center = [1, 0, 0], radius = 0.2 }
material = "white"

[[light]]
environment = { radiance = 1 }
"#;

/// Creates a folder with `ball.toml`, a scene of two white balls under a uniform sky.
fn folder() -> Folder {
    Folder::with("ball.toml", SCENE)
}

/// Asserts that the command is refused with this text and leaves nothing behind.
fn assert_refuses(arguments: &[&str], code: i32, stderr: &str) {
    let folder = folder();
    render(&folder, arguments).assert_refused(code, stderr);
    assert_eq!(folder.file_names(), ["ball.toml"]);
}

/// Asserts that the command succeeds with nothing on stdout and leaves exactly these files.
fn assert_leaves_files(arguments: &[&str], files: &[&str]) {
    let folder = folder();
    let answer = render(&folder, arguments);
    assert_eq!((answer.code, &*answer.stdout), (Some(0), ""), "{}", answer.stderr);
    assert_eq!(folder.file_names(), files, "{}", answer.stderr);
}

#[test]
fn the_image_is_named_after_its_scene_and_stands_in_the_current_folder() {
    let made = ["ball.exr", "ball.toml"];
    assert_leaves_files(&["--exr", "ball.toml"], &made);
    assert_leaves_files(&["ball.toml", "--exr"], &made);
    assert_leaves_files(&["ball.toml"], &made);
    let folder = Folder::new();
    fs::create_dir(folder.path_of("scenes")).expect("folders can be made");
    folder.write("scenes/ball.v2.toml", SCENE);
    assert_eq!(render(&folder, &["--exr", "scenes/ball.v2.toml"]).code, Some(0));
    assert_eq!(folder.file_names(), ["ball.v2.exr", "scenes"]);
}

#[test]
fn the_image_may_be_named_before_or_after_the_scene() {
    let made = ["ball.toml", "frame.exr"];
    assert_leaves_files(&["ball.toml", "--exr", "frame.exr"], &made);
    assert_leaves_files(&["--exr", "frame.exr", "ball.toml"], &made);
    assert_leaves_files(&["--exr=frame.exr", "ball.toml"], &made);
    assert_leaves_files(&["ball.toml", "--exr", "FRAME.EXR"], &["FRAME.EXR", "ball.toml"]);
}

#[test]
fn a_missing_output_folder_is_created() {
    let folder = folder();
    let arguments = ["ball.toml", "--exr", "out/today/frame.exr", "--png", "out/look/frame.png"];
    assert_eq!(render(&folder, &arguments).code, Some(0));
    assert!(folder.path_of("out/today/frame.exr").is_file());
    assert!(folder.path_of("out/look/frame.png").is_file());
}

#[test]
fn an_image_that_is_no_exr_is_refused() {
    let help = "help: name the scene once, and the image as in --exr out/frame.exr\n";
    let refusal = |name: &str| format!("error: --exr writes a file that ends in .exr, not {name}\n{help}");
    assert_refuses(&["--exr", "foo.png", "ball.toml"], 2, &refusal("foo.png"));
    assert_refuses(&["ball.toml", "--exr", "ball.toml"], 2, &refusal("ball.toml"));
    assert_refuses(&["ball.toml", "--exr", ".exr"], 2, &refusal(".exr"));
    assert_refuses(&["ball.toml", "--exr", "frames/"], 2, &refusal("frames/"));
}

#[test]
fn a_picture_that_is_no_png_is_refused() {
    let refusal = "error: --png writes a file that ends in .png, not look.jpg\nhelp: for instance: --png look.png\n";
    assert_refuses(&["ball.toml", "--png", "look.jpg"], 2, refusal);
}

#[test]
fn exactly_one_scene_is_required() {
    let refusal = "error: no scene is given\nhelp: name a scene, a TOML file: render --exr scene.toml\n";
    assert_refuses(&[], 2, refusal);
    assert_refuses(&["--exr"], 2, refusal);
    assert_refuses(&["--exr", "frame.exr"], 2, refusal);
    let refusal = "error: one scene is rendered at a time, and box.toml is another\n\
        help: render each with its own command\n";
    assert_refuses(&["ball.toml", "box.toml"], 2, refusal);
    let refusal = |file: &str, flag: &str| format!("error: {file} is not a scene\nhelp: write {flag} {file}\n");
    assert_refuses(&["ball.toml", "out/frame.exr"], 2, &refusal("out/frame.exr", "--exr"));
    assert_refuses(&["ball.toml", "look.png"], 2, &refusal("look.png", "--png"));
}

#[test]
fn arguments_that_belong_together_but_are_separate_are_reported() {
    let setting = "error: a setting is one word: a key, `=` and a value\nhelp: for instance: --set film.width=320\n";
    assert_refuses(&["--set", "film.width", "64", "ball.toml"], 2, setting);
    assert_refuses(&["ball.toml", "--set", "film.width", "=", "64"], 2, setting);
    let second = "error: film.height=9 needs --set before it\nhelp: write --set film.height=9\n";
    assert_refuses(&["ball.toml", "--set", "film.width=16", "film.height=9"], 2, second);
    let crop = "error: the numbers of a crop are joined by commas, without spaces\nhelp: write --crop 0,0,8,8\n";
    assert_refuses(&["ball.toml", "--crop", "0", "0", "8", "8"], 2, crop);
    let overscan =
        "error: the numbers of an overscan are joined by commas, without spaces\nhelp: write --overscan 4,2,4,2\n";
    assert_refuses(&["--overscan", "4", "2", "4", "2", "ball.toml"], 2, overscan);
}

#[test]
fn arguments_of_other_renderers_are_refused_with_their_names_here() {
    let refusal = |said: &str, help: &str| format!("error: there is no {said}\nhelp: {help}\n");
    let flag = |flag: &str, help: &str| {
        assert_refuses(&["ball.toml", flag, "3"], 2, &refusal(&format!("argument {flag}"), help))
    };
    flag("--spp", "write --samples 64");
    flag("--width", "write --set film.width=640");
    flag("-o", "write --exr frame.exr");
    flag("--percentage", "write --set film.width=640 --set film.height=360");
    flag(
        "--transparent",
        "write visible_to_camera = false beside the sky, in the scene, to hide it: A is 0 where no object is",
    );
    flag("--frames", "write --frame 1-24");
    flag("--gpu", "write --threads 8, or nothing: it renders on all processors, and on them alone");
    flag("--denoise", "write --layers albedo,N, and then denoise the image: python tools/denoise.py frame.exr");
    let spaced = "error: names of layers are joined by commas, without spaces\nhelp: write --layers lights,N,P\n";
    assert_refuses(&["ball.toml", "--layers", "lights", "N", "P"], 2, spaced);
    assert_refuses(&["ball.toml", "--layers", "lights,", "N,", "P", "--quiet"], 2, spaced);
    let first = "error: merge has no argument --exr\n\
                 help: the image to write comes first: render merge frame.exr frame.*.part\n";
    assert_refuses(&["merge", "a.1-of-2.part", "a.2-of-2.part", "--exr", "a.exr"], 2, first);
    let command =
        |word: &str, help: &str| assert_refuses(&[word, "ball.toml"], 2, &refusal(&format!("command `{word}`"), help));
    command("vew", "did you mean render view?");
    command("plan", "did you mean render --plan?");
    command("frames", "did you mean render --frame 1-24?");
    command("sequence", "did you mean render --frame 1-24?");
    let assert_unknown_command =
        |word: &str, help: &str| assert_refuses(&[word], 2, &refusal(&format!("command `{word}`"), help));
    assert_unknown_command("help", "did you mean render --help?");
    assert_unknown_command("catalogue", "did you mean render catalog?");
    let before = "error: the command info comes before all other arguments\n\
                  help: write render info, and its arguments after that; render info --help lists them\n";
    assert_refuses(&["--threads", "1", "info", "a.exr"], 2, before);
    for mark in ["####", "@@@", "$F4", "$frame", "{frame}", "%s"] {
        let name = format!("f.{mark}.exr");
        let every = format!("error: {name} would be written by every frame\nhelp: write %04d in place of {mark}\n");
        assert_refuses(&["ball.toml", "--exr", &name, "--frame", "3"], 2, &every);
    }
}

#[test]
fn a_scene_that_cannot_be_read_is_refused_with_the_nearest_file() {
    let example = "help: a scene is a TOML file, such as scene.toml\n";
    let missing = "error: there is no scene file bal.toml\nhelp: did you mean ball.toml?\n";
    assert_refuses(&["bal.toml"], 2, missing);
    assert_refuses(&["--exr", "bal.toml"], 2, missing);
    assert_refuses(&["cup"], 2, &format!("error: there is no scene file cup\n{example}"));
    assert_refuses(&["ball.txt"], 2, "error: there is no scene file ball.txt\nhelp: did you mean ball.toml?\n");
    assert_refuses(&["bone.toml"], 2, &format!("error: there is no scene file bone.toml\n{example}"));
    assert_refuses(&["no/ball.toml"], 2, &format!("error: there is no scene file no/ball.toml\n{example}"));
    assert_refuses(&["ball.toml/x.toml"], 2, &format!("error: there is no scene file ball.toml/x.toml\n{example}"));
    assert_refuses(&["."], 2, &format!("error: . is a folder, not a scene\n{example}"));
    let folder = folder();
    folder.write("latin.toml", b"# caf\xe9\n");
    let answer = render(&folder, &["latin.toml"]);
    let byte = "line 1 has the byte 0xE9 in column 6\nhelp: save it as UTF-8\n";
    answer.assert_refused(2, &format!("error: latin.toml is not text in UTF-8: {byte}"));
    folder.write("wide.toml", b"\xff\xfe[\0");
    let byte = "line 1 has the byte 0xFF in column 1\nhelp: it begins like UTF-16: save it as UTF-8\n";
    render(&folder, &["wide.toml"]).assert_refused(2, &format!("error: wide.toml is not text in UTF-8: {byte}"));
    folder.write("image.toml", b"\x89PNG\r\n\x1a\n\0");
    let byte = format!("line 1 has the byte 0x89 in column 1\n{example}");
    render(&folder, &["image.toml"]).assert_refused(2, &format!("error: image.toml is not text in UTF-8: {byte}"));
}

#[test]
fn an_image_that_cannot_be_written_is_refused_before_anything_is_rendered() {
    let file = "there is a file where its folder should be";
    let cannot = |path: &str, reason: &str| format!("error: cannot write {path}: {reason}\n");
    assert_refuses(&["ball.toml", "--exr", "ball.toml/a.exr"], 1, &cannot("ball.toml/a.exr", file));
    assert_refuses(&["ball.toml", "--exr", "ball.toml/b/a.exr"], 1, &cannot("ball.toml/b/a.exr", file));
    assert_refuses(&["ball.toml", "--png", "ball.toml/a.png"], 1, &cannot("ball.toml/a.png", file));
    let folder = folder();
    fs::create_dir(folder.path_of("a.exr")).expect("folders can be made");
    render(&folder, &["ball.toml", "--exr", "a.exr"]).assert_refused(1, &cannot("a.exr", "it is a folder"));
    assert_eq!(folder.file_names(), ["a.exr", "ball.toml"]);
}

/// Nobody can create a folder there.
#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_cannot_be_created_is_reported() {
    let reason = "its folder does not exist and cannot be made";
    let refusal = format!("error: cannot write /proc/nothing/a.exr: {reason}\n");
    assert_refuses(&["ball.toml", "--exr", "/proc/nothing/a.exr"], 1, &refusal);
}

#[test]
fn numbers_on_the_command_line_are_checked() {
    let is_refused = |flag: &str, value: &str, why: &str| {
        assert_refuses(&["ball.toml", flag, value], 2, &format!("error: {flag}: {why}\n"))
    };
    is_refused("--seed", "-1", "a seed is a whole number from 0 to 18446744073709551615");
    is_refused("--error", "5%", "write 0.05 for 5 %");
    is_refused("--error", "0.07%", "write 0.0007 for 0.07 %");
    is_refused("--error", "little", "an error is a number, such as 0.01 for one percent");
    is_refused("--layers", "N,albdo", "there is no layer `albdo`: did you mean albedo?");
    is_refused("--layers", "depth", "there is no layer `depth` (leave it out: Z is in every file)");
    is_refused("--layers", "N,normals", "there is no layer `normals` (normals are in N)");
    let light_hint = "there is no layer `light_key` (ask for lights: it writes one such layer for each light)";
    is_refused("--layers", "light_key", light_hint);
    let both = "there are no layers `albdo` (did you mean albedo?), `varianc` (did you mean variance?)";
    is_refused("--layers", "albdo,N,varianc", both);
    let both = "there are no layers `normal` (normals are in N), `depth` (leave it out: Z is in every file)";
    is_refused("--layers", "albedo,normal,depth", both);
    let frames = "frames are whole numbers from 0 to 4294967295, such as 7, 1-24, 1-24x2 or 3,17,40-50";
    (["-3", "1.5", "1-24x0", "3,,17"]).iter().for_each(|wrong| is_refused("--frame", wrong, frames));
    is_refused("--frame", "24-1", "24-1 ends before it begins: write 1-24");
    [("1..24x2", "1-24x2"), ("1:24", "1-24")]
        .iter()
        .for_each(|(there, here)| is_refused("--frame", there, &format!("write {here} for {there}")));
    is_refused("--time", "soon", "a time is a number with a unit, such as 60s, 5m or 1h");
    is_refused("--time", "-3s", "a time is a number with a unit, such as 60s, 5m or 1h");
    for (flag, value, message) in [
        ("--samples", "4.5", "--samples takes a whole number, not 4.5"),
        ("--samples", "0", "--samples takes a whole number from 1 to 4294967295, not 0"),
        ("--samples", "-3", "--samples takes a whole number from 1 to 4294967295, not -3"),
        ("--threads", "1025", "--threads takes a whole number from 1 to 1024, not 1025"),
        ("--exposure", "bright", "--exposure takes a number, not bright"),
    ] {
        assert_refuses(&["ball.toml", flag, value], 2, &format!("error: {message}\n"));
    }
    let exposure = "error: an exposure is a finite number of stops\nhelp: for instance: --exposure 1\n";
    assert_refuses(&["ball.toml", "--exposure", "nan"], 2, exposure);
    assert_refuses(&["ball.toml", "--exposure", "inf"], 2, exposure);
}

#[test]
fn the_help_of_every_command_names_all_of_it() {
    for command in ["catalog", "info", "view", "diff", "merge", "completions", "man"] {
        let help = render(&folder(), &[command, "--help"]);
        assert!(help.stdout.contains(&format!("\nUsage: render {command}")), "{}", help.stdout);
    }
}

#[test]
fn the_help_lists_all_commands() {
    let help = render(&folder(), &["--help"]).stdout;
    for command in ["catalog", "info", "view", "diff", "merge", "completions", "man"] {
        assert!(help.contains(&format!("\n  render {command} ")), "{command}: {help}");
    }
}

#[test]
fn a_misspelled_flag_is_reported_with_the_nearest_correct_one() {
    let answer = render(&folder(), &["ball.toml", "--sampels", "3"]);
    assert_eq!(answer.code, Some(2));
    assert!(answer.stderr.contains("tip: a similar argument exists: '--samples'"), "{}", answer.stderr);
}

#[test]
fn a_plan_goes_to_stdout_and_writes_nothing() {
    for arguments in [["--plan", "ball.toml"].as_slice(), &["--plan", "--exr", "ball.toml"]] {
        let folder = folder();
        let answer = render(&folder, arguments);
        assert_eq!((answer.code, &*answer.stderr), (Some(0), ""));
        assert!(
            answer.stdout.starts_with("cost: about ") && answer.stdout.contains("\nmodel rgb"),
            "{}",
            answer.stdout
        );
        assert_eq!(folder.file_names(), ["ball.toml"]);
    }
}

#[test]
fn a_check_says_that_the_scene_is_valid_and_writes_nothing() {
    let folder = folder();
    let answer = render(&folder, &["--check", "ball.toml"]);
    answer.assert_refused(0, "ball.toml is a valid scene: 2 objects\n");
    assert_eq!(folder.file_names(), ["ball.toml"]);
}

#[test]
fn a_plan_or_a_check_together_with_an_image_is_refused() {
    for flag in ["--plan", "--check"] {
        let refusal =
            format!("error: {flag} renders nothing, so frame.exr would not be written\nhelp: leave one of them out\n");
        assert_refuses(&[flag, "ball.toml", "--exr", "frame.exr"], 2, &refusal);
        let png = render(&folder(), &[flag, "ball.toml", "--png", "look.png"]);
        assert_eq!(png.code, Some(2), "{}", png.stderr);
    }
    assert_eq!(render(&folder(), &["--plan", "--check", "ball.toml"]).code, Some(2));
}

#[test]
fn a_picture_is_8_bit_rgb_of_the_film_s_size() {
    let folder = folder();
    assert_eq!(render(&folder, &["ball.toml", "--png", "look.png"]).code, Some(0));
    assert_eq!(folder.file_names(), ["ball.toml", "look.png"]);
    let picture = read_png(&folder.path_of("look.png"));
    assert_eq!((picture.width, picture.pixels.len()), (6, 6 * 4));
    // The sky in the corner has radiance 1 and is full white.
    assert_eq!(picture.pixels[0], [255; 3]);
    let says_srgb = |bytes: &[u8]| bytes.windows(4).any(|name| name == b"sRGB");
    assert!(says_srgb(&folder.read("look.png")), "programs that manage colors need to be told");
}

#[test]
fn an_exposure_of_minus_one_halves_the_light_of_the_picture_alone() {
    let folder = folder();
    assert_eq!(render(&folder, &["ball.toml", "--exr", "--png", "a.png"]).code, Some(0));
    let image = folder.read("ball.exr");
    assert_eq!(render(&folder, &["--exr", "ball.toml", "--png", "b.png", "--exposure", "-1"]).code, Some(0));
    assert!(folder.read("ball.exr") == image);
    let picture = read_png(&folder.path_of("b.png"));
    // sRGB of 0.5: 255 (1.055 * 0.5^(1/2.4) - 0.055) = 187.5 (IEC 61966-2-1).
    assert_eq!(picture.pixels[0], [188; 3]);
}

#[test]
fn a_picture_alone_leaves_an_image_of_the_same_scene_as_it_is() {
    assert_leaves_files(&["ball.toml", "--png", "look.png"], &["ball.toml", "look.png"]);
    assert_leaves_files(&["--exr", "ball.toml", "--png", "look.png"], &["ball.exr", "ball.toml", "look.png"]);
    assert_leaves_files(&["ball.toml", "--exr", "a.exr", "--png", "look.png"], &["a.exr", "ball.toml", "look.png"]);
    let folder = folder();
    folder.write("ball.exr", "an older image");
    assert_eq!(render(&folder, &["ball.toml", "--png", "look.png"]).code, Some(0));
    assert_eq!(folder.read("ball.exr"), b"an older image");
}

#[test]
fn an_exposure_without_a_picture_is_refused() {
    let refusal = "error: --exposure brightens only the picture of --png, and --png is not given\n\
                   help: add --png look.png, or leave --exposure out\n";
    assert_refuses(&["ball.toml", "--exposure", "1"], 2, refusal);
    assert_refuses(&["--exr", "ball.toml", "--exposure", "0"], 2, refusal);
    assert_refuses(&["--plan", "ball.toml", "--exposure", "1"], 2, refusal);
}

#[test]
fn an_existing_image_survives_a_failing_run_and_is_replaced_by_a_good_one() {
    let folder = folder();
    folder.write("ball.exr", "an older image");
    let older = || folder.read("ball.exr") == b"an older image";
    folder.write("bad.toml", SCENE.replace("radius = 1 ", "radius = -1 "));
    assert_eq!(render(&folder, &["bad.toml", "--exr", "ball.exr"]).code, Some(2));
    assert!(older());
    assert_eq!(render(&folder, &["--exr", "ball.toml", "--png", "ball.toml/a.png"]).code, Some(1));
    assert!(older());
    assert_eq!(render(&folder, &["ball.toml", "--samples", "0"]).code, Some(2));
    assert!(older());
    assert_eq!(render(&folder, &["ball.toml"]).code, Some(0));
    let image = folder.read("ball.exr");
    assert_eq!(image[..4], [0x76, 0x2f, 0x31, 0x01], "the magic number of OpenEXR");
    assert_eq!(folder.file_names(), ["bad.toml", "ball.exr", "ball.toml"]);
}

#[test]
fn flags_replace_what_the_scene_says_but_a_mistake_in_it_stays_one() {
    let folder = folder();
    folder.write("none.toml", SCENE.replace("samples = 1", "samples = 0"));
    assert_eq!(render(&folder, &["--check", "none.toml"]).code, Some(2));
    assert_eq!(render(&folder, &["--check", "none.toml", "--samples", "3"]).code, Some(2));
    let plan = render(&folder, &["--plan", "ball.toml", "--samples", "3"]).stdout;
    assert!(plan.contains("3 samples per pixel"), "{plan}");
}

#[test]
fn help_shows_examples_and_exit_codes_within_80_columns() {
    let help = render(&folder(), &["--help"]);
    assert_eq!((help.code, &*help.stderr), (Some(0), ""));
    let examples = help.stdout.split("Examples:\n").nth(1).expect("there are examples");
    assert!(examples.contains("  render --exr scenes/prism.toml "), "{examples}");
    assert!(examples.contains("\nExit codes: 0 done, 1 "), "{examples}");
    assert!(examples.lines().all(|line| line.len() <= 80), "{examples}");
    assert_eq!(render(&folder(), &["--version"]).stdout, format!("render {}\n", env!("CARGO_PKG_VERSION")));
}
