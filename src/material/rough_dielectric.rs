//! A rough clear body, evaluated lane by lane.

use super::coated_boundary::{block_at, shares_at};
use super::coating::LocalCoating;
use super::rough_coating::{self, MissingEnergy};
use super::roughness::to_local_above;
use super::{
    Block, Branch, BsdfValue, Coating, Facet, FacetSample, FacetSides, Incoming, Interface, Mueller, RoughInterface,
    ScatterContext,
};
use crate::math::{DVec3, Frame, unit};
use crate::spectrum::{Lanes, Table};

/// Lanes part if their refracted rays differ by more than this many times the angle by which a facet as steep as alpha
/// turns them, since the lobe extends that far to both sides. In either case each lane gets its own light; only the
/// noise differs.
const PARTING_WIDTHS: f64 = 2.0;

/// A rough surface where a ray meets it: the boundary of each lane, once for all lanes with the same refracting
/// indices. Lanes of one direction share the facets and the missing energy, and each reflects and transmits by its own
/// indices.
struct LaneBoundaries<'a, 'b, const N: usize> {
    context: &'a ScatterContext<'b, N>,
    frame: Frame,
    wo: DVec3,
    /// Each distinct boundary, and the lanes that meet it.
    groups: Vec<LaneGroup<'a, N>>,
    parts: bool,
    coating: Option<(&'a RoughInterface, LocalCoating<'a, N>)>,
    /// Cosine of the direction that was evaluated last, and whether it lies beyond the surface.
    cos: f64,
    crosses: bool,
}

/// Lanes that are refracted between the same two indices.
struct LaneGroup<'a, const N: usize> {
    indices: [f64; 2],
    sides: FacetSides<'a>,
    present: Lanes<N>,
    count: f64,
    /// BSDF of these lanes in the direction that was evaluated last.
    bsdf: BsdfValue,
    /// Number of these lanes that count beyond the surface.
    crossing: f64,
}

impl<'a, 'b, const N: usize> LaneBoundaries<'a, 'b, N> {
    fn new(boundary: &'a RoughBoundary<'a>, context: &'a ScatterContext<'b, N>) -> Self {
        let interface = boundary.interface;
        let parts = parts(interface, context);
        let continuing = if parts { context.draw.parting() } else { Lanes::ONE };
        let mut groups: Vec<LaneGroup<N>> = Vec::new();
        for lane in (0..N).filter(|&lane| context.present[lane] != 0.0) {
            let indices @ [n1, n2] = context.ray_indices(lane);
            if n1 == n2 {
                continue;
            }
            let index = groups.iter().position(|group| group.indices == indices).unwrap_or_else(|| {
                let (sides, bsdf) = (interface.between(n1, n2), BsdfValue::default());
                groups.push(LaneGroup { indices, sides, present: Lanes::ZERO, count: 0.0, crossing: 0.0, bsdf });
                groups.len() - 1
            });
            let group = &mut groups[index];
            group.present.0[lane] = 1.0;
            group.count += 1.0;
            group.crossing += f64::from(continuing[lane]);
        }
        let frame = Frame::about(context.normal);
        let coating = boundary.coating.map(|coating| (interface, coating.local(context, context.from_inside)));
        Self {
            context,
            wo: to_local_above(&frame, context.wo),
            frame,
            groups,
            parts,
            coating,
            cos: 0.0,
            crosses: false,
        }
    }

    /// Evaluates every group of lanes in a direction above the surface or beyond it, and returns the mean of the
    /// densities with which they draw it. `drawn` is the group that drew it, and the facet.
    fn evaluate_groups(&mut self, wi: DVec3, drawn: Option<(usize, Facet)>) -> f64 {
        (self.cos, self.crosses) = (wi.z.abs(), wi.z < 0.0);
        let (mut pdf, mut lanes) = (0.0, 0.0);
        for (number, group) in self.groups.iter_mut().enumerate() {
            let count = group.lane_count(self.crosses);
            if count == 0.0 {
                continue;
            }
            let facet = drawn.filter(|drawn| drawn.0 == number).map(|drawn| drawn.1);
            group.bsdf = match self.crosses {
                true => group.sides.crossed(self.wo, wi, facet),
                false => group.sides.reflected(self.wo, wi, facet),
            };
            pdf += count * group.bsdf.pdf;
            lanes += count;
        }
        if lanes > 0.0 { pdf / lanes } else { 0.0 }
    }

