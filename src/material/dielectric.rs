use super::coated_boundary::{self, block_at};
use super::last_result::LastResult;
use super::refractions::Refractions;
use super::rough_dielectric::{RoughBoundary, parts};
use super::{
    Block, Branch, Coating, Incoming, Interface, Mueller, RoughInterface, Roughness, ScatterContext, reflect,
    shared_transmittance,
};
use crate::math::DVec3;
use crate::spectrum::{Draw, Lanes, Quantity, Table};

/// A clear body, smooth or rough. Light is reflected and refracted by Snell's law and Fresnel's equations. The facets
/// of a rough surface do so: see [`RoughInterface`](super::RoughInterface).
///
/// The body fills the space behind its surface's front. The classic tracer's {r, t, g, n} are its reflectance,
/// transmittance, emission and index. Its emission shines from both sides of the surface. Only paths that hit the
/// surface find it, since it is never sampled as a light: a lamp is `emissive`.
///
/// ```toml
/// dielectric = { index = "N-SF11" }
/// dielectric = { index = { rgb = [1.513, 1.517, 1.523] }, transmittance = { rgb = [0.9, 1, 0.9] }, absorption = 0.2 }
/// dielectric = { index = "N-BK7", roughness = 0.3 }     # 0 to 1; 0, smooth, if absent
/// dielectric = { index = "N-BK7", coating = [{ index = 1.38, thickness_nm = 99.6 }] }     # from the outside inward
/// ```
#[derive(Clone, Debug)]
pub struct Dielectric<S> {
    /// Refractive index.
    pub index: S,
    /// Factor on the reflected light.
    pub reflectance: S,
    /// Factor on the refracted light.
    pub transmittance: S,
    /// Radiance of the surface itself.
    pub emission: S,
    /// Absorption coefficient inside, per scene unit, base e (Beer 1852).
    pub absorption: S,
    /// Where bodies overlap, the one of higher priority fills the space; of equal ones, the one whose material is used
    /// later in the file. Bodies of one material merge.
    pub priority: i32,
    /// Roughness of its surface; below 0.01 the surface counts as smooth.
    pub roughness: Roughness,
    /// Thin layers on its surface in which light interferes.
    pub coating: Option<Coating<S>>,
}

impl<S> Dielectric<S> {
    pub(super) fn map<T>(&self, convert: &mut impl FnMut(Quantity, &S) -> T) -> Dielectric<T> {
        Dielectric {
            index: convert(Quantity::Index, &self.index),
            reflectance: convert(Quantity::Reflectance, &self.reflectance),
            transmittance: convert(Quantity::Transmittance, &self.transmittance),
            emission: convert(Quantity::Emission, &self.emission),
            absorption: convert(Quantity::Absorption, &self.absorption),
            priority: self.priority,
            roughness: self.roughness.clone(),
            coating: self.coating.as_ref().map(|coating| coating.map(convert)),
        }
    }
}

impl Dielectric<Table> {
    /// Samples directions backward from the viewer and adds them to `branches`.
    pub(super) fn scatter<const N: usize>(
        &self,
        context: &ScatterContext<N>,
        u: [f64; 2],
        branches: &mut Vec<Branch<N>>,
    ) {
        match (self.roughness.interface(), &self.coating) {
            (Some(interface), _) => self.rough_boundary(interface).scatter(context, u, branches),
            (None, Some(coating)) => {
                coated_boundary::scatter(coating, [&self.reflectance, &self.transmittance], context, branches);
            }
            (None, None) => match context.one_direction() {
                Some(directions) => self.scatter_in_one_direction(context, directions, branches),
                None => self.scatter_smooth(context, branches),
            },
        }
    }

    pub(super) fn evaluate<const N: usize>(&self, context: &ScatterContext<N>, wi: DVec3) -> Option<(Lanes<N>, f64)> {
        self.rough_boundary(self.roughness.interface()?).evaluate(context, wi)
    }

