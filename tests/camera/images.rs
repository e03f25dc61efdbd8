//! How the lens, filters and crop affect an image.

use abbe::film::Film;
use abbe::plan::plan;
use abbe::trace::{Transport, prepare, render};

use crate::support::scenes::{EVERY_BRANCH, SPLITTING, environment, film_of, render_film, scene};

fn view(camera: &str, film: &str, samples: u32) -> String {
    format!(
        "[camera]\nposition = [0, 0, 0]\nlook_at = [0, 0, -1]\n{camera}\n[film]\n{film}\n[render]\nsamples = {samples}\n"
    )
}

const LAMP: &str = "[material.lamp]\nemissive = { radiance = 1 }\n";

/// Returns the variances of an image along x and y about its mean, in pixels.
fn variances(film: &Film) -> [f64; 2] {
    let (mut sum, mut first, mut second) = (0.0, [0.0; 2], [0.0; 2]);
    for y in 0..film.height {
        for x in 0..film.width {
            let weight = f64::from(film.at(x, y).rgb[1]);
            sum += weight;
            for (axis, place) in [x, y].into_iter().enumerate() {
                first[axis] += weight * f64::from(place);
                second[axis] += weight * f64::from(place) * f64::from(place);
            }
        }
    }
    [0, 1].map(|axis| second[axis] / sum - (first[axis] / sum) * (first[axis] / sum))
}

#[test]
fn a_point_out_of_focus_becomes_a_disc_of_the_size_that_the_thin_lens_gives() {
    let (radius, depth, spot, side) = (0.2, 4.0_f64, 0.04, 60);
    for (focus, written) in [(2.0, "2"), (f64::INFINITY, "inf"), (40.0, "40")] {
        // Light from depth d through the lens point l meets the plane one unit ahead at l (1/F - 1/d).
        let blur: f64 = 2.0 * radius * (1.0 / focus - 1.0 / depth).abs();
        // The image is as wide as three radii of the blur disc.
        let fov = 2.0 * libm::atan(0.75 * blur).to_degrees();
        let lens = format!("vertical_fov = {fov:?}\nlens = {{ radius = {radius}, focus_distance = {written} }}");
        let lamp = format!(
            "{LAMP}[[object]]\nshape.disc = {{ center = [0, 0, {:?}], normal = [0, 0, 1], radius = {spot} }}\nmaterial = \"lamp\"\n",
            -depth
        );
        let (film, _) =
            render_film(&(view(&lens, &format!("width = {side}\nheight = {side}"), 768) + &lamp), SPLITTING);
        let pixel = 1.5 * blur / f64::from(side);
        for variance in variances(&film) {
            // A disc of diameter D has the variance D^2 / 16. The lamp is such a disc, too. A pixel of side h adds h^2
            // / 12 (Sheppard).
            let lamp = (spot / depth) * (spot / depth) / 4.0;
            let found = 4.0 * (variance * pixel * pixel - lamp - pixel * pixel / 12.0).sqrt();
            println!(
                "focus {focus}: circle of confusion {found:.6} for {blur:.6}, off by {:.2} %",
                100.0 * (found / blur - 1.0)
            );
            assert!((found / blur - 1.0).abs() <= 0.01, "focus {focus}: {found} for {blur}");
        }
    }
}

#[test]
fn what_lies_in_the_plane_in_focus_is_as_sharp_as_through_a_pinhole() {
    let quad = format!(
        "{LAMP}[[object]]\nshape.quad = {{ center = [0.13, 0.07, -5], u = [0.9, 0.2, 0], v = [-0.1, 0.7, 0] }}\nmaterial = \"lamp\"\n"
    );
    let film_through = |lens: &str| {
        let camera = format!("vertical_fov = 40\nshift = [0.02, -0.03]\n{lens}");
        render_film(&(view(&camera, "width = 48\nheight = 32\nfilter = \"center\"", 32) + &quad), SPLITTING).0
    };
    let rgb = |film: &Film| film.pixels.iter().map(|pixel| pixel.rgb).collect::<Vec<_>>();
    let pinhole = rgb(&film_through(""));
    assert_eq!(rgb(&film_through("lens = { radius = 0.3, focus_distance = 5 }")), pinhole);
    assert_ne!(rgb(&film_through("lens = { radius = 0.3, focus_distance = 4 }")), pinhole);
}

