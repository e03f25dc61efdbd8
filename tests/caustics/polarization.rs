//! The estimated effect of polarization on a caustic: photons carry the effect of their surfaces, and it is counted
//! where they are seen.

use abbe::math::DVec3;
use abbe::plan::plan;
use abbe::trace::{LightPass, MapPasses, Method, Polarizing, Smoothness, polarization_error, prepare, render};

use crate::support::fresnel::reflectances;
use crate::support::scenes::{SPLITTING, body, mean_and_variance, quad, scene, view};

fn square(center: DVec3, normal: DVec3, half: f64) -> String {
    let up = DVec3::new(0.0, 0.0, half);
    quad(center, up, normal.cross(up))
}

/// Returns the light of a small lamp that two glass plates, both at Brewster's angle and in one plane, reflect to a
/// floor, and a view of that floor, in a mirror or not. A screen blocks the lamp's direct light.
fn two_plates(in_a_mirror: bool) -> String {
    let turn = 180.0 - 2.0 * 1.5_f64.atan().to_degrees();
    let way = |times: f64| {
        let (sin, cos) = (-times * turn).to_radians().sin_cos();
        DVec3::new(cos, sin, 0.0)
    };
    let normal = |times: f64| (way(times + 1.0) - way(times)).try_normalize().expect("not straight on");
    let lamp = DVec3::ZERO;
    let first = lamp + way(0.0) * 4.0;
    let second = first + way(1.0) * 4.0;
    let floor = second + way(2.0) * 4.0;
    let aside = way(2.0) * -0.8 + DVec3::new(0.0, 0.0, 0.6);
    let along = way(2.0).cross(DVec3::new(0.0, 0.0, 1.0));
    let (seen_at, camera) = (floor + aside * 3.0, floor + aside * 3.0 - along * 2.0);
    let (position, look_at) = if in_a_mirror { (camera, seen_at) } else { (seen_at, floor) };
    let mut text = view(position.into(), look_at.into(), 6.0, 8);
    let plates = [square(first, normal(0.0), 0.2), square(second, normal(1.0), 0.3)];
    text += &body("plate", "dielectric = { index = 1.5, absorption = 1000 }", &[&plates[0], &plates[1]]);
    text += &body("floor", "diffuse = { reflectance = 0.5 }", &[&square(floor, -way(2.0), 0.4)]);
    let screen = square(floor + (lamp - floor) * 0.5, (lamp - floor).try_normalize().expect("apart"), 0.7);
    text += &body("screen", "diffuse = { reflectance = 0 }", &[&screen]);
    let lamp = format!("sphere = {{ center = [{:?}, {:?}, {:?}], radius = 0.02 }}", lamp.x, lamp.y, lamp.z);
    text += &body("lamp", "emissive = { radiance = 1000 }", &[&lamp]);
    if in_a_mirror {
        // Any two vectors perpendicular to the normal.
        let normal = (-along - aside).try_normalize().expect("not straight on");
        let u = normal.cross(DVec3::new(0.0, 0.0, 1.0)).try_normalize().expect("not upright");
        let v = normal.cross(u);
        text += &body("mirror", "mirror = {}", &[&quad(seen_at, u * 0.3, v * 0.3)]);
    }
    text
}

/// Number of renders whose spread gives the noise.
const SEEDS: u64 = 4;

#[test]
fn the_effect_of_polarization_on_a_caustic_is_reported_for_photons_splatted_or_gathered() {
    for in_a_mirror in [false, true] {
        let scene = scene(&two_plates(in_a_mirror));
        let map = in_a_mirror.then_some(MapPasses { count: 2, photons: 50_000, radius: 1.0, chance: 1.0 });
        let light_pass = Some(LightPass {
            photons: 200_000,
            lights: vec![0],
            openings: Vec::new(),
            to: vec![Smoothness::Whole],
            map,
        });
        let planned = plan(&scene);
        let method =
            Method { samples: 4, transport: SPLITTING, diffuse_bounces: 1, light_pass, ..planned.method.clone() };
        let by =
            |polarization, seed| render(&prepare(&scene, Method { polarization, seed, ..method.clone() }), &|_| ());
        let (film, report) = by(Polarizing::Averaged, 0);
        let lit_pixels = film.pixels.iter().filter(|pixel| pixel.rgb[1] > 0.0).count();
        assert!(lit_pixels > film.pixels.len() / 2, "in a mirror {in_a_mirror}: {lit_pixels} pixels are lit");
        // All visible light was reflected by both plates, which reflect only one polarization: polarization doubles it.
        println!("in a mirror {in_a_mirror}: {:.4}", report.polarization);
        let reported = [report.polarization, report.polarization_of_tile];
        assert!(
            reported.iter().all(|&reported| reported > 0.99 && reported < 1.0 + 1e-6),
            "{in_a_mirror}: {reported:?}"
        );
        assert!(planned.method.light_pass.is_some(), "{:?}", planned.because);
        let states_error = |line: &String| line.starts_with("polarization on: without it, the image would be wrong by");
        assert!(planned.because.iter().any(states_error), "{in_a_mirror}: {:?}", planned.because);
        // The planes of incidence coincide, so tracing polarization doubles the light.
        let sums = |polarization| {
            mean_and_variance((0..SEEDS).map(|seed| {
                let (film, report) = by(polarization, seed);
                assert!(polarization == Polarizing::Averaged || report.polarization == 0.0);
                film.pixels.iter().map(|pixel| f64::from(pixel.rgb[1])).sum::<f64>()
            }))
        };
        let [(averaged, v), (traced, w)] = [sums(Polarizing::Averaged), sums(Polarizing::Traced)];
        let z = (traced - reported[0].mul_add(averaged, averaged)) / ((4.0 * v + w) / SEEDS as f64).sqrt();
        println!("in a mirror {in_a_mirror}: {:.4}, z {z:.2}", traced / averaged);
        assert!(z.abs() < 3.0, "in a mirror {in_a_mirror}: {}, z {z}", traced / averaged);
    }
}

