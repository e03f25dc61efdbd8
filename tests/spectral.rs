//! Spectra of pixels: they are those of the lights, and they make up the colors of the image.

mod stokes;

use abbe::Options;
use abbe::film::Film;
use abbe::plan::plan;
use abbe::spectrum::{apply, data};
use abbe::trace::Method;

use crate::support::larger::larger;
use crate::support::scenes::{film_of, mean_and_variance, render_text, render_text_with, scene};

/// Returns the largest difference between the image and the color of each pixel's bands of 1 nm, from 360 to 830. It is
/// relative to the brightest channel of the pixel, or to one percent of the image's mean if that is more.
fn worst_color(film: &Film) -> f64 {
    let film_of_xyz = film.color_space.matrix_from_xyz();
    let spectral = film.spectral.as_ref().expect("spectra were asked for");
    assert_eq!(spectral.bands.count(), data::color_matching().len());
    let y_integral: f64 = data::color_matching().iter().map(|cmf| cmf[1]).sum();
    let strongest = |rgb: [f32; 3]| rgb.iter().fold(0.0, |most: f64, &x| larger(most, f64::from(x).abs()));
    let mean = film.pixels.iter().map(|pixel| strongest(pixel.rgb)).sum::<f64>() / film.pixels.len() as f64;
    assert!(mean > 0.0);
    let worst = |number: usize| {
        let (mut xyz, expected) = ([0.0; 3], film.pixels[number].rgb);
        for (&radiance, cmf) in spectral.pixel(number).iter().zip(data::color_matching()) {
            (0..3).for_each(|i| xyz[i] += f64::from(radiance) * cmf[i] / y_integral);
        }
        let color = apply(&film_of_xyz, xyz);
        assert!(color.iter().all(|x| x.is_finite()), "{color:?}");
        let off = (0..3).map(|i| (color[i] - f64::from(expected[i])).abs()).fold(0.0, larger);
        off / strongest(expected).max(0.01 * mean)
    };
    (0..film.pixels.len()).map(worst).fold(0.0, larger)
}

/// Returns a scene of dispersive glass, a mirror and gold on a floor under a lamp, a sky and a spot. Photons are
/// splatted and gathered, lanes part, and both images and numbers emit light.
fn room(film: &str, glass: &str) -> String {
    format!(
        r#"
        camera = {{ position = [0, 1.6, 6], look_at = [0, 0.7, 0], vertical_fov = 38 }}
        film = {{ width = 24, height = 16, {film} }}
        render = {{ samples = 16, seed = 5 }}
        [material]
        floor.diffuse.reflectance = {{ rgb = [0.7, 0.5, 0.3] }}
        glass.dielectric.index = {glass}
        silver.mirror.reflectance = 0.9
        gold.conductor = {{ metal = "Au", roughness = 0.3 }}
        lamp.emissive.radiance = {{ illuminant = "FL11", scale = 40 }}
        screen.emissive.radiance = {{ checker = [3, {{ rgb = [0.5, 1, 2] }}] }}
        [[object]]
        shape.plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}
        material = "floor"
        [[object]]
        shape.sphere = {{ center = [0.2, 0.8, 0.6], radius = 0.8 }}
        material = "glass"
        [[object]]
        shape.quad = {{ center = [-2, 1, -1], u = [0.5, 0, 0.5], v = [0, 1, 0] }}
        material = "silver"
        [[object]]
        shape.cube = {{ center = [1.9, 0.5, -0.4], size = 1 }}
        material = "gold"
        [[object]]
        shape.sphere = {{ center = [-1, 2.3, -1], radius = 0.15 }}
        material = "lamp"
        [[object]]
        shape.quad = {{ center = [1.6, 1.6, -1.6], u = [0.4, 0, 0.1], v = [0, 0.6, 0] }}
        material = "screen"
        [[light]]
        environment.radiance = {{ samples = [[380, 0.1], [780, 0.3]] }}
        [[light]]
        spot = {{ position = [3, 3, -2], look_at = [0.2, 0.8, 0.6], cone_angle = 30, intensity = {{ blackbody = 3000, scale = 8 }} }}
        "#
    )
}

