//! Rows D1 to D5: a single interface, compared with results of 31 digits.

use std::f64::consts::FRAC_PI_2;

use abbe::material::{Branch, Index, Interface, Material, Scatter, ScatterContext};
use abbe::math::{DVec3, UNIT_ROUNDOFF};
use abbe::spectrum::{Draw, Lanes, Table};

use crate::support::exact::Exact;
use crate::support::larger::larger;
use crate::support::materials::{context, material};
use crate::support::random::Random;
use crate::support::scenes::{EVERY_BRANCH, body, environment, render_film, view};

/// Returns reflectance and transmittance with 31 digits, from the same rounded inputs.
fn truth(n1: f64, n2: f64, c1: f64) -> (Exact, Exact) {
    let [n1, n2, c1, one] = [n1, n2, c1, 1.0].map(Exact::from);
    let eta = n1 / n2;
    let c2_squared = one - eta * eta * (one - c1) * (one + c1);
    if c2_squared <= Exact::ZERO {
        return (one, Exact::ZERO);
    }
    let c2 = c2_squared.sqrt();
    let (s, p) = (n1 * c1 + n2 * c2, n2 * c1 + n1 * c2);
    let (r_s, r_p) = ((n1 * c1 - n2 * c2) / s, (n2 * c1 - n1 * c2) / p);
    let two = Exact::from(2.0);
    let transmittance = two * n1 * n2 * c1 * c2 * (one / (s * s) + one / (p * p));
    ((r_s * r_s + r_p * r_p) / two, transmittance)
}

fn difference(computed: f64, exact: Exact) -> f64 {
    (Exact::from(computed) - exact).abs().rounded()
}

/// Returns pairs of indices from nearly equal to diamond, in both orders.
fn index_pairs() -> Vec<(f64, f64)> {
    let mut pairs = vec![(1.0, 1.000_000_1), (1.0, 1.1), (1.0, 1.333), (1.333, 1.5168), (1.0, 1.5), (1.0, 2.42)];
    pairs.extend(pairs.clone().iter().map(|&(a, b)| (b, a)));
    pairs
}

#[test]
fn d1_reflectance_is_right_and_continuous_through_the_critical_angle() {
    let mut worst = 0f64;
    for (n1, n2) in index_pairs().into_iter().filter(|(n1, n2)| n1 > n2) {
        let critical = libm::asin(n2 / n1);
        for power in 1..=16 {
            for side in [-1.0, 1.0] {
                let angle = critical * (1.0 + side * libm::pow(10.0, -f64::from(power)));
                let cosine = libm::cos(angle.min(FRAC_PI_2));
                let found = Interface::new(n1, n2, cosine);
                assert!(found.cos_beyond >= 0.0 && found.transmittance >= 0.0, "{n1} to {n2}: {found:?}");
                worst = larger(worst, difference(found.reflectance, truth(n1, n2, cosine).0));
            }
        }
        // Neighboring floating-point numbers on both sides of the angle.
        let exact = ((n1 - n2) * (n1 + n2)).sqrt() / n1;
        let mut cosine = (0..200).fold(exact, |c: f64, _| c.next_up());
        let mut before = Interface::new(n1, n2, cosine).reflectance;
        for _ in 0..400 {
            cosine = cosine.next_down();
            let next = Interface::new(n1, n2, cosine).reflectance;
            assert!((next - before).abs() <= 1e-6, "{n1} to {n2}: a step from {before} to {next}");
            before = next;
        }
        assert_eq!(before, 1.0);
    }
    println!("D1: reflectance off by at most {worst:.1e}");
    assert!(worst <= 1e-6, "off by {worst:e}");
}

#[test]
fn d1_no_branch_is_nan_at_the_critical_angle() {
    let glass = material("dielectric = { index = 1.5 }");
    let mut random = Random::new(1);
    let critical = libm::asin(1.0 / 1.5);
    for _ in 0..20_000 {
        let normal = random.direction();
        let across = normal.cross(random.direction()).normalize();
        let angle = critical * (1.0 + random.between(-1.0, 1.0) * libm::pow(10.0, random.between(-17.0, 0.0)));
        let (sin, cos) = libm::sincos(angle.clamp(0.0, FRAC_PI_2));
        let wo = (normal * cos + across * sin).normalize();
        let branches = branches(&glass, wo, normal, 1.5, 1.0);
        assert!((1..=2).contains(&branches.len()));
        for branch in branches {
            assert!(branch.wi.is_finite() && branch.eta_scale.is_finite(), "{branch:?}");
            assert!(branch.share.0.iter().all(|share| (0.0..=1.0 / 0.44).contains(share)), "{branch:?}");
        }
    }
}

