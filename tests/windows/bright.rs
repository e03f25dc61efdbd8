//! Bounces aimed at what lights a room, compared with closed forms and with bounces that are not aimed.

use std::f64::consts::PI;

use abbe::film::Film;
use abbe::math::{Bounds, DVec3};
use abbe::plan::plan;
use abbe::trace::{BrightPlace, BrightPlaces, Method, prepare, prepare_unguided, render, room_light};

use crate::support::scenes::{
    Mean, SPLITTING, body, environment, films_of, mean_and_variance, method, quad, scene, sigma_limit, view,
};

/// Returns a closed box, 4 x 3 x 5, with holes in the wall at x = -2. Each of them extends from z to z, and all of them
/// from y = 1 to 2.2.
pub fn walls(holes: &[[f64; 2]]) -> Vec<String> {
    let mut quads = vec![
        quad([0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, -2.5]),
        quad([0.0, 3.0, 0.0], [2.0, 0.0, 0.0], [0.0, 0.0, 2.5]),
        quad([2.0, 1.5, 0.0], [0.0, 0.0, 2.5], [0.0, 1.5, 0.0]),
        quad([0.0, 1.5, -2.5], [2.0, 0.0, 0.0], [0.0, 1.5, 0.0]),
        quad([0.0, 1.5, 2.5], [2.0, 0.0, 0.0], [0.0, 1.5, 0.0]),
        quad([-2.0, 0.5, 0.0], [0.0, 0.0, 2.5], [0.0, 0.5, 0.0]),
        quad([-2.0, 2.6, 0.0], [0.0, 0.0, 2.5], [0.0, 0.4, 0.0]),
    ];
    let mut from = -2.5;
    for &[low, high] in holes.iter().chain(&[[2.5, 2.5]]) {
        quads.push(quad([-2.0, 1.6, 0.5 * (from + low)], [0.0, 0.0, 0.5 * (low - from)], [0.0, 0.6, 0.0]));
        from = high;
    }
    quads
}

/// Returns a room seen from inside.
pub fn room(holes: &[[f64; 2]], wall: &str, samples: u32, more: &str) -> String {
    let walls = walls(holes);
    view([1.6, 1.5, 2.0], [-1.0, 0.8, -0.8], 60.0, 16)
        + &format!("[render]\nsamples = {samples}\n")
        + &body("wall", wall, &walls.iter().map(String::as_str).collect::<Vec<_>>())
        + more
}

pub const WHITE: &str = "diffuse = { reflectance = 0.7 }";
pub const SUN: &str = "[[light]]\nsun = { toward = [-1, 0.7, 0.2], irradiance = 12 }\n";

/// Renders a scene with bounces that aim at places, or at nothing.
pub fn films(text: &str, bright: Option<&BrightPlaces>, seeds: u64) -> Vec<Film> {
    let scene = scene(text);
    let setup = Method { bright: bright.cloned(), ..method(&scene, SPLITTING) };
    films_of(&scene, &setup, 0..seeds)
}

fn learned_places(text: &str) -> Option<BrightPlaces> {
    let scene = scene(text);
    room_light(&prepare_unguided(&scene, method(&scene, SPLITTING))).places
}

/// A center, two half edges and a radiance.
type ListedPlace = ([f64; 3], [f64; 3], [f64; 3], f64);

/// Returns the places of a list, to be aimed at from the whole room.
fn places(list: &[ListedPlace]) -> BrightPlaces {
    let place = |&(center, u, v, radiance): &ListedPlace| {
        let (center, half) = (DVec3::from(center), [DVec3::from(u), DVec3::from(v)]);
        BrightPlace { center, half, radiance }
    };
    let within = Bounds { min: DVec3::new(-2.1, -0.1, -2.6), max: DVec3::new(2.1, 3.1, 2.6) };
    BrightPlaces { within, places: list.iter().map(place).collect(), elsewhere: 0.05, missed: 0.0, are_openings: false }
}

/// Returns the sum of the variances of all pixels.
pub fn variance(films: &[Film]) -> f64 {
    let of_pixel = |i: usize| mean_and_variance(films.iter().map(move |film| f64::from(film.pixels[i].rgb[1]))).1;
    (0..films[0].pixels.len()).map(of_pixel).sum()
}

pub fn assert_same(one: &[Film], other: &[Film], claims: usize, what: &str) {
    let [one, other] = [one, other].map(Mean::over_seeds);
    println!("{what}: {one:.5?} for {other:.5?}");
    one.with_joint_error(&other).assert_near(other.value, claims, what);
}

