//! Which part of a large smooth surface throws light onto what the camera sees: of a sea, only a bay.

use serde::{Deserialize, Serialize};

use crate::light::{Light, LightId, Opening};
use crate::material::Lobes;
use crate::math::{Bounds, DVec2, DVec3, Ray};
use crate::scene::{Primitive, Scene};
use crate::shape::Ball;
use crate::spectrum::Table;

/// Camera rays along each side of the image.
const SIDE: u32 = 24;
/// Most smooth surfaces that a ray passes, and most lights that are looked for.
const SURFACES: usize = 8;
const LIGHTS: usize = 4;
/// Beyond all surfaces.
const FAR: f64 = 1e100;
/// Fewest places that tell where light comes through.
const FEWEST: usize = 16;
/// Places so many times as far from the camera as the nearest belong to the next part.
const FARTHER: f64 = 2.5;
/// Share of the places that a part has at least.
const LEAST: f64 = 1.0 / 32.0;
/// How much larger balls are than what was found: refracted light comes through beside the straight line, and surfaces
/// beside the image light what is in it.
const WIDER: f64 = 1.5;
/// Parts are told apart where they are so many times as small as the whole.
const SMALLER: f64 = 3.0;
/// Share of the photons that is sent to all of the whole.
const EVERYWHERE: f64 = 0.1;
/// Of a surface that has no end, photons are sent to so many times what was found.
const REACH: f64 = 6.0;

/// How smooth an object is that photons can be sent to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Smoothness {
    /// Wherever light goes on from it.
    Whole,
    /// It scatters light widely as well, as what lies under a clear coat does.
    Partial,
    /// It mirrors or refracts light nearly as smooth ones do: by narrow lobes.
    Narrow,
    /// It mirrors some of it so, and scatters light widely as well.
    NarrowPartial,
}

impl Smoothness {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::Whole, Self::Partial, Self::Narrow, Self::NarrowPartial];

    /// How smooth an object is; none if photons cannot be sent to it.
    pub fn of<S>(scene: &Scene<S>, object: usize) -> Option<Self> {
        let material = scene.material_of(object as u32);
        let lobes = material.lobes();
        let object = &scene.objects[object];
        let is_bent = || object.shape.is_smooth() || object.relief.is_some();
        match (material.is_smooth_somewhere(), lobes.intersects(Lobes::BROAD)) {
            (true, false) => Some(Self::Whole),
            (true, true) => Some(Self::Partial),
            // By normals other than a surface's own, what crosses it widely cannot be followed forward alike.
            (false, false) if lobes.intersects(Lobes::NARROW_TRANSMISSION) && is_bent() => None,
            (false, false) => lobes.is_narrow().then_some(Self::Narrow),
            (false, true) => lobes.has_narrow_apart().then_some(Self::NarrowPartial),
        }
    }

    /// How smooth an object is, if that is among the kinds of smoothness that photons are sent to.
    pub fn sent_to<S>(scene: &Scene<S>, object: usize, to: &[Self]) -> Option<Self> {
        Self::of(scene, object).filter(|smoothness| to.contains(smoothness))
    }
}

/// A place on a smooth surface by way of which light may come to what the camera sees.
#[derive(Clone, Copy, Debug)]
pub(super) struct FocusPlace {
    pub(super) at: DVec3,
    smoothness: Smoothness,
    /// Whether the surface has no end.
    endless: bool,
    /// How far the camera is.
    distance: f64,
}

/// A ball around a part of such places, and its share of the photons of the whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FocusBall {
    pub(super) ball: Ball,
    pub(super) share: f64,
}

/// Whether the camera may see a small part of what lies in a ball: it is wider than the image there.
fn is_large(scene: &Scene<Table>, ball: &Ball) -> bool {
    let distance = (ball.center - scene.camera.position()).length();
    let pixels = f64::hypot(f64::from(scene.film.width), f64::from(scene.film.height));
    distance < ball.radius || scene.camera.pixel_width(distance) * pixels < 2.0 * ball.radius
}

/// Such places, where some of the targets are large: those that the camera sees, and those that lie on the straight way
/// to a light from what it sees straight on through smooth surfaces. The same whatever part of the image is made.
pub(super) fn places(
    scene: &Scene<Table>,
    lights: &[LightId],
    openings: &[Opening],
    to: &[Smoothness],
) -> Vec<FocusPlace> {
    let is_target = |&object: &usize| Smoothness::sent_to(scene, object, to).is_some();
    let targets = (0..scene.objects.len()).filter(is_target);
    let mut balls = targets.map(|object| scene.objects[object].shape.ball());
    let mut found = Vec::new();
    if lights.is_empty() || balls.all(|ball| ball.is_some_and(|ball| !is_large(scene, &ball))) {
        return found;
    }
    for [x, y] in scene.film.whole().middles_of_cells(SIDE) {
        let ray = scene.camera.ray(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5));
        let Some((receiver, primitive)) = walk(scene, to, ray, f64::INFINITY, None, &mut found) else { continue };
        let to_lights = lights.iter().take(LIGHTS).map(|&light| way_to(&scene.lights[light], receiver));
        for way in to_lights.chain(openings.iter().map(|opening| opening.center - receiver)) {
            if let Some(direction) = way.try_normalize() {
                walk(scene, to, Ray { origin: receiver, direction }, way.length(), Some(primitive), &mut found);
            }
        }
    }
    found
}

