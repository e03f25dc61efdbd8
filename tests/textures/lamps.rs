//! Surfaces that show an image light the scene as its texels say.

use abbe::math::DVec3;
use abbe::trace::Method;

use super::*;
use crate::support::scenes::{Mean, SPLITTING, film_of, films_of, mean_color, scene};

const WIDTH: usize = 4;
/// Rows from the top. Nothing is symmetric.
const TEXELS: [[f32; 3]; 12] = [
    [1.0, 0.0, 0.1],
    [0.2, 0.9, 0.0],
    [0.0, 0.3, 2.5],
    [0.0, 0.0, 0.0],
    [0.5, 0.5, 0.5],
    [3.0, 0.2, 0.0],
    [0.1, 0.0, 0.0],
    [0.0, 1.5, 0.4],
    [0.3, 0.1, 0.0],
    [0.0, 0.0, 0.6],
    [0.9, 0.9, 0.1],
    [0.1, 4.0, 0.2],
];

fn write_lamp(folder: &Path) {
    let at = |x: usize, y: usize| {
        let [r, g, b] = TEXELS[y * WIDTH + x];
        (r, g, b)
    };
    exr::prelude::write_rgb_file(folder.join("lamp.exr"), WIDTH, TEXELS.len() / WIDTH, at).unwrap();
}

/// Returns the color at (u, v) by the formula of bilinear interpolation between clamped texels.
fn color([u, v]: [f64; 2]) -> [f64; 3] {
    let height = TEXELS.len() / WIDTH;
    let (x, y) = (u * WIDTH as f64 - 0.5, (1.0 - v) * height as f64 - 0.5);
    let mut sum = [0.0; 3];
    for (row, column) in (0..height).flat_map(|row| (0..WIDTH).map(move |column| (row, column))) {
        // The hat function of a texel, which continues beyond the edges.
        let hat =
            |at: f64, i: usize, count: usize| (1.0 - (at.clamp(0.0, count as f64 - 1.0) - i as f64).abs()).max(0.0);
        let weight = hat(x, column, WIDTH) * hat(y, row, height);
        (0..3).for_each(|c| sum[c] += weight * f64::from(TEXELS[row * WIDTH + column][c]));
    }
    sum
}

const LAMP: &str = "emissive = { radiance = { image = \"lamp.exr\", wrap = \"clamp\", scale = 2 } }";

/// Returns a small white floor below a lamp whose image faces down, seen from above. u runs along +x and v along +z.
fn floor(model: &str) -> String {
    format!(
        "{}[render]\nmodel = {model}\nsamples = 64\n\
         [material.white]\ndiffuse = {{ reflectance = 0.5 }}\n[material.lamp]\n{LAMP}\n\
         [[object]]\nshape.quad = {{ center = [0, 0, 0], u = [0, 0, 0.01], v = [0.01, 0, 0] }}\nmaterial = \"white\"\n\
         [[object]]\nshape.quad = {{ center = [0.2, 1, 0.1], u = [1, 0, 0], v = [0, 0, 0.8] }}\nmaterial = \"lamp\"\n",
        view([0.0, 0.5, 0.0], [0.0; 3], 1.0, 6).replace("[film]", "up = [0, 0, -1]\n[film]")
    )
}

/// Returns the mean of renders with the splitting transport.
fn mean(scene: &Scene<Curve>) -> Mean {
    let method = Method { transport: SPLITTING, ..plan(scene).method };
    Mean::over_seeds(&films_of(scene, &method, 0..16))
}

/// Returns the film color of the floor's middle: reflectance / pi times the sum of L cos cos / r^2 over the lamp, whose
/// radiance in each lane is read from its table.
fn expected(scene: &Scene<Curve>, basis: &Basis) -> [f64; 3] {
    let emission = scene.lights[0].emission();
    let (table, response) = (basis.tabulate(Quantity::Emission, emission), basis.response(emission));
    let draw: Draw<MAX_LANES> = basis.draw(0.5);
    floor_color(|uv| response.film_rgb(&draw, draw.read_at(&table, uv), false))
}

