//! Values that replace those of a scene, its variables, and the files that it includes.

use std::fs;

use abbe::film::Window;
use abbe::scene::{Scene, Source};
use abbe::{Error, Options, Rendering};

use crate::support::run::Folder;

const SCENE: &str = r#"
camera = { position = [0, 1, 6], look_at = [0, 1, 0], vertical_fov = 35 }
film = { width = 6, height = 4 }
material.white.diffuse.reflectance = 0.7
material.gold.conductor.metal = "Au"
light = [{ environment = { radiance = 1 } }, { name = "key", point = { position = [0, 3, 3], intensity = 10 } }]

[[object]]
name = "ball"
shape.sphere = { center = [0, 1, 0], radius = 1 }
material = "white"

[[object]]
name = "big \"b.ll\""
shape.sphere = { center = [3, 1, 0], radius = 1 }
material = "white"
transform = [{ scale = 1 }, { translate = [0, 0, 0] }]
"#;

fn scene_with(text: &str, settings: &[&str]) -> Scene {
    let source = Source { path: "scene.toml".into(), text: text.to_owned() };
    let settings: Vec<String> = settings.iter().map(|setting| (*setting).to_owned()).collect();
    source.compile_with(&settings).unwrap_or_else(|error| panic!("{settings:?}: {error}"))
}

/// Returns everything in a scene except its hash, its files and its settings.
fn debug_text(scene: Scene) -> String {
    let mut scene = scene;
    (scene.hash, scene.files, scene.settings) = Default::default();
    format!("{scene:?}")
}

/// Asserts that settings make the same scene as the file with `old` replaced by `new`.
fn assert_replaces(settings: &[&str], old: &str, new: &str) {
    assert_eq!(SCENE.matches(old).count(), 1, "{old}");
    let (set, written) = (scene_with(SCENE, settings), scene_with(&SCENE.replace(old, new), &[]));
    assert_ne!(set.hash, scene_with(SCENE, &[]).hash, "{settings:?}");
    let (set, written) = (debug_text(set), debug_text(written));
    assert_eq!(set, written, "{settings:?}");
    assert_ne!(set, debug_text(scene_with(SCENE, &[])), "{settings:?} changes nothing");
}

#[test]
fn a_setting_means_what_the_same_value_in_the_file_means() {
    assert_replaces(&["film.width=8"], "width = 6", "width = 8");
    assert_replaces(&["film={width=8,height=4}"], "width = 6", "width = 8");
    assert_replaces(&[" film . width = 8 # columns"], "width = 6", "width = 8");
    assert_replaces(&["render.samples=3"], "film =", "render.samples = 3\nfilm =");
    assert_replaces(&["camera.position=[0, 2, 6]"], "position = [0, 1, 6]", "position = [0, 2, 6]");
    assert_replaces(&["camera.position.2=2"], "position = [0, 1, 6]", "position = [0, 2, 6]");
    assert_replaces(&["material.white.diffuse.reflectance=0.5"], "reflectance = 0.7", "reflectance = 0.5");
    let hidden = "name = \"ball\"\nvisible_to_camera = false";
    assert_replaces(&["object.ball.visible_to_camera=false"], "name = \"ball\"", hidden);
    let silver = ["material.silver={mirror={}}", "object.1.material=silver"];
    let written = SCENE.replacen("\"white\"", "\"silver\"", 1).replace("film =", "material.silver.mirror = {}\nfilm =");
    assert_eq!(debug_text(scene_with(SCENE, &silver)), debug_text(scene_with(&written, &[])));
}

