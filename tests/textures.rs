//! Images and checkerboards on surfaces: colors in every model, lamps that show images, the kinds of files, and damaged
//! files.

mod files;
mod lamps;
mod openexr;
mod radiance;

use std::path::Path;
use std::sync::Arc;

use crate::support::larger::larger;
use crate::support::pictures::{RGB8, write_png};
use crate::support::random::Random;
use crate::support::scenes::{assert_near, film_of, first_mistake, scene_in, view};
use abbe::film::Film;
use abbe::plan::plan;
use abbe::scene::{Scene, Source};
use abbe::spectrum::{
    Basis, ColorSpace, Curve, CurveKind, Draw, Emission, Image, Lanes, MAX_LANES, Placement, Quantity, TexelFilter,
    Texture,
};

/// Renders the scene as its plan decides.
fn film(scene: &Scene<Curve>) -> Film {
    film_of(scene, plan(scene).method)
}

/// Returns objects of every kind with texture coordinates, made of a material `even`, under a uniform sky and a point
/// light.
fn room(material: &str, model: &str) -> String {
    let shapes = [
        "plane = { point = [0, -1, 0], normal = [0, 1, 0] }",
        "sphere = { center = [0, 0.3, 0], radius = 0.8 }",
        "cube = { center = [-1.5, 0, 0], size = 1 }",
        "quad = { center = [1.5, 0, 0], u = [0.5, 0, 0.2], v = [0, 0.5, 0] }",
        "disc = { center = [0, 1.8, 0], normal = [0, -1, 1], radius = 0.5 }",
        "triangle = { points = [[-2, 1, 0], [-1, 1, 0], [-1.5, 2, 0]] }",
    ];
    let objects = shapes.map(|shape| format!("[[object]]\nshape.{shape}\nmaterial = \"even\"\n")).concat();
    format!(
        "{}[render]\nmodel = {model}\nsamples = 4\n[material.even]\n{material}\n{objects}\
         [[light]]\nenvironment = {{ radiance = 1 }}\n\
         [[light]]\npoint = {{ position = [0, 4, 4], intensity = {{ illuminant = \"A\", scale = 9 }} }}\n",
        view([0.0, 1.0, 6.0], [0.0, 0.4, 0.0], 40.0, 12)
    )
}

const MODELS: [&str; 4] = ["\"rgb\"", "{ bands = 8 }", "{ bands = 32 }", "\"hero\""];

#[test]
fn an_even_gray_image_is_the_plain_reflectance_to_the_last_bit() {
    let folder = tempfile::tempdir().unwrap();
    write_png(folder.path(), "gray.png", 3, RGB8, &[128; 3 * 3 * 2]);
    let value = 128.0 / 255.0;
    let pairs = [
        ("{ image = \"gray.png\", encoding = \"linear\", repeat = [3, 0.7] }", value),
        ("{ image = \"gray.png\", encoding = \"linear\", scale = 0.5, wrap = \"mirror\" }", 0.5 * value),
        ("{ checker = [0.3, 0.3], repeat = 5 }", 0.3),
    ];
    for model in MODELS {
        for (texture, value) in pairs {
            let bits = |reflectance: &str| {
                let text = room(&format!("diffuse = {{ reflectance = {reflectance} }}"), model);
                let film = film(&scene_in(folder.path(), &text));
                film.pixels.iter().map(|pixel| pixel.rgb.map(f32::to_bits)).collect::<Vec<_>>()
            };
            assert!(bits(texture) == bits(&format!("{value:?}")), "{model}: {texture}");
        }
    }
}

