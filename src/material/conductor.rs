use std::array;

use super::coating::LocalCoating;
use super::film_averages::{FilmAverages, mean};
use super::fresnel::conductor_reflectances;
use super::lane_cache::LaneCache;
use super::last_result::LastResult;
use super::polarization_degree::{MAX_EVALUATED_LANES, combined_degree, degree, max_degree};
use super::roughness::to_local_above;
use super::{
    Block, Branch, Coating, Incoming, Mueller, PolarizedShare, RoughReflection, RoughSurface, Roughness,
    ScatterContext, conductor_reflectance,
};
use crate::math::{Complex, DVec3, Frame, unit};
use crate::spectrum::{Lanes, Quantity, Table};

/// A metal, smooth or rough.
///
/// ```toml
/// conductor = { metal = "Au" }
/// conductor = { n = 0.2, k = 3.9, roughness = 0.3 }     # 0 to 1; 0, smooth, if absent
/// conductor = { metal = "Ti", coating = [{ index = 2.4, thickness_nm = 50 }] }     # from the outside inward
/// ```
#[derive(Clone, Debug)]
pub struct Conductor<S> {
    /// Real part of the refractive index.
    pub n: S,
    /// Extinction coefficient.
    pub k: S,
    /// Roughness of its surface; below 0.01 the surface counts as smooth.
    pub roughness: Roughness,
    /// Thin layers on it in which light interferes.
    pub coating: Option<Coating<S>>,
    /// [`RoughSurface::multiply_reflected`] of an uncoated metal, by its indices.
    multiple: LaneCache<[f64; 3], f64>,
}

impl<S> Conductor<S> {
    /// Makes a metal of index n - i k with a roughness and a coating.
    pub fn new([n, k]: [S; 2], roughness: Roughness, coating: Option<Coating<S>>) -> Self {
        Self { n, k, roughness, coating, multiple: LaneCache::new() }
    }

    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Conductor<T> {
        let indices = [convert(Quantity::MetalIndex, &self.n), convert(Quantity::MetalExtinction, &self.k)];
        let coating = self.coating.as_ref().map(|coating| coating.map(convert));
        Conductor::new(indices, self.roughness.clone(), coating)
    }
}

impl Conductor<Table> {
    /// Samples a direction backward from the viewer. Returns None if it leads into the metal.
    pub(super) fn scatter<const N: usize>(&self, context: &ScatterContext<N>, u: [f64; 2]) -> Option<Branch<N>> {
        let Some(surface) = self.roughness.surface() else { return Some(self.mirror(context)) };
        let frame = Frame::about(context.normal);
        let reflection = surface.scatter(to_local_above(&frame, context.wo), u)?;
        let share = self.reflected(context, surface, &reflection, 1.0 / reflection.pdf);
        Some(Branch::drawn(unit(frame.to_world(reflection.wi)), share, reflection.pdf))
    }

    fn local<'a, const N: usize>(&'a self, context: &'a ScatterContext<'a, N>) -> LocalConductor<'a, N> {
        let [n, k] = [&self.n, &self.k].map(|table| context.draw.read_exact(table));
        let coating = self.coating.as_ref().map(|coating| coating.local(context, false));
        LocalConductor { context, n, k, coating }
    }

    /// Returns the branch of a smooth metal.
    fn mirror<const N: usize>(&self, context: &ScatterContext<N>) -> Branch<N> {
        let (local, cos) = (self.local(context), context.wo.dot(context.normal));
        let reflected = local.reflected(cos);
        let share = Lanes::from_fn(|i| unpolarized(reflected[i]) as f32);
        let polarization = match local.coating {
            None => max_degree(reflected.into_iter().map(degree)),
            Some(_) => combined_degree(reflected.into_iter()) as f32,
        };
        Branch::mirrored(context, share, polarization)
    }

    pub(super) fn evaluate<const N: usize>(&self, context: &ScatterContext<N>, wi: DVec3) -> Option<(Lanes<N>, f64)> {
        let surface = self.roughness.surface()?;
        let reflection = surface.evaluate_at(context, wi)?;
        Some((self.reflected(context, surface, &reflection, 1.0), reflection.pdf))
    }

    /// Returns BRDF times cosine of each lane, times a factor.
    fn reflected<const N: usize>(
        &self,
        context: &ScatterContext<N>,
        surface: &RoughSurface,
        reflection: &RoughReflection,
        factor: f64,
    ) -> Lanes<N> {
        let (local, mut last) = (self.local(context), LastResult::NONE);
        let single = local.reflected(reflection.cos);
        Lanes::from_fn(|i| {
            if context.present[i] == 0.0 {
                return 0.0;
            }
            let multiple = match &local.coating {
                Some(coating) => surface.multiply_reflected(coated_mean_reflectance(coating, i, local.indices(i))),
                None => last.get_or_make(local.indices(i), |indices| {
                    let multiple = || surface.multiply_reflected(mean_reflectance(indices));
                    self.multiple.get(context.draw, i, indices, multiple).copied().unwrap_or_else(multiple)
                }),
            };
            (factor * (unpolarized(single[i]) * reflection.single + multiple * reflection.multiple)) as f32
        })
    }

    /// Returns the degree for the facet that mirrors light from `wi`:
    /// [`Scatter::degree_of_scattered`](super::Scatter::degree_of_scattered).
    pub(super) fn degree_of_scattered<const N: usize>(&self, context: &ScatterContext<N>, wi: DVec3) -> f32 {
        let Some(h) = (context.wo + wi).try_normalize() else { return 0.0 };
        let (local, cos) = (self.local(context), context.wo.dot(h));
        max_degree(
            (0..N).step_by(N.div_ceil(MAX_EVALUATED_LANES)).map(|lane| degree(local.lane_reflectance(lane, cos))),
        )
    }

    /// Sets the Mueller matrix of the facet that mirrors the light. What is reflected more than once leaves
    /// unpolarized.
    pub(super) fn mueller<const N: usize>(
        &self,
        context: &ScatterContext<N>,
        incoming: Incoming,
        mueller: &mut Mueller<N>,
    ) {
        let (axis, cos, single) = match self.roughness.surface() {
            None if incoming.single => (context.wo.cross(context.normal), context.wo.dot(context.normal), 1.0),
            Some(surface) if !incoming.single => {
                let Some(reflection) = surface.evaluate_at(context, incoming.wi) else {
                    return *mueller = Mueller::NONE;
                };
                (context.wo.cross(incoming.wi), reflection.cos, reflection.single)
            }
            _ => return *mueller = Mueller::NONE,
        };
        let (local, mut last) = (self.local(context), LastResult::NONE);
        mueller.set_lanes(axis, incoming.lanes, |lane| match local.coated_reflectance(lane, cos) {
            Some(share) => share.block().times(single),
            None => last.get_or_make(local.indices(lane), |[n1, n, k]| Block::of_metal(n1, n, k, cos).times(single)),
        });
    }
}

