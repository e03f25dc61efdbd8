//! What lights a room, learned from a few camera samples.

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

/// Camera samples along each side of the image: few that look for a room, and those that look what lights it.
const FEW: u32 = 24;
const SIDE: u32 = 48;
/// Of the way to a place, how far a bounce must go to have found what is there.
const NEARLY: f64 = 0.9;
/// Bounces of equal light that tell what lights a room. Where there are fewer, or nearly all light is in as few, more
/// rays look for openings, by pieces.
const OFTEN: f64 = 32.0;
const MOST_PIECES: usize = 64;
/// Sets these random numbers apart from those of the image.
const SEED: u64 = 0x6272_6967;

/// What lights a room that the camera sees.
#[derive(Default)]
pub struct RoomLight {
    /// Where bounces found most light, if anything stands out.
    pub places: Option<BrightPlaces>,
    /// Its openings to the sky, if they do.
    pub openings: Option<BrightPlaces>,
    /// Whether bounces found hardly any light, so that how they vary tells nothing.
    pub is_rare: bool,
}

/// Where light comes from inside a room that the sky lights; nowhere, if the camera sees no room.
///
/// All of the image counts, also where only a part of it is made, so that all parts are made alike.
pub fn room_light(world: &World) -> RoomLight {
    let is_random = matches!(world.method.transport, Transport::Random { .. });
    if world.scene.infinite_lights.is_empty() || !is_random || world.method.diffuse_bounces == 0 {
        return RoomLight::default();
    }
    of_room(world).unwrap_or_default()
}

fn of_room(world: &World) -> Option<RoomLight> {
    // A few tell whether there is a room at all.
    Room::of(world, bounces(world, FEW), SEED)?;
    let room = Room::of(world, bounces(world, SIDE), SEED)?;
    let is_rare = !is_lit_often(&room);
    let openings = Openings::of(&room, if is_rare { MOST_PIECES } else { 1 });
    let openings = openings.and_then(|openings| bright_openings(world, &openings));
    Some(RoomLight { places: learned(&room), openings, is_rare })
}

/// What the bounces of so many camera samples along each side of the image found, as far as there are rays for them.
pub(super) fn bounces(world: &World, side: u32) -> Vec<Bounce> {
    let bounce = |finding: SensorEvent| if let SensorEvent::Bounce(bounce) = finding { Some(bounce) } else { None };
    in_lanes!(&world.method.basis, N => {
        found_all_over(world, side, SEED, few_vertices::<N>(world).as_ref(), bounce)
    })
}

/// Whether what lights a room was found often enough to tell what it is.
fn is_lit_often(room: &Room) -> bool {
    let sum = |power: i32| room.bounces.iter().map(|bounce| bounce.light.powi(power)).sum::<f64>();
    sum(1).powi(2) > OFTEN * sum(2)
}

/// The bright places among those that bounces found.
fn learned(room: &Room) -> Option<BrightPlaces> {
    let lit = room.bounces.iter().filter(|bounce| bounce.light > 0.0);
    let points: Vec<(DVec3, f64)> = lit.map(|bounce| (room.end_of(bounce), bounce.light)).collect();
    bright_of(room, clusters(points, MOST).iter().map(Cluster::rectangle))
}

/// Those openings through which most light comes. All within the walls aim at them.
fn bright_openings(world: &World, Openings { walls, rectangles }: &Openings) -> Option<BrightPlaces> {
    let place = |&Rectangle { center, half }: &Rectangle| BrightPlace { center, half, radiance: 1.0 };
    let places = rectangles.iter().map(place).collect();
    // What light comes through them, bounces tell that are aimed at them.
    let aimed = BrightPlaces { within: *walls, places, elsewhere: 0.0, missed: 0.0, are_openings: true };
    let world = world.with_bright(Some(aimed));
    let room = Room::of(&world, bounces(&world, SIDE), SEED)?;
    Some(BrightPlaces { within: *walls, are_openings: true, ..bright_of(&room, rectangles.iter().copied())? })
}

/// Those of some rectangles from or through which more light comes than from elsewhere.
fn bright_of(room: &Room, rectangles: impl Iterator<Item = Rectangle>) -> Option<BrightPlaces> {
    let mut places: Vec<LearnedPlace> = rectangles.filter_map(LearnedPlace::of).collect();
    let mut elsewhere = Squares::default();
    let (mut of_sky, mut missed) = (0.0, 0.0);
    for bounce in &room.bounces {
        let ray = Ray { origin: bounce.from, direction: bounce.direction };
        let mut any = false;
        for place in &mut places {
            let Some(intersection) = place.shape.intersect(&ray, f64::INFINITY) else { continue };
            // What is hidden before the place is as much its own as what lies beyond it.
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
