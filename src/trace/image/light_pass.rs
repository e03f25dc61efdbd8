//! The light pass: caustics, by photons that are sent through glass and over mirrors to what the camera sees.
//!
//! It finds the paths light, one or more smooth surfaces, one that scatters widely, camera; and so all of those paths
//! whose light and first smooth surface photons are sent from and to. The camera's rays leave exactly these out, so
//! that nothing counts twice and no weights are needed. Veach 1997, *Robust Monte Carlo Methods for Light Transport
//! Simulation*, section 10.3.4, has the importance; Grittmann et al. 2018, *Efficient Caustic Rendering with
//! Lightweight Photon Mapping*, the split by kind of path.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use super::tile::{Shown, Tile};
use crate::film::{Layer, Shard};
use crate::trace::contribution::{Contribution, Found};
use crate::trace::parallel::in_parallel;
use crate::trace::pass::Pass;
use crate::trace::photon::{Batch, Splat, batches, batches_of_pass, send, send_shown, show as show_photon};
use crate::trace::photon_targets::{PhotonTarget, PhotonTargets};
use crate::trace::stats::Stats;
use crate::trace::walk::{Polarization, Polarized};
use crate::trace::watch::Watch;
use crate::trace::width::in_lanes;
use crate::trace::{LightPass, RAYS_OF_A_LOOK, World};

/// Batches whose splats are kept in memory at once.
const AT_ONCE: usize = 64;
/// Sets these random numbers apart from those of the camera, and those of photons sent ahead from both.
const SEED: u64 = 0x7068_6f74;
const AHEAD_SEED: u64 = 0x6168_6561;

/// Of a target's photons, one in so many is sent ahead to learn which ones are seen, unless those are too few to tell,
/// and as many as tell enough.
const AHEAD: u64 = 8;
const TOO_FEW: u64 = 4096;
const ENOUGH: u64 = 1 << 16;
/// Photons of all targets that the plan sends ahead, as many whatever the image is: no more than these, and than follow
/// the rays of a look, if those are not too few to tell; and of all targets those that tell which are seen.
const OF_A_PLAN: u64 = 1 << 16;
const SEEN_OF_A_PLAN: u64 = 1 << 16;
/// Most rays that a plan follows to learn where to send photons, and as many to tell which are seen. A photon in a heap
/// of glass balls follows a hundred.
const MOST_RAYS: f64 = (4 * RAYS_OF_A_LOOK) as f64;
/// Photons of all targets that tell how many rays one follows.
const FIRST: u64 = 256;

/// How far a light pass is. It goes on where it stopped.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
pub struct Sending {
    /// Batches that are done.
    batches: usize,
    /// Photons sent.
    pub photons: u64,
    pub(in crate::trace) stats: Stats,
}

impl Sending {
    /// Another one follows.
    pub fn begin_anew(&mut self) {
        self.batches = 0;
    }

    /// The part of a pass's photons that are sent.
    pub(in crate::trace) fn part(&self, world: &World, pass: &Pass) -> f64 {
        let Some(targets) = world.photon_targets.as_ref().filter(|_| self.batches > 0) else { return 0.0 };
        let batches = batches_of_pass(&pass.targets(world, targets, 1), 0, 0);
        let photons = |batches: &[Batch]| batches.iter().map(|batch| batch.count).sum::<u64>() as f64;
        photons(&batches[..self.batches.min(batches.len())]) / photons(&batches)
    }
}

