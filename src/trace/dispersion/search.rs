//! Where dispersion is seen in the view, even if only in small parts of the picture.
//!
//! The view is divided into cells. A cell whose beam may touch a smooth object that its rays have not hit is
//! subdivided, down to a part of a pixel. Small objects are thus found even behind panes, in mirrors and in water, by a
//! number of rays that does not depend on the number of pixels. Beams of rays: Amanatides 1984, *Ray Tracing with
//! Cones*; Heckbert & Hanrahan 1984, *Beam Tracing Polygonal Objects*.

use super::color_separation::{color_separation, is_dark, separated_share};
use super::color_walk::{CameraRays, ColorWalk, Colors, FollowedBranch};
use super::targets::{SEEN_PIXELS, Targets};
use crate::math::{DVec2, DVec3, Sampler};

/// Number of cells along each side of the view.
const CELLS_PER_SIDE: u32 = 24;
/// Maximum number of cells that are examined after the initial ones.
const MAX_CELLS: usize = 6000;
/// Cells of this size or less, in pixels, are not divided.
const MIN_CELL_SIZE: f64 = 0.5;
/// Smallest area of the view that counts, in pixels, or as a share of an image that has few pixels. It changes one
/// pixel as much as an edge whose colors are just seen apart changes the pixels along it.
const MIN_AREA_PIXELS: f64 = SEEN_PIXELS;
const MIN_AREA_SHARE: f64 = 0.005;
/// Number of pixels that are examined more closely each time.
const CLOSE_LOOKS: usize = 32;
/// A pixel of which this share is pulled apart changes as much as one at an edge whose colors are just seen apart: over
/// such an edge, the colors between the outermost two are moved by half as much.
const SEEN_SHARE: f64 = 0.5 * SEEN_PIXELS;

/// A place on a diffuse surface that is seen by way of other surfaces.
pub struct ReachedPlace {
    pub position: DVec3,
    /// The size of a pixel there, and that of the cell.
    pub pixel_size: f64,
    pub cell_size: f64,
    /// Number of surfaces between it and the camera.
    pub surfaces: u32,
}

/// The result of a search.
pub struct SearchResult {
    /// Share of the view on dispersive surfaces.
    pub dispersive_share: f64,
    /// How many pixels apart colors are, on an area of [`MIN_AREA_PIXELS`] or more.
    pub pixels: f64,
    /// Whether no ray that hit a dispersive surface saw anything.
    pub dark: bool,
    pub reached: Vec<ReachedPlace>,
}

/// A part of the view, in pixels.
#[derive(Clone, Copy)]
struct ViewCell {
    corner: DVec2,
    size: DVec2,
    choice: FollowedBranch,
    /// Number of such cells that it stands for.
    count: f64,
}

/// What was seen in a cell.
struct Look {
    cell: ViewCell,
    /// The area, in pixels, of the cell's part on dispersive surfaces, and the share of light that goes this way.
    dispersive: f64,
    weight: f64,
    /// How many pixels apart colors are; `None` if that cannot be told.
    separation: Option<f64>,
    /// Whether its ray leaves a scene that no sky shines on.
    dark: bool,
    /// The target it may show a part of.
    touched: Option<usize>,
}

