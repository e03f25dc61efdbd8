//! Vertices of paths from the lights, at which paths from the camera look for the light that surfaces send each other.
//!
//! At a diffuse surface x, a path from the camera chooses one vertex y of some, by what each would bring, and looks
//! whether it sees it: resampled importance sampling (Talbot, Cline & Egbert 2005, *Importance Resampling for
//! Global Illumination*). Near vertices would bring too much by far: of what leaves y for x, only the part d^2 / (d^2 +
//! D^2) is looked for at distance d, and the bounce that happens to go from x to y goes on from there with the
//! probability of the rest, D^2 / (d^2 + D^2). Both together are exact for any D (Kollig & Keller 2004, *Illumination
//! in the Presence of Weak Singularities*, bound the same way).
//!
//! Where photons are gathered, others that are sent as they are leave vertices too: light that comes over smooth
//! surfaces is looked for at those as at others, and gathered only where a bounce goes on.

use std::collections::BTreeMap;
use std::f64::consts::FRAC_1_PI;
use std::ops::Range;
use std::sync::{Arc, OnceLock};

use super::batch::{PHOTONS, batches_of_pass, send};
use super::follow::{Landing, Start, Surfaces, follow_photon};
use super::usefulness::{Place, places, usefulness};
use crate::film::Layer;
use crate::light::{Light, LightId};
use crate::material::Material;
use crate::math::{BranchKey, DVec3, Distribution, Ray, Sampler, seed_of};
use crate::shape::{Computation, Instructions, SurfacePoint, Vectors};
use crate::spectrum::{Draw, Lanes};
use crate::trace::parallel::in_parallel;
use crate::trace::path_start::PathStart;
use crate::trace::stats::Stats;
use crate::trace::walk::{PathKind, Polarization, Polarized, Walker};
use crate::trace::{Transport, World};

/// A vertex of a light path, on a diffuse surface.
#[derive(Clone, Debug)]
pub struct LightVertex<const N: usize> {
    pub position: DVec3,
    /// Bound of its distance from the true surface.
    pub error: f64,
    /// The surface's unit normal on the side that is lit.
    pub flat: DVec3,
    /// What leaves it in any direction of that side, lane by lane: intensity over the cosine.
    pub leaving: Lanes<N>,
    pub light: LightId,
    /// Surfaces that the light has met, and the diffuse ones of them, this one included.
    pub surfaces: u32,
    pub diffuse: u32,
    /// Whether a photon has left it.
    pub is_of_photon: bool,
    /// Whether lanes have parted on the way there.
    pub parted: bool,
}

/// The vertices of some light paths, dealt into sets of candidates. Each set has vertices from all over the scene.
pub struct LightVertices<const N: usize> {
    candidates: Vec<Candidates>,
    /// In the order of a curve through the scene. Of n sets of candidates each has every n-th vertex, row after row.
    vertices: Vec<LightVertex<N>>,
    /// The point from which places of candidates are counted, in units of D.
    center: DVec3,
    /// D.
    near: f64,
    /// How paths of each light start, where they do not find all light.
    starts: Option<Arc<[PathStart]>>,
    /// The instructions by which candidates are weighed.
    instructions: Instructions,
    pub stats: Stats,
}

/// Rows of candidates, and vertices of a row. There are 64 in all: of 32, an image is noisier by a sixth.
const ROWS: usize = 8;
const ROW: usize = 8;
const CANDIDATES: usize = ROWS * ROW;

/// What a choice among some vertices asks of them; absent ones have no power.
#[derive(Clone, Debug)]
struct Candidates {
    place: [OfCandidates; 3],
    flat: [OfCandidates; 3],
    /// X + Y + Z of what leaves, as the sensor sees it, times how often it is seen; 1 of the brightest vertex.
    power: OfCandidates,
}

/// A number for each candidate: for each place in a row, the numbers of all rows side by side, so that all rows
/// are summed at once.
type OfCandidates = [[f32; ROWS]; ROW];

/// Samples of each pixel that share light paths.
pub const SHARED: u32 = 16;
/// Camera samples for each light path, and the fewest and most light paths: what samples share does not average out
/// over pixels.
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
/// Cells of Morton's curve to a D.
const CELLS: f64 = 25.0;
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

