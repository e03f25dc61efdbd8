//! Images that bend normals: the normals are the expected ones, no light is lost or gained, and everything else is left
//! alone.
//!
//! ```text
//! cargo test --test all relief::
//! ```

use std::f64::consts::{PI, TAU};
use std::path::Path;

use crate::support::larger::larger;
use crate::support::pictures::{L8, RGB8, RGB16, write_png};
use crate::support::random::Random;
use crate::support::scenes::{EVERY_BRANCH, Mean, SINGLE_PATH, SPLITTING, environment, render_film_in, scene_in, view};
use abbe::math::{DVec3, Ray};
use abbe::scene::Source;

/// Writes an OpenEXR image with the colors at the centers of its texels, u to the right and v up.
fn write_exr(folder: &Path, name: &str, [width, height]: [usize; 2], color: impl Fn(f64, f64) -> [f32; 3] + Sync) {
    let at = |x: usize, y: usize| {
        let [r, g, b] = color((x as f64 + 0.5) / width as f64, 1.0 - (y as f64 + 0.5) / height as f64);
        (r, g, b)
    };
    exr::prelude::write_rgb_file(folder.join(name), width, height, at).expect("written");
}

const MESH: &str = "mesh = { points = [[-2, 1, 0], [-1, 1, 0], [-1, 2, 0.2], [-2, 2, 0]], faces = [[0, 1, 2], [0, 2, 3]], \
                    normals = [[-0.3, 0, 1], [0.3, 0, 1], [0.3, 0, 1], [-0.3, 0, 1]], \
                    uv = [[0, 0], [1, 0], [1, 1], [0.2, 1]] }";

/// Returns objects of every kind with texture coordinates and the same map, under a sky and a point light.
fn room(material: &str, map: &str) -> String {
    let shapes = [
        "plane = { point = [0, -1, 0], normal = [0, 1, 0] }",
        "sphere = { center = [0, 0.3, 0], radius = 0.8 }",
        "cube = { center = [-1.5, 0, 0], size = 1 }",
        "quad = { center = [1.5, 0, 0], u = [0.5, 0, 0.2], v = [0, 0.5, 0] }",
        "disc = { center = [0, 1.8, 0], normal = [0, -1, 1], radius = 0.5 }",
        "triangle = { points = [[1, 1, 0], [2, 1, 0], [1.5, 2, 0]] }",
        MESH,
    ];
    let objects = shapes.map(|shape| format!("[[object]]\nshape.{shape}\nmaterial = \"even\"\n{map}\n")).concat();
    format!(
        "{}[render]\nsamples = 4\n[material.even]\n{material}\n{objects}{}\
         [[light]]\npoint = {{ position = [0, 4, 4], intensity = 9 }}\n",
        view([0.0, 1.0, 6.0], [0.0, 0.4, 0.0], 40.0, 24),
        environment(0.5)
    )
}

#[test]
fn a_flat_map_changes_no_bit() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_png(folder, "flat.png", 2, RGB8, &[128, 128, 255].repeat(4));
    let words = [32768_u16, 32768, 65535].map(u16::to_be_bytes).concat();
    write_png(folder, "deep.png", 2, RGB16, &words.repeat(4));
    write_exr(folder, "flat.exr", [2, 2], |_, _| [0.5, 0.5, 1.0]);
    write_png(folder, "level.png", 2, L8, &[77; 4]);
    write_png(folder, "steps.png", 2, L8, &[77, 99, 20, 5]);
    for material in
        ["diffuse.reflectance = 0.7", "conductor = { metal = \"Au\", roughness = 0.3 }", "mirror.reflectance = 0.5"]
    {
        let bits = |map: &str| -> Vec<_> {
            let (film, _) = render_film_in(folder, &room(material, map), SPLITTING);
            film.pixels.iter().map(|pixel| pixel.rgb.map(f32::to_bits)).collect()
        };
        let bare = bits("");
        for map in [
            "normal_map = { image = \"flat.png\" }",
            "normal_map = { image = \"deep.png\", strength = 3 }",
            "normal_map = { image = \"flat.exr\", repeat = [2, 3] }",
            "normal_map = { image = \"flat.png\", strength = 0 }",
            "bump_map = { image = \"level.png\", depth = 0.3 }",
        ] {
            assert!(bits(map) == bare, "{material}: {map}");
        }
        assert!(bits("bump_map = { image = \"steps.png\", depth = 0.3 }") != bare, "{material}: dents change nothing");
    }
}