/// A metal at the point where light arrives.
struct LocalConductor<'a, const N: usize> {
    context: &'a ScatterContext<'a, N>,
    n: [f64; N],
    k: [f64; N],
    coating: Option<LocalCoating<'a, N>>,
}

impl<const N: usize> LocalConductor<'_, N> {
    /// Returns the index of the medium in front of the metal and the metal's index, n - i k, for a lane.
    fn indices(&self, lane: usize) -> [f64; 3] {
        [self.context.incident_of(lane), self.n[lane], self.k[lane]]
    }

    /// Returns the reflectances (s, p) of each lane on the ray, at an angle with cosine `cos`.
    fn reflected(&self, cos: f64) -> [[f64; 2]; N] {
        let is_present = |lane: usize| self.context.present[lane] != 0.0;
        if self.coating.is_some() {
            return array::from_fn(|lane| if is_present(lane) { self.lane_reflectance(lane, cos) } else { [0.0; 2] });
        }
        let n1 = array::from_fn(|lane| self.context.incident_of(lane));
        let [s, p] = conductor_reflectances(&n1, [&self.n, &self.k], cos);
        array::from_fn(|lane| if is_present(lane) { [s[lane], p[lane]] } else { [0.0; 2] })
    }

    /// Returns the reflectances (s, p) of one lane, whether or not it is on the ray.
    fn lane_reflectance(&self, lane: usize, cos: f64) -> [f64; 2] {
        match self.coated_reflectance(lane, cos) {
            Some(PolarizedShare { s, p, .. }) => [s, p],
            None => {
                let [n1, n, k] = self.indices(lane);
                conductor_reflectance(n1, n, k, cos)
            }
        }
    }

    /// Returns the reflectance of the coated metal for one lane, or None without a coating.
    fn coated_reflectance(&self, lane: usize, cos: f64) -> Option<PolarizedShare> {
        let [n1, n, k] = self.indices(lane);
        Some(self.coating.as_ref()?.shares_at_cosine(lane, n1, Complex::new(n, -k), cos).reflected)
    }
}

/// Returns the reflectance of unpolarized light from those of s and p.
fn unpolarized([s, p]: [f64; 2]) -> f64 {
    0.5 * (s + p)
}

/// Returns a coated metal's reflectance of diffuse light.
fn coated_mean_reflectance<const N: usize>(local: &LocalCoating<N>, lane: usize, [n1, n, k]: [f64; 3]) -> f64 {
    let averages = local.averages(lane, false, [n1, n, k, 0.0], |stack| {
        let at = |cos: f64| stack.shares(n1, Complex::new(n, -k), n1 * cos.clamp(0.0, 1.0)).reflected.mean();
        FilmAverages::from_mean(mean(stack.varies_slowly(), 1.0, |cos| [at(cos), 0.0]))
    });
    averages.mean[0]
}

/// Returns a metal's reflectance of diffuse light: twice the integral of reflectance times cosine over the cosine.
///
/// Uses the Gauss rule of order 10 for this weight.
fn mean_reflectance([n1, n, k]: [f64; 3]) -> f64 {
    const RULE: [[f64; 2]; 5] = [
        [0.098_535_085_798_826_43, 0.031_495_829_043_383_45],
        [0.304_535_726_646_363_9, 0.147_817_740_145_233_22],
        [0.562_025_189_752_613_8, 0.292_773_974_169_339_6],
        [0.801_986_582_126_391_8, 0.334_349_276_188_739_1],
        [0.960_190_142_948_531_2, 0.193_563_180_453_303_37],
    ];
    let reflected = RULE.map(|[cos, weight]| {
        let [s, p] = conductor_reflectance(n1, n, k, cos);
        0.5 * weight * (s + p)
    });
    reflected.iter().sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn five_places_give_a_metals_mean_reflectance() {
        const STEPS: u32 = 20_000;
        for (n, k) in [(0.05, 3.0), (0.2, 3.9), (1.5, 1.9), (1.2, 7.3), (3.1, 3.3), (6.0, 6.0), (0.02, 0.5), (1.0, 0.1)]
        {
            let at = |i| (f64::from(i) + 0.5) / f64::from(STEPS);
            let reflected = |cos: f64| conductor_reflectance(1.0, n, k, cos).iter().sum::<f64>() * cos;
            let exact = (0..STEPS).map(|i| reflected(at(i))).sum::<f64>() / f64::from(STEPS);
            let mean = mean_reflectance([1.0, n, k]);
            assert!((mean - exact).abs() < 1e-3, "{n}, {k}: {mean} for {exact}");
        }
    }
}
