use std::f64::consts::FRAC_1_PI;

use super::coat::{Coat, CoatTransmittance};
use super::last_result::LastResult;
use super::plastic_film::PlasticFilm;
use super::polarization_degree::{MAX_EVALUATED_LANES, combined_degree, max_degree};
use super::roughness::to_local_above;
use super::{
    Base, Block, Branch, Coating, Incoming, Interface, Lobes, Mueller, RoughReflection, RoughSurface, ScatterContext,
    StackShares,
};
use crate::math::{DVec3, Frame, sample_cosine_hemisphere, unit};
use crate::spectrum::{Lanes, Quantity, Table};

/// A matte body under a clear coat, smooth or rough: plastic, glazed earthenware, varnish.
///
/// The base scatters the light that the coat does not reflect. The coat sends part of it back to the base, the rest
/// leaves through the coat. A white plastic reflects all light.
///
/// ```toml
/// plastic = { reflectance = { rgb = [0.7, 0.1, 0.1] }, roughness = 0.2 }     # index = 1.5, roughness = 0 if absent
/// plastic = { reflectance = 0.02, coating = [{ index = 1.8, thickness_nm = 350 }] }     # oil on tar
/// ```
#[derive(Clone, Debug)]
pub struct Plastic<S> {
    /// Share of the light in the base that it scatters, before the coat sends any of it back.
    pub reflectance: S,
    /// Refractive index of the coat.
    pub index: S,
    /// The coat; below a roughness of 0.01 it counts as smooth.
    pub coat: Coat,
    /// Thin layers on the coat in which light interferes.
    pub coating: Option<Coating<S>>,
}

impl<S> Plastic<S> {
    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Plastic<T> {
        Plastic {
            index: convert(Quantity::Index, &self.index),
            reflectance: convert(Quantity::Reflectance, &self.reflectance),
            coat: self.coat.clone(),
            coating: self.coating.as_ref().map(|coating| coating.map(convert)),
        }
    }
}

impl Plastic<Table> {
    /// Adds the mirror image in a smooth coat, and one branch for all other light.
    pub(super) fn scatter<const N: usize>(
        &self,
        context: &ScatterContext<N>,
        u: [f64; 2],
        branches: &mut Vec<Branch<N>>,
    ) {
        let Some(surface) = self.coat.roughness().surface() else {
            let is_mirrored = context.lobes.intersects(Lobes::DELTA_REFLECTION);
            branches.extend(is_mirrored.then(|| self.mirrored(context)).flatten());
            if !context.lobes.intersects(Lobes::DIFFUSE_REFLECTION) {
                return;
            }
            let wi = sample_cosine_hemisphere(u);
            let base = self.lanes(context, [context.wo.dot(context.normal), wi.z], |lane| lane.base());
            branches.push(make_branch(context, wi, base, wi.z * FRAC_1_PI));
            return;
        };
        let wo = to_local_above(&Frame::about(context.normal), context.wo);
        let chance = self.chance_of_coat(context, &self.lanes(context, [wo.z; 2], |lane| lane.reflected()));
        let wi = if u[0] < chance {
            surface.scatter(wo, [u[0] / chance, u[1]]).map(|reflection| reflection.wi)
        } else {
            Some(sample_cosine_hemisphere([(u[0] - chance) / (1.0 - chance), u[1]]))
        };
        if let Some(wi) = wi
            && let Some((light, pdf)) = self.evaluate_rough(context, surface, [wo, wi])
        {
            branches.push(make_branch(context, wi, light.map(|x| x / pdf), pdf));
        }
    }

    pub(super) fn evaluate<const N: usize>(&self, context: &ScatterContext<N>, wi: DVec3) -> Option<(Lanes<N>, f64)> {
        let (light, pdf) = match self.coat.roughness().surface() {
            None => {
                let cos = wi.dot(context.normal);
                if cos <= 0.0 || !context.lobes.intersects(Lobes::DIFFUSE_REFLECTION) {
                    return None;
                }
                let (cosines, pdf) = ([context.wo.dot(context.normal), cos], cos * FRAC_1_PI);
                (self.lanes(context, cosines, |lane| lane.base() * pdf), pdf)
            }
            Some(surface) => {
                let frame = Frame::about(context.normal);
                self.evaluate_rough(context, surface, [to_local_above(&frame, context.wo), frame.to_local(wi)])?
            }
        };
        Some((Lanes::from_fn(|i| light[i] as f32), pdf))
    }

