//! Light vertices of skies, whose light paths start through the openings of a room.

use abbe::light::Opening;
use abbe::math::{Bounds, DVec3};
use abbe::plan::plan;
use abbe::trace::{
    BrightPlace, BrightPlaces, LightPass, MapPasses, Method, SkyOpenings, Smoothness, SunlitPlaces, World, prepare,
    with_light_vertices,
};

use super::{LAMP, WHITE, assert_same, ball, lamp, walls};
use crate::support::scenes::{SPLITTING, body, environment, method, quad, scene, view};

/// Returns the box with a window in its right wall, seen from inside.
fn room_by([height, width]: [f64; 2], render: &str, more: &[String]) -> String {
    let walls = walls();
    let [above, beside] = [0.25 * (3.0 - height), 0.25 * (5.0 - width)];
    let frame = [
        quad([2.0, above, 0.0], [0.0, 0.0, 2.5], [0.0, above, 0.0]),
        quad([2.0, 3.0 - above, 0.0], [0.0, 0.0, 2.5], [0.0, above, 0.0]),
        quad([2.0, 1.5, beside - 2.5], [0.0, 0.0, beside], [0.0, 0.5 * height, 0.0]),
        quad([2.0, 1.5, 2.5 - beside], [0.0, 0.0, beside], [0.0, 0.5 * height, 0.0]),
    ];
    let shapes: Vec<&str> = [0, 1, 3, 4, 5].map(|i| &walls[i]).into_iter().chain(&frame).map(String::as_str).collect();
    view([1.3, 1.6, 2.2], [-0.6, 1.0, -1.0], 75.0, 12)
        + &format!("[render]\nsamples = 8\n{render}\n")
        + &body("wall", WHITE, &shapes)
        + &more.concat()
}

/// Returns a room with a window 1 high and 1.2 wide.
fn room(render: &str, more: &[String]) -> String {
    room_by([1.0, 1.2], render, more)
}

/// Returns a rectangle perpendicular to x, through which light enters toward -x.
fn opening(center: [f64; 3], height: f64, width: f64) -> Opening {
    let half = [DVec3::new(0.0, 0.0, 0.5 * width), DVec3::new(0.0, 0.5 * height, 0.0)];
    Opening { center: DVec3::from(center), half }
}

fn window() -> Opening {
    opening([2.0, 1.5, 0.0], 1.0, 1.2)
}

/// Aims bounces at the window, so that little noise is left besides that of light vertices.
fn aim_at_window(method: &mut Method) {
    let Opening { center, half } = window();
    method.bright = Some(BrightPlaces {
        within: Bounds { min: DVec3::new(-2.1, -0.1, -2.6), max: DVec3::new(2.1, 3.1, 2.6) },
        places: vec![BrightPlace { center, half, radiance: 1.0 }],
        elsewhere: 0.1,
        missed: 0.0,
        are_openings: true,
    });
}

fn sky_with_a_bright_part(folder: &std::path::Path) -> String {
    let file = folder.join("sky.exr");
    let at = |x: usize, y: usize| match (x, y) {
        (20..=22, 5..=6) => (60.0, 42.0, 24.0),
        (44, 9) => (9.0, 14.0, 25.0),
        _ => (0.3, 0.01 * (x + y) as f32, 0.4),
    };
    exr::prelude::write_rgb_file(&file, 64, 32, at).unwrap();
    format!(
        "[[light]]\nenvironment = {{ radiance = {{ image = {file:?} }}, \
         transform = [{{ rotate = {{ axis = [0, 1, 0], degrees = 55 }} }}] }}\n"
    )
}