/// Every nm of the visible grid.
const FINE: &str = "spectral = { from = 360, to = 830, step = 1 }";

#[test]
fn an_even_spectrum_of_one_is_one_in_every_band() {
    // The last two extend above 830 nm, and one of them below 300 nm.
    let bands = [[400.0, 700.0, 10.0], [550.0, 552.0, 0.25], [360.0, 830.0, 5.0], [360.0, 830.0, 470.0]];
    let bands = bands.map(|[from, to, step]| format!("{{ from = {from}, to = {to}, step = {step} }}"));
    for bands in bands.iter().map(String::as_str).chain(["true"]) {
        let image = render_text(&format!(
            "camera = {{ position = [0, 0, 5], look_at = [0, 0, 0], vertical_fov = 40 }}\n\
             film = {{ width = 4, height = 2, spectral = {bands} }}\n\
             light = [{{ environment.radiance.samples = [[300, 1], [900, 1]] }}]"
        ));
        let spectral = image.film().spectral.as_ref().expect("spectra were asked for");
        assert!(spectral.values.iter().all(|value| (value - 1.0).abs() < 1e-6), "{bands}: {:?}", spectral.pixel(0));
    }
}

/// Measured radiance stays the same for any luminance of white. A luminance is recovered with the observer's functions.
#[test]
fn spectra_of_absolute_light_are_in_watts() {
    let sky = |radiance: &str| {
        render_text(&format!(
            "camera = {{ position = [0, 0, 5], look_at = [0, 0, 0], vertical_fov = 40 }}\n\
             film = {{ width = 2, height = 2, {FINE}, radiometry = \"absolute\", white_luminance = 80 }}\n\
             light = [{{ environment.radiance = {radiance} }}]"
        ))
    };
    let measured = sky("{ samples = [[300, 0.25], [900, 0.25]] }");
    let spectrum = measured.spectrum_at(0, 0).expect("spectra were asked for");
    assert!(spectrum.iter().all(|[_, radiance]| (radiance / 0.25 - 1.0).abs() <= 1e-6), "{spectrum:?}");
    for bright in ["1500", "{ illuminant = \"FL11\", luminance = 1500 }"] {
        let spectrum = sky(bright).spectrum_at(0, 0).expect("spectra were asked for");
        let seen = spectrum.iter().zip(data::color_matching()).map(|([_, radiance], cmf)| radiance * cmf[1]);
        let luminance = 683.002 * seen.sum::<f64>();
        assert!((luminance / 1500.0 - 1.0).abs() <= WHITE, "{bright}: {luminance} cd/m2");
    }
}

/// Numbers and `rgb` have the film's white to the digits in which its chromaticity is known. The white light is 4e-5
/// off in x and y, which is less than 5e-4 of a channel.
const WHITE: f64 = 5e-4;

#[test]
fn spectra_make_the_colors_of_the_image() {
    // The difference of two sums of light has a larger relative error.
    for (filter, tolerance) in [("box", WHITE), ("mitchell", 2.0 * WHITE)] {
        let image = render_text(&room(&format!("{FINE}, filter = \"{filter}\""), "1.5"));
        assert!(image.because().iter().any(|line| line.starts_with("photon tracing")), "{:?}", image.because());
        assert!(image.because().iter().any(|line| line.starts_with("photon map")), "{:?}", image.because());
        let worst = worst_color(image.film());
        assert!(worst <= tolerance, "{filter}: {worst}");
    }
}

/// A drawn wavelength counts in its band as if it were at the center of the band. The color matching functions change
/// by a few percent within half a nm, at most by 0.06 of themselves.
#[test]
fn spectra_of_lanes_that_part_make_the_colors_of_the_image() {
    let image = render_text(&room(FINE, "\"N-SF11\""));
    assert!(image.because().iter().any(|line| line.starts_with("model hero")), "{:?}", image.because());
    let worst = worst_color(image.film());
    assert!(worst <= 0.06, "{worst}");
}

