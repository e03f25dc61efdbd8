//! Photons that are splatted where shading normals are bent: they contribute the same as direct light.

use abbe::math::DVec3;
use abbe::trace::{LightPass, Method, Polarizing, Smoothness, prepare, render};

use crate::polarization::stokes_vectors;
use crate::support::scenes::{SPLITTING, assert_near, body, method, quad, scene};

/// A triangle of some material with a tilted normal, whose S0 to S3 a camera sees.
struct TiltedTriangle {
    camera: String,
    material: &'static str,
}

/// The direction from which light reaches the triangle, and the tables of what it passes on the way.
struct Beam {
    toward: DVec3,
    sheets: String,
}

/// Returns a square perpendicular to a direction, with sides of twice `half`.
fn square_across(center: DVec3, direction: DVec3, half: f64) -> String {
    let u = direction.cross(DVec3::Z).normalize();
    quad(center, u * half, direction.cross(u) * half)
}

fn sun(toward: DVec3) -> String {
    let DVec3 { x, y, z } = toward;
    format!("[[light]]\nsun = {{ toward = [{x:?}, {y:?}, {z:?}], angular_diameter = 0, irradiance = 1 }}\n")
}

/// Returns a perfect mirror and a sun whose light it sends to the triangle from the direction `toward`. The sun is
/// below the triangle.
fn mirrored_sun(toward: DVec3) -> String {
    let below = DVec3::new(-toward.y, toward.x, -0.5).normalize();
    body("mirror", "mirror = {}", &[&square_across(toward * 2.0, (below - toward).normalize(), 0.6)]) + &sun(below)
}

impl TiltedTriangle {
    /// Returns the Stokes vector relative to the S0 of the same render with light treated as unpolarized. All photons
    /// carry the same flux.
    fn stokes(&self, rest: &str, light_pass: Option<&LightPass>) -> [f64; 4] {
        let Self { camera, material } = self;
        let tilt = DVec3::new(0.4_f64.sin() * 0.8, 0.4_f64.sin() * 0.6, 0.4_f64.cos());
        let normal = format!("[{:?}, {:?}, {:?}]", tilt.x, tilt.y, tilt.z);
        let mesh = format!(
            "mesh = {{ points = [[-1, -1, 0], [1, -1, 0], [0, 1, 0]], faces = [[0, 1, 2]], \
             normals = [{normal}, {normal}, {normal}] }}"
        );
        let render_polarized = |polarization: Polarizing, stokes: &str| {
            let text =
                format!("camera = {{ {camera} }}\nfilm = {{ width = 1, height = 1, filter = \"box\"{stokes} }}\n")
                    + &body("rough", material, &[&mesh])
                    + rest;
            let scene = scene(&text);
            let light_pass = light_pass.cloned();
            let method =
                Method { samples: 4, polarization, light_pass, diffuse_bounces: 1, ..method(&scene, SPLITTING) };
            render(&prepare(&scene, method), &|_| ()).0
        };
        let averaged = f64::from(render_polarized(Polarizing::Averaged, "").pixels[0].rgb[1]);
        assert!(averaged > 1e-6, "{camera}, {material}: {averaged}");
        stokes_vectors(&render_polarized(Polarizing::Traced, ", stokes = true")).map(|part| part[1] / averaged)
    }

    fn assert_photons_bring(&self, Beam { toward, sheets }: &Beam) {
        let photons =
            LightPass { photons: 1000, lights: vec![0], openings: Vec::new(), to: Smoothness::ALL.to_vec(), map: None };
        let expected = self.stokes(&(sheets.clone() + &sun(*toward)), None);
        let found = self.stokes(&(sheets.clone() + &mirrored_sun(*toward)), Some(&photons));
        let what = format!("{} seen by {}, from {toward}", self.material, self.camera);
        assert_near(found, expected, 1e-5, &what);
    }
}

