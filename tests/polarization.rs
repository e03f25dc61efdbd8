//! Polarization compared with closed forms: Stokes vectors behind rows of sheets, mirrors, glass and panes.
//!
//! Expected numbers are those of the formulas that the tests name, computed in f64. Metals and sheets were compared
//! with Mitsuba 3.9.1 (`*_polarized`), which agrees to its own 32 bits. A camera at z = 5 looks along -z, and up is +y:
//! horizontal light has a positive S1.

mod criterion;
mod degrees;
mod folded;
mod furnaces;
mod plates;

use abbe::Options;
use abbe::film::{Film, Layer};
use abbe::math::DVec3;

use crate::support::fresnel::reflectances;
use crate::support::scenes::{assert_near, body, mean_and_variance, one_pixel, quad, render_text, render_text_with};

/// Lanes are f32 and are rounded at each of a few surfaces.
const ROUNDING: f64 = 2e-6;

/// Renders one pixel of a narrow view of some objects and lights, with more keys of the camera. Returns S0, S1, S2 and
/// S3.
fn stokes(camera: &str, rest: &str) -> [f64; 4] {
    green_stokes(render_text(&(one_pixel(camera, ", stokes = true") + rest)).film())
}

fn green_stokes(film: &Film) -> [f64; 4] {
    stokes_vectors(film).map(|component| component[1])
}

/// Returns S0, S1, S2 and S3 of the first pixel, each in red, green and blue.
pub fn stokes_vectors(film: &Film) -> [[f64; 3]; 4] {
    let find_layer = |layer: Layer| {
        let image = film.layers.iter().find(|image| image.layer == layer).expect("the layer is there");
        [0, 1, 2].map(|channel| f64::from(image.values[channel]))
    };
    [film.pixels[0].rgb.map(f64::from), find_layer(Layer::S1), find_layer(Layer::S2), find_layer(Layer::S3)]
}

const SKY: &str = "[[light]]\nenvironment.radiance = 1\n";

/// Returns sheets in front of the sky, the first one nearest to the camera. They are seen straight on or turned about y
/// by some degrees.
fn sheets(sheets: &[String], turned: f64) -> String {
    sheets_apart(sheets, turned, 1.0)
}

/// Returns sheets as [`sheets`] does, at a given distance from each other.
fn sheets_apart(sheets: &[String], turned: f64, apart: f64) -> String {
    let mut text = SKY.to_owned();
    for (number, sheet) in sheets.iter().enumerate() {
        text += &format!(
            "[material.sheet{number}]\n{sheet}\n[[object]]\nmaterial = \"sheet{number}\"\n\
             shape.quad = {{ center = [0, 0, 0], u = [0.5, 0, 0], v = [0, 0.5, 0] }}\n\
             transform = [{{ rotate = {{ axis = [0, 1, 0], degrees = {turned} }} }}, \
             {{ translate = [0, 0, {}] }}]\n",
            -apart * number as f64
        );
    }
    text
}

fn polarizer(degrees: f64, extinction: f64) -> String {
    let (sin, cos) = degrees.to_radians().sin_cos();
    format!("polarizer = {{ axis = [{cos}, {sin}, 0], extinction = {extinction} }}")
}

fn retarder(degrees: f64, retardance: f64) -> String {
    let (sin, cos) = degrees.to_radians().sin_cos();
    format!("retarder = {{ axis = [{cos}, {sin}, 0], retardance = {retardance} }}")
}

#[test]
fn two_polarizers_let_through_what_malus_says() {
    for degrees in [0.0_f64, 15.0, 30.0, 45.0, 60.0, 75.0, 90.0] {
        let cos = degrees.to_radians().cos();
        let found = stokes("", &sheets(&[polarizer(0.0, 0.0), polarizer(degrees, 0.0)], 0.0));
        let half = 0.5 * cos * cos;
        assert_near(found, [half, half, 0.0, 0.0], ROUNDING, &format!("{degrees} degrees"));
        let found = stokes("", &sheets(&[polarizer(degrees, 0.0), polarizer(0.0, 1e-4)], 0.0));
        let half = 0.5 * (cos * cos + 1e-4 * (1.0 - cos * cos));
        let turned = |x: f64| f64::to_radians(2.0 * degrees) * x;
        let expected = [half, half * turned(1.0).cos(), half * turned(1.0).sin(), 0.0];
        assert_near(found, expected, ROUNDING, &format!("{degrees} degrees before a leaking one"));
    }
    let three = stokes("", &sheets(&[0.0, 45.0, 90.0].map(|degrees| polarizer(degrees, 0.0)), 0.0));
    assert_near(three, [0.125, 0.125, 0.0, 0.0], ROUNDING, "three");
}

