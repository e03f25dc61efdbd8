//! Where photons start and where they are sent.

use std::f64::consts::{PI, TAU};

use super::LightPass;
use crate::light::{Area, Light, LightId};
use crate::material::Material;
use crate::math::{DVec3, Frame, Ray, cone, cosine_hemisphere, disk, unit};
use crate::scene::Scene;
use crate::shape::{Ball, Sides};
use crate::spectrum::Table;

/// Photons of one light toward one ball of smooth objects.
#[derive(Clone, Copy, Debug)]
pub(super) struct Aim {
    pub(super) light: LightId,
    /// How many photons are sent.
    pub(super) photons: u64,
    ball: Ball,
    /// Of a light that is a point: axis and 1 - cos of the cone that is shone into.
    lobe: (DVec3, f64),
}

/// All the ways photons are sent, and to what.
#[derive(Clone, Debug)]
pub(super) struct Aims {
    /// Those of one light follow each other.
    pub(super) aims: Vec<Aim>,
    /// Which lights send photons.
    pub(super) lights: Vec<bool>,
    /// Which objects they are sent to.
    pub(super) objects: Vec<bool>,
    /// A ball around all that is finite.
    world: Ball,
}

/// A photon on its way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Emitted {
    pub(super) ray: Ray,
    /// The factor on the light's emission that makes the photon's flux of it.
    pub(super) factor: f64,
}

/// Most balls of objects that photons are sent to: of more objects, neighbors share one.
const MOST: usize = 32;
/// Share of the photons that all aims get alike; the others go by flux.
const EVENLY: f64 = 0.1;
/// How often the outer side of a closed lamp around which an object is built sends a photon, and not the inner one.
const OUTWARD: f64 = 0.875;

/// Whether photons can be sent to an object: finite, and smooth where light goes on.
pub(super) fn is_target(scene: &Scene<Table>, object: usize) -> bool {
    let material = scene.material_of(object as u32);
    let smooth = !material.scatters_widely() && !matches!(material, Material::Emissive(_));
    smooth && scene.objects[object].shape.bounds().is_some()
}

impl Aims {
    /// Aims at all objects that photons can be sent to; none if there is none, or none of the lights shines there.
    pub(super) fn new(scene: &Scene<Table>, pass: &LightPass) -> Option<Self> {
        let objects: Vec<bool> = (0..scene.objects.len()).map(|object| is_target(scene, object)).collect();
        let shapes = || scene.objects.iter().map(|object| &object.shape);
        let balls = shapes().zip(&objects).filter(|(_, target)| **target).filter_map(|(shape, _)| shape.ball());
        let balls = gathered(balls.collect());
        let world = shapes().filter_map(|shape| shape.ball()).reduce(Ball::around)?;
        let mut flux = Vec::new();
        let mut aims = Vec::new();
        for &light in &pass.lights {
            let brightness = scene.lights[light].emission().range().1;
            for ball in &balls {
                let (lobe, size) = reach(&scene.lights[light], ball);
                if size * brightness > 0.0 {
                    flux.push(size * brightness);
                    aims.push(Aim { light, photons: 0, ball: *ball, lobe });
                }
            }
        }
        let (total, count) = (flux.iter().sum::<f64>(), flux.len() as f64);
        for (aim, flux) in aims.iter_mut().zip(flux) {
            let share = EVENLY / count + (1.0 - EVENLY) * flux / total;
            aim.photons = (share * pass.photons as f64).round().max(1.0) as u64;
        }
        let lights = (0..scene.lights.len()).map(|light| aims.iter().any(|aim| aim.light == light)).collect();
        (!aims.is_empty()).then_some(Self { aims, lights, objects, world })
    }

    /// How many balls are aimed at.
    pub(super) fn balls(&self) -> usize {
        let light = self.aims[0].light;
        self.aims.iter().filter(|aim| aim.light == light).count()
    }