/// Whether light paths find what surfaces send each other of a light that they start from, as paths from the camera do.
///
/// Not where wavelengths are drawn anew for each camera sample, nor where light goes straight through surfaces at which
/// light paths end.
pub fn can_be_followed(world: &World) -> bool {
    let objects = 0..world.scene.objects.len() as u32;
    !world.method.basis.draws_wavelengths()
        && matches!(world.method.transport, Transport::Random { .. })
        && objects.into_iter().all(|object| !(world.ends_light_paths(object) && world.is_see_through(object)))
}

/// Whether light that leaves a surface for another is looked for at light vertices on it: a diffuse one, by its own
/// normal.
pub fn holds_vertices(world: &World, object: u32, point: &SurfacePoint) -> bool {
    matches!(world.scene.material_of(object), Material::Diffuse(_)) && point.shading == point.normal
}

/// A few vertices of the light paths that a world's method asks for, for a pilot; none where no light can be followed.
pub fn few_vertices<const N: usize>(world: &World) -> Option<LightVertices<N>> {
    Some(LightPaths::new(world, world.method.seed)?.of_set::<N, Polarized>(PILOT, OF_A_PILOT))
}

/// How much fainter than the brightest one a lamp may be that has a layer of its own. One that is ten times fainter had
/// nine times the noise in means over 32 x 32 pixels.
const FAINT: f64 = 0.25;