    /// Returns BRDF times cosine of the base, seen through the coat.
    pub(super) fn diffuse_part<const N: usize>(&self, context: &ScatterContext<N>, wi: DVec3) -> Lanes<N> {
        let cos = wi.dot(context.normal);
        if cos <= 0.0 {
            return Lanes::ZERO;
        }
        let wo = to_local_above(&Frame::about(context.normal), context.wo);
        let light = self.lanes(context, [wo.z, cos], |lane| lane.base() * cos * FRAC_1_PI);
        Lanes::from_fn(|i| light[i] as f32)
    }

    /// Returns the mirror branch of a smooth coat.
    fn mirrored<const N: usize>(&self, context: &ScatterContext<N>) -> Option<Branch<N>> {
        let (index, cos) = (context.draw.read_exact(&self.index), context.wo.dot(context.normal));
        let local = self.coating.as_ref().map(|coating| coating.local(context, false));
        let (mut share, mut degree, mut lane_shares) = (Lanes::ZERO, 0.0_f64, [[0.0; 2]; N]);
        for lane in (0..N).filter(|&lane| context.present[lane] != 0.0) {
            let [n1, n2] = [context.incident_of(lane), index[lane]];
            if let Some(local) = &local {
                let reflected = local.shares_at_cosine(lane, n1, n2, cos).reflected;
                share.0[lane] = reflected.mean() as f32;
                lane_shares[lane] = [reflected.s, reflected.p];
            } else {
                let interface = Interface::new(n1, n2, cos);
                share.0[lane] = interface.reflectance as f32;
                degree = degree.max(interface.polarization_reflected.abs());
            }
        }
        if local.is_some() {
            degree = combined_degree(lane_shares.into_iter());
        }
        (!share.is_zero()).then(|| Branch::mirrored(context, share, degree as f32))
    }

    /// Returns BRDF times cosine of a rough coat and its base, and the density with which `scatter` draws the light's
    /// direction.
    fn evaluate_rough<const N: usize>(
        &self,
        context: &ScatterContext<N>,
        surface: &RoughSurface,
        [wo, wi]: [DVec3; 2],
    ) -> Option<([f64; N], f64)> {
        let reflection = surface.evaluate(wo, wi)?;
        let base_pdf = wi.z * FRAC_1_PI;
        let [coat_weight, base_weight] = self.requested_parts(context).map(f64::from);
        let mut last = LastResult::NONE;
        let lanes = self.lanes(context, [wo.z, wi.z], |lane| {
            let coat = match lane.film {
                Some(_) => lane.coat(&reflection),
                None => last.get_or_make(lane.indices, |_| lane.coat(&reflection)),
            };
            (coat_weight * coat + base_weight * lane.base() * base_pdf, lane.reflected())
        });
        let chance = self.chance_of_coat(context, &lanes.map(|lane| lane.1));
        let pdf = chance * reflection.pdf + (1.0 - chance) * base_pdf;
        (pdf > 0.0).then(|| (lanes.map(|lane| lane.0), pdf))
    }

    /// Returns whether a rough coat is requested, and whether the base is.
    fn requested_parts<const N: usize>(&self, context: &ScatterContext<N>) -> [bool; 2] {
        [self.coat.roughness().reflection(), Lobes::DIFFUSE_REFLECTION].map(|lobe| context.lobes.intersects(lobe))
    }

    /// Returns the probability of drawing a direction from a rough coat rather than from the base, in proportion to
    /// what each reflects of all lanes, if both are requested.
    fn chance_of_coat<const N: usize>(&self, context: &ScatterContext<N>, reflected: &[[f64; 2]; N]) -> f64 {
        let requested_parts = self.requested_parts(context).map(f64::from);
        let [coat, base] =
            [0, 1].map(|part| requested_parts[part] * reflected.iter().map(|lane| lane[part]).sum::<f64>());
        if coat > 0.0 { coat / (coat + base) } else { 0.0 }
    }

