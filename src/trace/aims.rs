//! Where photons are sent.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use super::guide::Guide;
use crate::light::{Light, LightId};
use crate::material::Material;
use crate::math::DVec3;
use crate::scene::Scene;
use crate::shape::{Ball, Shape, Sides};
use crate::spectrum::Table;

/// Photons of one light toward one ball of smooth objects.
#[derive(Clone, Debug)]
pub(super) struct Aim {
    pub(super) light: LightId,
    /// How many photons are sent.
    pub(super) photons: u64,
    pub(super) ball: Ball,
    /// Of a light that is a point: axis and 1 - cos of the cone that is shone into.
    pub(super) lobe: (DVec3, f64),
    /// Which places of the cone, or of the ball's disc, are worth it.
    pub(super) guide: Arc<Guide>,
    /// The flux it sends, about.
    flux: f64,
    /// Whether the light is apart from the ball, so that a place stands for a way to it.
    apart: bool,
}

/// Whether photons can be sent from a light: not from the sky, nor from a lamp that shows an image, which does not send the same
/// from all its points, nor from an instance, whose points are drawn by their areas before it was placed.
pub fn is_photon_source<S>(light: &Light<S>) -> bool {
    match light {
        Light::Environment(_) => false,
        Light::Area(area) => area.coordinates.is_none() && !matches!(*area.shape, Shape::Instance(_)),
        Light::Point(_) | Light::Spot(_) | Light::Sun(_) => true,
    }
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
    pub(super) world: Ball,
    /// Photons asked for.
    photons: u64,
}

/// Most balls of objects that photons are sent to: of more objects, neighbors share one; and most aims of all lights together.
const MOST: usize = 32;
const MOST_AIMS: usize = 8192;
/// Balls that are held against each other.
const MANY: usize = 4096;
/// Share of the photons that all aims get alike; the others go by flux.
const EVENLY: f64 = 0.1;

/// Whether photons can be sent to an object: finite, and smooth where light goes on.
pub fn is_photon_target<S>(scene: &Scene<S>, object: usize) -> bool {
    let material = scene.material_of(object as u32);
    let smooth = !material.scatters_widely() && !matches!(material, Material::Emissive(_));
    smooth && scene.objects[object].shape.bounds().is_some()
}

impl Aims {
    /// Aims some lights, given with their luminances, at all objects that photons can be sent to; none if there is none, or none of the lights shines there.
    pub(super) fn new(scene: &Scene<Table>, lights: &[(LightId, f64)], photons: u64) -> Option<Self> {
        let objects: Vec<bool> = (0..scene.objects.len()).map(|object| is_photon_target(scene, object)).collect();
        let shapes = || scene.objects.iter().map(|object| &object.shape);
        let balls = shapes().zip(&objects).filter(|(_, target)| **target).filter_map(|(shape, _)| shape.ball());
        let balls = gathered(balls.collect(), (MOST_AIMS / lights.len().max(1)).clamp(1, MOST));
        let [even, disc] = [Guide::even(), Guide::disc()].map(Arc::new);
        let world = shapes().filter_map(|shape| shape.ball()).reduce(Ball::around)?;
        let mut aims = Vec::new();
        for (&(light, luminance), ball) in lights.iter().flat_map(|light| balls.iter().map(move |ball| (light, ball))) {
            let (lobe, size) = reach(&scene.lights[light], ball);
            let flux = size * luminance;
            if flux > 0.0 {
                let apart = is_apart(&scene.lights[light], ball);
                let guide = if apart { disc.clone() } else { even.clone() };
                aims.push(Aim { light, photons: 0, ball: *ball, lobe, guide, flux, apart });
            }
        }
        let mut lights = vec![false; scene.lights.len()];
        aims.iter().for_each(|aim| lights[aim.light] = true);
        let mut aims = Self { aims, lights, objects, world, photons };
        aims.share_out();
        (!aims.aims.is_empty()).then_some(aims)
    }

    /// How many photons are sent in all.
    pub(super) fn photons(&self) -> u64 {
        self.aims.iter().map(|aim| aim.photons).sum()
    }

    /// Lets each aim have its part of the photons, most of them by flux.
    fn share_out(&mut self) {
        let (total, count) = (self.aims.iter().map(|aim| aim.flux).sum::<f64>(), self.aims.len() as f64);
        for aim in &mut self.aims {
            let by_flux = if total > 0.0 { aim.flux / total } else { 1.0 / count };
            let share = EVENLY / count + (1.0 - EVENLY) * by_flux;
            aim.photons = (share * self.photons as f64).round().max(1.0) as u64;
        }
    }

    /// Follows what was learned: of some photons of each aim, their places and whether the camera saw them.
    pub(super) fn learn(&mut self, found: &[Vec<([f64; 2], bool)>]) {
        for (aim, photons) in self.aims.iter_mut().zip(found) {
            let seen = photons.iter().filter(|photon| photon.1).count();
            aim.flux *= seen as f64 / photons.len().max(1) as f64;
            if aim.apart {
                aim.guide = Arc::new(Guide::learned(photons));
            }
        }
        self.share_out();
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
            let (lobe, own) = (ball.cone_from(spot.position.into()), spot.cone());
            let half = |one_minus_cos: f64| libm::acos((1.0 - one_minus_cos).clamp(-1.0, 1.0));
            let apart = libm::acos(lobe.0.dot(own.0).clamp(-1.0, 1.0));
            let misses = lobe.1 < 2.0 && apart > half(lobe.1) + half(own.1);
            let lobe = if own.1 < lobe.1 { own } else { lobe };
            (lobe, if misses { 0.0 } else { TAU * lobe.1 })
        }
        _ if !is_photon_source(light) => (all, 0.0),
        Light::Area(area) => {
            let size = area.shape.emitter(area.sides == Sides::Both).map_or(0.0, |emitter| emitter.intensity);
            let from = area.shape.ball().map_or(ball.center, |own| own.center);
            (all, size * TAU * ball.cone_from(from).1)
        }
        Light::Sun(_) => (all, PI * ball.radius * ball.radius),
        Light::Environment(_) => (all, 0.0),
    }
}

/// Whether no point of a lamp lies in a ball.
fn is_apart(light: &Light<Table>, ball: &Ball) -> bool {
    let Light::Area(area) = light else { return true };
    let lamp = area.shape.ball();
    lamp.is_some_and(|lamp| (lamp.center - ball.center).length() > lamp.radius + ball.radius)
}

/// Balls of which none lies in another; of more than are wanted, neighbors as one.
fn gathered(balls: Vec<Ball>, most: usize) -> Vec<Ball> {
    let holds = |a: &Ball, b: &Ball| (a.center - b.center).length() + b.radius <= a.radius;
    let mut outer: Vec<Ball> = Vec::new();
    if balls.len() > MANY {
        // So many are not held against each other.
        outer = balls;
    } else {
        for ball in balls {
            if !outer.iter().any(|other| holds(other, &ball)) {
                outer.retain(|other| !holds(&ball, other));
                outer.push(ball);
            }
        }
    }
    let mut found = Vec::new();
    halve(&mut outer, most, &mut found);
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
