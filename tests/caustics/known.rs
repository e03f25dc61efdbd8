//! Caustics with a known result: from other programs, by hand, or because a change must not affect them.

use abbe::film::Film;
use abbe::plan::{Plan, plan};
use abbe::trace::{LightPass, MapPasses, Method, Smoothness};

use super::agreement::{LAMP, assert_agree, camera_and_film};
use crate::support::run::{Answer, Folder, render};
use crate::support::scenes::{SPLITTING, film_of, mean_color, object, scene};

/// Renders a scene by its planned method, with photons from all lights.
fn with_photons(text: &str, photons: u64, samples: u32) -> Film {
    let scene = scene(text);
    let light_pass = Some(LightPass {
        photons,
        lights: (0..scene.lights.len()).collect(),
        to: vec![Smoothness::Whole],
        map: None,
        openings: Vec::new(),
    });
    let method = Method { samples, transport: SPLITTING, light_pass, ..plan(&scene).method };
    film_of(&scene, method)
}

/// Returns caustic A of the light tracing lab: a ball of index 1.5 and radius 1 with its center 1.5 above the floor,
/// and a lamp of power pi at a height of 7. The camera's parallel rays start below the ball, so the ball hides nothing.
fn patch(light: &str) -> String {
    format!(
        "[camera]\nposition = [0, 0.4, 0]\nlook_at = [0, 0, 0]\nup = [0, 0, 1]\nprojection = \"orthographic\"\nheight = 1.6\n\
         [film]\nwidth = 24\nheight = 24\n\
         [material.floor]\ndiffuse = {{ reflectance = 0.001 }}\n[material.glass]\ndielectric = {{ index = 1.5 }}\n\
         [[object]]\nmaterial = \"floor\"\nshape.quad = {{ center = [0, 0, 0], u = [0, 0, 2], v = [2, 0, 0] }}\n\
         [[object]]\nmaterial = \"glass\"\nshape.sphere = {{ center = [0, 1.5, 0], radius = 1 }}\n{light}"
    )
}

fn lamp(radius: f64) -> String {
    let radiance = 1.0 / (4.0 * std::f64::consts::PI * radius * radius);
    format!(
        "[material.lamp]\nemissive = {{ radiance = {radiance:?} }}\n\
         [[object]]\nmaterial = \"lamp\"\nshape.sphere = {{ center = [0, 7, 0], radius = {radius:?} }}\n"
    )
}

/// Row T1 of the closed forms: the mean irradiance over the patch of 1.6 by 1.6 is .0084 for radii up to 0.3 and .0085
/// for radius 1.
#[test]
fn the_caustic_of_a_ball_has_the_irradiance_that_another_program_found() {
    let point = "[[light]]\npoint = { position = [0, 7, 0], intensity = 0.25 }\n".to_owned();
    for (what, light, expected) in [
        ("1", lamp(1.0), 0.0085),
        ("0.3", lamp(0.3), 0.0084),
        ("0.003", lamp(0.003), 0.0084),
        ("a point", point, 0.0084),
    ] {
        let mean = |film: &Film| mean_color(film)[1];
        // Direct light that passes beside the ball is no part of the caustic. The camera samples are the same.
        let straight = scene(&patch(&light));
        let method = Method { samples: 16, light_pass: None, diffuse_bounces: 0, ..plan(&straight).method };
        let straight = mean(&film_of(&straight, Method { transport: SPLITTING, ..method }));
        // The floor is so dark that none of its light returns by way of the ball: the camera sees irradiance / 1000 pi.
        let irradiance = (mean(&with_photons(&patch(&light), 400_000, 16)) - straight) * 1e3 * std::f64::consts::PI;
        println!("T1, radius {what}: {irradiance:.6}");
        // The reference has two digits. Each photon carries at most a part in 10 000.
        assert!((irradiance - expected).abs() < 0.5e-4 + 0.01 * expected, "radius {what}: {irradiance} for {expected}");
    }
}