#[test]
fn rays_that_start_inside_a_body_know_its_medium() {
    // The plane of the view cuts an absorbing ball of index 1. The camera's own position lies beside it.
    let ball = "[material.fog]\ndielectric = { index = 1, absorption = 0.7 }\n[[object]]\n\
                shape.sphere = { center = [1.5, 0, 0], radius = 1 }\nmaterial = \"fog\"\n";
    let camera = "projection = \"orthographic\"\nheight = 2";
    let film = "width = 60\nheight = 20\nfilter = \"center\"";
    let (film, report) = render_film(&(view(camera, film, 1) + ball + &environment(1.0)), EVERY_BRANCH);
    assert_eq!(report.unmatched, 0);
    for y in 0..20 {
        for x in 0..60 {
            let place = [(f64::from(x) + 0.5) * 0.1 - 3.0 - 1.5, 1.0 - (f64::from(y) + 0.5) * 0.1];
            let way = (1.0 - place[0] * place[0] - place[1] * place[1]).max(0.0).sqrt();
            let (found, expected) = (f64::from(film.at(x, y).rgb[1]), libm::exp(-0.7 * way));
            assert!((found - expected).abs() <= 1e-6, "{x}, {y}: {found} for {expected}");
        }
    }
}

#[test]
fn a_lens_that_dips_into_a_body_starts_its_rays_on_either_side() {
    // A box of fog starts beside the center of the lens and extends 6 units ahead of it. With the focus at infinity,
    // the rays of the middle pixel are parallel.
    for begin in [0.1_f64, -0.1] {
        let fog = format!(
            "[material.fog]\ndielectric = {{ index = 1, absorption = 0.5 }}\n[[object]]\n\
             shape.cube = {{ center = [{:?}, 0, -1.5], size = [10, 20, 9] }}\nmaterial = \"fog\"\n",
            begin + 5.0
        );
        let camera = "vertical_fov = 1e-6\nlens = { radius = 0.5, focus_distance = inf }";
        let film = "width = 1\nheight = 1\nfilter = \"center\"";
        let (film, report) = render_film(&(view(camera, film, 4096) + &fog + &environment(1.0)), SPLITTING);
        assert_eq!(report.unmatched, 0);
        // The fraction of a disk beyond a chord.
        let chord = begin / 0.5;
        let share = (libm::acos(chord) - chord * (1.0 - chord * chord).sqrt()) / std::f64::consts::PI;
        let expected = 1.0 - share + share * libm::exp(-0.5 * 6.0);
        let found = f64::from(film.at(0, 0).rgb[1]);
        // 4096 points of a (0, 2)-sequence: the fraction beyond a cut through the disk is accurate to about 64 points.
        assert!((found - expected).abs() <= 64.0 / 4096.0, "{found} for {expected}");
    }
}

#[test]
fn no_filter_changes_the_mean_of_an_even_image() {
    let filters = ["\"box\"", "\"center\"", "\"tent\"", "\"gaussian\"", "\"blackman-harris\""];
    for filter in filters.into_iter().chain(["{ tent = { radius = 2 } }", "{ gaussian = { sigma = 1.5 } }"]) {
        let film = format!("width = 5\nheight = 4\nfilter = {filter}");
        let (film, _) = render_film(&(view("vertical_fov = 40", &film, 16) + &environment(1.0)), SPLITTING);
        assert!(film.pixels.iter().all(|pixel| pixel.rgb == film.pixels[0].rgb), "{filter}");
        assert!((film.pixels[0].rgb[1] - 1.0).abs() <= 4.0 * f32::EPSILON, "{filter}: {:?}", film.pixels[0].rgb);
    }
}

