//! Sends photons ahead: those that the camera sees tell where to send the others, and what they are worth.

use std::ops::Range;

use crate::trace::parallel::in_parallel;
use crate::trace::photon::{batches, splat_photon, trace_batch};
use crate::trace::photon_targets::PhotonTarget;
use crate::trace::walk::Polarized;
use crate::trace::width::in_lanes;
use crate::trace::{LightPass, RAYS_OF_A_LOOK, World};

/// Sets these random numbers apart from those of the image.
const SEED: u64 = 0x6168_6561;
/// One in `AHEAD_RATIO` of a target's photons is sent ahead to learn which are seen: at most `MAX_SENT`, and none if
/// that is fewer than `MIN_SENT`, which tell too little.
const AHEAD_RATIO: u64 = 8;
const MIN_SENT: u64 = 4096;
const MAX_SENT: u64 = 1 << 16;
/// Most photons of all targets that the plan sends ahead, whatever the size of the image. The first number is for
/// learning where to send the others; it is also limited to what the rays of a look trace, unless that is too few. The
/// second is for telling which photons are seen.
const PLAN_PHOTONS: u64 = 1 << 16;
const PLAN_SEEN_PHOTONS: u64 = 1 << 16;
/// Most rays that a plan traces to learn where to send photons, and again to tell which are seen. A photon in a heap of
/// glass balls takes a hundred.
const MAX_RAYS: f64 = (4 * RAYS_OF_A_LOOK) as f64;
/// Photons of all targets that tell how many rays one takes.
const FIRST_PHOTONS: u64 = 256;

/// What photons sent ahead found.
#[derive(Default)]
struct PilotPhotons {
    /// For each target, the places of its photons and whether the camera saw them.
    outcomes: Vec<Vec<([f64; 2], bool)>>,
    rays: u64,
}

impl PilotPhotons {
    /// Estimates how many photons of each target can be traced with `rays` rays, from what these took.
    fn photons_per_target(&self, rays: f64) -> u64 {
        let sent = self.outcomes.iter().map(Vec::len).sum::<usize>() as f64;
        (rays * sent / (self.rays as f64 * self.outcomes.len() as f64)) as u64
    }
}

/// Sends photons ahead: of each target, those with the given numbers, as long as it has them. Tests whether the format
/// sees them, even when a crop or overscan is rendered, so that all parts are rendered the same way.
fn send_ahead<const N: usize>(world: &World, numbers: Range<u64>) -> PilotPhotons {
    let world = world.of_the_format();
    let Some(targets) = &world.photon_targets else { return PilotPhotons::default() };
    let numbers_of = |target: &PhotonTarget| numbers.start..numbers.end.min(target.photons);
    let batches = batches(targets, numbers_of, world.method.seed ^ SEED);
    let trace_batch = |number: usize| {
        trace_batch::<N, Polarized, _>(&world, targets, batches[number], true, &splat_photon::<N, Polarized>)
    };
    let results = in_parallel(batches.len(), &trace_batch);
    let mut pilot_photons = PilotPhotons { outcomes: vec![Vec::new(); targets.targets.len()], rays: 0 };
    for (batch, sent) in batches.iter().zip(results) {
        pilot_photons.rays += sent.stats.rays;
        pilot_photons.outcomes[batch.target].extend(sent.outcomes);
    }
    pilot_photons
}

/// Returns the number of photons of each target that tell how many rays one takes.
fn first_per_target(world: &World) -> u64 {
    world.photon_targets.as_ref().map_or(0, |targets| (FIRST_PHOTONS / targets.targets.len() as u64).max(1))
}

/// Sends `max` photons of each target ahead, or as many as [`MAX_RAYS`] can trace, but at least [`FIRST_PHOTONS`] in
/// all.
fn send_some_ahead<const N: usize>(world: &World, max: u64) -> PilotPhotons {
    let first = max.min(first_per_target(world));
    let mut pilot_photons = send_ahead::<N>(world, 0..first);
    let more = send_ahead::<N>(world, first..max.min(pilot_photons.photons_per_target(MAX_RAYS)));
    pilot_photons.rays += more.rays;
    pilot_photons.outcomes.iter_mut().zip(more.outcomes).for_each(|(found, more)| found.extend(more));
    pilot_photons
}

/// Returns the share of each light's photons that the camera sees; of many lights, of a light and its neighbors.
pub fn seen_photons(world: &World) -> Vec<f64> {
    let mut shares = vec![0.0; world.scene.lights.len()];
    let Some(targets) = &world.photon_targets else { return shares };
    let max = (PLAN_SEEN_PHOTONS / targets.targets.len() as u64).clamp(1, MIN_SENT);
    let found = in_lanes!(&world.method.basis, N => send_some_ahead::<N>(world, max)).outcomes;
    let mut counts = vec![[0_u32; 2]; shares.len()];
    for (target, photons) in targets.targets.iter().zip(found) {
        let [sent, seen] = &mut counts[target.light];
        *sent += photons.len() as u32;
        *seen += photons.iter().filter(|photon| photon.1).count() as u32;
    }
    for group in world.photon_light_groups() {
        let count_in_group = |i: usize| group.iter().map(|&light| counts[light][i]).sum::<u32>();
        let share = f64::from(count_in_group(1)) / f64::from(count_in_group(0).max(1));
        group.iter().for_each(|&light| shares[light] = share);
    }
    shares
}

/// Returns a world with another light pass and photons sent ahead, for a plan. Their number does not grow with the
/// image, and none are sent if learning enough would take too many rays.
pub fn piloted(world: &World, light_pass: LightPass) -> World {
    let world = world.with_light_pass(Some(light_pass));
    in_lanes!(&world.method.basis, N => with_guided_photons::<N>(world))
}