/// Returns the film color of the floor's middle under a lamp with any radiance.
fn floor_color(radiance: impl Fn([f64; 2]) -> [f64; 3]) -> [f64; 3] {
    const STEPS: usize = 300;
    let mut sum = [0.0; 3];
    for (i, j) in (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| (i, j))) {
        let uv = [i, j].map(|i| (i as f64 + 0.5) / STEPS as f64);
        let point = DVec3::new(0.2 + 2.0 * uv[0] - 1.0, 1.0, 0.1 + 0.8 * (2.0 * uv[1] - 1.0));
        let form = 1.0 / (point.length_squared() * point.length_squared());
        let area = 2.0 * 1.6 / (STEPS * STEPS) as f64;
        let seen = radiance(uv);
        (0..3).for_each(|c| sum[c] += 0.5 / std::f64::consts::PI * seen[c] * form * area);
    }
    sum
}

#[test]
fn a_lamp_that_shows_an_image_lights_a_floor_as_its_texels_say() {
    let folder = tempfile::tempdir().unwrap();
    write_lamp(folder.path());
    for model in ["\"rgb\"", "{ bands = 16 }", "\"hero\""] {
        let scene = scene_in(folder.path(), &floor(model));
        let expected = expected(&scene, &plan(&scene).method.basis);
        if model == "\"rgb\"" {
            // The three numbers are those in the file, times two.
            let by_texels = floor_color(|uv| color(uv).map(|x| 2.0 * x));
            assert!((0..3).all(|c| (expected[c] / by_texels[c] - 1.0).abs() < 1e-5), "{expected:?} for {by_texels:?}");
        }
        let mean = mean(&scene);
        let error = mean.worst_relative_error(expected);
        assert!(error < 0.01, "{model}: noise {error}");
        // The floor is not a point: over 0.01 to each side the form factor changes by 1e-4, with the square of the
        // distance.
        let bias = 2e-4;
        for (c, &expected) in expected.iter().enumerate() {
            let (off, limit) = ((mean.value[c] - expected).abs(), 3.5 * mean.error[c] + bias * expected);
            assert!(off <= limit, "{model}, channel {c}: {} +- {} for {expected}", mean.value[c], mean.error[c]);
        }
    }
}

/// A lamp whose image has a dark and a bright half shines like the bright half alone.
#[test]
fn a_checkered_lamp_shines_like_its_two_halves() {
    let floor_mean = |lamps: &str| {
        let text = floor("\"rgb\"").replace(
            LAMP,
            "emissive = { radiance = { checker = [0, { rgb = [3, 2, 1] }], repeat = [2, 1], scale = 2 } }",
        );
        let text = match lamps {
            "" => text,
            _ => text
                .replace("{ checker = [0, { rgb = [3, 2, 1] }], repeat = [2, 1], scale = 2 }", lamps)
                .replace("center = [0.2, 1, 0.1], u = [1, 0, 0]", "center = [0.7, 1, 0.1], u = [0.5, 0, 0]"),
        };
        mean(&scene(&text))
    };
    let (checker, half) = (floor_mean(""), floor_mean("{ rgb = [6, 4, 2] }"));
    for c in 0..3 {
        let error = checker.with_joint_error(&half).error[c];
        assert!(error < 0.01 * half.value[c], "noise {error}");
        let off = (checker.value[c] - half.value[c]).abs();
        assert!(off <= 3.5 * error + 1e-6, "channel {c}: {} for {}", checker.value[c], half.value[c]);
    }
}

