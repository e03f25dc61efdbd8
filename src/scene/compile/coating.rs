//! Layers in which light interferes, as authors write them.

use super::asked::{Asked, spectrum, spectrum_or};
use crate::material::{Coating, CoatingLayer, MAX_LAYERS};
use crate::scene::text::{Fields, Value};

const EXAMPLE: &str = "write coating = [{ index = 1.38, thickness_nm = 100 }, ..], from the outside inward";

/// The layers of a material, if it has any; none if they are wrong, which is told.
pub(super) fn coating<'d>(fields: &mut Fields<'d>) -> Option<Option<Coating<Asked<'d>>>> {
    let Some(value) = fields.get("coating") else { return Some(None) };
    if !value.node().is_array() {
        return value.advise("a coating is a list of layers", EXAMPLE);
    }
    let layers = value.list(layer)?;
    if layers.len() > MAX_LAYERS {
        return value.refuse(format!("a coating has at most {MAX_LAYERS} layers, not {}", layers.len()));
    }
    Some((!layers.is_empty()).then(|| of_layers(layers)))
}

fn of_layers(layers: Vec<CoatingLayer<Asked>>) -> Coating<Asked> {
    Coating::new(layers, || Asked::Default(1.0))
}

fn layer(value: Value) -> Option<CoatingLayer<Asked>> {
    Fields::read(value, |fields| {
        let thickness = spectrum(fields, "thickness_nm");
        let [metal, n, index, k] = ["metal", "n", "index", "k"].map(|key| fields.get(key));
        let (index, k) = match (metal, n) {
            (None, None) => (spectrum(fields, "index"), spectrum_or(fields, "k", 0.0)),
            (Some(metal), None) if index.is_none() && k.is_none() => {
                let metal = Asked::There(metal.text().map(|_| metal)?);
                (metal, metal)
            }
            (None, Some(n)) if index.is_none() => (Asked::There(n), spectrum(fields, "k")),
            (Some(given), _) | (None, Some(given)) => {
                return given
                    .refuse("a layer has an `index` and its `k`, or it is of metal: a `metal`, or its `n` and `k`");
            }
        };
        Some(CoatingLayer { index, k, is_metal: metal.or(n).is_some(), thickness })
    })
}

/// The layer that a thin film is, of its index, if it has a thickness; none if that does not fit to its other keys,
/// which is told.
pub(super) fn film<'d>(fields: &mut Fields<'d>, index: Asked<'d>) -> Option<Option<Coating<Asked<'d>>>> {
    let (thickness, k) = (fields.get("thickness_nm"), fields.get("k"));
    match (thickness, k, fields.get("transmittance")) {
        (None, None, _) => Some(None),
        (None, Some(k), _) => k.refuse_key(
            "`k` goes with `thickness_nm`",
            Some("a pane without one absorbs by its `transmittance`".into()),
        ),
        (Some(_), _, Some(transmittance)) => {
            let help = "what a film absorbs is by its extinction: write `k`";
            transmittance.refuse_key("a film has a `thickness_nm` or a `transmittance`, not both", Some(help.into()))
        }
        (Some(thickness), k, None) => {
            let (k, thickness) = (k.map_or(Asked::Default(0.0), Asked::There), Asked::There(thickness));
            Some(Some(of_layers(vec![CoatingLayer { index, k, is_metal: false, thickness }])))
        }
    }
}