#[test]
fn a_filter_before_the_camera_is_a_sheet() {
    for degrees in [0.0_f64, 30.0, 90.0, 120.0] {
        let filter = format!(", polarizer = {{ axis = {degrees}, extinction = 0.01 }}");
        let behind = sheets(&[polarizer(20.0, 0.0)], 0.0);
        let by_sheet = stokes("", &sheets(&[polarizer(degrees, 0.01), polarizer(20.0, 0.0)], 0.0));
        assert_near(stokes(&filter, &behind), by_sheet, ROUNDING, &format!("{degrees} degrees"));
    }
}

/// Crossed polarizers transmit light at oblique incidence if the plane of incidence lies between their axes: seen along
/// the ray, the absorbing axes are no longer at right angles.
#[test]
fn crossed_polarizers_leak_aslant() {
    for (degrees, expected) in [(15.0, 0.000600), (30.0, 0.010204), (45.0, 0.055556), (60.0, 0.180000)] {
        let found = stokes("", &sheets(&[polarizer(45.0, 0.0), polarizer(-45.0, 0.0)], degrees));
        assert!((found[0] - expected).abs() < 2e-6, "{degrees} degrees: {found:?} for {expected}");
    }
}

#[test]
fn wave_plates_turn_linear_light() {
    let behind = |plate: String, axis: f64| stokes("", &sheets(&[plate, polarizer(axis, 0.0)], 0.0));
    for (plate, expected) in [
        (retarder(45.0, 90.0), [0.5, 0.0, 0.0, 0.5]),
        (retarder(-45.0, 90.0), [0.5, 0.0, 0.0, -0.5]),
        (retarder(22.5, 180.0), [0.5, 0.0, 0.5, 0.0]),
        (retarder(45.0, 180.0), [0.5, -0.5, 0.0, 0.0]),
        (retarder(45.0, 60.0), [0.5, 0.25, 0.0, 0.433013]),
    ] {
        assert_near(behind(plate.clone(), 0.0), expected, ROUNDING, &plate);
    }
    for retardance in [30.0_f64, 60.0, 90.0, 120.0, 180.0] {
        let sheets = sheets(&[polarizer(0.0, 0.0), retarder(45.0, retardance), polarizer(90.0, 0.0)], 0.0);
        let sin = (0.5 * retardance.to_radians()).sin();
        let through = 0.5 * sin * sin;
        assert_near(stokes("", &sheets), [through, through, 0.0, 0.0], ROUNDING, &format!("{retardance} degrees"));
    }
}

/// Returns mirrors at intervals of 1 along a ray, with the normals that the ray meets.
fn mirrors(material: &str, normals: &[DVec3]) -> String {
    let is_body = material.starts_with("dielectric");
    let mut text = format!("{SKY}[material.mirror]\n{material}\n");
    let (mut place, mut direction) = (DVec3::ZERO, DVec3::NEG_Z);
    for normal in normals.iter().map(|normal| normal.normalize()) {
        let middle = place - 0.2 * normal;
        text += &match is_body {
            false => format!(
                "[[object]]\nmaterial = \"mirror\"\n\
                 shape.disc = {{ center = [{}, {}, {}], normal = [{}, {}, {}], radius = 0.2 }}\n",
                place.x, place.y, place.z, normal.x, normal.y, normal.z
            ),
            true => format!(
                "[[object]]\nmaterial = \"mirror\"\nshape.sphere = {{ center = [{}, {}, {}], radius = 0.2 }}\n",
                middle.x, middle.y, middle.z
            ),
        };
        direction -= 2.0 * direction.dot(normal) * normal;
        place += direction;
    }
    text
}

/// Glass that absorbs all light that enters it.
const BLACK_GLASS: &str = "dielectric = { index = 1.5, absorption = 1e6 }";

