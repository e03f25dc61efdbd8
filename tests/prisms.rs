//! Every maker's glass as a prism: each spectral line leaves in the direction of Snell's law, as bright as Fresnel's
//! equations transmit it.
//!
//! ```text
//! cargo test --release --test all prisms::
//! ```

use std::fmt::Write;

use abbe::math::DVec3;
use abbe::spectrum::{Basis, ColorSpace, Quantity, data, visible};
use abbe::trace::Method;

use crate::support::fresnel::reflectance_by_angles;
use crate::support::scenes::{EVERY_BRANCH, film_of, method, scene, view};

/// Fraunhofer's lines and their neighbors, h F d C r, in nm.
const LINES_NM: [f64; 5] = [404.66, 486.13, 587.56, 656.27, 706.52];
/// Angular diameter of each sun. If a sun is seen, its center is missed by at most 0.01 degrees.
const SUN_DEGREES: f64 = 0.02;
const CAMERA: f64 = 1e6;
/// Length of a prism's faces. Prisms are 1 apart, so that no light from one hits another.
const FACE: f64 = 0.01;

/// A glass as stored in the table, which is parsed here independently.
struct Glass {
    key: &'static str,
    formula: &'static str,
    range_nm: (f64, f64),
    coefficients: &'static str,
}

impl Glass {
    fn all() -> impl Iterator<Item = Self> {
        include_str!("../src/spectrum/data/glasses.txt").lines().skip(1).map(|line| {
            let fields: Vec<&str> = line.split('|').collect();
            let range: Vec<f64> = fields[3].split(' ').map(number).collect();
            Self { key: fields[0], formula: fields[2], range_nm: (range[0], range[1]), coefficients: fields[4] }
        })
    }

    /// Returns the lines at which the index is known. The tables of some glasses end at 706.5 nm, while line r is at
    /// 706.5188.
    fn lines(&self) -> impl Iterator<Item = f64> {
        let (low, high) = self.range_nm;
        LINES_NM.into_iter().filter(move |&nm| low <= nm && nm <= high + 0.1)
    }

    /// Returns the index by the formulas of refractiveindex.info,
    /// <https://refractiveindex.info/database/doc/Dispersion%20formulas.pdf>.
    fn index(&self, nm: f64) -> f64 {
        let um = nm.min(self.range_nm.1) / 1000.0;
        let pairs = |c: &[f64], term: &dyn Fn(f64, f64) -> f64| -> f64 {
            (1..c.len()).step_by(2).map(|i| term(c[i], c[i + 1])).sum()
        };
        if self.formula == "n" {
            let samples: Vec<(f64, f64)> =
                self.coefficients.split(' ').map(|s| s.split_once(':').expect("nm:n")).map(parse_both).collect();
            let i = samples.iter().position(|sample| sample.0 >= nm).expect("a line within the range").max(1);
            let ((x0, y0), (x1, y1)) = (samples[i - 1], samples[i]);
            return ((x1 - nm) * y0 + (nm - x0) * y1) / (x1 - x0);
        }
        let c: Vec<f64> = self.coefficients.split(' ').map(number).collect();
        let squared = match self.formula {
            "1" => 1.0 + c[0] + pairs(&c, &|strength, um0| strength / (1.0 - (um0 / um).powi(2))),
            "2" => 1.0 + c[0] + pairs(&c, &|strength, um2| strength / (1.0 - um2 / um.powi(2))),
            "3" => c[0] + pairs(&c, &|factor, power| factor * (power * um.ln()).exp()),
            other => panic!("{}: no maker writes formula {other}", self.key),
        };
        squared.sqrt()
    }
}

fn number(text: &str) -> f64 {
    text.parse().unwrap_or_else(|_| panic!("{text} is no number"))
}

fn parse_both((a, b): (&str, &str)) -> (f64, f64) {
    (number(a), number(b))
}

/// One line through one prism.
struct Passage {
    nm: f64,
    apex: f64,
    incidence: f64,
    deviation: f64,
    /// Fraction of the light that both faces transmit.
    transmittance: f64,
}

impl Passage {
    /// Applies Snell's law at both faces (Born & Wolf 1999, section 4.7.2). Angles are in radians.
    fn new(nm: f64, index: f64, apex: f64, incidence: f64) -> Self {
        let inside = (incidence.sin() / index).asin();
        let leaving = (index * (apex - inside).sin()).asin();
        let reflected = [(incidence, inside), (leaving, apex - inside)].map(|(a, b)| reflectance_by_angles(a, b));
        let transmittance = (1.0 - reflected[0]) * (1.0 - reflected[1]);
        Self { nm, apex, incidence, deviation: incidence + leaving - apex, transmittance }
    }

