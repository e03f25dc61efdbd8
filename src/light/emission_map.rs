//! The brightness that an image gives to the places of a lamp, by which they are sampled.

use rayon::prelude::*;

use crate::math::Distribution2d;
use crate::shape::{Coordinates, TexturedShape};
use crate::spectrum::CurveKind;

/// The brightness of each part of a surface that shows an image, and of the cells of a grid on each part.
///
/// Cells are about as large as texels; in large images, each holds several. A part that is nearly even has none.
#[derive(Clone, Debug)]
pub struct EmissionMap {
    /// Mean brightness of the lamp, where brightness is the mean of red, green and blue.
    pub(super) mean: f64,
    /// Mean brightness with each place weighted by its light: the mean square over the mean.
    pub(super) brightness: f64,
    parts: Vec<Part>,
}

/// A part of the surface: a triangle, a face, or all of it.
#[derive(Clone, Debug)]
struct Part {
    mean: f64,
    cells: Option<Box<Distribution2d>>,
}

/// Maximum number of cells of a lamp. They take 8 MB.
const MAX_CELLS: f64 = (1 << 20) as f64;
/// Maximum number of texels along an edge of a part.
const MAX_TEXELS: f64 = MAX_CELLS;
/// Maximum number of places at which a lamp is evaluated. Each cell has at least two along each side regardless.
const MAX_SAMPLES: f64 = (1 << 25) as f64;
/// Ratio of a part's mean squared brightness to its squared mean above which cells save more than they cost.
const UNEVENNESS: f64 = 1.3;
/// Value of `UNEVENNESS` for a round shape, where cells behind the horizon are drawn as often as those in front of it.
const ROUND_UNEVENNESS: f64 = 4.0;
/// Weight of a part's own brightness in its weight, against the lamp's: no part is left out because it seemed dark.
const OWN_WEIGHT: f64 = 0.9;

impl EmissionMap {
    /// Creates the map of a shape with an image or a pattern; `None` if nothing varies, or if the shape is infinite.
    pub fn new(kind: &CurveKind, surface: TexturedShape) -> Option<Self> {
        let shape = surface.shape;
        let resolution = kind.resolution().filter(|_| shape.is_bounded())?;
        let count = shape.part_count().max(1);
        let texels = |part| {
            let along = |[u, v]: [f64; 2]| u * resolution[0] + v * resolution[1];
            surface.edges(part).map(|edge| along(edge).clamp(1.0, MAX_TEXELS))
        };
        let texel_count: f64 = (0..count).map(|part| texels(part).iter().product::<f64>()).sum();
        let coarsening = (texel_count / MAX_CELLS).max(1.0).sqrt();
        let samples = (MAX_SAMPLES / texel_count.min(MAX_CELLS).max(count.into())).sqrt().max(2.0);
        let min_unevenness =
            if matches!(surface.coordinates, Coordinates::Sphere { .. }) { ROUND_UNEVENNESS } else { UNEVENNESS };
        let grid = |part| {
            Grid::new(texels(part), [coarsening, samples], move |place| {
                let uv = surface.coordinates_at(part, place)?;
                Some([kind.brightness_at(uv), surface.growth(place)])
            })
        };
        let measured_parts: Vec<(Part, f64)> =
            (0..count).into_par_iter().map(|part| grid(part).part(min_unevenness)).collect();
        let area = |part| shape.part(part).map_or(1.0, |part| part.area());
        let [mut light, mut squares, mut total_area] = [0.0; 3];
        for (number, (part, square)) in measured_parts.iter().enumerate() {
            let area = area(number as u32);
            light += area * part.mean;
            squares += area * square;
            total_area += area;
        }
        let brightness = if light > 0.0 { squares / light } else { 0.0 };
        let parts = measured_parts.into_iter().map(|(part, _)| part).collect();
        Some(Self { mean: light / total_area, brightness, parts })
    }

    /// Returns the weight of a unit of area of a part.
    pub(super) fn part_weight(&self, part: u32) -> f64 {
        OWN_WEIGHT * self.parts[part as usize].mean + (1.0 - OWN_WEIGHT) * self.mean
    }

    pub(super) fn has_cells(&self) -> bool {
        self.parts.iter().any(|part| part.cells.is_some())
    }

    /// Returns the cells of a part, each drawn in proportion to its light; `None` if the part is nearly even.
    pub(super) fn cells(&self, part: u32) -> Option<&Distribution2d> {
        self.parts[part as usize].cells.as_deref()
    }
}

/// The unit square on a part, cut into cells of equal size.
struct Grid<F> {
    size: [usize; 2],
    samples: [usize; 2],
    /// The brightness at a place, and the area that it stands for; `None` beside the shape.
    evaluate: F,
}

impl<F: Fn([f64; 2]) -> Option<[f64; 2]> + Sync> Grid<F> {
    /// Creates the grid of a part that spans `texels`. Its cells are coarser than texels by a factor of 1 or more, and
    /// are evaluated in at most `most` rows and columns each.
    fn new(texels: [f64; 2], [coarsening, most]: [f64; 2], evaluate: F) -> Self {
        let size = texels.map(|texels| (texels / coarsening).ceil());
        // Two places per side are exact within an interpolated texel, and one per texel is where a cell holds several.
        let samples = [0, 1].map(|i| (texels[i] / size[i]).ceil().clamp(2.0, most) as usize);
        Self { size: size.map(|cells| cells as usize), samples, evaluate }
    }

    /// Returns the part, and its mean squared brightness.
    fn part(&self, min_unevenness: f64) -> (Part, f64) {
        let [columns, rows] = self.size;
        let cell = |number: usize| self.cell([number % columns, number / columns]);
        let cells: Vec<[f64; 2]> = (0..columns * rows).into_par_iter().with_min_len(256).map(cell).collect();
        let (mut light, mut area, mut square) = (0.0, 0.0, 0.0);
        for [cell_light, its_area] in cells.iter().copied().filter(|[_, area]| *area > 0.0) {
            light += cell_light;
            area += its_area;
            square += cell_light * cell_light / its_area;
        }
        let area = area.max(f64::MIN_POSITIVE);
        let (mean, square) = (light / area, square / area);
        let needs_cells = cells.len() > 1 && square > min_unevenness * mean * mean;
        let build_cells = || Box::new(Distribution2d::new(self.size, |[x, y]| cells[y * columns + x][0], |_| 1.0));
        (Part { mean, cells: needs_cells.then(build_cells) }, square)
    }

    /// Returns the light of a cell and its area.
    fn cell(&self, cell: [usize; 2]) -> [f64; 2] {
        let [mut light, mut area] = [0.0; 2];
        for (i, j) in (0..self.samples[1]).flat_map(|j| (0..self.samples[0]).map(move |i| (i, j))) {
            let within = [i, j].map(|at| at as f64 + 0.5);
            let place = |k: usize| (cell[k] as f64 + within[k] / self.samples[k] as f64) / self.size[k] as f64;
            if let Some([brightness, its_area]) = (self.evaluate)([place(0), place(1)]) {
                light += brightness * its_area;
                area += its_area;
            }
        }
        [light, area]
    }
}