/// Returns the irradiance of a point of a floor over pi times the radiance of a rectangle at right angles to it:
/// Howell, *A Catalog of Radiation Heat Transfer Configuration Factors*, B-4. A corner of the rectangle, `width` x
/// `height`, is at the foot of the perpendicular from the point, at a distance.
pub fn upright(distance: f64, width: f64, height: f64) -> f64 {
    let (x, y) = (height / width, distance / width);
    let root = (x * x + y * y).sqrt();
    ((1.0 / y).atan() - y / root * (1.0 / root).atan()) / (2.0 * PI)
}

/// A point on the floor of a black room sees the sky above and below the horizon through one hole. The places to aim at
/// are right, beside what is bright, tilted, in the floor's own plane, or all of these.
#[test]
fn an_even_sky_through_an_opening_gives_its_form_factor_wherever_bounces_aim() {
    let text = view([0.5, 2.0, 0.0], [0.500_01, 0.0, 0.0], 0.05, 8)
        + "[render]\nsamples = 256\n"
        + &body(
            "wall",
            "diffuse = { reflectance = 0.001 }",
            &walls(&[[-1.0, 1.0]]).iter().skip(1).map(String::as_str).collect::<Vec<_>>(),
        )
        + &body("floor", "diffuse = { reflectance = 0.5 }", &[walls(&[])[0].as_str()])
        + &environment(2.0);
    let of = |height: f64| 2.0 * upright(2.5, 1.0, height);
    // The black walls reflect less than a thousandth of it.
    let expected = 0.5 * 2.0 * (of(2.2) - of(1.0));
    let right = ([-2.0, 1.6, 0.0], [0.0, 0.0, 1.0], [0.0, 0.6, 0.0], 2.0);
    let beside = ([-2.0, 1.6, 1.4], [0.0, 0.0, 0.7], [0.0, 0.5, 0.0], 2.0);
    let tilted = ([-1.5, 1.5, 0.3], [0.3, 0.1, 0.8], [-0.2, 0.5, 0.1], 2.0);
    let floor = ([0.4, 0.0, 0.1], [0.5, 0.0, 0.0], [0.0, 0.0, 0.5], 2.0);
    let cases = [vec![right], vec![beside], vec![tilted], vec![floor], vec![right, beside, tilted, floor], Vec::new()];
    for case in &cases {
        let found = Mean::over_seeds(&films(&text, Some(&places(case)), 8));
        println!("{found:.6?} for {expected:.6}");
        // Of the light that came in, the walls reflect at most a thousandth of the room's mean.
        let mut wider = found;
        wider.error = found.error.map(|error| error + 3e-4 * expected);
        wider.assert_near([expected; 3], cases.len(), &format!("{case:?}"));
        assert!(found.worst_relative_error([expected; 3]) < 0.01, "{found:?}");
    }
}

#[test]
fn aimed_bounces_show_the_same_rooms_as_others() {
    let pane =
        body("pane", "thin = { index = 1.5 }", &["quad = { center = [-2, 1.6, 0], u = [0, 0, 2.5], v = [0, 0.6, 0] }"]);
    let lawn = body(
        "lawn",
        "diffuse = { reflectance = 0.3 }",
        &["quad = { center = [0, -0.5, 0], u = [30, 0, 0], v = [0, 0, -30] }"],
    );
    let table = body(
        "table",
        "plastic = { reflectance = 0.5, roughness = 0.3 }",
        &["cube = { center = [-0.5, 0.7, 0], size = [1, 0.1, 1.5] }"],
    );
    let vase = body("vase", "plastic = { reflectance = 0.5 }", &["sphere = { center = [-0.5, 1, 0], radius = 0.25 }"]);
    let sky = environment(1.0);
    let two = [[-2.0, -0.8], [0.2, 1.4]];
    let cases = [
        ("a hole under an even sky", room(&[[-1.0, 1.0]], WHITE, 64, &sky)),
        ("two holes, sun and sky", room(&two, WHITE, 64, &[SUN, &sky, &lawn].concat())),
        ("a pane, sun and sky", room(&two, WHITE, 64, &[&pane, SUN, &sky, &lawn].concat())),
        ("varnish and glaze", room(&two, WHITE, 64, &[&table, &vase, SUN, &sky].concat())),
        ("varnished walls", room(&two, "plastic = { reflectance = 0.7, roughness = 0.4 }", 64, &[SUN, &sky].concat())),
        (
            "one bounce",
            room(&two, WHITE, 64, &[SUN, &sky].concat()).replace("[render]\n", "[render]\ndiffuse_bounces = 1\n"),
        ),
        (
            "a lamp besides",
            room(
                &two,
                WHITE,
                64,
                &[
                    SUN,
                    &sky,
                    &body("lamp", "emissive = { radiance = 3 }", &["sphere = { center = [1, 2, -1], radius = 0.2 }"]),
                ]
                .concat(),
            ),
        ),
    ];
    for (name, text) in &cases {
        let found = learned_places(text).unwrap_or_else(|| panic!("{name}: nothing is bright"));
        assert!(!found.places.is_empty() && found.places.len() <= 6, "{found:?}");
        assert_same(&films(text, Some(&found), 8), &films(text, None, 8), cases.len(), name);
    }
}

