//! Openings of a room, however small: windows, gaps, pinholes.

use std::ops::Range;

use super::clusters::{Cluster, Rectangle, clusters};
use super::room::{Room, box_around};
use crate::math::{Bounds, BranchKey, DVec3, Sampler, ball_surface, cosine_about};
use crate::trace::bright::MOST;
use crate::trace::camera::Bounce;
use crate::trace::parallel::in_parallel;

/// Rays per piece of work. The search for ways out of the room starts with one piece and keeps doubling their number.
const RAYS: u32 = 1 << 14;
/// Number of ways out that tell where to look closely.
const ENOUGH: usize = 64;
/// Rounds of close looks. Each begins at what the one before has found, so that slits are found from end to end.
const ROUNDS: usize = 4;
/// Factor by which the rectangles found are enlarged before they are sampled uniformly.
const ABOUT: f64 = 1.5;
/// Numbers of the first piece that looks closely, of the one that samples uniformly, and of the one that finds walls.
const CLOSELY: usize = 1 << 16;
const EVENLY: usize = CLOSELY + ROUNDS;
const WALLS: usize = EVENLY + 1;
/// Close looks aim at a distance from a way out, in sizes of the room, whose exponent of two is drawn uniformly in this
/// range.
const BESIDE: [f64; 2] = [-14.0, -3.0];
/// Least weight of a place, in squares of the room's size: places nearer to a way out do not weigh less.
const LEAST: f64 = 1.0 / (1 << 28) as f64;
/// Factor by which an opening is enlarged: the part that was not found, hit only by chance, would be too bright.
const MARGIN: f64 = 1.03;
/// Two parts are one opening if a rectangle around both is at most this many times as large as the two.
const ONE: f64 = 1.3;
/// The use of random numbers that draws rays; looks around a place have smaller numbers.
const DRAW: u32 = 16;
/// Sets these random numbers apart from those of the image.
const SEED: u64 = 0x6f70_656e;

/// The direction, of any length, of a ray from the start of a bounce.
type Toward<'a> = &'a (dyn Fn(&Bounce, u32, [f64; 4]) -> DVec3 + Sync);
/// The point that is kept of a ray, if any.
type Keep<'a> = &'a (dyn Fn(&Bounce, DVec3, &Sampler) -> Option<DVec3> + Sync);

/// Openings of a room through which the sky is seen.
pub struct Openings {
    /// A box around the walls of the room.
    pub walls: Bounds,
    pub rectangles: Vec<Rectangle>,
}

impl Openings {
    /// Finds the openings of a room, if it has some, with `pieces` pieces of work, or fewer if they find enough.
    pub fn of(room: &Room, pieces: usize) -> Option<Self> {
        let search = OpeningSearch { room, walls: walls(room)? };
        let mut ways_out = search.ways_out(pieces);
        let mut points = Vec::new();
        for round in 0..ROUNDS {
            if ways_out.is_empty() {
                return None;
            }
            let found = search.beside(&ways_out, CLOSELY + round);
            let step = found.len().div_ceil(ENOUGH).max(1);
            ways_out = found.iter().step_by(step).map(|point| point.0).collect();
            points.extend(found);
        }
        let about: Vec<Rectangle> = rectangles(points).into_iter().map(|found| found.times(ABOUT)).collect();
        let found = if about.is_empty() { Vec::new() } else { search.evenly(&about) };
        let found = rectangles(found.into_iter().map(|place| (place, 1.0)).collect());
        let rectangles: Vec<Rectangle> = found.into_iter().map(|found| found.times(MARGIN)).collect();
        (!rectangles.is_empty()).then_some(Self { walls: search.walls, rectangles })
    }
}

struct OpeningSearch<'a> {
    room: &'a Room<'a>,
    walls: Bounds,
}