/// Metals of index n - i k. Mitsuba's `scalar_mono_polarized` shows the same ten pixels to 2.4e-7.
#[test]
fn metals_mirror_all_four_components() {
    let gold = "conductor = { n = 0.43, k = 2.455 }";
    let aluminum = "conductor = { n = 1.015, k = 6.627 }";
    let slanting = DVec3::new(1.0, 0.0, 1.0);
    let (sin, cos) = f64::to_radians(30.0).sin_cos();
    let up = DVec3::new(0.0, 1.0, 1.0).normalize() - DVec3::X;
    let grazing = [
        DVec3::new(0.965925826, 0.0, 0.258819045),
        DVec3::new(0.462096828, 0.683012702, 0.565650219),
        DVec3::new(-0.159272307, -0.985466895, 0.059053637),
    ];
    for (material, normals, expected) in [
        (gold, vec![slanting], [0.785459, -0.063955, 0.0, 0.0]),
        (gold, vec![DVec3::new(cos, sin, 1.0)], [0.785459, -0.031978, -0.055387, 0.0]),
        (gold, vec![slanting, up], [0.616945, -0.050234, 0.043242, 0.025236]),
        (gold, grazing[..2].to_vec(), [0.680673, -0.097907, -0.028745, 0.092527]),
        (gold, grazing.to_vec(), [0.533189, -0.056212, 0.041503, 0.090961]),
        (aluminum, grazing.to_vec(), [0.684973, -0.107958, 0.075201, 0.048315]),
        ("mirror = {}", grazing.to_vec(), [1.0, 0.0, 0.0, 0.0]),
    ] {
        let found = stokes("", &mirrors(material, &normals));
        assert_near(found, expected, ROUNDING, &format!("{material}, {} mirrors", normals.len()));
    }
}

#[test]
fn a_mirror_turns_handedness_around() {
    let scene = mirrors("mirror = {}", &[DVec3::new(1.0, 0.0, 1.0)])
        + "[material]\nplate.retarder = { axis = [0, 1, 1], retardance = 90 }\nsheet.polarizer.axis = [0, 1, 0]\n\
           [[object]]\nmaterial = \"plate\"\nshape.quad = { center = [1, 0, 0], u = [0, 0.2, 0], v = [0, 0, 0.2] }\n\
           [[object]]\nmaterial = \"sheet\"\nshape.quad = { center = [2, 0, 0], u = [0, 0.2, 0], v = [0, 0, 0.2] }\n";
    // In a view toward +x, z is to the right, so the plate's axis lies at 45 degrees.
    let straight = stokes("", &sheets(&[retarder(45.0, 90.0), polarizer(90.0, 0.0)], 0.0));
    assert_near(straight, [0.5, 0.0, 0.0, straight[3]], ROUNDING, "straight");
    let mirrored = stokes("", &scene);
    assert_near(mirrored, [0.5, 0.0, 0.0, -straight[3]], ROUNDING, "mirrored");
    assert!((straight[3].abs() - 0.5).abs() < ROUNDING, "{straight:?}");
}

/// Black glass of index 1.5 behind a filter that passes only p, behind one that passes only s, and without a filter. At
/// Brewster's angle, no p is left.
#[test]
fn a_filter_takes_the_glare_off_glass() {
    for (degrees, p, s, all) in [
        (45.0_f64, 0.004233, 0.046007, 0.050240),
        (56.309932, 0.0, 0.073964, 0.073964),
        (65.0, 0.006482, 0.114031, 0.120513),
    ] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let glass = mirrors(BLACK_GLASS, &[DVec3::new(sin, 0.0, cos)]);
        // The plane of incidence is horizontal.
        for (filter, expected) in [(", polarizer.axis = 0", p), (", polarizer.axis = 90", s), ("", all)] {
            let found = stokes(filter, &glass)[0];
            assert!((found - expected).abs() < 1e-6, "{degrees} degrees{filter}: {found} for {expected}");
        }
    }
}

/// Glass of index 1.5 reflects light polarized at 45 degrees as c / a of its Mueller matrix states. Below Brewster's
/// angle, the plane of polarization turns the other way.
#[test]
fn glass_turns_the_plane_of_polarization() {
    for (degrees, a, d, c) in [
        (30.0_f64, 0.041523, 0.391918, -0.92),
        (45.0, 0.050240, 0.831479, -0.555556),
        (75.0, 0.253061, 0.578105, 0.815963),
    ] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let normal = DVec3::new(sin, 0.0, cos);
        let direction = DVec3::NEG_Z + 2.0 * cos * normal;
        let p = DVec3::Y.cross(direction);
        let [u, v, place, axis] = [0.2 * p, 0.2 * DVec3::Y, direction, DVec3::Y + p];
        let scene = mirrors(BLACK_GLASS, &[normal])
            + &body("sheet", &format!("polarizer.axis = {:?}", axis.to_array()), &[&quad(place, u, v)]);
        // s is vertical.
        let expected = [0.5 * a, -0.5 * a * d, -0.5 * a * c, 0.0];
        assert_near(stokes("", &scene), expected, ROUNDING, &format!("{degrees} degrees"));
    }
}

