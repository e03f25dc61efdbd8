//! Pairs of objects whose boxes meet.

use crate::math::Bounds;

/// Surfaces nearer than this fraction of a body's size count as coinciding: far above rounding errors, far below
/// anything intended.
pub(super) const NEAR: f64 = 1e-9;
/// Maximum number of pairs that are found. Further pairs are ignored.
pub(super) const MAX_PAIRS: usize = 20_000;
/// Maximum number of grid cells that an object covers. A larger object is compared with all others.
const MAX_CELLS: usize = 16;

/// Finds pairs of objects whose boxes meet, the first of which is marked in `is_checked`. Objects are visited in the
/// order in which they begin along the longest side of the scene. Each is compared with those that have not ended yet
/// (Cohen et al. 1995, *I-COLLIDE*, sweep and prune) and that share a cell with it in a grid across that side. Objects
/// without a box are in no pair.
pub(super) fn near_pairs(boxes: &[Option<Bounds>], is_checked: &[bool]) -> Vec<(usize, usize)> {
    if !is_checked.contains(&true) {
        return Vec::new();
    }
    let grid = Grid::new(boxes);
    let from = |boxed: &Boxed| boxed.bounds.min[grid.along] - tolerance(&boxed.bounds);
    let to = |boxed: &Boxed| boxed.bounds.max[grid.along] + tolerance(&boxed.bounds);
    let mut order: Vec<Boxed> = (0..boxes.len()).filter_map(|object| Boxed::from_bounds(boxes, object)).collect();
    order.sort_by(|a, b| from(a).total_cmp(&from(b)));
    // Most objects of most scenes are not marked, and are compared only with the few that are.
    let (mut open, mut open_checked) = (OpenObjects::new(&grid), OpenObjects::new(&grid));
    let (mut pairs, mut near) = (Vec::new(), Vec::new());
    for (place, boxed) in order.iter().enumerate() {
        let others = if is_checked[boxed.object] { &mut open } else { &mut open_checked };
        others.find(&grid, &boxed.bounds, |other| to(&order[other]) >= from(boxed), &mut near);
        for &other in &near {
            if let Some(pair) = pair(is_checked, boxed, &order[other]) {
                pairs.push(pair);
                if pairs.len() == MAX_PAIRS {
                    return pairs;
                }
            }
        }
        open.add(&grid, &boxed.bounds, place);
        if is_checked[boxed.object] {
            open_checked.add(&grid, &boxed.bounds, place);
        }
    }
    pairs
}

/// An object with its box.
struct Boxed {
    object: usize,
    bounds: Bounds,
}

impl Boxed {
    fn from_bounds(boxes: &[Option<Bounds>], object: usize) -> Option<Self> {
        Some(Self { object, bounds: boxes[object]? })
    }
}

/// Returns two objects as a pair, the first of which is marked in `is_checked`, if one is and their boxes meet.
fn pair(is_checked: &[bool], one: &Boxed, other: &Boxed) -> Option<(usize, usize)> {
    let (low, high) = if one.object < other.object { (one, other) } else { (other, one) };
    let (first, second) = if is_checked[low.object] { (low, high) } else { (high, low) };
    (is_checked[first.object] && may_touch(&first.bounds, &second.bounds)).then_some((first.object, second.object))
}

/// Returns the distance within which the surfaces of a body and another object count as coinciding.
fn tolerance(of: &Bounds) -> f64 {
    of.size().max_element() * NEAR
}

/// Returns whether the boxes of a body and another object meet.
fn may_touch(a: &Bounds, b: &Bounds) -> bool {
    let tolerance = tolerance(a);
    (a.min - tolerance).cmple(b.max).all() && (b.min - tolerance).cmple(a.max).all()
}

/// A grid of cells across the longest side of a scene. It has as many cells each way as a cubic grid with one cell for
/// each object.
struct Grid {
    along: usize,
    across: [usize; 2],
    /// Where the grid begins, and the number of cells per unit of length.
    from: [f64; 2],
    per_length: [f64; 2],
    cells: usize,
}

impl Grid {
    fn new(boxes: &[Option<Bounds>]) -> Self {
        let around = Bounds::around(boxes.iter().flatten().map(Bounds::center));
        let size = around.size();
        let along = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
        let across = [(along + 1) % 3, (along + 2) % 3];
        let cells = (boxes.len() as f64).cbrt().ceil();
        let per_length = across.map(|axis| if size[axis] > 0.0 { cells / size[axis] } else { 0.0 });
        Self { along, across, from: across.map(|axis| around.min[axis]), per_length, cells: cells as usize }
    }