/// Sunlight at 60 degrees through a glass roof whose index differs between the three bands, seen from below.
const ROOF: &str = "[camera]\nposition = [0, 0.1, 0]\nlook_at = [0, 0, 0]\nup = [0, 0, -1]\nprojection = \"orthographic\"\n\
                    height = 0.3\nnear = 0\n[film]\nwidth = 8\nheight = 8\nfilter = \"box\"\n\
                    [render]\nmodel = \"rgb\"\nsamples = 4\n\
                    [[light]]\nsun = { toward = [0.8660254037844386, 0.5, 0], angular_diameter = 0, irradiance = 1 }\n";
const INDICES: [f64; 3] = [1.333, 1.52, 2.42];

/// Returns the light that crosses a plate at 60 degrees, once with each polarization traced by itself (Stokes 1862) and
/// once with the light treated as unpolarized at every surface.
fn through_a_plate(index: f64) -> [f64; 2] {
    let reflected = reflectances(index, 0.5);
    let plate_transmittance = |r: f64| (1.0 - r) / (1.0 + r);
    [
        reflected.map(plate_transmittance).iter().sum::<f64>() / 2.0,
        plate_transmittance(reflected.iter().sum::<f64>() / 2.0),
    ]
}

/// Photons whose wavelengths have parted carry one lane each. The effect of polarization is relative to that lane, and
/// absent lanes do not count.
#[test]
fn the_effect_of_polarization_on_parted_photons_is_reported_for_their_lanes() {
    let [red, green, blue] = INDICES;
    let glass = format!("dielectric = {{ index = {{ rgb = [{red}, {green}, {blue}] }} }}");
    let roof = "cube = { center = [0, 0.22, 0], size = [1.4, 0.04, 1.4] }";
    let floor = "quad = { center = [0, 0, 0], u = [6, 0, 0], v = [0, 0, -6] }";
    let text = ROOF.to_owned()
        + &body("glass", &glass, &[roof])
        + &body("floor", "diffuse = { reflectance = 1e-4 }", &[floor]);
    let scene = scene(&text);
    let method = plan(&scene).method;
    let errors = (0..16).map(|seed| polarization_error(&prepare(&scene, Method { seed, ..method.clone() })));
    let (mean, variance) = mean_and_variance(errors);
    // X + Y + Z of the primaries of sRGB (IEC 61966-2-1).
    let amounts = [0.4124 + 0.2126 + 0.0193, 0.3576 + 0.7152 + 0.1192, 0.1805 + 0.0722 + 0.9505];
    let seen = |way: usize| (0..3).map(|band| amounts[band] * through_a_plate(INDICES[band])[way]).sum::<f64>();
    let expected = seen(0) / seen(1) - 1.0;
    println!("{mean:.5} +- {:.5}, expected {expected:.5}", variance.sqrt());
    // The stated error is some standard errors of its cells above the expected one.
    assert!((0.9 * expected..2.5 * expected).contains(&mean), "{mean}, expected {expected}");
}

/// Polarization brightens one beam and dims another, and both changes count as errors. Without polarization, the beam
/// that leaves the base of the prism is a quarter too bright, and the image has an error of 3.3 % (root mean square),
/// although its total light is right within 0.3 %.
#[test]
fn beams_that_polarization_changes_either_way_are_no_less_wrong_together() {
    let scene = scene(&std::fs::read_to_string("scenes/rainbow.toml").expect("it comes with Abbe"));
    let method = plan(&scene).method;
    assert_eq!(method.polarization, Polarizing::Traced);
    let errors = (0..4).map(|seed| polarization_error(&prepare(&scene, Method { seed, ..method.clone() })));
    let (mean, _) = mean_and_variance(errors);
    assert!((0.007..0.06).contains(&mean), "{mean}");
}