    fn rough_boundary<'a>(&'a self, interface: &'a RoughInterface) -> RoughBoundary<'a> {
        let (reflectance, transmittance) = (&self.reflectance, &self.transmittance);
        RoughBoundary { interface, coating: self.coating.as_ref(), reflectance, transmittance }
    }

    /// Returns whether lanes that cross the surface part there: a pure function of the surface and the arriving light.
    pub(super) fn parts<const N: usize>(&self, context: &ScatterContext<N>) -> bool {
        match self.roughness.interface() {
            Some(interface) => parts(interface, context),
            None => context.parts(),
        }
    }

    /// Returns the degree for the facet of rough glass that light from `wi` meets: Walter et al. 2007, *Microfacet
    /// Models for Refraction through Rough Surfaces*, equations 13 and 16.
    pub(super) fn degree_of_scattered<const N: usize>(&self, context: &ScatterContext<N>, wi: DVec3) -> f32 {
        let (mut last, mut max_degree) = (None, 0.0_f64);
        let local = self.coating.as_ref().map(|coating| coating.local(context, context.from_inside));
        for lane in 0..N {
            let pair @ [n1, n2] = [context.incident_of(lane), context.beyond_of(lane)];
            if n1 == n2 || (last.replace(pair) == Some(pair) && local.is_none()) {
                continue;
            }
            let crosses = wi.dot(context.normal) < 0.0;
            let h = if crosses { (context.wo * n1 + wi * n2) * (n1 - n2).signum() } else { context.wo + wi };
            let Some(h) = h.try_normalize() else { continue };
            if let Some(local) = &local {
                let shares = local.shares_at_cosine(lane, n1, n2, context.wo.dot(h));
                let share = if crosses { shares.refracted } else { shares.reflected };
                max_degree = max_degree.max(share.degree());
                continue;
            }
            let facet = Interface::new(n1, n2, context.wo.dot(h));
            let degree = if crosses { facet.polarization_refracted } else { facet.polarization_reflected };
            max_degree = max_degree.max(degree.abs());
        }
        max_degree as f32
    }

    /// Adds one reflected branch with all lanes, and one refracted branch per distinct pair of refracting indices. If
    /// the pairs differ, lanes part and only those of `Draw::parting` continue. Lanes that share a direction have their
    /// own Fresnel shares.
    fn scatter_smooth<const N: usize>(&self, context: &ScatterContext<N>, branches: &mut Vec<Branch<N>>) {
        let [tint, reflectance] = [&self.transmittance, &self.reflectance].map(|table| context.read_tint(table));
        let parts = context.parts();
        let crossing = if parts { tint * context.draw.parting() } else { tint };
        let cos = context.wo.dot(context.normal);
        let (mut reflected, mut polarization) = (Lanes::ZERO, 0.0);
        let (mut refracted, mut last) = (Refractions::new(context, parts, branches), LastResult::NONE);
        let own = context.own_transmittance(cos);
        for lane in (0..N).filter(|&lane| context.present[lane] != 0.0) {
            let pair @ [here, beyond] = context.ray_indices(lane);
            let [n1, n2] = [context.incident_of(lane), context.beyond_of(lane)];
            let interface = last.get_or_make(pair, |[here, beyond]| Interface::new(here, beyond, cos));
            let [reflects, lets_through] = match &own {
                Some(own) if here != beyond || n1 != n2 => [1.0 - own[lane], own[lane]],
                _ => [interface.reflectance, interface.transmittance],
            };
            let weight = context.present[lane];
            reflected.0[lane] = weight * reflectance[lane] * reflects as f32;
            polarization = interface.polarization_reflected.abs().max(polarization);
            let crosses = weight * crossing[lane];
            if lets_through == 0.0 || crosses == 0.0 {
                continue;
            }
            let branch = refracted.branch(pair, || interface);
            branch.polarization = branch.polarization.max(interface.polarization_refracted.abs() as f32);
            branch.share.0[lane] = crosses * (lets_through * ((n1 / n2) * (n1 / n2))) as f32;
        }
        if !reflected.is_zero() {
            branches.push(Branch::mirrored(context, reflected, polarization as f32));
        }
    }

