//! What the author of a scene should know of the world that it means: rays look for it.

mod on_surface;
mod open_glass;
mod out_of_focus;
mod probe;
mod unlit;
mod view;

use super::Scene;
use crate::spectrum::Curve;

pub(super) use probe::{met_from_outside, ray_into};

/// Adds to the warnings of a scene what is most likely not meant.
pub(super) fn check(scene: &mut Scene<Curve>) {
    let dark = match scene.lights.iter().all(|light| light.emission().is_dark()) {
        true => vec!["nothing shines, so the image will be black".into()],
        false => unlit::unlit(scene),
    };
    scene.is_dark_told = !dark.is_empty();
    scene.warnings.extend(dark);
    scene.warnings.extend(on_surface::on_surface(scene));
    scene.warnings.extend(open_glass::open_glass(scene));
    scene.warnings.extend(out_of_focus::out_of_focus(scene));
}
