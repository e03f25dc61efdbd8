//! Vertices of paths from the lights, at which paths from the camera look for the light between surfaces.
//!
//! At a diffuse surface x, a path from the camera chooses one of several vertices y, in proportion to their estimated
//! contributions, and tests whether it sees it: resampled importance sampling (Talbot, Cline & Egbert 2005, *Importance
//! Resampling for Global Illumination*). Near vertices would contribute far too much: of what leaves y for x, only the
//! part d^2 / (d^2 + D^2) is looked for at distance d. A bounce that happens to go from x to y continues from there
//! with the probability of the rest, D^2 / (d^2 + D^2). Both together are exact for any D (Kollig & Keller 2004,
//! *Illumination in the Presence of Weak Singularities*, bound the same way).

use crate::light::LightId;
use crate::material::Material;
use crate::math::{DVec3, Ray};
use crate::shape::{Computation, Instructions, SurfacePoint, Vectors};
use crate::spectrum::Lanes;
use crate::trace::World;
use crate::trace::stats::Stats;

/// A vertex of a light path, on a diffuse surface.
#[derive(Clone, Debug)]
pub struct LightVertex<const N: usize> {
    pub position: DVec3,
    /// Bound on its distance from the true surface.
    pub error: f64,
    /// The surface's unit normal on the side that is lit.
    pub flat: DVec3,
    /// Light that leaves it in any direction on that side, lane by lane: intensity over the cosine.
    pub leaving: Lanes<N>,
    pub light: LightId,
    /// Number of surfaces that the light has hit, and of diffuse ones among them, this one included.
    pub surfaces: u32,
    pub diffuse: u32,
    /// Whether a photon left it.
    pub is_of_photon: bool,
    /// Whether lanes parted on the way there.
    pub parted: bool,
}

/// The vertices of some light paths, dealt into sets of candidates. Each set has vertices from all over the scene.
pub struct LightVertices<const N: usize> {
    candidates: Vec<Candidates>,
    /// Ordered along a curve through the scene. Of n sets of candidates, each has every n-th vertex, row after row.
    vertices: Vec<LightVertex<N>>,
    /// The origin of the places of candidates, which are in units of D.
    center: DVec3,
    /// D.
    near_distance: f64,
    /// Probability that camera paths continue for light that light paths do not find; `None` where they find all.
    pub rest_chance: Option<f64>,
    /// The instructions that weigh candidates.
    instructions: Instructions,
    pub stats: Stats,
}

/// Rows of candidates, and vertices of a row. There are 64 candidates in all: with 32, an image is noisier by a sixth.
const ROWS: usize = 8;
const PER_ROW: usize = 8;
const CANDIDATES: usize = ROWS * PER_ROW;
/// Cells of the Morton curve per D.
const CELLS_PER_D: f64 = 25.0;

/// The data of some vertices that a choice among them needs; absent vertices have no power.
#[derive(Clone, Debug)]
struct Candidates {
    place: [PerCandidate; 3],
    flat: [PerCandidate; 3],
    /// X + Y + Z of what leaves, as the sensor sees it, times how often it is seen; 1 for the brightest vertex.
    power: PerCandidate,
}

/// A number for each candidate: for each place in a row, those of all rows side by side, which are summed at once.
type PerCandidate = [[f32; ROWS]; PER_ROW];

/// Whether light between surfaces is looked for at vertices on this surface. It must be diffuse and shaded by its own
/// normal.
pub fn holds_vertices(world: &World, object: u32, point: &SurfacePoint) -> bool {
    matches!(world.scene.material_of(object), Material::Diffuse(_)) && point.shading == point.normal
}

impl<const N: usize> LightVertices<N> {
    /// Deals vertices into sets of candidates. `powers` returns what leaves each of them, as the sensor sees it, times
    /// how often it is seen; 1 for the brightest.
    pub fn new(
        mut vertices: Vec<LightVertex<N>>,
        center: DVec3,
        near: f64,
        rest_chance: Option<f64>,
        stats: Stats,
        powers: impl FnOnce(&[LightVertex<N>]) -> Vec<f32>,
    ) -> Self {
        vertices.sort_by_cached_key(|vertex| morton((vertex.position - center) * (CELLS_PER_D / near)));
        let count = vertices.len().div_ceil(CANDIDATES);
        let mut candidates = vec![Candidates::EMPTY; count];
        for (number, (vertex, power)) in vertices.iter().zip(powers(&vertices)).enumerate() {
            candidates[number % count].set(number / count, (vertex.position - center) / near, vertex.flat, power);
        }
        Self {
            candidates,
            vertices,
            center,
            near_distance: near,
            rest_chance,
            instructions: Instructions::best(),
            stats,
        }
    }