/// Writes strong dents: a random height and a random direction in every texel.
fn write_dents(folder: &Path) {
    let mut random = Random::new(11);
    let heights: Vec<u8> = (0..16 * 16).map(|_| (random.number() * 256.0) as u8).collect();
    write_png(folder, "dents.png", 16, L8, &heights);
    let normals: Vec<u8> = (0..16 * 16)
        .flat_map(|_| {
            let way = random.direction();
            [way.x, way.y, 0.4 + way.z.abs()].map(|x| (128.0 + 127.0 * x.min(1.0)) as u8)
        })
        .collect();
    write_png(folder, "normals.png", 16, RGB8, &normals);
}

const DENTS: [&str; 2] = [
    "normal_map = { image = \"normals.png\", repeat = 2 }",
    "bump_map = { image = \"dents.png\", repeat = 2, depth = 0.15 }",
];

#[test]
fn white_surfaces_with_dents_are_as_bright_as_the_sky_around_them() {
    let folder = tempfile::tempdir().unwrap();
    write_dents(folder.path());
    let shapes = [
        ("quad = { center = [0, 0, 0], u = [2, 0, 0], v = [0, 0, -2] }", [1.0, 2.0, 3.0]),
        ("sphere = { center = [0, 0, 0], radius = 1 }", [1.0, 2.0, 5.0]),
    ];
    for (shape, from) in shapes {
        for material in [
            "diffuse.reflectance = 1",
            "mirror.reflectance = 1",
            "conductor = { n = 0.0001, k = 100, roughness = 0.5 }",
        ] {
            for map in DENTS {
                for transport in [SPLITTING, SINGLE_PATH] {
                    let text = format!(
                        "{}[render]\nsamples = 64\n[material.m]\n{material}\n[[object]]\nshape.{shape}\nmaterial = \"m\"\n{map}\n{}",
                        view(from, [0.0; 3], 20.0, 40),
                        environment(1.0)
                    );
                    let (film, report) = render_film_in(folder.path(), &text, transport);
                    assert_eq!((report.non_finite, report.unmatched), (0, 0));
                    let mean = Mean::of(&film);
                    println!("{material}, {map}: {:?} +- {:?}", mean.value[1], mean.error[1]);
                    assert!((mean.value[1] - 1.0).abs() <= 5e-3, "{shape}, {material}, {map}: {mean:?}");
                    assert!(mean.error[1] < 1.5e-3, "{shape}, {material}, {map}: {mean:?}");
                }
            }
        }
    }
}

/// Returns the brightness in the middle of a white patch in the sun, seen from nearly straight above.
fn sunlit(folder: &Path, object: &str, toward: DVec3) -> f64 {
    sunlit_from(folder, object, toward, [0.1, 5.0, 0.2]).0
}

/// Returns the brightness in the middle of the patch seen from anywhere, and the layer `N` there.
fn sunlit_from(folder: &Path, object: &str, toward: DVec3, from: [f64; 3]) -> (f64, [f32; 3]) {
    let view = view(from, [0.0; 3], 1.0, 2).replace("[film]\n", "[film]\nlayers = [\"N\"]\n");
    let text = format!(
        "{view}[render]\nsamples = 1\n[material.m]\ndiffuse.reflectance = 1\n[[object]]\n{object}\nmaterial = \"m\"\n\
         [[light]]\nsun = {{ toward = {:?}, angular_diameter = 0, irradiance = {PI:?} }}\n",
        toward.to_array()
    );
    let (film, _) = render_film_in(folder, &text, EVERY_BRANCH);
    let first = film.pixels[0].rgb[1];
    assert!(film.pixels.iter().all(|pixel| (pixel.rgb[1] - first).abs() < 1e-5));
    (f64::from(first), film.layers[0].values[..3].try_into().expect("a normal"))
}

