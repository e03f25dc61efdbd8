//! Overscan: pixels around the format, which change none inside it.

use abbe::film::{Film, Layer, Overscan, Window};
use abbe::{Image, Options};

use super::{ROOM, rgb};
use crate::support::scenes::render_text_with;

const OVERSCAN: Overscan = Overscan { left: 5, top: 17, right: 18, bottom: 1 };

fn render_window(text: &str, overscan: Option<Overscan>, crop: Option<Window>, threads: usize) -> Image {
    let options = Options { overscan, crop, layers: Some(Layer::all()), threads: Some(threads), ..Options::default() };
    render_text_with(text, &options)
}

fn window(film: &Film) -> Window {
    Window { left: film.corner[0], top: film.corner[1], width: film.width, height: film.height }
}

/// Returns the bits of everything that a film stores for the pixels of a window: the numbers of the image and of every
/// layer.
fn bits(film: &Film, of: Window) -> Vec<u32> {
    let stored = window(film);
    assert!(stored.holds(&of), "{stored:?} does not hold {of:?}");
    let mut all = Vec::new();
    for y in of.top..of.top + of.height as i32 {
        for x in of.left..of.left + of.width as i32 {
            let at = (y - stored.top) as usize * stored.width as usize + (x - stored.left) as usize;
            let pixel = film.pixels[at];
            all.extend(pixel.rgb);
            all.extend([pixel.alpha, pixel.depth, pixel.samples]);
            for image in &film.layers {
                let size = image.layer.channels().len();
                all.extend(&image.values[at * size..][..size]);
            }
        }
    }
    all.into_iter().map(f32::to_bits).collect()
}

#[test]
fn overscan_changes_no_bit_of_the_format_and_crops_are_parts_of_both() {
    let filtered = ROOM.replace("height = 28", "height = 28, filter = \"mitchell\"");
    let catcher = ROOM.replace("name = \"floor\"\n", "name = \"floor\"\nshadow_catcher = true\n");
    for text in [ROOM, &filtered, &catcher] {
        let (plain, wide) = (render_window(text, None, None, 1), render_window(text, Some(OVERSCAN), None, 3));
        let (format, all) = (window(plain.film()), window(wide.film()));
        assert_eq!(all, Window { left: -5, top: -17, width: format.width + 23, height: format.height + 18 });
        assert_eq!(wide.film().full, [format.width, format.height]);
        assert!(bits(wide.film(), format) == bits(plain.film(), format), "overscan changes the image");
        let crops = [
            Window { left: -5, top: -17, width: 9, height: 20 },
            Window { left: 3, top: -2, width: 4, height: 6 },
            Window { left: all.width as i32 - 6, top: 0, width: 1, height: 5 },
        ];
        for crop in crops.into_iter().take(if text == ROOM { 3 } else { 1 }) {
            let part = render_window(text, Some(OVERSCAN), Some(crop), 2);
            assert_eq!(window(part.film()), crop);
            assert!(bits(part.film(), crop) == bits(wide.film(), crop), "{crop:?} has other bits");
        }
    }
    let room = render_window(ROOM, Some(OVERSCAN), None, 1);
    for photons in ["photon tracing: ", "photon map: "] {
        assert!(room.because().iter().any(|line| line.starts_with(photons)), "{:?}", room.because());
    }
}

/// The pixels around the format match those of a larger format, for camera paths and for photons that are splatted or
/// gathered.
#[test]
fn overscan_shows_what_a_wider_view_shows() {
    let samples = |text: &str| text.replace("samples = 8", "samples = 64");
    let wide = render_window(&samples(ROOM), Some(Overscan::even(14)), None, 2);
    let angle = 2.0 * (2.0 * libm::tan(19.0_f64.to_radians())).atan().to_degrees();
    let larger = samples(ROOM)
        .replace("width = 40, height = 28", "width = 68, height = 56")
        .replace("vertical_fov = 38", &format!("vertical_fov = {angle:?}"))
        .replace("seed = 5", "seed = 6");
    let larger = render_window(&larger, None, None, 2);
    assert_eq!((wide.width(), wide.height()), (larger.width(), larger.height()));
    for layer in ["direct", "indirect", "caustics", "background"] {
        let ring = |place: usize| {
            let [x, y] = [place % 68, place / 68];
            !(14..54).contains(&x) || !(14..42).contains(&y)
        };
        let mean = |image: &Image| {
            let light: Vec<f64> = rgb(image, layer).iter().map(|color| color[1]).collect();
            let light = (0..light.len()).filter(|place| ring(*place)).map(|place| light[place]);
            light.clone().sum::<f64>() / light.count() as f64
        };
        let variance = |image: &Image| {
            let variance = rgb(image, "variance");
            let ring_variances: Vec<f64> =
                (0..variance.len()).filter(|at| ring(*at)).map(|at| variance[at][1]).collect();
            ring_variances.iter().sum::<f64>() / (ring_variances.len() * ring_variances.len()) as f64
        };
        let off = mean(&wide) - mean(&larger);
        let deviation = (variance(&wide) + variance(&larger)).sqrt();
        assert!(mean(&wide) > 0.0, "nothing in {layer}");
        assert!(off.abs() <= 4.0 * deviation, "{layer}: {} and {}, {deviation}", mean(&wide), mean(&larger));
    }
}