/// A spotlight that covers all that matters of a point light throws the same caustic. A spot that covers a part of the
/// ball throws a part of it.
#[test]
fn a_wide_spot_throws_the_caustic_of_a_point_and_a_narrow_one_a_part_of_it() {
    let image = |light: &str| {
        let text = patch(&format!("[[light]]\n{light}\n"));
        with_photons(&text, 400_000, 1)
    };
    let point = image("point = { position = [0, 7, 0], intensity = 0.25 }");
    let spot = |degrees: f64| {
        image(&format!(
            "spot = {{ position = [0, 7, 0], toward = [0, -1, 0], cone_angle = {degrees}, blend = 0, intensity = 0.25 }}"
        ))
    };
    let [all, wide, narrow] = [point, spot(120.0), spot(6.0)].map(|film| mean_color(&film)[1]);
    println!("point {all:.4e}, wide spot {wide:.4e}, narrow spot {narrow:.4e}");
    assert!((wide / all - 1.0).abs() < 0.01, "{wide} for {all}");
    // All light of a cone with half angle 3 degrees hits the ball within its inner third. As at normal incidence,
    // nearly (2 sqrt(n) / (n + 1))^4 of it is transmitted and lands on the patch: the flux divided by the area and by
    // pi.
    let flux = 0.25 * std::f64::consts::TAU * (1.0 - 3.0_f64.to_radians().cos());
    let exact = flux * 0.96 * 0.96 / (1.6 * 1.6) * 1e-3 / std::f64::consts::PI;
    assert!((narrow / exact - 1.0).abs() < 0.01, "{narrow} for {exact}");
}

