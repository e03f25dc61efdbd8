//! How the light of a scene is found.

use super::between::{IndirectMethod, between};
use super::caustics::{self, CausticChoice};
use super::photon_map;
use crate::scene::Scene;
use crate::spectrum::Curve;
use crate::trace::{LightPass, World};

/// A world with all that finds its light.
pub(super) struct LitWorld {
    pub(super) world: World,
    pub(super) because: Vec<String>,
    /// Where photons learned to go.
    pub(super) guided: Option<World>,
}

impl LitWorld {
    pub(super) fn new(scene: &Scene<Curve>, unlit: &World) -> Self {
        let CausticChoice { caustics, why, settled, only_sky, guided } = caustics::caustics(scene, unlit);
        let shown = caustics.as_ref().map(|caustics| caustics.pass(unlit, 0.0));
        let (light_pass, why_gathered) = photon_map::with_map(scene, unlit, shown.as_ref(), settled);
        // Why nothing is shown matters only where nothing is gathered either.
        let is_told = shown.is_some() || light_pass.is_none();
        let why = if is_told { why } else { Vec::new() };
        let map = light_pass.as_ref().and_then(|pass| pass.map);
        let photons = caustics.as_ref().map_or(&[][..], |caustics| &caustics.photons);
        let way = between(unlit.with_light_pass(light_pass), photons);
        // As many as are best beside the noise that all else leaves.
        let pass = caustics.as_ref().map(|caustics| caustics.pass(unlit, way.photons_of_a_sample()));
        let IndirectMethod { mut world, reasons, .. } = way;
        if let Some(pass) = pass {
            world = world.with_light_pass(Some(LightPass { map, ..pass }));
        }
        let reason = caustics.as_ref().and_then(|caustics| caustics.reason(&world));
        let left = caustics::without_end(scene, &world);
        let of_sky = (only_sky && is_told).then(|| caustics::of_sky(&world));
        let because =
            reason.into_iter().chain(left).chain(why).chain(of_sky).chain(why_gathered).chain(reasons).collect();
        Self { world, because, guided }
    }
}
