//! Decides whether light is followed along all branches, or along some that are chosen by chance.

use super::format::percent;
use super::survey::path_method;
use crate::film::{Filter, Layer};
use crate::light::Light;
use crate::material::Material;
use crate::scene::{Object, RenderText, Scene, Visibility};
use crate::spectrum::{Basis, Curve, CurveKind};
use crate::trace::{Branching, Method, Transport, World, branching};

/// Weight below which deterministic transport follows no branch.
const CUTOFF: f64 = 1e-9;
/// Most surfaces that a camera sample of deterministic transport may hit: eight times what a mean one may.
const MAX_SURFACES: u64 = 16_384;
/// Transport that leaves nothing to chance.
const DETERMINISTIC: Transport = Transport::Deterministic { cutoff: CUTOFF, max_sample_surfaces: MAX_SURFACES };
/// Weight above which a path splits into all its branches (row W5 of the stability catalog).
const SPLIT: f64 = 0.05;
/// Weight below which paths are ended at random.
const ROULETTE: f64 = 0.05;
/// Surfaces that a mean sample may hit if all branches are followed: about as many as 256 samples that choose one.
const MAX_MEAN_SURFACES: f64 = 2048.0;

/// Decides whether anything is left to chance, and why. Lanes within the angle `together` continue as one.
pub(super) fn transport(scene: &Scene<Curve>, basis: &Basis, together: f64) -> (Transport, String) {
    let material = |object: &Object| &scene.materials[object.material as usize].material;
    let is_wide = |object: &&Object| material(object).lobes().is_wide() && !material(object).is_black();
    let rough = scene.objects.iter().find(|object| is_wide(object) && !material(object).lobes().is_diffuse());
    let scattering = scene.objects.iter().find(is_wide);
    let why_filter = || {
        let filter = scene.film.filter;
        let place = if filter == Filter::Box { "anywhere in" } else { "somewhere around" };
        (filter != Filter::Center)
            .then(|| format!("each sample falls {place} its pixel (filter \"{}\")", filter.name()))
    };
    let why_scattering = |object: &Object| Some(format!("light leaves {} in every direction", object.name));
    let why = match scattering {
        _ if basis.draws_wavelengths() => Some("each sample draws its own wavelengths".to_owned()),
        _ if scene.camera.has_lens() => Some("each sample looks through its own point of the lens".to_owned()),
        None => why_filter(),
        Some(object) => match (scene.render.diffuse_bounces, rough, extended_light(scene)) {
            (Some(0), Some(rough), _) => why_scattering(rough),
            (Some(0), None, None) => why_filter(),
            (Some(0), None, Some(light)) => {
                Some(format!("{} is lit by {light}, which is larger than a point", object.name))
            }
            _ => why_scattering(object),
        },
    };
    match why.or_else(|| why_sample_holes(scene)).or_else(|| why_not_all_branches(scene, basis, together)) {
        None => (
            DETERMINISTIC,
            format!(
                "transport deterministic: no random light paths, 1 sample per pixel is exact{}; branches end below weight {CUTOFF:e}",
                if requests_more_samples(scene) { " and more samples repeat it, so samples = 1 is enough" } else { "" }
            ),
        ),
        Some(why) => (
            Transport::Random { split: SPLIT, roulette: ROULETTE },
            format!(
                "transport random: {why}; a path follows both reflection and refraction as long as it has {} of its weight or more, then \
                 one of them, until Russian roulette ends it",
                percent(SPLIT)
            ),
        ),
    }
}

/// Whether a scene asks for more than one sample per pixel, and for no layer that needs several.
fn requests_more_samples(scene: &Scene<Curve>) -> bool {
    let RenderText { samples, error, time, .. } = &scene.render;
    let multi_sample_layers = [Layer::Variance, Layer::HalfA, Layer::HalfB];
    let needs_several = multi_sample_layers.iter().any(|layer| scene.format.layers.contains(layer));
    !needs_several && (samples.is_some_and(|samples| samples > 1) || error.is_some() || time.is_some())
}

/// Names a light with an extent at which next-event estimation would aim.
fn extended_light(scene: &Scene<Curve>) -> Option<String> {
    scene.lights.iter().find(|light| light.is_sampled() && light.is_extended()).map(|light| match light {
        Light::Area(area) => scene.objects[area.object as usize].name.clone(),
        Light::Sun(_) => "the sun".into(),
        _ => "the environment".into(),
    })
}

/// Explains that camera samples take surfaces with holes, or what is behind them, as a whole.
fn why_sample_holes(scene: &Scene<Curve>) -> Option<String> {
    let has_mattes =
        scene.objects.iter().any(|object| matches!(object.visibility, Visibility::Holdout | Visibility::ShadowCatcher));
    let is_opaque =
        |opacity: &Curve| matches!(opacity.kind, CurveKind::Number(opaque) if opaque * opacity.scale == 1.0);
    let is_mask = |material: &&Material<Curve>| matches!(material, Material::Mask(mask) if !is_opaque(&mask.opacity));
    let parts = |object: &Object| scene.materials[object.material as usize].material.with_parts();
    let has_holes = |object: &&Object| parts(object).iter().any(is_mask);
    let object = scene.objects.iter().find(has_holes).filter(|_| has_mattes)?;
    Some(format!("beside holdouts and shadow catchers each sample shows {} or what is behind its holes", object.name))
}

/// Explains why not all branches can be followed, if there are too many.
fn why_not_all_branches(scene: &Scene<Curve>, basis: &Basis, together: f64) -> Option<String> {
    if !scene.materials.iter().any(|named| named.material.lobes().has_delta()) {
        return None;
    }
    let method = Method { together, ..path_method(scene, basis.clone(), DETERMINISTIC) };
    match branching(&World::new(scene, method), MAX_MEAN_SURFACES) {
        Branching::Affordable(_) => None,
        Branching::Beyond([x, y]) => Some(format!(
            "light has too many paths through glass and via mirrors to follow all of them, as at pixel ({x}, {y})"
        )),
    }
}
