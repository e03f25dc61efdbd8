//! Paths from the lights, and photons like them, at whose vertices paths from the camera look for light.
//!
//! Where photons are gathered, others that are sent in the same way leave vertices too. Light over smooth surfaces is
//! looked for at these vertices as at the others, and is gathered only where a bounce continues.

use std::collections::BTreeMap;
use std::f64::consts::FRAC_1_PI;
use std::ops::Range;
use std::sync::OnceLock;

use super::batch::{PHOTON_TRANSPORT, batches_of_pass, trace_batch};
use super::follow::{Photon, PhotonHit, Surfaces, follow_photon};
use super::light_vertices::{LightVertex, LightVertices, holds_vertices};
use super::vertex_visibility::{DiffusePlace, is_seen, places, usefulness};
use crate::film::Layer;
use crate::light::{LeSample, Light, LightId};
use crate::material::Material;
use crate::math::{BranchKey, DVec3, Distribution, Sampler, derive_seed, median};
use crate::shape::SurfacePoint;
use crate::spectrum::Draw;
use crate::trace::parallel::in_parallel;
use crate::trace::path_start::{PathStart, SkyOpenings};
use crate::trace::stats::Stats;
use crate::trace::walk::{PathKind, Polarization, Polarized, Walker};
use crate::trace::width::in_lanes;
use crate::trace::{Transport, World};

/// Samples of each pixel that share light paths.
pub const SAMPLES_PER_SET: u32 = 16;
/// Camera samples per light path, and fewest and most light paths: noise that pixels share does not average out.
const SAMPLES_PER_PATH: u64 = 32;
const MIN_PATHS: u64 = 256;
const MAX_PATHS: u64 = 16_384;
/// Fewest photons per light path.
const MIN_PHOTONS_PER_PATH: f64 = 1.0 / 16.0;
/// Light paths of a batch, which are traced one after another. Their vertices are kept in the order of the batches.
const BATCH_SIZE: u64 = 256;
/// D as a share of the median distance of vertices from their center: a twelfth of the side of a room. From two thirds
/// of that to one and a half times as much, the error for the time is the same.
const NEAR_SHARE: f64 = 0.1;
/// The set of a pilot, and the number of its light paths.
const PILOT_SET: u32 = u32::MAX;
const PILOT_PATHS: u64 = 1024;
/// The set of light paths that determines D, and their number.
const SCALE_SET: u32 = u32::MAX - 1;
const SCALE_PATHS: u64 = 256;
/// Sets these random numbers apart from the others, and those of photons from both.
const SEED: u64 = 0x6c76_7274;
const PHOTON_SEED: u64 = 0x6169_6d65;
/// Uses of a light path's random numbers: where it starts, and from which light.
const START: u32 = 0;
const LIGHT: u32 = 1;

/// If light paths of skies through openings miss only a share of the light, camera paths that look for the rest
/// continue with the probability sqrt(`SPIKES` * share), but at least `MIN_REST`. What is found so rarely is about ten
/// times as noisy as what light vertices contribute, and the noise for the time is least for the root of the ratio.
const SPIKES: f64 = 10.0;
const MIN_REST: f64 = 1.0 / 8.0;

/// Fewest paths of a pilot that must reach what is seen: at this rate, `MIN_PATHS` paths of a largest set do.
const MIN_REACHING_PATHS: usize = (PILOT_PATHS * MIN_PATHS / MAX_PATHS) as usize;

/// Relative brightness below which a lamp with a layer of its own is too faint, compared with the brightest one. A lamp
/// that is ten times fainter had nine times the noise in means over 32 x 32 pixels.
const MIN_RELATIVE_BRIGHTNESS: f64 = 0.25;

/// Whether light paths, for the lights they start from, find the same indirect light as paths from the camera.
///
/// They do not if each camera sample draws wavelengths, or if light passes through surfaces at which light paths end.
pub fn can_trace_light_paths(world: &World) -> bool {
    let objects = 0..world.scene.objects.len() as u32;
    !world.method.basis.draws_wavelengths()
        && matches!(world.method.transport, Transport::Random { .. })
        && objects.into_iter().all(|object| !(world.ends_light_paths(object) && world.is_see_through(object)))
}