/// The floor fluoresces: its light has other wavelengths than the photons and lamps that excite it.
#[test]
fn spectra_of_dyes_make_the_colors_of_the_image() {
    for (glass, model, tolerance) in [("1.5", "model bands", 1e-3), ("\"N-SF11\"", "model hero", 0.06)] {
        let floor = "floor.diffuse = { reflectance = 0.1, fluorescence = { absorption = { samples = [[420, 0.9], [520, 0]] }, \
                     emission = { samples = [[500, 0], [540, 1], [620, 0]] }, quantum_yield = 0.9 } }";
        let text = room(FINE, glass).replace("floor.diffuse.reflectance = { rgb = [0.7, 0.5, 0.3] }", floor);
        let image = render_text(&text);
        assert!(image.because().iter().any(|line| line.starts_with(model)), "{:?}", image.because());
        assert!(image.because().iter().any(|line| line.contains("floor: fluoresces")), "{:?}", image.because());
        let worst = worst_color(image.film());
        println!("{model}: {worst:.1e}");
        assert!(worst <= tolerance, "{model}: {worst}");
    }
}

#[test]
fn light_vertices_leave_spectra_too() {
    let text = format!(
        r#"
        camera = {{ position = [0, 0, 2.9], look_at = [0, 0, 0], vertical_fov = 60 }}
        film = {{ width = 12, height = 12, {FINE} }}
        render = {{ samples = 64 }}
        [material]
        wall.diffuse.reflectance = {{ rgb = [0.75, 0.7, 0.6] }}
        lamp.emissive = {{ radiance = 4, sides = "front" }}
        [[object]]
        shape.cube = {{ center = [0, 0, 0], size = 6 }}
        material = "wall"
        [[object]]
        shape.quad = {{ center = [0, 2.9, 0], u = [1, 0, 0], v = [0, 0, 1] }}
        material = "lamp"
        "#
    );
    let scene = scene(&text);
    let method = plan(&scene).method;
    let [with, without] =
        [true, false].map(|light_vertices| film_of(&scene, Method { light_vertices, ..method.clone() }));
    assert!(with.spectral != without.spectral, "light vertices are not looked at");
    let worst = worst_color(&with);
    assert!(worst <= WHITE, "{worst}");
}

/// Two ideal lines stay in their bands, with their power divided by the width of the band.
#[test]
fn ideal_lines_stay_in_their_bands() {
    let image = render_text(
        "camera = { position = [0, 0, 5], look_at = [0, 0, 0], vertical_fov = 40 }\n\
         film = { width = 2, height = 2, spectral = true }\n\
         light = [{ environment.radiance = { lines = [[546.1, 3], [611, 1]] } }]",
    );
    for [nm, radiance] in image.spectrum_at(1, 1).expect("spectra were asked for") {
        let power = if nm == 545.0 {
            3.0
        } else if nm == 610.0 {
            1.0
        } else {
            0.0
        };
        assert!((radiance - power / 5.0).abs() <= 1e-6, "{radiance} at {nm}");
    }
}

