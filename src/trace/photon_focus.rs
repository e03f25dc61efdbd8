//! Which part of a large smooth surface casts light onto what the camera sees: of a sea, only a bay.

use serde::{Deserialize, Serialize};

use crate::light::{Light, LightId, Opening};
use crate::material::Lobes;
use crate::math::{Bounds, DVec2, DVec3, Ray};
use crate::scene::{Primitive, Scene};
use crate::shape::Ball;
use crate::spectrum::Table;

/// Number of camera rays along each side of the image.
const RAYS_PER_SIDE: u32 = 24;
/// Maximum number of smooth surfaces that a ray passes, and of lights that are considered.
const MAX_SURFACES: usize = 8;
const MAX_LIGHTS: usize = 4;
/// A distance beyond all surfaces.
const FAR_DISTANCE: f64 = 1e100;
/// Minimum number of places that show where light comes through.
const MIN_PLACES: usize = 16;
/// Places more than this factor farther from the camera than the nearest ones belong to the next part.
const PART_DEPTH_RATIO: f64 = 2.5;
/// Smallest share of the places in a part.
const MIN_PART_SHARE: f64 = 1.0 / 32.0;
/// How much larger balls are than the places found: refracted light comes through beside the straight line, and
/// surfaces outside the image light what is in it.
const BALL_MARGIN: f64 = 1.5;
/// Parts are kept if they are smaller than the whole by this factor.
const MIN_SHRINKAGE: f64 = 3.0;
/// Share of the photons that is sent to the entire whole.
const WHOLE_SHARE: f64 = 0.1;
/// On an unbounded surface, how much larger the region that receives photons is than the places found.
const REACH_MARGIN: f64 = 6.0;

/// The smoothness of an object that photons can be sent to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Smoothness {
    /// Smooth wherever light leaves it.
    Whole,
    /// Also scatters light widely, as what lies under a clear coat does.
    Partial,
    /// Mirrors or refracts light nearly as smooth objects do: by narrow lobes.
    Narrow,
    /// Mirrors some light by narrow lobes, and also scatters light widely.
    NarrowPartial,
}

impl Smoothness {
    /// All kinds.
    pub const ALL: [Self; 4] = [Self::Whole, Self::Partial, Self::Narrow, Self::NarrowPartial];

    /// Returns the smoothness of an object; `None` if photons cannot be sent to it.
    pub fn of<S>(scene: &Scene<S>, object: usize) -> Option<Self> {
        let material = scene.material_of(object as u32);
        let lobes = material.lobes();
        let object = &scene.objects[object];
        let has_bent_normals = || object.shape.is_smooth() || object.relief.is_some();
        match (material.is_smooth_somewhere(), lobes.intersects(Lobes::BROAD)) {
            (true, false) => Some(Self::Whole),
            (true, true) => Some(Self::Partial),
            // With normals other than the geometric one, rough transmission cannot be followed forward the same way.
            (false, false) if lobes.intersects(Lobes::NARROW_TRANSMISSION) && has_bent_normals() => None,
            (false, false) => lobes.is_narrow().then_some(Self::Narrow),
            (false, true) => lobes.has_narrow_apart().then_some(Self::NarrowPartial),
        }
    }

    /// Returns the smoothness of an object, if photons are sent to objects of that kind.
    pub fn sent_to<S>(scene: &Scene<S>, object: usize, to: &[Self]) -> Option<Self> {
        Self::of(scene, object).filter(|smoothness| to.contains(smoothness))
    }
}

/// A place on a smooth surface through which light may reach what the camera sees.
#[derive(Clone, Copy, Debug)]
pub(super) struct FocusPlace {
    pub(super) position: DVec3,
    smoothness: Smoothness,
    /// Whether the surface is unbounded.
    is_unbounded: bool,
    /// Distance to the camera.
    distance: f64,
}

/// A ball around one part of the places, and its share of the photons of the whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct FocusBall {
    pub(super) ball: Ball,
    pub(super) share: f64,
}

/// Returns whether the camera may see only a small part of a ball, because the ball is wider than the image there.
fn is_large(scene: &Scene<Table>, ball: &Ball) -> bool {
    let distance = (ball.center - scene.camera.position()).length();
    let pixels = f64::hypot(f64::from(scene.film.width), f64::from(scene.film.height));
    distance < ball.radius || scene.camera.pixel_width(distance) * pixels < 2.0 * ball.radius
}

/// Finds the smooth places through which light may reach what the camera sees, if some targets are large. These are the
/// places that the camera sees, and those on the straight line to a light from what it sees directly through smooth
/// surfaces. They do not depend on the part of the image that is rendered.
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
    for [x, y] in scene.film.whole().middles_of_cells(RAYS_PER_SIDE) {
        let ray = scene.camera.ray(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5));
        let Some((receiver, primitive)) = walk_straight(scene, to, ray, f64::INFINITY, None, &mut found) else {
            continue;
        };
        let to_lights = lights.iter().take(MAX_LIGHTS).map(|&light| vector_to(&scene.lights[light], receiver));
        for way in to_lights.chain(openings.iter().map(|opening| opening.center - receiver)) {
            if let Some(direction) = way.try_normalize() {
                walk_straight(
                    scene,
                    to,
                    Ray { origin: receiver, direction },
                    way.length(),
                    Some(primitive),
                    &mut found,
                );
            }
        }
    }
    found
}