/// A matte surface has one brightness and one normal for all viewers, also for those whom the normal faces away from.
#[test]
fn a_matte_surface_of_bent_normals_looks_the_same_from_everywhere() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for degrees in [10.0_f64, 30.0, 50.0] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        write_exr(folder, "tilted.exr", [2, 2], |_, _| [sin, 0.0, cos].map(|x| (0.5 + 0.5 * x) as f32));
        let quad = "shape.quad = { center = [0, 0, 0], u = [1, 0, 0], v = [0, 0, -1] }";
        let (object, normal) =
            (format!("{quad}\nnormal_map = {{ image = \"tilted.exr\" }}"), DVec3::new(sin, cos, 0.0));
        let toward = DVec3::new(0.3, 2.0, 0.4).normalize();
        for from in [[-5.0, 0.9, 0.2], [5.0, 0.9, 0.2], [-3.0, 3.0, 1.0], [0.3, 1.0, -5.0], [0.1, 5.0, 0.2]] {
            let (found, shown) = sunlit_from(folder, &object, toward, from);
            let expected = toward.dot(normal);
            assert!((found - expected).abs() < 2e-4, "{degrees} from {from:?}: {found}, not {expected}");
            let shown = DVec3::from(shown.map(f64::from));
            assert!((shown - normal).length() < 1e-4, "{degrees} from {from:?}: {shown}, not {normal}");
        }
    }
}

/// Lambert's law holds for the normal of the map, on every kind of surface that faces up, with u to +x and v to -z.
#[test]
fn an_even_map_shades_like_a_surface_with_the_same_tilt() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let tilted = DVec3::new(0.3, 0.2, 1.0).normalize();
    write_exr(folder, "tilted.exr", [2, 2], |_, _| tilted.to_array().map(|x| (0.5 + 0.5 * x) as f32));
    // Rises by 0.5 to the right and by 0.25 upward, from edge to edge.
    write_exr(folder, "slope.exr", [64, 64], |u, v| [(0.5 * u + 0.25 * v) as f32; 3]);
    let upright = "shape.quad = { center = [0, 0, 0], u = [1, 0, 0], v = [0, 0, -1] }";
    let mesh = |uv: &str| {
        format!(
            "shape.mesh = {{ points = [[-1, 0, 1], [1, 0, 1], [1, 0, -1], [-1, 0, -1]], \
             faces = [[0, 1, 2], [0, 2, 3]], uv = {uv} }}"
        )
    };
    let plain = mesh("[[0, 0], [1, 0], [1, 1], [0, 1]]");
    // Each object, with the directions of u and v on it.
    let objects = [
        (upright.to_owned(), DVec3::X, -DVec3::Z),
        ("shape.plane = { point = [-0.5, 0, 0.5], normal = [0, 1, 0] }".into(), DVec3::X, -DVec3::Z),
        ("shape.cube = { center = [0, -1, 0], size = 2 }".into(), DVec3::X, -DVec3::Z),
        (
            "shape.disc = { center = [0, 0, 0], normal = [0, 1, 0], radius = 1, u = [0, 0, 1] }".into(),
            DVec3::Z,
            DVec3::X,
        ),
        ("shape.triangle = { points = [[-1, 0, 1], [2, 0, 1], [-1, 0, -2]] }".into(), DVec3::X, -DVec3::Z),
        (plain.clone(), DVec3::X, -DVec3::Z),
        (mesh("[[1, 0], [0, 0], [0, 1], [1, 1]]"), -DVec3::X, -DVec3::Z),
        (format!("{upright}\ntransform = [{{ scale = [-1, 1, 1] }}]"), -DVec3::X, -DVec3::Z),
        (format!("{plain}\ninstances = [[{{ rotate = {{ axis = [0, 1, 0], degrees = 90 }} }}]]"), -DVec3::Z, -DVec3::X),
        (format!("{plain}\ninstances = [[{{ scale = [1, 1, -1] }}]]"), DVec3::X, DVec3::Z),
    ];
    for (object, u, v) in objects {
        let normal = u * tilted.x + v * tilted.y + DVec3::Y * tilted.z;
        // Length of the image on the object: 2 for quads and the like, 3 for the triangle, 1 for planes.
        let size = if object.contains("plane") {
            1.0
        } else if object.contains("triangle") {
            3.0
        } else {
            2.0
        };
        let sloping = (DVec3::Y - (u * 0.5 + v * 0.25) / size).normalize();
        for toward in [DVec3::new(1.0, 2.0, 0.3), DVec3::new(-0.8, 2.0, 0.4), DVec3::new(0.1, 1.5, 1.0), DVec3::Y] {
            let toward = toward.normalize();
            let found = sunlit(folder, &format!("{object}\nnormal_map = {{ image = \"tilted.exr\" }}"), toward);
            let expected = toward.dot(normal);
            assert!((found - expected).abs() < 2e-4, "{object} lit from {toward}: {found}, not {expected}");
            for strength in [0.5, 2.0] {
                let map = format!("normal_map = {{ image = \"tilted.exr\", strength = {strength:?} }}");
                let found = sunlit(folder, &format!("{object}\n{map}"), toward);
                let steeper = (u * tilted.x + v * tilted.y) * strength + DVec3::Y * tilted.z;
                let expected = toward.dot(steeper.normalize());
                assert!((found - expected).abs() < 2e-4, "{object} lit from {toward}: {found}, not {expected}");
            }
            let found = sunlit(folder, &format!("{object}\nbump_map = {{ image = \"slope.exr\", depth = 1 }}"), toward);
            let expected = toward.dot(sloping);
            assert!((found - expected).abs() < 2e-4, "{object} lit from {toward}: {found}, not {expected}");
        }
    }
}