    /// Returns D^2: of light from a distance d, the part d^2 / (d^2 + D^2) is looked for at vertices.
    pub fn near_squared(&self) -> f64 {
        self.near_distance * self.near_distance
    }

    /// Whether vertices contribute the light of a ray from a light, beyond the first surface that it hits.
    pub fn carry(&self, world: &World, light: LightId, ray: &Ray) -> bool {
        self.rest_chance.is_none() || world.is_found_by_light_paths(light, ray)
    }

    /// Returns the probability that a bounce continues from a surface at a distance whose light is found at vertices.
    pub fn continuation_probability(&self, distance_squared: f64) -> f64 {
        self.near_squared() / (distance_squared + self.near_squared())
    }

    /// Chooses a vertex for a point of a surface; returns it with one over its probability, if any would contribute.
    pub fn choose(&self, from: DVec3, flat: DVec3, [u, v]: [f64; 2]) -> Option<(&LightVertex<N>, f64)> {
        let count = self.candidates.len();
        let number = ((u * count as f64) as usize).min(count.checked_sub(1)?);
        let [from, flat] = [(from - self.center) / self.near_distance, flat].map(|v| v.as_vec3().to_array());
        let weights = self.instructions.run(CandidateWeights { candidates: &self.candidates[number], from, flat });
        let rows =
            weights.iter().fold([0.0; ROWS], |rows, weights| std::array::from_fn(|row| rows[row] + weights[row]));
        let total: f32 = rows.iter().sum();
        let (row, left) = chosen(rows, v as f32 * total)?;
        let (place, _) = chosen(weights.map(|weights| weights[row]), left)?;
        let factor = count as f64 * f64::from(total) / f64::from(weights[place][row]);
        factor.is_finite().then(|| (&self.vertices[(row * PER_ROW + place) * count + number], factor))
    }
}

/// Returns the index of the weight in which a share of the sum ends, and what of the share falls to it. A weight of 0
/// is never chosen. If rounding leaves the share larger than the sum, the last weight above 0 is chosen.
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
        Self { place: [[[0.0; ROWS]; PER_ROW]; 3], flat: [[[0.0; ROWS]; PER_ROW]; 3], power: [[0.0; ROWS]; PER_ROW] };

    fn set(&mut self, slot: usize, place: DVec3, flat: DVec3, power: f32) {
        let (row, slot) = (slot / PER_ROW, slot % PER_ROW);
        for axis in 0..3 {
            (self.place[axis][slot][row], self.flat[axis][slot][row]) = (place[axis] as f32, flat[axis] as f32);
        }
        self.power[slot][row] = power;
    }
}

/// Estimates what each candidate would contribute to a white diffuse surface.
struct CandidateWeights<'a> {
    candidates: &'a Candidates,
    /// The point of the surface in the coordinates of the candidates, and its unit normal.
    from: [f32; 3],
    flat: [f32; 3],
}

impl Computation for CandidateWeights<'_> {
    type Output = PerCandidate;

    #[inline(always)]
    fn run<V: Vectors>(self, _: V) -> PerCandidate {
        let Self { candidates: Candidates { place, flat: flats, power }, from, flat } = self;
        // A single instruction; `max` takes several to handle NaN.
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

/// Returns the index of a point along the Morton curve through a cube around the origin.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::{BranchKey, Sampler};

    #[test]
    fn plain_and_wide_instructions_weigh_candidates_alike() {
        let number = |i: usize, purpose: u32| {
            Sampler::new(3, [0, 0], i as u32).get_random_4d(BranchKey::CAMERA, purpose).map(|u| 4.0 * u - 2.0)
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
                instructions.run(CandidateWeights { candidates: &candidates, from, flat: [a, b, c].map(|x| x as f32) })
            };
            let weights = weigh(Instructions::Plain);
            assert_eq!(weights, weigh(Instructions::best()));
            assert!(weights.as_flattened().iter().all(|weight| (0.0..f32::INFINITY).contains(weight)));
            some += usize::from(weights.as_flattened().iter().any(|&weight| weight > 0.0));
        }
        assert!(some > 900, "only {some} of 1000 places are reached by any vertex");
    }
}