/// Searches the whole view for dispersion.
pub fn search(colors: &Colors, targets: &Targets) -> SearchResult {
    let film = colors.world.scene.film;
    let all = f64::from(film.width) * f64::from(film.height);
    let min_area = MIN_AREA_PIXELS.min(MIN_AREA_SHARE * all);
    let size = DVec2::new(f64::from(film.width), f64::from(film.height)) / f64::from(CELLS_PER_SIDE);
    let corner = |i: u32| DVec2::new(f64::from(i % CELLS_PER_SIDE), f64::from(i / CELLS_PER_SIDE)) * size;
    let cell = |i: u32| ViewCell { corner: corner(i), size, choice: FollowedBranch::Brighter, count: 1.0 };
    let mut cells: Vec<ViewCell> = (0..CELLS_PER_SIDE * CELLS_PER_SIDE).map(cell).collect();
    let (mut settled, mut reached, mut budget) = (Vec::new(), Vec::new(), MAX_CELLS);
    loop {
        let mut forks = Vec::new();
        let mut looks: Vec<Look> =
            cells.iter().map(|cell| look(colors, targets, *cell, &mut reached, &mut forks)).collect();
        look_closer(colors, &mut looks);
        let pixels = visible_separation(settled.iter().chain(&looks), min_area);
        if pixels >= SEEN_PIXELS || budget == 0 {
            settled.extend(looks);
            break;
        }
        let (divided, whole): (Vec<Look>, Vec<Look>) =
            looks.into_iter().partition(|look| look.touched.is_some() && look.cell.size.max_element() > MIN_CELL_SIZE);
        settled.extend(whole);
        let mut next: Vec<(usize, ViewCell)> = Vec::new();
        for look in &divided {
            next.extend(look.cell.parts().into_iter().map(|part| (look.touched.unwrap_or(0), part)));
        }
        // Faint mirror images form groups of their own.
        let kind = |cell: &ViewCell| targets.all.len() + usize::from(cell.choice == FollowedBranch::FainterInside);
        next.extend(forks.into_iter().map(|cell| (kind(&cell), cell)));
        if next.is_empty() {
            break;
        }
        let limit = (budget / 3).max(512).min(budget);
        cells = choose_fairly(next, limit);
        budget -= cells.len();
    }
    let seen: f64 =
        settled.iter().filter(|look| look.cell.choice == FollowedBranch::Brighter).map(|look| look.dispersive).sum();
    let dark = seen > 0.0 && settled.iter().all(|look| look.dark || look.dispersive == 0.0);
    SearchResult {
        dispersive_share: (seen / all).min(1.0),
        pixels: visible_separation(settled.iter(), min_area),
        dark,
        reached,
    }
}

