//! Every scene in `scenes/` compiles without a warning, renders, and is planned as its first lines promise.
//!
//! ```text
//! cargo test --test all scenes::
//! ```

use std::fs;
use std::path::Path;

use abbe::plan::{Plan, plan};
use abbe::scene::Scene;
use abbe::spectrum::Curve;
use abbe::trace::{Transport, prepare, render};

use crate::support::repository::scenes;

/// Compiles a scene at its own size, or at a given width with one sample.
fn compiled(path: &Path, width: Option<u32>) -> Scene<Curve> {
    let Some(width) = width else { return Scene::read(path).unwrap_or_else(|error| panic!("{error}")) };
    let mut scene: toml::Table = toml::from_str(&fs::read_to_string(path).expect("a scene")).expect("TOML");
    let film = scene["film"].as_table_mut().expect("a scene has a film");
    let whole = ["width", "height"].map(|key| film[key].as_integer().expect("a number") as u32);
    film.insert("width".into(), width.into());
    film.insert("height".into(), (whole[1] * width).div_ceil(whole[0]).into());
    let render = scene.entry("render").or_insert_with(|| toml::Table::new().into());
    render.as_table_mut().expect("a table").insert("samples".into(), 1.into());
    Scene::from_table(&scene, path.parent().expect("a folder")).unwrap_or_else(|error| panic!("{error}"))
}

fn planned(name: &str) -> (Plan, String) {
    let plan = plan(&compiled(&Path::new("scenes").join(name).with_extension("toml"), None));
    let because = plan.because.join("\n");
    (plan, because)
}

fn assert_says(because: &str, what: &str) {
    assert!(because.contains(what), "the plan does not say \"{what}\":\n{because}");
}

#[test]
fn every_scene_compiles_without_a_warning_and_says_what_to_look_for() {
    let paths = scenes();
    assert!(paths.len() >= 4, "only {} scenes", paths.len());
    for path in paths {
        let warnings = compiled(&path, None).warnings;
        assert!(warnings.is_empty(), "{}: {warnings:?}", path.display());
        let text = fs::read_to_string(&path).expect("a scene");
        assert!(text.starts_with("# "), "{} does not begin with a comment", path.display());
    }
}

#[test]
fn a5_every_scene_renders_without_a_number_that_is_not_finite() {
    for path in scenes() {
        let scene = compiled(&path, Some(96));
        let (film, report) = render(&prepare(&scene, plan(&scene).method), &|_| ());
        assert_eq!((report.non_finite, report.unmatched), (0, 0), "{}", path.display());
        assert_eq!(report.samples, film.pixels.len() as u64, "{}", path.display());
        let finite =
            |pixel: &abbe::film::Pixel| pixel.rgb.iter().chain([&pixel.alpha, &pixel.depth]).all(|x| x.is_finite());
        assert!(film.pixels.iter().all(finite), "{}", path.display());
        let lit = film.pixels.iter().filter(|pixel| pixel.rgb.iter().any(|&x| x > 0.0)).count();
        assert!(lit * 10 > film.pixels.len(), "{}: {lit} of {} pixels are lit", path.display(), film.pixels.len());
    }
}

#[test]
fn scenes_without_chance_are_planned_with_one_exact_sample() {
    for name in ["classic", "spheres"] {
        let (plan, because) = planned(name);
        assert!(matches!(plan.method.transport, Transport::Deterministic { .. }), "{name}: {because}");
        assert_eq!(plan.method.samples, 1, "{name}");
        assert_says(&because, "transport deterministic: no random light path");
    }
}

#[test]
fn the_plan_of_the_classic_scene_parts_lanes_in_every_dispersive_glass() {
    let (_, because) = planned("classic");
    for glass in ["crown", "flint", "diamond", "pond"] {
        let line = because.lines().find(|line| line.starts_with(&format!("material {glass}:")));
        assert_says(line.expect("a line about the glass"), "so lanes separate");
    }
    assert_says(&because, "material ruby: index 1.5200 in every lane, so lanes stay together");
    assert_says(&because, "diffuse surfaces receive only direct light");
}

#[test]
fn the_smallpt_scene_is_planned_as_a_path_tracer_of_three_lanes_that_stay_together() {
    let (plan, because) = planned("smallpt");
    assert!(matches!(plan.method.transport, Transport::Random { .. }), "{because}");
    assert_eq!(plan.method.diffuse_bounces, u32::MAX);
    assert_says(&because, "model rgb: 3 lanes");
    assert_says(&because, "in every lane, so lanes stay together");
    assert_says(&because, "light leaves left wall in every direction");
    // The visible tip has 0.14 sr, the whole sphere 2.8.
    assert_says(&because, "photons from lamp (solid angle 2.0e-1 sr) toward 2 smooth objects");
    assert!(!because.contains("lanes separate"), "{because}");
}

#[test]
fn the_plan_of_the_prism_scene_lets_wavelengths_part() {
    let (plan, because) = planned("prism");
    assert!(matches!(plan.method.transport, Transport::Random { .. }), "{because}");
    assert!(plan.method.basis.draws_wavelengths(), "{because}");
    assert_says(
        &because,
        "model hero 12 + 4: 16 lanes: 12 fixed wavelengths and 4 hero wavelengths, drawn anew for each sample; dispersion is seen",
    );
    assert_says(&because, "so wavelengths separate");
    assert_says(&because, "lanes separate in ");
}

#[test]
fn the_rainbow_scene_is_planned_with_photons_that_part() {
    let (plan, because) = planned("rainbow");
    assert!(plan.method.light_pass.is_some() && plan.method.basis.draws_wavelengths(), "{because}");
    assert_says(&because, "photons from the sun toward prism");
}
