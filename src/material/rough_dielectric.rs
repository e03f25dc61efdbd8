//! A rough clear body, evaluated lane by lane.

use super::coated_boundary::{block_at, shares_at};
use super::coating::LocalCoating;
use super::rough_coating::{self, MissingEnergy};
use super::roughness::above;
use super::{
    Block, Branch, BsdfValue, Coating, Facet, FacetSample, FacetSides, Incoming, Interface, Mueller, RoughInterface,
    ScatterContext,
};
use crate::math::{DVec3, Frame, unit};
use crate::spectrum::{Lanes, Table};

/// Lanes part if their refracted rays differ by more than this many times the angle by which a facet as steep as alpha
/// turns them, since the lobe extends that far to both sides. In either case each lane gets its own light; only the
/// noise differs.
const WIDTHS: f64 = 2.0;

/// A rough surface where a ray meets it: the boundary of each lane, once for all lanes with the same refracting
/// indices. Lanes of one direction share the facets and the missing energy, and each reflects and transmits by its own
/// indices.
struct LaneBoundaries<'a, 'b, const N: usize> {
    context: &'a ScatterContext<'b, N>,
    frame: Frame,
    wo: DVec3,
    /// Each distinct boundary, and the lanes that meet it.
    kinds: Vec<Kind<'a, N>>,
    parts: bool,
    coating: Option<(&'a RoughInterface, LocalCoating<'a, N>)>,
    /// Cosine of the direction that was evaluated last, and whether it lies beyond the surface.
    cos: f64,
    crosses: bool,
}

/// Lanes that are refracted between the same two indices.
struct Kind<'a, const N: usize> {
    indices: [f64; 2],
    sides: FacetSides<'a>,
    present: Lanes<N>,
    count: f64,
    /// BSDF of these lanes in the direction that was evaluated last.
    flow: BsdfValue,
    /// Number of these lanes that count beyond the surface.
    crossing: f64,
}

impl<'a, 'b, const N: usize> LaneBoundaries<'a, 'b, N> {
    fn new(boundary: &'a RoughBoundary<'a>, context: &'a ScatterContext<'b, N>) -> Self {
        let interface = boundary.interface;
        let parts = parts(interface, context);
        let goes_on = if parts { context.draw.parting() } else { Lanes::ONE };
        let mut kinds: Vec<Kind<N>> = Vec::new();
        for lane in (0..N).filter(|&lane| context.present[lane] != 0.0) {
            let indices @ [n1, n2] = context.refracting(lane);
            if n1 == n2 {
                continue;
            }
            let known = kinds.iter().position(|kind| kind.indices == indices).unwrap_or_else(|| {
                let (sides, flow) = (interface.between(n1, n2), BsdfValue::default());
                kinds.push(Kind { indices, sides, present: Lanes::ZERO, count: 0.0, crossing: 0.0, flow });
                kinds.len() - 1
            });
            let kind = &mut kinds[known];
            kind.present.0[lane] = 1.0;
            kind.count += 1.0;
            kind.crossing += f64::from(goes_on[lane]);
        }
        let frame = Frame::about(context.normal);
        let coating = boundary.coating.map(|coating| (interface, coating.local(context, context.from_inside)));
        Self { context, wo: above(&frame, context.wo), frame, kinds, parts, coating, cos: 0.0, crosses: false }
    }

    /// Evaluates every kind of lanes in a direction above the surface or beyond it, and returns the mean of the
    /// densities with which they draw it. `drawn` is the kind that drew it, and the facet.
    fn ask(&mut self, wi: DVec3, drawn: Option<(usize, Facet)>) -> f64 {
        (self.cos, self.crosses) = (wi.z.abs(), wi.z < 0.0);
        let (mut pdf, mut lanes) = (0.0, 0.0);
        for (number, kind) in self.kinds.iter_mut().enumerate() {
            let count = kind.counted(self.crosses);
            if count == 0.0 {
                continue;
            }
            let facet = drawn.filter(|drawn| drawn.0 == number).map(|drawn| drawn.1);
            kind.flow = match self.crosses {
                true => kind.sides.crossed(self.wo, wi, facet),
                false => kind.sides.reflected(self.wo, wi, facet),
            };
            pdf += count * kind.flow.pdf;
            lanes += count;
        }
        if lanes > 0.0 { pdf / lanes } else { 0.0 }
    }

