//! Light through dispersive objects: rays of two colors from the lights to them, and on to what the camera sees.

use std::cell::Cell;
use std::f64::consts::PI;

use super::color_walk::{ColorWalk, Colors, FollowedBranch};
use super::search::ReachedPlace;
use super::targets::{SEEN_PIXELS, Targets};
use crate::light::{Light, LightId};
use crate::math::{BranchKey, DVec2, DVec3, Frame, Ray, Sampler, sample_disk, unit};
use crate::shape::{Ball, SurfacePoint};
use crate::spectrum::Table;
use crate::trace::photon_targets::ball_around_all;

/// Number of rays in all, and minimum and maximum number of rays from one light toward one target.
const MAX_RAYS: usize = 4096;
const MIN_PAIR_RAYS: usize = 4;
const MAX_PAIR_RAYS: usize = 1024;
/// Maximum number of lights that send rays: the brightest at a target.
const MAX_LIGHTS: usize = 16;
/// Colors that are apart by less than this share of the lamp's own blur look white.
const MIN_CONTRAST: f64 = 0.05;
/// Light through an object is not seen if it is fainter than this share of the lamp's own: a color may be off by as
/// much.
const MIN_SHARE: f64 = 0.01;
/// Distance of a ray's neighbors, in radii of the object: near enough to take the same way.
const NEIGHBOR_OFFSET: f64 = 1e-3;
/// Largest angle in radians by which a ray is turned to measure the blur from the lamp's extent.
const MAX_TURN: f64 = 1e-3;
/// The branches followed to where light lands: through bodies, and after an internal reflection, as in a rainbow.
const BRANCHES: [FollowedBranch; 2] = [FollowedBranch::Brighter, FollowedBranch::FainterInside];
/// Separates these random numbers from others.
const SEED: u64 = 0x6c69_7420;

/// Returns how many pixels apart two colors of light through dispersive objects land, where the camera sees it.
pub fn lit_pixels(colors: &Colors, targets: &Targets, reached: &[ReachedPlace]) -> f64 {
    let world = colors.world;
    if world.method.diffuse_bounces == 0 {
        return 0.0;
    }
    let shines = |&id: &LightId| world.scene.lights[id].is_sampled() && !world.scene.lights[id].is_even_sky();
    let lights: Vec<LightId> = (0..world.scene.lights.len()).filter(shines).collect();
    let balls: Vec<Ball> = targets.all.iter().filter(|target| target.dispersive).map(|target| target.ball()).collect();
    let pairs = balls.len() * lights.len().min(MAX_LIGHTS);
    let rays = (MAX_RAYS / pairs.max(1)).clamp(MIN_PAIR_RAYS, MAX_PAIR_RAYS);
    let mut largest: f64 = 0.0;
    for (number, ball) in balls.iter().enumerate() {
        for light in brightest(colors, &lights, ball) {
            for choice in BRANCHES {
                let pair = Pair { colors, reached, light, ball, choice };
                let sent = (0..rays).map(|ray| {
                    let sampler = Sampler::new(world.method.seed ^ SEED, [number as u32, light as u32], ray as u32);
                    pair.pixel_separation(&sampler)
                });
                let mut separations: Vec<f64> = sent.flatten().collect();
                separations.sort_by(|a, b| b.total_cmp(a));
                // Requires more than one ray: where a ray passes an edge, its colors may be on both sides.
                let rank = (separations.len() / 50).max(1);
                largest = largest.max(separations.get(rank).copied().unwrap_or(0.0));
                if largest >= SEEN_PIXELS {
                    return largest;
                }
            }
        }
    }
    largest
}

/// Returns the lights that shine most on a ball.
fn brightest(colors: &Colors, lights: &[LightId], ball: &Ball) -> Vec<LightId> {
    if lights.len() <= MAX_LIGHTS {
        return lights.to_vec();
    }
    let shines = |&id: &LightId| {
        let light = &colors.world.scene.lights[id];
        let near = light.bounds().map(|lamp| {
            let squared = (lamp.bounds.center() - ball.center).length_squared();
            lamp.intensity / squared.max(ball.radius * ball.radius)
        });
        (near.unwrap_or_else(|| light.irradiance()), id)
    };
    let mut ranked: Vec<(f64, LightId)> = lights.iter().map(shines).collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    ranked[..MAX_LIGHTS].iter().map(|light| light.1).collect()
}

