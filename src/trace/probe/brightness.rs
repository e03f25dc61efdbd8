//! Learns from a few camera samples what lights a room.

use super::clusters::{Cluster, Rectangle, clusters};
use super::findings::found_all_over;
use super::openings::Openings;
use super::room::{Room, weight};
use crate::math::{DVec3, Ray};
use crate::shape::{Quad, Shape};
use crate::trace::bright::{BrightPlace, BrightPlaces, MOST};
use crate::trace::camera::{Bounce, SensorEvent};
use crate::trace::photon::few_vertices;
use crate::trace::width::in_lanes;
use crate::trace::{Transport, World};

/// Camera samples along each side of the image: a few to detect a room, and more to learn what lights it.
const FEW: u32 = 24;
const SIDE: u32 = 48;
/// Share of the way to a place that a bounce must travel to have reached what is there.
const NEARLY: f64 = 0.9;
/// Number of equally bright bounces that tell what lights a room. With fewer, or with nearly all light in as few, more
/// rays search for openings, in at most `MOST_PIECES` pieces of work.
const OFTEN: f64 = 32.0;
const MOST_PIECES: usize = 64;
/// Sets these random numbers apart from those of the image.
const SEED: u64 = 0x6272_6967;

/// What lights a room that the camera sees.
#[derive(Default)]
pub struct RoomLight {
    /// The places where bounces found most light, if any stand out.
    pub places: Option<BrightPlaces>,
    /// Its openings to the sky, if they stand out.
    pub openings: Option<BrightPlaces>,
    /// Whether too few bounces found light for their variance to mean anything.
    pub is_rare: bool,
}

/// Finds where light comes from inside a room that the sky lights. The result is empty if the camera sees no room.
///
/// Uses the whole image even when only a part of it is rendered, so that all parts are rendered the same way.
pub fn room_light(world: &World) -> RoomLight {
    let is_random = matches!(world.method.transport, Transport::Random { .. });
    if world.scene.infinite_lights.is_empty() || !is_random || world.method.diffuse_bounces == 0 {
        return RoomLight::default();
    }
    of_room(world).unwrap_or_default()
}

fn of_room(world: &World) -> Option<RoomLight> {
    // A few samples tell whether there is a room at all.
    Room::of(world, bounces(world, FEW), SEED)?;
    let room = Room::of(world, bounces(world, SIDE), SEED)?;
    let is_rare = !is_lit_often(&room);
    let openings = Openings::of(&room, if is_rare { MOST_PIECES } else { 1 });
    let openings = openings.and_then(|openings| bright_openings(world, &openings));
    Some(RoomLight { places: learned(&room), openings, is_rare })
}

/// Traces `side` x `side` camera samples over the image, or fewer if the rays run out, and returns their bounces.
pub(super) fn bounces(world: &World, side: u32) -> Vec<Bounce> {
    let bounce = |finding: SensorEvent| if let SensorEvent::Bounce(bounce) = finding { Some(bounce) } else { None };
    in_lanes!(&world.method.basis, N => {
        found_all_over(world, side, SEED, few_vertices::<N>(world).as_ref(), bounce)
    })
}

/// Whether bounces found light often enough to tell what lights the room.
fn is_lit_often(room: &Room) -> bool {
    let sum = |power: i32| room.bounces.iter().map(|bounce| bounce.light.powi(power)).sum::<f64>();
    sum(1).powi(2) > OFTEN * sum(2)
}

/// Returns the bright places among those that bounces found.
fn learned(room: &Room) -> Option<BrightPlaces> {
    let lit = room.bounces.iter().filter(|bounce| bounce.light > 0.0);
    let points: Vec<(DVec3, f64)> = lit.map(|bounce| (room.end_of(bounce), bounce.light)).collect();
    bright_of(room, clusters(points, MOST).iter().map(Cluster::rectangle))
}

/// Returns the openings through which most light comes. Bounces from anywhere within the walls are aimed at them.
fn bright_openings(world: &World, Openings { walls, rectangles }: &Openings) -> Option<BrightPlaces> {
    let place = |&Rectangle { center, half }: &Rectangle| BrightPlace { center, half, radiance: 1.0 };
    let places = rectangles.iter().map(place).collect();
    // Bounces aimed at the openings tell how much light comes through them.
    let aimed = BrightPlaces { within: *walls, places, elsewhere: 0.0, missed: 0.0, are_openings: true };
    let world = world.with_bright(Some(aimed));
    let room = Room::of(&world, bounces(&world, SIDE), SEED)?;
    Some(BrightPlaces { within: *walls, are_openings: true, ..bright_of(&room, rectangles.iter().copied())? })
}

/// Keeps those rectangles from or through which more light comes than from elsewhere.
fn bright_of(room: &Room, rectangles: impl Iterator<Item = Rectangle>) -> Option<BrightPlaces> {
    let mut places: Vec<LearnedPlace> = rectangles.filter_map(LearnedPlace::of).collect();
    let mut elsewhere = Squares::default();
    let (mut of_sky, mut missed) = (0.0, 0.0);
    for bounce in &room.bounces {
        let ray = Ray { origin: bounce.from, direction: bounce.direction };
        let mut any = false;
        for place in &mut places {
            let Some(intersection) = place.shape.intersect(&ray, f64::INFINITY) else { continue };
            // A bounce that ends in front of the place counts for it as much as one that goes beyond.
            place.squares.add(bounce);
            any |= bounce.distance > NEARLY * intersection.t;
        }
        if !any {
            elsewhere.add(bounce);
        }
        if bounce.distance == f64::INFINITY {
            of_sky += bounce.light;
            missed += if any { 0.0 } else { bounce.light };
        }
    }
    let mean = room.bounces.iter().map(|bounce| bounce.light).sum::<f64>() / weight(&room.bounces);
    let elsewhere = elsewhere.root() + mean;
    let stands_out = |place: &BrightPlace| place.radiance > elsewhere;
    let places: Vec<BrightPlace> = places.into_iter().filter_map(LearnedPlace::bright).filter(stands_out).collect();
    (!places.is_empty() && elsewhere > 0.0).then_some(BrightPlaces {
        within: room.bounds,
        places,
        elsewhere,
        missed: if of_sky > 0.0 { missed / of_sky } else { 1.0 },
        are_openings: false,
    })
}

struct LearnedPlace {
    shape: Shape,
    rectangle: Rectangle,
    squares: Squares,
}

impl LearnedPlace {
    fn of(rectangle: Rectangle) -> Option<Self> {
        let Rectangle { center, half: [u, v] } = rectangle;
        let spans = u.cross(v).length();
        (spans > 0.0 && spans.is_finite()).then(|| Self {
            shape: Shape::Quad(Quad::new(center, u, v)),
            rectangle,
            squares: Squares::default(),
        })
    }

    fn bright(self) -> Option<BrightPlace> {
        let Self { rectangle: Rectangle { center, half }, squares, .. } = self;
        Some(BrightPlace { center, half, radiance: squares.root() }).filter(|place| place.radiance > 0.0)
    }
}

/// Sums for the root mean square of the radiance, weighted by the throughput.
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