#[test]
fn an_edge_through_a_wide_filter_is_the_integral_of_the_filter() {
    // The edge x = 0 lies in the middle of an image with an odd number of pixels: pixel k sees the part of a tent
    // beyond k.
    let wall = format!(
        "{LAMP}[[object]]\nshape.quad = {{ center = [50, 0, -1], u = [50, 0, 0], v = [0, 50, 0] }}\nmaterial = \"lamp\"\n"
    );
    let film = "width = 7\nheight = 1\nfilter = { tent = { radius = 2 } }";
    let (film, _) = render_film(&(view("vertical_fov = 10", film, 4096) + &wall), SPLITTING);
    for (k, expected) in [0.0, 0.0, 0.125, 0.5, 0.875, 1.0, 1.0].into_iter().enumerate() {
        let found = f64::from(film.at(k as u32, 0).rgb[1]);
        // The strata along the axis have a size of 1 / 4096.
        assert!((found - expected).abs() <= 2.0 / 4096.0, "pixel {k}: {found} for {expected}");
    }
}

const ROOM: &str = r#"
[camera]
position = [0, 1.5, 6]
look_at = [0, 0.7, 0]
vertical_fov = 35
lens = { radius = 0.1, focus_distance = 5 }
[film]
width = 75
height = 43
filter = "gaussian"
[render]
samples = 4
[material]
floor.diffuse.reflectance = 0.6
glass.dielectric.index = "N-SF11"
lamp.emissive.radiance = { illuminant = "D65" }
[[object]]
shape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }
material = "floor"
[[object]]
shape.sphere = { center = [0, 0.8, 0], radius = 0.8 }
material = "glass"
[[object]]
shape.quad = { center = [0.5, 3, 0], u = [0.5, 0, 0], v = [0, 0, 0.5] }
material = "lamp"
"#;

#[test]
fn a_crop_has_the_bits_of_the_full_image() {
    let crops = ["[13, 7, 31, 20]", "[0, 0, 75, 43]", "[74, 42, 1, 1]", "[16, 0, 16, 43]"];
    let whole = scene(ROOM);
    let planned = plan(&whole).method;
    assert!(matches!(planned.transport, Transport::Random { .. }));
    let full = film_of(&whole, planned.clone());
    for crop in crops {
        let part = scene(&ROOM.replace("height = 43", &format!("height = 43\ncrop = {crop}")));
        let method = plan(&part).method;
        assert_eq!(method, planned);
        let (film, report) = render(&prepare(&part, method), &|_| ());
        assert_eq!(report.samples, 4 * film.pixels.len() as u64);
        assert_eq!(film.full, [75, 43]);
        for y in 0..film.height {
            for x in 0..film.width {
                assert_eq!(
                    film.at(x, y),
                    full.at(film.corner[0] as u32 + x, film.corner[1] as u32 + y),
                    "{crop}: {x}, {y}"
                );
            }
        }
    }
}

#[test]
fn the_plan_leaves_a_lens_to_chance() {
    let mirror = "[material.silver]\nmirror = { reflectance = 0.9 }\n[[object]]\n\
                  shape.sphere = { center = [0, 0, -4], radius = 1 }\nmaterial = \"silver\"\n";
    let planned = |lens: &str| {
        let camera = format!("vertical_fov = 40\n{lens}");
        let film = "width = 8\nheight = 8\nfilter = \"center\"";
        plan(&scene(&(view(&camera, film, 1) + mirror + &environment(1.0)))).method.transport.name()
    };
    assert_eq!(planned(""), "deterministic");
    assert_eq!(planned("lens = { radius = 0, focus_distance = 4 }"), "deterministic");
    assert_eq!(planned("lens = { radius = 0.1, focus_distance = 4 }"), "random");
}