/// Sends the photons of a world's light pass that have not been sent, until it shall stop, and adds what they show to
/// the tiles of a part of the image; answers whether all are sent. `progress` is told how many are done. The first pass
/// sends all photons; where there are replicates, every pass sends some.
///
/// Every part sends all photons, which may be seen anywhere: a sum of what the parts found would have other last bits.
pub fn show<const N: usize, P: Polarization<N>>(
    world: &World,
    pass: &Pass,
    sending: &mut Sending,
    shard: Shard,
    tiles: &mut [Tile],
    watch: &Watch,
) -> bool {
    let Some(targets) = &world.photon_targets else { return true };
    let weight = pass.weight_of_photons();
    let (window, numbers) = (world.scene.film.window(), world.layers.numbers);
    for tile in tiles.iter_mut().filter(|tile| tile.shown.pixels.is_empty()) {
        let pixels = tile.sums.len();
        tile.shown = Shown { pixels: vec![[0.0; 3]; pixels], layers: vec![0.0; pixels * numbers], moved: 0.0 };
    }
    let add = &mut |splat: Splat| {
        let splat = splat.times(weight).of_half(pass.is_of_first_half());
        let Splat { pixel, change, rgb, .. } = splat;
        let Some([tile, place]) = shard.place_of(window, pixel) else { return };
        let Tile { shown, replicates, .. } = &mut tiles[tile];
        if !world.layers.is_empty() {
            add_to_layers(world, &splat, &mut shown.layers[place * numbers..][..numbers]);
        }
        if splat.caught {
            let luminance = world.layers.luminance_of(&rgb);
            pass.replicate.iter().for_each(|&replicate| replicates.show_caught(place, replicate, luminance));
            return;
        }
        (0..3).for_each(|i| shown.pixels[place][i] += rgb[i]);
        if change != 0.0 {
            shown.moved += f64::from(change) * world.amount(rgb);
        }
        pass.replicate.iter().for_each(|&replicate| replicates.show(place, replicate, rgb));
    };
    send_on::<N, P>(world, &pass.targets(world, targets, 1), pass.photon_seed().0, sending, watch, add)
}

/// Adds a photon that the camera sees to the row of its pixel, which holds means.
fn add_to_layers(world: &World, splat: &Splat, row: &mut [f64]) {
    let Splat { light, rgb, dispersed, early, caught, first, weight, .. } = *splat;
    if caught {
        return world.layers.catch_photon(row, rgb);
    }
    // Smooth surfaces mirrored or refracted it, and the last one scattered it to the camera.
    let bounces = 2;
    let light = Some(light);
    world.layers.add(row, &Contribution { light, found: Found::Shown, rgb, moved: 0.0, first, bounces, dispersed });
    if let Some(stokes) = &splat.stokes {
        world.layers.add_stokes(row, **stokes, weight);
    }
    if let (Some(spectrum), Some(bands)) = (&world.layers.spectrum, &splat.bands) {
        let sums = row[spectrum.at..].iter_mut().zip(bands.iter());
        sums.for_each(|(sum, &light)| *sum += weight * f64::from(light));
    }
    world.layers.add_to(Layer::Variance, row, rgb.map(|x| x * x));
    world.layers.add_to(if early { Layer::HalfA } else { Layer::HalfB }, row, rgb.map(|x| 2.0 * x));
}

/// Sends all of them and hands over what they show, in an order that never changes; holds no image.
pub fn splats<const N: usize, P: Polarization<N>>(world: &World, take: &mut dyn FnMut(Splat)) -> Sending {
    let (mut sending, watch) = (Sending::default(), Watch { progress: &|_| (), is_due: &|| false });
    if let Some(targets) = &world.photon_targets {
        send_on::<N, P>(world, targets, world.method.seed, &mut sending, &watch, take);
    }
    sending
}

/// The same of those that have not been sent, until it shall stop; answers whether all are.
fn send_on<const N: usize, P: Polarization<N>>(
    world: &World,
    targets: &PhotonTargets,
    seed: u64,
    sending: &mut Sending,
    watch: &Watch,
    take: &mut dyn FnMut(Splat),
) -> bool {
    let batches = batches_of_pass(targets, 0, seed ^ SEED);
    for group in batches.get(sending.batches..).unwrap_or_default().chunks(AT_ONCE) {
        let send = |number: usize| (!(watch.is_due)()).then(|| send_shown::<N, P>(world, targets, group[number]));
        let done = in_parallel(group.len(), &send);
        for (batch, sent) in group.iter().zip(done) {
            // Splats are added in the order of the batches: what was found beyond a gap is found again.
            let Some(sent) = sent else { return false };
            (watch.progress)(batch.count);
            (sending.batches, sending.photons) = (sending.batches + 1, sending.photons + batch.count);
            sending.stats += sent.stats;
            for splat in sent.kept {
                if splat.rgb.iter().all(|x| x.is_finite()) {
                    take(splat);
                } else {
                    sending.stats.non_finite += 1;
                }
            }
        }
    }
    true
}