/// A parallel beam through a prism onto a screen: the screen receives what Fresnel's equations transmit.
#[test]
fn a_beam_through_a_prism_brings_to_the_screen_the_light_that_fresnel_predicts() {
    // The beam hits the left face at `incidence` to its normal. The apex points up and everything lies in the plane z =
    // 0.
    let (apex, index) = (30.0_f64.to_radians(), 1.5_f64);
    let incidence = 0.6_f64;
    // Two faces meet at the apex in the origin, symmetric about -y.
    let (left, right) = ([-(apex.cos()), apex.sin()], [apex.cos(), apex.sin()]);
    let inside = (incidence.sin() / index).asin();
    let second = 2.0 * apex - inside;
    let out = (index * second.sin()).asin();
    let share = |a: f64, b: f64| {
        let (s, p) = ((a - b).sin() / (a + b).sin(), (a - b).tan() / (a + b).tan());
        1.0 - 0.5 * (s * s + p * p)
    };
    let exact = share(incidence, inside) * share(second, out);
    // The sun is placed so that its light hits the left face at `incidence`, from below the normal.
    let angle = left[1].atan2(left[0]) + incidence;
    let sun = [angle.cos(), angle.sin()];
    let outward = right[1].atan2(right[0]) - out;
    let way = [outward.cos(), outward.sin()];
    let (depth, half) = (2.0, 0.1);
    let bottom = depth * apex.tan();
    // A slit in front of the middle of the left face, and a screen perpendicular to the beam.
    let middle = [-0.5 * bottom, -0.5 * depth];
    let slit = [middle[0] + 0.8 * sun[0], middle[1] + 0.8 * sun[1]];
    let across = [-sun[1], sun[0]];
    let blind = |side: f64| {
        let reach = 3.0;
        let center = [0, 1].map(|i| slit[i] + side * across[i] * (half + reach));
        format!(
            "[[object]]\nmaterial = \"black\"\nshape.quad = {{ center = [{:?}, {:?}, 0], u = [{:?}, {:?}, 0], v = [0, 0, 3] }}\n",
            center[0],
            center[1],
            across[0] * reach,
            across[1] * reach
        )
    };
    let caps = [1.0, -1.0].map(|side: f64| {
        format!(
            "[[object]]\nmaterial = \"black\"\nshape.quad = {{ center = [{:?}, {:?}, {:?}], u = [{:?}, {:?}, 0], v = [0, 0, 3] }}\n",
            slit[0], slit[1], side * (half + 3.0), across[0] * half * 1.01, across[1] * half * 1.01
        )
    });
    // Starting at the middle of the right face.
    let screen = [0.5 * bottom + 3.0 * way[0], -0.5 * depth + 3.0 * way[1]];
    let camera = [screen[0] - 0.8 * way[0], screen[1] - 0.8 * way[1]];
    let wide = [-way[1], way[0]];
    let text = format!(
        "[camera]\nposition = [{:?}, {:?}, 0]\nlook_at = [{:?}, {:?}, 0]\nup = [0, 0, 1]\nprojection = \"orthographic\"\nheight = 1.5\n\
         [film]\nwidth = 16\nheight = 16\n[material.black]\ndiffuse = {{ reflectance = 0 }}\n\
         [material.white]\ndiffuse = {{ reflectance = 1 }}\n[material.glass]\ndielectric = {{ index = {index:?} }}\n\
         [[object]]\nmaterial = \"white\"\nshape.quad = {{ center = [{:?}, {:?}, 0], u = [{:?}, {:?}, 0], v = [0, 0, 3] }}\n\
         [[object]]\nmaterial = \"glass\"\nshape.mesh.points = [[0, 0, -1], [{b:?}, {d:?}, -1], [{c:?}, {d:?}, -1], [0, 0, 1], [{b:?}, {d:?}, 1], [{c:?}, {d:?}, 1]]\n\
         shape.mesh.faces = [[0, 2, 1], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]]\n\
         {}{}{}{}[[light]]\nsun = {{ toward = [{:?}, {:?}, 0], angular_diameter = 0, irradiance = 1 }}\n",
        camera[0],
        camera[1],
        screen[0],
        screen[1],
        screen[0],
        screen[1],
        wide[0] * 3.0,
        wide[1] * 3.0,
        blind(1.0),
        blind(-1.0),
        caps[0],
        caps[1],
        sun[0],
        sun[1],
        b = -bottom,
        c = bottom,
        d = -depth,
    );
    let film = with_photons(&text, 2_000_000, 1);
    let pixel_area = (1.5 / 16.0) * (1.5 / 16.0);
    let landed: f64 = film.pixels.iter().map(|pixel| f64::from(pixel.rgb[1]) * std::f64::consts::PI * pixel_area).sum();
    let sent = 4.0 * half * half;
    println!("prism: {:.5} of the beam for {exact:.5}", landed / sent);
    assert!((landed / sent / exact - 1.0).abs() < 0.005, "{} of the beam arrives for {exact}", landed / sent);
}

/// Two balls in line with a point light, and a sun between two mirrors: cones overlap and photons are sent toward
/// several objects.
const CROWD: &str = "[render]\nseed = 5\n\
    [material.floor]\ndiffuse = { reflectance = 0.7 }\n[material.glass]\ndielectric = { index = \"N-SF11\" }\n\
    [material.mirror]\nmirror = { reflectance = 0.9 }\n\
    [[object]]\nmaterial = \"floor\"\nshape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }\n\
    [[object]]\nmaterial = \"glass\"\nshape.sphere = { center = [0, 0.6, 0], radius = 0.5 }\n\
    [[object]]\nmaterial = \"glass\"\nshape.sphere = { center = [0.3, 1.9, 0], radius = 0.4 }\n\
    [[object]]\nmaterial = \"mirror\"\nshape.quad = { center = [-1, 0.6, 0], u = [0.1, 0.5, 0], v = [0, 0, 0.5] }\n\
    [[light]]\npoint = { position = [0.5, 3.5, 0.2], intensity = 9 }\n\
    [[light]]\nsun = { toward = [1, 1.2, 0.1], irradiance = 2 }\n";

fn crowd(film: &str) -> String {
    format!(
        "[camera]\nposition = [1.5, 2.5, 3]\nlook_at = [0, 0.2, 0]\nvertical_fov = 40\n\
         [film]\nwidth = 48\nheight = 36\n{film}\n{CROWD}"
    )
}

