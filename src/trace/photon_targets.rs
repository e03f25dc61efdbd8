//! Where photons are sent, and how they start.

use std::sync::Arc;

use super::guide::Guide;
use super::photon_focus::{FocusBall, FocusPlace, Smoothness, parts, reach};
use crate::light::{Beam, LeSample, LightId, Opening};
use crate::math::{DVec3, Ray, group_neighbors};
use crate::scene::Scene;
use crate::shape::Ball;
use crate::spectrum::Table;

/// Photons of one light toward one ball of equally smooth objects, or toward a part of the ball.
#[derive(Clone, Debug)]
pub(super) struct PhotonTarget {
    pub(super) light: LightId,
    smoothness: Smoothness,
    pub(super) photons: u64,
    /// Share of the whole ball's photons. A part is worth its share however small the part is.
    share: f64,
    /// Whether it is a part of the preceding whole.
    is_part: bool,
    beam: Beam,
    /// Which part of the beam is worth sending photons into.
    pub(super) guide: Arc<Guide>,
    /// Approximate flux that it sends.
    flux: f64,
}

/// All targets of photons, and the lights that send them.
#[derive(Clone, Debug)]
pub(super) struct PhotonTargets {
    /// The targets. Those of one light follow each other.
    pub(super) targets: Vec<PhotonTarget>,
    /// Which lights send photons.
    pub(super) lights: Vec<bool>,
    /// The smoothness of each object that photons are sent to.
    objects: Vec<Option<Smoothness>>,
    /// Where photons are sent to unbounded objects.
    pub(super) reach: Option<Ball>,
    /// A ball around everything finite.
    world: Ball,
    /// Requested number of photons.
    photons: u64,
}

/// Maximum number of balls of objects that photons are sent to, and of targets of all lights. If there are more
/// objects, neighbors share a ball.
const MAX_BALLS: usize = 32;
const MAX_TARGETS: usize = 8192;
/// Maximum number of parts of a ball, and of all balls of all lights unless each ball has only one.
const MAX_PARTS: usize = 6;
const MAX_PARTS_IN_ALL: usize = 12;
/// Maximum number of balls that are compared with each other.
const MAX_COMPARED_BALLS: usize = 4096;
/// Share of the photons that is distributed evenly over all targets; the rest is distributed by flux.
const UNIFORM_SHARE: f64 = 0.1;
/// Rough reflectance of a clear coat: of the flux sent to partly smooth objects, this share goes on from there.
const COAT_REFLECTANCE: f64 = 0.05;

impl PhotonTargets {
    /// Returns the targets of some lights, given with their luminances, toward all objects of some kinds of smoothness.
    /// Skies among the lights also send photons through openings. On large objects, most photons go to the places that
    /// matter. Returns `None` if there are no such objects, or if no light shines there.
    pub(super) fn new(
        scene: &Scene<Table>,
        lights: &[(LightId, f64)],
        openings: &[Opening],
        places: &[FocusPlace],
        to: &[Smoothness],
        photons: u64,
    ) -> Option<Self> {
        let reach = reach(places);
        let smoothness_of = |object: usize| {
            let is_bounded = scene.objects[object].shape.is_bounded();
            Smoothness::sent_to(scene, object, to).filter(|_| is_bounded || reach.is_some())
        };
        let objects: Vec<Option<Smoothness>> = (0..scene.objects.len()).map(smoothness_of).collect();
        let max_count = (MAX_TARGETS / lights.len().max(1)).clamp(1, MAX_BALLS);
        let mut balls = Vec::new();
        for smooth in Smoothness::ALL {
            let objects_of_kind =
                || objects.iter().zip(scene.objects.iter()).filter(|(found, _)| **found == Some(smooth));
            let finite =
                merge_balls(objects_of_kind().filter_map(|(_, object)| object.shape.ball()).collect(), max_count);
            balls.extend(finite.into_iter().map(|ball| (smooth, ball)));
            let has_unbounded = objects_of_kind().any(|(_, object)| !object.shape.is_bounded());
            balls.extend(reach.filter(|_| has_unbounded).map(|ball| (smooth, ball)));
        }
        let max_count = (MAX_PARTS_IN_ALL / (lights.len() * balls.len()).max(1)).clamp(1, MAX_PARTS);
        let wholes: Vec<_> =
            balls.into_iter().map(|(smooth, ball)| (smooth, ball, parts(places, smooth, &ball, max_count))).collect();
        let guides = [Guide::uniform(), Guide::disk()].map(Arc::new);
        let targets: Vec<_> =
            lights.iter().flat_map(|light| of_light(scene, light.0, light.1, openings, &wholes, &guides)).collect();
        let mut lights = vec![false; scene.lights.len()];
        targets.iter().for_each(|target| lights[target.light] = true);
        let world = ball_around_all(scene).into_iter().chain(reach).reduce(Ball::around)?;
        let mut targets = Self { targets, lights, objects, reach, world, photons };
        targets.distribute_photons();
        (!targets.targets.is_empty()).then_some(targets)
    }

