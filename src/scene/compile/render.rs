//! How the image is rendered.

use toml::de::DeValue;

use crate::error::nearest;
use crate::scene::text::{Fields, Value};
use crate::scene::{AutoText, ModelText, PolarizationText, RenderText, duration};

/// The models that are given by name.
const MODELS: [(&str, ModelText); 3] = [("auto", ModelText::Auto), ("rgb", ModelText::Rgb), ("hero", ModelText::Hero)];
/// The numbers of wavelengths that a model may have.
const BANDS: [u32; 4] = [8, 12, 16, 32];

/// Reads how the image is rendered, in the form that [`RenderText`] shows.
pub(super) fn render(value: Value) -> Option<RenderText> {
    Fields::read(value, |render| {
        let model = render.or("model", ModelText::Auto, model);
        let error = render.maybe("error", |value| {
            let help = "0.01 asks for one percent";
            value.number_within(RenderText::ERRORS, "a relative error lies between 0.000001 and 1", Some(help))
        });
        let time = render.maybe("time", |value| {
            let text = value.text()?;
            let help = "a time is a number with a unit: \"90s\", \"10m\", \"1.5h\"";
            duration(text).map_or_else(|| value.advise(format!("`time` cannot be \"{text}\""), help), Some)
        });
        let meters_per_unit = render.maybe("meters_per_unit", |value| {
            let help = "0.01 if the scene is in centimeters";
            value.number_within(1e-12..=1e12, "a scene unit is 1e-12 to 1e12 meters", Some(help))
        });
        let samples = render.maybe("samples", |value| value.whole_number(1..=u32::MAX.into()));
        let seed = render.or("seed", 0, |value| value.whole_number(0..=u64::MAX));
        let diffuse_bounces = render.maybe("diffuse_bounces", Value::count);
        let max_bounces = render.maybe("max_bounces", Value::count);
        let words = [("auto", AutoText::Auto), ("off", AutoText::Off)];
        let [adaptive, caustics] =
            ["adaptive", "caustics"].map(|key| render.or(key, AutoText::Auto, |value| value.word(&words)));
        let words = [("auto", PolarizationText::Auto), ("on", PolarizationText::On), ("off", PolarizationText::Off)];
        let polarization = render.or("polarization", PolarizationText::Auto, |value| value.word(&words));
        Some(RenderText {
            model: model?,
            error: error?,
            time: time?,
            meters_per_unit: meters_per_unit?,
            samples: samples?,
            seed: seed?,
            diffuse_bounces: diffuse_bounces?,
            max_bounces: max_bounces?,
            caustics: caustics?,
            adaptive: adaptive?,
            polarization: polarization?,
            is_part: false,
        })
    })
}

fn model(value: Value) -> Option<ModelText> {
    const KNOWN: &str = "known here: \"auto\", \"rgb\", \"hero\" or { bands = 16 }";
    let near = |word: &str| nearest(word, MODELS.iter().map(|(name, _)| *name).chain(["bands"]));
    match value.node() {
        DeValue::String(word) => {
            let known = MODELS.iter().find(|(name, _)| name == word).map(|(_, model)| *model);
            known.or_else(|| {
                let help = match near(word) {
                    Some("bands") => "write { bands = 16 }".into(),
                    Some(near) => format!("did you mean \"{near}\"?"),
                    None => KNOWN.into(),
                };
                value.advise(format!("`model` cannot be \"{word}\""), help)
            })
        }
        DeValue::Table(table) if !table.is_empty() => {
            if let Some(other) = value.table()?.into_iter().find(|key| key.key() != "bands") {
                let word = other.key();
                let help = match near(word) {
                    Some("bands") => "did you mean `bands`?".into(),
                    Some(near) => format!("write model = \"{near}\""),
                    None => KNOWN.into(),
                };
                return other.refuse_key(format!("unknown key `{word}`"), Some(help));
            }
            let bands = Fields::read(value, |model| model.need("bands", bands));
            bands.map(ModelText::Bands)
        }
        _ => value.advise("`model` is a word in quotes or { bands = .. }", KNOWN),
    }
}

fn bands(value: Value) -> Option<u32> {
    match value.count()? {
        bands if BANDS.contains(&bands) => Some(bands),
        bands => value.refuse(format!("the model has 8, 12, 16 or 32 bands, not {bands}")),
    }
}