/// Renders a plane whose positions show where the rays of pixels go.
fn depths(camera: &str, film: &str) -> Image {
    let text = format!(
        "camera = {{ position = [0.2, 1, 3], look_at = [0, 0.5, 0], {camera} }}\n\
         film = {{ {film}, filter = \"center\" }}\nrender = {{ samples = 1 }}\n\
         material.lamp.emissive.radiance = 1\n\
         object = [{{ shape.plane = {{ point = [0, 0, -4], normal = [0.1, 0.2, 1] }}, material = \"lamp\" }}]\n"
    );
    render_text_with(&text, &Options { layers: Some(vec![Layer::Position]), ..Options::default() })
}

fn positions(image: &Image) -> Vec<[f32; 3]> {
    let [x, y, z] = ["P.X", "P.Y", "P.Z"].map(|name| image.layer(name).expect("places"));
    (0..x.len()).map(|at| [x[at], y[at], z[at]]).collect()
}

/// The film extends beyond the format, in the plane that the lens projects onto.
#[test]
fn a_pixel_of_the_overscan_looks_where_one_of_a_larger_format_does() {
    let half = libm::tan(20.0_f64.to_radians());
    // The overscan adds twice the format of 8 x 6 pixels, so the larger format is three times as large. A shift is
    // given in heights of the format.
    let fov = 2.0 * (3.0 * half).atan().to_degrees();
    for (camera, larger) in [
        ("vertical_fov = 40".into(), format!("vertical_fov = {fov:?}")),
        (
            "vertical_fov = 40, shift = [0.3, -0.2]".into(),
            format!("vertical_fov = {fov:?}, shift = [0.1, {:?}]", -0.2 / 3.0),
        ),
        (
            "projection = \"orthographic\", height = 2, shift = [0.3, 0.6]".to_owned(),
            "projection = \"orthographic\", height = 6, shift = [0.1, 0.2]".to_owned(),
        ),
    ] {
        let around = depths(&camera, "width = 8, height = 6, overscan = [8, 6, 8, 6]");
        let larger = depths(&larger, "width = 24, height = 18");
        for (a, b) in positions(&around).iter().zip(positions(&larger)) {
            let size = b.iter().fold(1.0_f32, |size, x| size.max(x.abs()));
            assert!((0..3).all(|i| (a[i] - b[i]).abs() <= 8.0 * f32::EPSILON * size), "{camera}: {a:?} is not {b:?}");
        }
    }
}

/// A full panorama continues beyond its seam and its poles.
#[test]
fn overscan_of_a_view_all_around_is_its_other_side() {
    let image = depths("projection = \"equirectangular\"", "width = 16, height = 8, overscan = [3, 2, 4, 2]");
    let positions = positions(&image);
    let at = |x: i32, y: i32| positions[((y + 2) * 23 + x + 3) as usize];
    let same = |a: [f32; 3], b: [f32; 3]| (0..3).all(|i| (a[i] - b[i]).abs() <= 1e-4 * b[i].abs().max(1.0));
    let mut hits = 0;
    for y in 0..8 {
        for x in (-3..0).chain(16..20) {
            assert!(same(at(x, y), at(x.rem_euclid(16), y)), "{x}, {y}");
            hits += u32::from(at(x, y) != [0.0; 3]);
        }
    }
    for x in 0..16 {
        for (beyond, within) in [(-1, 0), (-2, 1), (8, 7), (9, 6)] {
            assert!(same(at(x, beyond), at((x + 8) % 16, within)), "{x}, {beyond}");
            hits += u32::from(at(x, beyond) != [0.0; 3]);
        }
    }
    assert!(hits > 30, "only {hits} pixels meet anything");
}
