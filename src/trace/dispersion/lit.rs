//! Light through dispersive objects: rays of two colors from the lights to them, and on to what the camera sees.

use std::cell::Cell;
use std::f64::consts::PI;

use super::color_walk::{ColorWalk, Colors, FollowedBranch};
use super::search::ReachedPlace;
use super::targets::{SEEN_PIXELS, Targets};
use crate::light::{Light, LightId};
use crate::math::{BranchKey, DVec2, DVec3, Frame, Ray, Sampler, disk, unit};
use crate::shape::{Ball, SurfacePoint};
use crate::spectrum::Table;
use crate::trace::photon_targets::ball_around_all;

/// Number of rays in all, and minimum and maximum number of rays from one light toward one target.
const RAYS: usize = 4096;
const FEWEST: usize = 4;
const OF_A_PAIR: usize = 1024;
/// Maximum number of lights that send rays: the brightest at a target.
const LIGHTS: usize = 16;
/// Colors that are apart by less than this share of the lamp's own blur look white.
const CONTRAST: f64 = 0.05;
/// Light through an object is not seen if it is fainter than this share of the lamp's own: a color may be off by as
/// much.
const FAINT: f64 = 0.01;
/// Distance of a ray's neighbors, in radii of the object: near enough to take the same way.
const BESIDE: f64 = 1e-3;
/// Largest angle in radians by which a ray is turned to measure the blur from the lamp's extent.
const TURN: f64 = 1e-3;
/// The branches followed to where light lands: through bodies, and after an internal reflection, as in a rainbow.
const WAYS: [FollowedBranch; 2] = [FollowedBranch::Brighter, FollowedBranch::FainterInside];
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
    let pairs = balls.len() * lights.len().min(LIGHTS);
    let rays = (RAYS / pairs.max(1)).clamp(FEWEST, OF_A_PAIR);
    let mut most: f64 = 0.0;
    for (number, ball) in balls.iter().enumerate() {
        for light in brightest(colors, &lights, ball) {
            for choice in WAYS {
                let pair = Pair { colors, reached, light, ball, choice };
                let sent = (0..rays).map(|ray| {
                    let sampler = Sampler::new(world.method.seed ^ SEED, [number as u32, light as u32], ray as u32);
                    pair.pixels(&sampler)
                });
                let mut found: Vec<f64> = sent.flatten().collect();
                found.sort_by(|a, b| b.total_cmp(a));
                // Requires more than one ray: where a ray passes an edge, its colors may be on both sides.
                let rank = (found.len() / 50).max(1);
                most = most.max(found.get(rank).copied().unwrap_or(0.0));
                if most >= SEEN_PIXELS {
                    return most;
                }
            }
        }
    }
    most
}