#[test]
fn entries_of_lists_go_by_name_or_number() {
    let ball = "center = [0, 1, 0], radius = 1";
    assert_replaces(&["object.ball.shape.sphere.radius=0.5"], ball, "center = [0, 1, 0], radius = 0.5");
    assert_replaces(&["object.1.shape.sphere.radius=0.5"], ball, "center = [0, 1, 0], radius = 0.5");
    let big = "center = [3, 1, 0], radius = 1";
    assert_replaces(&[r#"object."big \"b.ll\"".shape.sphere.radius=0.5"#], big, "center = [3, 1, 0], radius = 0.5");
    assert_replaces(&[r#"object.'big "b.ll"'.shape.sphere.radius=0.5"#], big, "center = [3, 1, 0], radius = 0.5");
    let text = SCENE.replace("\"ball\"", "\"wine glass\"");
    let written = text.replacen("\"white\"", "\"gold\"", 1);
    for setting in ["object.wine glass.material=gold", r#"object."wine glass".material="gold""#] {
        assert_eq!(debug_text(scene_with(&text, &[setting])), debug_text(scene_with(&written, &[])), "{setting}");
    }
    assert_replaces(&["light.key.point.intensity=5"], "intensity = 10", "intensity = 5");
    assert_replaces(&["light.2.point.intensity=5"], "intensity = 10", "intensity = 5");
    let (old, new) = ("{ translate = [0, 0, 0] }", "{ translate = [0, 1, 0] }");
    assert_replaces(&["object.2.transform.2={ translate = [0, 1, 0] }"], old, new);
    assert_replaces(&["object.2.transform.2.translate.2=1"], old, new);
}

#[test]
fn what_is_not_toml_is_a_text_and_the_last_of_several_settings_counts() {
    let with_material = |material: &str| SCENE.replacen("\"white\"", material, 1);
    for settings in [&["object.ball.material=gold"][..], &["object.ball.material=\"gold\""]] {
        assert_eq!(debug_text(scene_with(SCENE, settings)), debug_text(scene_with(&with_material("\"gold\""), &[])));
    }
    assert_eq!(scene_with(SCENE, &["film.width=8", "film.width=10"]).film.width, 10);
    assert_eq!(scene_with(SCENE, &["film={width=8,height=2}", "film.width=10"]).film.height, 2);
    // A name takes precedence over a number.
    let text = SCENE.replace("name = \"ball\"", "name = \"2\"");
    let radius = |settings: &[&str]| debug_text(scene_with(&text, settings));
    let first = text.replace("center = [0, 1, 0], radius = 1", "center = [0, 1, 0], radius = 0.5");
    assert_eq!(radius(&["object.2.shape.sphere.radius=0.5"]), debug_text(scene_with(&first, &[])));
}

#[test]
fn the_hash_is_that_of_the_file_and_all_settings() {
    let hash = |settings: &[&str]| scene_with(SCENE, settings).hash;
    let all = [&[][..], &["film.width=8"], &["film.width=9"], &["film.width=8", "film.height=5"]].map(hash);
    let distinct: std::collections::BTreeSet<_> = all.iter().collect();
    assert_eq!(distinct.len(), all.len());
    assert_eq!(scene_with(SCENE, &["film.width=8"]).settings, ["film.width=8"]);
}

#[test]
fn a_variable_stands_for_its_value_wherever_that_is_meant() {
    let text = SCENE
        .replace("vertical_fov = 35", "vertical_fov = \"$angle\"")
        .replace("position = [0, 3, 3]", "position = [0, \"$height\", 3]")
        .replace("reflectance = 0.7", "reflectance = \"$paint\"")
        .replace("radius = 1 }\nmaterial = \"white\"\n\n", "radius = 1 }\nmaterial = \"$first\"\n\n");
    let text = format!("{text}\n[set]\nangle = 35\nheight = 3\npaint = 0.7\nfirst = \"white\"\n");
    assert_eq!(debug_text(scene_with(&text, &[])), debug_text(scene_with(SCENE, &[])));
    let written = SCENE.replace("vertical_fov = 35", "vertical_fov = 45");
    for settings in [&["angle=45"][..], &["set.angle=45"], &["angle=10", "angle=45.0"]] {
        assert_eq!(debug_text(scene_with(&text, settings)), debug_text(scene_with(&written, &[])), "{settings:?}");
    }
    let written = SCENE.replace("reflectance = 0.7", "reflectance = { rgb = [0.5, 0.4, 0.3] }");
    assert_eq!(debug_text(scene_with(&text, &["paint={rgb=[0.5, 0.4, 0.3]}"])), debug_text(scene_with(&written, &[])));
    // A setting may use a variable.
    assert_eq!(scene_with(&text, &["film.width=\"$height\""]).film.width, 3);
    // The number of a frame is a variable that no scene has to define.
    let text = SCENE.replace("vertical_fov = 35", "vertical_fov = \"$frame\"");
    assert_eq!(debug_text(scene_with(&text, &["frame=45"])), debug_text(scene_with(&text, &["set.frame=45"])));
    assert_eq!(scene_with(SCENE, &["frame=45"]).warnings, scene_with(SCENE, &[]).warnings);
}

#[test]
fn a_doubled_dollar_is_a_dollar_and_unused_variables_are_reported() {
    let text = SCENE.replace("name = \"ball\"", "name = \"$$angle\"");
    assert_eq!(scene_with(&text, &[]).objects[0].name, "$angle");
    let text = SCENE.replace("name = \"ball\"", "name = \"$5\"");
    assert_eq!(scene_with(&text, &[]).objects[0].name, "$5");
    let text = SCENE.replace("name = \"ball\"", "name = \"$label\"") + "\n[set]\nlabel = \"$$5\"\n";
    assert_eq!(scene_with(&text, &[]).objects[0].name, "$5");
    assert_eq!(scene_with(&text, &["label=\"$$6\""]).objects[0].name, "$6");
    let scene = scene_with(&format!("{SCENE}\n[set]\nangle = 3\nframe = 1\n"), &[]);
    assert!(scene.warnings.contains(&"variable angle is not used".to_owned()), "{:?}", scene.warnings);
    assert!(!scene.warnings.iter().any(|warning| warning.contains("frame")), "{:?}", scene.warnings);
}

fn folder_with(files: &[(&str, &str)]) -> Folder {
    let folder = Folder::new();
    files.iter().for_each(|(name, text)| folder.write(name, text));
    folder
}

fn read(folder: &Folder) -> Scene {
    Scene::read(folder.path_of("scene.toml")).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn included_files_stand_in_the_scene_as_if_they_were_written_there() {
    let (head, objects) = SCENE.split_at(SCENE.find("[[object]]").unwrap_or_default());
    let gold = "material.gold.conductor.metal = \"Au\"\n";
    let second = objects.rfind("[[object]]").unwrap_or_default();
    let scene =
        format!("include = [\"parts/all.toml\", \"gold.toml\"]\n{}{}", head.replace(gold, ""), &objects[..second]);
    let folder = folder_with(&[
        ("scene.toml", &scene),
        // A file that is included twice, by two paths, is one file.
        ("parts/all.toml", "include = [\"ball.toml\", \"../gold.toml\", \"./ball.toml\"]\n"),
        ("parts/ball.toml", &objects[second..]),
        ("gold.toml", gold),
    ]);
    let whole = read(&folder);
    assert_eq!(whole.objects.iter().map(|object| &*object.name).collect::<Vec<_>>(), ["ball", "big \"b.ll\""]);
    let files = whole.files.iter().map(|file| file.strip_prefix(fs::canonicalize(folder.path()).expect("it is there")));
    let files: Vec<String> = files.map(|file| file.expect("all lie within").display().to_string()).collect();
    assert_eq!(files, ["scene.toml", "parts/all.toml", "parts/ball.toml", "gold.toml"]);
    let hash = whole.hash.clone();
    assert_eq!(debug_text(whole), debug_text(scene_with(SCENE, &[])));
    folder.write("gold.toml", format!("{gold}# other\n"));
    assert_ne!(read(&folder).hash, hash);
}

/// A text from a program is called `scene.toml` but is no file. A file of that name is a different one.
#[test]
fn a_text_includes_a_file_called_scene() {
    let gold = "material.gold.conductor.metal = \"Au\"\n";
    let folder = folder_with(&[("scene.toml", gold)]);
    let text = format!("include = [\"scene.toml\"]\n{}", SCENE.replace(gold, ""));
    let scene = Scene::parse(&text, folder.path()).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(scene.files.len(), 1, "{:?}", scene.files);
    let alone = Scene::parse("include = [\"scene.toml\"]", "").err().map(|error| error.to_string());
    assert!(alone.is_some_and(|reported| reported.contains("scene.toml") && !reported.contains("includes itself")));
}

#[test]
fn files_are_named_from_the_folder_of_the_file_that_names_them() {
    let paint = SCENE.replace("reflectance = 0.7", "reflectance = { file = \"paint.csv\" }");
    let other = "material.other.diffuse.reflectance = { file = \"paint.csv\" }\n";
    let folder = folder_with(&[
        ("scene.toml", &format!("include = [\"parts/other.toml\"]\n{paint}")),
        ("paint.csv", "400, 0.25\n700, 0.25\n"),
        ("parts/other.toml", other),
        ("parts/paint.csv", "400, 0.75\n700, 0.75\n"),
    ]);
    let set = |settings: &[&str]| {
        let source = Source::read(folder.path_of("scene.toml")).expect("the scene can be read");
        let settings: Vec<String> = settings.iter().map(|setting| (*setting).to_owned()).collect();
        format!("{:?}", source.compile_with(&settings).expect("the scene is right").materials)
    };
    let own = set(&[]);
    assert!(own.contains("0.25") && !own.contains("0.75"), "{own}");
    let other = set(&["object.1.material=other", "object.2.material=other"]);
    assert!(other.contains("0.75") && !other.contains("0.25"), "{other}");
    // Paths in a setting are relative to the folder of the scene.
    let set = set(&["material.white.diffuse.reflectance={ file = \"parts/paint.csv\" }"]);
    assert!(set.contains("0.75"), "{set}");
}

#[test]
fn a_scene_that_a_program_has_built_may_include_files_and_reports_mistakes_in_them() {
    let folder = folder_with(&[("gold.toml", "[material.copper]\nconductor = { metal = \"Cu\", roughnes = 1 }\n")]);
    let table: abbe::toml::Table = format!("include = [\"gold.toml\"]\n{SCENE}").parse().expect("it is TOML");
    let refusal = Scene::from_table(&table, folder.path()).expect_err("a key is misspelt").to_string();
    assert!(refusal.ends_with("gold.toml:2:29: unknown key `roughnes` (did you mean `roughness`?)"), "{refusal}");
    let table: abbe::toml::Table = SCENE.replace("= 35", "= \"$angle\"").parse().expect("it is TOML");
    let refusal = Scene::from_table(&table, "").expect_err("there is no such variable").to_string();
    assert!(refusal.starts_with("camera.vertical_fov: there is no variable `angle`"), "{refusal}");
}

/// Returns the message that refuses a scene that a program has changed, or the options for it.
fn refusal(options: Options, change: impl FnOnce(&mut Scene)) -> String {
    let mut scene = scene_with(SCENE, &[]);
    change(&mut scene);
    match Rendering::new(&scene, &options) {
        Err(Error::Arguments { message, help: Some(_) }) => message,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_scene_that_a_program_has_changed_is_checked_as_options_are() {
    let refused_change = |change: fn(&mut Scene)| refusal(Options::default(), change);
    assert_eq!(
        refused_change(|scene| scene.film.width = 0),
        "an image has at least 1 pixel along each side, not 0 x 4"
    );
    assert_eq!(refused_change(|scene| scene.render.samples = Some(0)), "a pixel needs at least 1 sample");
    let error = "a relative error lies between 0.000001 and 1, not -1";
    assert_eq!(refused_change(|scene| scene.render.error = Some(-1.0)), error);
    let crop = "this crop ends at column 9, row 4, but the image has 6 x 4 pixels";
    let beyond = Window { left: 0, top: 0, width: 9, height: 4 };
    assert_eq!(refusal(Options { crop: Some(beyond), ..Options::default() }, |_| ()), crop);
    assert_eq!(refusal(Options::default(), |scene| scene.film.crop = Some(beyond)), crop);
}

#[test]
fn no_more_threads_are_started_than_a_machine_bears() {
    for threads in [0, 1025, usize::MAX] {
        let options = Options { threads: Some(threads), ..Options::default() };
        assert_eq!(refusal(options, |_| ()), "a render has 1 to 1024 threads");
    }
}

#[test]
fn an_error_can_be_boxed_and_sent_to_another_thread() {
    let error = Scene::parse("film = 3", "").expect_err("a film has a width and a height");
    let boxed: Box<dyn std::error::Error + Send + Sync> = error.into();
    assert!(boxed.to_string().starts_with("scene.toml:1:"), "{boxed}");
}