    /// A photon of an aim for four random numbers; none where the light does not shine.
    ///
    /// Its flux is divided by how many photons all aims of the light send along the same line: their cones may overlap.
    pub(super) fn emit(&self, scene: &Scene<Table>, number: usize, u: [f64; 4]) -> Option<Emitted> {
        let aim = &self.aims[number];
        let light = &scene.lights[aim.light];
        let of_light = || self.aims.iter().enumerate().filter(|(_, other)| other.light == aim.light);
        let sent = |density: &dyn Fn(&Aim) -> Option<f64>, own: f64| -> f64 {
            let by = |(other, aim): (usize, &Aim)| {
                // Rounding may put a photon just outside of its own cone.
                let density = if other == number { density(aim).unwrap_or(own) } else { density(aim).unwrap_or(0.0) };
                aim.photons as f64 * density
            };
            of_light().map(by).sum()
        };
        let (ray, flux, sent) = match light {
            Light::Point(_) | Light::Spot(_) => {
                let (axis, one_minus_cos) = aim.lobe;
                let (local, own) = cone(one_minus_cos, [u[0], u[1]]);
                let direction = unit(Frame::about(axis).to_world(local));
                let (origin, part) = match light {
                    Light::Spot(spot) => (spot.position, spot.part(direction)),
                    Light::Point(point) => (point.position, 1.0),
                    _ => return None,
                };
                let density = |aim: &Aim| within(aim.lobe, direction).then(|| 1.0 / (TAU * aim.lobe.1));
                (Ray { origin: origin.into(), direction }, part, sent(&density, own))
            }
            Light::Area(area) => {
                let (point, _) = area.shape.emit(&aim.ball, [u[2], u[3]])?;
                let direction = toward(area, &aim.ball, point.position, point.normal, [u[0], u[1]]);
                let cos = point.normal.dot(direction);
                if !area.sides.shine(cos > 0.0) {
                    return None;
                }
                let density = |aim: &Aim| {
                    let along = density_toward(area, &aim.ball, point.position, direction, cos)?;
                    Some(along * area.shape.emit_density(&aim.ball, &point))
                };
                let own = 1.0 / (TAU * aim.ball.cone_from(point.position).1 * area.shape.area());
                (point.leave(direction), cos.abs(), sent(&density, own))
            }
            Light::Sun(_) => {
                let sighting = light.aim(aim.ball.center, DVec3::Y, [u[0], u[1]])?;
                let sky = sighting.direction;
                let place = disk([u[2], u[3]]) * aim.ball.radius;
                let point = aim.ball.center + Frame::about(sky).to_world(place.extend(0.0));
                let view = light.view(&Ray { origin: point, direction: sky }, DVec3::Y, &sighting)?;
                let area = |ball: &Ball| PI * ball.radius * ball.radius;
                let density = |aim: &Aim| {
                    let beside = sky.cross(point - aim.ball.center).length_squared();
                    (beside <= aim.ball.radius * aim.ball.radius).then(|| 1.0 / area(&aim.ball))
                };
                // From outside of all that is finite; only a plane can hide the sun there.
                let out = (self.world.center - point).dot(sky) + 2.0 * self.world.radius;
                let start = point + sky * out;
                let hidden = scene.is_hidden(&Ray { origin: start, direction: sky }, f64::INFINITY, None, &0.into());
                if hidden {
                    return None;
                }
                let flux = view.factor / view.pdf.unwrap_or(1.0);
                (Ray { origin: start, direction: -sky }, flux, sent(&density, 1.0 / area(&aim.ball)))
            }
            Light::Environment(_) => return None,
        };
        let factor = flux / sent;
        (factor > 0.0 && factor.is_finite()).then_some(Emitted { ray, factor })
    }
}