    pub(super) fn photons(&self) -> u64 {
        self.targets.iter().map(|target| target.photons).sum()
    }

    /// Returns whether photons are sent to a place on an object.
    pub(super) fn includes(&self, scene: &Scene<Table>, object: u32, place: DVec3) -> bool {
        let is_near = || self.reach.is_some_and(|reach| reach.contains(place));
        self.objects[object as usize].is_some() && (scene.objects[object as usize].shape.is_bounded() || is_near())
    }

    /// Returns the approximate flux that all targets send, as CIE Y.
    pub(super) fn flux(&self) -> f64 {
        self.targets.chunk_by(is_same_whole).map(flux).sum()
    }

    /// Returns the target of a photon, given the photon's number among those of all targets.
    pub(super) fn target_of_photon(&self, number: u64) -> usize {
        let mut before = 0;
        let holds = |target: &PhotonTarget| {
            before += target.photons;
            number < before
        };
        self.targets.iter().position(holds).unwrap_or(self.targets.len() - 1)
    }

    /// Adopts what other targets of the same scene, with all these lights, have learned.
    pub(super) fn adopt(&mut self, guided: &Self) {
        self.targets.clone_from(&guided.targets);
        self.targets.retain(|target| self.lights[target.light] && self.objects.contains(&Some(target.smoothness)));
        self.distribute_photons();
    }

    /// Keeps only the targets of some lights, given in order, and of one kind of smoothness.
    pub(super) fn only(mut self, lights: &[LightId], smoothness: Smoothness) -> Self {
        self.targets.retain(|target| target.smoothness == smoothness && lights.binary_search(&target.light).is_ok());
        self.objects.iter_mut().for_each(|object| *object = object.filter(|smooth| *smooth == smoothness));
        self
    }

    /// Returns whether photons are sent to objects of this kind of smoothness.
    pub(super) fn has_smoothness(&self, smoothness: Smoothness) -> bool {
        self.targets.iter().any(|target| target.smoothness == smoothness)
    }

    /// Returns these targets with the number of photons multiplied by a factor.
    pub(super) fn scaled(&self, factor: f64) -> Self {
        let photons = (factor * self.photons as f64).ceil() as u64;
        let mut targets = Self { photons, ..self.clone() };
        targets.distribute_photons();
        targets
    }

    /// Distributes the photons over the targets, mostly by flux.
    fn distribute_photons(&mut self) {
        let (total, count) = (self.flux(), self.targets.len() as f64);
        for whole in self.targets.chunk_by_mut(is_same_whole) {
            let flux = flux(whole);
            let sends_flux = |target: &PhotonTarget| target.flux > 0.0;
            let shares: f64 = whole.iter().filter(|target| sends_flux(target)).map(|target| target.share).sum();
            for target in whole {
                let share_of_whole = if sends_flux(target) { target.share / shares } else { 0.0 };
                let by_flux = if total > 0.0 { flux * share_of_whole / total } else { 1.0 / count };
                let share = UNIFORM_SHARE / count + (1.0 - UNIFORM_SHARE) * by_flux;
                target.photons = (share * self.photons as f64).round().max(1.0) as u64;
            }
        }
    }

    /// Learns from some photons of each target: their `guide_uv`, and whether the camera saw them.
    pub(super) fn learn(&mut self, found: &[Vec<([f64; 2], bool)>]) {
        for (target, photons) in self.targets.iter_mut().zip(found) {
            let seen_count = photons.iter().filter(|photon| photon.1).count();
            target.flux *= seen_count as f64 / photons.len().max(1) as f64;
            if target.beam.is_outside_ball {
                target.guide = Arc::new(Guide::from_photons(photons));
            }
        }
        self.distribute_photons();
    }

    /// Returns whether photons of a light start along the line of a ray that leads to it.
    pub(super) fn sends_along(&self, scene: &Scene<Table>, light: LightId, ray: &Ray) -> bool {
        let source = &scene.lights[light];
        if !self.lights[light] || source.sends_photons_from(ray.direction) {
            return self.lights[light];
        }
        let sample = LeSample { ray: Ray { direction: -ray.direction, ..*ray }, factor: 1.0, surface: None };
        let starts = |target: &PhotonTarget| source.pdf_le(&target.beam, &sample, |uv| target.guide.density(uv)) > 0.0;
        self.targets.iter().any(|target| target.light == light && target.beam.opening.is_some() && starts(target))
    }