    /// Adds one reflected and one refracted branch, in which each lane has its own shares.
    fn scatter_in_one_direction<const N: usize>(
        &self,
        context: &ScatterContext<N>,
        [here, beyond]: [f64; 2],
        branches: &mut Vec<Branch<N>>,
    ) {
        let [tint, reflectance] = [&self.transmittance, &self.reflectance].map(|table| context.read_tint(table));
        let cos = context.wo.dot(context.normal);
        let [n1, n2] = &context.indices();
        let mut push = |wi, share: Lanes<N>, crosses, eta_scale, polarization: f64| {
            let (share, polarization) = (share * context.present, polarization.abs() as f32);
            if !share.is_zero() {
                branches.push(Branch { wi, share, pdf: None, crosses, eta_scale, polarization });
            }
        };
        // Between equal indices nothing happens at all, even at grazing incidence.
        let straight = here == beyond;
        if straight && n1 == n2 {
            push(-context.wo, tint, true, 1.0, 0.0);
            return;
        }
        let interface = Interface::new(here, beyond, cos);
        let crossing = shared_transmittance([n1, n2], [here, beyond], cos);
        if interface.transmittance > 0.0 {
            let wi = if straight { -context.wo } else { interface.refract(context.wo, context.normal) };
            let eta_scale = (here / beyond) * (here / beyond);
            let square = |i: usize| (n1[i] / n2[i]) * (n1[i] / n2[i]);
            let share = tint * Lanes::from_fn(|i| (crossing[i] * square(i)) as f32);
            push(wi, share, true, eta_scale, interface.polarization_refracted);
        }
        let share = reflectance * Lanes::from_fn(|i| (1.0 - crossing[i]) as f32);
        let wi = reflect(context.wo, context.normal);
        push(wi, share, false, 1.0, interface.polarization_reflected);
    }

    /// Sets the Mueller matrix of the surface, or of the facet that light meets.
    pub(super) fn mueller<const N: usize>(
        &self,
        context: &ScatterContext<N>,
        incoming: Incoming,
        mueller: &mut Mueller<N>,
    ) {
        match self.roughness.interface() {
            Some(interface) if !incoming.single => self.rough_boundary(interface).mueller(context, incoming, mueller),
            Some(_) => mueller.set_unchanged(context.present * context.read(&self.transmittance)),
            None => self.mueller_of_smooth(context, incoming, mueller),
        }
    }

    fn mueller_of_smooth<const N: usize>(
        &self,
        context: &ScatterContext<N>,
        incoming: Incoming,
        mueller: &mut Mueller<N>,
    ) {
        let crosses = incoming.crosses;
        let table = if crosses { &self.transmittance } else { &self.reflectance };
        let tint = context.read_tint(table);
        let (axis, cos) = (context.wo.cross(context.normal), context.wo.dot(context.normal));
        if let Some(coating) = &self.coating {
            let local = coating.local(context, context.from_inside);
            return mueller.set_lanes(axis, incoming.lanes, |lane| {
                block_at(&local, context, lane, cos, crosses).times(f64::from(tint[lane]))
            });
        }
        let mut last = LastResult::NONE;
        mueller.set_lanes(axis, incoming.lanes, |lane| {
            let block =
                last.get_or_make(context.own_boundary(lane, cos), |boundary| Block::at_boundary(boundary, crosses));
            block.times(f64::from(tint[lane]))
        });
    }

    fn is_clear(&self) -> bool {
        self.absorption.is_flat() && self.absorption.bins()[0] == 0.0
    }

    /// Returns the transmittance of each lane over a distance inside, e^(-absorption * distance).
    pub fn transmission<const N: usize>(&self, draw: &Draw<N>, distance: f64) -> Lanes<N> {
        if self.is_clear() {
            return Lanes::ONE;
        }
        let absorption = draw.read_exact(&self.absorption);
        Lanes::from_fn(|i| if absorption[i] == 0.0 { 1.0 } else { libm::exp(-absorption[i] * distance) as f32 })
    }
}