fn with_guided_photons<const N: usize>(mut world: World) -> World {
    let targets = world.photon_targets.as_ref().map_or(1, |targets| targets.targets.len() as u64);
    let max = PLAN_PHOTONS / targets;
    if max >= MIN_SENT {
        let first = send_ahead::<N>(&world, 0..first_per_target(&world));
        if first.photons_per_target(MAX_RAYS) >= MIN_SENT {
            train::<N>(&mut world, first.photons_per_target(RAYS_OF_A_LOOK as f64).clamp(MIN_SENT, max));
        }
    }
    world
}

/// Sends photons ahead, and aims the others at where those were seen.
pub fn guide_photons(world: &mut World) {
    in_lanes!(&world.method.basis, N => train::<N>(world, u64::MAX));
}

/// Sends at most `max` photons of each target ahead, and aims the others at where those were seen.
fn train<const N: usize>(world: &mut World, max: u64) {
    let targets = world.photon_targets.iter().flat_map(|targets| &targets.targets);
    let Some(least) = targets.map(|target| target.photons / AHEAD_RATIO).min() else { return };
    let ahead = least.min(MAX_SENT).min(max);
    if ahead >= MIN_SENT {
        let found = send_ahead::<N>(world, 0..ahead).outcomes;
        if let Some(targets) = &mut world.photon_targets {
            targets.learn(&found);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use crate::spectrum::{Basis, ColorSpace};
    use crate::trace::{Method, Smoothness, Transport};

    /// Returns a scene whose first light sends the given number of photons.
    fn world_sending(photons: u64, text: &str) -> World {
        let scene = Scene::parse(text, ".").expect("it is a scene");
        let transport = Transport::Random { split: 0.05, roulette: 0.05 };
        let method = Method::of_paths(Basis::rgb(ColorSpace::Rec709), transport, 0);
        World::new(&scene, method).with_light_pass(Some(LightPass {
            photons,
            lights: vec![0],
            openings: Vec::new(),
            to: vec![Smoothness::Whole],
            map: None,
        }))
    }

    /// Returns a heap of glass balls under a spot, in which a photon takes dozens of rays.
    fn heap() -> World {
        let mut text = String::from(
            "[camera]\nposition = [0, -20, 4]\nlook_at = [0, 0, 0]\nvertical_fov = 40\n[film]\nwidth = 64\nheight = 48\n\
             [material.glass]\ndielectric = { index = 1.5 }\n[material.floor]\ndiffuse = { reflectance = 0.5 }\n\
             [[object]]\nmaterial = \"floor\"\nshape.quad = { center = [0, 0, -4], u = [20, 0, 0], v = [0, 20, 0] }\n\
             [[light]]\nspot = { position = [0, 0, 20], toward = [0, 0, -1], cone_angle = 30, intensity = 3000 }\n",
        );
        for ball in 0..512 {
            let [x, y, z] = [ball % 8, ball / 8 % 8, ball / 64].map(|i| f64::from(i) - 3.5);
            text += &format!(
                "[[object]]\nmaterial = \"glass\"\nshape.sphere = {{ center = [{x}, {y}, {z}], radius = 0.4 }}\n"
            );
        }
        world_sending(1 << 20, &text)
    }

    #[test]
    fn a_plan_sends_no_more_photons_ahead_than_it_has_time_for() {
        let world = heap();
        let first = send_ahead::<4>(&world, 0..first_per_target(&world));
        let all = first.rays as f64 * MIN_SENT as f64 / first_per_target(&world) as f64;
        assert!(all > 2.0 * MAX_RAYS, "{all} rays are affordable");
        let some = send_some_ahead::<4>(&world, MIN_SENT);
        assert!((some.rays as f64 / MAX_RAYS - 1.0).abs() < 0.1, "{} rays", some.rays);
        for (first, some) in first.outcomes.iter().zip(&some.outcomes) {
            assert!(some.len() > first.len() && some.starts_with(first), "{} and {}", first.len(), some.len());
        }
        // Nothing is learned from them.
        let photons = |world: &World| -> Vec<u64> {
            world.photon_targets.iter().flat_map(|targets| &targets.targets).map(|target| target.photons).collect()
        };
        assert_eq!(photons(&with_guided_photons::<4>(world.clone())), photons(&world));
    }

    /// Each pane of a stack reflects a twelfth of the light. With 30 panes, a photon that took both ways never ended.
    #[test]
    fn photons_between_many_panes_come_to_an_end() {
        let mut text = String::from(
            "[camera]\nposition = [0, 3, 12]\nlook_at = [0, 0, 0]\nvertical_fov = 45\n[film]\nwidth = 64\nheight = 36\n\
             [material.pane]\nthin = { index = 1.5 }\n[material.floor]\ndiffuse = { reflectance = 0.7 }\n[[object]]\n\
             material = \"floor\"\nshape.plane = { point = [0, -1, 0], normal = [0, 1, 0] }\n\
             [[light]]\npoint = { position = [0, 2, -3], intensity = 10 }\n",
        );
        for pane in 0..30 {
            let z = 0.1 * f64::from(pane);
            text += &format!(
                "[[object]]\nmaterial = \"pane\"\nshape.quad = {{ center = [0, 0, {z}], u = [4, 0, 0], v = [0, 4, 0] }}\n"
            );
        }
        let pilot_photons = send_ahead::<4>(&world_sending(1 << 16, &text), 0..64);
        let sent: usize = pilot_photons.outcomes.iter().map(Vec::len).sum();
        let each = pilot_photons.rays as f64 / sent as f64;
        assert!((30.0..300.0).contains(&each), "{each} rays");
    }
}