    /// Evaluates each lane on the ray, for light that crosses the coat from directions of two cosines.
    fn lanes<T: Default, const N: usize>(
        &self,
        context: &ScatterContext<N>,
        cosines: [f64; 2],
        mut evaluate_lane: impl FnMut(&CoatLane<N>) -> T,
    ) -> [T; N] {
        let (index, base) = (context.draw.read_exact(&self.index), context.read(&self.reflectance));
        let local = self.coating.as_ref().map(|coating| coating.local(context, false));
        let missing = local.as_ref().and_then(|_| self.coat.missing_energy(cosines));
        let mut last = LastResult::NONE;
        std::array::from_fn(|i| {
            if context.present[i] == 0.0 {
                return T::default();
            }
            let indices = [context.incident_of(i), index[i]];
            let film = local.as_ref().map(|local| PlasticFilm::new(local, i, indices, missing.is_some()));
            let bare = last.get_or_make(indices, |indices| self.coat.transmittance(indices, cosines));
            let transmittance = film.as_ref().map_or(bare, |film| film.transmittance(&bare, missing.as_ref(), cosines));
            evaluate_lane(&CoatLane { transmittance, r: f64::from(base[i]), indices, film })
        })
    }

    /// Sets the Mueller matrix of the coat, which light crosses and is mirrored by. If it is rough and has a film, it
    /// is crossed like a smooth one.
    pub(super) fn mueller<const N: usize>(
        &self,
        context: &ScatterContext<N>,
        incoming: Incoming,
        mueller: &mut Mueller<N>,
    ) {
        let index = context.draw.read_exact(&self.index);
        let local = self.coating.as_ref().map(|coating| coating.local(context, false));
        let film = |lane: usize, cos: f64| {
            local.as_ref().map(|local| local.shares_at_cosine(lane, context.incident_of(lane), index[lane], cos))
        };
        let reflected = |lane: usize, cos: f64| match (film(lane, cos), [context.incident_of(lane), index[lane]]) {
            (Some(shares), _) => shares.reflected.block(),
            (None, [n1, n2]) => Block::at_boundary([n1, n2, cos], false),
        };
        let cos = context.wo.dot(context.normal);
        if incoming.single {
            // A rough coat has no single direction; this one belongs to a material that it is mixed with.
            if !self.coat.roughness().is_smooth() {
                return *mueller = Mueller::NONE;
            }
            let axis = context.wo.cross(context.normal);
            return mueller.set_lanes(axis, incoming.lanes, |lane| reflected(lane, cos));
        }
        let to = incoming.wi.dot(context.normal);
        if to <= 0.0 {
            return *mueller = Mueller::NONE;
        }
        match self.coat.roughness().surface() {
            None => *mueller = Mueller::NONE,
            Some(_) if !self.requested_parts(context)[0] => *mueller = Mueller::NONE,
            Some(surface) => {
                let Some(reflection) = surface.evaluate_at(context, incoming.wi) else {
                    return *mueller = Mueller::NONE;
                };
                let axis = context.wo.cross(incoming.wi);
                let facet = |lane| reflected(lane, reflection.cos).times(reflection.single);
                mueller.set_lanes(axis, incoming.lanes, facet);
            }
        }
        if !self.requested_parts(context)[1] {
            return;
        }
        let from = to_local_above(&Frame::about(context.normal), context.wo).z;
        mueller.base = Some(Box::new(self.polarized_base(context, [from, to], film)));
    }