    /// Samples the start of a photon of one target, for a place sampled by its guide and two random numbers. Returns
    /// `None` if the light does not shine there.
    ///
    /// The flux is divided by the density of photons that all targets of the light send along that line, because beams
    /// may overlap.
    pub(super) fn sample_le(
        &self,
        scene: &Scene<Table>,
        number: usize,
        guide_uv: [f64; 2],
        u: [f64; 2],
    ) -> Option<LeSample> {
        let of_light = |target: &&PhotonTarget| target.light == self.targets[number].light;
        let first = self.targets[..number].iter().rposition(|target| !of_light(&target)).map_or(0, |before| before + 1);
        let light = &scene.lights[self.targets[number].light];
        let sample = light.sample_le(&self.targets[number].beam, guide_uv, u)?;
        let ray = if light.is_infinite() { started_outside(scene, &self.world, &sample.ray) } else { sample.ray };
        let photon_density = |target: &PhotonTarget| {
            target.photons as f64 * light.pdf_le(&target.beam, &sample, |uv| target.guide.density(uv))
        };
        let factor = sample.factor / self.targets[first..].iter().take_while(of_light).map(photon_density).sum::<f64>();
        (factor > 0.0 && factor.is_finite()).then_some(LeSample { ray, factor, ..sample })
    }
}

/// Returns the targets of a light with a luminance: each ball, followed by its parts; for a sky, also through each
/// opening. Photons start by one of two guides, the even one or, toward what is apart from the light, the disk.
fn of_light(
    scene: &Scene<Table>,
    light: LightId,
    luminance: f64,
    openings: &[Opening],
    wholes: &[(Smoothness, Ball, Vec<FocusBall>)],
    [uniform, disk]: &[Arc<Guide>; 2],
) -> Vec<PhotonTarget> {
    let target = |opening: Option<&Opening>, smoothness: Smoothness, ball: &Ball, share: f64, is_part: bool| {
        let source = &scene.lights[light];
        let beam = opening.map_or_else(|| source.beam(ball), |opening| source.beam_through(opening, ball))?;
        let onward_share = match smoothness {
            Smoothness::Whole | Smoothness::Narrow => 1.0,
            Smoothness::Partial | Smoothness::NarrowPartial => COAT_REFLECTANCE,
        };
        let flux = beam.flux * luminance * onward_share;
        let guide = if beam.is_outside_ball { disk.clone() } else { uniform.clone() };
        (flux > 0.0).then_some(PhotonTarget { light, smoothness, photons: 0, share, is_part, beam, guide, flux })
    };
    let mut targets = Vec::new();
    for opening in std::iter::once(None).chain(openings.iter().map(Some)) {
        for (smooth, ball, parts) in wholes {
            let share = 1.0 - parts.iter().map(|part| part.share).sum::<f64>();
            if let Some(whole) = target(opening, *smooth, ball, share, false) {
                targets.push(whole);
                targets.extend(parts.iter().filter_map(|part| target(opening, *smooth, &part.ball, part.share, true)));
            }
        }
    }
    targets
}

/// Returns whether a target is a part of the same whole as the one before it.
fn is_same_whole(_: &PhotonTarget, next: &PhotonTarget) -> bool {
    next.is_part
}

/// Returns the approximate flux that is sent to a whole. Some of it may have been seen only through the parts.
fn flux(targets: &[PhotonTarget]) -> f64 {
    let (parts, wholes): (Vec<_>, Vec<_>) = targets.iter().partition(|target| target.is_part);
    let sum = |targets: Vec<&PhotonTarget>| targets.iter().map(|target| target.flux).sum::<f64>();
    f64::max(sum(wholes), sum(parts))
}

/// Returns a ball around everything finite; `None` if nothing is.
pub(super) fn ball_around_all(scene: &Scene<Table>) -> Option<Ball> {
    scene.objects.iter().filter_map(|object| object.shape.ball()).reduce(Ball::around)
}

/// Returns the ray of a path from the sky, started outside a ball around everything finite and beyond all planes.
pub(super) fn started_outside(scene: &Scene<Table>, world: &Ball, ray: &Ray) -> Ray {
    let sky = -ray.direction;
    let distance_outside = (world.center - ray.origin).dot(sky) + 2.0 * world.radius;
    let mut reversed_ray = Ray { origin: ray.origin + sky * distance_outside, direction: sky };
    // A ray crosses a plane once.
    for _ in scene.unbounded() {
        let Some(hit) = scene.nearest(&reversed_ray, f64::INFINITY, &|_| true) else { break };
        reversed_ray.origin += sky * (hit.intersection.t + world.radius);
    }
    Ray { direction: ray.direction, ..reversed_ray }
}

/// Returns the balls that lie in no other ball. If more than `max_count` are left, neighbors are merged.
fn merge_balls(balls: Vec<Ball>, max_count: usize) -> Vec<Ball> {
    let holds = |a: &Ball, b: &Ball| (a.center - b.center).length() + b.radius <= a.radius;
    let mut outer: Vec<Ball> = Vec::new();
    if balls.len() > MAX_COMPARED_BALLS {
        // Too many balls to compare with each other.
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
    let mut add_group = |group: &[Ball]| found.extend(group.iter().copied().reduce(Ball::around));
    group_neighbors(&mut outer, max_count, &|ball| ball.center, &mut add_group);
    found
}