/// Whether enough of the light paths of a world's method reach what the camera sees. From a lamp that is far away or
/// behind a small hole, hardly any do: their light would be too bright or too dark all over an image, and a pilot
/// without any would show no noise.
pub fn light_paths_reach(world: &World) -> bool {
    let paths = LightPaths::new(world, world.method.seed);
    paths.is_some_and(|paths| in_lanes!(&world.method.basis, N => paths.reach_view::<N>()))
}

/// Returns a few vertices of the method's light paths, for a pilot; `None` where no light can be traced forward.
pub fn pilot_vertices<const N: usize>(world: &World) -> Option<LightVertices<N>> {
    Some(LightPaths::new(world, world.method.seed)?.build_set::<N, Polarized>(PILOT_SET, PILOT_PATHS))
}

/// The lights from which paths start, and the places from which their vertices are looked at: what all sets share.
pub struct LightPaths<'a> {
    world: &'a World,
    seed: u64,
    by_flux: Distribution,
    /// Probability that camera paths continue for light that light paths do not find; `None` where they find all.
    rest_chance: Option<f64>,
    places: Vec<DiffusePlace>,
    /// The center of the vertices, and D.
    scale: OnceLock<(DVec3, f64)>,
}

impl<'a> LightPaths<'a> {
    /// Returns the light paths that the method uses, or `None` where no light can be traced forward.
    pub fn new(world: &'a World, seed: u64) -> Option<Self> {
        if world.path_starts.is_empty() || !can_trace_light_paths(world) {
            return None;
        }
        let starts = || world.path_starts.iter().zip(&world.scene.lights);
        let flux = |(id, (start, light)): (LightId, (&PathStart, &Light<_>))| start.flux(light) * world.luminance(id);
        let by_flux = Distribution::new(starts().enumerate().map(flux));
        let ends_nowhere = (0..world.scene.objects.len() as u32).all(|object| !world.ends_light_paths(object));
        let find_all = starts().all(|(start, _)| matches!(start, PathStart::Anywhere));
        // Suns in mirrors are rare and bright: they must not be found by a few paths with large weights.
        let may_dazzle = |(id, light): (LightId, &Light<_>)| {
            light.is_infinite() && light.sends_photons() && !(world.has_map() && world.sends_photons(id))
        };
        let has_mirrors = world.lobes.iter().any(|lobes| lobes.has_delta());
        let dazzles = has_mirrors && world.scene.lights.iter().enumerate().any(may_dazzle);
        let find_most = !dazzles && starts().all(|(start, light)| start.finds_most(light));
        let SkyOpenings { openings, missed } = &world.method.openings;
        let rest_chance = match ends_nowhere {
            true if find_all => None,
            true if find_most && !openings.is_empty() => Some((SPIKES * missed).sqrt().clamp(MIN_REST, 1.0)),
            _ => Some(1.0),
        };
        let places = places(world);
        (by_flux.total() > 0.0).then_some(Self { world, seed, by_flux, rest_chance, places, scale: OnceLock::new() })
    }

    /// Whether a layer of lights is requested whose paths are so few that all of it would be too bright or too dark.
    pub fn have_starved_layer(&self) -> bool {
        if self.world.layers.offset(Layer::Lights).is_none() {
            return false;
        }
        let mut group_shares: BTreeMap<&str, f64> = BTreeMap::new();
        for (light, group) in self.world.scene.light_groups.iter().enumerate() {
            *group_shares.entry(group).or_default() += self.by_flux.probability(light);
        }
        let positive_shares = || group_shares.values().copied().filter(|share| *share > 0.0);
        positive_shares().fold(1.0, f64::min) < MIN_RELATIVE_BRIGHTNESS * positive_shares().fold(0.0, f64::max)
    }

