//! Openings of a room, however small: windows, gaps, pinholes.

use std::ops::Range;

use super::clusters::{Cluster, Rectangle, clusters};
use super::room::{Room, box_around};
use crate::math::{Bounds, BranchKey, DVec3, Sampler, sample_cosine_about, sample_sphere};
use crate::trace::bright::MAX_PLACES;
use crate::trace::camera::Bounce;
use crate::trace::parallel::in_parallel;

/// Rays per piece of work. The search for ways out of the room starts with one piece and keeps doubling their number.
const RAYS_PER_PIECE: u32 = 1 << 14;
/// Number of ways out that tell where to look closely.
const MAX_WAYS_OUT: usize = 64;
/// Rounds of close looks. Each begins at what the one before has found, so that slits are found from end to end.
const SEARCH_ROUNDS: usize = 4;
/// Factor by which the rectangles found are enlarged before they are sampled uniformly.
const SEARCH_MARGIN: f64 = 1.5;
/// Numbers of the first piece that looks closely, of the one that samples uniformly, and of the one that finds walls.
const CLOSE_PIECE: usize = 1 << 16;
const UNIFORM_PIECE: usize = CLOSE_PIECE + SEARCH_ROUNDS;
const WALL_PIECE: usize = UNIFORM_PIECE + 1;
/// Close looks aim at a distance from a way out, in sizes of the room, whose exponent of two is drawn uniformly in this
/// range.
const CLOSE_EXPONENTS: [f64; 2] = [-14.0, -3.0];
/// Least weight of a place, in squares of the room's size: places nearer to a way out do not weigh less.
const MIN_WEIGHT: f64 = 1.0 / (1 << 28) as f64;
/// Factor by which an opening is enlarged: the part that was not found, hit only by chance, would be too bright.
const ENLARGEMENT: f64 = 1.03;
/// Two parts are one opening if a rectangle around both is at most this many times as large as the two.
const MERGE_RATIO: f64 = 1.3;
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
    pub fn find(room: &Room, pieces: usize) -> Option<Self> {
        let search = OpeningSearch { room, walls: walls(room)? };
        let mut ways_out = search.ways_out(pieces);
        let mut points = Vec::new();
        for round in 0..SEARCH_ROUNDS {
            if ways_out.is_empty() {
                return None;
            }
            let found = search.points_near(&ways_out, CLOSE_PIECE + round);
            let step = found.len().div_ceil(MAX_WAYS_OUT).max(1);
            ways_out = found.iter().step_by(step).map(|point| point.0).collect();
            points.extend(found);
        }
        let enlarged: Vec<Rectangle> =
            rectangles(points).into_iter().map(|found| found.scaled(SEARCH_MARGIN)).collect();
        let found = if enlarged.is_empty() { Vec::new() } else { search.points_within(&enlarged) };
        let found = rectangles(found.into_iter().map(|place| (place, 1.0)).collect());
        let rectangles: Vec<Rectangle> = found.into_iter().map(|found| found.scaled(ENLARGEMENT)).collect();
        (!rectangles.is_empty()).then_some(Self { walls: search.walls, rectangles })
    }
}

struct OpeningSearch<'a> {
    room: &'a Room<'a>,
    walls: Bounds,
}

