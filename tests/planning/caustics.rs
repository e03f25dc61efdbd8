//! The plan asks for a light pass where that lowers the time to an error, and otherwise says why not.

use abbe::plan::{Plan, plan};
use abbe::trace::{LightPass, Smoothness, World, photons_within};

use super::ordinary;
use super::twenty::{Room, rooms};
use crate::support::scenes::{GROUND, SPLITTING, body, environment, method, quad, scene, view};

/// The right choice for each room was measured: `cargo bench --bench rooms`, the table in `benches/README.md`.
#[test]
fn of_twenty_rooms_the_plan_asks_for_photons_in_those_that_gain_and_says_why_not_in_the_others() {
    let rooms = rooms();
    assert_eq!([true, false].map(|asks| rooms.iter().filter(|room| room.asks == asks).count()), [10, 10]);
    assert_as_measured(rooms);
}

/// In the mean over all pixels, most noise is that of a lamp's edge, which photons do not reduce. By that measure,
/// photons did not pay off in most of these rooms.
#[test]
fn photons_are_weighed_by_what_most_pixels_gain() {
    assert_as_measured(ordinary::rooms());
}

fn assert_as_measured(rooms: Vec<Room>) {
    let mut wrong = Vec::new();
    for Room { name, text, asks, words } in rooms {
        let plan = plan(&scene(&text));
        let lines = plan.because.iter().filter(|line| line.contains("caustic") || line.contains("photon tracing"));
        let lines: Vec<&str> = lines.map(String::as_str).collect();
        println!("{name}: {}", lines.join("; "));
        if plan.method.light_pass.is_some() != asks || !lines.iter().any(|line| line.contains(words)) {
            wrong.push(format!("{name}: wants {words:?}, says {:?}", plan.because));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A metal dial under a dome of sapphire. Photons make most of its pixels, which are dark, less noisy for the time:
/// measured at a small size, an equal error of each pixel takes 1.3 times as long without them. An equal error of the
/// whole image takes 0.3 times as long without them, because it arises where the metal reflects the lamp.
const DIAL: &str = "[camera]\nposition = [0, 5, 4]\nlook_at = [0, 0, 0]\nvertical_fov = 28\n\
    [film]\nwidth = 80\nheight = 80\n\
    [material]\ngold.conductor = { metal = \"Au\", roughness = 0.15 }\ndial.diffuse.reflectance = 0.6\n\
    sapphire.dielectric.index = 1.77\ncloth.diffuse.reflectance = 0.05\nlamp.emissive.radiance = 15\n\
    [[object]]\nmaterial = \"gold\"\n\
    shape.disc = { center = [0, 0.1, 0], normal = [0, 1, 0], radius = 1.25 }\n\
    [[object]]\nmaterial = \"dial\"\nshape.disc = { center = [0, 0.11, 0], normal = [0, 1, 0], radius = 1 }\n\
    [[object]]\nmaterial = \"sapphire\"\nshape.sphere = { center = [0, 0, 0], radius = 1 }\n\
    transform = [{ scale = [1.1, 0.15, 1.1] }, { translate = [0, 0.35, 0] }]\n\
    [[object]]\nmaterial = \"cloth\"\nshape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }\n\
    [[object]]\nmaterial = \"lamp\"\nshape.quad = { center = [-2, 4, -2], u = [0.7, 0, 0], v = [0, 0, 0.7] }\n\
    [[light]]\nenvironment.radiance = 0.15\n";

#[test]
fn an_error_of_the_whole_image_counts_beside_that_of_its_pixels() {
    let asks = |text: &str| {
        let Plan { method, because, .. } = plan(&scene(text));
        (method.light_pass.is_some(), because)
    };
    let with_error = |text: &str| format!("{text}[render]\nerror = 0.03\n");
    assert!(asks(DIAL).0);
    let (sends, because) = asks(&with_error(DIAL));
    assert!(!sends && because.iter().any(|line| line.contains(" times as long, that of each pixel ")), "{because:?}");
    for Room { name, text, .. } in ordinary::rooms() {
        let (sends, because) = asks(&with_error(&text));
        assert!(sends, "{name}: {because:?}");
    }
}

/// The number of photons is derived from counts of rays and values of pixels, never from a clock.
#[test]
fn the_plan_asks_for_the_same_photons_every_time_and_on_any_number_of_threads() {
    for room in rooms().into_iter().filter(|room| room.asks).step_by(4) {
        let scene = scene(&room.text);
        let plan_on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started");
            pool.install(|| plan(&scene)).method.light_pass
        };
        let first = plan_on(1);
        assert!(first.is_some(), "{}", room.name);
        assert!(first == plan_on(3), "{}", room.name);
    }
}

/// With 0.25 photons per camera sample, the number that suits the noise of paths alone, this room took twice as long to
/// an equal error.
#[test]
fn photons_that_light_a_room_are_counted_beside_the_noise_that_all_else_leaves() {
    let text = "camera = { position = [0, 1.5, 2.4], look_at = [0, 1.4, 0], vertical_fov = 60 }\n\
                film = { width = 128, height = 128 }\nrender = { samples = 64 }\n[material]\n\
                white.diffuse.reflectance = 0.7\nglass.dielectric.index = 1.5\nlamp.emissive.radiance = 9\n\
                [[object]]\nshape.quad = { center = [0, 0, 0], u = [2, 0, 0], v = [0, 0, -2.5] }\nmaterial = \"white\"\n\
                [[object]]\nshape.quad = { center = [0, 3, 0], u = [2, 0, 0], v = [0, 0, 2.5] }\nmaterial = \"white\"\n\
                [[object]]\nshape.quad = { center = [2, 1.5, 0], u = [0, 0, 2.5], v = [0, 1.5, 0] }\nmaterial = \"white\"\n\
                [[object]]\nshape.quad = { center = [-2, 1.5, 0], u = [0, 0, 2.5], v = [0, 1.5, 0] }\nmaterial = \"white\"\n\
                [[object]]\nshape.quad = { center = [0, 1.5, -2.5], u = [2, 0, 0], v = [0, 1.5, 0] }\nmaterial = \"white\"\n\
                [[object]]\nshape.quad = { center = [0, 1.5, 2.5], u = [2, 0, 0], v = [0, 1.5, 0] }\nmaterial = \"white\"\n\
                [[object]]\nshape.sphere = { center = [0, 2.2, -0.5], radius = 0.2 }\nmaterial = \"glass\"\n\
                [[object]]\nshape.sphere = { center = [0, 2.2, -0.5], radius = 0.1 }\nmaterial = \"lamp\"\n";
    let method = plan(&scene(text)).method;
    let photons = method.light_pass.expect("the lamp is behind glass").photons as f64 / f64::from(128 * 128 * 64);
    assert!(method.light_vertices && (0.7..=4.0).contains(&photons), "{photons} for each camera sample");
}

/// With a window of a square meter, photons through it do not pay off beside bounces alone. Light vertices, which are
/// used for images of a million samples, leave so little noise that photons pay off.
#[test]
fn photons_are_weighed_beside_light_vertices() {
    let walls = [
        quad([0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, -1.5]),
        quad([0.0, 2.6, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 1.5]),
        quad([0.0, 1.3, -1.5], [2.0, 0.0, 0.0], [0.0, 1.3, 0.0]),
        quad([0.0, 1.3, 1.5], [2.0, 0.0, 0.0], [0.0, 1.3, 0.0]),
        quad([-2.0, 1.3, 0.0], [0.0, 1.3, 0.0], [0.0, 0.0, 1.5]),
        quad([2.0, 0.5, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 1.5]),
        quad([2.0, 2.3, 0.0], [0.0, 0.3, 0.0], [0.0, 0.0, 1.5]),
        quad([2.0, 1.5, -1.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.5]),
        quad([2.0, 1.5, 1.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.5]),
    ];
    let with_samples = |samples: u32| {
        let text = format!(
            "camera = {{ position = [-1.8, 1.5, 1.2], look_at = [0.3, 0.6, -0.2], vertical_fov = 50 }}\n\
             film = {{ width = 160, height = 120 }}\nrender = {{ samples = {samples} }}\n"
        ) + &body("wall", "diffuse = { reflectance = 0.6 }", &walls.each_ref().map(String::as_str))
            + &body(
                "table",
                "diffuse = { reflectance = 0.5 }",
                &[&quad([0.4, 0.6, 0.0], [0.6, 0.0, 0.0], [0.0, 0.0, 0.5])],
            )
            + &body(
                "glass",
                "dielectric = { index = 1.5 }",
                &["sphere = { center = [0.4, 0.85, -0.1], radius = 0.2 }"],
            )
            + &environment(1.0);
        let method = plan(&scene(&text)).method;
        (method.light_vertices, method.light_pass.is_some())
    };
    assert_eq!([with_samples(32), with_samples(64)], [(false, false), (true, true)]);
}

#[test]
fn photons_that_meet_a_mirror_and_a_floor_follow_two_rays() {
    let quad = |z: f64, half: f64, front: f64| {
        format!("quad = {{ center = [0, 0, {z:?}], u = [{half:?}, 0, 0], v = [0, {:?}, 0] }}", front * half)
    };
    let text = view([0.0, -9.0, 4.0], [0.0; 3], 40.0, 48)
        + &body("floor", "diffuse = { reflectance = 0.5 }", &[&quad(0.0, 9.0, 1.0)])
        + &body("mirror", "mirror = { reflectance = 1 }", &[&quad(4.0, 1.0, -1.0)])
        + "[[light]]\nspot = { position = [0, 0, 2], toward = [0, 0, 1], cone_angle = 20, intensity = 9 }\n";
    let scene = scene(&text);
    let pass =
        LightPass { photons: 1 << 20, lights: vec![0], openings: Vec::new(), to: vec![Smoothness::Whole], map: None };
    let world = World::new(&scene, method(&scene, SPLITTING)).with_light_pass(Some(pass));
    // Photons that are sent outside of the spot's cone trace no rays.
    let photons = photons_within(&world, 4096.0);
    assert!((2048..2300).contains(&photons), "{photons}");
}

/// A clear coat reflects a small light onto the floor. Random paths find it too rarely, and never if it is a point.
#[test]
fn photons_are_sent_to_clear_coats() {
    let text = |material: &str, light: &str| {
        view([0.0, 2.0, 6.0], [0.0, 1.0, 0.0], 30.0, 16)
            + &body("floor", "diffuse = { reflectance = 0.5 }", &[GROUND])
            + &body("ball", material, &["sphere = { center = [0, 1, 0], radius = 0.8 }"])
            + light
    };
    let lines = |material: &str, light: &str| {
        let Plan { because, method, left_out, .. } = plan(&scene(&text(material, light)));
        assert!(left_out.iter().all(|line| !line.contains("point lights")) || method.light_pass.is_none());
        because.into_iter().find(|line| line.starts_with("photon tracing:") || line.starts_with("no ")).expect("a line")
    };
    let [sun, point] =
        ["sun = { toward = [1, 2, 1], irradiance = 3 }", "point = { position = [1, 5, 1], intensity = 9 }"]
            .map(|light| format!("[[light]]\n{light}\n"));
    let coat = "plastic = { reflectance = 0.5 }";
    assert!(lines(coat, &sun).contains("photons from the sun (solid angle 6.8e-5 sr) toward object 2"));
    assert!(lines(coat, &point).contains("photons from a point light toward object 2"));
    for nearly in
        ["plastic = { reflectance = 0.5, roughness = 0.2 }", "conductor = { metal = \"Al\", roughness = 0.3 }"]
    {
        assert!(
            lines(nearly, &sun).contains("photons from the sun (solid angle 6.8e-5 sr) toward object 2"),
            "{nearly}"
        );
    }
    assert!(lines("plastic = { reflectance = 0.5, roughness = 0.4 }", &sun).starts_with("no caustics: no surface is"));
    // A body inside a box throws no visible caustic.
    let hidden = body("box", "diffuse = { reflectance = 0.5 }", &["cube = { center = [0, 2, 60], size = 3 }"])
        + &body("hidden", coat, &["sphere = { center = [0, 2, 60], radius = 0.8 }"]);
    let glass = plan(&scene(&(text("dielectric = { index = 1.5 }", &sun) + &hidden)));
    let left = "left to chance: caustics of object 4, which is smooth only in part";
    assert!(glass.because.iter().any(|line| line == left), "{:?}", glass.because);
    assert!(glass.method.light_pass.is_some_and(|pass| !pass.to.contains(&Smoothness::Partial)));
    // A sheet that only lets light pass straight through throws none.
    let sheet = body(
        "sheet",
        "polarizer = { axis = [1, 0, 0] }",
        &["disc = { center = [2, 1, 0], normal = [0, 0, 1], radius = 0.3 }"],
    );
    let Plan { because, left_out, .. } = plan(&scene(&(text(coat, &point) + &sheet)));
    assert!(because.iter().all(|line| !line.starts_with("left to chance")), "{because:?}");
    assert!(left_out.iter().all(|line| !line.contains("sheet")), "{left_out:?}");
    let window =
        body("lamp", "emissive = { radiance = 2 }", &["quad = { center = [0, 5, 0], u = [4, 0, 0], v = [0, 0, 4] }"]);
    assert!(lines(coat, &window).contains("no photon tracing: rays hit "));
}
