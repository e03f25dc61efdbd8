//! Paths from the lights, and photons like them, whose vertices paths from the camera look at.
//!
//! Where photons are gathered, others that are sent as they are leave vertices too: light that comes over smooth
//! surfaces is looked for at those as at others, and gathered only where a bounce goes on.

use std::collections::BTreeMap;
use std::f64::consts::FRAC_1_PI;
use std::ops::Range;
use std::sync::OnceLock;

use super::batch::{PHOTONS, batches_of_pass, send};
use super::follow::{Photon, PhotonHit, Surfaces, follow_photon};
use super::light_vertices::{LightVertex, LightVertices, holds_vertices};
use super::usefulness::{DiffusePlace, is_seen, places, usefulness};
use crate::film::Layer;
use crate::light::{LeSample, Light, LightId};
use crate::material::Material;
use crate::math::{BranchKey, DVec3, Distribution, Sampler, median, seed_of};
use crate::shape::SurfacePoint;
use crate::spectrum::Draw;
use crate::trace::parallel::in_parallel;
use crate::trace::path_start::{PathStart, SkyOpenings};
use crate::trace::stats::Stats;
use crate::trace::walk::{PathKind, Polarization, Polarized, Walker};
use crate::trace::width::in_lanes;
use crate::trace::{Transport, World};

/// Samples of each pixel that share light paths.
pub const SHARED: u32 = 16;
/// Camera samples for each light path, fewest and most light paths: noise that pixels share does not average out.
const PER_PATH: u64 = 32;
const FEWEST: u64 = 256;
const MOST: u64 = 16_384;
/// Least photons for each light path.
const LEAST_PHOTONS: f64 = 1.0 / 16.0;
/// Light paths that are followed one after another; their vertices are kept in the order of the batches.
const BATCH: u64 = 256;
/// D as a share of the median distance of vertices from their middle: a twelfth of the side of a room. From two thirds
/// of that to one and a half, the error for the time is the same.
const NEAR: f64 = 0.1;
/// The set of a pilot, and its light paths.
const PILOT: u32 = u32::MAX;
const OF_A_PILOT: u64 = 1024;
/// The set of those that tell D, and its light paths.
const SCALE: u32 = u32::MAX - 1;
const OF_SCALE: u64 = 256;
/// Sets these random numbers apart from the others, and those of photons from both.
const SEED: u64 = 0x6c76_7274;
const PHOTON_SEED: u64 = 0x6169_6d65;
/// Uses of a light path's random numbers: where it starts, and of which light.
const START: u32 = 0;
const LIGHT: u32 = 1;

/// Where light paths of skies through openings find all but a share of the light, paths from the camera that look for
/// the rest go on with the root of so many times that share, and as often as this at least. What is found so rarely
/// is about ten times as noisy as what light vertices bring, and noise for the time is least for the root of the ratio.
const SPIKES: f64 = 10.0;
const LEAST_ON: f64 = 1.0 / 8.0;

/// Fewest paths of a pilot that reach what is seen: of a largest set, as many as a smallest one has.
const REACHING: usize = (OF_A_PILOT * FEWEST / MOST) as usize;

/// How much fainter than the brightest one a lamp may be that has a layer of its own. One that is ten times fainter had
/// nine times the noise in means over 32 x 32 pixels.
const FAINT: f64 = 0.25;

/// Whether light paths find what surfaces send each other of a light that they start from, as paths from the camera do.
///
/// Not where each camera sample draws wavelengths, nor where light passes through surfaces at which light paths end.
pub fn can_be_followed(world: &World) -> bool {
    let objects = 0..world.scene.objects.len() as u32;
    !world.method.basis.draws_wavelengths()
        && matches!(world.method.transport, Transport::Random { .. })
        && objects.into_iter().all(|object| !(world.ends_light_paths(object) && world.is_see_through(object)))
}

/// Whether enough of the light paths that a world's method asks for reach what the camera sees. From a lamp that is far
/// away or behind a small hole hardly any do: what they bring would be bright or dark all over an image, and a pilot
/// without any would show no noise.
pub fn light_paths_reach(world: &World) -> bool {
    let paths = LightPaths::new(world, world.method.seed);
    paths.is_some_and(|paths| in_lanes!(&world.method.basis, N => paths.reach::<N>()))
}

/// A few vertices of the light paths that a world's method asks for, for a pilot; none where no light can be followed.
pub fn few_vertices<const N: usize>(world: &World) -> Option<LightVertices<N>> {
    Some(LightPaths::new(world, world.method.seed)?.of_set::<N, Polarized>(PILOT, OF_A_PILOT))
}

/// The lights of a world that paths start from, and from where their vertices are looked at: what all sets share.
pub struct LightPaths<'a> {
    world: &'a World,
    seed: u64,
    by_flux: Distribution,
    /// How likely paths from the camera go on for light that is not theirs; none where all is.
    rest: Option<f64>,
    places: Vec<DiffusePlace>,
    /// The middle of vertices, and D.
    scale: OnceLock<(DVec3, f64)>,
}