    /// Returns the groups of lanes that continue in the direction that was evaluated last.
    fn continuing_groups(&self) -> impl Iterator<Item = &LaneGroup<'a, N>> {
        self.groups.iter().filter(|group| group.lane_count(self.crosses) > 0.0)
    }

    /// Returns the lanes of such a group that continue.
    fn lanes(&self, group: &LaneGroup<N>) -> Lanes<N> {
        if self.crosses && self.parts { group.present * self.context.draw.parting() } else { group.present }
    }

    /// Returns BSDF times cosine of all lanes in that direction, times a factor.
    fn light(&self, factor: f64) -> Lanes<N> {
        self.continuing_groups().fold(Lanes::ZERO, |sum, group| sum + self.group_light(group, factor))
    }

    /// Returns BSDF times cosine of the lanes of a kind, each by its own indices, times a factor.
    fn group_light(&self, group: &LaneGroup<N>, factor: f64) -> Lanes<N> {
        let light = match &self.coating {
            Some((interface, local)) => self.coated_light(interface, local, group, factor),
            None => self.bare_light(group, factor),
        };
        self.lanes(group) * light
    }

    /// Returns what a boundary without a coating scatters, whether or not a lane continues.
    fn bare_light(&self, group: &LaneGroup<N>, factor: f64) -> Lanes<N> {
        let (BsdfValue { value, facet, cos, .. }, crosses) = (group.bsdf, self.crosses);
        let Some(own) = self.context.own_transmittance(cos) else {
            return Lanes::from_fn(|_| (value * factor) as f32);
        };
        let [here, beyond] = group.indices;
        let ray_interface = Interface::new(here, beyond, cos);
        // If less light of a lane crosses, more is reflected.
        let facet = if crosses { facet } else { -facet };
        Lanes::from_fn(|i| {
            // Radiance changes by the lane's own indices, while `value` contains the change by those of the ray.
            let ratio = (self.context.incident_of(i) / self.context.beyond_of(i)) * (beyond / here);
            let square = if crosses { ratio * ratio } else { 1.0 };
            ((value + (own[i] - ray_interface.transmittance) * facet) * square * factor).max(0.0) as f32
        })
    }

    /// Returns what a coated boundary scatters.
    fn coated_light(
        &self,
        interface: &RoughInterface,
        local: &LocalCoating<N>,
        group: &LaneGroup<N>,
        factor: f64,
    ) -> Lanes<N> {
        let ([here, beyond], crosses) = (group.indices, self.crosses);
        let kernels = interface.film_kernels(here, beyond);
        let missing = MissingEnergy::new(&group.sides, kernels, [self.wo.z, self.cos], crosses);
        Lanes::from_fn(|lane| {
            if group.present[lane] == 0.0 {
                return 0.0;
            }
            let shares = shares_at(local, self.context, lane, group.bsdf.cos);
            let ratio = self.context.incident_of(lane) / self.context.beyond_of(lane);
            let square = if crosses { ratio * ratio } else { 1.0 };
            // The facets' part of radiance that crosses already contains the change by the ray's indices.
            let conversion = if crosses { square * (beyond / here) * (beyond / here) } else { 1.0 };
            let single = conversion * if crosses { shares.refracted.mean() } else { shares.reflected.mean() };
            let averages = rough_coating::averages(local, self.context, lane);
            (factor * missing.value(&averages, &group.bsdf, single, square)) as f32
        })
    }

    /// Returns the direction in world space, or None if rounding has put it on the wrong side.
    fn to_world(&self, wi: DVec3) -> Option<DVec3> {
        let world = unit(self.frame.to_world(wi));
        (world.dot(self.context.normal) * wi.z > 0.0).then_some(world)
    }
}

