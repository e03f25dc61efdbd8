//! The layer `polarization`: degrees and an angle, computed from the sums of Stokes vectors.

use abbe::Image;
use abbe::math::DVec3;

use super::{BLACK_GLASS, ROUNDING, SKY, mirrors, polarizer, retarder, sheets};
use crate::support::scenes::{one_pixel, render_text};

/// Renders one pixel. Returns its degree, linear degree and angle.
fn degrees(rest: &str) -> [f64; 3] {
    let image = render_text(&(one_pixel("", ", layers = [\"polarization\"]") + rest));
    let one = |channel: &str| f64::from(image.layer(&format!("polarization.{channel}")).expect("it is there")[0]);
    ["degree", "linear_degree", "angle"].map(one)
}

fn assert_near(found: [f64; 3], expected: [f64; 3], what: &str) {
    let near = |i: usize, within: f64| (found[i] - expected[i]).abs() <= within;
    // The angle is in degrees, computed from f32 components.
    assert!(near(0, ROUNDING) && near(1, ROUNDING) && near(2, 1e-4), "{what}: {found:?} for {expected:?}");
}

/// s is perpendicular to the plane of incidence, which is turned about the view direction.
#[test]
fn black_glass_polarizes_across_its_plane_of_incidence() {
    for (incidence, degree) in [(30.0_f64, 0.391918), (45.0, 0.831479), (56.309932474, 1.0), (75.0, 0.578105)] {
        for (turned, angle) in
            [(0.0_f64, 90.0), (20.0, -70.0), (45.0, -45.0), (90.0, 0.0), (150.0, 60.0), (-60.0, 30.0)]
        {
            let ((sin, cos), (y, x)) = (incidence.to_radians().sin_cos(), turned.to_radians().sin_cos());
            let glass = mirrors(BLACK_GLASS, &[DVec3::new(sin * x, sin * y, cos)]);
            assert_near(degrees(&glass), [degree, degree, angle], &format!("{incidence} degrees, turned by {turned}"));
        }
    }
}

#[test]
fn sheets_have_their_degrees_and_angles() {
    let behind = |plate: String| sheets(&[plate, polarizer(0.0, 0.0)], 0.0);
    assert_eq!(degrees(SKY), [0.0; 3], "unpolarized");
    assert_eq!(degrees(""), [0.0; 3], "no light");
    for angle in [-60.0, 0.0, 15.0, 45.0, 90.0] {
        assert_near(degrees(&sheets(&[polarizer(angle, 0.0)], 0.0)), [1.0, 1.0, angle], "a sheet");
    }
    assert_near(degrees(&sheets(&[polarizer(30.0, 0.25)], 0.0)), [0.6, 0.6, 30.0], "a sheet that leaks");
    assert_near(degrees(&behind(retarder(45.0, 60.0))), [1.0, 0.5, 0.0], "elliptic light");
    let [degree, linear, _] = degrees(&behind(retarder(45.0, 90.0)));
    assert!((degree - 1.0).abs() <= ROUNDING && linear <= ROUNDING, "circular light: {degree}, {linear}");
}

/// Shadow catchers show no light, and so no polarized light. Without the catcher, their coat polarizes what they show.
#[test]
fn shadow_catchers_leave_no_stokes_vectors() {
    let coated = |keys: &str| {
        format!(
            "{SKY}[[light]]\nsun = {{ toward = [0, 1, 1], irradiance = 3 }}\n\
             [material.coated]\nplastic = {{ reflectance = 0.2, index = 1.5, roughness = 0.3 }}\n\
             [[object]]\nmaterial = \"coated\"\n{keys}\n\
             shape.plane = {{ point = [0, 0, 0], normal = [0, 0.8, 0.6] }}\n"
        )
    };
    let seen =
        |keys: &str| render_text(&(one_pixel("", ", stokes = true, layers = [\"polarization\"]") + &coated(keys)));
    let value_of = |image: &Image, channel: &str| image.layer(channel).expect("it is there")[0];
    let (shown, caught) = (seen(""), seen("shadow_catcher = true"));
    assert!(
        value_of(&shown, "polarization.degree") > 0.05 && value_of(&shown, "S1.G").abs() > 0.01,
        "the coat polarizes"
    );
    for channel in
        ["G", "S1.G", "S2.G", "S3.G", "polarization.degree", "polarization.linear_degree", "polarization.angle"]
    {
        assert_eq!(value_of(&caught, channel), 0.0, "{channel}");
    }
}

/// Photons that are splatted on shadow catchers leave no Stokes vectors either.
#[test]
fn photons_leave_no_stokes_vectors_on_shadow_catchers() {
    let text = r#"
        camera = { position = [0, 3, 6], look_at = [0, 0.3, 0], vertical_fov = 35 }
        film = { width = 24, height = 16, stokes = true, layers = ["polarization", "shadow"] }
        render = { samples = 8 }
        [material]
        floor.plastic = { reflectance = 0.4, index = 1.5, roughness = 0.3 }
        glass.dielectric.index = 1.5
        lamp.emissive.radiance = 800
        [[object]]
        shape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }
        material = "floor"
        shadow_catcher = true
        [[object]]
        shape.sphere = { center = [0, 0.8, 0], radius = 0.8 }
        material = "glass"
        [[object]]
        shape.sphere = { center = [-1, 3.5, 1], radius = 0.02 }
        material = "lamp"
    "#;
    let (caught, shown) = (render_text(text), render_text(&text.replace("shadow_catcher = true", "")));
    assert!(caught.because().iter().any(|line| line.starts_with("photon tracing")), "{:?}", caught.because());
    let (mut dark, mut polarized) = (0, 0);
    for (pixel, rgb) in caught.rgb().into_iter().enumerate().filter(|(_, rgb)| *rgb == [0.0; 3]) {
        let value_of = |image: &Image, channel: &str| image.layer(channel).expect("it is there")[pixel];
        for channel in ["S1.G", "S2.G", "S3.G", "polarization.degree", "polarization.angle"] {
            assert_eq!(value_of(&caught, channel), 0.0, "{channel} of pixel {pixel}, which is {rgb:?}");
        }
        dark += usize::from(value_of(&caught, "shadow.G") != 0.0);
        polarized += usize::from(value_of(&shown, "polarization.degree") > 0.02);
    }
    assert!(dark > 100 && polarized > 100, "{dark} pixels of the catcher, {polarized} polarized as a floor");
}