#[test]
fn between_equal_indices_nothing_happens_even_along_the_surface() {
    let mut random = Random::new(22);
    for _ in 0..10_000 {
        let (n, wo) = (random.between(1.0, 3.0), random.direction());
        let cosine = wo.z.abs();
        for (cosine, index) in [(cosine, n), (0.0, n), (1e-200, n), (1.0, 1.0)] {
            let found = Interface::new(index, index, cosine);
            assert_eq!([found.reflectance, found.transmittance, found.cos_beyond], [0.0, 1.0, cosine]);
            assert_eq!([found.polarization_reflected, found.polarization_refracted], [0.0; 2]);
        }
    }
}

#[test]
fn d2_reflectance_at_normal_incidence_is_right_within_4_roundings() {
    let mut random = Random::new(2);
    let mut pairs = index_pairs();
    pairs.extend((0..10_000).map(|_| (random.between(1.0, 3.0), random.between(1.0, 3.0))));
    let (mut absolute, mut beyond_one) = (0f64, 0);
    for (n1, n2) in pairs {
        let [a, b] = [n1, n2].map(Exact::from);
        let r = (a - b) / (a + b);
        let found = Interface::new(n1, n2, 1.0);
        absolute = larger(absolute, difference(found.reflectance, r * r));
        // The dot product of two unit vectors may exceed 1 by a few roundings.
        let d = random.direction();
        beyond_one += usize::from(d.dot(d) > 1.0);
        for cosine in [d.dot(d), 1.0 + 2.0 * UNIT_ROUNDOFF, 1.0 + 4.0 * UNIT_ROUNDOFF] {
            let near = Interface::new(n1, n2, cosine);
            assert!((near.reflectance - found.reflectance).abs() <= 4.0 * UNIT_ROUNDOFF, "{n1} to {n2}: {near:?}");
            let refracted = near.refract(d, d);
            assert!((refracted + d).length() <= 1e-7, "{n1} to {n2}: bent from {d} to {refracted}");
        }
    }
    assert!(beyond_one > 100, "only {beyond_one} dot products exceed 1");
    println!("D2: reflectance off by at most {:.2} u", absolute / UNIT_ROUNDOFF);
    assert!(absolute <= 4.0 * UNIT_ROUNDOFF, "off by {} u", absolute / UNIT_ROUNDOFF);
}

#[test]
fn d3_transmittance_keeps_14_digits_at_grazing_angles() {
    let mut worst = 0f64;
    for (n1, n2) in index_pairs().into_iter().filter(|(n1, n2)| n1 < n2) {
        for step in 0..400 {
            let cosine = libm::pow(10.0, -0.1 * f64::from(step));
            let exact = truth(n1, n2, cosine).1;
            let off = difference(Interface::new(n1, n2, cosine).transmittance, exact) / exact.rounded();
            assert!(off <= 1e-14, "{n1} to {n2} at {cosine:e}: relative error {off:e}");
            worst = larger(worst, off);
        }
    }
    println!("D3: transmittance off by at most {worst:.1e} of itself");
}

#[test]
fn d3_reflectance_and_transmittance_sum_to_1_within_4_roundings() {
    let mut random = Random::new(3);
    let (mut worst, mut at) = (0f64, (0.0, 0.0, 0.0));
    let mut check = |n1: f64, n2: f64, cosine: f64| {
        let found = Interface::new(n1, n2, cosine);
        let off = difference(found.reflectance, Exact::from(1.0) - Exact::from(found.transmittance));
        if off > worst {
            (worst, at) = (off, (n1, n2, cosine));
        }
    };
    for (n1, n2) in index_pairs() {
        (0..20_000).for_each(|_| check(n1, n2, random.number()));
        (0..300).for_each(|step| check(n1, n2, libm::pow(10.0, -0.1 * f64::from(step))));
        let critical = libm::sqrt((1.0 - (n2 / n1) * (n2 / n1)).max(0.0));
        (0..2000).for_each(|_| check(n1, n2, critical * (1.0 + libm::pow(10.0, random.between(-17.0, -1.0)))));
    }
    println!("D3: sum off by at most {:.2} u, at {at:?}", worst / UNIT_ROUNDOFF);
    assert!(worst <= 4.0 * UNIT_ROUNDOFF, "off by {} u at {at:?}", worst / UNIT_ROUNDOFF);
}

#[test]
fn d4_light_crosses_between_equal_indices_with_every_bit_of_its_direction() {
    let glass = material("dielectric = { index = 1.5 }");
    let mut random = Random::new(4);
    for step in 0..10_000 {
        let normal = random.direction();
        let across = normal.cross(random.direction()).normalize();
        let cosine = if step % 2 == 0 { random.number() } else { libm::pow(10.0, random.between(-300.0, 0.0)) };
        let wo = (normal * cosine + across * (1.0 - cosine * cosine).sqrt()).normalize();
        let branches = branches(&glass, wo, normal, 1.5, 1.5);
        let [only] = branches[..] else { panic!("{} branches", branches.len()) };
        assert_eq!(only.wi, -wo);
        assert_eq!((only.share, only.eta_scale, only.crosses), (Lanes([1.0, 1.0, 1.0, 0.0]), 1.0, true));
    }
}