/// Returns the lights that shine most on a ball.
fn brightest(colors: &Colors, lights: &[LightId], ball: &Ball) -> Vec<LightId> {
    if lights.len() <= LIGHTS {
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
    let mut known: Vec<(f64, LightId)> = lights.iter().map(shines).collect();
    known.sort_by(|a, b| b.0.total_cmp(&a.0));
    known[..LIGHTS].iter().map(|light| light.1).collect()
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
    fn pixels(&self, sampler: &Sampler) -> Option<f64> {
        let u = sampler.four(BranchKey::CAMERA, 0);
        let scene = &self.colors.world.scene;
        let light = &scene.lights[self.light];
        let facing = light.bounds().and_then(|lamp| (lamp.bounds.center() - self.ball.center).try_normalize());
        let normal = facing.unwrap_or(DVec3::Y);
        let target = self.target(light, normal, u)?;
        let sample = light.sample_li(&SurfacePoint::in_space(target), normal, [u[2], u[3]])?;
        let start = self.start(&sample.ray, sample.distance)?;
        let media = self.colors.world.media_at_light(self.light, &start);
        let walk = |lane: usize, ray: Ray| self.colors.walk(lane, ray, false, media, sampler, self.choice);
        let (first, second) = (walk(0, start), walk(1, start));
        if self.choice == FollowedBranch::FainterInside && first.fork_inside == 0.0 {
            return None;
        }
        if !first.dispersive || !first.diffuse || !second.diffuse || first.met != second.met || first.weight == 0.0 {
            return None;
        }
        let (a, b) = (first.end?.0, second.end?.0);
        let scale = self.scale(&a, &first)?;
        let apart = scale * (a.position - b.position).length();
        if apart >= SEEN_PIXELS && self.share(&start, target, &first, &a, &walk).is_some_and(|share| share < FAINT) {
            return Some(0.0);
        }
        // A cone of uniform density.
        let radius = sample.pdf.map_or(0.0, |pdf| (1.0 / (PI * pdf)).sqrt());
        if radius == 0.0 {
            return Some(apart);
        }
        let (frame, turn) = (Frame::about(start.direction), TURN.min(radius));
        let far = (target - start.origin).length();
        let blur = [DVec3::X, DVec3::Y].map(|side| {
            let direction = unit(start.direction + frame.to_world(side) * turn);
            let turned = walk(0, Ray { origin: target - direction * far, direction });
            let moved = turned.end.filter(|_| turned.met == first.met);
            moved.map_or(0.0, |end| scale * (end.0.position - a.position).length() * radius / turn)
        });
        let blur = f64::max(blur[0], blur[1]);
        Some(if apart >= CONTRAST * blur { apart } else { 0.0 })
    }

    /// Returns the irradiance along a ray's way, relative to the lamp's own where it lands, by the areas that the ray's
    /// neighbors span. Returns `None` if they go other ways, or if something blocks the lamp's own light.
    fn share(
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
        let keeps_away = |object| !first.met.contains(&object) && !scene.material_of(object).lobes().is_transmissive();
        let ray = end.leave(direction);
        if own * from <= 0.0 || scene.is_occluded_by(&ray, distance, lamp, &Cell::new(None), &keeps_away) {
            return None;
        }
        let (frame, step) = (Frame::about(start.direction), BESIDE * self.ball.radius);
        let [x, y] = [DVec3::X, DVec3::Y].map(|side| {
            let aside = frame.to_world(side) * step;
            let beside = if light.is_infinite() {
                Ray { origin: start.origin + aside, ..*start }
            } else {
                Ray { direction: unit(target + aside - start.origin), ..*start }
            };
            let walk = walk(0, beside);
            walk.end.filter(|_| walk.met == first.met).map(|beside| beside.0.position - end.position)
        });
        let nearer = if light.is_infinite() { 1.0 } else { (target - start.origin).length() / distance };
        Some(first.weight * step * step / (x?.cross(y?).length() * own.abs() * nearer * nearer))
    }

    /// Samples a point of the ball that the light shines on; for a spot narrower than the ball, within its cone.
    fn target(&self, light: &Light<Table>, normal: DVec3, u: [f64; 4]) -> Option<DVec3> {
        if let Light::Spot(spot) = light {
            let position = DVec3::from(spot.position);
            let (of_ball, own) = (self.ball.cone_from(position), spot.cone());
            let cone = if own.one_minus_cos < of_ball.one_minus_cos { own } else { of_ball };
            let direction = unit(cone.sample_uniform([u[0], u[1]]));
            return Some(position + direction * (self.ball.center - position).length());
        }
        let sample = light.sample_li(&SurfacePoint::in_space(self.ball.center), normal, [u[2], u[3]]);
        let axis = sample.map_or(normal, |sample| sample.ray.direction);
        let [x, y] = (disk([u[0], u[1]]) * self.ball.radius).into();
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
                let out = (world.center - back.origin).length() + 2.0 * world.radius;
                let start = Ray { origin: back.at(out), ..*back };
                let hidden = scene.is_occluded(&start, f64::INFINITY, None, &Cell::new(None));
                (!hidden).then_some(Ray { direction: -back.direction, ..start })
            }
            _ => Some(Ray { origin: back.at(distance), direction: -back.direction }),
        }
    }

    /// Returns the pixels per length where a ray lands, if the camera sees it: directly, through clear objects, or
    /// indirectly.
    fn scale(&self, point: &SurfacePoint, walk: &ColorWalk) -> Option<f64> {
        let left = self.colors.world.method.max_bounces - walk.surfaces;
        let is_near = |place: &&ReachedPlace| (place.position - point.position).length() <= place.of_cell;
        let by_way = |place: &&ReachedPlace| place.surfaces < left && is_near(place);
        let straight = self.straight(point, walk);
        straight.or_else(|| self.reached.iter().find(by_way).map(|place| 1.0 / place.of_pixel))
    }

    fn straight(&self, point: &SurfacePoint, walk: &ColorWalk) -> Option<f64> {
        let (scene, film) = (&self.colors.world.scene, self.colors.world.scene.film);
        let seen = scene.camera.see(point.position, [0.5; 2])?;
        let size = DVec2::new(f64::from(film.width), f64::from(film.height));
        let inside = seen.film.cmpge(DVec2::ZERO).all() && seen.film.cmple(size).all();
        let lit = -walk.last()?.direction.dot(point.normal);
        if !inside || lit * seen.direction.dot(point.normal) <= 0.0 {
            return None;
        }
        let ray = point.leave(seen.direction);
        let distance = (seen.start - ray.origin).length();
        let hides = |object| !scene.material_of(object).lobes().is_transmissive();
        let hidden = scene.is_occluded_by(&ray, distance, None, &Cell::new(None), &hides);
        (!hidden).then(|| (seen.importance * seen.direction.dot(point.normal).abs()).sqrt())
    }
}
