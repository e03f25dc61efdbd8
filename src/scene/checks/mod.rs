//! Checks of the finished scene by ray tracing, for mistakes that its author should know about.

mod on_surface;
mod open_glass;
mod out_of_focus;
mod probe;
mod unlit;
mod view;

use super::{Object, Scene, Visibility};
use crate::spectrum::Curve;

pub(super) use probe::{hit_from_outside, ray_into};

/// Adds warnings about what is most likely not intended.
pub(super) fn check(scene: &mut Scene<Curve>) {
    let dark = match scene.lights.iter().all(|light| light.emission().is_dark()) {
        true => vec!["nothing emits light, so the image will be black".into()],
        false => unlit::unlit(scene),
    };
    scene.has_dark_warning = !dark.is_empty();
    scene.warnings.extend(dark);
    scene.warnings.extend(on_surface::on_surface(scene));
    scene.warnings.extend(open_glass::open_glass(scene));
    scene.warnings.extend(out_of_focus::out_of_focus(scene));
    let black = black_catchers(scene);
    scene.warnings.extend(black);
}

/// Returns warnings about shadow catchers on which no shadow can be seen.
fn black_catchers(scene: &Scene<Curve>) -> Vec<String> {
    let is_black = |object: &&Object| scene.materials[object.material as usize].material.is_black();
    let catchers =
        scene.objects.iter().filter(|object| object.visibility == Visibility::ShadowCatcher).filter(is_black);
    let warning = |object: &Object| {
        format!(
            "{} is black and catches no shadow: give it the reflectance of the surface that it stands in for",
            object.name
        )
    };
    catchers.map(warning).collect()
}