/// What photons sent ahead found.
#[derive(Default)]
struct Learned {
    /// Of each target, the places and whether the camera saw them.
    found: Vec<Vec<([f64; 2], bool)>>,
    /// Rays followed.
    rays: u64,
}

impl Learned {
    /// How many photons of each target follow so many rays, by what these took.
    fn each_within(&self, rays: f64) -> u64 {
        let sent = self.found.iter().map(Vec::len).sum::<usize>() as f64;
        (rays * sent / (self.rays as f64 * self.found.len() as f64)) as u64
    }
}

/// Sends photons ahead, of each target those of some numbers as far as it has so many. The format sees them, also where
/// a part of it or more is made, so that all parts are made alike.
fn send_ahead<const N: usize>(world: &World, numbers: Range<u64>) -> Learned {
    let world = world.of_the_format();
    let Some(targets) = &world.photon_targets else { return Learned::default() };
    let of_target = |target: &PhotonTarget| numbers.start..numbers.end.min(target.photons);
    let batches = batches(targets, of_target, world.method.seed ^ AHEAD_SEED);
    let send =
        |number: usize| send::<N, Polarized, _>(&world, targets, batches[number], true, &show_photon::<N, Polarized>);
    let done = in_parallel(batches.len(), &send);
    let mut learned = Learned { found: vec![Vec::new(); targets.targets.len()], rays: 0 };
    for (batch, sent) in batches.iter().zip(done) {
        learned.rays += sent.stats.rays;
        learned.found[batch.target].extend(sent.places);
    }
    learned
}

/// Photons of each target that tell how many rays one follows.
fn first_of_each(world: &World) -> u64 {
    world.photon_targets.as_ref().map_or(0, |targets| (FIRST / targets.targets.len() as u64).max(1))
}

/// Sends so many photons of each target ahead, or as many as follow [`MOST_RAYS`], but [`FIRST`] at least.
fn send_some_ahead<const N: usize>(world: &World, most: u64) -> Learned {
    let first = most.min(first_of_each(world));
    let mut learned = send_ahead::<N>(world, 0..first);
    let more = send_ahead::<N>(world, first..most.min(learned.each_within(MOST_RAYS)));
    learned.rays += more.rays;
    learned.found.iter_mut().zip(more.found).for_each(|(found, more)| found.extend(more));
    learned
}

/// Of the photons of each light, the share that the camera sees; of many lights, of a light and its neighbors.
pub fn seen_photons(world: &World) -> Vec<f64> {
    let mut shares = vec![0.0; world.scene.lights.len()];
    let Some(targets) = &world.photon_targets else { return shares };
    let most = (SEEN_OF_A_PLAN / targets.targets.len() as u64).clamp(1, TOO_FEW);
    let found = in_lanes!(&world.method.basis, N => send_some_ahead::<N>(world, most)).found;
    let mut counts = vec![[0_u32; 2]; shares.len()];
    for (target, photons) in targets.targets.iter().zip(found) {
        let [sent, seen] = &mut counts[target.light];
        *sent += photons.len() as u32;
        *seen += photons.iter().filter(|photon| photon.1).count() as u32;
    }
    for group in world.photon_light_groups() {
        let of_group = |i: usize| group.iter().map(|&light| counts[light][i]).sum::<u32>();
        let share = f64::from(of_group(1)) / f64::from(of_group(0).max(1));
        group.iter().for_each(|&light| shares[light] = share);
    }
    shares
}

