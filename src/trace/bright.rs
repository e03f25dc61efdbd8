//! Guides bounces inside rooms toward what lights them: sunlit patches, and openings through which the sky is seen.
//!
//! The direction of a bounce is sampled by the material or, with a probability that follows the light that bright
//! places are expected to contribute, uniformly from the solid angle of one of them. Its density is that of both
//! techniques together, a one-sample balance heuristic (Veach & Guibas 1995, *Optimally Combining Sampling Techniques
//! for Monte Carlo Rendering*). Light that the places miss, and places that turn out to contribute nothing, therefore
//! change only the noise. Jensen 1995, *Importance Driven Path Tracing Using the Photon Map*, guides bounces with
//! histograms of directions; places in space stay valid wherever the path goes next.

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use super::path_start::SkyOpenings;
use crate::light::Opening;
use crate::math::{Bounds, DVec3, Ray};
use crate::shape::{Density, Quad, Shape};

/// Maximum number of places: each costs time at every bounce.
pub(super) const MAX_PLACES: usize = 6;
/// Largest probability that a bounce is aimed. The noise of all other light at most doubles.
const MAX_AIMED_SHARE: f64 = 0.5;
/// Exponents of the albedo in the largest aimed share of the bounces. At a surface of albedo a, at most 1 - a^2 of the
/// bounces are aimed. With more, the second moment a^2 / (1 - share) of a path that is not aimed would grow at every
/// bounce, without bound in a room of one color. Where all light comes from what is aimed at, the limit is 1 - a: all
/// paths in such a room then have the same weight.
const FINITE_EXPONENT: i32 = 2;
const EQUAL_EXPONENT: i32 = 1;
/// Weight of light from elsewhere relative to that of the places, which others may see too: 2 to 6 work equally well.
const ELSEWHERE_WEIGHT: f64 = 3.0;
/// Distance from a place's plane, in its half diagonals, below which it is not aimed at: its outline is uncertain.
const MIN_HEIGHT: f64 = 1e-3;

/// A rectangle from which or through which much light comes.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct BrightPlace {
    /// Its center.
    pub center: DVec3,
    /// Half edges, perpendicular to each other.
    pub half: [DVec3; 2],
    /// Root mean square of the radiance that bounces found there.
    pub radiance: f64,
}

/// The bright places that light a room, as found by bounces.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BrightPlaces {
    /// The region from which they are aimed at.
    pub within: Bounds,
    /// The places, at most six.
    pub places: Vec<BrightPlace>,
    /// Root mean square of the radiance from elsewhere, plus the mean radiance of all bounces.
    pub elsewhere: f64,
    /// The share of the sky's light that bounces found elsewhere.
    pub missed: f64,
    /// Whether the places are openings to the sky.
    pub are_openings: bool,
}

impl BrightPlaces {
    /// Returns the places that are openings, oriented toward the room, and the share of the sky's light that they miss.
    pub fn openings(&self) -> SkyOpenings {
        let into = self.within.center();
        let opening = |&BrightPlace { center, half: [u, v], .. }: &BrightPlace| {
            let half = if u.cross(v).dot(into - center) < 0.0 { [v, u] } else { [u, v] };
            Opening { center, half }
        };
        let openings = self.places.iter().filter(|_| self.are_openings).map(opening).collect();
        SkyOpenings { openings, missed: self.missed }
    }
}

/// A bright place, prepared for sampling.
#[derive(Clone, Debug)]
struct BrightTarget {
    shape: Shape,
    center: DVec3,
    normal: DVec3,
    area: f64,
    /// Height above its plane below which it is not aimed at.
    min_height: f64,
    radiance: f64,
}

/// Bright places, prepared for the tracer.
#[derive(Clone, Debug)]
pub(super) struct AimedSampler {
    within: Bounds,
    targets: Vec<BrightTarget>,
    elsewhere: f64,
    /// Exponent of a surface's albedo in the smallest share of bounces that are not aimed.
    unaimed_exponent: i32,
}

/// The distribution of aimed bounces at one point.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aiming<'a> {
    bright: &'a AimedSampler,
    from: DVec3,
    /// Probability of each place among the aimed directions.
    chances: [f64; MAX_PLACES],
    /// Probability that a direction is aimed.
    share: f64,
}

impl AimedSampler {
    pub(super) fn new(found: &BrightPlaces) -> Self {
        let target = |place: &BrightPlace| {
            let BrightPlace { center, half: [u, v], radiance } = *place;
            BrightTarget {
                shape: Shape::Quad(Quad::new(center, u, v)),
                center,
                normal: u.cross(v).normalize(),
                area: 4.0 * u.cross(v).length(),
                min_height: MIN_HEIGHT * (u.length_squared() + v.length_squared()).sqrt(),
                radiance,
            }
        };
        let targets = found.places.iter().take(MAX_PLACES).map(target).collect();
        let unaimed_exponent = if found.are_openings { EQUAL_EXPONENT } else { FINITE_EXPONENT };
        Self { within: found.within, targets, elsewhere: ELSEWHERE_WEIGHT * found.elsewhere, unaimed_exponent }
    }

