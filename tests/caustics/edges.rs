//! Caustics at places where surfaces end, meet or are made of pieces.

use abbe::film::Window;
use abbe::plan::plan;
use abbe::trace::{LightPass, MapPasses, Method, Smoothness};

use super::agreement::{blocks, camera_and_film, scene_and_method};
use crate::support::scenes::{SPLITTING, film_of, mean_color, object, scene, sigma_limit};

/// A camera that looks the other way and sees the scene in a mirror in front of it.
const VIEW: &str = "position = [0, 6, 6]\nlook_at = [0, 6, 5]\nvertical_fov = 25";
const WINDOW: &str = "quad = { center = [0, 6, 5], u = [0.6, 0, 0], v = [0, 0.216, 0.4608] }";
/// Surfaces so dark that the light they reflect adds nothing visible elsewhere.
const MATERIALS: &str =
    "[material.matte]\ndiffuse = { reflectance = 0.001 }\n[material.mirror]\nmirror = { reflectance = 1 }\n";

fn point(x: f64, y: f64) -> String {
    format!("[[light]]\npoint = {{ position = [{x}, {y}, 2], intensity = 8 }}\n")
}

/// Returns a point light beside a vertical mirror at x = 3. The light is as high above the origin as it is below.
fn lit_by_mirror(bodies: &str, height: f64) -> String {
    let mirror = format!("quad = {{ center = [3, {}, 1.5], u = [0, 0.8, 0], v = [0, 0, 0.7] }}", height * 2.3 / 3.0);
    camera_and_film(VIEW, "")
        + MATERIALS
        + &object("mirror", WINDOW)
        + &object("mirror", &mirror)
        + bodies
        + &point(2.0, height)
}

/// Returns the scene of [`lit_by_mirror`] with the light's mirror image in place of the mirror.
fn lit_by_image(bodies: &str, height: f64) -> String {
    camera_and_film(VIEW, "")
        + MATERIALS
        + &object("mirror", WINDOW)
        + bodies
        + &point(2.0, height)
        + &point(4.0, height)
}

/// A map whose photons are gathered within 1.5 pixels, a sixteenth of the image.
const WIDE: MapPasses = MapPasses { count: 4, photons: 32_768, radius: 1.5, chance: 1.0 };

/// Compares the light of a mirror, which photons contribute, with the light of a lamp at its mirror image, which is
/// sampled directly.
fn assert_agree(what: &str, bodies: &str, map: MapPasses) {
    let gathered = blocks(&scene_and_method(&lit_by_mirror(bodies, 3.0)), true, Some(map), 64);
    let reference = blocks(&scene_and_method(&lit_by_image(bodies, 3.0)), false, None, 64);
    let limit = 1.25 * sigma_limit(gathered.len());
    let mut sums = [0.0; 3];
    for (a, b) in gathered.iter().zip(&reference) {
        let error = (a.1 + b.1).sqrt();
        assert!((a.0 - b.0).abs() <= 0.01 * b.0 + limit * error, "{what}: {} for {}, error {error}", a.0, b.0);
        [a.0, b.0, a.1 + b.1].into_iter().zip(&mut sums).for_each(|(x, sum)| *sum += x);
    }
    let [gathered, reference, variance] = sums;
    // The three bands of a block are correlated.
    let (ratio, error) = (gathered / reference, (3.0 * variance).sqrt() / reference);
    println!("{what}: {ratio:.5} of what is known, error {error:.5}");
    assert!(
        (ratio - 1.0).abs() < 0.003 + 3.0 * error && error < 0.003,
        "{what}: {ratio} of what is known, error {error}"
    );
}

#[test]
fn k4_light_is_right_where_a_table_ends_and_where_a_wall_meets_it() {
    let bodies = object("matte", "quad = { center = [-0.2, 0, 0], u = [1, 0, 0], v = [0, 0, 1] }")
        + &object("matte", "quad = { center = [-1.2, 0.5, 0], u = [0, 0.5, 0], v = [0, 0, 1] }")
        + &object("matte", "quad = { center = [-0.2, -0.5, 1], u = [1, 0, 0], v = [0, 0.5, 0] }");
    assert_agree("table and wall", &bodies, WIDE);
}

#[test]
fn k4_light_is_right_on_bodies_that_stand_on_a_floor_and_on_the_floor_around_them() {
    let bodies = object("matte", "quad = { center = [-0.2, 0, 0], u = [1, 0, 0], v = [0, 0, 1] }")
        + &object("matte", "cube = { center = [-0.2, 0.3, -0.2], size = [0.6, 0.6, 0.6] }")
        + &object("matte", "cube = { center = [-0.8, 0.05, 0.3], size = [0.2, 0.1, 0.3] }")
        + &object("matte", "sphere = { center = [0.4, 0.3, 0.2], radius = 0.3 }");
    // Shadows are blurred from block to block in proportion to the square of the radius.
    assert_agree("bodies", &bodies, MapPasses { radius: 0.75, ..WIDE });
}