/// A second plane of incidence is turned relative to the first. The second surface may not reflect the light that the
/// first one favors.
#[test]
fn two_reflections_depend_on_how_their_planes_lie() {
    for (degrees, expected) in [
        (45.0_f64, [0.00426907, 0.00339656, 0.00252405, 0.00165154, 0.00077903]),
        (56.309932, [0.01094149, 0.00820612, 0.00547075, 0.00273537, 0.0]),
    ] {
        for (turned, expected) in [0.0_f64, 30.0, 45.0, 60.0, 90.0].into_iter().zip(expected) {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let first = DVec3::new(sin, 0.0, cos);
            let direction = DVec3::NEG_Z - 2.0 * DVec3::NEG_Z.dot(first) * first;
            let across = direction.cross(DVec3::Y);
            let (sin_turned, cos_turned) = turned.to_radians().sin_cos();
            let second = -direction * cos + (across * cos_turned + DVec3::Y * sin_turned) * sin;
            let scene = mirrors(BLACK_GLASS, &[first, second]);
            let found = stokes("", &scene)[0];
            assert!((found - expected).abs() < 3e-8, "{degrees}, {turned} degrees: {found} for {expected}");
        }
    }
}

/// Returns a pile of panes in front of a lamp. There is no other light, so the panes reflect black.
fn pile(plates: usize, index: f64, degrees: f64) -> String {
    let lamp = "[material.lamp.emissive]\nradiance = 1\n[[object]]\nmaterial = \"lamp\"\n\
                shape.disc = { center = [0, 0, -20], normal = [0, 0, 1], radius = 0.5 }\n";
    let panes = vec![format!("thin = {{ index = {index} }}"); plates];
    sheets_apart(&panes, degrees, 1e-3).replace(SKY, lamp)
}

/// Returns what the pile transmits, and S1 if s is vertical. Each polarization transmits (1 - R) / (1 + (2 m - 1) R)
/// (Stokes 1862, *On the Intensity of the Light Reflected from or Transmitted through a Pile of Plates*).
fn through_pile(plates: usize, index: f64, degrees: f64) -> [f64; 2] {
    let through = |r: f64| (1.0 - r) / (1.0 + (2.0 * plates as f64 - 1.0) * r);
    let [s, p] = reflectances(index, degrees.to_radians().cos()).map(through);
    [0.5 * (s + p), 0.5 * (p - s)]
}

/// A pile of plates without interference between them.
#[test]
fn a_pile_of_plates_polarizes() {
    // Known numbers, which show that the formula is right.
    let [t, s1] = through_pile(4, 1.5168, 56.603838);
    assert!((t - 0.702374).abs() < 1e-6 && (s1 / t - 0.423743).abs() < 1e-6, "{t}, {s1}");
    for (index, degrees) in [(1.5, 45.0), (1.5168, 56.603838), (1.5168, 75.0)] {
        for plates in [1, 2] {
            let [t, s1] = through_pile(plates, index, degrees);
            let found = stokes("", &pile(plates, index, degrees));
            assert_near(found, [t, s1, 0.0, 0.0], 1e-5, &format!("{plates} of {index} at {degrees} degrees"));
        }
    }
}

/// A pile with too many light paths to follow them all. They are sampled, so the mean of many pixels is compared.
#[test]
fn a_pile_of_many_plates_polarizes_on_average() {
    for plates in [4, 10] {
        let text = format!(
            "camera = {{ position = [0, 0, 5], look_at = [0, 0, 0], projection = \"orthographic\", height = 1e-6 }}\n\
             film = {{ width = 24, height = 24, stokes = true }}\nrender = {{ samples = 16 }}\n{}",
            pile(plates, 1.5168, 56.603838)
        );
        let image = render_text_with(&text, &Options::default());
        let film = image.film();
        let s1 = film.layers.iter().find(|image| image.layer == Layer::S1).expect("the layer is there");
        let seen = [
            mean_and_variance(film.pixels.iter().map(|pixel| f64::from(pixel.rgb[1]))),
            mean_and_variance(s1.channel(1).map(f64::from).collect::<Vec<_>>().into_iter()),
        ];
        for ((mean, variance), expected) in seen.into_iter().zip(through_pile(plates, 1.5168, 56.603838)) {
            let error = (variance / film.pixels.len() as f64).sqrt();
            let z = (mean - expected) / error;
            println!("{plates} plates: {mean:.6} +- {error:.6} for {expected:.6}, z {z:.2}");
            assert!(z.abs() < 4.0 && error < 0.01, "{plates} plates: {mean} +- {error} for {expected}");
        }
    }
}

