//! A rough coated boundary, lane by lane: facets reflect and let through as the film does, and what they block is given
//! back as [`Sides`] does for the bare one, so that no light is lost or won.

use std::f64::consts::PI;

use super::coated_boundary::shares_of_lane;
use super::coating::MetCoating;
use super::film_averages::FilmAverages;
use super::film_kernel::FilmKernel;
use super::{Arrival, Flow, Interface, Sides};

/// What a lane's light does at the boundary.
pub(super) struct CoatedLane<'a> {
    sides: &'a Sides<'a>,
    kernels: [&'a FilmKernel; 2],
    /// From the viewer's side and from beyond.
    averages: [FilmAverages; 2],
    /// Light from all around that is blocked on each side.
    mean_blocked: [f64; 2],
    /// The share of what is blocked on the viewer's side that crosses in the end.
    crossing: f64,
    /// What the film leaves of that, where it absorbs, on the viewer's side and on the way across.
    left: [f64; 2],
}

impl<'a> CoatedLane<'a> {
    pub(super) fn new<const N: usize>(
        met: &MetCoating<N>,
        arrival: &Arrival<N>,
        lane: usize,
        sides: &'a Sides<'a>,
        kernels: [&'a FilmKernel; 2],
    ) -> Self {
        let turned = arrival.turned_around();
        let stack = met.stack(lane);
        let averages =
            [(arrival, &stack, false), (&turned, &stack.turned_around(), true)].map(|(from, stack, beyond)| {
                let ([here, there], own) = (from.refracting(lane), [from.incident_of(lane), from.beyond_of(lane)]);
                let bare = |cos: f64| {
                    let interface = Interface::new(here, there, cos);
                    [interface.reflectance, interface.transmittance]
                };
                let film = |cos: f64| {
                    let goes_on = bare(cos)[1] > 0.0;
                    shares_of_lane(from, lane, cos, goes_on, |n1, n2, q1| stack.shares(n1, n2.into(), q1)).means()
                };
                let make = || FilmAverages::new(stack.is_slow(), [here, there], there, film, bare);
                met.averages(lane, met.is_inside() != beyond, [own[0], own[1], here, there], make)
            });
        let bare = [sides.near.mean_blocked(), sides.far.mean_blocked()];
        let mean_blocked = [0, 1].map(|i| (bare[i] + kernels[i].mean_added(&averages[i])).max(f64::MIN_POSITIVE));
        let left = averages.map(|averages| (averages.mean[0] + averages.mean[1]).min(1.0));
        let enters = averages[0].mean[1] / left[0].max(f64::MIN_POSITIVE);
        let crossing = (enters * mean_blocked[1] / mean_blocked[0].max(mean_blocked[1])).min(1.0);
        Self { sides, kernels, averages, mean_blocked, crossing, left: [left[0], (left[0] * left[1]).sqrt()] }
    }

    fn blocked(&self, side: usize, cos: f64) -> f64 {
        let bare = if side == 0 { self.sides.near.blocked(cos) } else { self.sides.far.blocked(cos) };
        (bare + self.kernels[side].added(&self.averages[side], cos)).max(0.0)
    }

    /// BSDF times cosine between cosines `from` and `to`, of which the latter lies beyond where `crosses`; of light
    /// that one facet sends there `flow` knows all but its share, `once`.
    pub(super) fn value(&self, flow: &Flow, once: f64, [from, to]: [f64; 2], crosses: bool, square: f64) -> f64 {
        let side = usize::from(crosses);
        let way = if crosses { self.crossing * square } else { 1.0 - self.crossing };
        let again = self.blocked(0, from) * self.blocked(side, to) / self.mean_blocked[side] * to / PI;
        way * self.left[side] * again + once * flow.facet
    }
}