/// The cone that a point shines into, and how much of the light's emission goes to a ball.
fn reach(light: &Light<Table>, ball: &Ball) -> ((DVec3, f64), f64) {
    let all = (DVec3::Z, 2.0);
    match light {
        Light::Point(point) => {
            let lobe = ball.cone_from(point.position.into());
            (lobe, TAU * lobe.1)
        }
        Light::Spot(spot) => {
            let lobe = ball.cone_from(spot.position.into());
            let own = spot.cone();
            let apart = libm::acos(lobe.0.dot(own.0).clamp(-1.0, 1.0));
            let half = |one_minus_cos: f64| libm::acos((1.0 - one_minus_cos).clamp(-1.0, 1.0));
            let misses = lobe.1 < 2.0 && apart > half(lobe.1) + half(own.1);
            let lobe = if own.1 < lobe.1 { own } else { lobe };
            (lobe, if misses { 0.0 } else { TAU * lobe.1 })
        }
        Light::Area(area) => {
            let size = area.shape.emitter(area.sides == Sides::Both).map_or(0.0, |emitter| emitter.intensity);
            let from = area.shape.ball().map_or(ball.center, |own| own.center);
            (all, size * TAU * ball.cone_from(from).1)
        }
        Light::Sun(_) => (all, PI * ball.radius * ball.radius),
        Light::Environment(_) => (all, 0.0),
    }
}

fn within((axis, one_minus_cos): (DVec3, f64), direction: DVec3) -> bool {
    0.5 * (direction - axis).length_squared() <= one_minus_cos
}

/// A direction from a point of a lamp: even in the cone that a ball fills; by its cosine where the lamp is inside the ball.
fn toward(area: &Area<Table>, ball: &Ball, from: DVec3, normal: DVec3, [u, v]: [f64; 2]) -> DVec3 {
    let (axis, one_minus_cos) = ball.cone_from(from);
    if one_minus_cos < 2.0 {
        return unit(Frame::about(axis).to_world(cone(one_minus_cos, [u, v]).0));
    }
    let front = front(area);
    let (side, u) = if u < front { (normal, u / front) } else { (-normal, (u - front) / (1.0 - front)) };
    unit(Frame::about(side).to_world(cosine_hemisphere([u, v])))
}

/// The density of that direction; none where it does not lead to the ball.
fn density_toward(area: &Area<Table>, ball: &Ball, from: DVec3, direction: DVec3, cos: f64) -> Option<f64> {
    let cone = ball.cone_from(from);
    if cone.1 < 2.0 {
        return within(cone, direction).then(|| 1.0 / (TAU * cone.1));
    }
    let front = front(area);
    Some(if cos > 0.0 { front } else { 1.0 - front } * cos.abs() / PI)
}

/// How often a lamp inside a ball shines from its front.
fn front(area: &Area<Table>) -> f64 {
    match (area.sides, area.shape.is_closed()) {
        (Sides::Front, _) => 1.0,
        (Sides::Both, true) => OUTWARD,
        (Sides::Both, false) => 0.5,
    }
}

/// Balls of which none lies in another; of more than are wanted, neighbors as one.
fn gathered(balls: Vec<Ball>) -> Vec<Ball> {
    let holds = |a: &Ball, b: &Ball| (a.center - b.center).length() + b.radius <= a.radius;
    let mut outer: Vec<Ball> = Vec::new();
    for ball in balls {
        if !outer.iter().any(|other| holds(other, &ball)) {
            outer.retain(|other| !holds(&ball, other));
            outer.push(ball);
        }
    }
    let mut found = Vec::new();
    halve(&mut outer, MOST, &mut found);
    found
}

/// Adds at most `most` balls around all of some.
fn halve(balls: &mut [Ball], most: usize, found: &mut Vec<Ball>) {
    if balls.len() <= most {
        found.extend_from_slice(balls);
        return;
    }
    if most == 1 {
        found.extend(balls.iter().copied().reduce(Ball::around));
        return;
    }
    let [low, high] = [DVec3::min, DVec3::max].map(|choose| balls.iter().map(|ball| ball.center).reduce(choose));
    let size = high.unwrap_or_default() - low.unwrap_or_default();
    let axis = (0..3).max_by(|&a, &b| size[a].total_cmp(&size[b])).unwrap_or(0);
    balls.sort_by(|a, b| a.center[axis].total_cmp(&b.center[axis]));
    let (left, right) = balls.split_at_mut(balls.len() / 2);
    halve(left, most / 2, found);
    halve(right, most - most / 2, found);
}
