//! Materials, each read by itself.

use std::collections::BTreeMap;

use super::camera::extinction;
use super::coating::{coating, thin};
use super::context::Context;
use super::curve_text::CurveText;
use super::fluorescence::{check_conservation, diffuse, dye_values};
use super::image::surface_curve;
use super::ranges::{direction, small_retardance, small_retardation};
use super::spectrum_draft::{SpectrumDraft, spectrum, spectrum_or};
use crate::material::{
    Coat, Conductor, Dielectric, Emissive, Material, Mirror, PathDifference, Plastic, Polarizer, Retardance, Retarder,
    Roughness,
};
use crate::scene::text::{Choice, Fields, Value, exactly, six_digits};
use crate::shape::Sides;
use crate::spectrum::{Curve, Quantity};

/// A material read by itself. A mix or a mask still holds the values that name its parts.
pub(super) enum MaterialDraft<'d, S> {
    Whole(Material<S>),
    Mix { parts: [Value<'d>; 2], amount: S },
    Mask { part: Value<'d>, opacity: S },
}

/// Reads a roughness from 0, which is smooth, to 1. Returns 0 if it is wrong, which is recorded as a mistake.
fn roughness(fields: &mut Fields) -> f64 {
    let rule = "a roughness lies between 0 (smooth) and 1";
    let read = |value: Value| match value.number()? {
        percent if (2.0..=100.0).contains(&percent) => {
            let help = format!("if this is in percent, write {}", six_digits(percent / 100.0));
            value.advise(format!("{rule}, not {percent}"), help)
        }
        _ => value.number_within(0.0..=1.0, rule, None),
    };
    fields.or("roughness", 0.0, read).unwrap_or_default()
}

/// The reader of a kind of material. It receives the table of the kind as a value and as fields.
type MaterialReader =
    for<'d> fn(&mut Context, Value<'d>, &mut Fields<'d>) -> Option<MaterialDraft<'d, SpectrumDraft<'d>>>;

/// The kinds of materials. Each is documented where it is implemented, in `material`.
const MATERIAL: Choice<MaterialReader> = Choice {
    name: "a material",
    word: "kind of material",
    example: "diffuse = { reflectance = 0.7 }",
    second_kind_help: "give each kind its own [material.NAME]",
    outside_keys: &[],
    kinds: &[
        ("diffuse", |_, _, fields| Some(MaterialDraft::Whole(Material::Diffuse(diffuse(fields)?)))),
        ("mirror", |_, _, fields| {
            Some(MaterialDraft::Whole(Material::Mirror(Mirror {
                reflectance: spectrum_or(fields, "reflectance", 1.0),
            })))
        }),
        ("conductor", conductor),
        ("dielectric", |_, _, fields| dielectric(fields)),
        ("thin", |_, _, fields| Some(MaterialDraft::Whole(Material::Thin(thin(fields)?)))),
        ("emissive", |_, _, fields| {
            let radiance = spectrum(fields, "radiance");
            let words = [("both", Sides::Both), ("front", Sides::Front)];
            let sides = fields.or("sides", Sides::Both, |value| value.word(&words)).unwrap_or_default();
            Some(MaterialDraft::Whole(Material::Emissive(Emissive { radiance, sides })))
        }),
        ("plastic", |_, _, fields| {
            let (reflectance, index) = (spectrum(fields, "reflectance"), spectrum_or(fields, "index", 1.5));
            let (coat, coating) = (Coat::new(roughness(fields)), coating(fields));
            Some(MaterialDraft::Whole(Material::Plastic(Plastic { reflectance, index, coat, coating: coating? })))
        }),
        ("polarizer", |_, _, fields| {
            let (axis, extinction) = (fields.need("axis", direction), fields.or("extinction", 0.0, extinction));
            Some(MaterialDraft::Whole(Material::Polarizer(Polarizer { axis: axis?, extinction: extinction? })))
        }),
        ("retarder", |context, _, fields| {
            let (axis, retardance) = (fields.need("axis", direction), retardance(context, fields));
            Some(MaterialDraft::Whole(Material::Retarder(Retarder { axis: axis?, retardance: retardance? })))
        }),
        ("mix", |_, _, fields| {
            let parts = fields.need("materials", two_names);
            let amount = spectrum(fields, "amount");
            Some(MaterialDraft::Mix { parts: parts?, amount })
        }),
        ("mask", |_, _, fields| {
            let part = fields.need("material", name);
            let opacity = spectrum(fields, "opacity");
            Some(MaterialDraft::Mask { part: part?, opacity })
        }),
    ],
};

/// Reads how far light along the fast axis is ahead: in degrees, or as a length.
fn retardance(context: &mut Context, fields: &mut Fields) -> Option<Retardance> {
    let (phase, path) = (fields.get("retardance"), fields.get("retardation_nm"));
    match (phase, path) {
        (Some(phase), None) => {
            let help = "in degrees: 90 for a quarter-wave plate, 180 for a half-wave plate";
            let rule = "a retardance lies between -360 and 360 degrees";
            let degrees = phase.number_within(-360.0..=360.0, rule, Some(help))?;
            small_retardance(degrees).into_iter().for_each(|warning| context.warn_at(phase, warning));
            Some(Retardance::Phase(degrees))
        }
        (None, Some(path)) => {
            let rule = format!("a retardation lies between -{MAX_RETARDATION_NM} and {MAX_RETARDATION_NM} nm");
            let help = "in nm: 137.5 for a quarter-wave plate at 550 nm";
            let nm = path.number_within(-MAX_RETARDATION_NM..=MAX_RETARDATION_NM, &rule, Some(help))?;
            if nm != 0.0 && nm.abs() < MIN_RETARDATION_NM {
                let in_nm = nm * 1e9;
                let help = match in_nm.abs() {
                    1.0..=MAX_RETARDATION_NM => format!("it is in nm: if this is in m, write {}", six_digits(in_nm)),
                    _ => help.to_owned(),
                };
                return path.advise(format!("a retardation of {} nm changes no light", six_digits(nm)), help);
            }
            small_retardation(nm).into_iter().for_each(|warning| context.warn_at(path, warning));
            Some(Retardance::Path(PathDifference { nm }))
        }
        (Some(_), Some(path)) => path.refuse_key(
            "a retarder has a `retardance` or a `retardation_nm`, not both",
            Some("`retardance` is the same in degrees at every wavelength, `retardation_nm` the same in nm".into()),
        ),
        (None, None) if fields.is_misspelled("retardation_nm") => None,
        (None, None) => fields.report_missing("retardance", Some("in degrees; or `retardation_nm`, in nm")),
    }
}

/// Largest path difference in nm: 1 mm.
const MAX_RETARDATION_NM: f64 = 1e6;
/// Smallest path difference in nm, at which 3 parts in 10^9 of polarized light change. A smaller number is most likely
/// in m.
const MIN_RETARDATION_NM: f64 = 0.01;

fn conductor<'d>(
    _: &mut Context,
    value: Value<'d>,
    fields: &mut Fields<'d>,
) -> Option<MaterialDraft<'d, SpectrumDraft<'d>>> {
    let (metal, n, k) = (fields.get("metal"), fields.get("n"), fields.get("k"));
    let (roughness, coating) = (Roughness::new(roughness(fields)), coating(fields));
    let [n, k] = match (metal, n, k) {
        // A metal gives both n and k.
        (Some(metal), None, None) => [SpectrumDraft::Given(name(metal)?); 2],
        (None, Some(n), Some(k)) => [n, k].map(SpectrumDraft::Given),
        _ if fields.has_unknown() => return None,
        _ => return value.refuse("a conductor needs either `metal`, or both `n` and `k`"),
    };
    Some(MaterialDraft::Whole(Material::Conductor(Conductor::new([n, k], roughness, coating?))))
}

fn dielectric<'d>(fields: &mut Fields<'d>) -> Option<MaterialDraft<'d, SpectrumDraft<'d>>> {
    let coating = coating(fields);
    Some(MaterialDraft::Whole(Material::Dielectric(Dielectric {
        index: spectrum(fields, "index"),
        reflectance: spectrum_or(fields, "reflectance", 1.0),
        transmittance: spectrum_or(fields, "transmittance", 1.0),
        emission: spectrum_or(fields, "emission", 0.0),
        absorption: spectrum_or(fields, "absorption", 0.0),
        priority: fields.or("priority", 0, Value::integer).unwrap_or_default(),
        roughness: Roughness::new(roughness(fields)),
        coating: coating?,
    })))
}

