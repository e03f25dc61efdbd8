//! Lanes that part and also go on together, while one hero adds what dispersion changes: against heroes that bring
//! all the light, in scenes of many kinds.
//!
//! ```text
//! cargo test --test all control_variate::
//! ```

use abbe::film::Film;
use abbe::plan::plan;
use abbe::scene::{Scene, Source};
use abbe::spectrum::Curve;
use abbe::trace::{Method, control_gain, prepare, render};

use crate::support::scenes::{body, environment, moments, scene, standard_errors, view};

const SEEDS: u64 = 24;
const FLINT: &str = "dielectric = { index = \"N-SF11\" }";
/// Without photons, of which each image sends many, whatever its size.
const BY_CHANCE: &str = "caustics = \"off\"";
const BALL: &str = "sphere = { center = [0, 0.95, 0.8], radius = 0.95 }";

/// Tiles, a red cube, a lamp and a sky, seen from before them, with what else stands there.
fn tiles(light: &str, render: &str, more: &str) -> String {
    let mut text = view([0.0, 1.7, 5.2], [0.0, 0.8, 0.0], 36.0, 12)
        + &format!("[render]\nsamples = 32\nmodel = \"hero\"\n{render}\n")
        + &body(
            "red",
            "diffuse = { reflectance = { rgb = [0.7, 0.1, 0.08] } }",
            &["cube = { center = [-1.4, 0.6, -1.2], size = 1.2 }"],
        )
        + &body(
            "lamp",
            &format!("emissive = {{ radiance = {light}, sides = \"front\" }}"),
            &["quad = { center = [2, 4, 1], u = [0.6, 0, 0], v = [0, 0, 0.6] }"],
        )
        + &environment(0.4);
    for (name, reflectance, odd) in [("light", 0.8, 0), ("dark", 0.12, 1)] {
        let places = (-3..3).flat_map(|i| (-3..3).map(move |j| (i, j))).filter(|(i, j)| (i + j) & 1 == odd);
        let quads: Vec<String> = places
            .map(|(i, j)| {
                let (x, z) = (f64::from(i) + 0.5, f64::from(j) + 0.5);
                format!("quad = {{ center = [{x:?}, 0, {z:?}], u = [0, 0, 0.5], v = [0.5, 0, 0] }}")
            })
            .collect();
        let quads: Vec<&str> = quads.iter().map(String::as_str).collect();
        text += &body(name, &format!("diffuse = {{ reflectance = {reflectance:?} }}"), &quads);
    }
    text + more
}

