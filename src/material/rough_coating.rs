//! A rough coated boundary, evaluated lane by lane. Facets reflect and transmit as the film does, and the missing
//! energy is restored as in [`FacetSides`] for the bare boundary, so that no energy is lost or gained.

use std::f64::consts::PI;

use super::coated_boundary::shares_of_lane;
use super::coating::{Averages, LocalCoating};
use super::film_averages::{FilmAverages, HatWeights};
use super::film_kernel::FilmKernel;
use super::{BsdfValue, FacetSides, Interface, ScatterContext};

/// The energy that single scattering loses between two directions, the second of which may lie beyond the boundary. It
/// is equal for all lanes with the same refracting indices.
pub(super) struct MissingEnergy<'a> {
    /// The side of the second direction: 0 is the viewer's, 1 is beyond.
    side: usize,
    /// Its cosine.
    to: f64,
    /// Missing energy without a film: from both directions, and of diffuse light on both sides.
    bare: [f64; 2],
    bare_diffuse: [f64; 2],
    /// What a film adds: from both directions, and of diffuse light on both sides.
    hats: [HatWeights; 2],
    hats_diffuse: [&'a HatWeights; 2],
}

impl<'a> MissingEnergy<'a> {
    /// Computes the missing energy between directions of cosines `from` and `to`, the latter beyond where light
    /// `crosses`.
    pub(super) fn new(sides: &FacetSides, kernels: [&'a FilmKernel; 2], [from, to]: [f64; 2], crosses: bool) -> Self {
        let (near, far, side) = (&sides.near, &sides.far, usize::from(crosses));
        Self {
            side,
            to,
            bare: [near.missing_energy(from), if crosses { far } else { near }.missing_energy(to)],
            bare_diffuse: [near.mean_missing_energy(), far.mean_missing_energy()],
            hats: [kernels[0].at(from), kernels[side].at(to)],
            hats_diffuse: kernels.map(|kernel| &kernel.mean),
        }
    }

    /// Returns BSDF times cosine of a lane, times `square` where light crosses. `single` is the lane's share of the
    /// light that a facet sends on; `bsdf` holds the other factors of single scattering.
    pub(super) fn value(&self, averages: &[Averages; 2], bsdf: &BsdfValue, single: f64, square: f64) -> f64 {
        let Self { side, to, bare, bare_diffuse, hats, hats_diffuse } = self;
        let diffuse = [0, 1]
            .map(|i| (bare_diffuse[i] + averages[i].added_missing_energy(hats_diffuse[i])).max(f64::MIN_POSITIVE));
        // Share of the missing energy that an absorbing film leaves: on the viewer's side, and on the way across.
        let unabsorbed = [0, 1].map(|i| (averages[i].mean[0] + averages[i].mean[1]).min(1.0));
        let unabsorbed_on_way = [unabsorbed[0], (unabsorbed[0] * unabsorbed[1]).sqrt()][*side];
        // Share of the missing energy that crosses in the end.
        let enters = averages[0].mean[1] / unabsorbed[0].max(f64::MIN_POSITIVE);
        let crossing = (enters * diffuse[1] / diffuse[0].max(diffuse[1])).min(1.0);
        let way_share = if *side == 1 { crossing * square } else { 1.0 - crossing };
        let [from_missing, to_missing] = [(0, 0), (1, *side)]
            .map(|(end, side)| (bare[end] + averages[side].added_missing_energy(&hats[end])).max(0.0));
        let multiple = from_missing * to_missing / diffuse[*side] * to / PI;
        way_share * unabsorbed_on_way * multiple + single * bsdf.facet
    }
}

/// Returns the averages of the film over directions for a lane, on the viewer's side and beyond.
pub(super) fn averages<'a, const N: usize>(
    local: &LocalCoating<'a, N>,
    context: &ScatterContext<N>,
    lane: usize,
) -> [Averages<'a>; 2] {
    let turned = context.turned_around();
    [(context, false), (&turned, true)].map(|(from, is_beyond)| {
        let ([here, there], own) = (from.ray_indices(lane), [from.incident_of(lane), from.beyond_of(lane)]);
        local.averages(lane, local.inside != is_beyond, [own[0], own[1], here, there], |stack| {
            let stack = if is_beyond { &stack.turned_around() } else { stack };
            let bare = |cos: f64| {
                let interface = Interface::new(here, there, cos);
                [interface.reflectance, interface.transmittance]
            };
            let film = |cos: f64| {
                let crosses = bare(cos)[1] > 0.0;
                shares_of_lane(from, lane, cos, crosses, |n1, n2, q1| stack.shares(n1, n2.into(), q1)).means()
            };
            FilmAverages::new(stack.varies_slowly(), [here, there], there, film, bare)
        })
    })
}