fn two_names(value: Value) -> Option<[Value; 2]> {
    exactly(value.list(name)?, |count| value.refuse(format!("a mix is made of 2 materials, not {count}")))
}

/// Reads a text in quotes, and returns its place.
fn name(value: Value) -> Option<Value> {
    value.text().map(|_| value)
}

/// All materials, each read by itself. A material with a mistake has an entry without a draft.
pub(super) struct MaterialDrafts<'d> {
    pub(super) by_name: BTreeMap<&'d str, Option<MaterialDraft<'d, Curve>>>,
    /// Whether there are other materials whose names are not known.
    pub(super) has_unnamed: bool,
}

/// Reads the materials of a scene.
pub(super) fn drafts<'d>(context: &mut Context, value: Value<'d>) -> MaterialDrafts<'d> {
    let mut drafts = MaterialDrafts { by_name: BTreeMap::new(), has_unnamed: !value.node().is_table() };
    if value.node().is_array() {
        value.advise::<()>("`material` is a table, not a list", "write [material.NAME] for each");
        return drafts;
    }
    let mut coats = BTreeMap::new();
    for material in value.table().unwrap_or_default() {
        let mut draft = MATERIAL.kind(material).and_then(|kind| {
            let word = material.key();
            if MATERIAL.knows(word) && !MATERIAL.knows(kind.key()) {
                drafts.has_unnamed = true;
                let help = format!("write [material.NAME] above {word} = {{ .. }}");
                return kind.refuse_key("this material has no name", Some(help));
            }
            let read = MATERIAL.reader(kind)?;
            Fields::read(kind, |fields| {
                let draft = read(context, kind, fields)?;
                resolved(context, draft)
            })
        });
        if let Some(MaterialDraft::Whole(material)) = &mut draft {
            share_tables(&mut coats, material);
        }
        drafts.by_name.insert(material.key(), draft);
    }
    drafts
}

