//! A world made ready for rendering: tabulated, and taught by a few paths and photons where to look.

use super::sent_ahead::learn_where_to_send;
use super::visible_caps::learn_visible_caps;
use crate::scene::Scene;
use crate::spectrum::Curve;
use crate::trace::{Method, World};

/// The scene, tabulated for the method, after rays and photons have learned where lamps and caustics are visible.
pub fn prepare(scene: &Scene<Curve>, method: Method) -> World {
    let mut world = prepare_unguided(scene, method);
    learn_where_to_send(&mut world);
    world
}

/// The scene, tabulated for the method, without photons sent ahead: enough for camera samples.
pub fn prepare_unguided(scene: &Scene<Curve>, method: Method) -> World {
    let mut world = World::new(scene, method);
    learn_visible_caps(&mut world);
    world
}
