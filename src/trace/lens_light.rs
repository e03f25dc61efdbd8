//! Small lights that the lens blurs: each point of the film sees such a light through a small disc of the lens.
//!
//! Some samples of the film's points are aimed at these discs. Both kinds of samples find the same light, and the
//! balance heuristic weighs them (Veach & Guibas 1995, *Optimally Combining Sampling Techniques for Monte Carlo
//! Rendering*).

use std::collections::HashMap;
use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use super::highlight::MAX_AIMED;
use crate::light::LightId;
use crate::math::{DVec2, sample_disk};

/// A small light that the lens blurs, and the disc of the lens through which a point of the film sees it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LensLight {
    /// The light that is seen.
    pub light: LightId,
    /// The point of the film that sees it through the middle of the lens, in pixels from the top left corner of the
    /// format.
    pub center: [f64; 2],
    /// How far the middle of the disc moves to the right and up, in scene units, where the point of the film moves by a
    /// pixel to the right and down.
    pub per_pixel: [f64; 2],
    /// The radius of the disc in scene units.
    pub radius: f64,
}

impl LensLight {
    /// Returns the middle of the disc through which a point of the film sees the light.
    fn middle(&self, film: DVec2) -> DVec2 {
        (film - DVec2::from(self.center)) * DVec2::from(self.per_pixel)
    }

    /// Returns the half size of the blurred image on the film, in pixels.
    pub(super) fn half_size(&self, lens_radius: f64) -> DVec2 {
        (lens_radius + self.radius) / DVec2::from(self.per_pixel).abs()
    }
}

/// Pixels along each side of a block of the film.
const BLOCK: f64 = 16.0;

/// All small lights that the lens blurs.
#[derive(Clone, Debug, Default)]
pub(super) struct LensLights {
    lights: Vec<LensLight>,
    lens_radius: f64,
    /// The lights that points of a block of the film may see.
    blocks: HashMap<[i32; 2], Vec<u32>>,
}

impl LensLights {
    pub fn new(lights: &[LensLight], lens_radius: f64) -> Self {
        let mut blocks: HashMap<[i32; 2], Vec<u32>> = HashMap::new();
        for (number, light) in (0..).zip(lights) {
            let half = light.half_size(lens_radius);
            let [first, last] = [-half, half].map(|offset| block_of(DVec2::from(light.center) + offset));
            for block in (first[1]..=last[1]).flat_map(|y| (first[0]..=last[0]).map(move |x| [x, y])) {
                blocks.entry(block).or_default().push(number);
            }
        }
        Self { lights: lights.to_vec(), lens_radius, blocks }
    }

    /// Returns the lights that a point of the film may see, if there are any.
    #[inline]
    pub fn seen_from(&self, film: DVec2) -> Option<SeenLensLights<'_>> {
        if self.lights.is_empty() {
            return None;
        }
        let numbers = self.blocks.get(&block_of(film))?;
        let seen = SeenLensLights { all: self, numbers, film, share: 1.0 };
        let count = seen.lights().count();
        (count > 0).then(|| SeenLensLights { share: (MAX_AIMED / count as f64).min(1.0), ..seen })
    }
}

fn block_of(film: DVec2) -> [i32; 2] {
    (film / BLOCK).floor().to_array().map(|at| at as i32)
}

/// The lights that a point of the film sees through discs of the lens.
#[derive(Clone, Copy, Debug)]
pub(super) struct SeenLensLights<'a> {
    all: &'a LensLights,
    /// Those of the film's block.
    numbers: &'a [u32],
    film: DVec2,
    /// The mean number of samples that are aimed at each, at most 1.
    share: f64,
}

impl<'a> SeenLensLights<'a> {
    fn lights(&self) -> impl Iterator<Item = &'a LensLight> {
        let Self { all, film, .. } = *self;
        let is_seen = move |light: &&LensLight| light.middle(film).length() < all.lens_radius + light.radius;
        self.numbers.iter().map(|&number| &all.lights[number as usize]).filter(is_seen)
    }

    /// Returns points of the lens from which a camera sample looks at the lights: at each, or at some of them if there
    /// are many, each with the light. `u` are random numbers, the last of which chooses.
    pub fn aimed(&self, [u, v, choice]: [f64; 3]) -> impl Iterator<Item = (LightId, DVec2)> {
        let Self { all, film, share, .. } = *self;
        let mut sum = choice;
        let chosen = self.lights().filter(move |_| {
            let before = sum;
            sum += share;
            sum.floor() > before.floor()
        });
        chosen
            .map(move |light| (light.light, light.middle(film) + sample_disk([u, v]) * light.radius))
            .filter(move |(_, place)| place.length() < all.lens_radius)
    }

    /// Returns the factor on what a light sends through a point of the lens, for samples that are aimed there as well
    /// as for those of the whole lens.
    pub fn factor(&self, light: LightId, place: DVec2) -> f64 {
        let covers = |other: &&LensLight| {
            other.light == light && place.distance_squared(other.middle(self.film)) < other.radius * other.radius
        };
        let density = |radius: f64| 1.0 / (PI * radius * radius);
        let own = density(self.all.lens_radius);
        own / (own + self.lights().filter(covers).map(|light| self.share * density(light.radius)).sum::<f64>())
    }
}
