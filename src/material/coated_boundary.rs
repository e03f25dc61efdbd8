//! The smooth coated surface of a clear body, evaluated lane by lane.

use super::coating::LocalCoating;
use super::fresnel::SharedRay;
use super::polarization_degree::combined_degree;
use super::refractions::Refractions;
use super::stack::StackShares;
use super::{Block, Branch, Coating, Interface, ScatterContext};
use crate::spectrum::{Lanes, Table};

/// Adds one reflected branch, and one refracted branch for each distinct pair of refracting indices. The directions are
/// those of the bare surface, since layers with flat faces turn no ray. `factors` apply to the reflected and the
/// transmitted light.
pub(super) fn scatter<const N: usize>(
    coating: &Coating<Table>,
    factors: [&Table; 2],
    context: &ScatterContext<N>,
    branches: &mut Vec<Branch<N>>,
) {
    let ([reflectance, tint], parts) = (factors.map(|table| context.read(table)), context.parts());
    let crossing = if parts { tint * context.draw.parting() } else { tint };
    let (local, cos) = (coating.local(context, context.from_inside), context.wo.dot(context.normal));
    let (mut reflected, mut lane_shares) = (Lanes::ZERO, [[[0.0; 2]; 2]; N]);
    let first = branches.len();
    let mut refracted = Refractions::new(context, parts, branches);
    for lane in (0..N).filter(|&lane| context.present[lane] != 0.0) {
        let pair @ [here, beyond] = context.ray_indices(lane);
        let StackShares { reflected: r, refracted: t } = shares_at(&local, context, lane, cos);
        reflected.0[lane] = context.present[lane] * reflectance[lane] * r.mean() as f32;
        lane_shares[lane] = [[r.s, r.p], [t.s, t.p]];
        let crosses = context.present[lane] * crossing[lane];
        if t.mean() == 0.0 || crosses == 0.0 {
            continue;
        }
        let ratio = context.incident_of(lane) / context.beyond_of(lane);
        let branch = refracted.branch(pair, || Interface::new(here, beyond, cos));
        branch.share.0[lane] = crosses * (t.mean() * (ratio * ratio)) as f32;
    }
    let degree = |share: &Lanes<N>, way: usize| {
        let lit_lanes = (0..N).filter(|&lane| share[lane] != 0.0);
        combined_degree(lit_lanes.map(|lane| lane_shares[lane][way])) as f32
    };
    branches[first..].iter_mut().for_each(|branch| branch.polarization = degree(&branch.share, 1));
    if !reflected.is_zero() {
        branches.push(Branch::mirrored(context, reflected, degree(&reflected, 0)));
    }
}

/// Returns the shares of a lane whose ray meets a coated boundary, or a facet of it, at an angle with cosine `cos`.
pub(super) fn shares_at<const N: usize>(
    local: &LocalCoating<N>,
    context: &ScatterContext<N>,
    lane: usize,
    cos: f64,
) -> StackShares {
    let [here, beyond] = context.ray_indices(lane);
    let crosses = Interface::new(here, beyond, cos).transmittance > 0.0;
    shares_of_lane(context, lane, cos, crosses, |n1, n2, q1| local.shares(lane, n1, n2.into(), q1))
}

/// Returns the Mueller block of radiance at a coated boundary, or a facet of it.
pub(super) fn block_at<const N: usize>(
    local: &LocalCoating<N>,
    context: &ScatterContext<N>,
    lane: usize,
    cos: f64,
    crosses: bool,
) -> Block<f64> {
    let StackShares { reflected, refracted } = shares_at(local, context, lane, cos);
    let ratio = context.incident_of(lane) / context.beyond_of(lane);
    if crosses { refracted.block().times(ratio * ratio) } else { reflected.block() }
}

/// Returns the shares of a lane at a coated boundary that its ray meets at an angle with cosine `cos`. `of_stack` gets
/// the lane's own indices n1 and n2, and n1 times its cosine on the ray: see [`SharedRay`]. Unless the ray `crosses`,
/// what would cross is reflected.
pub(super) fn shares_of_lane<const N: usize>(
    context: &ScatterContext<N>,
    lane: usize,
    cos: f64,
    crosses: bool,
    of_stack: impl Fn(f64, f64, f64) -> StackShares,
) -> StackShares {
    let own @ [n1, n2] = [context.incident_of(lane), context.beyond_of(lane)];
    let ray = SharedRay::new(context.ray_indices(lane), cos);
    let mut shares = of_stack(n1, n2, ray.normal_component(own));
    if !crosses {
        shares.reflect_all();
    }
    shares
}