fn kinds() -> Vec<(&'static str, String)> {
    let of = |glass: &str, shape: &str| tiles("8", BY_CHANCE, &body("glass", glass, &[shape]));
    let both = |a: &str, b: &str| format!("{a}{b}");
    let tilted = "cube = { center = [0, 0, 0], size = [1.6, 1.2, 1.1] }\ntransform = [{ rotate = { axis = [1, 2, 0.5], degrees = 37 } }, { translate = [0, 1.1, 0.6] }]";
    let absorbing = "dielectric = { index = \"N-SF11\", absorption = { rgb = [0.2, 0.6, 1.5] } }";
    let coated = "dielectric = { index = \"N-BK7\", coating = [{ index = 1.38, thickness_nm = 99.6 }] }";
    let tinted = "dielectric = { index = \"N-SF11\", transmittance = { rgb = [0.9, 0.5, 0.7] }, reflectance = 0.5 }";
    let water = body(
        "water",
        "dielectric = { index = \"water\", priority = 1 }",
        &["cube = { center = [0, 1.2, 0.6], size = [2.6, 2.3, 2.2] }"],
    );
    let inside = body(
        "glass",
        "dielectric = { index = \"N-SF11\", priority = 2 }",
        &["sphere = { center = [0, 1.2, 0.6], radius = 0.8 }"],
    );
    let frosted = body(
        "frosted",
        "dielectric = { index = \"N-SF11\", roughness = 0.3 }",
        &["sphere = { center = [0.2, 0.9, -0.6], radius = 0.7 }"],
    );
    let pane = body(
        "glass",
        FLINT,
        &[
            "cube = { center = [0, 1.2, 2.4], size = [2.4, 2, 0.3] }\ntransform = [{ rotate = { axis = [0, 1, 0], degrees = 25 } }]",
        ],
    );
    let mirror = body(
        "mirror",
        "mirror = { reflectance = 0.9 }",
        &["quad = { center = [0, 1.5, -1.5], u = [2, 0, 0], v = [0, 1.5, 0] }"],
    );
    let around = body("glass", FLINT, &["sphere = { center = [0.15, 1.8, 5.3], radius = 0.4 }"]);
    vec![
        ("a ball", of(FLINT, BALL)),
        ("a tilted block, which parts rays widely", of(FLINT, tilted)),
        ("an absorbing ball", of(absorbing, BALL)),
        ("a coated ball", of(coated, BALL)),
        ("a tinted ball", of(tinted, BALL)),
        ("glass in water", tiles("8", BY_CHANCE, &both(&water, &inside))),
        ("frosted glass behind glass", tiles("8", BY_CHANCE, &both(&pane, &frosted))),
        ("glass before a mirror", tiles("8", BY_CHANCE, &both(&body("glass", FLINT, &[BALL]), &mirror))),
        ("a camera in glass", tiles("8", BY_CHANCE, &around)),
        ("a tube", tiles("{ illuminant = \"FL11\", scale = 8 }", BY_CHANCE, &body("glass", FLINT, &[BALL]))),
        (
            "two lines",
            tiles("{ lines = [[546.1, 2], [589.3, 1]], luminance = 8 }", BY_CHANCE, &body("glass", FLINT, &[BALL])),
        ),
        ("polarized", tiles("8", "polarization = \"on\"\ncaustics = \"off\"", &body("glass", FLINT, &[tilted]))),
        ("few bounces", tiles("8", "max_bounces = 4\ncaustics = \"off\"", &body("glass", FLINT, &[BALL]))),
        ("with photons", tiles("8", "", &body("glass", FLINT, &[BALL]))),
    ]
}

fn with_control(method: &Method) -> Method {
    Method { control: true, basis: method.basis.with_one_hero(), ..method.clone() }
}

fn films(scene: &Scene<Curve>, method: &Method) -> Vec<Film> {
    (0..SEEDS).map(|seed| render(&prepare(scene, Method { seed, ..method.clone() }), &|_| ()).0).collect()
}

/// Mean and standard error of a channel in a quarter of the image.
fn of_quarter(films: &[Film], quarter: usize, channel: usize) -> (f64, f64) {
    let mean_of = |film: &Film| {
        let side = film.width as usize / 2;
        let at = |i: usize| (i / side + side * (quarter / 2)) * 2 * side + i % side + side * (quarter % 2);
        (0..side * side).map(|i| f64::from(film.pixels[at(i)].rgb[channel])).sum::<f64>() / (side * side) as f64
    };
    let (mean, variance) = moments(films.iter().map(mean_of));
    (mean, (variance / films.len() as f64).sqrt())
}

/// Quarters of images of all kinds have the same means either way.
#[test]
fn what_dispersion_changes_is_the_same_as_a_difference() {
    let kinds = kinds();
    let limit = standard_errors(12 * kinds.len());
    for (what, text) in &kinds {
        let scene = scene(text);
        let method = plan(&scene).method;
        assert!(method.basis.draws_wavelengths() && !method.control, "{what}");
        let plain = films(&scene, &method);
        let control = films(&scene, &with_control(&method));
        let mut worst = 0.0_f64;
        for (quarter, channel) in (0..4).flat_map(|quarter| (0..3).map(move |channel| (quarter, channel))) {
            let ((a, of_a), (b, of_b)) = (of_quarter(&plain, quarter, channel), of_quarter(&control, quarter, channel));
            let sigma = (a - b).abs() / of_a.hypot(of_b);
            worst = worst.max(sigma);
            assert!(sigma < limit, "{what}: {a} +- {of_a:.1e}, {b} +- {of_b:.1e}: {sigma:.1} sigma");
        }
        println!("{what}: at most {worst:.1} sigma");
    }
}