/// A light, and the ball that it shines on.
struct Pair<'a> {
    colors: &'a Colors<'a>,
    reached: &'a [ReachedPlace],
    light: LightId,
    ball: &'a Ball,
    choice: FollowedBranch,
}

impl Pair<'_> {
    /// Returns how many pixels apart the two colors of one ray land; `None` if that is not seen, and 0 if the light is
    /// too faint or the lamp's extent hides it.
    fn pixel_separation(&self, sampler: &Sampler) -> Option<f64> {
        let u = sampler.get_4d(BranchKey::CAMERA, 0);
        let scene = &self.colors.world.scene;
        let light = &scene.lights[self.light];
        let facing = light.bounds().and_then(|lamp| (lamp.bounds.center() - self.ball.center).try_normalize());
        let normal = facing.unwrap_or(DVec3::Y);
        let target = self.sample_target(light, normal, u)?;
        let sample = light.sample_li(&SurfacePoint::in_space(target), normal, [u[2], u[3]])?;
        let start = self.start(&sample.ray, sample.distance)?;
        let media = self.colors.world.media_at_light(self.light, &start);
        let walk = |lane: usize, ray: Ray| self.colors.walk(lane, ray, false, media, sampler, self.choice);
        let (first, second) = (walk(0, start), walk(1, start));
        if self.choice == FollowedBranch::FainterInside && first.fork_inside == 0.0 {
            return None;
        }
        if !first.dispersive
            || !first.diffuse
            || !second.diffuse
            || first.crossed_objects != second.crossed_objects
            || first.weight == 0.0
        {
            return None;
        }
        let (a, b) = (first.end?.0, second.end?.0);
        let scale = self.pixel_scale(&a, &first)?;
        let separation = scale * (a.position - b.position).length();
        if separation >= SEEN_PIXELS
            && self.relative_irradiance(&start, target, &first, &a, &walk).is_some_and(|share| share < MIN_SHARE)
        {
            return Some(0.0);
        }
        // A cone of uniform density.
        let radius = sample.pdf.map_or(0.0, |pdf| (1.0 / (PI * pdf)).sqrt());
        if radius == 0.0 {
            return Some(separation);
        }
        let (frame, turn) = (Frame::about(start.direction), MAX_TURN.min(radius));
        let far = (target - start.origin).length();
        let blur = [DVec3::X, DVec3::Y].map(|side| {
            let direction = unit(start.direction + frame.to_world(side) * turn);
            let turned = walk(0, Ray { origin: target - direction * far, direction });
            let matching_end = turned.end.filter(|_| turned.crossed_objects == first.crossed_objects);
            matching_end.map_or(0.0, |end| scale * (end.0.position - a.position).length() * radius / turn)
        });
        let blur = f64::max(blur[0], blur[1]);
        Some(if separation >= MIN_CONTRAST * blur { separation } else { 0.0 })
    }

    /// Returns the irradiance along a ray's way, relative to the lamp's own where it lands, by the areas that the ray's
    /// neighbors span. Returns `None` if they go other ways, or if something blocks the lamp's own light.
    fn relative_irradiance(
        &self,
        start: &Ray,
        target: DVec3,
        first: &ColorWalk,
        end: &SurfacePoint,
        walk: &impl Fn(usize, Ray) -> ColorWalk,
    ) -> Option<f64> {
        let (scene, light) = (&self.colors.world.scene, &self.colors.world.scene.lights[self.light]);
        let (direction, distance, lamp) = if light.is_infinite() {
            (-start.direction, f64::INFINITY, None)
        } else {
            let side = if first.last()?.direction.dot(end.normal) < 0.0 { end.normal } else { -end.normal };
            let sample = light.sample_li(end, side, [0.5; 2])?;
            (sample.ray.direction, sample.distance, sample.object)
        };
        let (own, from) = (direction.dot(end.normal), -first.last()?.direction.dot(end.normal));
        let blocks =
            |object| !first.crossed_objects.contains(&object) && !scene.material_of(object).lobes().is_transmissive();
        let ray = end.leave(direction);
        if own * from <= 0.0 || scene.is_occluded_by(&ray, distance, lamp, &Cell::new(None), &blocks) {
            return None;
        }
        let (frame, step) = (Frame::about(start.direction), NEIGHBOR_OFFSET * self.ball.radius);
        let [x, y] = [DVec3::X, DVec3::Y].map(|side| {
            let offset = frame.to_world(side) * step;
            let neighbor = if light.is_infinite() {
                Ray { origin: start.origin + offset, ..*start }
            } else {
                Ray { direction: unit(target + offset - start.origin), ..*start }
            };
            let walk = walk(0, neighbor);
            walk.end
                .filter(|_| walk.crossed_objects == first.crossed_objects)
                .map(|neighbor| neighbor.0.position - end.position)
        });
        let nearer = if light.is_infinite() { 1.0 } else { (target - start.origin).length() / distance };
        Some(first.weight * step * step / (x?.cross(y?).length() * own.abs() * nearer * nearer))
    }

    /// Samples a point of the ball that the light shines on; for a spot narrower than the ball, within its cone.
    fn sample_target(&self, light: &Light<Table>, normal: DVec3, u: [f64; 4]) -> Option<DVec3> {
        if let Light::Spot(spot) = light {
            let position = DVec3::from(spot.position);
            let (ball_cone, own) = (self.ball.cone_from(position), spot.cone());
            let cone = if own.one_minus_cos < ball_cone.one_minus_cos { own } else { ball_cone };
            let direction = unit(cone.sample_uniform([u[0], u[1]]));
            return Some(position + direction * (self.ball.center - position).length());
        }
        let sample = light.sample_li(&SurfacePoint::in_space(self.ball.center), normal, [u[2], u[3]]);
        let axis = sample.map_or(normal, |sample| sample.ray.direction);
        let [x, y] = (sample_disk([u[0], u[1]]) * self.ball.radius).into();
        Some(self.ball.center + Frame::about(axis).to_world(DVec3::new(x, y, 0.0)))
    }

    fn start(&self, back: &Ray, distance: f64) -> Option<Ray> {
        let scene = &self.colors.world.scene;
        match &scene.lights[self.light] {
            Light::Area(area) => {
                let intersection = area.shape.intersect(back, f64::INFINITY)?;
                Some(area.shape.point(back, &intersection).leave(-back.direction))
            }
            light if light.is_infinite() => {
                let world = ball_around_all(scene)?;
                let distance_outside = (world.center - back.origin).length() + 2.0 * world.radius;
                let start = Ray { origin: back.at(distance_outside), ..*back };
                let hidden = scene.is_occluded(&start, f64::INFINITY, None, &Cell::new(None));
                (!hidden).then_some(Ray { direction: -back.direction, ..start })
            }
            _ => Some(Ray { origin: back.at(distance), direction: -back.direction }),
        }
    }

    /// Returns the pixels per length where a ray lands, if the camera sees it: directly, through clear objects, or
    /// indirectly.
    fn pixel_scale(&self, point: &SurfacePoint, walk: &ColorWalk) -> Option<f64> {
        let remaining_bounces = self.colors.world.method.max_bounces - walk.surfaces;
        let is_near = |place: &&ReachedPlace| (place.position - point.position).length() <= place.cell_size;
        let is_indirect = |place: &&ReachedPlace| place.surfaces < remaining_bounces && is_near(place);
        let straight = self.direct_pixel_scale(point, walk);
        straight.or_else(|| self.reached.iter().find(is_indirect).map(|place| 1.0 / place.pixel_size))
    }

    fn direct_pixel_scale(&self, point: &SurfacePoint, walk: &ColorWalk) -> Option<f64> {
        let (scene, film) = (&self.colors.world.scene, self.colors.world.scene.film);
        let projection = scene.camera.see(point.position, [0.5; 2])?;
        let size = DVec2::new(f64::from(film.width), f64::from(film.height));
        let inside = projection.film.cmpge(DVec2::ZERO).all() && projection.film.cmple(size).all();
        let cos_lit = -walk.last()?.direction.dot(point.normal);
        if !inside || cos_lit * projection.direction.dot(point.normal) <= 0.0 {
            return None;
        }
        let ray = point.leave(projection.direction);
        let distance = (projection.start - ray.origin).length();
        let hides = |object| !scene.material_of(object).lobes().is_transmissive();
        let hidden = scene.is_occluded_by(&ray, distance, None, &Cell::new(None), &hides);
        (!hidden).then(|| (projection.importance * projection.direction.dot(point.normal).abs()).sqrt())
    }
}
