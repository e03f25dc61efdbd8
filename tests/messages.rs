//! Every mistake that a person can make in a scene file, with the exact text that answers it.
//!
//! The files in `tests/messages/` hold the cases. A case is a heading, a patch to `base.toml`, the files that a mesh is
//! read from, and what `render --check scene.toml` then writes to stderr:
//!
//! ```text
//! ## a misspelt key of the film
//! - width = 4                          lines of the base scene, which stand there once, taken out
//! + widht = 4                          lines put in their place, or at the end if nothing is taken out
//! @ cup.ply                            another file in the folder of the scene
//! > ply                                its lines
//! = film.width=abc                     a value in place of the scene's, by --set
//!
//! error: unknown key `widht`
//! ..
//! ```

use std::fs;
use std::path::Path;

use abbe::scene::Source;
use abbe::{Error, Lines};

use crate::support::run::{Folder, render};

const BASE: &str = include_str!("messages/base.toml");

struct Case<'a> {
    title: &'a str,
    scene: String,
    /// Names and texts of other files.
    files: Vec<(&'a str, String)>,
    settings: Vec<&'a str>,
    expected: &'a str,
}

impl<'a> Case<'a> {
    fn new(text: &'a str) -> Self {
        let (title, rest) = text.split_once('\n').expect("a heading ends its line");
        let (patch, expected) = rest.split_once("\n\n").expect("a blank line ends the patch");
        let (mut removed, mut added, mut files) = (Vec::new(), Vec::new(), Vec::<(&str, String)>::new());
        let mut settings = Vec::new();
        for line in patch.lines() {
            let (mark, line) = line.split_at(1);
            let line = line.strip_prefix(' ').unwrap_or(line);
            match mark {
                "-" => removed.push(line),
                "+" => added.push(line),
                "=" => settings.push(line),
                "@" => files.push((line, String::new())),
                ">" => files.last_mut().expect("a file has a name").1 += &format!("{line}\n"),
                other => panic!("{title}: what is {other}?"),
            }
        }
        Self { title, scene: patched(title, &removed, &added), files, settings, expected: expected.trim_end() }
    }

    /// Creates a folder with the scene and its files.
    fn folder(&self) -> Folder {
        let folder = Folder::new();
        for (name, text) in &self.files {
            folder.write(name, text);
        }
        folder.write("scene.toml", &self.scene);
        folder
    }

    /// Returns what is wrong with the answer to a scene that must be refused, if anything.
    fn failure(&self) -> Option<String> {
        let folder = self.folder();
        let before = folder.file_names();
        // A check and a render refuse a scene with the same words, and neither leaves anything behind.
        for flag in ["--check", "--exr"] {
            let settings = self.settings.iter().flat_map(|setting| ["--set", setting]);
            let answer = render(&folder, &[flag, "scene.toml"].into_iter().chain(settings).collect::<Vec<_>>());
            let reported = answer.stderr.trim_end();
            let answered = answer.code == Some(2) && answer.stdout.is_empty() && reported == self.expected;
            if !answered {
                return Some(format!("## {}\n\n{reported}\n\n(exit code {:?})", self.title, answer.code));
            }
            if folder.file_names() != before {
                return Some(format!("## {}\n\nleaves {:?}", self.title, folder.file_names()));
            }
        }
        None
    }

    /// Returns what is wrong with the answer to a scene that must be accepted with warnings, if anything.
    fn warning_failure(&self) -> Option<String> {
        let folder = self.folder();
        let answer = render(&folder, &["--check", "scene.toml"]);
        if answer.code != Some(0) || answer.stderr.trim_end() != self.expected {
            return Some(format!("## {}\n\n{}\n(exit code {:?})", self.title, answer.stderr, answer.code));
        }
        // A render gives the same warnings, each of them once.
        let warnings = |text: &str| -> Vec<String> {
            text.lines().filter(|line| line.starts_with("warning: ")).map(str::to_owned).collect()
        };
        let rendered = render(&folder, &["--exr", "scene.toml"]);
        let same = rendered.code == Some(0) && warnings(&rendered.stderr) == warnings(self.expected);
        (!same).then(|| format!("## {}, rendered\n\n{}", self.title, rendered.stderr))
    }
}

fn patched(title: &str, removed: &[&str], added: &[&str]) -> String {
    let mut lines: Vec<&str> = BASE.lines().collect();
    let places: Vec<usize> =
        (0..lines.len()).filter(|&i| !removed.is_empty() && lines[i..].starts_with(removed)).collect();
    let at = match (removed, places.as_slice()) {
        ([], _) => lines.len(),
        (_, [place]) => *place,
        _ => panic!("{title}: the lines taken out stand in the base scene {} times", places.len()),
    };
    lines.splice(at..at + removed.len(), added.iter().copied());
    lines.join("\n") + "\n"
}

