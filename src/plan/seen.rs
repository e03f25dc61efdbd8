//! The colors that the camera sees of a scene, found by a probe: products of as many tints as light really hits.

use std::collections::BTreeMap;

use super::films::films;
use super::survey::{Survey, Tint, look_method, max_channel, max_channel_error, tolerance};
use crate::material::Material;
use crate::scene::Scene;
use crate::spectrum::{Basis, Curve, Draw, Lanes, MAX_LANES, Quantity};
use crate::trace::{ROUTES_NM, Route, RouteEvent, Step, World, routes};

/// Indices of products of tints, with the weight of each.
type WeightedProducts = Vec<(usize, f64)>;

/// Colors that are seen, those of each light separately.
#[derive(Default)]
pub(super) struct Seen<'a> {
    tints: Vec<Tint<'a>>,
    /// Tints that light hits one after another, each repeated as often as it is hit.
    products: Vec<Vec<u32>>,
    colors: Vec<Color>,
}

/// What a pixel sees of one light, after a given number of diffuse surfaces.
struct Color {
    light: usize,
    /// Products and their weights.
    sum: WeightedProducts,
    /// From sums over 1 nm.
    exact: [f64; 3],
    /// What an error of it is relative to: its strongest channel, or the tolerated share of the brightest color that
    /// the light makes in the view, if that is larger.
    scale: f64,
}

/// Factor between distances, and number of cosines, that are told apart.
const DISTANCE_RATIO: f64 = 1.05;
const COSINE_STEPS: f64 = 32.0;
/// Steps per unit of weight that are told apart.
const WEIGHT_STEPS: f64 = 100.0;

impl<'a> Seen<'a> {
    /// Traces a few hundred rays and keeps what they hit; nothing where smooth surfaces tint no light.
    pub(super) fn new(scene: &'a Scene<Curve>, survey: &Survey) -> Self {
        if survey.is_rgb_only() || survey.smooth(1).is_empty() {
            return Self::default();
        }
        let basis = Basis::wavelengths(survey.color_space, ROUTES_NM.into(), &[]);
        let mut builder = SeenBuilder::new(scene, survey);
        for of_pixel in routes(&World::new(scene, look_method(scene, basis))) {
            builder.add_pixel(&of_pixel);
        }
        builder.finish(survey, tolerance(scene))
    }

    /// Returns the largest error of a color in the lanes of a basis.
    pub(super) fn error(&self, survey: &Survey, basis: &Basis) -> f64 {
        let draw = Draw::<MAX_LANES>::fixed(basis.fixed_lanes());
        let tints: Vec<Vec<f64>> = self.tints.iter().map(|tint| tint.in_basis(basis)).collect();
        let products = self.multiply(&tints, basis.fixed_lanes());
        let mut lights = BTreeMap::new();
        for light in self.colors.iter().map(|color| color.light) {
            let curve = &survey.lights[light].0;
            let read = || (draw.read(&basis.tabulate(Quantity::Emission, curve)), basis.response(curve));
            lights.entry(light).or_insert_with(read);
        }
        let error = |color: &Color| {
            let mut lanes = [0.0; MAX_LANES];
            for (product, weight) in &color.sum {
                lanes.iter_mut().zip(&products[*product]).for_each(|(lane, left)| *lane += weight * left);
            }
            let (emission, response) = &lights[&color.light];
            let found = response.film_rgb(&draw, *emission * Lanes(lanes.map(|x| x as f32)), false);
            max_channel_error(found, color.exact) / color.scale
        };
        self.colors.iter().map(error).fold(0.0, f64::max)
    }

    /// Returns what is left of light after each product, from what each tint leaves.
    fn multiply(&self, tints: &[Vec<f64>], length: usize) -> Vec<Vec<f64>> {
        let product = |numbers: &Vec<u32>| {
            let mut remaining = vec![1.0; length];
            for &number in numbers {
                remaining.iter_mut().zip(&tints[number as usize]).for_each(|(left, tint)| *left *= tint);
            }
            remaining
        };
        self.products.iter().map(product).collect()
    }
}