/// A sphere that is turned and stretched shows its image at the transformed points.
#[test]
fn an_image_turns_with_its_sphere() {
    let folder = tempfile::tempdir().unwrap();
    write_lamp(folder.path());
    for (direction, stretch) in [([0.1, 0.2, 1.0], 1.0), ([-0.7, 0.3, 0.4], 1.0), ([0.6, -0.5, 0.7], 2.5)] {
        let own = DVec3::from(direction).normalize();
        // First stretched along y, then turned by a quarter about z: x becomes y, and y becomes -x.
        let stretched = DVec3::new(own.x, stretch * own.y, own.z);
        let point = DVec3::new(-stretched.y, stretched.x, stretched.z);
        let camera = point + DVec3::new(point.x / (stretch * stretch), point.y, point.z) * 0.5;
        let text = format!(
            "{}filter = \"center\"\n[render]\nmodel = \"rgb\"\n[material.lamp]\n{LAMP}\n\
             [[object]]\nshape.sphere = {{ center = [0, 0, 0], radius = 1 }}\nmaterial = \"lamp\"\n\
             transform = [{{ scale = [1, {stretch:?}, 1] }}, {{ rotate = {{ axis = [0, 0, 1], degrees = 90 }} }}]\n",
            view(camera.into(), point.into(), 1.0, 1)
        );
        let found = film(&scene_in(folder.path(), &text)).pixels[0].rgb;
        let uv = [0.5 + own.x.atan2(own.z) / std::f64::consts::TAU, 0.5 + own.y.asin() / std::f64::consts::PI];
        let expected = color(uv).map(|x| 2.0 * x);
        for c in 0..3 {
            let off = (f64::from(found[c]) - expected[c]).abs();
            assert!(off < 1e-5 * (1.0 + expected[c]), "{direction:?}: {found:?} for {expected:?}");
        }
    }
}

/// A lamp above the small white floor, of which one texel of 256 x 256 shines. `place` returns the point at (u, v), and
/// the normal there times the area that stands for a unit of the image.
struct OneTexel {
    shape: &'static str,
    texel: [usize; 2],
    place: fn([f64; 2]) -> [DVec3; 2],
}

const ONE_TEXEL: [OneTexel; 5] = [
    OneTexel {
        shape: "quad = { center = [0.2, 1, 0.1], u = [1, 0, 0], v = [0, 0, 0.8] }",
        texel: [40, 200],
        place: |[u, v]| [DVec3::new(2.0 * u - 0.8, 1.0, 1.6 * v - 0.7), DVec3::new(0.0, -3.2, 0.0)],
    },
    OneTexel {
        shape: "mesh = { points = [[-0.8, 1, -0.7], [1.2, 1, -0.7], [1.2, 1, 0.9], [-0.8, 1, 0.9]], \
                faces = [[0, 1, 2], [0, 2, 3]], uv = [[0, 0], [1, 0], [1, 1], [0, 1]] }",
        texel: [40, 200],
        place: |[u, v]| [DVec3::new(2.0 * u - 0.8, 1.0, 1.6 * v - 0.7), DVec3::new(0.0, -3.2, 0.0)],
    },
    OneTexel {
        shape: "disc = { center = [0.2, 1, 0.1], normal = [0, -1, 0], radius = 0.9, u = [1, 0, 0] }",
        texel: [70, 90],
        place: |[u, v]| [DVec3::new(1.8 * u - 0.7, 1.0, 1.8 * v - 0.8), DVec3::new(0.0, -3.24, 0.0)],
    },
    OneTexel {
        shape: "cube = { center = [0.2, 1.5, 0.1], size = 1 }",
        texel: [70, 90],
        place: |[u, v]| [DVec3::new(u - 0.3, 1.0, v - 0.4), DVec3::new(0.0, -1.0, 0.0)],
    },
    OneTexel {
        shape: "sphere = { center = [0.2, 1.5, 0.1], radius = 0.5 }",
        texel: [100, 230],
        place: |[u, v]| {
            let (longitude, latitude) = (std::f64::consts::TAU * (u - 0.5), std::f64::consts::PI * (v - 0.5));
            let (across, up) = (libm::cos(latitude), libm::sin(latitude));
            let normal = DVec3::new(across * libm::sin(longitude), up, across * libm::cos(longitude));
            let area = 0.25 * std::f64::consts::TAU * std::f64::consts::PI * across;
            [DVec3::new(0.2, 1.5, 0.1) + normal * 0.5, normal * area]
        },
    },
];