    /// Returns the polarization of light that crosses the coat between directions of two cosines, that of the leaving
    /// light first. `film` returns what a film does to a lane at a cosine, if there is one.
    fn polarized_base<const N: usize>(
        &self,
        context: &ScatterContext<N>,
        [from, to]: [f64; 2],
        film: impl Fn(usize, f64) -> Option<StackShares>,
    ) -> Base<N> {
        let index = context.draw.read_exact(&self.index);
        let crossings = self.lanes(context, [from, to], |lane| {
            (lane.base() * to * FRAC_1_PI, [lane.transmittance.from, lane.transmittance.to])
        });
        let mut last = LastResult::NONE;
        let mut crossing_degree = |lane: usize, cos: f64, share: f64| {
            if context.present[lane] == 0.0 {
                return 0.0;
            }
            if let Some(shares) = film(lane, cos) {
                return shares.refracted.block().degree();
            }
            let local = ([context.incident_of(lane), index[lane]], cos);
            last.get_or_make(local, |(indices, cos)| self.coat.transmitted_degree(indices, cos, share))
        };
        let [leaving, arriving] = [(from, 0), (to, 1)].map(|(cos, way)| -> [f64; N] {
            std::array::from_fn(|lane| crossing_degree(lane, cos, crossings[lane].1[way]))
        });
        let base = |lane: usize| crossings[lane].0;
        Base {
            normal: context.normal,
            leaving: Lanes::from_fn(|i| (base(i) * leaving[i]) as f32),
            arriving: Lanes::from_fn(|i| (base(i) * arriving[i]) as f32),
            both: Lanes::from_fn(|i| (base(i) * leaving[i] * arriving[i]) as f32),
        }
    }

    /// Returns the degree for the coat, which light crosses and, if it is rough, is mirrored by:
    /// [`Scatter::degree_of_scattered`](super::Scatter::degree_of_scattered).
    pub(super) fn degree_of_scattered<const N: usize>(&self, context: &ScatterContext<N>, wi: DVec3) -> f32 {
        let index = context.draw.read_exact(&self.index);
        let lanes =
            || (0..N).filter(|&lane| index[lane] != context.incident_of(lane)).step_by(N.div_ceil(MAX_EVALUATED_LANES));
        let local = self.coating.as_ref().map(|coating| coating.local(context, false));
        let coat = |lane: usize, cos: f64| {
            let [n1, n2] = [context.incident_of(lane), index[lane]];
            match &local {
                None => {
                    let interface = Interface::new(n1, n2, cos);
                    [interface.polarization_reflected, interface.polarization_refracted]
                }
                Some(local) => {
                    let shares = local.shares_at_cosine(lane, n1, n2, cos);
                    [shares.reflected, shares.refracted].map(|share| share.degree())
                }
            }
            .map(f64::abs)
        };
        let crossing_degree = |lane: usize| {
            let cosines = [context.wo, wi].map(|direction| direction.dot(context.normal).abs());
            cosines.map(|cos| coat(lane, cos)[1]).into_iter().fold(0.0, f64::max)
        };
        let base = max_degree(lanes().map(crossing_degree));
        match (self.coat.roughness().is_smooth(), (context.wo + wi).try_normalize()) {
            (false, Some(h)) => {
                let mirrored = |lane: usize| coat(lane, context.wo.dot(h))[0];
                base.max(max_degree(lanes().map(mirrored)))
            }
            _ => base,
        }
    }
}

/// Coat and base, as a lane meets them.
struct CoatLane<'a, const N: usize> {
    /// Transmittance of the coat from two directions.
    transmittance: CoatTransmittance,
    /// Reflectance of the base.
    r: f64,
    /// Indices on both sides of the coat.
    indices: [f64; 2],
    film: Option<PlasticFilm<'a, N>>,
}

impl<const N: usize> CoatLane<'_, N> {
    /// Returns BRDF times pi of the base.
    fn base(&self) -> f64 {
        self.transmittance.base(self.r)
    }

    /// Returns the shares of the light from the first direction that the coat and the base reflect.
    fn reflected(&self) -> [f64; 2] {
        self.transmittance.reflected(self.r)
    }

    /// Returns BRDF times cosine of a rough coat.
    fn coat(&self, reflection: &RoughReflection) -> f64 {
        let (cos, [n1, n2]) = (reflection.cos, self.indices);
        let single = match &self.film {
            Some(film) => film.shares(cos).reflected.mean(),
            None => Interface::new(n1, n2, cos).reflectance,
        };
        single * reflection.single + self.transmittance.multiple * reflection.multiple
    }
}

/// Makes the branch of a direction in the surface's frame.
fn make_branch<const N: usize>(context: &ScatterContext<N>, wi: DVec3, share: [f64; N], pdf: f64) -> Branch<N> {
    let wi = unit(Frame::about(context.normal).to_world(wi));
    Branch::drawn(wi, Lanes::from_fn(|i| share[i] as f32), pdf)
}
