//! Bounces inside rooms aim at what lights them: sunlit patches, and openings through which the sky is seen.
//!
//! A direction is drawn by the material or, as often as bright places are expected to bring light, evenly from the solid angle of
//! one of them. Its density is that of both ways together, a one-sample balance heuristic (Veach & Guibas 1995, *Optimally
//! Combining Sampling Techniques for Monte Carlo Rendering*): what the places miss, and where they are in vain, changes the
//! noise alone. Jensen 1995, *Importance Driven Path Tracing Using the Photon Map*, guides bounces so by histograms of
//! directions; places in space also hold where the path goes next.

use std::f64::consts::PI;

use super::brightness::Bounce;
use super::path::Path;
use super::polarization::amount;
use super::shading;
use super::tracer::Tracer;
use crate::material::{Arrival, Branch, Material};
use crate::math::{Bounds, DVec3, Ray};
use crate::shape::{Density, Quad, Shape};
use crate::spectrum::{Draw, Table};

/// Places at most: each takes its time at every bounce.
pub(super) const MOST: usize = 6;
/// The largest share of the directions that is aimed: the noise of all other light is at most doubled.
const LARGEST: f64 = 0.5;
/// How much more light from elsewhere counts than that of the places, which others may see as well: in rooms with a window, 2 to
/// 6 make hardly a difference.
const ELSEWHERE: f64 = 3.0;
/// Distance from a place's plane, in its half diagonals, below which it is not aimed at: its outline has no certain extent.
const FLAT: f64 = 1e-3;

/// A rectangle from which or through which much light comes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BrightPlace {
    /// Its middle.
    pub center: DVec3,
    /// Half edges at right angles.
    pub half: [DVec3; 2],
    /// Root of the mean square of the radiance that bounces found there.
    pub radiance: f64,
}

/// What lights a room, as bounces found it.
#[derive(Clone, Debug, PartialEq)]
pub struct BrightPlaces {
    /// Where they are aimed at from.
    pub within: Bounds,
    /// The places, at most six.
    pub places: Vec<BrightPlace>,
    /// Root of the mean square of the radiance from elsewhere.
    pub elsewhere: f64,
}

/// A place, ready to be aimed at.
#[derive(Clone, Debug)]
struct Target {
    shape: Shape,
    center: DVec3,
    normal: DVec3,
    area: f64,
    /// Height above its plane below which it is not aimed at.
    flat: f64,
    radiance: f64,
}

/// Bright places as the tracer reads them.
#[derive(Clone, Debug)]
pub(super) struct Bright {
    within: Bounds,
    targets: Vec<Target>,
    elsewhere: f64,
}

/// How bounces are drawn at one point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aiming<'a> {
    bright: &'a Bright,
    from: DVec3,
    /// How likely each place is, of all aimed directions.
    chances: [f64; MOST],
    /// How likely a direction is aimed.
    share: f64,
}

impl Bright {
    pub(super) fn new(found: &BrightPlaces) -> Self {
        let target = |place: &BrightPlace| {
            let BrightPlace { center, half: [u, v], radiance } = *place;
            Target {
                shape: Shape::Quad(Quad::new(center, u, v)),
                center,
                normal: u.cross(v).normalize(),
                area: 4.0 * u.cross(v).length(),
                flat: FLAT * (u.length_squared() + v.length_squared()).sqrt(),
                radiance,
            }
        };
        let targets = found.places.iter().take(MOST).map(target).collect();
        Self { within: found.within, targets, elsewhere: ELSEWHERE * found.elsewhere }
    }

    /// How bounces are drawn at a point of a surface of the given unit normal; none where they are not aimed.
    pub(super) fn at(&self, from: DVec3, normal: DVec3) -> Option<Aiming<'_>> {
        let Bounds { min, max } = self.within;
        if from.cmplt(min).any() || from.cmpgt(max).any() {
            return None;
        }
        // About what each brings: radiance x solid angle x cosine, bounded nearby.
        let (mut chances, mut all) = ([0.0; MOST], 0.0);
        for (chance, target) in chances.iter_mut().zip(&self.targets) {
            let way = target.center - from;
            let height = way.dot(target.normal).abs();
            if height < target.flat {
                continue;
            }
            let squared = way.length_squared();
            let length = squared.sqrt();
            let here = 0.1 + (way.dot(normal) / length).max(0.0);
            let there = 0.05 + height / length;
            *chance = target.radiance * target.area * here * there / (squared + 0.3 * target.area);
            all += *chance;
        }
        if all == 0.0 {
            return None;
        }
        chances.iter_mut().for_each(|chance| *chance /= all);
        let share = (all / (all + PI * self.elsewhere)).min(LARGEST);
        Some(Aiming { bright: self, from, chances, share })
    }
}