impl OneTexel {
    /// Returns the radiance of a white floor of reflectance 1/2 at the origin, under a radiance of 1.
    fn expected(&self) -> f64 {
        const STEPS: usize = 20;
        let mut sum = 0.0;
        for (i, j) in (0..STEPS).flat_map(|i| (0..STEPS).map(move |j| (i, j))) {
            let within = [i, j].map(|i| (i as f64 + 0.5) / STEPS as f64);
            let u = (self.texel[0] as f64 + within[0]) / 256.0;
            let v = 1.0 - (self.texel[1] as f64 + within[1]) / 256.0;
            let [point, normal] = (self.place)([u, v]);
            let squared = point.length_squared();
            sum += (-normal.dot(point)).max(0.0) * point.y / (squared * squared);
        }
        0.5 / std::f64::consts::PI * sum / (STEPS * STEPS) as f64 / (256.0 * 256.0)
    }
}

/// With uniform sampling, all but one of 65,536 samples would hit the lamp where it is dark.
#[test]
fn l10_one_bright_texel_of_a_lamp_is_found() {
    for lamp in ONE_TEXEL {
        let folder = tempfile::tempdir().unwrap();
        let bright = |x: usize, y: usize| if [x, y] == lamp.texel { (1e6, 1e6, 1e6) } else { (0.0, 0.0, 0.0) };
        exr::prelude::write_rgb_file(folder.path().join("lamp.exr"), 256, 256, bright).unwrap();
        let quad = "quad = { center = [0.2, 1, 0.1], u = [1, 0, 0], v = [0, 0, 0.8] }";
        let text = floor("\"rgb\"").replace(LAMP, &LAMP.replace("wrap = \"clamp\"", "filter = \"nearest\""));
        let scene = scene_in(folder.path(), &text.replace(quad, lamp.shape));
        let (mean, expected) = (mean(&scene), 2e6 * lamp.expected());
        let error = mean.worst_relative_error([expected; 3]);
        println!("{}: {} +- {} for {expected}", lamp.shape, mean.value[0], mean.error[0]);
        assert!(error < 0.01, "{}: noise {error}", lamp.shape);
        // The floor is not a point, and the texel is not near the horizon of any of its points.
        let off = (mean.value[0] - expected).abs();
        assert!(off <= 3.5 * mean.error[0] + 2e-4 * expected, "{}: {} for {expected}", lamp.shape, mean.value[0]);
    }
}

/// Neither a million repeats nor mesh coordinates that are far apart take unlimited memory or time.
#[test]
fn patterns_too_fine_to_be_told_apart_shine_like_their_mean() {
    let fine = "emissive = { radiance = { checker = [0, { rgb = [3, 2, 1] }], repeat = [1e6, 1e6], scale = 2 } }";
    let mesh = "mesh = { points = [[-0.8, 1, -0.7], [1.2, 1, -0.7], [1.2, 1, 0.9], [-0.8, 1, 0.9]], \
                faces = [[0, 1, 2], [0, 2, 3]], uv = [[0, 0], [1e30, 0], [1e30, -1e25], [0, 1e9]] }";
    let quad = "quad = { center = [0.2, 1, 0.1], u = [1, 0, 0], v = [0, 0, 0.8] }";
    let floor_mean = |lamp: &str, shape: &str| {
        let scene = scene(&floor("\"rgb\"").replace(LAMP, lamp).replace(quad, shape));
        let method = Method { transport: SPLITTING, ..plan(&scene).method };
        mean_color(&film_of(&scene, method))[0]
    };
    let even = floor_mean("emissive = { radiance = { rgb = [3, 2, 1] } }", quad);
    let (quad_mean, mesh_mean) = (floor_mean(fine, quad), floor_mean(fine, mesh));
    println!("{quad_mean} and {mesh_mean} for {even}");
    // At the ends of the number range, a pattern no longer is what was written. On the mesh it is still light.
    assert!((quad_mean / even - 1.0).abs() < 0.1 && mesh_mean >= 0.0 && mesh_mean < 2.0 * even);
}
