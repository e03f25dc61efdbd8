//! What an image's file records about its render.

use crate::film::{Fact, Provenance};
use crate::plan::Plan;
use crate::scene::Scene;
use crate::trace::REPLICATES;

/// The key for the number of camera samples per pixel.
pub(super) const SAMPLES: &str = "samples";
/// The key for the number of samples that are left out because they are not finite.
pub(super) const NON_FINITE: &str = "nonFinite";

/// Returns what is known before the first sample. The counts of what a render has done are still 0.
pub(super) fn origin(scene: &Scene, plan: &Plan) -> Provenance {
    let text = |text: &str| Fact::Text(text.to_owned());
    let method = &plan.method;
    let wavelengths: Vec<String> = method.basis.wavelengths_nm().iter().map(f64::to_string).collect();
    // Written as on a command line.
    let settings: Vec<String> = scene.settings.iter().map(|setting| format!("--set {setting}")).collect();
    let settings = (!settings.is_empty()).then(|| ("set", Fact::Text(settings.join(" "))));
    let replicates = method.stop.as_ref().map(|_| ("replicates", Fact::Count(REPLICATES as u64)));
    let photons = method.light_pass.as_ref().map(|pass| ("photons", Fact::Count(pass.photons)));
    let blur = method.map().map(|map| ("photonRadius", text(&format!("{:.3} pixels", map.radius))));
    let facts = [
        ("version", text(env!("CARGO_PKG_VERSION"))),
        ("sceneHash", text(&scene.hash)),
        ("model", text(&method.basis.name())),
        ("wavelengths", text(&wavelengths.join(" "))),
        ("projection", text(scene.camera.projection().name())),
        ("transport", text(method.transport.name())),
        ("filter", text(&scene.film.filter.described())),
        (SAMPLES, Fact::Count(0)),
        ("seed", text(&method.seed.to_string())),
        (NON_FINITE, Fact::Count(0)),
    ];
    let facts = facts.into_iter().chain(settings).chain(replicates).chain(photons).chain(blur);
    Provenance { facts: facts.map(|(key, fact)| (key.into(), fact)).collect(), time: None }
}
