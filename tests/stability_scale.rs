//! Row S6 of the stability catalog: a scene has no inherent size. Scaled by a power of two, which commutes with every
//! rounding, it gives the identical image. Any length that is hidden in the code shows here.
//!
//! ```text
//! cargo test --test all stability_scale::
//! ```

use abbe::film::{DEPTH_OF_NOTHING, Film};
use abbe::trace::Transport;

use crate::support::scenes::{SINGLE_PATH, SPLITTING, render_film, scene};

/// Returns a scene with every shape, material and light. All lengths are multiplied by a factor.
fn text(size: f64) -> String {
    let number = |x: f64| format!("{:?}", x * size);
    let vector = |v: [f64; 3]| format!("{:?}", v.map(|x| x * size));
    let (intensity, absorption) = (6.0 * size * size, 0.7 / size);
    let objects = [
        ("floor", format!("plane = {{ point = {}, normal = [0.1, 1, 0] }}", vector([0.3, 0.0, 0.1])), ""),
        ("red", format!("sphere = {{ center = {}, radius = {} }}", vector([-1.7, 0.6, -0.4]), number(0.6)), ""),
        ("glass", format!("sphere = {{ center = {}, radius = {} }}", vector([0.2, 0.9, 0.7]), number(0.55)), ""),
        ("ruby", format!("cube = {{ center = {}, size = {} }}", vector([1.4, 0.7, -0.3]), vector([0.7, 0.9, 0.8])), ""),
        (
            "flint",
            format!("sphere = {{ center = {}, radius = {} }}", vector([0.0; 3]), number(0.5)),
            "{ scale = [1.3, 0.6, 0.9] }, { rotate = { axis = [1, 2, 3], degrees = 33 } }",
        ),
        (
            "glass",
            format!(
                "mesh = {{ points = [{}, {}, {}, {}], faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] }}",
                vector([-0.9, 0.1, 1.2]),
                vector([-0.2, 0.1, 1.9]),
                vector([0.1, 0.2, 1.1]),
                vector([-0.4, 0.9, 1.4])
            ),
            "{ scale = [-1, 1, 1] }",
        ),
        (
            "gold",
            format!(
                "disc = {{ center = {}, normal = [1, 0.2, 1], radius = {} }}",
                vector([-2.2, 1.1, -2.0]),
                number(1.1)
            ),
            "",
        ),
        (
            "silver",
            format!(
                "quad = {{ center = {}, u = {}, v = {} }}",
                vector([2.0, 1.2, -2.2]),
                vector([0.9, 0.1, 0.4]),
                vector([0.0, 1.0, 0.1])
            ),
            "",
        ),
        (
            "red",
            format!(
                "triangle = {{ points = [{}, {}, {}] }}",
                vector([-0.6, 0.0, 0.6]),
                vector([0.6, 0.1, 0.2]),
                vector([0.1, 0.8, 0.1])
            ),
            "",
        ),
        (
            "lamp",
            format!(
                "quad = {{ center = {}, u = {}, v = {} }}",
                vector([0.3, 3.1, 0.2]),
                vector([0.4, 0.0, 0.1]),
                vector([0.0, 0.1, 0.4])
            ),
            "",
        ),
        ("lamp", format!("sphere = {{ center = {}, radius = {} }}", vector([-2.0, 2.3, 0.8]), number(0.2)), ""),
        (
            "glow",
            format!("sphere = {{ center = {}, radius = {} }}", vector([0.0; 3]), number(0.3)),
            "{ scale = [1, 0.5, 0.7] }, { rotate = { axis = [0, 1, 1], degrees = 20 } }, { translate = MOVE }",
        ),
        ("glow", format!("cube = {{ center = {}, size = {} }}", vector([2.4, 0.4, 0.9]), number(0.3)), ""),
    ];
    let place = vector([1.5, 2.2, 0.9]);
    let objects: String = objects
        .iter()
        .map(|(material, shape, steps)| {
            let steps = steps.replace("MOVE", &place);
            format!("[[object]]\nshape.{shape}\nmaterial = \"{material}\"\ntransform = [{steps}]\n")
        })
        .collect();
    format!(
        r#"
camera = {{ position = {position}, look_at = {look_at}, vertical_fov = 42, near = {near} }}
film = {{ width = 72, height = 54 }}
render = {{ samples = 4, seed = 5 }}
[material]
floor.diffuse.reflectance.rgb = [0.6, 0.5, 0.4]
red.diffuse.reflectance.rgb = [0.7, 0.1, 0.1]
glass.dielectric.index = 1.5
flint.dielectric = {{ index.rgb = [1.7, 1.73, 1.79], transmittance = 0.95, priority = 1 }}
ruby.dielectric = {{ index = 1.6, absorption = {{ rgb = [0.1, 1, 0.9], scale = {absorption:?} }}, emission = 0.01 }}
gold.conductor.metal = "Au"
silver.mirror.reflectance = 0.9
lamp.emissive.radiance.rgb = [9, 8, 6]
glow.emissive = {{ radiance = 4, sides = "front" }}
{objects}
[[light]]
point = {{ position = {point}, intensity = {intensity:?} }}
[[light]]
environment.radiance.rgb = [0.1, 0.2, 0.4]
"#,
        position = vector([0.4, 1.9, 6.3]),
        look_at = vector([0.0, 0.8, 0.0]),
        near = number(2.5),
        point = vector([1.0, 2.5, 3.0]),
    )
}