fn because(plan: &Plan) -> String {
    plan.because.join("\n")
}

#[test]
fn a_part_of_an_image_has_the_bits_that_it_has_in_the_whole() {
    for filter in ["", "filter = { tent = { radius = 1.5 } }\n"] {
        let whole = scene(&crowd(filter));
        let planned = plan(&whole).method;
        let pass = planned.light_pass.clone().expect("a caustic");
        let map = pass.map.map(|map| MapPasses { count: 3, photons: 4096, ..map });
        assert!(map.is_some(), "a caustic in a mirror");
        let few = LightPass { photons: 16_384, map, ..pass };
        let method = Method { samples: 8, light_pass: Some(few), ..planned.clone() };
        let full = film_of(&whole, method.clone());
        for window in ["crop = [7, 11, 22, 19]", "overscan = [40, 5, 3, 60]", "overscan = 9\ncrop = [-9, 3, 13, 17]"] {
            let part = scene(&crowd(&format!("{filter}{window}")));
            if filter.is_empty() {
                assert_eq!(plan(&part).method.light_pass, planned.light_pass);
            }
            let part = film_of(&part, method.clone());
            let mut same = 0;
            for (x, y) in (0..part.width).flat_map(|x| (0..part.height).map(move |y| (x, y))) {
                let [column, row] = [part.corner[0] + x as i32, part.corner[1] + y as i32];
                if (0..48).contains(&column) && (0..36).contains(&row) {
                    assert_eq!(part.at(x, y), full.at(column as u32, row as u32), "{window}: {column} {row}");
                    same += 1;
                }
            }
            assert!(same >= 4 * 17, "{window} has {same} pixels of the format");
        }
    }
}

#[test]
fn any_number_of_threads_writes_the_same_bytes_of_a_caustic() {
    let folder = Folder::with("scene.toml", crowd("filter = \"gaussian\""));
    let rendered = |threads: &str| {
        let Answer { code, stderr, .. } =
            render(&folder, &["scene.toml", "--exr", "image.exr", "--samples", "24", "--threads", threads]);
        assert!(code == Some(0) && stderr.contains("photon tracing:") && stderr.contains("photon map:"), "{stderr}");
        folder.read("image.exr")
    };
    let first = rendered("1");
    for threads in ["2", "3"] {
        assert!(rendered(threads) == first, "{threads} threads write other bytes");
    }
}

/// Lamps large enough for random paths to hit: a photon that could have been sent toward several objects counts once.
#[test]
fn photons_toward_objects_whose_cones_overlap_count_once() {
    let things = CROWD.split("[[light]]").next().unwrap_or_default().replace("\"N-SF11\"", "1.7");
    let lamp = object("lamp", "sphere = { center = [0.5, 3.5, 0.2], radius = 0.3 }");
    let sun = "[[light]]\nsun = { toward = [1, 1.2, 0.1], irradiance = 2, angular_diameter = 12 }\n";
    let camera = "position = [1.5, 2.5, 3]\nlook_at = [0, 0.2, 0]\nvertical_fov = 40";
    assert_agree(
        "two balls in one line and a mirror",
        &(camera_and_film(camera, "") + &things + LAMP + &lamp + sun),
        16,
    );
}

