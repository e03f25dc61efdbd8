//! What it is worth that lanes which part also go on together, learned from some thousand camera samples of both kinds.

use super::cost::with_few_photons;
use super::pilot_noise::{Noise, weigh};
use crate::film::Layer;
use crate::trace::pass::Pass;
use crate::trace::photon::photons;
use crate::trace::walk::Polarized;
use crate::trace::width::in_lanes;
use crate::trace::{Transport, World};

/// How many times as long an equal error takes without [`control`](crate::trace::Method::control); none where that
/// cannot be: without heroes, where dyes are excited, and where a layer asks for the end of every weight.
pub fn control_gain(world: &World) -> Option<f64> {
    let is_random = matches!(world.method.transport, Transport::Random { .. });
    let can = is_random && world.method.basis.draws_wavelengths() && !world.fluoresces();
    if !can || world.layers.at(Layer::Residual).is_some() {
        return None;
    }
    in_lanes!(&world.method.basis, N => {
        let few = with_few_photons(world);
        let photons = photons::<N, Polarized>(&few, &Pass::of_photons_alone(&few, 0));
        let of = |world| weigh(world, photons.as_ref(), None, Noise::OfChannels);
        of(&few.with_control()).gain_over(&of(&few))
    })
}
