//! Light that masks let through: rays from the camera, light from lamps, and paths between surfaces.

use abbe::film::Film;

use crate::support::larger::larger;
use crate::support::scenes::{
    EVERY_BRANCH, GROUND, Mean, SINGLE_PATH, SPLITTING, assert_next_event_agrees, body, lamps, render_film, view,
};

const SHEET: &str = "quad = { center = [0, 1, 0], u = [40, 0, 0], v = [0, 0, 40] }";
const POINT: &str = "[[light]]\npoint = { position = [0.3, 3, 0.2], intensity = 10 }\n";
const SUN: &str = "[[light]]\nsun = { toward = [0.2, 1, 0.1], irradiance = 3 }\n";
const LAMP: &str = "[material.lamp]\nemissive = { radiance = { rgb = [10, 20, 5] } }\n\
    [[object]]\nshape.quad = { center = [0, 2, 0], u = [0.5, 0, 0], v = [0, 0, 0.5] }\nmaterial = \"lamp\"\n";
const SKY: &str = "[[light]]\nenvironment = { radiance = 2 }\n";

/// Returns a floor under a sheet, seen from below the sheet.
fn under(sheet: &str, lights: &str, samples: u32) -> String {
    view([3.0, 0.8, 0.5], [0.0, 0.0, 0.0], 20.0, 12)
        + &format!("[render]\nsamples = {samples}\n[material.black]\ndiffuse = {{ reflectance = 0 }}\n")
        + &body("floor", "diffuse = { reflectance = { rgb = [0.8, 0.5, 0.3] } }", &[GROUND])
        + sheet
        + lights
}

fn masked(material: &str, opacity: &str) -> String {
    body("sheet", &format!("mask = {{ material = \"{material}\", opacity = {opacity} }}"), &[SHEET])
}

/// Returns the largest difference of two films, relative to their brightest number.
fn largest_difference(a: &Film, b: &Film) -> f32 {
    let numbers = |film: &Film| film.pixels.iter().flat_map(|pixel| pixel.rgb).collect::<Vec<_>>();
    let (a, b) = (numbers(a), numbers(b));
    let most = a.iter().chain(&b).fold(f32::MIN_POSITIVE, |most, x| larger(most, *x));
    a.iter().zip(&b).fold(0f32, |worst, (a, b)| larger(worst, (a - b).abs())) / most
}

#[test]
fn a_sheet_of_opacity_0_is_not_there_and_one_of_opacity_1_is_its_material() {
    for lights in [POINT, SUN, LAMP, SKY] {
        for transport in [SINGLE_PATH, SPLITTING] {
            let without = render_film(&under("", lights, 16), transport).0;
            let clear = render_film(&under(&masked("black", "0"), lights, 16), transport).0;
            // The random numbers are the same. Only the start of the continued ray beyond a hole is rounded
            // differently.
            assert!(largest_difference(&without, &clear) < 1e-5, "{lights}: {}", largest_difference(&without, &clear));
            let white = body("sheet", "diffuse = { reflectance = 0.7 }", &[SHEET]);
            let inner = "[material.inner]\ndiffuse = { reflectance = 0.7 }\n".to_owned() + &masked("inner", "1");
            let opaque = render_film(&under(&white, lights, 16), transport).0;
            let covered = render_film(&under(&inner, lights, 16), transport).0;
            assert_eq!(largest_difference(&opaque, &covered), 0.0, "{lights}");
        }
    }
}

#[test]
fn lights_shine_through_holes_in_the_share_that_is_open() {
    let opacity = "{ rgb = [0.25, 0.5, 0.9] }";
    for (name, lights) in [("point", POINT), ("sun", SUN), ("lamp", LAMP)] {
        for transport in [SINGLE_PATH, SPLITTING] {
            let expected = Mean::render_text(&under("", lights, 64), transport, 8).times([0.75, 0.5, 0.1]);
            let through = Mean::render_text(&under(&masked("black", opacity), lights, 256), transport, 8);
            let through = through.with_joint_error(&expected);
            println!("{name}: {through:.5?} for {expected:.5?}");
            assert!(through.worst_relative_error(expected.value) < 0.02, "{name}: {through:?}");
            through.assert_near(expected.value, 6, name);
        }
    }
}

