//! Small highlights: images of small lights in mirrors and glass, which the samples of a pixel seldom hit.
//!
//! Some samples of a pixel are aimed at them. Both kinds of samples find the same light, and the balance heuristic
//! weighs them (Veach & Guibas 1995, *Optimally Combining Sampling Techniques for Monte Carlo Rendering*).

use std::collections::HashMap;
use std::f64::consts::{FRAC_1_PI, TAU};
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::film::{Filter, Window};
use crate::light::LightId;
use crate::math::{BELOW_ONE, DMat2, DVec2, Distribution2d};

/// A part of the film on which surfaces show a small light: an ellipse in which samples are drawn, most densely at
/// its center.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Highlight {
    /// The light that is shown.
    pub light: LightId,
    /// The number of surfaces that mirror or refract it one after another.
    pub bounces: u32,
    /// The center of the ellipse, in pixels from the top left corner of the format.
    pub center: [f64; 2],
    /// Two conjugate radii of the ellipse, in pixels: a circle's radii after the linear map that makes it the ellipse.
    pub radii: [[f64; 2]; 2],
    /// How much the density falls toward the rim: at the share r of a radius it is proportional to
    /// 1 / (1 + peak r^2)^2. The light of a rough surface falls like that (Walter et al. 2007, *Microfacet Models for
    /// Refraction through Rough Surfaces*, equation 33). 0 draws evenly.
    pub peak: f64,
}

impl Highlight {
    /// Returns the map from the unit disk to the ellipse around its center.
    fn map(&self) -> DMat2 {
        DMat2::from_cols_array_2d(&self.radii)
    }

    /// Maps a point of the unit square to the film, in pixels, so that uniform points have this density.
    fn point(&self, [u, v]: [f64; 2]) -> DVec2 {
        // Of the density, (1 + peak) t / (1 + peak t) lies within the square t of a radius.
        let radius = (u / (1.0 + self.peak * (1.0 - u))).sqrt();
        let (sin, cos) = libm::sincos(TAU * v);
        DVec2::from(self.center) + self.map() * (DVec2::new(cos, sin) * radius)
    }

    /// Returns the density at a point of the film, per square pixel, and the point of the unit square that is mapped to
    /// it; `None` outside of the ellipse.
    fn density(&self, film: DVec2) -> Option<Density> {
        let map = self.map();
        let point = map.inverse() * (film - DVec2::from(self.center));
        let squared = point.length_squared();
        (squared < 1.0).then(|| {
            let falloff = 1.0 + self.peak * squared;
            let (most, turn) = (1.0 + self.peak, libm::atan2(point.y, point.x) / TAU);
            let pdf = FRAC_1_PI * most / (falloff * falloff * map.determinant().abs());
            let u = [squared * most / falloff, if turn < 0.0 { turn + 1.0 } else { turn }].map(|u| u.min(BELOW_ONE));
            Density { pdf, u }
        })
    }

    /// Returns the longest half axis of the ellipse, in pixels.
    pub(super) fn longest_half_axis(&self) -> f64 {
        longest_half_axis(self.map())
    }

    /// Returns whether a point of the film lies in the ellipse.
    pub(super) fn contains(&self, film: DVec2) -> bool {
        self.density(film).is_some()
    }

    /// Returns whether samples of any pixel of a window may fall into the ellipse.
    pub(super) fn is_seen_in(&self, window: Window, filter: Filter) -> bool {
        let [first, end] = window.ends();
        let [at_least, at_most] = self.pixels(filter).map(|pixel| pixel.map(i64::from));
        (0..2).all(|axis| at_most[axis] >= first[axis] && at_least[axis] < end[axis])
    }

    /// Returns the first and the last column and row of the pixels whose samples may fall into the ellipse.
    fn pixels(&self, filter: Filter) -> [[i32; 2]; 2] {
        // Along an axis, an ellipse reaches as far as the hypotenuse of both radii there.
        let half_extent = |axis: usize| self.radii[0][axis].hypot(self.radii[1][axis]) + filter.reach() - 0.5;
        let side = |axis: usize, sign: f64| (self.center[axis] + sign * half_extent(axis)).floor() as i32;
        [-1.0, 1.0].map(|sign| [0, 1].map(|axis| side(axis, sign)))
    }
}