/// Quarters of images have the same means with and without light paths that start through openings: whatever lies in
/// front of the openings and behind them, wherever they are, and however much light enters elsewhere.
#[test]
fn light_paths_through_openings_change_no_mean() {
    let folder = tempfile::tempdir().unwrap();
    let image = sky_with_a_bright_part(folder.path());
    let sky = environment(1.0);
    let sun = "[[light]]\nsun = { toward = [1, 0.7, 0.1], irradiance = { rgb = [15, 13, 10] } }\n".to_owned();
    let cubes = body(
        "red",
        "diffuse = { reflectance = { rgb = [0.8, 0.2, 0.1] } }",
        &[
            "cube = { center = [-0.6, 0.6, -0.9], size = [1, 1.2, 1] }",
            "cube = { center = [0.9, 0.3, 0.2], size = 0.6 }",
        ],
    );
    let pane =
        body("pane", "thin = { index = 1.5 }", &["quad = { center = [2, 1.5, 0], u = [0, 0, 0.7], v = [0, 0.6, 0] }"]);
    let garden = body(
        "garden",
        "diffuse = { reflectance = { rgb = [0.2, 0.6, 0.2] } }",
        &[
            "quad = { center = [12, -0.5, 0], u = [9, 0, 0], v = [0, 0, -9] }",
            "cube = { center = [3.2, 1, 0.6], size = 0.8 }",
        ],
    );
    let outside = body("glass", "dielectric = { index = 1.5 }", &["sphere = { center = [3, 1.5, 0], radius = 0.6 }"]);
    let lamp_outside = body("lamp", LAMP, &["sphere = { center = [4, 2.5, 0], radius = 0.4 }"]);
    let half = opening([2.0, 1.75, 0.2], 0.5, 0.8);
    let inside = opening([0.5, 1.2, -0.3], 1.5, 2.0);
    let beyond = opening([6.0, 3.0, 0.5], 6.0, 7.0);
    let cases: Vec<(&str, String, Vec<Opening>, f64)> = vec![
        ("an even sky", room("", &[sky.clone(), cubes.clone()]), vec![window()], 0.0),
        ("half of the window", room("", &[sky.clone(), cubes.clone()]), vec![half], 0.02),
        ("one behind the other", room("", &[sky.clone(), cubes.clone()]), vec![half, beyond], 0.0),
        ("a rectangle within the room", room("", &[sky.clone(), cubes.clone()]), vec![inside], 1.0),
        ("an image of the sky", room("", &[image.clone(), cubes.clone()]), vec![window()], 0.0),
        ("sun and sky", room("", &[sun.clone(), sky.clone(), cubes.clone()]), vec![window()], 0.0),
        ("a lamp as well", room("", &[sky.clone(), lamp(), cubes.clone()]), vec![window()], 0.0),
        ("a pane", room("", &[sky.clone(), cubes.clone(), pane]), vec![window()], 0.0),
        ("a garden", room("", &[sky.clone(), cubes.clone(), garden]), vec![window()], 0.0),
        ("a lamp in the garden", room("", &[sky.clone(), cubes.clone(), lamp_outside]), vec![window()], 0.0),
        ("a ball of glass outside", room("", &[sky.clone(), cubes.clone(), outside]), vec![window()], 0.0),
        ("a mirror", room("", &[sky.clone(), ball("silver", "mirror = { reflectance = 0.9 }")]), vec![window()], 0.0),
        (
            "plastic",
            room("", &[sky.clone(), ball("plastic", "plastic = { reflectance = 0.6, index = 1.5 }")]),
            vec![window()],
            0.0,
        ),
        ("two diffuse bounces", room("diffuse_bounces = 2", &[sky.clone(), cubes.clone()]), vec![window()], 0.0),
        ("three bounces", room("max_bounces = 3", &[sky, cubes]), vec![window()], 0.0),
    ];
    // Photons contribute the light that the ball focuses, either of the bright parts of the sky or of all that enters
    // through half of the window. The rest of that light leaves vertices.
    let text = room("", &[image, ball("glass", "dielectric = { index = 1.5 }")]);
    for of_pass in [Vec::new(), vec![half]] {
        let change = |method: &mut Method| {
            aim_at_window(method);
            let map = Some(MapPasses { count: 8, photons: 8192, radius: 0.2, chance: 1.0 });
            let to = vec![Smoothness::Whole];
            let openings = of_pass.clone();
            method.light_pass = Some(LightPass { photons: 8192, lights: vec![0], openings, to, map });
        };
        let with = |world: &World| {
            world.with_light_vertices(Vec::new(), SkyOpenings { openings: vec![window()], missed: 0.0 })
        };
        let worst = assert_same("a pass beside", &text, &change, &with, cases.len());
        println!("a pass beside: at most {worst:.1} sigma");
    }
    for (what, text, openings, missed) in &cases {
        let with = |world: &World| {
            let openings = SkyOpenings { openings: openings.clone(), missed: *missed };
            world.with_light_vertices(Vec::new(), openings)
        };
        let worst = assert_same(what, text, &aim_at_window, &with, cases.len());
        println!("{what}: at most {worst:.1} sigma");
    }
}

/// A sun lights a patch through a small hole. Bounces find too little of its light to locate the patch.
#[test]
fn light_paths_of_suns_start_through_openings_that_bounces_find_no_light_of() {
    let sun = "[[light]]\nsun = { toward = [1, 0.7, 0.1], irradiance = 10 }\n".to_owned();
    let places = |size: [f64; 2]| {
        let scene = scene(&room_by(size, "", &[sun.clone(), environment(1.0)]));
        let world = prepare(&scene, method(&scene, SPLITTING));
        let openings = SkyOpenings { openings: vec![opening([2.0, 1.5, 0.0], size[0], size[1])], missed: 0.0 };
        with_light_vertices(&world, &openings).expect("light can be followed").method().sunlit.clone()
    };
    let [of_hole, of_window] = [[0.04, 0.06], [1.0, 1.2]].map(places);
    let is_at = |place: &SunlitPlaces| (place.center - DVec3::new(2.0, 1.5, 0.0)).length() < 1e-9;
    assert!(of_hole.len() == 1 && is_at(&of_hole[0]), "{of_hole:?}");
    assert!((of_hole[0].radius - libm::hypot(0.02, 0.03)).abs() < 1e-9, "{of_hole:?}");
    assert!(of_window.len() == 1 && !is_at(&of_window[0]) && of_window[0].radius > 0.3, "{of_window:?}");
}

/// A room with a window uses light vertices if its image is large enough, with the opening that was found.
#[test]
fn the_plan_starts_light_paths_of_skies_through_openings() {
    let text = room("", &[environment(1.0)]).replace("width = 12\nheight = 12", "width = 384\nheight = 384");
    let decided = plan(&scene(&text));
    let reason = "light between surfaces that comes from the sky through openings is found at light vertices";
    assert!(decided.because.iter().any(|line| line.starts_with(reason)), "{:?}", decided.because);
    let SkyOpenings { openings, missed } = &decided.method.openings;
    assert!(openings.len() == 1 && *missed < 0.01, "{openings:?}, {missed}");
    let (found, window) = (openings[0], window());
    assert!((found.center - window.center).length() < 0.05, "{found:?}");
    assert!((found.area() / window.area() - 1.0).abs() < 0.1, "{found:?}");
    let across = found.half[0].cross(found.half[1]);
    assert!(across.x < 0.0, "light enters along {across}");
}