/// Walks straight through smooth surfaces and sheets, adds where photons are sent to on the way, and answers where
/// another surface is, or one that is smooth only in part. A ray that has left no surface is the camera's.
fn walk(
    scene: &Scene<Table>,
    to: &[Smoothness],
    mut ray: Ray,
    mut distance: f64,
    mut left: Option<Primitive>,
    found: &mut Vec<FocusPlace>,
) -> Option<(DVec3, Primitive)> {
    let seen = left.is_none();
    for _ in 0..SURFACES {
        let hit = if seen { scene.intersect_seen(&ray, left) } else { scene.intersect_from(&ray, left) }?;
        let object = &scene.objects[hit.object as usize];
        let point = object.point(&ray, &hit.intersection);
        distance -= hit.intersection.t;
        if distance < 0.0 {
            return None;
        }
        let (smoothness, material) = (Smoothness::of(scene, hit.object as usize), scene.material_of(hit.object));
        if let Some(smoothness) = smoothness.filter(|smooth| to.contains(smooth)) {
            let distance = (point.position - scene.camera.position()).length();
            found.push(FocusPlace { at: point.position, smoothness, endless: !object.shape.is_bounded(), distance });
        }
        let lets_through = material.is_see_through() && material.lobes() == Lobes::NONE;
        if smoothness != Some(Smoothness::Whole) && !lets_through {
            return Some((point.position, hit.primitive()));
        }
        (ray, left) = (point.leave(ray.direction), Some(hit.primitive()));
    }
    None
}

/// The way from a place to the middle of a light; to the sky, beyond all surfaces.
fn way_to(light: &Light<Table>, place: DVec3) -> DVec3 {
    match light {
        Light::Sun(_) | Light::Environment(_) => light.bright_direction([0.5; 2]).map_or(DVec3::ZERO, |sky| sky * FAR),
        Light::Area(area) => area.visible_part().map_or(DVec3::ZERO, |part| part.0.center - place),
        Light::Point(point) => DVec3::from(point.position) - place,
        Light::Spot(spot) => DVec3::from(spot.position) - place,
    }
}

/// The ball within which photons are sent to surfaces without end; none where these show the camera nothing.
pub(super) fn reach(places: &[FocusPlace]) -> Option<Ball> {
    let places: Vec<FocusPlace> = places.iter().filter(|place| place.endless).copied().collect();
    (places.len() >= FEWEST).then(|| around(&places, REACH))
}

/// The parts, at most so many, of what is so smooth in a ball; none where it is seen as a whole, or not at all.
///
/// A part of n places gets photons for the square root of n: by area, the near ones would get too few, and by pixels
/// the far ones, where photons are gathered around places that look longer than wide.
pub(super) fn parts(places: &[FocusPlace], smoothness: Smoothness, whole: &Ball, most: usize) -> Vec<FocusBall> {
    let is_in = |place: &&FocusPlace| place.smoothness == smoothness && whole.contains(place.at);
    let mut places: Vec<FocusPlace> = places.iter().filter(is_in).copied().collect();
    if places.len() < FEWEST {
        return Vec::new();
    }
    places.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    let least = (LEAST * places.len() as f64).ceil() as usize;
    let (mut parts, mut told) = (Vec::new(), 0);
    while told < places.len() {
        let far = FARTHER * places[(told + least - 1).min(places.len() - 1)].distance;
        let near = places.partition_point(|place| place.distance <= far).max(told + 1);
        let end = if parts.len() + 1 < most { near } else { places.len() };
        // Around what is nearer, too.
        parts.push(FocusBall { ball: around(&places[..end], WIDER), share: ((end - told) as f64).sqrt() });
        told = end;
    }
    let all: f64 = parts.iter().map(|part| part.share).sum();
    parts.iter_mut().for_each(|part| part.share *= (1.0 - EVERYWHERE) / all);
    parts.retain(|part| SMALLER * part.ball.radius < whole.radius && part.ball.radius > 0.0);
    parts
}

/// A ball around some places, so many times as large as it must be.
fn around(places: &[FocusPlace], wider: f64) -> Ball {
    let ball = Ball::of_box(&Bounds::around(places.iter().map(|place| place.at)));
    Ball { radius: wider * ball.radius, ..ball }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_a_sea_are_small_where_it_is_near() {
        // Rows of an image of a plane, from below the camera to the horizon.
        let row = |i: u32| 1.6 / (f64::from(i) / 576.0);
        let place = |i| FocusPlace {
            at: DVec3::new(f64::from(i % 24) / 24.0, 0.0, 1.0) * row(i),
            smoothness: Smoothness::Whole,
            endless: true,
            distance: row(i),
        };
        let places: Vec<FocusPlace> = (1..=576).map(place).collect();
        let whole = reach(&places).expect("there are enough");
        let parts = parts(&places, Smoothness::Whole, &whole, 6);
        assert!((3..=6).contains(&parts.len()), "{parts:?}");
        assert!(parts.is_sorted_by(|a, b| 1.5 * a.ball.radius < b.ball.radius), "{parts:?}");
        for place in &places {
            assert!(parts.iter().any(|part| part.ball.contains(place.at)), "{place:?} is in none of {parts:?}");
        }
        let share: f64 = parts.iter().map(|part| part.share).sum();
        assert!((share - 0.9).abs() < 1e-12, "{share} of the photons are sent to parts");
        // Seen as a whole, there are none.
        let small = Ball { radius: 0.5 * parts[0].ball.radius, ..parts[0].ball };
        assert_eq!(super::parts(&places, Smoothness::Whole, &small, 6), []);
    }
}