impl<'a> LightPaths<'a> {
    /// Those that the method asks for; none where no light can be followed.
    pub fn new(world: &'a World, seed: u64) -> Option<Self> {
        if world.path_starts.is_empty() || !can_be_followed(world) {
            return None;
        }
        let starts = || world.path_starts.iter().zip(&world.scene.lights);
        let flux = |(id, (start, light)): (LightId, (&PathStart, &Light<_>))| start.flux(light) * world.luminance(id);
        let by_flux = Distribution::new(starts().enumerate().map(flux));
        let ends_nowhere = (0..world.scene.objects.len() as u32).all(|object| !world.ends_light_paths(object));
        let find_all = starts().all(|(start, _)| matches!(start, PathStart::Anywhere));
        // Suns that mirrors show, rare and bright, must not be found by a few paths that count more.
        let may_dazzle = |(id, light): (LightId, &Light<_>)| {
            light.is_infinite() && light.sends_photons() && !(world.has_map() && world.sends_photons(id))
        };
        let has_mirrors = world.lobes.iter().any(|lobes| lobes.has_delta());
        let dazzles = has_mirrors && world.scene.lights.iter().enumerate().any(may_dazzle);
        let find_most = !dazzles && starts().all(|(start, light)| start.finds_most(light));
        let SkyOpenings { openings, missed } = &world.method.openings;
        let rest = match ends_nowhere {
            true if find_all => None,
            true if find_most && !openings.is_empty() => Some((SPIKES * missed).sqrt().clamp(LEAST_ON, 1.0)),
            _ => Some(1.0),
        };
        let places = places(world);
        (by_flux.total() > 0.0).then_some(Self { world, seed, by_flux, rest, places, scale: OnceLock::new() })
    }

    /// Whether a layer of lights is asked for whose paths are so few that all of it would be too bright or too dark.
    pub fn starve_a_layer(&self) -> bool {
        if self.world.layers.at(Layer::Lights).is_none() {
            return false;
        }
        let mut of_groups: BTreeMap<&str, f64> = BTreeMap::new();
        for (light, group) in self.world.scene.light_groups.iter().enumerate() {
            *of_groups.entry(group).or_default() += self.by_flux.probability(light);
        }
        let started = || of_groups.values().copied().filter(|share| *share > 0.0);
        started().fold(1.0, f64::min) < FAINT * started().fold(0.0, f64::max)
    }

    /// Whether enough paths of a pilot leave a vertex that is seen from what the camera sees.
    fn reach<const N: usize>(&self) -> bool {
        let mut reaching = 0;
        (0..OF_A_PILOT).step_by(BATCH as usize).any(|first| {
            let reaches = |place: usize| {
                let path = first + place as u64;
                let (vertices, _) = self.follow::<N, Polarized>(PILOT, path..path + 1);
                let mut keyed = (0..).zip(&vertices);
                keyed.any(|(key, vertex)| is_seen(self.world, &self.places, vertex.position, [path as u32, key]))
            };
            reaching += in_parallel(BATCH as usize, &reaches).into_iter().filter(|&reaches| reaches).count();
            reaching >= REACHING
        })
    }

    /// The light of a path and how the path leaves it, if it does.
    fn start(&self, sampler: &Sampler) -> Option<(LightId, LeSample)> {
        let drawn = self.by_flux.sample(sampler.four_plain(BranchKey::CAMERA, LIGHT)[0]);
        let (light, u) = (drawn.index, sampler.four(BranchKey::CAMERA, START));
        let emitted = self.world.path_starts[light].emit(&self.world.scene, &self.world.scene.lights[light], u)?;
        Some((light, LeSample { factor: emitted.factor / drawn.probability, ..emitted }))
    }

    /// The vertices for some samples of each pixel, at most `SHARED`.
    pub fn shared<const N: usize, P: Polarization<N>>(&self, samples: Range<u32>) -> LightVertices<N> {
        let all = self.world.scene.film.whole().pixels() * samples.len() as u64;
        self.of_set::<N, P>(samples.start, (all / PER_PATH).clamp(FEWEST, MOST))
    }

    /// Those of so many light paths of a set, and where photons are gathered, of photons that are sent as those are: as
    /// many as there are for the flux of the paths, so that vertices of both bring about as much.
    fn of_set<const N: usize, P: Polarization<N>>(&self, set: u32, paths: u64) -> LightVertices<N> {
        let (mut vertices, mut stats) = self.vertices::<N, P>(set, paths);
        if let Some(targets) = &self.world.map_targets {
            let of_a_path = (targets.flux() / self.by_flux.total()).clamp(LEAST_PHOTONS, 1.0);
            let targets = targets.times(of_a_path * paths as f64 / targets.photons() as f64);
            // Sets differ in size: each has photons of its own.
            let seed = seed_of(self.seed ^ PHOTON_SEED, set.into());
            let batches = batches_of_pass(&targets, 0, seed);
            let of_batch = |number: usize| {
                send(self.world, &targets, batches[number], false, &|_, photon_hit: &PhotonHit<N, P>, vertices| {
                    vertices.extend(kept(self.world, photon_hit, true));
                })
            };
            for sent in in_parallel(batches.len(), &of_batch) {
                stats += sent.stats;
                vertices.extend(sent.kept);
            }
        }
        let (center, near) = *self.scale.get_or_init(|| self.scale::<N, P>());
        LightVertices::dealt(vertices, center, near, self.rest, stats, |vertices| self.powers(vertices))
    }