    /// Returns the first and the last cell that an object covers each way.
    fn covered(&self, of: &Bounds) -> [[usize; 2]; 2] {
        let (tolerance, last) = (tolerance(of), self.cells.saturating_sub(1));
        [0, 1].map(|side| {
            let axis = self.across[side];
            // Numbers beyond the ends go into the cells there, and NaN into the first.
            let cell = |at: f64| (((at - self.from[side]) * self.per_length[side]) as usize).min(last);
            [cell(of.min[axis] - tolerance), cell(of.max[axis] + tolerance)]
        })
    }

    /// Returns the indices of the cells that an object covers.
    fn cells(&self, of: &Bounds) -> impl Iterator<Item = usize> {
        let (cells, [[left, right], [low, high]]) = (self.cells, self.covered(of));
        (low..=high).flat_map(move |row| (left..=right).map(move |column| row * cells + column))
    }

    /// Returns whether an object covers few cells.
    fn is_small(&self, of: &Bounds) -> bool {
        self.covered(of).map(|[first, last]| last - first + 1).iter().product::<usize>() <= MAX_CELLS
    }
}

/// Objects that have begun and are not known to have ended, by their positions in the order.
struct OpenObjects {
    by_cell: Vec<Vec<usize>>,
    /// Objects that cover many cells.
    large: Vec<usize>,
}

impl OpenObjects {
    fn new(grid: &Grid) -> Self {
        Self { by_cell: vec![Vec::new(); grid.cells * grid.cells], large: Vec::new() }
    }

    fn add(&mut self, grid: &Grid, of: &Bounds, place: usize) {
        match grid.is_small(of) {
            true => grid.cells(of).for_each(|cell| self.by_cell[cell].push(place)),
            false => self.large.push(place),
        }
    }

    /// Finds the open objects that may meet an object, in their order. Removes those that have ended.
    fn find(&mut self, grid: &Grid, of: &Bounds, is_open: impl Fn(usize) -> bool, found: &mut Vec<usize>) {
        found.clear();
        let mut take = |places: &mut Vec<usize>| {
            places.retain(|&place| is_open(place));
            found.extend_from_slice(places);
        };
        take(&mut self.large);
        grid.cells(of).for_each(|cell| take(&mut self.by_cell[cell]));
        found.sort_unstable();
        found.dedup();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{BranchKey, DVec3, Sampler};

    fn around(center: DVec3, half: DVec3) -> Option<Bounds> {
        Some(Bounds { min: center - half, max: center + half })
    }

    #[test]
    fn all_pairs_are_found_whatever_the_sizes() {
        for sides in [DVec3::new(1.0, 1.0, 1.0), DVec3::new(0.2, 5.0, 1.0), DVec3::new(0.0, 0.0, 3.0)] {
            let random = |number, of| DVec3::from_slice(&Sampler::new(0, [0, of], number).get_4d(BranchKey::CAMERA, 0));
            // Small ones, large ones, and some without bounds.
            let size = |number: u32| [0.02, 0.05, 0.5][number as usize % 3];
            let boxed = |number: u32| {
                (number % 40 != 7).then(|| around(random(number, 0) * sides, random(number, 1) * size(number)))
            };
            let boxes: Vec<Option<Bounds>> = (0..300).map(|number| boxed(number).flatten()).collect();
            let is_checked: Vec<bool> = (0..300).map(|number| number % 4 == 0).collect();
            let all = (0..300).flat_map(|low| (low + 1..300).map(move |high| [low, high]));
            let boxed = |number: usize| Boxed::from_bounds(&boxes, number);
            let expected = all.filter_map(|[low, high]| pair(&is_checked, &boxed(low)?, &boxed(high)?));
            let mut expected: Vec<_> = expected.collect();
            expected.sort_unstable();
            let mut found = near_pairs(&boxes, &is_checked);
            found.sort_unstable();
            assert_eq!(found, expected);
        }
    }

    /// Previously, each of a million beads was compared with ten thousand others.
    #[test]
    fn beads_in_a_lattice_are_compared_with_their_neighbors_alone() {
        let places =
            (0..8000).map(|number| DVec3::new((number / 400).into(), (number / 20 % 20).into(), (number % 20).into()));
        let boxes: Vec<Option<Bounds>> = places.map(|place| around(place, DVec3::splat(0.4))).collect();
        let grid = Grid::new(&boxes);
        let (mut open, mut near, mut compared) = (OpenObjects::new(&grid), Vec::new(), 0);
        for (place, of) in boxes.iter().flatten().enumerate() {
            let from = of.min[grid.along];
            open.find(&grid, of, |other| boxes[other].is_some_and(|other| other.max[grid.along] >= from), &mut near);
            compared += near.len();
            open.add(&grid, of, place);
        }
        assert!(compared < 10 * boxes.len(), "{compared} comparisons");
    }
}