    /// Returns how to aim bounces at a point of a surface with this unit normal and albedo; `None` if they are not.
    pub(super) fn aiming(&self, from: DVec3, normal: DVec3, albedo: impl FnOnce() -> f64) -> Option<Aiming<'_>> {
        if !self.within.contains(from) {
            return None;
        }
        // Roughly what each place contributes: radiance x solid angle x cosine, bounded nearby.
        let (mut chances, mut all) = ([0.0; MAX_PLACES], 0.0);
        for (chance, target) in chances.iter_mut().zip(&self.targets) {
            let offset = target.center - from;
            let height = offset.dot(target.normal).abs();
            if height < target.min_height {
                continue;
            }
            let squared = offset.length_squared();
            let length = squared.sqrt();
            let cos_at_surface = 0.1 + (offset.dot(normal) / length).max(0.0);
            let cos_at_place = 0.05 + height / length;
            *chance = target.radiance * target.area * cos_at_surface * cos_at_place / (squared + 0.3 * target.area);
            all += *chance;
        }
        if all == 0.0 {
            return None;
        }
        chances.iter_mut().for_each(|chance| *chance /= all);
        let max_share = MAX_AIMED_SHARE.min(1.0 - albedo().min(1.0).powi(self.unaimed_exponent));
        let share = (all / (all + PI * self.elsewhere)).min(max_share);
        Some(Aiming { bright: self, from, chances, share })
    }
}

