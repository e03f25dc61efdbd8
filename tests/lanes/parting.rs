//! Dispersion: a render with an index per band is three renders with one index each.

use abbe::film::Film;
use abbe::trace::Transport;

use crate::support::scenes::{
    EVERY_BRANCH, Mean, SINGLE_PATH, SPLITTING, films_of, method, render_film, scene, sigma_limit, view,
};

/// A ball and a prism of glass among other objects, shared by the scenes of this folder.
pub const BALL_AND_PRISM: &str = r#"[[object]]
shape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }
material = "floor"
[[object]]
shape.plane = { point = [0, 0, -9], normal = [0.1, 0.2, 1] }
material = "sky"
[[object]]
shape.sphere = { center = [-0.5, 0.8, 0.4], radius = 0.75 }
material = "glass"
[[object]]
material = "glass"
[object.shape.mesh]
points = [[0.5, 0.1, 0.9], [1.5, 0.1, 0.6], [0.9, 0.1, -0.2], [0.9, 1.3, 0.5]]
faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]
[[object]]
shape.sphere = { center = [1.6, 1.1, -2], radius = 1 }
material = "silver"
[[object]]
shape.disc = { center = [-1.8, 1, -2], normal = [0.6, 0, 1], radius = 1 }
material = "gold"
[[object]]
shape.quad = { center = [0, 3, -3], u = [1.5, 0, 0], v = [0, 0.3, 0.3] }
material = "lamp"
[[light]]
environment.radiance = 0.01
"#;

const INDICES: [f64; 3] = [1.5, 1.57, 1.66];

/// Returns a ball and a prism of some glass among glowing and reflecting objects, on a floor that may be diffuse.
fn text(index: &str, floor: &str, filter: &str, side: u32) -> String {
    let view = view([0.3, 1.0, 6.0], [0.1, 0.7, 0.0], 30.0, side);
    format!(
        r#"{view}filter = "{filter}"
[material]
floor.{floor}
glass.dielectric = {{ index = {index}, absorption.rgb = [0.1, 0.2, 0.3], transmittance.rgb = [0.9, 0.95, 1] }}
silver.mirror.reflectance.rgb = [0.9, 0.8, 0.7]
gold.conductor.metal = "Au"
lamp.emissive.radiance.rgb = [5, 4, 3]
sky.emissive = {{ radiance.rgb = [0.2, 0.3, 0.5], sides = "front" }}
{BALL_AND_PRISM}"#
    )
}

fn index_per_band() -> String {
    format!("{{ rgb = {INDICES:?} }}")
}

/// Renders a scene whose lanes part, and one with a flat index for each band.
fn parted_and_flat(floor: &str, filter: &str, transport: Transport) -> (Film, [Film; 3]) {
    let film = |index: &str| render_film(&text(index, floor, filter, 44), transport).0;
    (film(&index_per_band()), INDICES.map(|index| film(&index.to_string())))
}

#[test]
fn parted_lanes_equal_one_render_for_each_index_bit_for_bit() {
    let (parted, flat) = parted_and_flat("mirror.reflectance.rgb = [0.3, 0.4, 0.6]", "center", EVERY_BRANCH);
    let mut differing = 0;
    for (at, pixel) in parted.pixels.iter().enumerate() {
        let alone = [0, 1, 2].map(|band| flat[band].pixels[at].rgb[band]);
        assert_eq!(pixel.rgb.map(f32::to_bits), alone.map(f32::to_bits), "pixel {at}");
        differing += usize::from(pixel.rgb[2] != flat[0].pixels[at].rgb[2]);
    }
    assert!(differing > 300, "the glass disperses only {differing} pixels");
}

/// Returns one of the blocks of pixels that a film is divided into.
pub fn block(film: &Film, column: u32, row: u32) -> Film {
    let places = (0..BLOCK * BLOCK).map(|i| (column * BLOCK + i % BLOCK, row * BLOCK + i / BLOCK));
    let pixels = places.map(|(x, y)| *film.at(x, y)).collect();
    Film { width: BLOCK, height: BLOCK, pixels, layers: Vec::new(), spectral: None, manifests: Vec::new(), ..*film }
}

pub const BLOCK: u32 = 8;

#[test]
fn parted_lanes_equal_one_render_for_each_index_in_the_mean() {
    const SEEDS: u64 = 32;
    const BLOCKS: u32 = 5;
    let floor = "diffuse.reflectance.rgb = [0.7, 0.6, 0.5]";
    for transport in [SPLITTING, SINGLE_PATH] {
        let films = |index: &str, first: u64| {
            let scene = scene(&text(index, floor, "box", BLOCK * BLOCKS));
            films_of(&scene, &method(&scene, transport), first..first + SEEDS)
        };
        let parted = films(&index_per_band(), 0);
        for (band, index) in INDICES.into_iter().enumerate() {
            // With other seeds, so that the two sides are independent.
            let flat = films(&index.to_string(), SEEDS);
            for place in 0..BLOCKS * BLOCKS {
                let block_mean = |films: &[Film]| {
                    let blocks: Vec<Film> =
                        films.iter().map(|film| block(film, place % BLOCKS, place / BLOCKS)).collect();
                    let mean = Mean::over_seeds(&blocks);
                    (mean.value[band], mean.error[band])
                };
                let ((a, error_a), (b, error_b)) = (block_mean(&parted), block_mean(&flat));
                let (off, error) = ((a - b).abs(), error_a.hypot(error_b));
                let limit = sigma_limit((BLOCKS * BLOCKS * 6) as usize);
                assert!(off <= limit * error, "block {place}, band {band}: {a} parted, {b} alone, +- {error}");
            }
        }
    }
}