fn check(table: &str, at_least: usize) {
    check_with(table, at_least, |case| case.failure());
}

fn check_with(table: &str, at_least: usize, failure: fn(&Case) -> Option<String>) {
    let table = format!("\n{}", fs::read_to_string(Path::new("tests/messages").join(table)).expect("the table exists"));
    let cases: Vec<Case> = table.split("\n## ").skip(1).map(Case::new).collect();
    assert!(cases.len() >= at_least, "only {} cases were read", cases.len());
    let failures: Vec<String> = cases.iter().filter_map(failure).collect();
    assert!(failures.is_empty(), "{} answers differ; they are now:\n\n{}", failures.len(), failures.join("\n\n"));
}

#[test]
fn the_base_scene_itself_is_valid() {
    let folder = Folder::with("scene.toml", BASE);
    let answer = render(&folder, &["--check", "scene.toml"]);
    assert_eq!((answer.code, &*answer.stderr), (Some(0), "scene.toml is a valid scene: 7 objects\n"));
}

#[test]
fn a_program_whose_main_fails_prints_the_same_message() {
    let error_text = |scene: abbe::Result<abbe::Scene>| format!("{:?}", scene.expect_err("it is wrong"));
    let reported = "there is no scene file absent.toml (a scene is a TOML file, such as scene.toml)";
    assert_eq!(error_text(abbe::Scene::read("absent.toml")), reported);
    let reported = error_text(abbe::Scene::parse(&BASE.replace("width = 4", "widht = 4"), ""));
    assert!(
        reported.starts_with("scene.toml:") && reported.ends_with(": unknown key `widht` (did you mean `width`?)"),
        "{reported}"
    );
    assert_eq!(reported.lines().count(), 1);
}

#[test]
fn unknown_keys_names_and_kinds_are_reported_with_the_nearest_correct_one() {
    check("keys.txt", 65);
}

#[test]
fn what_is_missing_is_reported_where_it_is_missing() {
    check("missing.txt", 20);
}

#[test]
fn two_kinds_in_one_place_are_refused() {
    check("kinds.txt", 12);
}

#[test]
fn values_of_the_wrong_type_are_reported_with_the_expected_type() {
    check("types.txt", 65);
}

#[test]
fn impossible_numbers_and_shapes_are_refused() {
    check("values.txt", 65);
}

#[test]
fn what_a_file_may_hold_and_what_the_camera_sees_is_checked() {
    check("film.txt", 15);
}

#[test]
fn impossible_spectra_are_refused() {
    check("spectra.txt", 125);
}

#[test]
fn files_of_spectra_are_refused_with_the_line_that_is_wrong() {
    check("spectrum_files.txt", 35);
}

#[test]
fn images_that_cannot_light_a_scene_are_refused() {
    check("images.txt", 13);
}

#[test]
fn impossible_coatings_and_films_are_refused() {
    check("coatings.txt", 13);
}

#[test]
fn impossible_dyes_are_refused() {
    check("fluorescence.txt", 11);
}

#[test]
fn images_and_patterns_that_cannot_lie_on_a_surface_are_refused() {
    check("textures.txt", 30);
}

#[test]
fn images_that_cannot_bend_normals_are_refused() {
    check("relief.txt", 12);
}

#[test]
fn warnings_are_printed_once_and_stop_nothing() {
    check_with("warnings.txt", 10, |case| case.warning_failure());
}