/// A Fresnel rhomb of index 1.51 at 54.6 degrees turns light polarized at 45 degrees into circular light.
#[test]
fn total_reflection_shifts_the_phase() {
    let angle = 54.6_f64.to_radians();
    let rhomb = |reflections: usize| {
        // Inside glass that is all around, a slab of air reflects totally. Its face is hit at the angle.
        let mut text = format!("{SKY}[material]\nglass.dielectric.index = 1.51\nair.thin.index = 1\n");
        let (mut place, mut direction) = (DVec3::ZERO, DVec3::NEG_Z);
        for number in 0..reflections {
            let sign = if number % 2 == 0 { 1.0 } else { -1.0 };
            let normal = DVec3::new(sign * angle.sin(), 0.0, angle.cos());
            let normal = if number == 0 { normal } else { DVec3::new(-angle.sin(), 0.0, -angle.cos()) };
            text += &format!(
                "[[object]]\nmaterial = \"air\"\nshape.disc = {{ center = [{}, {}, {}], normal = [{}, {}, {}], radius = 0.2 }}\n",
                place.x, place.y, place.z, normal.x, normal.y, normal.z
            );
            direction -= 2.0 * direction.dot(normal) * normal;
            place += direction;
        }
        let across = direction.cross(DVec3::Y);
        let (u, v) = (0.2 * across, 0.2 * DVec3::Y);
        let axis = across + DVec3::Y;
        text += &body("sheet", &format!("polarizer.axis = {:?}", axis.to_array()), &[&quad(place, u, v)]);
        text + "[[object]]\nmaterial = \"glass\"\nshape.sphere = { center = [0, 0, 0], radius = 100 }\n"
    };
    for (reflections, expected) in [(1, [0.706958, 0.707256]), (2, [0.000422, 1.0])] {
        let found = stokes("", &rhomb(reflections));
        let [s2, s3] = [found[2], found[3]].map(|part| (part / found[0]).abs());
        assert!((s2 - expected[0]).abs() < 1e-5 && (s3 - expected[1]).abs() < 1e-5, "{reflections}: {found:?}");
    }
}

/// Light from the base of plastic leaves through the coat, which polarizes it partly in the plane of the normal.
#[test]
fn a_coat_polarizes_what_comes_from_below() {
    for (degrees, expected) in
        [(30.0, 0.016978), (45.0, 0.043983), (60.0, 0.095941), (75.0, 0.195860), (85.0, 0.308744)]
    {
        let plastic = "plastic = { reflectance = 0.8, index = 1.5 }".to_owned();
        // The camera does not see the reflection of a lamp straight above.
        let (sin, cos) = f64::to_radians(degrees).sin_cos();
        let scene = sheets(&[plastic], degrees).replace(SKY, "")
            + &format!("[[light]]\npoint = {{ position = [{}, 0, {}], intensity = 100 }}\n", 10.0 * sin, 10.0 * cos);
        let found = stokes("", &scene);
        assert!((found[1] / found[0] - expected).abs() < 1e-5, "{degrees} degrees: {found:?} for {expected}");
        assert!(found[2].abs() + found[3].abs() < 1e-6 * found[0], "{degrees} degrees: {found:?}");
    }
}

/// Water under a sky whose light is polarized to a degree of 0.7 wherever the camera looks, at an angle from s.
#[test]
fn a_polarized_sky_changes_what_water_mirrors() {
    for (degrees, expected) in [
        (30.0_f64, [0.028139, 0.024810, 0.021480, 0.014820]),
        (45.0, [0.045541, 0.036745, 0.027949, 0.010357]),
        (53.1315, [0.066662, 0.052937, 0.039213, 0.011764]),
        (70.0, [0.193998, 0.163791, 0.133584, 0.073169]),
    ] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let normal = DVec3::new(sin, 0.0, cos);
        let direction = DVec3::NEG_Z - 2.0 * DVec3::NEG_Z.dot(normal) * normal;
        let p = direction.cross(DVec3::Y);
        for (turned, expected) in [0.0_f64, 30.0, 45.0, 90.0].into_iter().zip(expected) {
            // A quarter turn from the sun, skylight is polarized perpendicular to both directions. Here s is vertical.
            let (sin, cos) = turned.to_radians().sin_cos();
            let sun = p * cos + DVec3::Y * sin;
            let scene = mirrors("dielectric = { index = 1.3334, absorption = 1e6 }", &[normal]);
            let sky = format!(
                "environment = {{ radiance = 1, polarization = {{ sun = [{}, {}, {}], degree = 0.7 }} }}",
                sun.x, sun.y, sun.z
            );
            let found = stokes("", &scene.replace("environment.radiance = 1", &sky))[0];
            assert!((found - expected).abs() < 1e-6, "{degrees}, {turned} degrees: {found} for {expected}");
        }
    }
}