/// Returns the longest half axis of the ellipse that a linear map makes of the unit circle.
///
/// A linear map of the plane is a sum of two: one turns and scales, the other does so after a reflection.
pub(super) fn longest_half_axis(map: DMat2) -> f64 {
    let DMat2 { x_axis: x, y_axis: y } = map;
    0.5 * ((x - y.perp()).length() + (x + y.perp()).length())
}

/// The density of a highlight at a point of the film, and the point of the unit square that is mapped to it.
struct Density {
    pdf: f64,
    u: [f64; 2],
}

/// Cells of the unit square from the center to the rim of a highlight, and around it.
const CELL_COUNTS: [usize; 2] = [12, 16];
/// Points along each side of a cell that tell how much of it a pixel sees.
const POINTS_PER_SIDE: usize = 2;
/// Share of the samples of the fullest cell around it that are also drawn in a cell: a pixel may see a part of it that
/// has none of its points.
const NEIGHBOR_SHARE: f64 = 0.25;

/// Most samples that are aimed at the highlights of a pixel, or at lights that the lens blurs, with each camera sample.
pub(super) const MAX_AIMED: f64 = 4.0;
/// Points on the rim of an ellipse that stand for all of it.
pub(super) const RIM_POINTS: u32 = 16;
/// Least value of the filter on such an ellipse, relative to the largest.
const MIN_RATIO: f64 = 0.5;

/// What a pixel sees of a highlight: samples are drawn only there.
#[derive(Clone, Debug)]
pub(super) struct SeenHighlight {
    pub(super) highlight: Arc<Highlight>,
    /// How samples are spread over the cells of the ellipse; `None` if the pixel sees all of it nearly alike.
    cells: Option<Box<Distribution2d>>,
    /// The mean value of the pixel's filter.
    value: f64,
    /// The mean number of samples that come with each camera sample, at most 1.
    pub(super) count: f64,
}

impl SeenHighlight {
    /// Returns `None` where the pixel sees nothing of the highlight.
    fn new(highlight: &Arc<Highlight>, filter: Filter, pixel: [i32; 2]) -> Option<Self> {
        if !filter.reaches(offset(highlight.center.into(), pixel), highlight.longest_half_axis()) {
            return None;
        }
        let (highlight, count) = (Arc::clone(highlight), 1.0);
        // The corners of a polygon around the ellipse.
        let (map, scale) = (highlight.map(), 1.0 / libm::cos(0.5 * TAU / f64::from(RIM_POINTS)));
        let corners = rim().map(|point| DVec2::from(highlight.center) + map * (point * scale));
        let center = filter.value(offset(highlight.center.into(), pixel));
        let values = corners.map(|corner| filter.value(offset(corner, pixel)));
        let [least, most] = values.fold([center; 2], |[least, most], value| [least.min(value), most.max(value)]);
        if least > MIN_RATIO * most || most < MIN_RATIO * least {
            return Some(Self { highlight, cells: None, value: center.abs(), count });
        }
        let cells = seen_cells(&highlight, filter, pixel);
        let value = cells.total() / (CELL_COUNTS[0] * CELL_COUNTS[1]) as f64;
        (value > 0.0).then(|| Self { highlight, cells: Some(Box::new(cells)), value, count })
    }

    /// Returns whether it may show light of a source that surfaces sent on `bounces` times.
    fn shows(&self, light: LightId, bounces: u32) -> bool {
        (self.highlight.light, self.highlight.bounces) == (light, bounces)
    }

    /// Samples a point of the film, in pixels.
    pub fn sample(&self, u: [f64; 2]) -> DVec2 {
        self.highlight.point(self.cells.as_ref().map_or(u, |cells| cells.sample_point(u)))
    }

    /// Returns the mean density of the samples that come with a camera sample at a point of the film, per square pixel.
    fn density(&self, film: DVec2) -> f64 {
        let of_cell = |u| self.cells.as_ref().map_or(1.0, |cells| cells.density(u));
        self.highlight.density(film).map_or(0.0, |Density { pdf, u }| self.count * pdf * of_cell(u))
    }
}

/// Returns points around the unit circle.
pub(super) fn rim() -> impl Iterator<Item = DVec2> {
    (0..RIM_POINTS).map(|i| {
        let (sin, cos) = libm::sincos(TAU * f64::from(i) / f64::from(RIM_POINTS));
        DVec2::new(cos, sin)
    })
}

