//! Learns from a few camera samples what lights a room.

use super::camera_events::collect_events;
use super::clusters::{Cluster, Rectangle, clusters};
use super::openings::Openings;
use super::room::{Room, weight};
use crate::math::{DVec3, Ray};
use crate::shape::{Quad, Shape};
use crate::trace::bright::{BrightPlace, BrightPlaces, MAX_PLACES};
use crate::trace::camera::{Bounce, SensorEvent};
use crate::trace::photon::pilot_vertices;
use crate::trace::width::in_lanes;
use crate::trace::{Transport, World};

/// Camera samples along each side of the image: a few to detect a room, and more to learn what lights it.
const DETECTION_SAMPLES_PER_SIDE: u32 = 24;
const SAMPLES_PER_SIDE: u32 = 48;
/// Share of the way to a place that a bounce must travel to have reached what is there.
const MIN_REACH: f64 = 0.9;
/// Number of equally bright bounces that tell what lights a room. With fewer, or with nearly all light in as few, more
/// rays search for openings, in at most `MAX_PIECES` pieces of work.
const MIN_LIT_BOUNCES: f64 = 32.0;
const MAX_PIECES: usize = 64;
/// Sets these random numbers apart from those of the image.
const SEED: u64 = 0x6272_6967;

/// What lights a room that the camera sees.
#[derive(Clone, Debug, Default, PartialEq)]
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
    learn_room_light(world).unwrap_or_default()
}

fn learn_room_light(world: &World) -> Option<RoomLight> {
    // A few samples tell whether there is a room at all.
    Room::from_bounces(world, bounces(world, DETECTION_SAMPLES_PER_SIDE), SEED)?;
    let room = Room::from_bounces(world, bounces(world, SAMPLES_PER_SIDE), SEED)?;
    let is_rare = !is_lit_often(&room);
    let openings = Openings::find(&room, if is_rare { MAX_PIECES } else { 1 });
    let openings = openings.and_then(|openings| bright_openings(world, &openings));
    Some(RoomLight { places: bright_places(&room), openings, is_rare })
}

/// Traces `side` x `side` camera samples over the image, or fewer if the rays run out, and returns their bounces.
pub(super) fn bounces(world: &World, side: u32) -> Vec<Bounce> {
    let bounce = |event: SensorEvent| if let SensorEvent::Bounce(bounce) = event { Some(bounce) } else { None };
    in_lanes!(&world.method.basis, N => {
        collect_events(world, side, SEED, pilot_vertices::<N>(world).as_ref(), bounce)
    })
}

/// Whether bounces found light often enough to tell what lights the room.
fn is_lit_often(room: &Room) -> bool {
    let sum = |power: i32| room.bounces.iter().map(|bounce| bounce.light.powi(power)).sum::<f64>();
    sum(1).powi(2) > MIN_LIT_BOUNCES * sum(2)
}

/// Returns the bright places among those that bounces found.
fn bright_places(room: &Room) -> Option<BrightPlaces> {
    let lit_bounces = room.bounces.iter().filter(|bounce| bounce.light > 0.0);
    let points: Vec<(DVec3, f64)> = lit_bounces.map(|bounce| (room.end_of(bounce), bounce.light)).collect();
    select_bright(room, clusters(points, MAX_PLACES).iter().map(Cluster::rectangle))
}

/// Returns the openings through which most light comes. Bounces from anywhere within the walls are aimed at them.
fn bright_openings(world: &World, Openings { walls, rectangles }: &Openings) -> Option<BrightPlaces> {
    let place = |&Rectangle { center, half }: &Rectangle| BrightPlace { center, half, radiance: 1.0 };
    let places = rectangles.iter().map(place).collect();
    // Bounces aimed at the openings tell how much light comes through them.
    let aimed = BrightPlaces { within: *walls, places, elsewhere: 0.0, missed: 0.0, are_openings: true };
    let world = world.with_bright(Some(aimed));
    let room = Room::from_bounces(&world, bounces(&world, SAMPLES_PER_SIDE), SEED)?;
    Some(BrightPlaces { within: *walls, are_openings: true, ..select_bright(&room, rectangles.iter().copied())? })
}

/// Keeps those rectangles from or through which more light comes than from elsewhere.
fn select_bright(room: &Room, rectangles: impl Iterator<Item = Rectangle>) -> Option<BrightPlaces> {
    let mut places: Vec<LearnedPlace> = rectangles.filter_map(LearnedPlace::from_rectangle).collect();
    let mut elsewhere = RmsSums::default();
    let (mut sky_light, mut missed) = (0.0, 0.0);
    for bounce in &room.bounces {
        let ray = Ray { origin: bounce.from, direction: bounce.direction };
        let mut reaches_place = false;
        for place in &mut places {
            let Some(intersection) = place.shape.intersect(&ray, f64::INFINITY) else { continue };
            // A bounce that ends in front of the place counts for it as much as one that goes beyond.
            place.squares.add(bounce);
            reaches_place |= bounce.distance > MIN_REACH * intersection.t;
        }
        if !reaches_place {
            elsewhere.add(bounce);
        }
        if bounce.distance == f64::INFINITY {
            sky_light += bounce.light;
            missed += if reaches_place { 0.0 } else { bounce.light };
        }
    }
    let mean = room.bounces.iter().map(|bounce| bounce.light).sum::<f64>() / weight(&room.bounces);
    let elsewhere = elsewhere.rms() + mean;
    let stands_out = |place: &BrightPlace| place.radiance > elsewhere;
    let places: Vec<BrightPlace> = places.into_iter().filter_map(LearnedPlace::bright).filter(stands_out).collect();
    (!places.is_empty() && elsewhere > 0.0).then_some(BrightPlaces {
        within: room.bounds,
        places,
        elsewhere,
        missed: if sky_light > 0.0 { missed / sky_light } else { 1.0 },
        are_openings: false,
    })
}

struct LearnedPlace {
    shape: Shape,
    rectangle: Rectangle,
    squares: RmsSums,
}

impl LearnedPlace {
    fn from_rectangle(rectangle: Rectangle) -> Option<Self> {
        let Rectangle { center, half: [u, v] } = rectangle;
        let area = u.cross(v).length();
        (area > 0.0 && area.is_finite()).then(|| Self {
            shape: Shape::Quad(Quad::new(center, u, v)),
            rectangle,
            squares: RmsSums::default(),
        })
    }

    fn bright(self) -> Option<BrightPlace> {
        let Self { rectangle: Rectangle { center, half }, squares, .. } = self;
        Some(BrightPlace { center, half, radiance: squares.rms() }).filter(|place| place.radiance > 0.0)
    }
}

/// Sums for the root mean square of the radiance, weighted by the throughput.
#[derive(Clone, Copy, Default)]
struct RmsSums {
    light: f64,
    weight: f64,
}

impl RmsSums {
    fn add(&mut self, bounce: &Bounce) {
        self.light += bounce.light * bounce.light;
        self.weight += bounce.weight * bounce.weight;
    }

    fn rms(&self) -> f64 {
        if self.weight > 0.0 { (self.light / self.weight).sqrt() } else { 0.0 }
    }
}
