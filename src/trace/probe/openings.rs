//! Openings of a room that light so little of it that some thousand bounces do not find them: pinholes, gaps.

use std::ops::Range;

use super::clusters::{Cluster, Rectangle, clusters};
use super::room::Room;
use crate::math::{BranchKey, DVec3, Sampler, ball_surface, cosine_about};
use crate::trace::bright::MOST;
use crate::trace::camera::Bounce;
use crate::trace::parallel::in_parallel;

/// Rays of a piece of work, and pieces that look for ways out of the room: first one, then twice as many each time.
const RAYS: u32 = 1 << 14;
const PIECES: usize = 64;
/// Ways out that tell where to look closely. Where one piece finds as many, some thousand bounces find the way.
const ENOUGH: usize = 32;
/// How far beside a way out rays look closely, in sizes of the room: a power of two, from the first to the last alike.
const BESIDE: [f64; 2] = [-14.0, -3.0];
/// Nearer places, in squares of the size of the room, weigh no less.
const LEAST: f64 = 1.0 / (1 << 28) as f64;
/// An opening is taken to be so many times as large as what was found of it: the rest would be met by chance alone, and
/// be much too bright.
const MARGIN: f64 = 1.05;
/// Two parts are one opening if a rectangle about both is no more than so many times as large as theirs.
const ONE: f64 = 1.3;
/// Uses of random numbers; those of looks around come before.
const DRAW: u32 = 16;
/// Sets these random numbers apart from those of the image.
const SEED: u64 = 0x6f70_656e;

/// The direction of a ray from where a bounce began, of any length.
type Toward<'a> = &'a (dyn Fn(&Bounce, u32, [f64; 4]) -> DVec3 + Sync);

/// The small openings of a room to where the sky is seen, each held by a rectangle; none beside large ones, which
/// bounces find.
pub fn small_openings(room: &Room) -> Vec<Rectangle> {
    let ways_out = ways_out(room);
    let size = (room.bounds.max - room.bounds.min).length();
    let beside = |bounce: &Bounce, number: u32, [exponent, a, b, _]: [f64; 4]| {
        let way_out = ways_out[number as usize % ways_out.len()];
        let radius = size * libm::exp2(BESIDE[0] + (BESIDE[1] - BESIDE[0]) * exponent);
        way_out + ball_surface([a, b]) * radius - bounce.from
    };
    let found = if ways_out.is_empty() { Vec::new() } else { looked(room, PIECES..PIECES + 1, &beside) };
    // Rays fall the less densely the farther they are from the way out, by the square of that.
    let nearest =
        |place: DVec3| ways_out.iter().map(|way_out| place.distance_squared(*way_out)).fold(f64::INFINITY, f64::min);
    let points = found.into_iter().map(|place| (place, nearest(place).max(LEAST * size * size))).collect();
    joined(clusters(points, MOST)).iter().map(|cluster| cluster.around_all().times(MARGIN)).collect()
}

/// Clusters of which those that lie side by side are one.
fn joined(mut clusters: Vec<Cluster>) -> Vec<Cluster> {
    let pair = |clusters: &[Cluster]| {
        let pairs = (0..clusters.len()).flat_map(|j| (0..j).map(move |i| [i, j]));
        let join = |[i, j]: [usize; 2]| {
            let both = clusters[i].joined(&clusters[j])?;
            (both.area() <= ONE * (clusters[i].area() + clusters[j].area())).then_some(([i, j], both))
        };
        pairs.filter_map(join).min_by(|a, b| a.1.area().total_cmp(&b.1.area()))
    };
    while let Some(([i, j], both)) = pair(&clusters) {
        clusters.swap_remove(j);
        clusters[i] = both;
    }
    clusters
}

/// Where some of the rays that bounces might take leave the room; none where they often do.
fn ways_out(room: &Room) -> Vec<DVec3> {
    let by_cosine = |bounce: &Bounce, _: u32, [a, b, ..]: [f64; 4]| cosine_about(bounce.normal, [a, b]);
    let mut found = looked(room, 0..1, &by_cosine);
    if found.len() >= ENOUGH {
        return Vec::new();
    }
    let mut pieces = 1;
    while pieces < PIECES && found.len() < ENOUGH {
        found.extend(looked(room, pieces..2 * pieces, &by_cosine));
        pieces *= 2;
    }
    found
}

/// Where rays leave the room.
fn looked(room: &Room, pieces: Range<usize>, toward: Toward) -> Vec<DVec3> {
    let of_piece = |piece: usize| -> Vec<DVec3> {
        let way_out = |number: u32| {
            let key = [(pieces.start + piece) as u32, 0];
            let sampler = Sampler::new(room.world.method.seed ^ SEED, key, number);
            let u = sampler.four_plain(BranchKey::CAMERA, DRAW);
            let bounce = &room.bounces[(u[3] * room.bounces.len() as f64) as usize];
            let direction = toward(bounce, number, u).try_normalize()?;
            if direction.dot(bounce.normal) > 0.0 { room.way_out(bounce, direction, &sampler) } else { None }
        };
        (0..RAYS).filter_map(way_out).collect()
    };
    in_parallel(pieces.len(), &of_piece).concat()
}