#[test]
fn the_plan_asks_for_photons_where_they_are_needed_and_says_why_where_not() {
    let room = |extra: &str| {
        plan(&scene(&format!(
            "[camera]\nposition = [0, 2, 5]\nlook_at = [0, 0.5, 0]\nvertical_fov = 40\n[film]\nwidth = 64\nheight = 48\n\
             [material.floor]\ndiffuse = {{ reflectance = 0.7 }}\n[material.lamp]\nemissive = {{ radiance = 5 }}\n\
             [material.glass]\ndielectric = {{ index = 1.5 }}\n[material.mirror]\nmirror = {{ reflectance = 0.9 }}\n\
             [[object]]\nname = \"floor\"\nmaterial = \"floor\"\nshape.plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}\n{extra}"
        )))
    };
    let ball =
        "[[object]]\nname = \"ball\"\nmaterial = \"glass\"\nshape.sphere = { center = [0, 0.8, 0], radius = 0.5 }\n";
    let point = "[[light]]\npoint = { position = [1, 3, 0], intensity = 3 }\n";
    let lamp = |radius: f64| {
        format!(
            "[[object]]\nname = \"bulb\"\nmaterial = \"lamp\"\nshape.sphere = {{ center = [-1, 3.5, 0], radius = {radius} }}\n"
        )
    };
    let assert_photons = |extra: String, words: &str| {
        let plan = room(&extra);
        assert!(plan.method.light_pass.is_some() && because(&plan).contains(words), "{extra}{}", because(&plan));
    };
    let assert_no_photons = |extra: String, words: &str| {
        let plan = room(&extra);
        assert!(plan.method.light_pass.is_none() && because(&plan).contains(words), "{extra}{}", because(&plan));
    };
    assert_photons(format!("{ball}{point}"), "photons from a point light toward ball");
    assert_photons(format!("{ball}{}", lamp(0.1)), "photons from bulb (");
    assert_photons(
        format!("{ball}[[light]]\nsun = {{ toward = [1, 2, 0], irradiance = 1 }}\n"),
        "photons from the sun (solid angle 6.8e-5 sr)",
    );
    assert_photons(format!("{ball}{point}{}", lamp(2.0)), "left to chance: caustics from bulb");
    assert_no_photons(point.into(), "no caustics: no surface is smooth");
    let coated = "[material.coat]\nplastic = { reflectance = 0.5, index = 1.5 }\n[[object]]\nmaterial = \"coat\"\n\
                  shape.cube = { center = [2, 0.5, 0], size = 1 }\n";
    assert_photons(format!("{ball}{coated}{point}"), "photons from a point light toward 2 smooth objects");
    assert_photons(format!("{coated}{point}"), "photons from a point light toward object ");
    let frosted = |roughness: f64| {
        let ball = ball.replace("\"glass\"", "\"frosted\"");
        format!("[material.frosted]\ndielectric = {{ index = 1.5, roughness = {roughness} }}\n{ball}{point}")
    };
    assert_photons(frosted(0.2), "photons from a point light toward ball");
    let plan = room(&frosted(0.35));
    let all = because(&plan);
    assert!(all.contains("no caustics: no surface is smooth") && !all.contains("left out: light from point"), "{all}");
    assert_no_photons(format!("{ball}{}", lamp(2.0)), "no photon tracing: rays hit bulb (solid angle ");
    let screen = "[material.screen]\nemissive = { radiance = { checker = [3, 1] } }\n";
    assert_photons(format!("{screen}{ball}{}", lamp(0.1).replace("\"lamp\"", "\"screen\"")), "photons from bulb (");
    assert_no_photons(
        format!("{ball}[[light]]\nenvironment = {{ radiance = 1 }}\n"),
        "rays find the sky often enough by chance",
    );
    let folder = tempfile::tempdir().unwrap();
    let sky = |sun: f32, more: &str| {
        let file = folder.path().join(format!("{sun}.exr"));
        let at = |x: usize, y: usize| if [x, y] == [30, 20] { (sun, sun, sun) } else { (1.0, 1.0, 2.0) };
        exr::prelude::write_rgb_file(&file, 128, 64, at).unwrap();
        format!("{ball}[[light]]\nenvironment = {{ radiance = {{ image = {file:?} }}{more} }}\n")
    };
    assert_photons(
        sky(1e4, ""),
        "photons from the bright parts of the image of the sky (solid angle 1.8e-2 sr) toward ball",
    );
    assert_no_photons(sky(9.0, ""), "rays find the sky often enough by chance");
    let polarized = ", polarization = { sun = [0, 1, 1], degree = 0.7 }";
    assert_no_photons(sky(1e4, polarized), "caustics from a polarized image of the sky are left to chance");
    let wall = "[[object]]\nname = \"wall\"\nmaterial = \"mirror\"\nshape.plane = { point = [0, 0, -3], normal = [0, 0, 1] }\n";
    assert_photons(format!("{wall}{point}"), "from a point light toward wall");
    let beyond =
        "left to chance: caustics of wall, which is unbounded, far beyond where it is seen; caustics from point";
    assert_photons(format!("{ball}{wall}{point}"), beyond);
    let behind = wall.replace("-3]", "9]");
    let unseen = "wall is unbounded and not seen, so photons cannot be aimed at it; caustics from point";
    assert_no_photons(format!("{behind}{point}"), unseen);
    assert_photons(
        format!("{ball}{behind}{point}"),
        "left to chance: caustics of wall, which is unbounded and is not seen; caustics from point",
    );
    assert_no_photons(format!("{ball}{point}").replace("0.8, 0]", "-0.8, 0]"), "in sight");
    assert_no_photons(format!("[render]\ncaustics = \"off\"\n{ball}{point}"), "caustics \"off\"");
    assert_no_photons(format!("[render]\ndiffuse_bounces = 0\n{ball}{point}"), "no caustics: with diffuse_bounces 0");
    let pane = "[[object]]\nmaterial = \"glass\"\nshape.cube = { center = [0, 2, 4.5], size = [9, 9, 0.1] }\n";
    assert_photons(format!("{ball}{pane}{point}"), "photon map: 12 passes of");
}