    /// Returns the kinds of lanes that continue in the direction that was evaluated last.
    fn going(&self) -> impl Iterator<Item = &Kind<'a, N>> {
        self.kinds.iter().filter(|kind| kind.counted(self.crosses) > 0.0)
    }

    /// Returns the lanes of such a kind that continue.
    fn lanes(&self, kind: &Kind<N>) -> Lanes<N> {
        if self.crosses && self.parts { kind.present * self.context.draw.parting() } else { kind.present }
    }

    /// Returns BSDF times cosine of all lanes in that direction, times a factor.
    fn light(&self, factor: f64) -> Lanes<N> {
        self.going().fold(Lanes::ZERO, |sum, kind| sum + self.light_of(kind, factor))
    }

    /// Returns BSDF times cosine of the lanes of a kind, each by its own indices, times a factor.
    fn light_of(&self, kind: &Kind<N>, factor: f64) -> Lanes<N> {
        let light = match &self.coating {
            Some((interface, local)) => self.coated(interface, local, kind, factor),
            None => self.bare(kind, factor),
        };
        self.lanes(kind) * light
    }

    /// Returns what a boundary without a coating scatters, whether or not a lane continues.
    fn bare(&self, kind: &Kind<N>, factor: f64) -> Lanes<N> {
        let (BsdfValue { value, facet, cos, .. }, crosses) = (kind.flow, self.crosses);
        let Some(own) = self.context.own_transmittance(cos) else {
            return Lanes::from_fn(|_| (value * factor) as f32);
        };
        let [here, beyond] = kind.indices;
        let of_ray = Interface::new(here, beyond, cos);
        // If less light of a lane crosses, more is reflected.
        let facet = if crosses { facet } else { -facet };
        Lanes::from_fn(|i| {
            // Radiance changes by the lane's own indices, while `value` contains the change by those of the ray.
            let ratio = (self.context.incident_of(i) / self.context.beyond_of(i)) * (beyond / here);
            let square = if crosses { ratio * ratio } else { 1.0 };
            ((value + (own[i] - of_ray.transmittance) * facet) * square * factor).max(0.0) as f32
        })
    }

    /// Returns what a coated boundary scatters.
    fn coated(&self, interface: &RoughInterface, local: &LocalCoating<N>, kind: &Kind<N>, factor: f64) -> Lanes<N> {
        let ([here, beyond], crosses) = (kind.indices, self.crosses);
        let kernels = interface.film_kernels(here, beyond);
        let missing = MissingEnergy::new(&kind.sides, kernels, [self.wo.z, self.cos], crosses);
        Lanes::from_fn(|lane| {
            if kind.present[lane] == 0.0 {
                return 0.0;
            }
            let shares = shares_at(local, self.context, lane, kind.flow.cos);
            let ratio = self.context.incident_of(lane) / self.context.beyond_of(lane);
            let square = if crosses { ratio * ratio } else { 1.0 };
            // The facets' part of radiance that crosses already contains the change by the ray's indices.
            let converted = if crosses { square * (beyond / here) * (beyond / here) } else { 1.0 };
            let single = converted * if crosses { shares.refracted.mean() } else { shares.reflected.mean() };
            let averages = rough_coating::averages(local, self.context, lane);
            (factor * missing.value(&averages, &kind.flow, single, square)) as f32
        })
    }

    /// Returns the direction in world space, or None if rounding has put it on the wrong side.
    fn to_world(&self, wi: DVec3) -> Option<DVec3> {
        let world = unit(self.frame.to_world(wi));
        (world.dot(self.context.normal) * wi.z > 0.0).then_some(world)
    }
}