/// Glass whose index hardly differs from lane to lane: what the hero adds is what is subtracted, sample by sample, so
/// that hardly any noise is left beside that of lanes together.
#[test]
fn without_dispersion_nothing_is_left_to_subtract() {
    let text = tiles("8", BY_CHANCE, &body("glass", "dielectric = { index = { cauchy = [1.6, 1e-12] } }", &[BALL]));
    let scene = scene(&text);
    let method = Method { together: 0.0, ..plan(&scene).method };
    let noise = |method: &Method| {
        let films = films(&scene, method);
        let of_pixel = |i: usize| moments(films.iter().map(move |film| f64::from(film.pixels[i].rgb[1]))).1;
        (0..films[0].pixels.len()).map(of_pixel).sum::<f64>()
    };
    let together = noise(&Method { together: 1.0, ..method.clone() });
    let [plain, control] = [&method, &with_control(&method)].map(noise);
    println!(
        "variance, in parts of that of lanes together: {:.2} by four heroes, {:.3}",
        plain / together,
        control / together
    );
    assert!(control < 1.06 * together && plain > control);
}

/// Layers of what is seen through glass hold the same.
#[test]
fn layers_hold_the_same() {
    let text = tiles("8", BY_CHANCE, &body("glass", FLINT, &[BALL]))
        .replace("[film]", "[film]\nlayers = [\"albedo\", \"N\", \"dispersed\"]\nfirst = \"visible\"");
    let scene = scene(&text);
    let method = plan(&scene).method;
    let films = [films(&scene, &method), films(&scene, &with_control(&method))];
    for (layer, image) in films[0][0].layers.iter().enumerate() {
        let channels = image.values.len() / films[0][0].pixels.len();
        for channel in 0..channels {
            let mean_of = |film: &Film| {
                let values = film.layers[layer].values.iter().skip(channel).step_by(channels);
                values.map(|&x| f64::from(x)).sum::<f64>() / film.pixels.len() as f64
            };
            let [(a, of_a), (b, of_b)] = films.each_ref().map(|films| {
                let (mean, variance) = moments(films.iter().map(mean_of));
                (mean, (variance / SEEDS as f64).sqrt())
            });
            let sigma = (a - b).abs() / of_a.hypot(of_b).max(1e-6);
            println!("layer {layer}, channel {channel}: {a:.5} and {b:.5}, {sigma:.1} sigma");
            assert!(sigma < standard_errors(9), "{layer}, {channel}: {a} +- {of_a:.1e}, {b} +- {of_b:.1e}");
        }
    }
}

/// The plan takes it where dispersion is small, and not where it parts rays widely.
#[test]
fn the_plan_weighs_it() {
    let larger = |text: &str| text.replace("width = 12\nheight = 12", "width = 128\nheight = 128");
    let text = larger(&tiles("8", "", &body("glass", FLINT, &[BALL])));
    let decided = plan(&scene(&text));
    assert!(decided.method.control, "{:?}", decided.because);
    assert!(decided.because.iter().any(|line| line.contains("as a difference")), "{:?}", decided.because);
    let spectral = text.replace("[film]", "[film]\nspectral = true");
    assert!(!plan(&scene(&spectral)).method.control, "each band would be noisier");
    for name in ["prism", "gem", "lens"] {
        let path = format!("scenes/{name}.toml");
        let source = Source { text: std::fs::read_to_string(&path).expect("it comes with Abbe"), path: path.into() };
        let scene = source.compile().expect("it is valid");
        let gain = control_gain(&prepare(&scene, plan(&scene).method));
        println!("{name}: {gain:?}");
        assert!(gain.is_some_and(|gain| gain < 1.0), "{name}: {gain:?}");
    }
}
