//! Rows S5, D7 and D8: directions stay unit vectors, as the formulas for spheres and Fresnel's equations assume.

use abbe::material::{Index, Interface, Scatter, ScatterContext, reflect};
use abbe::math::{DVec2, DVec3, UNIT_ROUNDOFF};
use abbe::shape::SurfacePoint;
use abbe::spectrum::{Draw, Table};
use abbe::trace::prepare;

use crate::support::exact::{Exact, ExactVector};
use crate::support::larger::larger;
use crate::support::materials::context;
use crate::support::random::Random;
use crate::support::scenes::{EVERY_BRANCH, body, method, scene, view};

/// Returns how far a vector's length is from 1, in units of rounding.
fn off_unit(direction: DVec3) -> f64 {
    (ExactVector::from(direction).length() - Exact::from(1.0)).abs().rounded() / UNIT_ROUNDOFF
}

/// Returns a unit normal at an acute angle to a direction.
fn normal_toward(direction: DVec3, random: &mut Random) -> DVec3 {
    let normal = random.direction().normalize();
    if normal.dot(direction) < 0.0 { -normal } else { normal }
}

#[test]
fn d7_a_thousand_refractions_do_not_drift() {
    let mut random = Random::new(7);
    let mut worst = 0f64;
    for _ in 0..20 {
        let mut wo = random.direction().normalize();
        for step in 0..1000 {
            let normal = normal_toward(wo, &mut random);
            let (n1, n2) = if step % 2 == 0 { (1.0, 1.5) } else { (1.5, 1.0) };
            let interface = Interface::new(n1, n2, wo.dot(normal));
            wo = if interface.transmittance > 0.0 { -interface.refract(wo, normal) } else { -reflect(wo, normal) };
            worst = larger(worst, off_unit(wo));
        }
    }
    println!("D7: off by at most {worst:.2} u");
    assert!(worst <= 2.0, "off by {worst} u");
}

#[test]
fn d8_a_thousand_reflections_do_not_drift() {
    let mut random = Random::new(8);
    let mut worst = 0f64;
    for _ in 0..20 {
        let mut wo = random.direction().normalize();
        for _ in 0..1000 {
            wo = -reflect(wo, normal_toward(wo, &mut random));
            worst = larger(worst, off_unit(wo));
        }
    }
    println!("D8: off by at most {worst:.2} u");
    assert!(worst <= 2.0, "off by {worst} u");
}

#[test]
fn s5_every_material_sends_light_on_along_unit_vectors() {
    let ball = "sphere = { center = [0, 0, 0], radius = 1 }";
    let materials = [
        ("matte", "diffuse = { reflectance = 0.5 }"),
        ("silver", "mirror = {}"),
        ("gold", "conductor = { metal = \"Au\" }"),
        ("flint", "dielectric = { index = { rgb = [1.7, 1.73, 1.79] } }"),
    ];
    let bodies: String = materials.iter().map(|(name, material)| body(name, material, &[ball])).collect();
    let scene = scene(&format!("{}{bodies}", view([0.0, 0.0, 5.0], [0.0; 3], 30.0, 1)));
    let world = prepare(&scene, method(&scene, EVERY_BRANCH));
    let (draw, inside) = (Draw::<4>::fixed(3), Table::new([1.7, 1.73, 1.79, 1.0]));
    let mut random = Random::new(5);
    for object in 0..materials.len() as u32 {
        let (material, mut worst, mut branches) = (world.scene().material_of(object), 0f64, Vec::new());
        for _ in 0..20_000 {
            let wo = random.direction().normalize();
            let normal = normal_toward(wo, &mut random);
            let context = ScatterContext { normal, incident: Index::Own(&inside), ..context(&draw, wo, 1.0) };
            material.scatter(&context, random.pair(), &mut branches);
            assert!(!branches.is_empty());
            worst = branches.drain(..).map(|branch| off_unit(branch.wi)).fold(worst, larger);
        }
        println!("S5: {} off by at most {worst:.2} u", materials[object as usize].0);
        assert!(worst <= 2.0, "{} off by {worst} u", materials[object as usize].0);
    }
}

#[test]
fn s5_camera_rays_and_rays_to_lights_run_along_unit_vectors() {
    let lamp = "emissive = { radiance = 1 }";
    let shapes = [
        "sphere = { center = [2, 3, 1], radius = 0.7 }",
        "disc = { center = [2, 3, 1], normal = [1, 2, 3], radius = 0.7 }",
        "quad = { center = [2, 3, 1], u = [1, 0, 0.3], v = [0, 1, 0.1] }",
        "cube = { center = [2, 3, 1], size = [1, 2, 0.5] }",
        "triangle = { points = [[2, 3, 1], [1, 4, 2], [0, 3, 3]] }",
    ];
    let lights = format!(
        "{}[[light]]\nenvironment = {{ radiance = 1 }}\n[[light]]\npoint = {{ position = [1, 2, 3], intensity = 1 }}\n",
        body("lamp", lamp, &shapes)
    );
    let scene = scene(&format!("{}{lights}", view([1.3, 0.2, 5.0], [0.1, 0.2, 0.3], 50.0, 300)));
    let mut random = Random::new(6);
    let mut worst = 0f64;
    for _ in 0..20_000 {
        let film = DVec2::from(random.pair()) * 300.0;
        worst = larger(worst, off_unit(scene.camera.ray(film).direction));
    }
    println!("S5: camera rays off by at most {worst:.2} u");
    assert!(worst <= 2.0, "camera rays off by {worst} u");
    // Rays to lights do not bounce again. An error in their length affects only that length.
    for (number, light) in scene.lights.iter().enumerate() {
        let mut worst = 0f64;
        for _ in 0..20_000 {
            let from = SurfacePoint::in_space(random.direction() * random.between(0.1, 50.0));
            if let Some(sample) = light.sample_li(&from, random.direction().normalize(), random.pair()) {
                worst = larger(worst, off_unit(sample.ray.direction));
            }
        }
        println!("S5: rays to light {number} off by at most {worst:.2} u");
        assert!(worst <= 4.0, "rays to light {number} off by {worst} u");
    }
}