/// Photons that a mirror sends to a rough surface are polarized there in the same way as the light of a sun.
#[test]
fn photons_on_bent_normals_are_polarized_as_a_sun_is() {
    let above = "position = [0, 0, 5], look_at = [0, 0, 0], projection = \"orthographic\", height = 0.4";
    let low = "position = [-4.8, 0.5, 1.2], look_at = [0, 0, 0], up = [0, 0, 1], projection = \"orthographic\", \
               height = 0.2";
    for material in
        ["conductor = { n = 0.43, k = 2.455, roughness = 0.7 }", "plastic = { reflectance = 0.4, roughness = 0.8 }"]
    {
        for camera in [above, low] {
            for filter in ["", ", polarizer = { axis = 30 }"] {
                let seen = TiltedTriangle { camera: format!("{camera}{filter}"), material };
                for toward in [[0.9, 0.3, 0.15], [0.5, 0.9, 0.2], [0.9, -0.2, 0.3], [-0.7, -0.2, 0.4]] {
                    let toward = DVec3::from(toward).normalize();
                    let axis = (toward.cross(DVec3::Z).normalize() + DVec3::Z * 0.7).normalize();
                    let axis = format!("axis = [{:?}, {:?}, {:?}]", axis.x, axis.y, axis.z);
                    let plain = String::new();
                    let linear = body(
                        "linear",
                        &format!("polarizer = {{ {axis} }}"),
                        &[&square_across(toward * 1.3, toward, 0.8)],
                    );
                    let retarder = "retarder = { axis = [0, 0, 1], retardance = 70 }";
                    let elliptic =
                        linear.clone() + &body("retarder", retarder, &[&square_across(toward * 1.2, toward, 0.8)]);
                    for sheets in [plain, linear, elliptic] {
                        seen.assert_photons_bring(&Beam { toward, sheets });
                    }
                }
            }
        }
    }
}

/// Returns a floor between a board and a wall of rough metal with bent normals, and a lamp in front of the wall.
fn floor_beside_bent_wall() -> String {
    let wall = "mesh = { points = [[0, -2, 0], [0, 2, 0], [0, 2, 2], [0, -2, 2]], faces = [[0, 1, 2], [0, 2, 3]], \
                normals = [[0.4, -0.7, -0.5], [0.4, 0.7, -0.5], [0.4, 0.7, 0.5], [0.4, -0.7, 0.5]] }";
    "camera = { position = [1, 0, 9], look_at = [1, 0, 0], projection = \"orthographic\", height = 2 }\n\
     film = { width = 8, height = 8 }\n"
        .to_owned()
        + &body(
            "floor",
            "diffuse = { reflectance = 0.5 }",
            &[
                "quad = { center = [1, 0, 0], u = [1, 0, 0], v = [0, 1, 0] }",
                "quad = { center = [2, 0, 1], u = [0, 3, 0], v = [0, 0, 3] }",
            ],
        )
        + &body("wall", "conductor = { n = 2, k = 4.8, roughness = 0.6 }", &[wall])
        + &body("lamp", "emissive = { radiance = 10 }", &["sphere = { center = [0.3, 0, 1], radius = 0.1 }"])
}

/// The wall polarizes unpolarized light, to which diffuse surfaces are insensitive.
#[test]
fn light_paths_over_bent_normals_are_as_bright_as_without_polarization() {
    let scene = scene(&floor_beside_bent_wall());
    let render_polarized = |polarization, light_vertices| {
        let method =
            Method { samples: 16, polarization, light_vertices, diffuse_bounces: 3, ..method(&scene, SPLITTING) };
        let film = render(&prepare(&scene, method), &|_| ()).0;
        film.pixels.iter().map(|pixel| f64::from(pixel.rgb[1])).collect::<Vec<_>>()
    };
    let [averaged, traced] =
        [Polarizing::Averaged, Polarizing::Traced].map(|polarization| render_polarized(polarization, true));
    assert!(averaged != render_polarized(Polarizing::Averaged, false), "light paths did something");
    for (averaged, traced) in averaged.iter().zip(&traced) {
        assert!((averaged - traced).abs() <= 1e-5 * averaged, "{traced} for {averaged}");
    }
}