/// The lights of a world that paths start from, and from where their vertices are looked at: what all sets share.
pub struct LightPaths<'a> {
    world: &'a World,
    /// Of their random numbers.
    seed: u64,
    by_flux: Distribution,
    /// Whether all light is theirs.
    finds_all: bool,
    places: Vec<Place>,
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
        let starts_anywhere = world.path_starts.iter().all(|start| matches!(start, PathStart::Anywhere));
        let ends_nowhere = (0..world.scene.objects.len() as u32).all(|object| !world.ends_light_paths(object));
        let finds_all = starts_anywhere && ends_nowhere;
        let places = places(world);
        (by_flux.total() > 0.0).then_some(Self { world, seed, by_flux, finds_all, places, scale: OnceLock::new() })
    }

    /// Whether a layer of lights is asked for whose paths would be so few that it would be too bright or too dark as a
    /// whole.
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
                send(self.world, &targets, batches[number], false, &|_, landing: &Landing<N, P>, _, vertices| {
                    vertices.extend(kept(self.world, landing, true));
                })
            };
            for sent in in_parallel(batches.len(), &of_batch) {
                stats += sent.stats;
                vertices.extend(sent.kept);
            }
        }
        let (center, near) = *self.scale.get_or_init(|| self.scale::<N, P>());
        self.dealt(vertices, stats, center, near)
    }

    /// The middle of vertices, and D, by light paths of their own: weights by a D that depends on the vertices that
    /// they are of would be biased.
    fn scale<const N: usize, P: Polarization<N>>(&self) -> (DVec3, f64) {
        let (vertices, _) = self.vertices::<N, P>(SCALE, OF_SCALE);
        // Medians: some vertices may lie far outside of all that is seen.
        let middle = |axis: usize| median(vertices.iter().map(|vertex| vertex.position[axis]).collect());
        let center = DVec3::new(middle(0), middle(1), middle(2));
        let distances = vertices.iter().map(|vertex| (vertex.position - center).length()).collect();
        let near = if vertices.is_empty() { 1.0 } else { (NEAR * median(distances)).max(f64::MIN_POSITIVE) };
        (center, near)
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
        let over = if self.finds_all || !world.has_map() { Surfaces::All } else { Surfaces::AllButPhotons };
        let mut vertices = Vec::new();
        for number in paths {
            let sampler = Sampler::new(self.seed ^ SEED, [set, 0], number as u32);
            let drawn = self.by_flux.sample(sampler.four_plain(BranchKey::CAMERA, LIGHT)[0]);
            let light = drawn.index;
            let u = sampler.four(BranchKey::CAMERA, START);
            let emitted = world.path_starts[light].emit(&world.scene, &world.scene.lights[light], u);
            let Some(mut emitted) = emitted else { continue };
            emitted.factor /= drawn.probability;
            let media = world.media_at_light(light, &emitted.ray);
            let start = Start { emitted: &emitted, light, media, early: true };
            follow_photon(&mut walker, start, &draw, &sampler, over, &mut |_, landing| {
                vertices.extend(kept(world, landing, false));
            });
        }
        (vertices, walker.stats)
    }

    /// Deals vertices into sets of candidates.
    fn dealt<const N: usize>(
        &self,
        mut vertices: Vec<LightVertex<N>>,
        stats: Stats,
        center: DVec3,
        near: f64,
    ) -> LightVertices<N> {
        vertices.sort_by_cached_key(|vertex| morton((vertex.position - center) * (CELLS / near)));
        let count = vertices.len().div_ceil(CANDIDATES);
        let mut candidates = vec![Candidates::EMPTY; count];
        for (number, (vertex, power)) in vertices.iter().zip(self.powers(&vertices)).enumerate() {
            candidates[number % count].set(number / count, (vertex.position - center) / near, vertex.flat, power);
        }
        let (starts, instructions) = (self.world.path_starts.clone(), Instructions::best());
        let starts = (!self.finds_all).then_some(starts);
        LightVertices { candidates, vertices, center, near, starts, instructions, stats }
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

impl<const N: usize> LightVertices<N> {
    /// D^2: of light from a distance d, the part d^2 / (d^2 + D^2) is looked for at vertices.
    pub fn near_squared(&self) -> f64 {
        self.near * self.near
    }

    /// Whether all light that surfaces send each other is looked for.
    pub fn carry_all(&self) -> bool {
        self.starts.is_none()
    }

    /// Whether the light that comes along a ray from a light is looked for behind the first surface that it meets.
    pub fn carry(&self, world: &World, light: LightId, ray: &Ray) -> bool {
        self.starts.as_ref().is_none_or(|starts| starts[light].covers(&world.scene.lights[light], ray))
    }

    /// The chance with which a bounce goes on from a surface at a distance whose light is looked for at light vertices.
    pub fn complement(&self, distance_squared: f64) -> f64 {
        self.near_squared() / (distance_squared + self.near_squared())
    }

    /// A vertex as seen from a point of a surface, for two random numbers, and one over how likely it was; none if none
    /// is seen.
    pub fn choose(&self, from: DVec3, flat: DVec3, [u, v]: [f64; 2]) -> Option<(&LightVertex<N>, f64)> {
        let count = self.candidates.len();
        let number = ((u * count as f64) as usize).min(count.checked_sub(1)?);
        let [from, flat] = [(from - self.center) / self.near, flat].map(|v| v.as_vec3().to_array());
        let weights = self.instructions.run(Weighing { candidates: &self.candidates[number], from, flat });
        let rows =
            weights.iter().fold([0.0; ROWS], |rows, weights| std::array::from_fn(|row| rows[row] + weights[row]));
        let total: f32 = rows.iter().sum();
        let (row, left) = chosen(rows, v as f32 * total)?;
        let (place, _) = chosen(weights.map(|weights| weights[row]), left)?;
        let factor = count as f64 * f64::from(total) / f64::from(weights[place][row]);
        factor.is_finite().then(|| (&self.vertices[(row * ROW + place) * count + number], factor))
    }
}

/// The place of the weight in which a share of the sum ends, and what of the share falls to it. A weight of 0 is never
/// chosen. Where rounding leaves the share larger than the sum, the last weight above 0 is chosen.
fn chosen<const COUNT: usize>(weights: [f32; COUNT], share: f32) -> Option<(usize, f32)> {
    let (mut left, mut chosen) = (share, None);
    for (number, weight) in weights.into_iter().enumerate().filter(|(_, weight)| *weight > 0.0) {
        chosen = Some((number, left));
        if left < weight {
            break;
        }
        left -= weight;
    }
    chosen
}

impl Candidates {
    const EMPTY: Self =
        Self { place: [[[0.0; ROWS]; ROW]; 3], flat: [[[0.0; ROWS]; ROW]; 3], power: [[0.0; ROWS]; ROW] };

    fn set(&mut self, slot: usize, place: DVec3, flat: DVec3, power: f32) {
        let (row, slot) = (slot / ROW, slot % ROW);
        for axis in 0..3 {
            (self.place[axis][slot][row], self.flat[axis][slot][row]) = (place[axis] as f32, flat[axis] as f32);
        }
        self.power[slot][row] = power;
    }
}

/// Finds about what each candidate would bring to a white diffuse surface.
struct Weighing<'a> {
    candidates: &'a Candidates,
    /// The point of the surface as places of candidates are given, and its unit normal.
    from: [f32; 3],
    flat: [f32; 3],
}