/// The weight that limits of bounces leave out is reported, however bounces were aimed.
#[test]
fn aimed_bounces_leave_out_as_much_as_others() {
    let sky = environment(1.0);
    for (limit, walls) in [
        ("diffuse_bounces = 1", WHITE),
        ("diffuse_bounces = 3", WHITE),
        ("max_bounces = 2", "plastic = { reflectance = 0.7, roughness = 0.4 }"),
    ] {
        let text = room(&[[-2.0, -0.8], [0.2, 1.4]], walls, 64, &[SUN, &sky].concat());
        let text = text.replace("[render]\n", &format!("[render]\n{limit}\n"));
        let (scene, found) = (scene(&text), learned_places(&text));
        assert!(found.is_some(), "{limit}: something is bright");
        let of = |bright: Option<BrightPlaces>| {
            let setup = Method { bright, ..method(&scene, SPLITTING) };
            let of_seed = |seed| render(&prepare(&scene, Method { seed, ..setup.clone() }), &|_| ()).1.stopped;
            let (mean, variance) = mean_and_variance((0..8).map(of_seed));
            (mean, variance / 8.0)
        };
        let ((aimed, aimed_variance), (plain, plain_variance)) = (of(found), of(None));
        let error = (aimed_variance + plain_variance).sqrt();
        println!("{limit}: {aimed:.4} of the weight is left out, {plain:.4} +- {error:.1e} where nothing is aimed");
        assert!(plain > 0.05 && error < 0.02 * plain, "{limit}: {plain} +- {error}");
        // Means of 8 films have the heavier tails of Student's t distribution.
        assert!((aimed - plain).abs() < 1.6 * sigma_limit(3) * error, "{limit}: {aimed} for {plain} +- {error}");
    }
}

#[test]
fn a_room_that_sun_and_sky_light_through_windows_is_calmer_and_the_plan_says_so() {
    let sky = environment(1.0);
    let text = room(&[[-2.0, -0.8], [0.2, 1.4]], WHITE, 16, &[SUN, &sky].concat());
    let decided = plan(&scene(&text));
    assert!(decided.because.iter().any(|line| line.contains("bright place")), "{:?}", decided.because);
    let bright = decided.method.bright.expect("the room is learned");
    let [aimed, plain] = [Some(&bright), None].map(|bright| variance(&films(&text, bright, 8)));
    println!("variance {aimed:.5} for {plain:.5}");
    assert!(aimed < 0.8 * plain, "{aimed} for {plain}");
}

#[test]
fn what_no_room_encloses_is_left_as_it_is() {
    let open = view([3.0, 2.0, 3.0], [0.0, 0.5, 0.0], 40.0, 16)
        + "[render]\nsamples = 4\n"
        + &body("floor", WHITE, &["quad = { center = [0, 0, 0], u = [9, 0, 0], v = [0, 0, -9] }"])
        + &body("ball", WHITE, &["sphere = { center = [0, 1, 0], radius = 1 }"])
        + SUN
        + &environment(1.0);
    assert_eq!(plan(&scene(&open)).method.bright, None);
    // A room without a sky has nothing to open to.
    let lamp = body("lamp", "emissive = { radiance = 9 }", &["sphere = { center = [0, 2, 0], radius = 0.2 }"]);
    assert_eq!(plan(&scene(&room(&[], WHITE, 4, &lamp))).method.bright, None);
}

#[test]
fn the_same_places_are_learned_whatever_part_of_the_image_is_made() {
    let text = room(&[[-2.0, -0.8], [0.2, 1.4]], WHITE, 4, &[SUN, &environment(1.0)].concat());
    for window in ["crop = [3, 4, 5, 6]", "overscan = 20"] {
        let part = text.replace("[film]\n", &format!("[film]\n{window}\n"));
        assert_ne!(part, text);
        assert_eq!(plan(&scene(&part)).method.bright, plan(&scene(&text)).method.bright);
    }
}
