//! The photons that a world needs.

use super::caustics::{self, Shown};
use super::photon_map;
use crate::scene::Scene;
use crate::spectrum::Curve;
use crate::trace::World;

/// A world and the photons that it needs.
pub(super) struct Lit {
    pub(super) world: World,
    pub(super) because: Vec<String>,
    /// Where photons learned to go.
    pub(super) taught: Option<World>,
}

impl Lit {
    pub(super) fn new(scene: &Scene<Curve>, unlit: &World) -> Self {
        let Shown { pass: shown, why, taught } = caustics::light_pass(scene, unlit);
        let (light_pass, why_gathered) = photon_map::with_map(scene, unlit, shown.as_ref());
        // Why nothing is shown matters only where nothing is gathered either.
        let mut because: Vec<String> = why.into_iter().filter(|_| shown.is_some() || light_pass.is_none()).collect();
        because.extend(why_gathered);
        Self { world: unlit.with_light_pass(light_pass), because, taught }
    }
}