/// Identifies a tint that was hit: material, part, what light does there, and a number.
type Key = (u32, usize, u8, i64);
/// Identifies a color: light, diffuse surfaces, products with rounded weights.
type ColorKey = (usize, u32, Vec<(usize, i64)>);

struct SeenBuilder<'a> {
    scene: &'a Scene<Curve>,
    /// For each light, the index of its spectrum in the survey.
    lights: Vec<usize>,
    seen: Seen<'a>,
    tints: BTreeMap<Key, Vec<u32>>,
    products: BTreeMap<Vec<u32>, usize>,
    colors: BTreeMap<ColorKey, WeightedProducts>,
}

impl<'a> SeenBuilder<'a> {
    fn new(scene: &'a Scene<Curve>, survey: &Survey) -> Self {
        let lights = survey.light_indices.clone();
        let (tints, products, colors) = (BTreeMap::new(), BTreeMap::new(), BTreeMap::new());
        Self { scene, lights, seen: Seen::default(), tints, products, colors }
    }

    fn add_pixel(&mut self, found: &[Route]) {
        let mut of_pixel: BTreeMap<(usize, u32), WeightedProducts> = BTreeMap::new();
        for route in found {
            let product = self.product(route);
            let sum = of_pixel.entry((route.light, route.scattered)).or_default();
            match sum.iter_mut().find(|(known, _)| *known == product) {
                Some((_, weight)) => *weight += route.weight,
                None => sum.push((product, route.weight)),
            }
        }
        for ((light, scattered), sum) in of_pixel {
            let rounded = |&(product, weight): &(usize, f64)| (product, (weight * WEIGHT_STEPS).round() as i64);
            let mut key: Vec<_> = sum.iter().map(rounded).collect();
            key.sort_unstable();
            self.colors.entry((self.lights[light], scattered, key)).or_insert(sum);
        }
    }

    fn product(&mut self, route: &Route) -> usize {
        let mut numbers: Vec<u32> = route.steps.iter().flat_map(|step| self.tint_indices(step)).collect();
        numbers.sort_unstable();
        let next = self.products.len();
        *self.products.entry(numbers).or_insert(next)
    }

    fn tint_indices(&mut self, step: &Step) -> Vec<u32> {
        let (event_code, rounded) = match step.way {
            RouteEvent::Reflected(cos) => (0, (cos * COSINE_STEPS).round().max(1.0) as i64),
            RouteEvent::Crossed => (1, 0),
            RouteEvent::Scattered => (2, 0),
            RouteEvent::Inside(distance) => (3, (libm::log(distance) / libm::log(DISTANCE_RATIO)).round() as i64),
        };
        let material = &self.scene.materials[step.material as usize].material;
        let parts = material.with_parts();
        let rounded = if matches!(parts[step.part], Material::Conductor(_)) || event_code == 3 { rounded } else { 0 };
        let key = (step.material, step.part, event_code, rounded);
        if let Some(known) = self.tints.get(&key) {
            return known.clone();
        }
        let tints = tints(&parts, step, rounded);
        let first = self.seen.tints.len() as u32;
        let numbers: Vec<u32> = (first..).take(tints.len()).collect();
        self.seen.tints.extend(tints);
        self.tints.insert(key, numbers.clone());
        numbers
    }