/// Facets that hardly differ from the surface polarize like the surface.
#[test]
fn nearly_smooth_surfaces_polarize_as_smooth_ones() {
    let slanting = [DVec3::new(1.0, 0.0, 1.0)];
    for (rough, smooth) in [
        ("conductor = { n = 0.43, k = 2.455, roughness = 0.12 }", "conductor = { n = 0.43, k = 2.455 }"),
        ("dielectric = { index = 1.5, absorption = 1e6, roughness = 0.12 }", BLACK_GLASS),
        ("plastic = { reflectance = 0, index = 1.5, roughness = 0.12 }", BLACK_GLASS),
    ] {
        let [rough_light, smooth_light] = [rough, smooth].map(|material| stokes("", &mirrors(material, &slanting)));
        for part in 1..4 {
            let [a, b] = [rough_light, smooth_light].map(|light| light[part] / light[0]);
            assert!((a - b).abs() < 0.02, "{rough}: {rough_light:?} for {smooth_light:?}");
        }
    }
}

/// A room with everything that polarizes has the same bits with any number of threads, and never more polarized light
/// than light.
#[test]
fn any_threads_find_the_same_stokes_vectors() {
    let text = r#"
camera = { position = [0, 1.6, 6], look_at = [0, 0.7, 0], vertical_fov = 38, polarizer = { axis = 30, extinction = 0.2 } }
film = { width = 40, height = 28, stokes = true }
render = { samples = 16, seed = 5 }
[material]
floor.plastic = { reflectance = 0.5, roughness = 0.2 }
glass.dielectric.index = "N-SF11"
frosted.dielectric = { index = 1.5, roughness = 0.3 }
gold.conductor = { metal = "Au", roughness = 0.3 }
window.thin.index = 1.5
sheet.polarizer.axis = [0, 1, 0]
holes.mask = { material = "sheet", opacity = 0.5 }
lamp.emissive.radiance = 40
[[object]]
shape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }
material = "floor"
[[object]]
shape.sphere = { center = [0.2, 0.8, 0.6], radius = 0.8 }
material = "glass"
[[object]]
shape.sphere = { center = [-1.3, 0.5, 0.9], radius = 0.5 }
material = "frosted"
[[object]]
shape.cube = { center = [1.9, 0.5, -0.4], size = 1 }
material = "gold"
[[object]]
shape.quad = { center = [1.6, 0.6, 1.6], u = [0.4, 0, 0.1], v = [0, 0.6, 0] }
material = "window"
[[object]]
shape.quad = { center = [-0.4, 0.6, 2], u = [0.4, 0, 0.1], v = [0, 0.5, 0] }
material = "holes"
[[object]]
shape.sphere = { center = [-1, 2.3, -1], radius = 0.15 }
material = "lamp"
[[light]]
environment = { radiance = 0.3, polarization = { sun = [0.3, 1, 0.2], degree = 0.7 } }
"#;
    let [one, three] =
        [1, 3].map(|threads| render_text_with(text, &Options { threads: Some(threads), ..Options::default() }));
    assert!(one.film() == three.film(), "three threads make another film");
    let film = one.film();
    let find_layer = |layer: Layer| film.layers.iter().find(|image| image.layer == layer).expect("the layer is there");
    let parts = Layer::STOKES.map(find_layer);
    for (number, pixel) in film.pixels.iter().enumerate() {
        for channel in 0..3 {
            let squared: f64 = parts.iter().map(|part| f64::from(part.values[3 * number + channel]).powi(2)).sum();
            let s0 = f64::from(pixel.rgb[channel]);
            assert!(squared.sqrt() <= s0 * (1.0 + 1e-4) + 1e-6, "pixel {number}: {} of {s0}", squared.sqrt());
        }
    }
}