impl Aiming<'_> {
    /// Chooses between an aimed direction (`Ok`) and one by the material (`Err`), and returns the random number for it.
    pub(super) fn choose_technique(&self, u: f64) -> Result<f64, f64> {
        if u < self.share { Ok(u / self.share) } else { Err((u - self.share) / (1.0 - self.share)) }
    }

    /// Samples an aimed direction. Also returns the place that it was aimed at and its density there, if that is known.
    pub(super) fn draw(&self, [u, v]: [f64; 2]) -> Option<(DVec3, Option<(usize, f64)>)> {
        let (mut remaining, mut chosen) = (u, None);
        for (number, &chance) in self.chances.iter().enumerate().filter(|(_, chance)| **chance > 0.0) {
            chosen = Some((number, (remaining / chance).min(1.0 - f64::EPSILON)));
            if remaining < chance {
                break;
            }
            remaining -= chance;
        }
        let (number, u) = chosen?;
        let sample = self.bright.targets[number].shape.sample(self.from, [u, v])?;
        let place_density = match sample.density {
            Some(Density::SolidAngle(density)) => Some((number, density)),
            _ => None,
        };
        Some((sample.direction, place_density))
    }

    /// Returns the density of a direction that the material samples with the density `material_pdf`.
    pub(super) fn pdf(&self, direction: DVec3, material_pdf: f64) -> f64 {
        self.pdf_given(direction, material_pdf, None)
    }

    /// Returns the density of a direction, given the material's density and that of one place, if it is known.
    pub(super) fn pdf_given(&self, direction: DVec3, material_pdf: f64, known: Option<(usize, f64)>) -> f64 {
        let ray = Ray { origin: self.from, direction };
        let mut sum = 0.0;
        for (number, &chance) in self.chances.iter().enumerate().filter(|(_, chance)| **chance > 0.0) {
            sum += match known {
                Some((place, density)) if place == number => chance * density,
                _ => {
                    let shape = &self.bright.targets[number].shape;
                    let intersection = shape.intersect(&ray, f64::INFINITY);
                    intersection.map_or(0.0, |intersection| chance * shape.pdf(&ray, &intersection))
                }
            };
        }
        self.share * sum + (1.0 - self.share) * material_pdf
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{Frame, sample_cosine_hemisphere, unit};

    /// Returns three places: one upright, one lying and one tilted. All are aimed at, but from their planes.
    fn bright() -> AimedSampler {
        let place = |center: [f64; 3], u: [f64; 3], v: [f64; 3], radiance| BrightPlace {
            center: center.into(),
            half: [u.into(), v.into()],
            radiance,
        };
        let places = vec![
            place([-2.0, 1.5, 0.0], [0.0, 0.0, 1.0], [0.0, 0.7, 0.0], 1.0),
            place([0.0, 0.0, -1.0], [0.9, 0.0, 0.0], [0.0, 0.0, 0.6], 2.0),
            place([1.0, 1.0, 1.0], [0.2, 0.1, 0.0], [-0.05, 0.1, 0.3], 5.0),
        ];
        let within = Bounds { min: DVec3::splat(-3.0), max: DVec3::splat(3.0) };
        AimedSampler::new(&BrightPlaces { within, places, elsewhere: 0.05, missed: 0.0, are_openings: false })
    }

    const ROWS: usize = 12;
    const COLUMNS: usize = 24;

    /// Returns the cell of a direction: rows of equal cosine over the hemisphere, and one for all directions below.
    fn cell(frame: &Frame, direction: DVec3) -> usize {
        let local = frame.to_local(direction);
        if local.z <= 0.0 {
            return ROWS * COLUMNS;
        }
        let column = (libm::atan2(local.y, local.x) / (2.0 * PI) + 0.5) * COLUMNS as f64;
        ((local.z * ROWS as f64) as usize).min(ROWS - 1) * COLUMNS + (column as usize).min(COLUMNS - 1)
    }

    /// Directions sampled from between the places, and from a point in the plane of one, follow their density.
    #[test]
    fn aimed_directions_follow_their_density() {
        let bright = bright();
        for (from, normal) in [
            (DVec3::new(0.3, 0.9, 0.2), DVec3::NEG_X),
            (DVec3::new(0.5, 2.5, -0.5), DVec3::NEG_Y),
            (DVec3::new(0.5, 0.0, 1.0), DVec3::Y),
            (DVec3::new(2.9, 1.4, -2.0), unit(DVec3::new(-1.0, 0.3, 0.5))),
        ] {
            let aiming = bright.aiming(from, normal, || 0.5).expect("it lies within");
            let frame = Frame::about(normal);
            // Integrates the density by the midpoints of a fine grid of all directions.
            let (rows, columns) = (ROWS * 100, COLUMNS * 100);
            let mut expected = vec![0.0; ROWS * COLUMNS + 1];
            for row in 0..2 * rows {
                let z = (row as f64 + 0.5) / rows as f64 - 1.0;
                for column in 0..columns {
                    let angle = ((column as f64 + 0.5) / columns as f64 - 0.5) * 2.0 * PI;
                    let radius = (1.0 - z * z).sqrt();
                    let direction = frame.to_world(DVec3::new(radius * angle.cos(), radius * angle.sin(), z));
                    let density = aiming.pdf(direction, z.max(0.0) / PI);
                    expected[cell(&frame, direction)] += density * 2.0 * PI / (rows * columns) as f64;
                }
            }
            let sum = expected.iter().sum::<f64>();
            assert!((sum - 1.0).abs() < 1e-3, "the density sums to {sum}");
            let (mut counts, total) = (vec![0.0; expected.len()], 1 << 18);
            for number in 0..total {
                // Points of two additive sequences: well spread, but without a structure of cells.
                let u = |step: f64| (0.5 + f64::from(number) * step).fract();
                let [a, b] = [u(0.754_877_666_246_692_8), u(0.569_840_290_998_053_3)];
                let direction = match aiming.choose_technique(a) {
                    Ok(aimed) => aiming.draw([aimed, b]).expect("places are seen").0,
                    Err(own) => unit(frame.to_world(sample_cosine_hemisphere([own, b]))),
                };
                counts[cell(&frame, direction)] += 1.0;
            }
            // The sums over cells have the error of the grid. Draws vary less than independent ones would.
            for (i, (count, share)) in counts.iter().zip(&expected).enumerate() {
                let due = share * f64::from(total);
                let limit = 4.5 * due.max(1.0).sqrt() + 2e-3 * due + 5.0;
                assert!((count - due).abs() < limit, "{from} cell {i}: {count} for {due}");
            }
        }
    }

    #[test]
    fn unaimed_paths_do_not_gain_weight_without_bound() {
        let share = |only: bool, albedo: f64| {
            let bright = AimedSampler {
                elsewhere: 0.0,
                unaimed_exponent: if only { EQUAL_EXPONENT } else { FINITE_EXPONENT },
                ..bright()
            };
            bright.aiming(DVec3::new(0.3, 0.9, 0.2), DVec3::NEG_X, || albedo).expect("it lies within").share
        };
        for (albedo, among, alone) in [(0.2, 0.5, 0.5), (0.6, 0.5, 0.4), (0.8, 0.36, 0.2), (1.0, 0.0, 0.0)] {
            let found = [share(false, albedo), share(true, albedo)];
            assert!((found[0] - among).abs() + (found[1] - alone).abs() < 1e-12, "{albedo}: {found:?}");
        }
    }

    #[test]
    fn nothing_is_aimed_from_outside_of_the_room() {
        assert!(bright().aiming(DVec3::new(0.0, 3.5, 0.0), DVec3::Y, || 0.5).is_none());
    }
}
