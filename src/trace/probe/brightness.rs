//! What lights a room, learned from a few camera samples.

use super::clusters::{Cluster, bounds_of_most, clusters};
use super::findings::found_all_over;
use crate::math::{Bounds, BranchKey, DVec3, Frame, Ray, Sampler, cosine_hemisphere, unit};
use crate::shape::{Quad, Shape};
use crate::trace::bright::{BrightPlace, BrightPlaces, MOST};
use crate::trace::camera::{Bounce, Finding};
use crate::trace::photon::few_vertices;
use crate::trace::width::in_lanes;
use crate::trace::{Transport, World};

/// Camera samples along each side of the image: few that look for a room, and those that look what lights it.
const FEW: u32 = 24;
const SIDE: u32 = 48;
/// Of the way to a place, how far a bounce must go to have found what is there.
const NEARLY: f64 = 0.9;
/// Rays that look for the sky from where a bounce began, and how many may see it from inside a room: a quarter.
const LOOKS: u32 = 4;
const INSIDE: usize = 1;
/// Share of the bounces' weight inside rooms from which on it is a picture of a room.
const ENOUGH: f64 = 0.25;
/// Points that are gathered into places.
const POINTS: usize = 2048;
/// Sets these random numbers apart from those of the image.
const SEED: u64 = 0x6272_6967;

/// Where light comes from inside a room that the sky lights; none where the camera sees no room or nothing stands out.
///
/// All of the image counts, also where only a part of it is made, so that all parts are made alike.
pub fn bright_places(world: &World) -> Option<BrightPlaces> {
    let is_random = matches!(world.method.transport, Transport::Random { .. });
    if world.scene.infinite_lights.is_empty() || !is_random || world.method.diffuse_bounces == 0 {
        return None;
    }
    in_lanes!(&world.method.basis, N => places::<N>(world))
}

fn places<const N: usize>(world: &World) -> Option<BrightPlaces> {
    // A few tell whether there is a room at all.
    inside_of(world, bounces::<N>(world, FEW))?;
    learned(inside_of(world, bounces::<N>(world, SIDE))?)
}

/// What the bounces of so many camera samples along each side of the image found, as far as there are rays for them.
pub(super) fn bounces<const N: usize>(world: &World, side: u32) -> Vec<Bounce> {
    let vertices = few_vertices::<N>(world);
    found_all_over(world, side, SEED, vertices.as_ref(), |finding| match finding {
        Finding::Bounce(bounce) => Some(bounce),
        _ => None,
    })
}

fn weight(bounces: &[Bounce]) -> f64 {
    bounces.iter().map(|bounce| bounce.weight).sum()
}

/// The bounces that began inside a room, if they are many.
fn inside_of(world: &World, bounces: Vec<Bounce>) -> Option<Vec<Bounce>> {
    let all = weight(&bounces);
    let mut inside = Vec::new();
    for (number, bounce) in (0..).zip(bounces) {
        if is_inside(world, &bounce, &Sampler::new(world.method.seed ^ SEED, [number, 0], 0)) {
            inside.push(bounce);
        }
    }
    (!inside.is_empty() && weight(&inside) >= ENOUGH * all).then_some(inside)
}