/// Lets materials of equal roughness share their tables, which take 10 ms to a second to compute. `coats` has a coat
/// for each roughness so far, keyed by its bits.
fn share_tables(coats: &mut BTreeMap<u64, Coat>, material: &mut Material<Curve>) {
    let mut coat = |value: f64| coats.entry(value.to_bits()).or_insert_with(|| Coat::new(value)).clone();
    match material {
        Material::Plastic(Plastic { coat: of, .. }) => *of = coat(of.roughness().value()),
        Material::Conductor(Conductor { roughness, .. }) | Material::Dielectric(Dielectric { roughness, .. }) => {
            *roughness = coat(roughness.value()).roughness().clone();
        }
        _ => {}
    }
}

/// Resolves the spectra that the keys of a material give.
fn resolved<'d>(
    context: &mut Context,
    raw_draft: MaterialDraft<'d, SpectrumDraft<'d>>,
) -> Option<MaterialDraft<'d, Curve>> {
    let mut is_valid = true;
    let mut curve = |quantity, draft: &SpectrumDraft<'d>| {
        let curve = match *draft {
            SpectrumDraft::Given(value) => {
                CurveText::read(value, quantity).and_then(|text| surface_curve(context, &text, quantity))
            }
            SpectrumDraft::Default(value) => Some(value.into()),
            SpectrumDraft::Missing => None,
        };
        is_valid &= curve.is_some();
        curve.unwrap_or_else(|| 0.0.into())
    };
    let dye = match &raw_draft {
        MaterialDraft::Whole(Material::Diffuse(diffuse)) => dye_values(diffuse),
        _ => None,
    };
    let draft = match raw_draft {
        MaterialDraft::Whole(material) => MaterialDraft::Whole(material.map(&mut curve)),
        MaterialDraft::Mix { parts, amount } => MaterialDraft::Mix { parts, amount: curve(Quantity::Share, &amount) },
        MaterialDraft::Mask { part, opacity } => {
            MaterialDraft::Mask { part, opacity: curve(Quantity::Share, &opacity) }
        }
    };
    if let (true, Some(dye), MaterialDraft::Whole(Material::Diffuse(diffuse))) = (is_valid, dye, &draft) {
        check_conservation(diffuse, dye)?;
    }
    is_valid.then_some(draft)
}
