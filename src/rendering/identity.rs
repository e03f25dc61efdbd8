//! The identity of a render, by which checkpoints, parts and plans are matched to it.

use std::fmt::Write;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::film::{Format, Overscan, Shard, Window};
use crate::scene::{FilmSettings, Scene};
use crate::trace::{LightPass, Method, Stop};

/// The facts that two runs must have in common to contribute to one image, each with its name.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Identity(Vec<(String, String)>);

const VERSION: &str = "version";
const SCENE: &str = "scene";
const STOP: &str = "stop rule";
const PLAN: &str = "plan";

impl Identity {
    /// Identifies a scene with all options applied. The number of samples is not part of the identity, unless the plan
    /// depends on it.
    pub(super) fn new(scene: &Scene, method: &Method, shard: Shard) -> Self {
        let spectral = scene.format.spectral;
        let stop = if method.stop.is_some() { "error or time" } else { "samples alone" };
        let plan = digest(&format!("{:?} {spectral:?} {:?}", sample_method(method), scene.film.filter));
        let method_facts = [(STOP, stop.to_owned()), (PLAN, plan)].map(|(name, value)| (name.to_owned(), value));
        Self(Self::without_plan(scene, shard).0.into_iter().chain(method_facts).collect())
    }

    /// Returns the part of the identity that is known before a scene is planned.
    fn without_plan(scene: &Scene, shard: Shard) -> Self {
        let FilmSettings { width, height, filter, color_space, overscan, crop } = scene.film;
        let Overscan { left, top, right, bottom } = overscan;
        let crop_text = |Window { left, top, width, height }| format!("{left},{top},{width},{height}");
        let Format { layers, first, spectral, .. } = &scene.format;
        let names: Vec<&str> = layers.iter().map(|layer| layer.name()).collect();
        let facts = [
            (VERSION, env!("CARGO_PKG_VERSION").to_owned()),
            (SCENE, scene.hash.clone()),
            ("size", format!("{width} x {height} pixels")),
            ("overscan", format!("{left},{top},{right},{bottom}")),
            ("crop", crop.map_or("none".into(), crop_text)),
            ("seed", scene.render.seed.to_string()),
            ("filter", filter.described()),
            ("color space", color_space.interop_id().to_owned()),
            ("list of layers", if names.is_empty() { "empty".into() } else { names.join(",") }),
            ("first surface", format!("{first:?}").to_lowercase()),
            ("number of spectral bands", spectral.map_or(0, |bands| bands.count()).to_string()),
            ("part", format!("{} of {}", shard.number(), shard.count())),
        ];
        Self(facts.map(|(name, value)| (name.to_owned(), value)).into())
    }

    /// Returns whether this is the identity of a scene, whatever the plan.
    pub(super) fn is_of_scene(&self, scene: &Scene, shard: Shard) -> bool {
        let own = self.0.iter().filter(|(name, _)| ![STOP, PLAN].contains(&name.as_str()));
        own.eq(&Self::without_plan(scene, shard).0)
    }

    /// Returns the identity that all parts of an image share.
    pub(super) fn without_part(&self) -> Self {
        Self(self.0.iter().filter(|(name, _)| name != "part").cloned().collect())
    }

    /// Returns why the rest of a file cannot be read, if so: another version may store other data after the identity.
    pub(super) fn objection(&self) -> Option<String> {
        let made_by = self.0.iter().find_map(|(name, value)| (name == VERSION).then_some(value))?;
        (made_by != env!("CARGO_PKG_VERSION"))
            .then(|| format!("its {VERSION} is {made_by}, not {}", env!("CARGO_PKG_VERSION")))
    }

    /// Returns what differs in another run, if anything does.
    pub(super) fn difference(&self, other: &Self) -> Option<String> {
        let value = |name: &str| self.0.iter().find(|(known, _)| known == name).map(|(_, value)| value);
        let (name, theirs) = other.0.iter().find(|(name, theirs)| value(name) != Some(theirs))?;
        Some(match name.as_str() {
            SCENE => "it was made from another scene, or from this one before it was changed".into(),
            PLAN => {
                "it was made with another plan: other --samples or another --error may lead to one, as where photons \
                 are gathered, or where light vertices or adaptive sampling come into use"
                    .into()
            }
            _ => format!("its {name} is {theirs}, not {}", value(name).map_or("known", String::as_str)),
        })
    }
}

/// Reduces a method to what determines the result of a camera sample. Omits the number of samples, the limits of the
/// stop rule and the number of photons that are splatted. If photons are gathered, their number and radius are
/// included, and so is the number of samples.
fn sample_method(method: &Method) -> Method {
    let light_pass = method.light_pass.clone().map(|pass| LightPass { photons: 0, ..pass });
    let stop = method.stop.as_ref().map(|_| Stop { noise: None, time: None, min_samples: 0, max_samples: 0 });
    let method = Method { stop, ..method.clone() };
    if method.map().is_some() { method } else { Method { samples: 0, light_pass, ..method } }
}

/// Returns 64 hexadecimal digits that identify a text.
pub(super) fn digest(text: &str) -> String {
    Sha256::digest(text.as_bytes()).iter().fold(String::new(), |mut digits, byte| {
        let _ = write!(digits, "{byte:02x}");
        digits
    })
}
