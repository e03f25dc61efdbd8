//! Chains of filters, mirrors, metals and panes between the camera and a lamp: what the plan and the render state about
//! color and polarization holds.

use abbe::math::DVec3;
use abbe::plan::plan;
use abbe::scene::Scene;
use abbe::spectrum::{Basis, Curve, Draw, Emission, Lanes, MAX_LANES, Quantity, data, visible};
use abbe::trace::{Method, Polarizing, prepare, render};

use super::stokes::{Stokes, metal, mirror, pane, surface};
use crate::support::larger::larger;
use crate::support::random::Random;
use crate::support::scenes::{body, object, quad, scene, view};

/// A link of a chain.
#[derive(Clone)]
enum Link {
    /// A pane that light crosses, with its transmittance along the path.
    Filter(Vec<f64>),
    Mirror(Vec<f64>),
    Metal(&'static str),
    /// A metal with the same n and k in every lane.
    Plain([f64; 2]),
    IdealMirror,
    Through(f64),
    MirroredByPane(f64),
    MirroredByGlass(f64),
}

impl Link {
    fn transmits(&self) -> bool {
        matches!(self, Self::Filter(_) | Self::Through(_))
    }

    fn material(&self) -> String {
        let samples = |values: &[f64]| {
            let pairs: Vec<String> = visible::wavelengths().zip(values).map(|(nm, x)| format!("[{nm}, {x}]")).collect();
            format!("{{ samples = [{}] }}", pairs.join(", "))
        };
        match self {
            Self::Filter(values) => format!("thin = {{ index = 1.5, transmittance = {} }}", samples(values)),
            Self::Mirror(values) => format!("mirror = {{ reflectance = {} }}", samples(values)),
            Self::Metal(name) => format!("conductor = {{ metal = \"{name}\" }}"),
            Self::Plain([n, k]) => format!("conductor = {{ n = {n}, k = {k} }}"),
            Self::IdealMirror => "mirror = {}".into(),
            Self::Through(n) | Self::MirroredByPane(n) => format!("thin = {{ index = {n} }}"),
            Self::MirroredByGlass(n) => format!("dielectric = {{ index = {n}, absorption = 1000 }}"),
        }
    }
}

/// A link, the direction in which the camera's ray arrives, and the unit normal on that side.
struct Hit {
    link: Link,
    incoming: DVec3,
    normal: DVec3,
}

impl Hit {
    fn outgoing(&self) -> DVec3 {
        if self.link.transmits() {
            self.incoming
        } else {
            self.incoming - self.normal * (2.0 * self.incoming.dot(self.normal))
        }
    }

