//! Prepares a world for rendering: tabulates it, and lets a few paths and photons learn where to look.

use super::photon_pilot::guide_photons;
use super::visible_caps::learn_visible_caps;
use crate::scene::Scene;
use crate::spectrum::Curve;
use crate::trace::{Method, World};

/// Tabulates the scene for the method, then traces rays and photons that learn where lamps and caustics are visible.
pub fn prepare(scene: &Scene<Curve>, method: Method) -> World {
    let mut world = prepare_unguided(scene, method);
    guide_photons(&mut world);
    world
}

/// Tabulates the scene for the method without sending photons ahead, which is enough for camera samples.
pub fn prepare_unguided(scene: &Scene<Curve>, method: Method) -> World {
    let mut world = World::new(scene, method);
    learn_visible_caps(&mut world);
    world
}