impl<const N: usize> LaneGroup<'_, N> {
    /// Returns how many of its lanes count for a direction on a side.
    fn lane_count(&self, crosses: bool) -> f64 {
        if crosses { self.crossing } else { self.count }
    }
}

/// Returns whether lanes that cross a rough surface take different directions. While their lobes overlap they stay
/// together.
///
/// The refracted ray turns by sin t dr / (r cos t) if the ratio of the indices, r, changes by dr, and by
/// |r cos i - cos t| / cos t times the angle by which a facet turns. Only the lanes that count while they are together
/// decide; if there are heroes, these are the fixed lanes. If wavelengths drawn at random decided whether they count,
/// some would count more often than others.
pub(super) fn parts<const N: usize>(interface: &RoughInterface, context: &ScatterContext<N>) -> bool {
    if !context.parts() {
        return false;
    }
    let ratio = |i: usize| {
        let [here, beyond] = context.ray_indices(i);
        here / beyond
    };
    let counts = |&i: &usize| context.draw.shares(false)[i] != 0.0;
    let (min_ratio, max_ratio) =
        (0..N).filter(counts).map(ratio).fold((f64::INFINITY, 0.0_f64), |(l, m), x| (l.min(x), m.max(x)));
    let (cos, middle) = (context.wo.dot(context.normal).clamp(0.0, 1.0), 0.5 * (min_ratio + max_ratio));
    let sin = (middle * (1.0 - cos * cos).sqrt()).min(1.0);
    let turned = (middle * cos - (1.0 - sin * sin).sqrt()).abs();
    sin * (max_ratio - min_ratio) / middle > PARTING_WIDTHS * interface.facets().alpha() * turned
}

/// A rough surface of a clear body.
pub(super) struct RoughBoundary<'a> {
    pub(super) interface: &'a RoughInterface,
    pub(super) coating: Option<&'a Coating<Table>>,
    /// Factors on the reflected and the transmitted light.
    pub(super) reflectance: &'a Table,
    pub(super) transmittance: &'a Table,
}