fn assert_same_but_depth(scaled: &Film, film: &Film, size: f32) {
    for (at, (scaled, pixel)) in scaled.pixels.iter().zip(&film.pixels).enumerate() {
        assert_eq!(scaled.rgb.map(f32::to_bits), pixel.rgb.map(f32::to_bits), "pixel {at} at size {size}");
        assert_eq!(scaled.alpha, pixel.alpha, "alpha of pixel {at} at size {size}");
        let depth = if pixel.depth == DEPTH_OF_NOTHING { pixel.depth } else { pixel.depth * size };
        assert_eq!(scaled.depth, depth, "depth of pixel {at} at size {size}");
    }
}

#[test]
fn s6_a_scene_scaled_by_a_power_of_two_gives_the_identical_image() {
    for transport in [SPLITTING, SINGLE_PATH, Transport::Deterministic { cutoff: 1e-4, max_sample_surfaces: u64::MAX }]
    {
        let (film, report) = render_film(&text(1.0), transport);
        assert_eq!((report.non_finite, report.unmatched), (0, 0));
        let seen = |test: &dyn Fn(f32) -> bool| film.pixels.iter().filter(|pixel| test(pixel.rgb[0])).count();
        assert!(seen(&|x| x > 0.05) > 1000, "the scene is nearly black");
        for power in [20, -20] {
            let size = libm::exp2(f64::from(power));
            let (scaled, counted) = render_film(&text(size), transport);
            assert_eq!(counted.rays, report.rays, "size 2^{power}");
            assert_same_but_depth(&scaled, &film, size as f32);
        }
    }
}

#[test]
fn s6_the_comparison_notices_a_length_that_was_not_scaled() {
    let (film, _) = render_film(&text(1.0), SPLITTING);
    let with_length_kept = text(2.0).replace("intensity = 24.0", "intensity = 6.0");
    let (other, _) = render_film(&with_length_kept, SPLITTING);
    assert!(film.pixels.iter().zip(&other.pixels).any(|(a, b)| a.rgb != b.rgb));
}

#[test]
fn s6_areas_scale_exactly_and_with_them_how_often_each_light_is_aimed_at() {
    let objects = scene(&text(1.0)).objects;
    for power in [40, -40] {
        let size = libm::exp2(f64::from(power));
        for (scaled, object) in scene(&text(size)).objects.iter().zip(objects.iter()) {
            let expected = object.shape.area() * size * size;
            assert_eq!(scaled.shape.area(), expected, "{:?} at size 2^{power}", object.shape);
        }
    }
}