fn learned(mut inside: Vec<Bounce>) -> Option<BrightPlaces> {
    let room = room_of(&inside);
    inside.retain(|bounce| room.contains(bounce.from));
    let lit = inside.iter().filter(|bounce| bounce.light > 0.0);
    let points: Vec<(DVec3, f64)> = lit.map(|bounce| (end_of(bounce, room), bounce.light)).collect();
    let step = points.len().div_ceil(POINTS).max(1);
    let found = clusters(points.into_iter().step_by(step).collect(), MOST);
    let mut places: Vec<Place> = found.iter().filter_map(Place::of).collect();
    let mut elsewhere = Squares::default();
    for bounce in &inside {
        let ray = Ray { origin: bounce.from, direction: bounce.direction };
        let mut any = false;
        for place in &mut places {
            let Some(crossing) = place.shape.intersect(&ray, f64::INFINITY) else { continue };
            // What is hidden before the place is as much its own as what lies beyond it.
            place.squares.add(bounce);
            any |= bounce.distance > NEARLY * crossing.t;
        }
        if !any {
            elsewhere.add(bounce);
        }
    }
    let mean = inside.iter().map(|bounce| bounce.light).sum::<f64>() / weight(&inside);
    let elsewhere = elsewhere.root() + mean;
    let stands_out = |place: &BrightPlace| place.radiance > elsewhere;
    let places: Vec<BrightPlace> = places.into_iter().filter_map(Place::bright).filter(stands_out).collect();
    (!places.is_empty() && elsewhere > 0.0).then_some(BrightPlaces { within: room, places, elsewhere })
}

/// Whether less than a quarter of the sky, weighed by the cosine, is seen from where a bounce began.
fn is_inside(world: &World, bounce: &Bounce, sampler: &Sampler) -> bool {
    let frame = Frame::about(bounce.normal);
    let from = bounce.from + bounce.normal * (1e-6 * bounce.from.length().max(1e-3));
    let sees = |look: &u32| {
        let u = sampler.four_plain(BranchKey::CAMERA, *look);
        let direction = unit(frame.to_world(cosine_hemisphere([u[0], u[1]])));
        let ray = Ray { origin: from, direction };
        world.scene.nearest(&ray, f64::INFINITY, &|object| !world.is_see_through(object)).is_none()
    };
    (0..LOOKS).filter(sees).count() <= INSIDE
}

/// The box in which bounces begin, but for a few.
fn room_of(inside: &[Bounce]) -> Bounds {
    let from: Vec<(DVec3, f64)> = inside.iter().map(|bounce| (bounce.from, bounce.weight)).collect();
    let Bounds { min, max } = bounds_of_most(&from, weight(inside));
    let margin = 1e-6 * (max - min).length();
    Bounds { min: min - margin, max: max + margin }
}

/// Where a bounce ends, or where it leaves the room.
fn end_of(bounce: &Bounce, room: Bounds) -> DVec3 {
    let toward = |from: f64, direction: f64, min: f64, max: f64| match direction {
        d if d > 0.0 => (max - from) / d,
        d if d < 0.0 => (min - from) / d,
        _ => f64::INFINITY,
    };
    let Bounce { from, direction, distance, .. } = *bounce;
    let leaves = (0..3).map(|i| toward(from[i], direction[i], room.min[i], room.max[i])).fold(f64::INFINITY, f64::min);
    from + direction * distance.min(leaves)
}

/// A place that is being learned.
struct Place {
    shape: Shape,
    center: DVec3,
    half: [DVec3; 2],
    squares: Squares,
}

impl Place {
    fn of(cluster: &Cluster) -> Option<Self> {
        let [u, v, _] = cluster.half;
        let spans = u.cross(v).length();
        (spans > 0.0 && spans.is_finite()).then(|| Self {
            shape: Shape::Quad(Quad::new(cluster.center, u, v)),
            center: cluster.center,
            half: [u, v],
            squares: Squares::default(),
        })
    }

    fn bright(self) -> Option<BrightPlace> {
        let Self { center, half, squares, .. } = self;
        Some(BrightPlace { center, half, radiance: squares.root() }).filter(|place| place.radiance > 0.0)
    }
}

/// Sums for the root of a mean square of radiance, weighed by how much it counts.
#[derive(Clone, Copy, Default)]
struct Squares {
    light: f64,
    weight: f64,
}

impl Squares {
    fn add(&mut self, bounce: &Bounce) {
        self.light += bounce.light * bounce.light;
        self.weight += bounce.weight * bounce.weight;
    }

    fn root(&self) -> f64 {
        if self.weight > 0.0 { (self.light / self.weight).sqrt() } else { 0.0 }
    }
}