/// Small heights give a sphere the normals of a sphere whose points are displaced by them.
#[test]
fn normals_under_heights_are_those_of_a_displaced_sphere() {
    let folder = tempfile::tempdir().unwrap();
    let height =
        |u: f64, v: f64| 0.5 + 0.2 * libm::sin(TAU * 3.0 * u) * libm::sin(PI * v) + 0.2 * libm::cos(PI * 4.0 * v);
    write_exr(folder.path(), "waves.exr", [512, 256], |u, v| [height(u, v) as f32; 3]);
    const DEPTH: f64 = 0.05;
    let text = format!(
        "{}[material.m]\ndiffuse.reflectance = 1\n[[object]]\nshape.sphere = {{ center = [1, 2, 3], radius = 2 }}\n\
         material = \"m\"\nbump_map = {{ image = \"waves.exr\", depth = {DEPTH:?} }}\n{}",
        view([0.0, 0.0, 9.0], [0.0; 3], 30.0, 4),
        environment(1.0)
    );
    let scene = scene_in(folder.path(), &text);
    let (object, center) = (&scene.objects[0], DVec3::new(1.0, 2.0, 3.0));
    let displaced = |u: f64, v: f64| {
        let ((sin, cos), (up, across)) = (libm::sincos(TAU * (u - 0.5)), libm::sincos(PI * (v - 0.5)));
        DVec3::new(across * sin, up, across * cos) * (2.0 + DEPTH * height(u, v))
    };
    let mut random = Random::new(5);
    let mut most: f64 = 0.0;
    for _ in 0..2000 {
        let (u, v) = (random.number(), 0.05 + 0.9 * random.number());
        let ray = Ray::new(center, displaced(u, v));
        let intersection = object.shape.intersect(&ray, f64::INFINITY).unwrap();
        let found = object.point(&ray, &intersection);
        const STEP: f64 = 1e-5;
        let along = displaced(u + STEP, v) - displaced(u - STEP, v);
        let up = displaced(u, v + STEP) - displaced(u, v - STEP);
        let expected = along.cross(up).normalize();
        most = larger(most, expected.cross(found.normal).length());
        // Blinn's method leaves out the height itself, up to 2.3 % of the radius. It misses that fraction of a tilt of
        // up to 0.03.
        assert!((found.shading - expected).length() < 1e-3, "{u} {v}: {} not {expected}", found.shading);
    }
    assert!(most > 0.02, "the waves tilt by {most}");
}

#[test]
fn no_normal_is_lost_at_the_poles_of_a_sphere() {
    let folder = tempfile::tempdir().unwrap();
    write_dents(folder.path());
    for map in DENTS {
        let text = format!(
            "{}[material.m]\ndiffuse.reflectance = 1\n[[object]]\nshape.sphere = {{ center = [0, 0, 0], radius = 1 }}\n\
             material = \"m\"\n{map}\n{}",
            view([0.0, 0.0, 9.0], [0.0; 3], 30.0, 4),
            environment(1.0)
        );
        let scene = scene_in(folder.path(), &text);
        let object = &scene.objects[0];
        let aside = [0.0, -0.0, 1e-300, -1e-300, 1e-160, 1e-17, -1e-17, 1e-12, 1e-8, -1e-4];
        for pole in [1.0, -1.0] {
            for x in aside {
                for z in aside {
                    let ray = Ray::new(DVec3::new(3.0 * x, 3.0 * pole, 3.0 * z), DVec3::new(-x, -pole, -z));
                    let intersection = object.shape.intersect(&ray, f64::INFINITY).unwrap();
                    let point = object.point(&ray, &intersection);
                    let upright =
                        (point.shading.length() - 1.0).abs() < 1e-12 && point.shading.dot(point.normal) > -1e-15;
                    assert!(upright, "{map} at {x} {z}: {}", point.shading);
                }
            }
        }
    }
}