#[test]
fn a_file_of_a_spectrum_that_is_not_text_is_refused() {
    let folder = Folder::with("paint.csv", b"\xff\xfe4\x000\x000\x00");
    folder.write("scene.toml", BASE.replace("reflectance = 0.7", "reflectance = { file = \"paint.csv\" }"));
    let expected = "\
error: paint.csv is not text in UTF-8: line 1 has the byte 0xFF in column 1
  --> scene.toml:14:36
   |
14 | diffuse = { reflectance = { file = \"paint.csv\" } }
   |                                    ^^^^^^^^^^^
   |
   = help: it begins like UTF-16: save it as UTF-8
";
    let answer = render(&folder, &["--check", "scene.toml"]);
    assert_eq!((answer.code, &*answer.stderr), (Some(2), expected));
}

#[test]
fn a_file_of_another_kind_that_is_given_as_a_scene_is_called_what_it_is() {
    let export = "export its meshes as PLY, OBJ or glTF, and write a scene in TOML around them";
    let kinds = [
        ("room.pbrt", "WorldBegin\nLightSource \"infinite\"\n", "a pbrt scene", export),
        ("room.XML", "<?xml version='1.0'?>\n<scene version='3.0.0'/>\n", "XML, as Mitsuba scenes are", export),
        ("room.blend", "BLENDER-v300\u{0}", "a Blender file", export),
        ("room.usda", "#usda 1.0\ndef Xform \"room\" {}\n", "a USD scene", export),
        (
            "cup.obj",
            "v 0 0 0\nf 1 1 1\n",
            "a mesh",
            "in a scene, which is a TOML file, write it as shape.mesh = { file = \"cup.obj\" }; README.md begins with \
             an example",
        ),
        (
            "wood.png",
            "\u{1}PNG",
            "an image",
            "in a scene, which is a TOML file, write it as { image = \"wood.png\" } in place of a color",
        ),
        ("old.exr", "v/1\u{1}", "an image", "`render view old.exr` shows it; a scene is a TOML file"),
        (
            "scene.json",
            "{ \"camera\": {} }",
            "JSON or YAML",
            "a scene is a TOML file: key = value lines below headings such as [camera]",
        ),
    ];
    for (name, text, what, help) in kinds {
        let answer = render(&Folder::with(name, text), &[name, "--check"]);
        answer.assert_refused(2, &format!("error: {name} is {what}, not a scene in TOML\nhelp: {help}\n"));
        // A scene file may have any name.
        assert_eq!(render(&Folder::with(name, BASE), &[name, "--check"]).code, Some(0), "{name}");
    }
}

#[test]
fn an_image_without_light_causes_one_warning_and_none_where_it_is_intended() {
    let dim = BASE.replace("radiance = 1 }", "radiance = 1 }\nvisible_to_camera = false");
    let dim = dim.replace("samples = 1", "samples = 1\nmax_bounces = 0").replace("[0, 4, 0]", "[0, 40, 0]");
    let black = "warning: no light was found in any pixel within max_bounces = 0, so the image is black\n";
    let reported = |scene: &str, flags: &[&str]| {
        let answer = render(&Folder::with("scene.toml", scene), &[&["scene.toml"], flags].concat());
        assert_eq!(answer.code, Some(0), "{}", answer.stderr);
        answer.stderr.matches("warning: ").count() == 1 && answer.stderr.contains(black)
    };
    assert!(reported(&dim, &[]));
    assert!(!reported(&dim, &["--layers", "N"]));
    assert!(!reported(&dim.replace("material = \"gold\"", "material = \"gold\"\nholdout = true"), &[]));
    assert!(!reported(&dim.replace("max_bounces = 0", "max_bounces = 1"), &[]));
    let dark = BASE.replace("radiance = 10 }", "radiance = 0 }").replace("radiance = 1 }", "radiance = 0 }");
    let dark = Folder::with("scene.toml", dark.replace("intensity = 10 }", "intensity = 0 }"));
    let warned = "warning: nothing emits light, so the image will be black\nscene.toml is a valid scene: 7 objects\n";
    render(&dark, &["scene.toml", "--check"]).assert_refused(0, warned);
    assert_eq!(render(&dark, &["scene.toml"]).stderr.matches("warning: ").count(), 1);
}

#[test]
fn settings_and_variables_are_refused_where_they_stand() {
    check("settings.txt", 35);
}

#[test]
fn mistakes_in_included_files_are_reported_with_their_file_and_line() {
    check("includes.txt", 14);
}

#[test]
fn text_that_is_not_toml_is_reported_in_plain_words() {
    check("syntax.txt", 25);
}

#[test]
fn impossible_instances_and_broken_gltf_files_are_refused() {
    check("instances.txt", 11);
}

#[test]
fn broken_mesh_files_are_refused_with_the_place_in_the_scene() {
    check("meshes.txt", 25);
}

#[test]
fn several_mistakes_are_reported_at_once_in_the_order_of_the_file_and_counted() {
    check("several.txt", 14);
}

#[test]
fn of_many_mistakes_the_first_twenty_are_shown_and_all_are_counted() {
    let folder = Folder::new();
    let ball = "[[object]]\nshape.sphere = { center = [0, 1, 0], radius = 0 }\nmaterial = \"white\"\n";
    folder.write("scene.toml", format!("{BASE}{}", ball.repeat(27)));
    let answer = render(&folder, &["--check", "scene.toml"]);
    let reported = answer.stderr.matches("error: a radius is a length above 0, not 0\n").count();
    assert_eq!((answer.code, reported), (Some(2), 20), "{}", answer.stderr);
    assert!(answer.stderr.ends_with("\n\n27 mistakes in scene.toml: these and 7 more\n"), "{}", answer.stderr);
}

#[test]
fn of_very_many_mistakes_each_has_its_place_and_the_first_hundred_say_what_was_meant() {
    let ball = |i: usize| {
        let sphere = format!("{{ \"\u{e9}\" = 1, center = [0, 1, 0], radius = \"$wide-lens{i}\" }}");
        format!("[[object]]\nshape.sphere = {sphere}\nmaterial = \"white\"\n")
    };
    let text = format!("set.wide-lens = 1\n{BASE}{}", (0..300).map(ball).collect::<String>());
    let Err(error) = (Source { path: "scene.toml".into(), text: text.clone() }).compile() else { panic!("a mistake") };
    let reported = error.to_string();
    let Error::Scene(mistakes) = error else { panic!("{error}") };
    let lines: Vec<&str> = reported.lines().collect();
    assert_eq!((lines.len(), mistakes.len()), (300, 300));
    let mut backward = Lines::default();
    for (i, mistake) in mistakes.iter().enumerate().rev() {
        let at = text.find(&format!("\"$wide-lens{i}\"")).expect("it stands there");
        let place = (text[..at].lines().count(), text[..at].lines().last().map_or(0, |line| line.chars().count()) + 1);
        assert_eq!([mistake.line_and_column(), backward.place_of(mistake)], [place; 2], "{i}");
        let help = if i < 100 { " (did you mean \"$wide-lens\"?)" } else { "" };
        let (line, column) = place;
        assert_eq!(lines[i], format!("scene.toml:{line}:{column}: there is no variable `wide-lens{i}`{help}"));
    }
}

#[test]
fn of_very_many_materials_a_hundred_are_named() {
    let more: String = (0..200).map(|i| format!("[material.x{i}]\ndiffuse = {{ reflectance = 0.5 }}\n")).collect();
    let ball = "[[object]]\nshape.sphere = { center = [0, 1, 0], radius = 1 }\n";
    let count = BASE.matches("[material.").count() + 200 - 100;
    for (material, help) in [("material = \"porcelain\"\n", "the scene defines "), ("", "give it one, as in ")] {
        let folder = Folder::with("scene.toml", format!("{BASE}{more}{ball}{material}"));
        let reported = render(&folder, &["--check", "scene.toml"]).stderr;
        let line =
            reported.lines().find_map(|line| line.strip_prefix("   = help: ").or(line.trim().strip_prefix("= help: ")));
        let line = line.unwrap_or_else(|| panic!("{reported}"));
        assert!(line.starts_with(help) && line.ends_with(&format!(" and {count} more")), "{reported}");
    }
}

/// The number of parts doubles with every material, and a chain has thousands of them. Each mistake is reported once
/// and takes no time.
#[test]
fn materials_that_are_made_of_too_many_others_are_refused() {
    let make_scene = |count: usize, second: &dyn Fn(usize) -> String| {
        let mix = |i: usize| {
            format!("[material.x{i}]\nmix = {{ materials = [\"x{}\", \"{}\"], amount = 0.5 }}\n", i + 1, second(i))
        };
        let last = format!("[material.x{count}]\ndiffuse = {{ reflectance = 0.5 }}\n");
        format!("{BASE}{}{last}", (0..count).map(mix).collect::<String>())
    };
    for (text, expected) in [
        (make_scene(30, &|i| format!("x{}", i + 1)), "error: material \"x0\" is made of more than 1000 others\n"),
        (make_scene(3000, &|_| "white".into()), "error: material \"x0\" is made of others nested more than 64 deep\n"),
    ] {
        let folder = Folder::with("scene.toml", &text);
        let answer = render(&folder, &["--check", "scene.toml"]);
        assert_eq!(answer.code, Some(2), "{}", answer.stderr);
        assert!(answer.stderr.starts_with(expected), "{}", answer.stderr);
        assert_eq!(answer.stderr.matches("error: ").count(), 1, "{}", answer.stderr);
    }
    let folder = Folder::with("scene.toml", make_scene(8, &|i| format!("x{}", i + 1)));
    assert_eq!(render(&folder, &["--check", "scene.toml"]).code, Some(0));
}

#[test]
fn an_empty_scene_asks_for_a_camera_and_a_film() {
    let folder = Folder::with("scene.toml", "");
    let expected = "\
error: the scene has no [camera] and no [film]
 --> scene.toml:1:1
  |
1 |
  | ^
  |
  = help: every scene needs [camera] and [film]
";
    let answer = render(&folder, &["--check", "scene.toml"]);
    assert_eq!((answer.code, &*answer.stderr), (Some(2), expected));
}

#[test]
fn lines_that_end_as_on_windows_are_counted_and_shown_alike() {
    let folder = Folder::with("scene.toml", BASE.replacen("radius = 1 }", "radius = 0 }", 1).replace('\n', "\r\n"));
    let expected = "\
error: a radius is a length above 0, not 0
  --> scene.toml:31:47
   |
31 | shape.sphere = { center = [0, 1, 0], radius = 0 }
   |                                               ^
";
    let answer = render(&folder, &["--check", "scene.toml"]);
    assert_eq!((answer.code, &*answer.stderr), (Some(2), expected));
}

#[test]
fn lines_that_end_as_on_old_macintoshes_are_refused_in_plain_words() {
    let folder = Folder::with("scene.toml", "[camera]\rposition = [0, 1, 6]\r");
    let answer = render(&folder, &["--check", "scene.toml"]);
    assert!(answer.stderr.starts_with("error: a carriage return alone does not end a line\n --> scene.toml:1:10\n"));
    assert!(answer.stderr.contains("= help: save the file with Unix or Windows line endings\n"), "{}", answer.stderr);
}

#[test]
fn a_byte_order_mark_does_not_move_the_column() {
    let folder = Folder::with("scene.toml", format!("\u{feff}{}", BASE.replace("[camera]", "[kamera]")));
    let answer = render(&folder, &["--check", "scene.toml"]);
    assert!(answer.stderr.contains("--> scene.toml:1:2\n"), "{}", answer.stderr);
}

#[test]
fn mistakes_in_a_table_that_a_program_has_built_are_reported_by_their_keys() {
    let mut scene: abbe::toml::Table = toml::from_str(BASE).expect("TOML");
    assert_eq!(abbe::Scene::from_table(&scene, "").expect("a scene").objects.len(), 7);
    let reported = |scene: &abbe::toml::Table| abbe::Scene::from_table(scene, "").expect_err("mistakes").to_string();
    scene["object"][1]["shape"]["sphere"]["radius"] = 0.into();
    scene["material"]["glass"]["dielectric"]["index"] = "N-BK8".into();
    scene["light"][0].as_table_mut().expect("a table").insert("nam".into(), "sky".into());
    let mut mistakes: Vec<String> = reported(&scene).lines().map(str::to_owned).collect();
    mistakes.sort();
    let expected = [
        "light[0].nam: unknown key `nam` (did you mean `name`?)",
        "material.glass.dielectric.index: there is no glass named \"N-BK8\" (did you mean \"N-BK7\"?)",
        "object[1].shape.sphere.radius: a radius is a length above 0, not 0",
    ];
    assert_eq!(mistakes, expected);
    scene.remove("film");
    assert!(reported(&scene).starts_with("the scene has no [film] (every scene needs [camera] and [film])\n"));
}

#[test]
fn a_mesh_file_may_have_comments_in_any_encoding() {
    let folder = Folder::with("cup.obj", b"# caf\xe9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let inline = "{ points = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], faces = [[0, 1, 2]] }";
    folder.write("scene.toml", BASE.replace(inline, "{ file = \"cup.obj\" }"));
    assert_eq!(render(&folder, &["--check", "scene.toml"]).code, Some(0));
}

#[test]
fn a_mesh_is_looked_for_beside_its_scene() {
    let inline = "{ points = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], faces = [[0, 1, 2]] }";
    let folder = Folder::with("scenes/scene.toml", BASE.replace(inline, "{ file = \"cup.obj\" }"));
    folder.write("scenes/cup.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    assert_eq!(render(&folder, &["--check", "scenes/scene.toml"]).code, Some(0));
}

#[cfg(unix)]
#[test]
fn a_device_in_place_of_a_file_is_refused() {
    for (whole, device) in [
        ("reflectance = 0.7", "reflectance = { file = \"/dev/zero\" }"),
        ("environment = { radiance = 1 }", "environment = { radiance = { image = \"/dev/zero\" } }"),
    ] {
        let folder = Folder::with("scene.toml", BASE.replace(whole, device));
        let answer = render(&folder, &["--check", "scene.toml"]);
        assert_eq!(answer.code, Some(2));
        assert!(answer.stderr.starts_with("error: /dev/zero is a device, not a file\n"), "{}", answer.stderr);
    }
}