fn look(
    colors: &Colors,
    targets: &Targets,
    cell: ViewCell,
    reached: &mut Vec<ReachedPlace>,
    forks: &mut Vec<ViewCell>,
) -> Look {
    let rays = cell.rays(colors);
    let points = [DVec2::new(0.5, 0.5), DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
    let walks = points.map(|place| rays.walk(cell.corner + cell.size * place, 0));
    let first = &walks[0];
    if cell.is_undivided(colors) && cell.choice == FollowedBranch::Brighter {
        if first.fork > 0.0 {
            forks.push(ViewCell { choice: FollowedBranch::FainterFirst, ..cell });
        }
        // In front of a sky, or the dark, internal reflections may be all there is to see.
        if first.fork_inside > 0.0 && first.leaves_scene() {
            forks.push(ViewCell { choice: FollowedBranch::FainterInside, ..cell });
        }
        reached.extend(place(&walks, cell.size));
    }
    let has_fork = match cell.choice {
        FollowedBranch::Brighter => true,
        FollowedBranch::FainterFirst => first.fork > 0.0,
        FollowedBranch::FainterInside => first.fork_inside > 0.0,
    };
    let is_lost = first.weight == 0.0 || !has_fork;
    let dispersive = if first.dispersive && !is_lost { cell.size.x * cell.size.y * cell.count } else { 0.0 };
    let separation = if dispersive > 0.0 { color_separation(&rays, cell.middle(), first) } else { None };
    let width = colors.world.scene.camera.pixel_angle() * cell.size.length();
    let dark = first.leaves_scene() && is_dark(colors.world);
    Look { cell, dispersive, weight: first.weight, separation, dark, touched: targets.touched(&walks, width) }
}

/// Examines a whole pixel where one ray is not enough. Between the edges of small gems it hardly ever is. Where it is,
/// it lies in the largest facets, many of which are parallel.
fn look_closer(colors: &Colors, looks: &mut [Look]) {
    let undecided: Vec<&mut Look> =
        looks.iter_mut().filter(|look| look.dispersive > 0.0 && look.separation.is_none()).collect();
    let step = undecided.len().div_ceil(CLOSE_LOOKS).max(1);
    for look in undecided.into_iter().step_by(step) {
        let share = separated_share(&look.cell.rays(colors), look.cell.middle());
        look.separation = Some(if share >= SEEN_SHARE { SEEN_PIXELS } else { 0.0 });
        if share >= SEEN_SHARE {
            // The whole pixel was examined.
            (look.dispersive, look.weight) = (look.dispersive.max(1.0), 1.0);
        }
    }
}

/// Returns the place where the first of a cell's walks ends, if that is on a diffuse surface seen by way of others.
fn place(walks: &[ColorWalk; 5], size: DVec2) -> Option<ReachedPlace> {
    let diffuse_end = |walk: &ColorWalk| walk.end.filter(|_| walk.diffuse).map(|end| end.0.position);
    let position = diffuse_end(&walks[0]).filter(|_| !walks[0].crossed_objects.is_empty())?;
    let neighbors =
        walks[1..].iter().filter(|walk| walk.crossed_objects == walks[0].crossed_objects).filter_map(diffuse_end);
    let cell_size = neighbors.map(|other| (other - position).length()).fold(0.0, f64::max);
    let (pixel_size, surfaces) = (cell_size / (0.5 * size.length()), walks[0].surfaces);
    (cell_size > 0.0).then_some(ReachedPlace { position, pixel_size, cell_size, surfaces })
}

impl ViewCell {
    fn middle(&self) -> DVec2 {
        self.corner + self.size * 0.5
    }

    fn rays<'a>(&self, colors: &'a Colors) -> CameraRays<'a> {
        let DVec2 { x, y } = self.middle();
        let sampler = Sampler::of_pixel(colors.world.method.seed, [x as i32, y as i32], 0);
        CameraRays { colors, sampler, choice: self.choice }
    }

    fn is_undivided(&self, colors: &Colors) -> bool {
        self.size.x * f64::from(CELLS_PER_SIDE) >= f64::from(colors.world.scene.film.width)
    }

    /// Returns its halves along each side that can be divided.
    fn parts(&self) -> Vec<Self> {
        let count = |size: f64| if size > MIN_CELL_SIZE { 2 } else { 1 };
        let (columns, rows) = (count(self.size.x), count(self.size.y));
        let size = self.size / DVec2::new(f64::from(columns), f64::from(rows));
        let part = |i: u32| Self {
            corner: self.corner + size * DVec2::new(f64::from(i % columns), f64::from(i / columns)),
            size,
            ..*self
        };
        (0..columns * rows).map(part).collect()
    }
}

/// Returns at most `limit` cells. All targets get the same number, and those that need less leave the rest to others.
fn choose_fairly(mut cells: Vec<(usize, ViewCell)>, limit: usize) -> Vec<ViewCell> {
    cells.sort_by_key(|cell| cell.0);
    let mut groups: Vec<&[(usize, ViewCell)]> = cells.chunk_by(|a, b| a.0 == b.0).collect();
    groups.sort_by_key(|group| group.len());
    let (mut chosen, mut budget) = (Vec::new(), limit);
    for (number, group) in groups.iter().enumerate() {
        let share = (budget / (groups.len() - number)).min(group.len());
        let count = group.len() as f64 / share.max(1) as f64;
        let pick = |i: usize| group[i * group.len() / share].1;
        chosen.extend((0..share).map(pick).map(|cell| ViewCell { count: cell.count * count, ..cell }));
        budget -= share;
    }
    chosen
}

/// Returns how many pixels apart colors are, on `min_area` pixels or more. Where that is unknown, it is as elsewhere.
fn visible_separation<'a>(looks: impl Iterator<Item = &'a Look> + Clone, min_area: f64) -> f64 {
    let area = |look: &Look| look.dispersive * look.weight;
    let all: f64 = looks.clone().map(area).sum();
    let mut known: Vec<(f64, f64)> = looks.filter_map(|look| Some((look.separation?, area(look)))).collect();
    let known_area: f64 = known.iter().map(|known| known.1).sum();
    known.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut sum = 0.0;
    for (pixels, area) in known {
        sum += area * all / known_area;
        if sum >= min_area {
            return pixels;
        }
    }
    0.0
}