#[test]
fn two_sheets_let_through_the_product() {
    let second =
        "[[object]]\nshape.quad = { center = [0, 1.5, 0], u = [40, 0, 0], v = [0, 0, 40] }\nmaterial = \"sheet\"\n";
    let expected = Mean::render_text(&under("", POINT, 16), SPLITTING, 8).times([0.36; 3]);
    let through = Mean::render_text(&under(&(masked("black", "0.4") + second), POINT, 64), SPLITTING, 8);
    through.with_joint_error(&expected).assert_near(expected.value, 1, "two sheets");
}

#[test]
fn aiming_through_a_mask_and_meeting_the_lamp_beyond_show_the_same() {
    // The mask scatters light itself and the floor is rough, so both ways of finding the lamp count.
    let sheet = |lamp: &str| {
        let rough = "[material.gold]\nconductor = { metal = \"Au\", roughness = 0.4 }\n\
            [material.inner]\ndiffuse = { reflectance = 0.7 }\n";
        under(&(rough.to_owned() + &masked("inner", "0.5")), lamp, 512).replace("\"floor\"\n", "\"gold\"\n")
    };
    let [aimed_at, met] = lamps(&["sphere = { center = [0, 2.2, 0], radius = 0.8 }"]).map(|lamp| sheet(&lamp));
    assert_next_event_agrees([&aimed_at, &met], 8, 0.02, 2, "through a mask");
}

#[test]
fn a_hole_before_the_camera_leaves_no_trace_in_alpha_and_depth() {
    let ball = "sphere = { center = [0, 0, 0], radius = 1 }";
    let alpha = |opacity: f64, transport| {
        let text = view([0.0, 0.0, 9.0], [0.0; 3], 4.0, 8)
            + "[render]\nsamples = 64\n[material.black]\ndiffuse = { reflectance = 0 }\n"
            + &body("holes", &format!("mask = {{ material = \"black\", opacity = {opacity:?} }}"), &[ball])
            + SKY;
        let film = render_film(&text, transport).0;
        (film.pixels.iter().map(|pixel| f64::from(pixel.alpha)).sum::<f64>() / film.pixels.len() as f64, film)
    };
    for transport in [SINGLE_PATH, SPLITTING, EVERY_BRANCH] {
        assert_eq!([0.0, 1.0].map(|opacity| alpha(opacity, transport).0), [0.0, 1.0]);
    }
    // Light has to pass both walls of the ball: 1 - 0.7^2. The standard error of 4096 samples is 0.008.
    assert!((alpha(0.3, SINGLE_PATH).0 - 0.51).abs() < 0.03);
    // The sky is seen through two holes and nothing else, however few bounces are allowed.
    let (_, film) = alpha(0.3, EVERY_BRANCH);
    assert!(film.pixels.iter().all(|pixel| (pixel.rgb[0] / 2.0 - 0.49).abs() < 1e-6), "{:?}", film.pixels[0]);
}

#[test]
fn holes_are_no_bounces() {
    let text = under(&masked("black", "0.5"), LAMP, 64).replace("[render]\n", "[render]\nmax_bounces = 1\n");
    let all = Mean::render_text(&under(&masked("black", "0.5"), LAMP, 64), SPLITTING, 8);
    let one = Mean::render_text(&text, SPLITTING, 8);
    one.with_joint_error(&all).assert_near(all.value, 1, "one bounce lights the floor through the sheet");
}

#[test]
fn holes_that_vary_over_a_sheet_let_light_through_where_they_are() {
    let center =
        |sheet: &str| under(sheet, POINT, 1).replace("[render]", "filter = \"center\"\n[render]\ndiffuse_bounces = 0");
    let (open, checkered) = (center(""), center(&masked("black", "{ checker = [0, 1], repeat = 300 }")));
    let [open, checkered] = [open, checkered].map(|text| render_film(&text, SPLITTING).0);
    let shares: Vec<f32> = open.pixels.iter().zip(&checkered.pixels).map(|(a, b)| b.rgb[1] / a.rgb[1]).collect();
    let lit = shares.iter().filter(|share| (*share - 1.0).abs() < 1e-6).count();
    let dark = shares.iter().filter(|share| **share == 0.0).count();
    assert_eq!(lit + dark, shares.len(), "{shares:?}");
    assert!(lit > shares.len() / 4 && dark > shares.len() / 4, "{lit} lit, {dark} dark");
}