/// A world with another light pass and photons sent ahead, for a plan: no more of them for an image of many pixels than
/// for one of few, and none where enough to learn from would follow too many rays.
pub fn piloted(world: &World, light_pass: LightPass) -> World {
    let world = world.with_light_pass(Some(light_pass));
    in_lanes!(&world.method.basis, N => taught::<N>(world))
}

fn taught<const N: usize>(mut world: World) -> World {
    let targets = world.photon_targets.as_ref().map_or(1, |targets| targets.targets.len() as u64);
    let most = OF_A_PLAN / targets;
    if most >= TOO_FEW {
        let first = send_ahead::<N>(&world, 0..first_of_each(&world));
        if first.each_within(MOST_RAYS) >= TOO_FEW {
            teach::<N>(&mut world, first.each_within(RAYS_OF_A_LOOK as f64).clamp(TOO_FEW, most));
        }
    }
    world
}

/// Sends photons ahead, at most so many of a target, and the others where those were seen.
pub fn learn_where_to_send(world: &mut World, most: u64) {
    in_lanes!(&world.method.basis, N => teach::<N>(world, most));
}

fn teach<const N: usize>(world: &mut World, most: u64) {
    let Some(least) = world
        .photon_targets
        .as_ref()
        .and_then(|targets| targets.targets.iter().map(|target| target.photons / AHEAD).min())
    else {
        return;
    };
    let ahead = least.min(ENOUGH).min(most);
    if ahead >= TOO_FEW {
        let found = send_ahead::<N>(world, 0..ahead).found;
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
    use crate::trace::{Method, Transport};

    /// A heap of glass balls under a spot, in which a photon follows dozens of rays.
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
        let scene = Scene::parse(&text, ".").expect("the heap is a scene");
        let transport = Transport::Random { split: 0.05, roulette: 0.05 };
        let method = Method::of_paths(Basis::rgb(ColorSpace::Rec709), transport, 0);
        let pass = LightPass { photons: 1 << 20, lights: vec![0], map: None };
        World::new(&scene, method).with_light_pass(Some(pass))
    }

    #[test]
    fn a_plan_sends_no_more_photons_ahead_than_it_has_time_for() {
        let world = heap();
        let first = send_ahead::<4>(&world, 0..first_of_each(&world));
        let all = first.rays as f64 * TOO_FEW as f64 / first_of_each(&world) as f64;
        assert!(all > 2.0 * MOST_RAYS, "{all} rays are affordable");
        let some = send_some_ahead::<4>(&world, TOO_FEW);
        assert!((some.rays as f64 / MOST_RAYS - 1.0).abs() < 0.1, "{} rays", some.rays);
        for (first, some) in first.found.iter().zip(&some.found) {
            assert!(some.len() > first.len() && some.starts_with(first), "{} and {}", first.len(), some.len());
        }
        // Nothing is learned from them.
        let photons = |world: &World| -> Vec<u64> {
            world.photon_targets.iter().flat_map(|targets| &targets.targets).map(|target| target.photons).collect()
        };
        assert_eq!(photons(&taught::<4>(world.clone())), photons(&world));
    }

    /// Each pane of a stack mirrors a twelfth of the light: of 30, a photon that was followed both ways at every one
    /// came to no end.
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
        let scene = Scene::parse(&text, ".").expect("it is a scene");
        let transport = Transport::Random { split: 0.05, roulette: 0.05 };
        let method = Method::of_paths(Basis::rgb(ColorSpace::Rec709), transport, 0);
        let pass = LightPass { photons: 1 << 16, lights: vec![0], map: None };
        let world = World::new(&scene, method).with_light_pass(Some(pass));
        let learned = send_ahead::<4>(&world, 0..64);
        let sent: usize = learned.found.iter().map(Vec::len).sum();
        let each = learned.rays as f64 / sent as f64;
        assert!((30.0..300.0).contains(&each), "{each} rays");
    }
}
