//! Where the sky is seen from inside: through windows, doors and gaps, as directions that are learned for each place.

use super::World;
use super::directions::Directions;
use crate::light::{Environment, Light, LightId};
use crate::math::{Bounds, DVec3, Ray};
use crate::shape::Sighting;
use crate::spectrum::Table;

/// How often the sky is aimed at by what was learned; else as without, so that what was not found is at most four times as
/// bright.
const LEARNED: f64 = 0.75;

/// What is known of the sky, place by place: a grid of cells.
///
/// Vorba et al. 2014, *On-line Learning of Parametric Mixture Models for Light Transport Simulation*, and Müller et al. 2017,
/// *Practical Path Guiding for Efficient Light-Transport Simulation*, learn directions place by place for all light.
#[derive(Clone, Debug)]
pub(super) struct Openings {
    pub(super) grid: Grid,
    /// Number among `views` plus one of each cell; 0 where nothing is known.
    pub(super) cells: Vec<u32>,
    pub(super) views: Vec<SkyView>,
}

/// Cubes that fill a box.
#[derive(Clone, Copy, Debug)]
pub(super) struct Grid {
    low: DVec3,
    /// Length of a cube's edge.
    edge: f64,
    pub(super) counts: [usize; 3],
}

/// What is known of the skies around one place.
#[derive(Clone, Debug)]
pub(super) struct SkyView {
    /// Where the sky is seen; none where aiming by it would not pay.
    sky: Option<Directions>,
    /// How often each sky is chosen, of those that are, in the order of the world's choice.
    pub(super) skies: Vec<f64>,
}

impl Openings {
    /// What is known around a point.
    pub(super) fn at(&self, point: DVec3) -> Option<&SkyView> {
        let number = self.cells[self.grid.cell(point)?];
        self.views.get((number as usize).wrapping_sub(1))
    }
}

impl Grid {
    /// A box with so many cubes along its longest side.
    pub(super) fn new(bounds: &Bounds, along: usize) -> Self {
        let size = bounds.max - bounds.min;
        let edge = size.max_element() / along as f64;
        let counts = [0, 1, 2].map(|axis| ((size[axis] / edge).floor() as usize + 1).min(along));
        Self { low: bounds.min, edge, counts }
    }

    /// The cell of a point; none outside of the box.
    pub(super) fn cell(&self, point: DVec3) -> Option<usize> {
        let mut cell = 0;
        for axis in (0..3).rev() {
            let at = (point[axis] - self.low[axis]) / self.edge;
            // Points on the far side belong to the last cube.
            let last = self.counts[axis] as f64;
            if !(0.0..=last).contains(&at) {
                return None;
            }
            cell = cell * self.counts[axis] + (at as usize).min(self.counts[axis] - 1);
        }
        Some(cell)
    }

    /// The cells that share a side with one.
    pub(super) fn neighbors(&self, cell: usize) -> impl Iterator<Item = usize> {
        let [x, y, _] = self.counts;
        let (at, strides) = ([cell % x, cell / x % y, cell / (x * y)], [1, x, x * y]);
        let counts = self.counts;
        (0..3).flat_map(move |axis| {
            let before = (at[axis] > 0).then(|| cell - strides[axis]);
            let after = (at[axis] + 1 < counts[axis]).then(|| cell + strides[axis]);
            before.into_iter().chain(after)
        })
    }
}

impl SkyView {
    /// Of the light that comes from each cell of directions, up to a factor, where the sky is worth aiming by it.
    pub(super) fn new(sky: Option<&[f64]>, skies: Vec<f64>) -> Self {
        Self { sky: sky.and_then(Directions::new), skies }
    }

    /// Whether anything was learned that pays.
    pub(super) fn is_aimed(&self) -> bool {
        self.sky.is_some()
    }
}

/// The sky around a place where it was learned.
#[derive(Clone, Copy)]
pub(super) struct Aimed<'a> {
    sky: &'a Environment<Table>,
    directions: &'a Directions,
}

impl Aimed<'_> {
    /// A direction to the sky from a surface of a normal: as it is aimed at by itself, or by what was learned.
    pub(super) fn aim(self, normal: DVec3, u: [f64; 2]) -> Sighting {
        if u[0] >= LEARNED {
            return self.sky.aim(normal, [(u[0] - LEARNED) / (1.0 - LEARNED), u[1]]);
        }
        Sighting { direction: self.directions.draw([u[0] / LEARNED, u[1]]), part: None, density: None }
    }

    /// The density of a ray's direction, which `aim` draws.
    pub(super) fn pdf(self, ray: &Ray, normal: DVec3) -> f64 {
        LEARNED * self.directions.density(ray.direction) + (1.0 - LEARNED) * self.sky.pdf(ray, normal)
    }
}

impl World {
    /// What is known of the sky around a point.
    #[inline]
    pub(super) fn sky_view(&self, point: DVec3) -> Option<&SkyView> {
        self.openings.as_ref()?.at(point)
    }

    /// The sky around a point, if it was learned there.
    pub(super) fn aimed(&self, light: LightId, point: DVec3) -> Option<Aimed<'_>> {
        let Light::Environment(sky) = &self.scene.lights[light] else { return None };
        let directions = self.sky_view(point)?.sky.as_ref()?;
        Some(Aimed { sky, directions })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_of_a_box_lie_in_its_grid_and_others_do_not() {
        let bounds = Bounds { min: DVec3::new(-1.0, 0.0, 2.0), max: DVec3::new(3.0, 1.0, 4.0) };
        let grid = Grid::new(&bounds, 8);
        assert!(grid.cell(bounds.min).is_some() && grid.cell(bounds.max).is_some());
        assert_eq!(grid.cell(bounds.max + DVec3::new(1.0, 0.0, 0.0)), None);
        assert_eq!(grid.cell(bounds.min - DVec3::new(0.0, 0.1, 0.0)), None);
        assert_eq!(grid.cell(DVec3::splat(f64::NAN)), None);
        let cells: usize = grid.counts.iter().product();
        for cell in 0..cells {
            for neighbor in grid.neighbors(cell) {
                assert!(neighbor < cells && grid.neighbors(neighbor).any(|back| back == cell));
            }
        }
    }
}