impl OpeningSearch<'_> {
    /// Returns where some of the rays that bounces might take leave the room.
    fn ways_out(&self, most: usize) -> Vec<DVec3> {
        let (mut found, mut pieces) = (self.found(0..1, &by_cosine), 1);
        while pieces < most && found.len() < ENOUGH {
            found.extend(self.found(pieces..2 * pieces, &by_cosine));
            pieces *= 2;
        }
        found.truncate(ENOUGH);
        found
    }

    /// Returns where rays beside known ways out leave the room. They are weighted by the squared distance, since fewer
    /// rays fall farther away.
    fn beside(&self, ways_out: &[DVec3], piece: usize) -> Vec<(DVec3, f64)> {
        let size = self.walls.size().length();
        let toward = |bounce: &Bounce, number: u32, [exponent, a, b, _]: [f64; 4]| {
            let way_out = ways_out[number as usize % ways_out.len()];
            let radius = size * libm::exp2(BESIDE[0] + (BESIDE[1] - BESIDE[0]) * exponent);
            way_out + ball_surface([a, b]) * radius - bounce.from
        };
        let weight = |place: DVec3| {
            let squares = ways_out.iter().map(|way_out| place.distance_squared(*way_out));
            squares.fold(f64::INFINITY, f64::min).max(LEAST * size * size)
        };
        self.found(piece..piece + 1, &toward).into_iter().map(|place| (place, weight(place))).collect()
    }

    /// Returns where rays that are aimed uniformly at rectangles leave the room.
    fn evenly(&self, about: &[Rectangle]) -> Vec<DVec3> {
        let toward = |bounce: &Bounce, number: u32, [a, b, ..]: [f64; 4]| {
            let Rectangle { center, half: [u, v] } = about[number as usize % about.len()];
            center + u * (2.0 * a - 1.0) + v * (2.0 * b - 1.0) - bounce.from
        };
        self.found(EVENLY..EVENLY + 1, &toward)
    }

    /// Returns where rays leave the room.
    fn found(&self, pieces: Range<usize>, toward: Toward) -> Vec<DVec3> {
        looked(self.room, pieces, toward, &|bounce, direction, sampler| {
            self.room.way_out(&self.walls, bounce, direction, sampler)
        })
    }
}

/// Returns a box around the walls of a room, from where bounces begin and where rays end inside.
fn walls(room: &Room) -> Option<Bounds> {
    let ends = looked(room, WALLS..WALLS + 1, &by_cosine, &|bounce, direction, sampler| {
        room.end_inside(bounce, direction, sampler)
    });
    if ends.is_empty() {
        return None;
    }
    let begun = room.bounces.iter().map(|bounce| bounce.from).step_by(room.bounces.len().div_ceil(ends.len()));
    let points: Vec<(DVec3, f64)> = begun.chain(ends.iter().copied()).map(|place| (place, 1.0)).collect();
    Some(box_around(&points, points.len() as f64))
}

/// Draws a direction as a bounce from a matte surface would.
fn by_cosine(bounce: &Bounce, _: u32, [a, b, ..]: [f64; 4]) -> DVec3 {
    cosine_about(bounce.normal, [a, b])
}

/// Returns what `keep` keeps of the rays of some pieces of work.
fn looked(room: &Room, pieces: Range<usize>, toward: Toward, keep: Keep) -> Vec<DVec3> {
    let of_piece = |piece: usize| -> Vec<DVec3> {
        let kept = |number: u32| {
            let key = [(pieces.start + piece) as u32, 0];
            let sampler = Sampler::new(room.world.method.seed ^ SEED, key, number);
            let u = sampler.four_plain(BranchKey::CAMERA, DRAW);
            let bounce = &room.bounces[(u[3] * room.bounces.len() as f64) as usize];
            let direction = toward(bounce, number, u).try_normalize()?;
            if direction.dot(bounce.normal) > 0.0 { keep(bounce, direction, &sampler) } else { None }
        };
        (0..RAYS).filter_map(kept).collect()
    };
    in_parallel(pieces.len(), &of_piece).concat()
}

/// Returns the rectangles that hold weighted points of openings.
fn rectangles(points: Vec<(DVec3, f64)>) -> Vec<Rectangle> {
    joined(clusters(points, MOST)).iter().map(Cluster::around_all).collect()
}

/// Joins clusters that lie side by side.
fn joined(mut clusters: Vec<Cluster>) -> Vec<Cluster> {
    let area = |cluster: &Cluster| cluster.rectangle().area();
    let pair = |clusters: &[Cluster]| {
        let pairs = (0..clusters.len()).flat_map(|j| (0..j).map(move |i| [i, j]));
        let join = |[i, j]: [usize; 2]| {
            let both = clusters[i].joined(&clusters[j])?;
            (area(&both) <= ONE * (area(&clusters[i]) + area(&clusters[j]))).then_some(([i, j], both))
        };
        pairs.filter_map(join).min_by(|a, b| area(&a.1).total_cmp(&area(&b.1)))
    };
    while let Some(([i, j], both)) = pair(&clusters) {
        clusters.swap_remove(j);
        clusters[i] = both;
    }
    clusters
}