    /// Whether enough paths of a pilot leave a vertex that is visible from what the camera sees.
    fn reach_view<const N: usize>(&self) -> bool {
        let mut reaching = 0;
        (0..PILOT_PATHS).step_by(BATCH_SIZE as usize).any(|first| {
            let reaches = |place: usize| {
                let path = first + place as u64;
                let (vertices, _) = self.follow::<N, Polarized>(PILOT_SET, path..path + 1);
                let mut keyed = (0..).zip(&vertices);
                keyed.any(|(key, vertex)| is_seen(self.world, &self.places, vertex.position, [path as u32, key]))
            };
            reaching += in_parallel(BATCH_SIZE as usize, &reaches).into_iter().filter(|&reaches| reaches).count();
            reaching >= MIN_REACHING_PATHS
        })
    }

    /// Draws the light of a path and how the path leaves it, if it does.
    fn start(&self, sampler: &Sampler) -> Option<(LightId, LeSample)> {
        let drawn = self.by_flux.sample(sampler.get_random_4d(BranchKey::CAMERA, LIGHT)[0]);
        let (light, u) = (drawn.index, sampler.get_4d(BranchKey::CAMERA, START));
        let emitted = self.world.path_starts[light].emit(&self.world.scene, &self.world.scene.lights[light], u)?;
        Some((light, LeSample { factor: emitted.factor / drawn.probability, ..emitted }))
    }

    /// Returns the vertices for some samples of each pixel, at most `SAMPLES_PER_SET`.
    pub fn vertices_for<const N: usize, P: Polarization<N>>(&self, samples: Range<u32>) -> LightVertices<N> {
        let all = self.world.scene.film.whole().pixels() * samples.len() as u64;
        self.build_set::<N, P>(samples.start, (all / SAMPLES_PER_PATH).clamp(MIN_PATHS, MAX_PATHS))
    }

    /// Returns the vertices of `paths` light paths of a set and, where photons are gathered, of photons that are sent
    /// in the same way. Their numbers are in proportion to their flux, so that vertices of both contribute about as
    /// much.
    fn build_set<const N: usize, P: Polarization<N>>(&self, set: u32, paths: u64) -> LightVertices<N> {
        let (mut vertices, mut stats) = self.vertices::<N, P>(set, paths);
        if let Some(targets) = &self.world.map_targets {
            let photons_per_path = (targets.flux() / self.by_flux.total()).clamp(MIN_PHOTONS_PER_PATH, 1.0);
            let targets = targets.scaled(photons_per_path * paths as f64 / targets.photons() as f64);
            // Sets differ in size: each has photons of its own.
            let seed = derive_seed(self.seed ^ PHOTON_SEED, set.into());
            let batches = batches_of_pass(&targets, 0, seed);
            let batch_vertices = |number: usize| {
                trace_batch(
                    self.world,
                    &targets,
                    batches[number],
                    false,
                    &|_, photon_hit: &PhotonHit<N, P>, vertices| {
                        vertices.extend(light_vertex(self.world, photon_hit, true));
                    },
                )
            };
            for sent in in_parallel(batches.len(), &batch_vertices) {
                stats += sent.stats;
                vertices.extend(sent.records);
            }
        }
        let (center, near) = *self.scale.get_or_init(|| self.scale::<N, P>());
        LightVertices::new(vertices, center, near, self.rest_chance, stats, |vertices| self.powers(vertices))
    }

    /// Returns the center of vertices, and D, from separate light paths: with the same ones, weights would be biased.
    fn scale<const N: usize, P: Polarization<N>>(&self) -> (DVec3, f64) {
        let (vertices, _) = self.vertices::<N, P>(SCALE_SET, SCALE_PATHS);
        // Medians, since some vertices may lie far outside of all that is seen.
        let middle = |axis: usize| median(vertices.iter().map(|vertex| vertex.position[axis]).collect());
        let center = DVec3::from([0, 1, 2].map(|axis| middle(axis).unwrap_or_default()));
        let distances = vertices.iter().map(|vertex| (vertex.position - center).length()).collect();
        (center, median(distances).map_or(1.0, |distance| (NEAR_SHARE * distance).max(f64::MIN_POSITIVE)))
    }