    /// Returns the passages of a line at minimum deviation and at a greater incidence.
    fn pair(nm: f64, index: f64) -> [Self; 2] {
        let apex = f64::to_radians(if index < 1.9 { 60.0 } else { 30.0 });
        let incidence_at_minimum = (index * (apex / 2.0).sin()).asin();
        let minimum = Self::new(nm, index, apex, incidence_at_minimum);
        let min_deviation = 2.0 * incidence_at_minimum - apex;
        assert!((minimum.deviation - min_deviation).abs() < 1e-12, "{} is not {min_deviation}", minimum.deviation);
        [minimum, Self::new(nm, index, apex, 0.5 * (incidence_at_minimum + 80_f64.to_radians()))]
    }

    /// Appends the prism and a sun. The prism is placed around the ray that meets the plane z = 0 at x, and bends it
    /// toward `side`. The sun is `off` degrees beside the direction in which the ray leaves.
    fn write(&self, text: &mut String, x: f64, side: f64, off: f64) {
        let forward = DVec3::new(x, 0.0, -CAMERA).normalize();
        let across = DVec3::new(side.cos(), side.sin(), 0.0);
        let across = (across - forward * across.dot(forward)).normalize();
        let along = forward.cross(across);
        let rotated = |angle: f64| across * angle.cos() - forward * angle.sin();
        let faces = [rotated(self.incidence), rotated(self.incidence - self.apex)];
        // The ray hits the middle of the first face.
        let edge = DVec3::new(x, 0.0, 0.0) - 0.5 * FACE * faces[0];
        let corners = [edge, edge + FACE * faces[0], edge + FACE * faces[1]];
        let points = [-FACE, FACE].map(|end| corners.map(|corner| corner + end * along));
        let points: Vec<DVec3> = points.into_iter().flatten().collect();
        let center = points.iter().sum::<DVec3>() / 6.0;
        let outward = |mut face: [usize; 3]| {
            let [a, b, c] = face.map(|i| points[i]);
            if (b - a).cross(c - a).dot(a - center) < 0.0 {
                face.swap(1, 2);
            }
            face
        };
        const TRIANGLES: [[usize; 3]; 8] =
            [[0, 1, 2], [3, 4, 5], [0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4], [2, 0, 3], [2, 3, 5]];
        let points: Vec<[f64; 3]> = points.iter().map(DVec3::to_array).collect();
        let direction = self.deviation + off.to_radians();
        let toward = forward * direction.cos() + across * direction.sin();
        write!(
            text,
            "[[object]]\nmaterial = \"glass\"\nshape.mesh = {{ points = {points:?}, faces = {:?} }}\n\
             [[light]]\nsun = {{ toward = {:?}, angular_diameter = {SUN_DEGREES:?}, irradiance = {{ lines = [[{:?}, 1]] }} }}\n",
            TRIANGLES.map(outward),
            toward.to_array(),
            self.nm
        )
        .expect("a string takes all text");
    }

    /// Returns CIE X of the sun's disc behind the prism.
    fn expected(&self) -> f64 {
        let half = (0.5 * SUN_DEGREES).to_radians();
        let radiance = 1.0 / (std::f64::consts::PI * half.sin().powi(2));
        radiance * self.transmittance * visible::color_matching(self.nm)[0] / visible::y_integral()
    }
}

/// Returns the mistakes of a glass whose index is expected to be `more` above its formula, and the number of passages
/// that were judged.
fn judge(glass: &Glass, more: f64) -> (Vec<String>, usize) {
    // Each sun has two controls, and each pixel its own direction to the side, so that no other sun is near.
    let passages: Vec<Passage> = glass.lines().flat_map(|nm| Passage::pair(nm, glass.index(nm) + more)).collect();
    let views: Vec<(&Passage, f64)> =
        passages.iter().flat_map(|passage| [0.0, SUN_DEGREES, -SUN_DEGREES].map(|off| (passage, off))).collect();
    let count = views.len();
    let vertical_fov = 2.0 * (0.5 / CAMERA).atan().to_degrees();
    // Light that is reflected inside would leave to the same side, at a thousandth of the brightness.
    let mut text = format!(
        "[camera]\nposition = [0, 0, {CAMERA:?}]\nlook_at = [0, 0, 0]\nvertical_fov = {vertical_fov:?}\n\
         [film]\nwidth = {count}\nheight = 1\nfilter = \"center\"\ncolor_space = \"lin_ciexyzd65_scene\"\n\
         [material.glass]\ndielectric = {{ index = {:?}, reflectance = 0 }}\n",
        glass.key
    );
    for (i, (passage, off)) in views.iter().enumerate() {
        let side = std::f64::consts::TAU * (i as f64 + 0.5) / count as f64;
        passage.write(&mut text, i as f64 - 0.5 * (count as f64 - 1.0), side, *off);
    }
    let scene = scene(&text);
    let basis = Basis::wavelengths(ColorSpace::Xyz, vec![550.0], &glass.lines().collect::<Vec<_>>());
    let method = Method { basis, ..method(&scene, EVERY_BRANCH) };
    let film = film_of(&scene, method);
    let wrong = views.iter().zip(&film.pixels).filter_map(|((passage, off), pixel)| {
        let found = f64::from(pixel.rgb[0]);
        let expected = if *off == 0.0 { passage.expected() } else { 0.0 };
        // Lanes, light and film are f32: each of 8 products or sums is rounded.
        let right = (found - expected).abs() <= 8.0 * f64::from(f32::EPSILON) * expected;
        let [incidence, deviation] = [passage.incidence, passage.deviation].map(f64::to_degrees);
        (!right).then(|| {
            format!(
                "{} at {} nm, incidence {incidence:.3}, deviation {deviation:.4} and a sun {off} beside: {found} for {expected}",
                glass.key, passage.nm
            )
        })
    });
    (wrong.collect(), passages.len())
}

