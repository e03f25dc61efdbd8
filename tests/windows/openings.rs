//! Openings that light a room, however small: bounces are aimed at them, since hardly any would find them by chance.

use abbe::plan::plan;
use abbe::trace::{BrightPlaces, prepare_unguided, room_light};

use super::bright::{SUN, WHITE, assert_same, films, room, upright, variance, walls};
use crate::support::scenes::{Mean, SPLITTING, body, environment, method, scene, view};

fn openings(text: &str) -> BrightPlaces {
    let scene = scene(text);
    room_light(&prepare_unguided(&scene, method(&scene, SPLITTING))).openings.expect("the room has openings")
}

/// A bounce from the visible point of the floor finds the sky through this slit once in 50,000 times. All bounces begin
/// at the slit: the room is known by where they end.
#[test]
fn l13_a_slit_that_no_bounce_finds_gives_its_form_factor() {
    let walls = walls(&[[-5e-4, 5e-4]]);
    let text = view([0.5, 2.0, 0.0], [0.500_01, 0.0, 0.0], 0.05, 8)
        + "[render]\nsamples = 64\n"
        + &body("wall", "diffuse = { reflectance = 0 }", &walls.iter().skip(1).map(String::as_str).collect::<Vec<_>>())
        + &body("floor", "diffuse = { reflectance = 0.5 }", &[walls[0].as_str()])
        + &environment(2.0);
    let factor_to = |height: f64| 2.0 * upright(2.5, 5e-4, height);
    let share = factor_to(2.2) - factor_to(1.0);
    assert!((share - 2e-5).abs() < 2e-6, "{share} of the bounces find it");
    let scene = scene(&text);
    assert!(scene.warnings.iter().all(|line| !line.contains("lights nothing")), "{:?}", scene.warnings);
    let decided = plan(&scene);
    let because =
        "bounces in the room are aimed at 1 opening that lets light in; otherwise, hardly any would find light";
    assert!(decided.because.iter().any(|line| line == because), "{:?}", decided.because);
    let found = Mean::over_seeds(&films(&text, decided.method.bright.as_ref(), 8));
    println!("{found:?} for {}, {:?}", 0.5 * 2.0 * share, decided.method.bright);
    found.assert_near([0.5 * 2.0 * share; 3], 1, "a slit");
    assert!(found.worst_relative_error([0.5 * 2.0 * share; 3]) < 0.005, "{found:?}");
}

#[test]
fn bounces_aimed_at_openings_show_the_same_rooms_as_others() {
    let pane =
        body("pane", "thin = { index = 1.5 }", &["quad = { center = [-2, 1.6, 0], u = [0, 0, 2.5], v = [0, 0.6, 0] }"]);
    let table = body(
        "table",
        "plastic = { reflectance = 0.5, roughness = 0.3 }",
        &["cube = { center = [-0.5, 0.7, 0], size = [1, 0.1, 1.5] }"],
    );
    let sky = environment(1.0);
    let two = [[-2.0, -0.8], [0.2, 1.4]];
    let cases = [
        ("a hole under an even sky", room(&[[-1.0, 1.0]], WHITE, 64, &sky)),
        ("two holes, sun and sky", room(&two, WHITE, 64, &[SUN, &sky].concat())),
        ("a pane, sun and sky", room(&two, WHITE, 64, &[&pane, SUN, &sky].concat())),
        ("a table of varnish", room(&two, WHITE, 64, &[table.as_str(), &sky].concat())),
        ("varnished walls", room(&two, "plastic = { reflectance = 0.7, roughness = 0.4 }", 64, &sky)),
        ("dark walls", room(&two, "diffuse = { reflectance = 0.02 }", 64, &sky)),
    ];
    for (name, text) in &cases {
        let found = openings(text);
        assert_same(&films(text, Some(&found), 8), &films(text, None, 8), cases.len(), name);
    }
}

/// Two openings become two rectangles, each of which holds its own opening.
#[test]
fn each_opening_is_held_by_a_rectangle() {
    for [left, right] in [[[-2.0, -0.8], [0.2, 1.4]], [[-2.0, -1.98], [0.2, 0.23]]] {
        let found = openings(&room(&[left, right], WHITE, 4, &environment(1.0)));
        assert_eq!(found.places.len(), 2, "{found:?}");
        for hole in [left, right] {
            let near = |middle: f64| (middle - 0.5 * (hole[0] + hole[1])).abs() < 0.1;
            let place = found.places.iter().find(|place| near(place.center.z)).expect("it is found");
            let half = place.half[0].abs() + place.half[1].abs();
            let found = [place.center - half, place.center + half].map(|corner| [corner.y, corner.z]);
            println!("{hole:?}: {found:?}");
            for (axis, [low, high]) in [[1.0, 2.2], hole].into_iter().enumerate() {
                let margin = 0.06 * (high - low);
                assert!(found[0][axis] < low && found[0][axis] > low - margin, "{found:?} for {low}");
                assert!(found[1][axis] > high && found[1][axis] < high + margin, "{found:?} for {high}");
            }
        }
    }
}

/// In a white room, aiming half of the bounces would let the weight of the paths that stay there grow without bound. If
/// as many are aimed as light is lost, paths weigh nearly the same.
#[test]
fn l13_a_white_room_with_a_small_opening_is_calm() {
    let text = room(&[[-0.05, 0.05]], "diffuse = { reflectance = 0.9 }", 64, &environment(1.0));
    let found = openings(&text);
    let relative_variance = |are_openings: bool| {
        let films = films(&text, Some(&BrightPlaces { are_openings, ..found.clone() }), 8);
        let (mean, pixels) = (Mean::over_seeds(&films).value[1], films[0].pixels.len() as f64);
        64.0 * variance(&films) / pixels / (mean * mean)
    };
    let [calm, wild] = [true, false].map(relative_variance);
    println!("a variance of {calm:.2} and {wild:.2} times the squared mean");
    assert!(calm < 10.0 && calm < 0.5 * wild, "{calm}, {wild}");
}

/// Random paths find the light of a sky that a glass ball focuses, but not often if the light enters through a slit
/// alone. Then photons are sent through the slit.
#[test]
fn the_plan_sends_photons_through_openings_alone() {
    let ball = body("ball", "dielectric = { index = 1.5 }", &["sphere = { center = [-0.5, 1, 0], radius = 0.5 }"]);
    let because =
        |holes: &[[f64; 2]]| plan(&scene(&room(holes, WHITE, 16, &(ball.clone() + &environment(1.0))))).because;
    let through_slit = because(&[[-0.02, 0.02]]);
    let sent = |line: &String| line.contains("photons from the sky through openings (solid angle");
    assert!(through_slit.iter().any(sent), "{through_slit:?}");
    assert!(through_slit.iter().all(|line| !line.contains("often enough")), "{through_slit:?}");
    let outside = view([0.0, 1.0, 4.0], [0.0, 1.0, 0.0], 40.0, 16)
        + &body("floor", WHITE, &["plane = { point = [0, 0, 0], normal = [0, 1, 0] }"])
        + &ball
        + &environment(1.0);
    let outside = plan(&scene(&outside)).because;
    assert!(outside.iter().any(|line| line.contains("rays find the sky often enough by chance")), "{outside:?}");
}