/// Walks straight through smooth surfaces and see-through sheets, and adds the places on the way that photons are sent
/// to. Returns the first other surface, or one that is smooth only in part. A ray that has left no surface is a camera
/// ray.
fn walk_straight(
    scene: &Scene<Table>,
    to: &[Smoothness],
    mut ray: Ray,
    mut distance: f64,
    mut last_hit: Option<Primitive>,
    found: &mut Vec<FocusPlace>,
) -> Option<(DVec3, Primitive)> {
    let is_camera_ray = last_hit.is_none();
    for _ in 0..MAX_SURFACES {
        let hit =
            if is_camera_ray { scene.intersect_seen(&ray, last_hit) } else { scene.intersect_from(&ray, last_hit) }?;
        let object = &scene.objects[hit.object as usize];
        let point = object.point(&ray, &hit.intersection);
        distance -= hit.intersection.t;
        if distance < 0.0 {
            return None;
        }
        let (smoothness, material) = (Smoothness::of(scene, hit.object as usize), scene.material_of(hit.object));
        if let Some(smoothness) = smoothness.filter(|smooth| to.contains(smooth)) {
            let distance = (point.position - scene.camera.position()).length();
            found.push(FocusPlace {
                position: point.position,
                smoothness,
                is_unbounded: !object.shape.is_bounded(),
                distance,
            });
        }
        let lets_through = material.is_see_through() && material.lobes() == Lobes::NONE;
        if smoothness != Some(Smoothness::Whole) && !lets_through {
            return Some((point.position, hit.primitive()));
        }
        (ray, last_hit) = (point.leave(ray.direction), Some(hit.primitive()));
    }
    None
}

/// Returns the vector from a place to the middle of a light; toward the sky, it leads beyond all surfaces.
fn vector_to(light: &Light<Table>, place: DVec3) -> DVec3 {
    match light {
        Light::Sun(_) | Light::Environment(_) => {
            light.bright_direction([0.5; 2]).map_or(DVec3::ZERO, |sky| sky * FAR_DISTANCE)
        }
        Light::Area(area) => area.visible_part().map_or(DVec3::ZERO, |part| part.0.center - place),
        Light::Point(point) => DVec3::from(point.position) - place,
        Light::Spot(spot) => DVec3::from(spot.position) - place,
    }
}

/// Returns the ball within which photons are sent to unbounded surfaces; `None` if too few of their places were found.
pub(super) fn reach(places: &[FocusPlace]) -> Option<Ball> {
    let places: Vec<FocusPlace> = places.iter().filter(|place| place.is_unbounded).copied().collect();
    (places.len() >= MIN_PLACES).then(|| around(&places, REACH_MARGIN))
}

/// Returns at most `max` parts of what has this smoothness in a ball; none if it is seen as a whole, or not at all.
///
/// A part with n places receives photons in proportion to the square root of n. In proportion to area, the near parts
/// would receive too few. In proportion to pixels, the far ones would: there, photons are gathered around places that
/// look longer than wide.
pub(super) fn parts(places: &[FocusPlace], smoothness: Smoothness, whole: &Ball, max: usize) -> Vec<FocusBall> {
    let is_in = |place: &&FocusPlace| place.smoothness == smoothness && whole.contains(place.position);
    let mut places: Vec<FocusPlace> = places.iter().filter(is_in).copied().collect();
    if places.len() < MIN_PLACES {
        return Vec::new();
    }
    places.sort_by(|a, b| a.distance.total_cmp(&b.distance));
    let min_count = (MIN_PART_SHARE * places.len() as f64).ceil() as usize;
    let (mut parts, mut assigned) = (Vec::new(), 0);
    while assigned < places.len() {
        let far = PART_DEPTH_RATIO * places[(assigned + min_count - 1).min(places.len() - 1)].distance;
        let near = places.partition_point(|place| place.distance <= far).max(assigned + 1);
        let end = if parts.len() + 1 < max { near } else { places.len() };
        // The ball also encloses all nearer places.
        parts.push(FocusBall { ball: around(&places[..end], BALL_MARGIN), share: ((end - assigned) as f64).sqrt() });
        assigned = end;
    }
    let all: f64 = parts.iter().map(|part| part.share).sum();
    parts.iter_mut().for_each(|part| part.share *= (1.0 - WHOLE_SHARE) / all);
    parts.retain(|part| MIN_SHRINKAGE * part.ball.radius < whole.radius && part.ball.radius > 0.0);
    parts
}

/// Returns a ball around some places, enlarged by a factor.
fn around(places: &[FocusPlace], factor: f64) -> Ball {
    let ball = Ball::of_box(&Bounds::around(places.iter().map(|place| place.position)));
    Ball { radius: factor * ball.radius, ..ball }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_of_a_sea_are_small_where_it_is_near() {
        // Rows of an image of a plane, from below the camera to the horizon.
        let row = |i: u32| 1.6 / (f64::from(i) / 576.0);
        let place = |i| FocusPlace {
            position: DVec3::new(f64::from(i % 24) / 24.0, 0.0, 1.0) * row(i),
            smoothness: Smoothness::Whole,
            is_unbounded: true,
            distance: row(i),
        };
        let places: Vec<FocusPlace> = (1..=576).map(place).collect();
        let whole = reach(&places).expect("there are enough");
        let parts = parts(&places, Smoothness::Whole, &whole, 6);
        assert!((3..=6).contains(&parts.len()), "{parts:?}");
        assert!(parts.is_sorted_by(|a, b| 1.5 * a.ball.radius < b.ball.radius), "{parts:?}");
        for place in &places {
            assert!(parts.iter().any(|part| part.ball.contains(place.position)), "{place:?} is in none of {parts:?}");
        }
        let share: f64 = parts.iter().map(|part| part.share).sum();
        assert!((share - 0.9).abs() < 1e-12, "{share} of the photons are sent to parts");
        // There are no parts if the surface is seen as a whole.
        let small = Ball { radius: 0.5 * parts[0].ball.radius, ..parts[0].ball };
        assert_eq!(super::parts(&places, Smoothness::Whole, &small, 6), []);
    }
}