#[test]
fn k4_light_is_right_on_coins_smaller_than_the_kernel_and_on_laths_with_gaps() {
    let coin = |x: f64, z: f64, radius: f64| {
        object("matte", &format!("disc = {{ center = [{x}, 0.3, {z}], normal = [0, 1, 0], radius = {radius} }}"))
    };
    let lath = |i: i32| {
        let x = -1.0 + 0.05 * f64::from(i);
        object("matte", &format!("quad = {{ center = [{x}, 0, 0.4], u = [0.015, 0, 0], v = [0, 0, 0.4] }}"))
    };
    let coins: String = (0..4)
        .flat_map(|row| (0..6).map(move |column| (row, column)))
        .map(|(row, column)| {
            coin(-0.8 + 0.3 * f64::from(column), -0.8 + 0.2 * f64::from(row), 0.03 * f64::from(1 + column % 3))
        })
        .collect();
    assert_agree("coins and laths", &(coins + &(0..36).map(lath).collect::<String>()), WIDE);
}

/// Returns the mean of an image that is rendered as planned.
fn planned_mean(text: &str) -> [f64; 3] {
    let scene = scene(text);
    let method = plan(&scene).method;
    assert!(method.light_pass.as_ref().is_some_and(|pass| pass.map.is_some()), "nothing is gathered");
    mean_color(&film_of(&scene, method))
}

/// Returns a glass ball above a floor of `count` pieces, seen in a mirror above. `turned` flips every other piece.
fn pieces(count: u32, turned: bool) -> String {
    let lath = |i: u32| {
        let half = 1.6 / f64::from(count);
        let x = -1.6 + f64::from(2 * i + 1) * half;
        let along = if turned && i % 2 == 1 { -half } else { half };
        object("floor", &format!("quad = {{ center = [{x:?}, 0, 0], u = [{along:?}, 0, 0], v = [0, 0, 1.6] }}"))
    };
    camera_and_film("position = [0, 2.8, 1.2]\nlook_at = [0, 4, 0.9]\nvertical_fov = 34", "")
        + "[render]\nsamples = 64\n[material.floor]\ndiffuse = { reflectance = 0.6 }\n"
        + "[material.glass]\ndielectric = { index = 1.5 }\n[material.mirror]\nmirror = { reflectance = 1 }\n"
        + &object("mirror", "quad = { center = [0, 4, 0], u = [3, 0, 0], v = [0, 0, 3] }")
        + &object("glass", "sphere = { center = [0, 1.2, -0.5], radius = 0.5 }")
        + "[[light]]\npoint = { position = [0.8, 3.5, -0.5], intensity = 1 }\n"
        + &(0..count).map(lath).collect::<String>()
}

#[test]
fn k3_a_floor_laid_in_two_thousand_pieces_shows_the_caustic_of_one() {
    let whole = planned_mean(&pieces(1, false));
    for (count, turned) in [(10, false), (10, true), (200, false), (2000, false), (2000, true)] {
        let in_pieces = planned_mean(&pieces(count, turned));
        let ratio = in_pieces[1] / whole[1];
        println!("{count} pieces: {ratio:.6}");
        assert!((ratio - 1.0).abs() < 0.002, "a floor of {count} pieces shows {ratio} of the light");
    }
}

#[test]
fn k5_a_thin_table_that_is_lit_from_below_does_not_glow_above() {
    let table = object("matte", "cube = { center = [-0.2, 0, 0], size = [2, 1e-4, 2] }");
    let brightness_at = |height: f64| {
        let scene = scene(&lit_by_mirror(&table, height));
        let light_pass = Some(LightPass {
            photons: 32_768,
            lights: vec![0],
            openings: Vec::new(),
            to: vec![Smoothness::Whole],
            map: Some(WIDE),
        });
        let method = Method { samples: 4, transport: SPLITTING, light_pass, ..plan(&scene).method };
        mean_color(&film_of(&scene, method))[1]
    };
    let (above, below) = (brightness_at(3.0), brightness_at(-3.0));
    assert!(above > 0.0 && below == 0.0, "{above} lit from above, {below} from below");
}

#[test]
fn what_is_gathered_is_the_same_on_any_number_of_threads_and_in_any_part_of_the_image() {
    let whole = scene(&pieces(10, true));
    let method = Method { samples: 8, ..plan(&whole).method };
    let render_on = |threads: usize, crop: Option<Window>| {
        let mut part = whole.clone();
        part.film.crop = crop;
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started");
        pool.install(|| film_of(&part, method.clone()))
    };
    let (film, crop) = (render_on(1, None), Window { left: 5, top: 9, width: 11, height: 7 });
    assert!(render_on(3, None) == film, "3 threads make another image");
    for (i, pixel) in render_on(2, Some(crop)).pixels.iter().enumerate() {
        let (x, y) = (crop.left as usize + i % 11, crop.top as usize + i / 11);
        assert!(film.pixels[y * film.width as usize + x] == *pixel, "the pixel {x}, {y} is another");
    }
}