/// In the middle of a texel, an image of thicknesses acts as a film whose thickness is given by its gray and its scale.
#[test]
fn a_film_is_as_thick_as_its_image_says() {
    let folder = tempfile::tempdir().unwrap();
    let gray = |x: usize, _| [0.25_f32, 0.75].map(|gray| (gray, gray, gray))[x];
    exr::prelude::write_rgb_file(folder.path().join("grays.exr"), 2, 1, gray).unwrap();
    let materials = [
        "thin = { index = 1.6, thickness_nm = THICKNESS }",
        "conductor = { metal = \"Ti\", coating = [{ index = 2.4, thickness_nm = THICKNESS }] }",
        "dielectric = { index = 1.5, coating = [{ index = 2.1, thickness_nm = THICKNESS }] }",
        "plastic = { reflectance = 0.2, coating = [{ index = 2.1, thickness_nm = THICKNESS }] }",
        "conductor = { metal = \"Ti\", roughness = 0.4, coating = [{ index = 2.4, thickness_nm = THICKNESS }] }",
        "dielectric = { index = 1.5, roughness = 0.4, coating = [{ index = 2.1, thickness_nm = THICKNESS }] }",
        "plastic = { reflectance = 0.8, roughness = 0.4, coating = [{ index = 2.1, k = 0.03, thickness_nm = THICKNESS }, \
         { index = 1.38, thickness_nm = 90 }] }",
    ];
    for material in materials {
        let film_scene = |x: f64, thickness: &str| {
            let text = view([x, 0.0, 9.0], [x, 0.0, 0.0], 1e-3, 1)
                + &format!("[render]\nsamples = 16\n[material.m]\n{}\n", material.replace("THICKNESS", thickness))
                + "[[object]]\nshape.quad = { center = [0, 0, 0], u = [1, 0, 0], v = [0, 1, 0] }\nmaterial = \"m\"\n\
                   [material.lamp]\nemissive = { radiance = 1 }\n[[object]]\nmaterial = \"lamp\"\n\
                   shape.quad = { center = [0, 0, 10], u = [9, 0, 0], v = [0, -9, 0] }\n";
            scene_in(folder.path(), &text)
        };
        let image = |x: f64| film_scene(x, "{ image = \"grays.exr\", scale = 400 }");
        let method = plan(&image(-0.5)).method;
        let seen = |scene: &Scene<Curve>| film_of(scene, method.clone()).pixels[0].rgb;
        let found = [-0.5, 0.5].map(|x| seen(&image(x)));
        let expected = [(-0.5, "100"), (0.5, "300")].map(|(x, nm)| seen(&film_scene(x, nm)));
        for (found, expected) in found.iter().zip(&expected) {
            let strongest = expected.iter().fold(0.0, |most: f32, x| larger(most, x.abs()));
            let is_near = (0..3).all(|i| (found[i] - expected[i]).abs() < 5e-4 * strongest);
            assert!(is_near, "{material}: {found:?}, not {expected:?}");
        }
        let apart = (0..3).any(|i| (expected[0][i] - expected[1][i]).abs() > 0.05 * expected[0][i]);
        assert!(apart, "{material}: both are {expected:?}");
    }
}

/// Returns every kind of basis.
fn bases() -> Vec<Basis> {
    let space = ColorSpace::Rec709;
    let light = |text: &str| Emission::new(&CurveKind::illuminant(text).unwrap().into(), space);
    vec![
        Basis::rgb(space),
        Basis::prefiltered(space, &light("D65")),
        Basis::prefiltered(space, &light("FL11")),
        Basis::bands(space, 8, &[]),
        Basis::bands(space, 16, &[546.1]),
        Basis::bands(space, 32, &[]),
        Basis::bands(space, 12, &[]).with_heroes(4, &[light("A")]),
        Basis::bands(ColorSpace::AcesCg, 12, &[]),
    ]
}

fn textured(width: usize, texels: &[[f32; 3]]) -> Curve {
    let image = Arc::new(Image::of_floats(width, 3, texels.as_flattened().to_vec()));
    let placement = Placement { filter: TexelFilter::Nearest, ..Placement::default() };
    CurveKind::Texture(Texture { image, placement }).into()
}

#[test]
fn no_texel_makes_a_lane_gain_or_lose_more_light_than_there_is() {
    const COUNT: usize = 4000;
    let mut random = Random::new(7);
    // Corners and edges of the color cube, where rounding could step outside, and its inside.
    let mut number = || (1.4 * random.number() - 0.2).clamp(0.0, 1.0) as f32;
    let texels: Vec<[f32; 3]> = (0..COUNT).map(|_| [number(), number(), number()]).collect();
    let curve = textured(COUNT, &texels);
    for basis in bases() {
        let table = basis.tabulate(Quantity::Reflectance, &curve);
        for (i, texel) in texels.iter().enumerate() {
            let draw = basis.draw::<MAX_LANES>((i as f64 + 0.5) / COUNT as f64);
            let lanes = draw.read_at(&table, [(i as f64 + 0.5) / COUNT as f64, 0.5]);
            assert!(lanes.0.iter().all(|x| (0.0..=1.0).contains(x)), "{}: {texel:?} is {lanes:?}", basis.name());
        }
    }
}