/// In a box lit by a lamp inside a glass ball, pixels are so wide that thousands of photons lie around each place. More
/// passes with fewer photons make the same image in less time.
#[test]
fn a_pass_has_no_more_photons_than_are_worth_looking_through() {
    let text = "[camera]\nposition = [0, 1, 3]\nlook_at = [0, 1, 0]\nprojection = \"equirectangular\"\n\
                [film]\nwidth = 24\nheight = 12\n[render]\nsamples = 64\n\
                [material.matte]\ndiffuse = { reflectance = 0.6 }\n[material.lamp]\nemissive = { radiance = 20 }\n\
                [material.glass]\ndielectric = { index = 1.5 }\n"
        .to_owned()
        + &object("matte", "cube = { center = [0, 1, 0], size = 8 }")
        + &object("glass", "sphere = { center = [1, 2, 0], radius = 0.4 }")
        + &object("lamp", "sphere = { center = [1, 2, 0], radius = 0.1 }");
    let map = plan(&scene(&text)).method.map().unwrap();
    assert!(map.photons < 1024 && map.count > 8, "{map:?}");
}

/// The camera sees a chip below a glass ball that throws a lamp's light onto the floor. From there light returns to the
/// chip through the ball, from places that lie farther apart than the chip is wide. With few photons, none landed
/// within a pixel of them, so no map was planned, at 3.4 times the variance.
#[test]
fn a_map_is_kept_for_places_that_lie_farther_apart_than_the_view_is_wide() {
    let text = "[camera]\nposition = [0.37, -1.199, 0.045]\nlook_at = [0.37, -1.2, 0.044]\n\
                projection = \"orthographic\"\nheight = 0.03\n[film]\nwidth = 24\nheight = 24\n[render]\nsamples = 256\n\
                [material.matte]\ndiffuse = { reflectance = 0.4 }\n[material.lamp]\nemissive = { radiance = 100 }\n\
                [material.glass]\ndielectric = { index = 1.68 }\n"
            .to_owned()
            + &object("glass", "sphere = { center = [0.16, 0.37, 0.39], radius = 0.39 }")
            + &object("matte", "quad = { center = [0, -1.4, 0], u = [3, 0, 0], v = [0, 0, -3] }")
            + &object(
                "matte",
                "quad = { center = [0.37, -1.2, 0.044], u = [0.016, 0.039, -0.027], v = [-0.046, 0.008, -0.017] }",
            )
            + &object("lamp", "sphere = { center = [-0.247, 1.84, -0.65], radius = 0.05 }");
    let plan = plan(&scene(&text));
    assert!(plan.method.map().is_some(), "{}", because(&plan));
}
