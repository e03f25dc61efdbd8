//! Small lights that the lens blurs, and their images in mirrors and glass: each point of the film sees such a light
//! through a small part of the lens.
//!
//! Some samples of the film's points are aimed at these parts. Both kinds of samples find the same light, and the
//! balance heuristic weighs them (Veach & Guibas 1995, *Optimally Combining Sampling Techniques for Monte Carlo
//! Rendering*).

use std::collections::HashMap;
use std::f64::consts::PI;

use serde::{Deserialize, Serialize};

use super::highlight::{MAX_AIMED, chosen, longest_half_axis};
use crate::film::{Filter, Window};
use crate::light::LightId;
use crate::math::{DMat2, DVec2, sample_disk};
use crate::scene::FilmSettings;

/// A small light that the lens blurs, or its image in surfaces, and the ellipse of the lens through which a point of
/// the film sees it. Places on the lens are in scene units to the right and up, those of the film in pixels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LensLight {
    /// The light that is seen.
    pub light: LightId,
    /// The number of surfaces that mirror or refract it one after another.
    pub bounces: u32,
    /// The point of the film that sees it through the middle of the lens, from the top left corner of the format.
    pub center: [f64; 2],
    /// How far the middle of the ellipse moves on the lens where the point of the film moves by a pixel to the right,
    /// and down.
    pub per_pixel: [[f64; 2]; 2],
    /// Two conjugate radii of the ellipse on the lens: a circle's radii after the linear map that makes it the ellipse.
    pub radii: [[f64; 2]; 2],
}

impl LensLight {
    /// Returns the map from the unit disk to the ellipse around its middle.
    fn map(&self) -> DMat2 {
        DMat2::from_cols_array_2d(&self.radii)
    }

    /// Returns the map from offsets on the film to those on the lens.
    fn to_lens(&self) -> DMat2 {
        DMat2::from_cols_array_2d(&self.per_pixel)
    }

    /// Returns the middle of the ellipse through which a point of the film sees the light.
    fn middle(&self, film: DVec2) -> DVec2 {
        self.to_lens() * (film - DVec2::from(self.center))
    }

    /// Returns how far the ellipse reaches at most.
    fn reach(&self) -> f64 {
        longest_half_axis(self.map())
    }

    /// Returns whether samples of any pixel of a window may see it.
    pub(super) fn is_seen_in(&self, window: Window, filter: Filter, lens_radius: f64) -> bool {
        let half = self.half_size(lens_radius);
        let [first, end] = ends_of_samples(window, filter);
        let center = DVec2::from(self.center);
        (center + half).cmpge(first).all() && (center - half).cmple(end).all()
    }

    /// Returns the share of the lens that the ellipse covers.
    pub(super) fn share(&self, lens_radius: f64) -> f64 {
        self.map().determinant().abs() / (lens_radius * lens_radius)
    }

    /// Returns half the size of a box around the blurred image on the film, in pixels.
    pub(super) fn half_size(&self, lens_radius: f64) -> DVec2 {
        let rows = self.to_lens().inverse().transpose();
        (lens_radius + self.reach()) * DVec2::new(rows.x_axis.length(), rows.y_axis.length())
    }
}

/// Pixels along each side of a block of the film.
const BLOCK: f64 = 16.0;

/// All small lights that the lens blurs.
#[derive(Clone, Debug, Default)]
pub(super) struct LensLights {
    lights: Vec<LensLight>,
    /// How far from the middle of the lens the middle of each one's ellipse may be.
    limits: Vec<f64>,
    lens_radius: f64,
    /// The lights that points of a block of the film may see.
    blocks: HashMap<[i32; 2], Vec<u32>>,
}

impl LensLights {
    /// Sorts the lights into blocks of a film with a lens of some radius.
    pub fn new(lights: &[LensLight], lens_radius: f64, film: &FilmSettings) -> Self {
        let mut blocks: HashMap<[i32; 2], Vec<u32>> = HashMap::new();
        let [low, high] = ends_of_samples(film.whole(), film.filter);
        for (number, light) in (0..).zip(lights) {
            let half = light.half_size(lens_radius);
            let [first, last] =
                [-half, half].map(|offset| block_of((DVec2::from(light.center) + offset).clamp(low, high)));
            for block in (first[1]..=last[1]).flat_map(|y| (first[0]..=last[0]).map(move |x| [x, y])) {
                blocks.entry(block).or_default().push(number);
            }
        }
        let limits = lights.iter().map(|light| lens_radius + light.reach()).collect();
        Self { lights: lights.to_vec(), limits, lens_radius, blocks }
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

/// Returns the first and the last points of the film from which samples of a window come.
fn ends_of_samples(window: Window, filter: Filter) -> [DVec2; 2] {
    let [first, end] = window.ends().map(|at| DVec2::from(at.map(|at| at as f64)));
    [first - filter.reach(), end + filter.reach()]
}

fn block_of(film: DVec2) -> [i32; 2] {
    (film / BLOCK).floor().to_array().map(|at| at as i32)
}

/// The lights that a point of the film sees through parts of the lens.
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
        let seen = move |&number: &u32| {
            let (light, limit) = (&all.lights[number as usize], all.limits[number as usize]);
            (light.middle(film).length() < limit).then_some(light)
        };
        self.numbers.iter().filter_map(seen)
    }

    /// Returns points of the lens from which a camera sample looks at the lights, with random numbers of which the last
    /// one chooses: at each light, or at some of them if there are many.
    pub fn aimed(&self, [u, v, choice]: [f64; 3]) -> impl Iterator<Item = LensPoint<'a>> {
        let Self { all, film, share, .. } = *self;
        chosen(self.lights(), move |_| share, choice)
            .map(move |light| LensPoint { light, place: light.middle(film) + light.map() * sample_disk([u, v]) })
            .filter(move |point| point.place.length() < all.lens_radius)
    }

    /// Returns the factor on what a light sends through a point of the lens after so many bounces, for samples that are
    /// aimed there as well as for those of the whole lens.
    pub fn factor(&self, light: LightId, bounces: u32, place: DVec2) -> f64 {
        let density_of = |other: &LensLight| {
            let map = other.map();
            let offset = map.inverse() * (place - other.middle(self.film));
            if offset.length_squared() < 1.0 { self.share / (PI * map.determinant().abs()) } else { 0.0 }
        };
        let own = 1.0 / (PI * self.all.lens_radius * self.all.lens_radius);
        let shown = self.lights().filter(|other| (other.light, other.bounces) == (light, bounces));
        own / (own + shown.map(density_of).sum::<f64>())
    }
}

/// A point of the lens from which a sample looks at a light.
pub(super) struct LensPoint<'a> {
    pub light: &'a LensLight,
    pub place: DVec2,
}