impl Computation for Weighing<'_> {
    type Output = OfCandidates;

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) -> OfCandidates {
        let Self { candidates: Candidates { place, flat: flats, power }, from, flat } = self;
        // One instruction, where `max` takes several for the sake of NaN.
        let positive = |x: f32| if x > 0.0 { x } else { 0.0 };
        std::array::from_fn(|i| {
            std::array::from_fn(|row| {
                let way = [0, 1, 2].map(|axis| place[axis][i][row] - from[axis]);
                let squared = way[0] * way[0] + way[1] * way[1] + way[2] * way[2];
                let here = positive(way[0] * flat[0] + way[1] * flat[1] + way[2] * flat[2]);
                let there = [0, 1, 2].map(|axis| way[axis] * flats[axis][i][row]);
                let there = positive(-(there[0] + there[1] + there[2]));
                let weight = power[i][row] * (here * there) / (squared * (squared + 1.0));
                if weight < f32::INFINITY { weight } else { 0.0 }
            })
        })
    }
}

/// The median of some numbers; 0 of none.
fn median(mut numbers: Vec<f64>) -> f64 {
    let half = numbers.len() / 2;
    if numbers.is_empty() { 0.0 } else { *numbers.select_nth_unstable_by(half, f64::total_cmp).1 }
}

/// The place of a point along Morton's curve through a cube around the origin.
fn morton(place: DVec3) -> u64 {
    let spread = |x: f64| {
        let mut x = (x + 1024.0).clamp(0.0, 2047.0) as u64;
        x = (x | x << 32) & 0x1f_0000_0000_ffff;
        x = (x | x << 16) & 0x1f_0000_ff00_00ff;
        x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
        x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
        (x | x << 2) & 0x1249_2492_4924_9249
    };
    spread(place.x) | spread(place.y) << 1 | spread(place.z) << 2
}

/// The vertex where a light path or a photon that is aimed at smooth surfaces lands, if it is one: what comes over
/// those from lights that send photons is left to photons.
fn kept<const N: usize, P>(world: &World, landing: &Landing<N, P>, is_of_photon: bool) -> Option<LightVertex<N>> {
    let Landing { path, at, start } = landing;
    let Material::Diffuse(diffuse) = at.material else { return None };
    let leaving = landing.flux(world) * at.arrival.read(&diffuse.reflectance) * FRAC_1_PI as f32;
    let came_over_smooth = path.vertices > 1 && path.kind == PathKind::Other;
    let is_left = !is_of_photon && world.has_map() && world.sends_photons(start.light) && came_over_smooth;
    let usable = holds_vertices(world, at.object, at.point)
        && !is_left
        && !leaving.is_zero()
        && leaving.0.iter().all(|x| x.is_finite());
    // From the camera, a path leaves one diffuse surface more to come over smooth ones to the light.
    let diffuse = world.method.diffuse_bounces - path.diffuse_left + 1 + u32::from(is_of_photon);
    let SurfacePoint { position, error, normal, .. } = *at.point;
    let (error, flat, light) = (normal.abs().dot(error), at.flat, start.light);
    let (surfaces, parted) = (path.surfaces(), path.parted);
    usable.then_some(LightVertex { position, error, flat, leaving, light, surfaces, diffuse, is_of_photon, parted })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_and_wide_instructions_weigh_candidates_alike() {
        let number = |i: usize, purpose: u32| {
            Sampler::new(3, [0, 0], i as u32).four_plain(BranchKey::CAMERA, purpose).map(|u| 4.0 * u - 2.0)
        };
        let mut candidates = Candidates::EMPTY;
        for slot in 0..CANDIDATES - 3 {
            let ([x, y, z, power], [a, b, c, _]) = (number(slot, 0), number(slot, 1));
            candidates.set(slot, DVec3::new(x, y, z), DVec3::new(a, b, c).normalize(), power.abs() as f32);
        }
        let mut some = 0;
        for i in 0..1000 {
            let ([x, y, z, _], [a, b, c, _]) = (number(i, 2), number(i, 3));
            // Also from the place of a vertex itself, where its weight is 0 / 0.
            let from = if i < 8 { candidates.place.map(|axis| axis[i][0]) } else { [x, y, z].map(|x| x as f32) };
            let weigh = |instructions: Instructions| {
                instructions.run(Weighing { candidates: &candidates, from, flat: [a, b, c].map(|x| x as f32) })
            };
            let weights = weigh(Instructions::Plain);
            assert_eq!(weights, weigh(Instructions::best()));
            assert!(weights.as_flattened().iter().all(|weight| (0.0..f32::INFINITY).contains(weight)));
            some += usize::from(weights.as_flattened().iter().any(|&weight| weight > 0.0));
        }
        assert!(some > 900, "only {some} of 1000 places are reached by any vertex");
    }
}