#[test]
fn d4_an_index_matched_body_is_invisible_to_the_bit() {
    let lamps: String = (0..12)
        .map(|i| {
            let (x, y) = (f64::from(i % 4) - 1.5, f64::from(i / 4) - 1.0);
            let rgb = format!("{{ rgb = [{}, {}, {}] }}", 1 + i, 2 * i, 12 - i);
            let quad = format!("quad = {{ center = [{x}, {y}, -3], u = [0.47, 0.02, 0], v = [0.03, 0.46, 0.1] }}");
            body(&format!("lamp{i}"), &format!("emissive = {{ radiance = {rgb} }}"), &[&quad])
        })
        .collect();
    let mirror = body("silver", "mirror = {}", &["sphere = { center = [0.3, 0.2, -1.4], radius = 0.5 }"]);
    let block =
        body("block", "dielectric = { index = 1.5, priority = 1 }", &["cube = { center = [-0.9, 0, -1], size = 1.1 }"]);
    let backdrop = format!("{}{lamps}{mirror}{block}{}", view([0.2, 0.3, 6.0], [0.0; 3], 35.0, 80), environment(0.25));
    let shapes = [
        "sphere = { center = [0.2, 0.1, 0], radius = 1.2 }",
        "cube = { center = [0.1, 0, 0.5], size = [2, 1.5, 0.7] }",
        "mesh = { points = [[-1, -1, 1], [1, -1, 1], [0, 1.2, 1], [0, 0, 0.3]], \
         faces = [[0, 1, 2], [0, 3, 1], [1, 3, 2], [2, 3, 0]] }",
    ];
    let ellipsoid = "[[object]]\nshape.sphere = { center = [0, 0, 0], radius = 1 }\nmaterial = \"air\"\n\
                     transform = [{ scale = [1.4, 0.7, 0.5] }, { rotate = { axis = [0, 0, 1], degrees = 20 } }]\n";
    let (empty, _) = render_film(&backdrop, EVERY_BRANCH);
    assert!(empty.pixels.iter().any(|pixel| pixel.rgb[0] > 5.0), "the backdrop shows nothing");
    let inside_block =
        body("core", "dielectric = { index = 1.5 }", &["sphere = { center = [-0.9, 0, -1], radius = 0.5 }"]);
    let air = |shapes: &[&str]| body("air", "dielectric = { index = 1 }", shapes);
    for added in [air(&shapes), format!("{}{ellipsoid}", air(&[])), inside_block] {
        let (film, report) = render_film(&format!("{backdrop}{added}"), EVERY_BRANCH);
        assert_eq!(report.unmatched, 0);
        for (at, (with, without)) in film.pixels.iter().zip(&empty.pixels).enumerate() {
            assert_eq!(with.rgb.map(f32::to_bits), without.rgb.map(f32::to_bits), "pixel {at} with {added}");
        }
    }
}

#[test]
fn d5_the_mean_reflectance_of_diffuse_light_is_exact() {
    let mean = |n1: f64, n2: f64| {
        const STEPS: u32 = 1_000_000;
        // 2 c dc = d(c^2), so the mean is uniform over the squared cosine.
        let cosine = |step: u32| ((f64::from(step) + 0.5) / f64::from(STEPS)).sqrt();
        (0..STEPS).map(|step| Interface::new(n1, n2, cosine(step)).reflectance).sum::<f64>() / f64::from(STEPS)
    };
    for (n, outside) in [(1.5, 0.091_778_0), (1.333, 0.066_406)] {
        // In equilibrium, the light that enters through a surface leaves it again: 1 - R_inside = (1 - R_outside) /
        // n^2.
        for (found, expected) in [(mean(1.0, n), outside), (mean(n, 1.0), 1.0 - (1.0 - outside) / (n * n))] {
            assert!((found - expected).abs() <= 1e-6, "index {n}: {found} for {expected}");
        }
    }
}

#[test]
fn the_reference_agrees_with_brewster() {
    // At tan = n = 3 / 2 only s is reflected: R = ((n^2 - 1) / (n^2 + 1))^2 / 2.
    let (reflectance, transmittance) = truth(1.0, 1.5, 1.0 / 3.25f64.sqrt());
    assert!(difference(25.0 / 338.0, reflectance) < 1e-15);
    assert!((reflectance + transmittance - Exact::from(1.0)).abs().rounded() < 1e-30);
}

fn branches(material: &Material<Table>, wo: DVec3, normal: DVec3, incident: f64, beyond: f64) -> Vec<Branch<4>> {
    let draw = Draw::<4>::fixed(3);
    let context = ScatterContext { normal, beyond: Index::Same(beyond), ..context(&draw, wo, incident) };
    let mut branches = Vec::new();
    material.scatter(&context, [0.5; 2], &mut branches);
    branches
}