/// Surfaces are known equally well where the eye sees hardly anything and where it sees well.
#[test]
fn spectra_resolve_surfaces_over_all_bands() {
    let all = "{ from = 360, to = 830, step = 5 }";
    let common = "{ from = 400, to = 700, step = 10 }";
    let (even, edge) = ([[360.0, 0.0], [830.0, 1.0]], [[740.0, 0.2], [760.0, 0.8]]);
    // White paint with titanium dioxide is dark in the ultraviolet.
    let titania = [[380.0, 0.1], [395.0, 0.9]];
    let cases = [
        ("true", even, 0.005),
        (all, even, 0.01),
        ("true", edge, 0.03),
        (all, edge, 0.05),
        ("true", titania, 0.07),
        (common, titania, 0.02),
        (common, even, 0.005),
    ];
    for (bands, reflectance, most) in cases {
        let [[first, low], [last, high]] = reflectance;
        let image = render_text(&format!(
            "camera = {{ position = [0, 0, 5], look_at = [0, 0, 0], vertical_fov = 10 }}\n\
             film = {{ width = 1, height = 1, spectral = {bands} }}\n\
             light = [{{ environment.radiance.samples = [[300, 1], [900, 1]] }}]\n\
             object = [{{ shape.plane = {{ point = [0, 0, 0], normal = [0, 0, 1] }}, material = \"tinted\" }}]\n\
             material.tinted.mirror.reflectance.samples = [[359, {low}], [{first}, {low}], [{last}, {high}], [831, {high}]]",
        ));
        let spectral = image.film().spectral.as_ref().expect("spectra were asked for");
        let expected = |nm: f64| low + (high - low) * ((nm - first) / (last - first)).clamp(0.0, 1.0);
        for (band, nm) in spectral.bands.centers_nm().enumerate() {
            // A band that extends over the edge or beyond 830 nm has the mean of its known part.
            let parts = (0..100).map(|i| nm + spectral.bands.step_nm() * ((f64::from(i) + 0.5) / 100.0 - 0.5));
            let known: Vec<f64> = parts.filter(|&nm| nm <= 830.0).map(expected).collect();
            let mean = known.iter().sum::<f64>() / known.len() as f64;
            let off = f64::from(spectral.pixel(0)[band]) - mean;
            assert!(off.abs() <= most, "{bands}, {reflectance:?}: off by {off} at {nm} nm");
        }
    }
}

/// Glass that parts lanes in a uniform world shows that world unchanged in every band. The spectra of a prism add up to
/// it.
#[test]
fn a_dispersive_ball_in_an_even_world_cannot_be_seen_in_any_band() {
    let image = render_text(
        "camera = { position = [0, 0, 5], look_at = [0, 0, 0], vertical_fov = 10 }\n\
         film = { width = 16, height = 16, spectral = { from = 360, to = 830, step = 10 } }\n\
         render = { samples = 64, model = \"hero\" }\n\
         material.glass.dielectric.index = \"N-SF11\"\n\
         light = [{ environment.radiance.samples = [[300, 1], [900, 1]] }]\n\
         object = [{ shape.sphere = { center = [0, 0, 0], radius = 1 }, material = \"glass\" }]",
    );
    let spectral = image.film().spectral.as_ref().expect("spectra were asked for");
    let pixels = spectral.values.len() / spectral.bands.count();
    for (band, nm) in spectral.bands.centers_nm().enumerate() {
        let (mean, variance) = mean_and_variance((0..pixels).map(|pixel| f64::from(spectral.pixel(pixel)[band])));
        let z = (mean - 1.0) / (variance / pixels as f64).sqrt();
        assert!(z.abs() <= 4.0, "{mean} at {nm} nm, z = {z}");
        // If visibility alone decided where wavelengths are drawn, hardly a sample would find light where the eye sees
        // nothing.
        assert!(variance.sqrt() <= 1.0, "{nm} nm: a pixel is off by {}", variance.sqrt());
    }
}

#[test]
fn spectra_change_no_bit_of_the_image_by_the_same_lanes() {
    let lanes = |film: &str| room(film, "1.5").replace("samples = 16,", "samples = 16, model = { bands = 32 },");
    let (plain, spectral) = (render_text(&lanes("")), render_text(&lanes("spectral = true")));
    for channel in ["R", "G", "B", "A", "Z"] {
        assert!(plain.layer(channel) == spectral.layer(channel), "{channel}");
    }
}

/// A part of the image has the same spectra as in the full image, with any number of threads.
#[test]
fn spectra_are_the_same_for_any_part_and_any_number_of_threads() {
    let text = room("spectral = true", "1.5");
    let whole = render_text(&text);
    let [left, top] = [7, 5];
    let crop = abbe::film::Window { left: left as i32, top: top as i32, width: 10, height: 8 };
    let part = render_text_with(&text, &Options { threads: Some(3), crop: Some(crop), ..Options::default() });
    for (x, y) in (0..8).flat_map(|y| (0..10).map(move |x| (x, y))) {
        assert_eq!(part.spectrum_at(x, y), whole.spectrum_at(left + x, top + y), "{x}, {y}");
    }
}