impl Aiming<'_> {
    /// Divides a random number: that of an aimed direction, or that of the material's.
    pub(super) fn divided(&self, u: f64) -> Result<f64, f64> {
        if u < self.share { Ok(u / self.share) } else { Err((u - self.share) / (1.0 - self.share)) }
    }

    /// An aimed direction, the place it was aimed at and its density there.
    fn draw(&self, [u, v]: [f64; 2]) -> Option<(DVec3, Option<(usize, f64)>)> {
        let (mut left, mut chosen) = (u, None);
        for (number, &chance) in self.chances.iter().enumerate().filter(|(_, chance)| **chance > 0.0) {
            chosen = Some((number, (left / chance).min(1.0 - f64::EPSILON)));
            if left < chance {
                break;
            }
            left -= chance;
        }
        let (number, u) = chosen?;
        let sighting = self.bright.targets[number].shape.aim(self.from, [u, v])?;
        let known = match sighting.density {
            Some(Density::Angle(density)) => Some((number, density)),
            _ => None,
        };
        Some((sighting.direction, known))
    }

    /// The density of a direction that the material draws with another.
    pub(super) fn pdf(&self, direction: DVec3, own: f64) -> f64 {
        self.pdf_knowing(direction, own, None)
    }

    /// The same where the density is known with which one of the places is aimed at.
    fn pdf_knowing(&self, direction: DVec3, own: f64, known: Option<(usize, f64)>) -> f64 {
        let ray = Ray { origin: self.from, direction };
        let mut sum = 0.0;
        for (number, &chance) in self.chances.iter().enumerate().filter(|(_, chance)| **chance > 0.0) {
            sum += match known {
                Some((place, density)) if place == number => chance * density,
                _ => {
                    let shape = &self.bright.targets[number].shape;
                    let crossing = shape.intersect(&ray, f64::INFINITY);
                    crossing.map_or(0.0, |crossing| chance * shape.pdf_toward(&ray, &crossing))
                }
            };
        }
        self.share * sum + (1.0 - self.share) * own
    }
}

/// Whether bounces from a material may be aimed: it scatters nearly alike in all directions of one side.
pub(super) fn may_aim(material: &Material<Table>) -> bool {
    matches!(material, Material::Diffuse(_) | Material::Plastic(_))
}

impl<const N: usize> Tracer<'_, N> {
    /// Keeps what a bounce found, if somebody wants to know.
    #[inline]
    pub(super) fn note(&mut self, path: &Path<N>, draw: &Draw<N>, distance: f64, light: [f64; 3]) {
        if let (Some(bounces), Some(drawn)) = (&mut self.bounces, &path.drawn) {
            let distance = distance + (path.ray.origin - drawn.from).length();
            let (light, weight) = (amount(self.world, light), path.weight(draw));
            let (from, normal, direction) = (drawn.from, drawn.normal, path.ray.direction);
            bounces.push(Bounce { from, normal, direction, distance, light, weight });
        }
    }

    /// The ways on from a surface whose bounces are aimed.
    ///
    /// Roulette is to end aimed paths as often as others: what their density takes from the weight is no measure of importance.
    pub(super) fn scatter_aimed(
        &mut self,
        aiming: &Aiming,
        (material, arrival): (&Material<Table>, &Arrival<N>),
        flat: DVec3,
        u: [f64; 2],
    ) {
        let divided = aiming.divided(u[0]);
        shading::scatter(material, arrival, flat, [divided.err().unwrap_or(0.5), u[1]], &mut self.branches);
        if let Ok(aimed) = divided {
            self.branches.retain(|branch| branch.pdf.is_none());
            let Some((wi, known)) = aiming.draw([aimed, u[1]]).filter(|(wi, _)| wi.dot(flat) > 0.0) else { return };
            let Some((bsdf_cos, own)) = shading::evaluate(material, arrival, flat, wi) else { return };
            let pdf = aiming.pdf_knowing(wi, own, known);
            if !(own > 0.0 && pdf.is_finite()) {
                return;
            }
            let share = bsdf_cos * (1.0 / pdf) as f32;
            let eta_scale = own / pdf;
            self.branches.push(Branch { wi, share, pdf: Some(pdf), crosses: false, eta_scale, polarization: 0.0 });
            return;
        }
        for branch in &mut self.branches {
            if let Some(own) = branch.pdf.filter(|own| *own > 0.0) {
                let pdf = aiming.pdf(branch.wi, own);
                let factor = own / pdf;
                branch.share = branch.share * factor as f32;
                branch.eta_scale *= factor;
                branch.pdf = Some(pdf);
            }
        }
    }
}