    /// The middle of vertices, and D, by light paths of their own: by the same ones, weights would be biased.
    fn scale<const N: usize, P: Polarization<N>>(&self) -> (DVec3, f64) {
        let (vertices, _) = self.vertices::<N, P>(SCALE, OF_SCALE);
        // Medians: some vertices may lie far outside of all that is seen.
        let middle = |axis: usize| median(vertices.iter().map(|vertex| vertex.position[axis]).collect());
        let center = DVec3::from([0, 1, 2].map(|axis| middle(axis).unwrap_or_default()));
        let distances = vertices.iter().map(|vertex| (vertex.position - center).length()).collect();
        (center, median(distances).map_or(1.0, |distance| (NEAR * distance).max(f64::MIN_POSITIVE)))
    }

    /// The vertices of some light paths of a set.
    fn vertices<const N: usize, P: Polarization<N>>(&self, set: u32, paths: u64) -> (Vec<LightVertex<N>>, Stats) {
        let first = |batch: usize| batch as u64 * BATCH;
        let of_batch = |batch| self.follow::<N, P>(set, first(batch)..first(batch + 1).min(paths));
        let done = in_parallel(paths.div_ceil(BATCH) as usize, &of_batch);
        let (mut stats, mut vertices) = (Stats::default(), Vec::new());
        for (of_batch, noticed) in done {
            vertices.extend(of_batch);
            stats += noticed;
        }
        let each = 1.0 / paths as f32;
        vertices.iter_mut().for_each(|vertex| vertex.leaving = vertex.leaving * each);
        (vertices, stats)
    }

    /// Follows some light paths of a set.
    fn follow<const N: usize, P: Polarization<N>>(&self, set: u32, paths: Range<u64>) -> (Vec<LightVertex<N>>, Stats) {
        let world = self.world;
        let mut walker = Walker::<N, P>::new(world, PHOTONS);
        let draw = world.method.basis.draw(0.0);
        let mut vertices = Vec::new();
        for number in paths {
            let sampler = Sampler::new(self.seed ^ SEED, [set, 0], number as u32);
            let Some((light, emitted)) = self.start(&sampler) else { continue };
            let photon =
                Photon { emitted: &emitted, light, draw: &draw, sampler: &sampler, over: Surfaces::All, early: true };
            follow_photon(&mut walker, &photon, &mut |_, photon_hit| vertices.extend(kept(world, photon_hit, false)));
        }
        (vertices, walker.stats)
    }

    /// What leaves each vertex, as the sensor sees it, times how often it is seen; 1 of the brightest.
    fn powers<const N: usize>(&self, vertices: &[LightVertex<N>]) -> Vec<f32> {
        let world = self.world;
        let draw = Draw::<N>::fixed(world.method.basis.fixed_lanes());
        let seen = |vertex: &LightVertex<N>| world.responses[vertex.light].sensor(&draw, vertex.leaving, false);
        let powers: Vec<f64> = vertices.iter().map(|vertex| world.amount(seen(vertex))).collect();
        let most = powers.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let positions: Vec<DVec3> = vertices.iter().map(|vertex| vertex.position).collect();
        let shares = usefulness(world, &self.places, &positions, &powers);
        powers.iter().zip(shares).map(|(power, share)| (power / most) as f32 * share).collect()
    }
}

/// The vertex where a light path or a photon that is aimed at smooth surfaces lands, if it is one: what comes over
/// those from lights that send photons is left to photons.
fn kept<const N: usize, P>(world: &World, photon_hit: &PhotonHit<N, P>, is_of_photon: bool) -> Option<LightVertex<N>> {
    let PhotonHit { path, at, photon } = photon_hit;
    let Material::Diffuse(diffuse) = at.material else { return None };
    let leaving = photon_hit.flux(world) * at.context.read(&diffuse.reflectance) * FRAC_1_PI as f32;
    let came_over_smooth = path.vertices > 1 && path.kind == PathKind::Other;
    let is_left = !is_of_photon && world.has_map() && came_over_smooth && photon.is_left_to_pass(world);
    let usable = holds_vertices(world, at.object, at.point)
        && !is_left
        && !leaving.is_zero()
        && leaving.0.iter().all(|x| x.is_finite());
    // From the camera, a path leaves one diffuse surface more to come over smooth ones to the light.
    let diffuse = world.method.diffuse_bounces - path.diffuse_left + 1 + u32::from(is_of_photon);
    let SurfacePoint { position, error, normal, .. } = *at.point;
    let (error, flat, light) = (normal.abs().dot(error), at.flat, photon.light);
    let (surfaces, parted) = (path.surfaces(), path.parted);
    usable.then_some(LightVertex { position, error, flat, leaving, light, surfaces, diffuse, is_of_photon, parted })
}