impl RoughBoundary<'_> {
    /// Adds one branch by reflection, and one by refraction: where lanes part, one for each group of lanes.
    ///
    /// Lanes that are together share a direction drawn for one of them, chosen uniformly, and each is divided by the
    /// mean of all their densities (the balance heuristic, Veach & Guibas 1995; Wilkie et al. 2014). Each branch has a
    /// density of its own, which integrates to the probability that it is drawn. Next-event estimation weights a
    /// direction by the same function, `evaluate`, so that the two weights sum to 1 in every direction. This holds for
    /// any number of branches that the tracer follows, since one that is chosen with a probability is divided by it.
    pub(super) fn scatter<const N: usize>(
        &self,
        context: &ScatterContext<N>,
        u: [f64; 2],
        branches: &mut Vec<Branch<N>>,
    ) {
        let (tint, reflectance) = (context.read(self.transmittance), context.read(self.reflectance));
        if context.lobes.has_delta() {
            self.pass_equal_indices(context, tint, branches);
        }
        let mut boundaries = LaneBoundaries::new(self, context);
        let total: f64 = boundaries.groups.iter().map(|group| group.count).sum();
        let mut at = u[0] * total;
        let chosen = boundaries.groups.iter().position(|group| {
            let here = at < group.count;
            at -= if here { 0.0 } else { group.count };
            here
        });
        let Some(chosen) = chosen.or(boundaries.groups.len().checked_sub(1)) else { return };
        let group = &boundaries.groups[chosen];
        let u = [(at / group.count).min(1.0 - f64::EPSILON), u[1]];
        let [reflected, crossed] = group.sides.draw(boundaries.wo, u);
        let drawn = if boundaries.parts { 0..boundaries.groups.len() } else { chosen..chosen + 1 };
        for number in drawn {
            let group = &boundaries.groups[number];
            let [n1, n2] = group.indices;
            let sample = if number == chosen { crossed } else { group.sides.draw(boundaries.wo, u)[1] };
            let (Some(FacetSample { wi, facet }), true) = (sample, group.crossing > 0.0) else { continue };
            let Some(world) = boundaries.to_world(wi) else { continue };
            let pdf = boundaries.evaluate_groups(wi, facet.map(|facet| (number, facet)));
            let share = if boundaries.parts {
                let group = &boundaries.groups[number];
                boundaries.group_light(group, 1.0 / group.bsdf.pdf)
            } else {
                boundaries.light(1.0 / pdf)
            };
            if pdf > 0.0 && !(share * tint).is_zero() {
                let eta_scale = (n1 / n2) * (n1 / n2);
                branches.push(Branch { crosses: true, eta_scale, ..Branch::drawn(world, share * tint, pdf) });
            }
        }
        if let Some(FacetSample { wi, facet }) = reflected
            && let Some(world) = boundaries.to_world(wi)
        {
            let pdf = boundaries.evaluate_groups(wi, facet.map(|facet| (chosen, facet)));
            let share = boundaries.light(1.0 / pdf) * reflectance;
            if pdf > 0.0 && !share.is_zero() {
                branches.push(Branch::drawn(world, share, pdf));
            }
        }
    }

    /// Adds the light that passes straight through between equal indices.
    fn pass_equal_indices<const N: usize>(
        &self,
        context: &ScatterContext<N>,
        tint: Lanes<N>,
        branches: &mut Vec<Branch<N>>,
    ) {
        let has_equal_indices = |i: usize| {
            let [here, beyond] = context.ray_indices(i);
            here == beyond
        };
        let same = Lanes::from_fn(|i| if has_equal_indices(i) { context.present[i] } else { 0.0 });
        if same.is_zero() {
            return;
        }
        let parting = if parts(self.interface, context) { context.draw.parting() } else { Lanes::ONE };
        let share = same * tint * parting;
        let wi = -context.wo;
        branches.push(Branch { wi, share, pdf: None, crosses: true, eta_scale: 1.0, polarization: 0.0 });
    }

    /// Sets the Mueller matrix of the facet that reflects or refracts the light of each group of lanes. What meets a
    /// second facet leaves unpolarized.
    pub(super) fn mueller<const N: usize>(
        &self,
        context: &ScatterContext<N>,
        incoming: Incoming,
        mueller: &mut Mueller<N>,
    ) {
        let context = &ScatterContext { present: Lanes::mask_of(incoming.lanes), ..*context };
        let mut boundaries = LaneBoundaries::new(self, context);
        if boundaries.evaluate_groups(boundaries.frame.to_local(incoming.wi), None) <= 0.0 {
            return *mueller = Mueller::NONE;
        }
        let crosses = boundaries.crosses;
        let tint = context.read(self.factor(crosses));
        *mueller = Mueller { axis: context.wo.cross(incoming.wi), ..Mueller::NONE };
        for group in boundaries.continuing_groups() {
            let lanes = boundaries.lanes(group);
            for lane in (0..N).filter(|&lane| lanes[lane] != 0.0) {
                let block = match &boundaries.coating {
                    None => Block::at_boundary(context.own_boundary(lane, group.bsdf.cos), crosses),
                    Some((_, local)) => block_at(local, context, lane, group.bsdf.cos, crosses),
                };
                // The facets' part of radiance that crosses already contains the change by the ray's indices.
                let [here, beyond] = group.indices;
                let square = if crosses { (beyond / here) * (beyond / here) } else { 1.0 };
                mueller.block.set(lane, block.times(group.bsdf.facet * square * f64::from(tint[lane])));
            }
        }
    }

    /// Returns BSDF times cosine of each lane, and the density of `wi` among the branches on its side.
    pub(super) fn evaluate<const N: usize>(&self, context: &ScatterContext<N>, wi: DVec3) -> Option<(Lanes<N>, f64)> {
        let mut boundaries = LaneBoundaries::new(self, context);
        let local = boundaries.frame.to_local(wi);
        let pdf = if local.z == 0.0 { 0.0 } else { boundaries.evaluate_groups(local, None) };
        (pdf > 0.0).then(|| (boundaries.light(1.0) * context.read(self.factor(boundaries.crosses)), pdf))
    }

    fn factor(&self, crosses: bool) -> &Table {
        if crosses { self.transmittance } else { self.reflectance }
    }
}