/// Returns how much a pixel sees of the cells of a highlight, on the average of a cell.
fn seen_cells(highlight: &Highlight, filter: Filter, pixel: [i32; 2]) -> Distribution2d {
    let at = |cell: [usize; 2], point: usize| -> [f64; 2] {
        let within =
            [point % POINTS_PER_SIDE, point / POINTS_PER_SIDE].map(|i| (i as f64 + 0.5) / POINTS_PER_SIDE as f64);
        [0, 1].map(|i| (cell[i] as f64 + within[i]) / CELL_COUNTS[i] as f64)
    };
    let value = |cell, point| filter.value(offset(highlight.point(at(cell, point)), pixel)).abs();
    let points = POINTS_PER_SIDE * POINTS_PER_SIDE;
    let [columns, rows] = CELL_COUNTS;
    let mean =
        |i: usize| (0..points).map(|point| value([i % columns, i / columns], point)).sum::<f64>() / points as f64;
    let means: Vec<f64> = (0..columns * rows).map(mean).collect();
    let weight = |[x, y]: [usize; 2]| {
        let near_columns = x.saturating_sub(1)..=(x + 1).min(columns - 1);
        // The rows go around the center.
        let near_rows = [rows - 1, 0, 1].map(|step| (y + step) % rows);
        let near = near_columns.flat_map(|x| near_rows.map(|y| means[x + y * columns]));
        means[x + y * columns] + NEIGHBOR_SHARE * near.fold(0.0, f64::max)
    };
    Distribution2d::new(CELL_COUNTS, weight, |_| 1.0)
}

/// Returns those of some items that are chosen by a random number: each as often as `mean_count` says, at most once.
pub(super) fn chosen<T>(
    items: impl Iterator<Item = T>,
    mean_count: impl Fn(&T) -> f64,
    u: f64,
) -> impl Iterator<Item = T> {
    let mut sum = u;
    items.filter(move |item| {
        let before = sum;
        sum += mean_count(item);
        sum.floor() > before.floor()
    })
}

/// Returns the offset of a point of the film from the middle of a pixel.
pub(super) fn offset(film: DVec2, pixel: [i32; 2]) -> DVec2 {
    film - DVec2::from(pixel.map(f64::from)) - 0.5
}

/// The highlights of each pixel that has any.
#[derive(Clone, Debug, Default)]
pub(super) struct Highlights(HashMap<[i32; 2], Vec<SeenHighlight>>);

impl Highlights {
    pub fn new(highlights: &[Highlight], filter: Filter) -> Self {
        let mut of_pixel: HashMap<[i32; 2], Vec<SeenHighlight>> = HashMap::new();
        for highlight in highlights {
            let [[left, top], [right, bottom]] = highlight.pixels(filter);
            let highlight = Arc::new(highlight.clone());
            for pixel in (top..=bottom).flat_map(|y| (left..=right).map(move |x| [x, y])) {
                if let Some(seen) = SeenHighlight::new(&highlight, filter, pixel) {
                    of_pixel.entry(pixel).or_default().push(seen);
                }
            }
        }
        for seen in of_pixel.values_mut().filter(|seen| seen.len() as f64 > MAX_AIMED) {
            let all: f64 = seen.iter().map(|highlight| highlight.value).sum();
            seen.iter_mut().for_each(|highlight| highlight.count = (MAX_AIMED * highlight.value / all).min(1.0));
        }
        Self(of_pixel)
    }

    /// Returns the highlights at which some samples of a pixel are aimed.
    #[inline]
    pub fn of_pixel(&self, pixel: [i32; 2]) -> &[SeenHighlight] {
        if self.0.is_empty() { &[] } else { self.0.get(&pixel).map_or(&[], Vec::as_slice) }
    }
}

/// Returns the density of a pixel's ordinary samples, per square pixel.
pub(super) fn density(filter: Filter, offset: DVec2) -> f64 {
    filter.value(offset).abs() / filter.absolute_integral()
}

/// Returns the mean density of the samples that come with a camera sample and are aimed at highlights of a light after
/// so many bounces, per square pixel.
pub(super) fn density_of(highlights: &[SeenHighlight], light: LightId, bounces: u32, film: DVec2) -> f64 {
    highlights.iter().filter(|highlight| highlight.shows(light, bounces)).map(|highlight| highlight.density(film)).sum()
}