#[test]
fn a_texel_under_white_light_has_its_own_color() {
    let texels =
        [[0.8, 0.8, 0.8], [0.7, 0.2, 0.1], [0.1, 0.6, 0.3], [0.05, 0.1, 0.9], [0.9, 0.8, 0.1], [0.3, 0.3, 0.0]];
    let curve = textured(texels.len(), &texels);
    // Twice the measured error of 16 and 32 wavelengths. For sums of fully saturated colors, the error of 16 is 17e-3.
    let space = ColorSpace::Rec709;
    for (basis, tolerance) in
        [(Basis::rgb(space), 1e-6), (Basis::bands(space, 16, &[]), 3e-3), (Basis::bands(space, 32, &[]), 5e-4)]
    {
        let table = basis.tabulate(Quantity::Reflectance, &curve);
        let white = Curve::from(1.0);
        let (light, response) = (basis.tabulate(Quantity::Emission, &white), basis.response(&white));
        let draw: Draw<MAX_LANES> = basis.draw(0.5);
        for (i, texel) in texels.iter().enumerate() {
            let uv = [(i as f64 + 0.5) / texels.len() as f64, 0.5];
            let lanes: Lanes<MAX_LANES> = draw.read_at(&table, uv) * draw.read(&light);
            let found = response.film_rgb(&draw, lanes, false);
            for c in 0..3 {
                let off = (found[c] - f64::from(texel[c])).abs();
                assert!(off <= tolerance, "{}: {texel:?} becomes {found:?}", basis.name());
            }
        }
    }
}

#[test]
fn images_are_colors_that_three_lanes_hold_and_a_measured_square_is_none() {
    let folder = tempfile::tempdir().unwrap();
    write_png(folder.path(), "red.png", 1, RGB8, &[200, 50, 20, 90, 90, 90]);
    let model = |reflectance: &str| {
        let text = room(&format!("diffuse = {{ reflectance = {reflectance} }}"), "\"auto\"")
            .replace("{ illuminant = \"A\", scale = 9 }", "9");
        plan(&scene_in(folder.path(), &text)).method.basis.name()
    };
    assert_eq!(model("{ image = \"red.png\" }"), "rgb");
    assert_eq!(model("{ checker = [0.5, { rgb = [0.5, 0.2, 0.1] }] }"), "rgb");
    assert_ne!(model("{ checker = [0.5, \"dark skin\"] }"), "rgb");
}

/// A square of a checkerboard looks like its own curve, of any kind, to a camera that sees only that square.
#[test]
fn squares_of_a_checkerboard_are_their_curves() {
    let folder = tempfile::tempdir().unwrap();
    write_png(folder.path(), "dots.png", 2, RGB8, &[200, 50, 20, 90, 90, 90]);
    let cells = ["\"dark skin\"", "{ image = \"dots.png\" }", "{ samples = [[400, 0.1], [700, 0.8]] }", "0.25"];
    let seen_color = |reflectance: &str, x: f64| {
        let text = format!(
            "{}[render]\nmodel = {{ bands = 16 }}\nsamples = 2\n\
             [material.even]\ndiffuse = {{ reflectance = {reflectance} }}\n\
             [[object]]\nshape.plane = {{ point = [0, 0, 0], normal = [0, 1, 0] }}\nmaterial = \"even\"\n\
             [[light]]\nsun = {{ toward = [0, 1, 0], irradiance = 3 }}\n",
            view([x, 3.0, -0.5], [x, 0.0, -0.5], 10.0, 6).replace("[film]", "up = [0, 0, -1]\n[film]")
        );
        let film = film(&scene_in(folder.path(), &text));
        film.pixels.iter().map(|pixel| pixel.rgb.map(f32::to_bits)).collect::<Vec<_>>()
    };
    for [first, second] in [[cells[0], cells[1]], [cells[2], cells[3]]] {
        let checker = format!("{{ checker = [{first}, {second}] }}");
        for (x, cell) in [(0.5, first), (1.5, second), (-0.5, second), (-1.5, first)] {
            assert!(seen_color(&checker, x) == seen_color(cell, x), "{checker} at {x} is not {cell}");
        }
    }
}