fn maker_glasses() -> Vec<Glass> {
    Glass::all().filter(|glass| data::GLASS_MAKERS.contains(&glass.key.split('/').next().unwrap_or_default())).collect()
}

#[test]
fn every_makers_glass_bends_every_line_by_snells_law() {
    let (mut wrong, mut passages) = (Vec::new(), 0);
    for glass in maker_glasses() {
        let (mistakes, judged) = judge(&glass, 0.0);
        wrong.extend(mistakes);
        passages += judged;
    }
    println!("{} glasses, {passages} passages", maker_glasses().len());
    let makers = data::glass_names().filter(|key| data::GLASS_MAKERS.iter().any(|maker| key.starts_with(maker)));
    assert_eq!(maker_glasses().len(), makers.count());
    assert!(passages > 9 * maker_glasses().len(), "only {passages} passages");
    assert!(wrong.is_empty(), "{} are wrong:\n{}", wrong.len(), wrong[..wrong.len().min(20)].join("\n"));
}

/// The smallest slope of a deviation is 2 sin(A/2), half a radian per unit of index: 0.01 degrees for 0.00034.
#[test]
fn an_index_that_is_off_by_four_in_the_fourth_decimal_is_noticed_at_every_line() {
    for key in ["schott/N-BK7", "schott/N-SF66"] {
        let glass = maker_glasses().into_iter().find(|glass| glass.key == key).expect("a glass of the catalog");
        for more in [-4e-4, 4e-4] {
            let (mistakes, judged) = judge(&glass, more);
            assert!(mistakes.len() >= judged, "only {} of {judged} are noticed", mistakes.len());
        }
    }
}

/// Returns the index at a wavelength in nm of a dielectric whose index is written in a scene.
fn written_index(index: &str) -> impl Fn(f64) -> f64 + use<> {
    let scene = scene(&format!(
        "{}[material.glass]\ndielectric = {{ index = {index} }}\n[[object]]\nmaterial = \"glass\"\n\
         shape.sphere = {{ center = [0, 0, 0], radius = 1 }}\n",
        view([0.0, 0.0, 9.0], [0.0; 3], 30.0, 4)
    ));
    let curve = scene.material_of(0).clear_index().expect("glass has one").clone();
    move |nm| curve.values(Quantity::Index)(nm)
}

/// Sellmeier's formula of N-BK7 with Schott's numbers, compared with the indices that Schott's data sheet lists beside
/// them. n_d and V_d are compared with their definitions.
#[test]
fn an_index_that_a_scene_writes_as_a_formula_is_that_of_the_glass() {
    let bk7 = written_index(
        "{ sellmeier = { b = [1.03961212, 0.231792344, 1.01046945], c = [0.00600069867, 0.0200179144, 103.560653] } }",
    );
    // Lines h, g, F', e, d, C' and r.
    let listed = [
        (404.6561, 1.53024),
        (435.8343, 1.52668),
        (479.9914, 1.52283),
        (546.0740, 1.51872),
        (587.5618, 1.51680),
        (643.8469, 1.51472),
        (706.5188, 1.51289),
    ];
    for (nm, index) in listed {
        assert!((bk7(nm) - index).abs() <= 0.6e-5, "{nm} nm: {}, not {index}", bk7(nm));
    }
    for [nd, vd] in [[1.5168, 64.17], [1.78472, 25.68], [2.0, 19.0]] {
        let index = written_index(&format!("{{ abbe = {{ nd = {nd:?}, vd = {vd:?} }} }}"));
        let [f, d, c] = [486.13, 587.56, 656.27].map(&index);
        assert!((d - nd).abs() < 1e-12, "n_d = {d}, not {nd}");
        assert!(((d - 1.0) / (f - c) - vd).abs() < 1e-9 * vd, "V_d = {}, not {vd}", (d - 1.0) / (f - c));
        // Cauchy's curve is linear in 1 / w^2.
        let over = |nm: f64| 1e6 / (nm * nm);
        let slope = |a: f64, b: f64| (index(a) - index(b)) / (over(a) - over(b));
        assert!((slope(400.0, 500.0) / slope(600.0, 700.0) - 1.0).abs() < 1e-9);
    }
}