    /// Traces some light paths of a set, and returns their vertices.
    fn vertices<const N: usize, P: Polarization<N>>(&self, set: u32, paths: u64) -> (Vec<LightVertex<N>>, Stats) {
        let first = |batch: usize| batch as u64 * BATCH_SIZE;
        let batch_vertices = |batch| self.follow::<N, P>(set, first(batch)..first(batch + 1).min(paths));
        let done = in_parallel(paths.div_ceil(BATCH_SIZE) as usize, &batch_vertices);
        let (mut stats, mut vertices) = (Stats::default(), Vec::new());
        for (batch_vertices, batch_stats) in done {
            vertices.extend(batch_vertices);
            stats += batch_stats;
        }
        let each = 1.0 / paths as f32;
        vertices.iter_mut().for_each(|vertex| vertex.leaving = vertex.leaving * each);
        (vertices, stats)
    }

    /// Traces those light paths of a set that have the given numbers.
    fn follow<const N: usize, P: Polarization<N>>(&self, set: u32, paths: Range<u64>) -> (Vec<LightVertex<N>>, Stats) {
        let world = self.world;
        let mut walker = Walker::<N, P>::new(world, PHOTON_TRANSPORT);
        let draw = world.method.basis.draw(0.0);
        let mut vertices = Vec::new();
        for number in paths {
            let sampler = Sampler::new(self.seed ^ SEED, [set, 0], number as u32);
            let Some((light, emitted)) = self.start(&sampler) else { continue };
            let photon = Photon {
                emitted: &emitted,
                light,
                draw: &draw,
                sampler: &sampler,
                scope: Surfaces::All,
                first_half: true,
            };
            follow_photon(&mut walker, &photon, &mut |_, photon_hit| {
                vertices.extend(light_vertex(world, photon_hit, false))
            });
        }
        (vertices, walker.stats)
    }

    /// Returns what leaves each vertex, as the sensor sees it, times how often it is seen; 1 for the brightest.
    fn powers<const N: usize>(&self, vertices: &[LightVertex<N>]) -> Vec<f32> {
        let world = self.world;
        let draw = Draw::<N>::fixed(world.method.basis.fixed_lanes());
        let seen = |vertex: &LightVertex<N>| world.responses[vertex.light].film_rgb(&draw, vertex.leaving, false);
        let powers: Vec<f64> = vertices.iter().map(|vertex| world.amount(seen(vertex))).collect();
        let most = powers.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
        let positions: Vec<DVec3> = vertices.iter().map(|vertex| vertex.position).collect();
        let shares = usefulness(world, &self.places, &positions, &powers);
        powers.iter().zip(shares).map(|(power, share)| (power / most) as f32 * share).collect()
    }
}

/// Returns the vertex where a light path, or a photon aimed at smooth surfaces, lands, if it is one. Light that comes
/// over smooth surfaces from lights that send photons is left to photons.
fn light_vertex<const N: usize, P>(
    world: &World,
    photon_hit: &PhotonHit<N, P>,
    is_of_photon: bool,
) -> Option<LightVertex<N>> {
    let PhotonHit { path, interaction, photon } = photon_hit;
    let Material::Diffuse(diffuse) = interaction.material else { return None };
    let leaving = photon_hit.flux(world) * interaction.context.read(&diffuse.reflectance) * FRAC_1_PI as f32;
    let came_over_smooth = path.vertices > 1 && path.kind == PathKind::Other;
    let is_left_to_photons = !is_of_photon && world.has_map() && came_over_smooth && photon.is_for_light_pass(world);
    let usable = holds_vertices(world, interaction.object, interaction.point)
        && !is_left_to_photons
        && !leaving.is_zero()
        && leaving.0.iter().all(|x| x.is_finite());
    // A path from the camera leaves one more diffuse surface to reach the light over smooth ones.
    let diffuse = world.method.diffuse_bounces - path.diffuse_left + 1 + u32::from(is_of_photon);
    let SurfacePoint { position, error, normal, .. } = *interaction.point;
    let (error, flat, light) = (normal.abs().dot(error), interaction.flat, photon.light);
    let (surfaces, parted) = (path.surfaces(), path.parted);
    usable.then_some(LightVertex { position, error, flat, leaving, light, surfaces, diffuse, is_of_photon, parted })
}