    fn cos(&self) -> f64 {
        -self.incoming.dot(self.normal)
    }
}

const STEP: f64 = 4.0;

/// Returns a chain of links and its scene. The links are hit at angles of up to `steepest` degrees, all in one plane or
/// turned at random.
fn chain(random: &mut Random, links: &[Link], steepest: f64, in_plane: bool) -> (Vec<Hit>, String) {
    loop {
        let (mut at, mut incoming) = (DVec3::ZERO, DVec3::new(0.0, 0.0, -1.0));
        let (mut places, mut hit) = (vec![at - incoming * STEP], Vec::new());
        for link in links {
            let around =
                if in_plane { DVec3::new(0.0, 1.0, 0.0).cross(incoming) } else { random.direction().cross(incoming) };
            let aside = around.try_normalize().unwrap_or(DVec3::new(1.0, 0.0, 0.0));
            let (sin, cos) = random.between(0.0, steepest).to_radians().sin_cos();
            let next = Hit { link: link.clone(), incoming, normal: aside * sin - incoming * cos };
            places.push(at);
            incoming = next.outgoing();
            at += incoming * STEP;
            hit.push(next);
        }
        places.push(at);
        if is_unblocked(&places) {
            let text = text(&hit, &places);
            return (hit, text);
        }
    }
}

/// Returns whether nothing blocks the path between two links.
fn is_unblocked(places: &[DVec3]) -> bool {
    let distance = |point: DVec3, a: DVec3, b: DVec3| {
        let along = ((point - a).dot(b - a) / (b - a).dot(b - a)).clamp(0.0, 1.0);
        (a + (b - a) * along - point).length()
    };
    places.iter().enumerate().all(|(number, &point)| {
        let others = places.windows(2).enumerate().filter(|(first, _)| *first != number && *first + 1 != number);
        others.into_iter().all(|(_, ends)| distance(point, ends[0], ends[1]) > 1.0)
    })
}

fn text(hit: &[Hit], places: &[DVec3]) -> String {
    let mut text = view(places[0].into(), [0.0; 3], 0.05, 4) + "filter = \"center\"\n";
    for (number, (hit, place)) in hit.iter().zip(&places[1..]).enumerate() {
        let u = hit.normal.cross(DVec3::new(0.3, 0.5, 0.81)).try_normalize().expect("not along it");
        let (u, v) = (u * 0.5, hit.normal.cross(u) * 0.5);
        text += &body(&format!("m{number}"), &hit.link.material(), &[&quad(*place, u, v)]);
    }
    let lamp = places[places.len() - 1].to_array();
    text + &object("lamp", &format!("sphere = {{ center = {lamp:?}, radius = 0.03 }}"))
}

/// Returns the transmittance of a filter or the reflectance of a mirror: a paint of the chart, or an edge like that of
/// colored glass.
fn tint(random: &mut Random) -> Vec<f64> {
    let patches: Vec<_> = data::reflectances().collect();
    let patch = patches[(random.number() * 24.0) as usize].clone();
    let (edge, width) = (random.between(450.0, 650.0), random.between(8.0, 60.0));
    let sign = if random.number() < 0.5 { 1.0 } else { -1.0 };
    let (low, high) = (random.between(0.01, 0.3), random.between(0.6, 0.95));
    let is_paint = random.number() < 0.5;
    let share_at = |nm: f64| match is_paint {
        true => (0.1 + patch.at(nm)).min(1.0),
        false => low + (high - low) / (1.0 + libm::exp(-sign * (nm - edge) / width)),
    };
    visible::wavelengths().map(share_at).collect()
}

/// Returns the light that is left after a chain, in steps of 1 nm or in the lanes of a basis.
fn remaining_light(hit: &[Hit], scene: &Scene<Curve>, basis: Option<&Basis>) -> Vec<f64> {
    use abbe::material::{Material, Thin, conductor_reflectance};
    let read = |rgb: &Basis, quantity: Quantity, curve: &Curve| match basis {
        Some(basis) => basis.tabulate(quantity, curve).bins().to_vec(),
        None => visible::wavelengths().map(|nm| curve.reader(quantity, rgb.upsampler())(nm)).collect(),
    };
    let rgb = Basis::rgb(scene.film.color_space);
    let read = |quantity, curve: &Curve| read(&rgb, quantity, curve);
    let mut remaining_light = Vec::new();
    for (number, hit) in hit.iter().enumerate() {
        let cos = hit.cos();
        let values: Vec<f64> =
            match &scene.materials.iter().find(|m| m.name == format!("m{number}")).expect("named so").material {
                Material::Mirror(mirror) => read(Quantity::Reflectance, &mirror.reflectance),
                Material::Conductor(metal) => {
                    let (n, k) = (read(Quantity::MetalIndex, &metal.n), read(Quantity::MetalExtinction, &metal.k));
                    n.iter()
                        .zip(&k)
                        .map(|(n, k)| 0.5 * conductor_reflectance(1.0, *n, *k, cos).iter().sum::<f64>())
                        .collect()
                }
                Material::Thin(Thin::Pane { transmittance, .. }) => read(Quantity::Transmittance, transmittance),
                _ => unreachable!("no other links have colors"),
            };
        if remaining_light.is_empty() {
            remaining_light = vec![1.0; values.len()];
        }
        remaining_light.iter_mut().zip(values).for_each(|(remaining_light, value)| *remaining_light *= value);
    }
    remaining_light
}

#[test]
fn colors_through_chains_of_filters_mirrors_and_metals_are_missed_by_no_more_than_the_plan_says() {
    const SCENES: u64 = 120;
    let lights = ["D65", "A", "FL11", "LED-B3", "LED-RGB1"];
    let mut ratios: Vec<f64> = Vec::new();
    for number in 0..SCENES {
        let mut random = Random::new(number + 7000);
        let count = 1 + (number % 7) as usize;
        let links: Vec<Link> = (0..count)
            .map(|_| match (random.number() * 6.0) as u32 {
                0..=2 => Link::Filter(tint(&mut random)),
                3..=4 => Link::Mirror(tint(&mut random)),
                _ => Link::Metal(["Au", "Cu", "Ag", "Al"][(random.number() * 4.0) as usize]),
            })
            .collect();
        let (hit, mut text) = chain(&mut random, &links, 60.0, false);
        let light = lights[number as usize % lights.len()];
        text += &format!("[material.lamp]\nemissive = {{ radiance = {{ illuminant = \"{light}\" }} }}\n");
        let scene = scene(&text);
        let curve = scene.lights[0].emission();
        for candidate in plan(&scene).candidates {
            let basis = &candidate.basis;
            let emission = Emission::new(curve, basis.color_space());
            let mut exact = [0.0; 3];
            for (value, column) in remaining_light(&hit, &scene, None).iter().zip(emission.columns()) {
                (0..3).for_each(|c| exact[c] += value * column[c]);
            }
            let draw = Draw::<MAX_LANES>::fixed(basis.fixed_lanes());
            let lanes = remaining_light(&hit, &scene, Some(basis));
            let lanes = Lanes::from_fn(|lane| lanes.get(lane).map_or(0.0, |x| *x as f32));
            let emitted = draw.read(&basis.tabulate(Quantity::Emission, curve));
            let found = basis.response(curve).film_rgb(&draw, emitted * lanes, false);
            let strongest = exact.iter().fold(0.0_f64, |most, x| larger(most, x.abs()));
            let color_error = (0..3).fold(0.0_f64, |most, c| larger(most, (found[c] - exact[c]).abs())) / strongest;
            let name = basis.name();
            assert!(
                color_error <= candidate.bound() + 1e-6,
                "scene {number}, {count} links under {light}, {name}: misses {color_error:.5}, stated {:.5}",
                candidate.bound()
            );
            ratios.push(candidate.bound() / color_error.max(1e-6));
        }
    }
    ratios.sort_by(f64::total_cmp);
    let at = |share: f64| ratios[((ratios.len() - 1) as f64 * share) as usize];
    println!("stated over true error of color: least {:.2}, median {:.2}, 95 % {:.1}", at(0.0), at(0.5), at(0.95));
}

/// Returns the light of a chain by Mueller calculus, relative to the light without polarization.
fn exact_over_averaged(hit: &[Hit]) -> f64 {
    let (mut light, mut averaged) = (Stokes::unpolarized(), 1.0);
    for hit in hit.iter().rev() {
        let cos = hit.cos();
        let event = match hit.link {
            Link::Through(n) => pane(n, cos)[0],
            Link::MirroredByPane(n) => pane(n, cos)[1],
            Link::MirroredByGlass(n) => surface(n, cos),
            Link::Plain([n, k]) => metal(n, k, cos),
            _ => mirror(),
        };
        averaged *= event.mean();
        light = light.after(&event, -hit.outgoing(), hit.normal);
    }
    light.intensity() / averaged
}

/// Returns the stated error of averaging, the light with traced polarization relative to the light with averaging, and
/// the reasons of the plan.
fn render_chain(text: &str) -> (f64, f64, Vec<String>) {
    let scene = scene(&format!("{text}[material.lamp]\nemissive = {{ radiance = 1 }}\n"));
    let plan = plan(&scene);
    let render_with =
        |polarization| render(&prepare(&scene, Method { polarization, ..plan.method.clone() }), &|_| ()).1;
    let [averaged, traced] = [Polarizing::Averaged, Polarizing::Traced].map(render_with);
    assert!(averaged.light > 0.0, "no light in\n{text}");
    (averaged.polarization, traced.light / averaged.light, plan.because)
}

#[test]
fn polarization_changes_the_light_of_chains_by_no_more_than_the_report_says() {
    const SCENES: u64 = 200;
    let (mut changes, mut large) = (Vec::new(), 0);
    for number in 0..SCENES {
        let mut random = Random::new(number + 9000);
        let count = 2 + (number % 4) as usize;
        let links: Vec<Link> = (0..count)
            .map(|_| match (random.number() * 5.0) as u32 {
                0 => Link::Through(random.between(1.3, 2.4)),
                1 => Link::MirroredByPane(random.between(1.3, 2.4)),
                2 => Link::MirroredByGlass(random.between(1.3, 2.4)),
                3 => Link::Plain([random.between(0.1, 3.0), random.between(1.0, 6.0)]),
                _ => Link::IdealMirror,
            })
            .collect();
        let (hit, text) = chain(&mut random, &links, 80.0, number % 2 == 0);
        let exact = exact_over_averaged(&hit);
        let change = (exact - 1.0).abs();
        let (stated, traced, because) = render_chain(&text);
        assert!((traced - exact).abs() < 1e-5 * exact.max(1.0), "scene {number}: {traced} for {exact}");
        // Lanes are f32.
        let links: Vec<String> = hit.iter().map(|hit| format!("{} at {:.3}", hit.link.material(), hit.cos())).collect();
        assert!(change <= stated + 1e-5, "scene {number}: changes {change:.6}, stated {stated:.6}: {links:?}");
        let says =
            because.iter().any(|line| line.starts_with("polarization on") || line.starts_with("polarization off"));
        assert!(says || stated <= 0.0101, "scene {number}: {stated} and not a word: {because:?}");
        changes.push((change, stated));
        large += u32::from(change > 0.05);
    }
    assert!(large > 40, "{large} chains in which polarization matters");
    let in_plane: Vec<f64> =
        changes.iter().step_by(2).filter(|x| x.0 > 0.05).map(|(change, stated)| stated / change).collect();
    let mean = in_plane.iter().sum::<f64>() / in_plane.len() as f64;
    println!("{large} chains change by more than 5 %; stated over true in a plane: mean {mean:.2}");
    assert!(mean < 2.0, "the bound is {mean} times what happens in a plane");
}

#[test]
fn a_mirror_between_two_reflections_at_brewsters_angle_hides_nothing() {
    let hit = |link: Link, incoming: DVec3, degrees: f64| {
        let aside = DVec3::new(0.0, 1.0, 0.0).cross(incoming).try_normalize().expect("not upright");
        let (sin, cos) = degrees.to_radians().sin_cos();
        Hit { link, incoming, normal: aside * sin - incoming * cos }
    };
    let brewster = 1.5_f64.atan().to_degrees();
    let (mut at, mut incoming, mut all) = (DVec3::ZERO, DVec3::new(0.0, 0.0, -1.0), Vec::new());
    let mut places = vec![at - incoming * STEP];
    for (link, degrees) in
        [(Link::MirroredByGlass(1.5), brewster), (Link::IdealMirror, -40.0), (Link::MirroredByGlass(1.5), brewster)]
    {
        let next = hit(link, incoming, degrees);
        places.push(at);
        incoming = next.outgoing();
        at += incoming * STEP;
        all.push(next);
    }
    places.push(at);
    let change = exact_over_averaged(&all) - 1.0;
    assert!((change - 1.0).abs() < 1e-9, "twice the light, not {change} more");
    let (stated, traced, because) = render_chain(&text(&all, &places));
    assert!((traced - 2.0).abs() < 1e-5, "{traced}");
    assert!((stated - 1.0).abs() < 1e-5, "{stated}");
    assert!(
        because.iter().any(|line| line.starts_with("polarization on: without it, the image would be wrong by 50 %")),
        "{because:?}"
    );
}