impl<const N: usize> Kind<'_, N> {
    /// Returns how many of its lanes count for a direction on a side.
    fn counted(&self, crosses: bool) -> f64 {
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
        let [here, beyond] = context.refracting(i);
        here / beyond
    };
    let counts = |&i: &usize| context.draw.shares(false)[i] != 0.0;
    let (least, most) =
        (0..N).filter(counts).map(ratio).fold((f64::INFINITY, 0.0_f64), |(l, m), x| (l.min(x), m.max(x)));
    let (cos, middle) = (context.wo.dot(context.normal).clamp(0.0, 1.0), 0.5 * (least + most));
    let sin = (middle * (1.0 - cos * cos).sqrt()).min(1.0);
    let turned = (middle * cos - (1.0 - sin * sin).sqrt()).abs();
    sin * (most - least) / middle > WIDTHS * interface.facets().alpha() * turned
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
    /// Adds one branch by reflection, and one by refraction: where lanes part, one for each kind of lanes.
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
        let mut meeting = LaneBoundaries::new(self, context);
        let total: f64 = meeting.kinds.iter().map(|kind| kind.count).sum();
        let mut at = u[0] * total;
        let chosen = meeting.kinds.iter().position(|kind| {
            let here = at < kind.count;
            at -= if here { 0.0 } else { kind.count };
            here
        });
        let Some(chosen) = chosen.or(meeting.kinds.len().checked_sub(1)) else { return };
        let kind = &meeting.kinds[chosen];
        let u = [(at / kind.count).min(1.0 - f64::EPSILON), u[1]];
        let [reflected, crossed] = kind.sides.draw(meeting.wo, u);
        let drawn = if meeting.parts { 0..meeting.kinds.len() } else { chosen..chosen + 1 };
        for number in drawn {
            let kind = &meeting.kinds[number];
            let [n1, n2] = kind.indices;
            let way = if number == chosen { crossed } else { kind.sides.draw(meeting.wo, u)[1] };
            let (Some(FacetSample { wi, facet }), true) = (way, kind.crossing > 0.0) else { continue };
            let Some(world) = meeting.to_world(wi) else { continue };
            let pdf = meeting.ask(wi, facet.map(|facet| (number, facet)));
            let share = if meeting.parts {
                let kind = &meeting.kinds[number];
                meeting.light_of(kind, 1.0 / kind.flow.pdf)
            } else {
                meeting.light(1.0 / pdf)
            };
            if pdf > 0.0 && !(share * tint).is_zero() {
                let eta_scale = (n1 / n2) * (n1 / n2);
                branches.push(Branch { crosses: true, eta_scale, ..Branch::drawn(world, share * tint, pdf) });
            }
        }
        if let Some(FacetSample { wi, facet }) = reflected
            && let Some(world) = meeting.to_world(wi)
        {
            let pdf = meeting.ask(wi, facet.map(|facet| (chosen, facet)));
            let share = meeting.light(1.0 / pdf) * reflectance;
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
        let is_same = |i: usize| {
            let [here, beyond] = context.refracting(i);
            here == beyond
        };
        let same = Lanes::from_fn(|i| if is_same(i) { context.present[i] } else { 0.0 });
        if same.is_zero() {
            return;
        }
        let parting = if parts(self.interface, context) { context.draw.parting() } else { Lanes::ONE };
        let share = same * tint * parting;
        let wi = -context.wo;
        branches.push(Branch { wi, share, pdf: None, crosses: true, eta_scale: 1.0, polarization: 0.0 });
    }

    /// Sets the Mueller matrix of the facet that reflects or refracts the light of each kind of lanes. What meets a
    /// second facet leaves unpolarized.
    pub(super) fn mueller<const N: usize>(
        &self,
        context: &ScatterContext<N>,
        incoming: Incoming,
        mueller: &mut Mueller<N>,
    ) {
        let context = &ScatterContext { present: Lanes::one_in(incoming.lanes), ..*context };
        let mut meeting = LaneBoundaries::new(self, context);
        if meeting.ask(meeting.frame.to_local(incoming.wi), None) <= 0.0 {
            return *mueller = Mueller::NONE;
        }
        let crosses = meeting.crosses;
        let tint = context.read(self.factor(crosses));
        *mueller = Mueller { axis: context.wo.cross(incoming.wi), ..Mueller::NONE };
        for kind in meeting.going() {
            let lanes = meeting.lanes(kind);
            for lane in (0..N).filter(|&lane| lanes[lane] != 0.0) {
                let block = match &meeting.coating {
                    None => Block::at_boundary(context.own_boundary(lane, kind.flow.cos), crosses),
                    Some((_, local)) => block_at(local, context, lane, kind.flow.cos, crosses),
                };
                // The facets' part of radiance that crosses already contains the change by the ray's indices.
                let [here, beyond] = kind.indices;
                let square = if crosses { (beyond / here) * (beyond / here) } else { 1.0 };
                mueller.block.set(lane, block.times(kind.flow.facet * square * f64::from(tint[lane])));
            }
        }
    }

    /// Returns BSDF times cosine of each lane, and the density of `wi` among the branches on its side.
    pub(super) fn evaluate<const N: usize>(&self, context: &ScatterContext<N>, wi: DVec3) -> Option<(Lanes<N>, f64)> {
        let mut meeting = LaneBoundaries::new(self, context);
        let local = meeting.frame.to_local(wi);
        let pdf = if local.z == 0.0 { 0.0 } else { meeting.ask(local, None) };
        (pdf > 0.0).then(|| (meeting.light(1.0) * context.read(self.factor(meeting.crosses)), pdf))
    }

    fn factor(&self, crosses: bool) -> &Table {
        if crosses { self.transmittance } else { self.reflectance }
    }
}