impl OpeningSearch<'_> {
    /// Returns where some of the rays that bounces might take leave the room.
    fn ways_out(&self, max_pieces: usize) -> Vec<DVec3> {
        let (mut found, mut pieces) = (self.exit_points(0..1, &cosine_direction), 1);
        while pieces < max_pieces && found.len() < MAX_WAYS_OUT {
            found.extend(self.exit_points(pieces..2 * pieces, &cosine_direction));
            pieces *= 2;
        }
        found.truncate(MAX_WAYS_OUT);
        found
    }

    /// Returns where rays beside known ways out leave the room. They are weighted by the squared distance, since fewer
    /// rays fall farther away.
    fn points_near(&self, ways_out: &[DVec3], piece: usize) -> Vec<(DVec3, f64)> {
        let size = self.walls.size().length();
        let toward = |bounce: &Bounce, number: u32, [exponent, a, b, _]: [f64; 4]| {
            let way_out = ways_out[number as usize % ways_out.len()];
            let radius = size * libm::exp2(CLOSE_EXPONENTS[0] + (CLOSE_EXPONENTS[1] - CLOSE_EXPONENTS[0]) * exponent);
            way_out + sample_sphere([a, b]) * radius - bounce.from
        };
        let weight = |place: DVec3| {
            let squares = ways_out.iter().map(|way_out| place.distance_squared(*way_out));
            squares.fold(f64::INFINITY, f64::min).max(MIN_WEIGHT * size * size)
        };
        self.exit_points(piece..piece + 1, &toward).into_iter().map(|place| (place, weight(place))).collect()
    }

    /// Returns where rays that are aimed uniformly at rectangles leave the room.
    fn points_within(&self, enlarged: &[Rectangle]) -> Vec<DVec3> {
        let toward = |bounce: &Bounce, number: u32, [a, b, ..]: [f64; 4]| {
            let Rectangle { center, half: [u, v] } = enlarged[number as usize % enlarged.len()];
            center + u * (2.0 * a - 1.0) + v * (2.0 * b - 1.0) - bounce.from
        };
        self.exit_points(UNIFORM_PIECE..UNIFORM_PIECE + 1, &toward)
    }

    /// Returns where rays leave the room.
    fn exit_points(&self, pieces: Range<usize>, toward: Toward) -> Vec<DVec3> {
        trace_pieces(self.room, pieces, toward, &|bounce, direction, sampler| {
            self.room.way_out(&self.walls, bounce, direction, sampler)
        })
    }
}

/// Returns a box around the walls of a room, from where bounces begin and where rays end inside.
fn walls(room: &Room) -> Option<Bounds> {
    let ends = trace_pieces(room, WALL_PIECE..WALL_PIECE + 1, &cosine_direction, &|bounce, direction, sampler| {
        room.end_inside(bounce, direction, sampler)
    });
    if ends.is_empty() {
        return None;
    }
    let starts = room.bounces.iter().map(|bounce| bounce.from).step_by(room.bounces.len().div_ceil(ends.len()));
    let points: Vec<(DVec3, f64)> = starts.chain(ends.iter().copied()).map(|place| (place, 1.0)).collect();
    Some(box_around(&points, points.len() as f64))
}

/// Draws a direction as a bounce from a matte surface would.
fn cosine_direction(bounce: &Bounce, _: u32, [a, b, ..]: [f64; 4]) -> DVec3 {
    sample_cosine_about(bounce.normal, [a, b])
}

/// Returns what `keep` keeps of the rays of some pieces of work.
fn trace_pieces(room: &Room, pieces: Range<usize>, toward: Toward, keep: Keep) -> Vec<DVec3> {
    let trace_piece = |piece: usize| -> Vec<DVec3> {
        let trace_ray = |number: u32| {
            let key = [(pieces.start + piece) as u32, 0];
            let sampler = Sampler::new(room.world.method.seed ^ SEED, key, number);
            let u = sampler.get_random_4d(BranchKey::CAMERA, DRAW);
            let bounce = &room.bounces[(u[3] * room.bounces.len() as f64) as usize];
            let direction = toward(bounce, number, u).try_normalize()?;
            if direction.dot(bounce.normal) > 0.0 { keep(bounce, direction, &sampler) } else { None }
        };
        (0..RAYS_PER_PIECE).filter_map(trace_ray).collect()
    };
    in_parallel(pieces.len(), &trace_piece).concat()
}

/// Returns the rectangles that hold weighted points of openings.
fn rectangles(points: Vec<(DVec3, f64)>) -> Vec<Rectangle> {
    merged(clusters(points, MAX_PLACES)).iter().map(Cluster::bounding_rectangle).collect()
}

/// Joins clusters that lie side by side.
fn merged(mut clusters: Vec<Cluster>) -> Vec<Cluster> {
    let area = |cluster: &Cluster| cluster.rectangle().area();
    let best_pair = |clusters: &[Cluster]| {
        let pairs = (0..clusters.len()).flat_map(|j| (0..j).map(move |i| [i, j]));
        let try_merge = |[i, j]: [usize; 2]| {
            let both = clusters[i].merged(&clusters[j])?;
            (area(&both) <= MERGE_RATIO * (area(&clusters[i]) + area(&clusters[j]))).then_some(([i, j], both))
        };
        pairs.filter_map(try_merge).min_by(|a, b| area(&a.1).total_cmp(&area(&b.1)))
    };
    while let Some(([i, j], both)) = best_pair(&clusters) {
        clusters.swap_remove(j);
        clusters[i] = both;
    }
    clusters
}