    fn finish(self, survey: &Survey, tolerated: f64) -> Seen<'a> {
        let mut seen = self.seen;
        seen.products = vec![Vec::new(); self.products.len()];
        self.products.into_iter().for_each(|(numbers, at)| seen.products[at] = numbers);
        let mut by_light: Vec<Vec<(u32, WeightedProducts)>> = survey.lights.iter().map(|_| Vec::new()).collect();
        for ((light, scattered, _), sum) in self.colors {
            by_light[light].push((scattered, sum));
        }
        for (light, (colors, (_, emission))) in by_light.into_iter().zip(&survey.lights).enumerate() {
            if colors.is_empty() {
                continue;
            }
            let film = emission.film_colors();
            let wavelengths = &film.wavelengths_nm;
            let tints: Vec<Vec<f64>> = seen.tints.iter().map(|tint| tint.at(wavelengths, &survey.upsampler)).collect();
            let products = seen.multiply(&tints, wavelengths.len());
            let products: Vec<[f64; 3]> = products.iter().map(|left| film.color(left)).collect();
            let mut brightest: BTreeMap<u32, f64> = BTreeMap::new();
            let first = seen.colors.len();
            let mut scatter_counts = Vec::new();
            for (scattered, sum) in colors {
                let exact = [0, 1, 2].map(|c| sum.iter().map(|(product, weight)| weight * products[*product][c]).sum());
                let scale = max_channel(exact);
                let most = brightest.entry(scattered).or_default();
                *most = most.max(scale);
                scatter_counts.push(scattered);
                seen.colors.push(Color { light, sum, exact, scale });
            }
            for (color, scattered) in seen.colors[first..].iter_mut().zip(scatter_counts) {
                color.scale = color.scale.max(tolerated * brightest[&scattered]);
            }
        }
        seen.colors.retain(|color| color.scale > 0.0);
        seen
    }
}

/// Returns what tints light at a step on a part of a material; `rounded` is its distance or angle in rounded steps.
fn tints<'a>(parts: &[&'a Material<Curve>], step: &Step, rounded: i64) -> Vec<Tint<'a>> {
    let filter = |quantity, curve: &'a Curve| vec![Tint::Filter(quantity, farthest_from_gray(curve))];
    match (parts[step.part], step.way) {
        (Material::Mirror(mirror), _) => filter(Quantity::Reflectance, &mirror.reflectance),
        (Material::Thin(pane), RouteEvent::Crossed) => {
            pane.transmittance().map_or_else(Vec::new, |left| filter(Quantity::Transmittance, left))
        }
        (Material::Dielectric(glass), RouteEvent::Crossed) => filter(Quantity::Transmittance, &glass.transmittance),
        (Material::Dielectric(glass), RouteEvent::Reflected(_)) => filter(Quantity::Reflectance, &glass.reflectance),
        (Material::Dielectric(glass), RouteEvent::Inside(_)) => {
            vec![Tint::Depth(&glass.absorption, libm::exp(rounded as f64 * libm::log(DISTANCE_RATIO)))]
        }
        (Material::Conductor(metal), _) if metal.coating.is_none() => {
            vec![Tint::Metal(metal, rounded as f64 / COSINE_STEPS)]
        }
        (coated @ Material::Conductor(_), _) => films(coated).into_iter().take(1).map(Tint::Film).collect(),
        (Material::Diffuse(diffuse), _) => vec![Tint::Diffuse(farthest_from_gray(&diffuse.reflectance))],
        (Material::Plastic(plastic), RouteEvent::Scattered) => {
            vec![Tint::Coated(plastic, farthest_from_gray(&plastic.reflectance))]
        }
        _ => Vec::new(),
    }
}

/// Returns the color of a curve that is farthest from gray, if it varies over a surface.
fn farthest_from_gray(curve: &Curve) -> std::borrow::Cow<'_, Curve> {
    let spread = |curve: &Curve| {
        let rgb = curve.kind.rgb().unwrap_or([1.0; 3]);
        let (low, high) = rgb.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), &x| (low.min(x), high.max(x)));
        if high > 0.0 { (high - low) / high } else { 0.0 }
    };
    let shades = curve.representatives().into_iter();
    shades.max_by(|a, b| spread(a).total_cmp(&spread(b))).expect("a curve has a shade")
}
