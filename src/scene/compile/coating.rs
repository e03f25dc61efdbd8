//! Layers in which light interferes, as authors write them.

use super::spectrum_draft::{SpectrumDraft, spectrum, spectrum_or};
use crate::material::{Coating, CoatingLayer, MAX_LAYERS, Thin};
use crate::scene::text::{Fields, Value};

const EXAMPLE: &str = "write coating = [{ index = 1.38, thickness_nm = 100 }, ..], from the outside inward";

/// Reads the coating of a material, if it has one. Returns none if it is wrong, which is recorded as a mistake.
pub(super) fn coating<'d>(fields: &mut Fields<'d>) -> Option<Option<Coating<SpectrumDraft<'d>>>> {
    let Some(value) = fields.get("coating") else { return Some(None) };
    if !value.node().is_array() {
        return value.advise("a coating is a list of layers", EXAMPLE);
    }
    let layers = value.list(layer)?;
    if layers.len() > MAX_LAYERS {
        return value.refuse(format!("a coating has at most {MAX_LAYERS} layers, not {}", layers.len()));
    }
    Some((!layers.is_empty()).then(|| Coating::new(layers)))
}

fn layer(value: Value) -> Option<CoatingLayer<SpectrumDraft>> {
    Fields::read(value, layer_from_fields)
}

fn layer_from_fields<'d>(fields: &mut Fields<'d>) -> Option<CoatingLayer<SpectrumDraft<'d>>> {
    let thickness = spectrum(fields, "thickness_nm");
    let [metal, n, index, k] = ["metal", "n", "index", "k"].map(|key| fields.get(key));
    let (index, k) = match (metal, n) {
        (None, None) => (spectrum(fields, "index"), spectrum_or(fields, "k", 0.0)),
        (Some(metal), None) if index.is_none() && k.is_none() => {
            let metal = SpectrumDraft::Given(metal.text().map(|_| metal)?);
            (metal, metal)
        }
        (None, Some(n)) if index.is_none() => (SpectrumDraft::Given(n), spectrum(fields, "k")),
        (Some(given), _) | (None, Some(given)) => {
            return given.refuse("a layer has an `index` with an optional `k`, or a `metal`, or both `n` and `k`");
        }
    };
    Some(CoatingLayer { index, k, is_metal: metal.or(n).is_some(), thickness })
}

/// Reads a pane, or a film of one layer if there is a thickness, a `metal` or an `n`. Returns none if its keys do not
/// fit together, which is recorded as a mistake.
pub(super) fn thin<'d>(fields: &mut Fields<'d>) -> Option<Thin<SpectrumDraft<'d>>> {
    let index = fields.get("index");
    let (transmittance, thickness) = (fields.get("transmittance"), fields.get("thickness_nm"));
    let [k, metal, n] = ["k", "metal", "n"].map(|key| fields.get(key));
    if thickness.is_none()
        && let Some(k) = k.filter(|_| index.is_some() || n.is_none())
    {
        let help = "a pane without a thickness absorbs through its `transmittance`";
        return k.refuse_key("`k` needs `thickness_nm`", Some(help.into()));
    }
    if thickness.or(metal).or(n).is_none() {
        let transmittance = spectrum_or(fields, "transmittance", 1.0);
        return Some(Thin::Pane { index: spectrum(fields, "index"), transmittance });
    }
    if let Some(transmittance) = transmittance {
        let help = "a film absorbs through its extinction coefficient: write `k`";
        return transmittance
            .refuse_key("a film has a `thickness_nm` or a `transmittance`, not both", Some(help.into()));
    }
    Some(Thin::Film(Coating::new(vec![layer_from_fields(fields)?])))
}