#[test]
fn maps_of_any_numbers_give_unit_normals() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_exr(folder, "any.exr", [16, 16], |u, v| {
        let mut random = Random::new((u * 16.0) as u64 * 16 + (v * 16.0) as u64);
        [0.0; 3].map(|_: f64| if random.number() < 0.2 { 0.5 } else { random.number() as f32 })
    });
    write_exr(folder, "huge.exr", [16, 16], |u, v| {
        [if (u * 16.0) as u32 % 3 == (v * 16.0) as u32 % 2 { 1e38 } else { -1e38 }; 3]
    });
    for map in [
        "normal_map = { image = \"any.exr\", strength = 1000 }",
        "normal_map = { image = \"any.exr\" }",
        "bump_map = { image = \"huge.exr\", depth = 1e30, repeat = 1e6 }",
        "bump_map = { image = \"huge.exr\", depth = -1e-300 }",
    ] {
        let scene = scene_in(folder, &room("diffuse.reflectance = 1", map));
        let mut random = Random::new(9);
        for object in scene.objects.iter() {
            for _ in 0..300 {
                let from = DVec3::new(0.0, 1.0, 6.0);
                let toward = DVec3::new(4.0 * random.number() - 2.0, 3.0 * random.number() - 1.0, 0.0);
                let ray = Ray::new(from, toward - from);
                let Some(intersection) = object.shape.intersect(&ray, f64::INFINITY) else { continue };
                let point = object.point(&ray, &intersection);
                let upright = (point.shading.length() - 1.0).abs() < 1e-12 && point.shading.dot(point.normal) > -1e-15;
                assert!(upright, "{map}: {}", point.shading);
            }
        }
    }
}

/// Mistakes with images that the tables of messages cannot hold.
#[test]
fn images_that_are_no_relief_are_refused_in_words() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_png(folder, "gray.png", 2, L8, &[128; 4]);
    write_png(folder, "dark.png", 2, RGB8, &[128, 128, 60].repeat(4));
    write_png(folder, "flat.png", 2, RGB8, &[128, 128, 255].repeat(4));
    write_exr(folder, "signed.exr", [2, 2], |_, _| [0.0, -0.25, 1.0]);
    let sphere = "shape.sphere = { center = [0, 0, 0], radius = 1 }";
    let bare = "shape.mesh = { points = [[0, 0, 0], [1, 0, 0], [0, 1, 0]], faces = [[0, 1, 2]] }";
    let refused = |shape: &str, map: &str| {
        let text = format!(
            "{}[material.m]\ndiffuse.reflectance = 1\n[[object]]\n{shape}\nmaterial = \"m\"\n{map}\n{}",
            view([0.0, 0.0, 9.0], [0.0; 3], 30.0, 4),
            environment(1.0)
        );
        let source = Source { path: folder.join("scene.toml"), text };
        source.compile().err().map(|error| error.to_string())
    };
    for (shape, map, words) in [
        (sphere, "normal_map = { image = \"gray.png\" }", "gray.png is gray, but a normal map has red, green and blue"),
        (sphere, "normal_map = { image = \"dark.png\" }", "its mean normal points into the surface"),
        (sphere, "normal_map = { image = \"signed.exr\" }", "pixel (0, 0) is [0.0, -0.25, 1.0]"),
        (bare, "normal_map = { image = \"flat.png\" }", "this mesh has no texture coordinates"),
        (bare, "bump_map = { image = \"gray.png\", depth = 1 }", "this mesh has no texture coordinates"),
    ] {
        let refusal = refused(shape, map).unwrap_or_default();
        assert!(refusal.contains(words), "{map}: {refusal}");
    }
    // Heights may be below 0, and a gray image holds them as well as a color image.
    for map in ["bump_map = { image = \"signed.exr\", depth = 1 }", "bump_map = { image = \"gray.png\", depth = -1 }"] {
        assert_eq!(refused(sphere, map), None);
    }
}
