//! Whether every value of a curve is possible for what it describes.

use super::curve_check::{ABBE, CAUCHY, Refusal, SELLMEIER};
use super::{Curve, CurveKind, Quantity};

/// Largest emission: far within f32, which film and lanes hold.
const MAX_EMISSION: f64 = 1e30;
const PERCENT: &str = "in percent?";
/// Largest n and k: several times those of any metal in visible light.
const MAX_METAL: f64 = 100.0;

/// Every value between 360 and 830 nm is possible for the quantity.
pub(super) fn in_range(curve: &Curve, quantity: Quantity) -> Result<(), Refusal> {
    let scale = if curve.scale == 1.0 { String::new() } else { format!(" with its scale of {}", shown(curve.scale)) };
    let list = |keys, values: &[f64]| {
        let mut scaled = values.iter().map(|x| x * curve.scale).enumerate();
        scaled
            .try_for_each(|(entry, value)| possible(quantity, value, &scale).map_err(|refusal| refusal.at(keys, entry)))
    };
    match &curve.kind {
        CurveKind::Number(x) => possible(quantity, x * curve.scale, ""),
        CurveKind::Rgb(rgb) => list(&["rgb"], rgb),
        CurveKind::Samples(samples) => {
            let values: Vec<f64> = samples.iter().map(|pair| pair[1]).collect();
            list(&["samples"], &values).map_err(|refusal| match &refusal.help {
                Some(help) if help.starts_with(PERCENT) && curve.scale == 1.0 => {
                    refusal.help(format!("{PERCENT} Then add scale = 0.01"))
                }
                _ => refusal,
            })
        }
        CurveKind::Lines(lines) => list(&["lines"], &lines.iter().map(|pair| pair[1]).collect::<Vec<_>>()),
        CurveKind::Illuminant(_) | CurveKind::Blackbody(_) => factor("a scale", curve.scale, &["scale"]),
        kind => {
            let value = curve.plain_reader(quantity);
            (360..=830).try_for_each(|nm| {
                let value = value(f64::from(nm));
                let place = format!(" at {nm} nm");
                let formula = !matches!(kind, CurveKind::Name(_));
                let below = if formula && value == 1.0 { Err(nothing_bends(&place)) } else { Ok(()) };
                below.and_then(|()| possible(quantity, value, &place)).map_err(|refusal| match kind {
                    CurveKind::Cauchy([_, b]) if (500.0..100_000.0).contains(b) => {
                        let help = format!("B in nm^2? It is in um^2: then write {}", shown(b * 1e-6));
                        refusal.help(help).at(&["cauchy"], 1)
                    }
                    CurveKind::Cauchy(_) => refusal.help(CAUCHY).at(&["cauchy"], None),
                    CurveKind::Sellmeier { c, .. } if c.iter().all(|&c| c > 1e3) => {
                        refusal.help("c in nm^2? It is in um^2: divide it by 1e6").at(&["sellmeier", "c"], None)
                    }
                    CurveKind::Sellmeier { .. } => refusal.help(SELLMEIER).at(&["sellmeier"], None),
                    CurveKind::Abbe { .. } => refusal.help(ABBE).at(&["abbe"], None),
                    _ => refusal,
                })
            })
        }
    }?;
    match curve.luminance {
        Some(luminance) => factor("a luminance", luminance, &["luminance"]),
        None => Ok(()),
    }
}

/// An index of exactly 1 from a formula: its coefficients are 0 or in another unit.
fn nothing_bends(place: &str) -> Refusal {
    Refusal::new(format!("a refractive index is above 1, not 1{place}"))
}

/// A number by which a whole light is made brighter or darker.
fn factor(name: &str, value: f64, keys: &'static [&'static str]) -> Result<(), Refusal> {
    let bound = match value {
        _ if value < 0.0 => "at least 0".to_owned(),
        _ if value > MAX_EMISSION => format!("at most {}", shown(MAX_EMISSION)),
        _ => return Ok(()),
    };
    Err(Refusal::new(format!("{name} is {bound}, not {}", shown(value))).at(keys, None))
}

fn possible(quantity: Quantity, value: f64, place: &str) -> Result<(), Refusal> {
    let name = article(quantity);
    let (least, most) = match quantity {
        Quantity::Reflectance | Quantity::Transmittance | Quantity::Share => (0.0, 1.0),
        Quantity::Emission => (0.0, MAX_EMISSION),
        Quantity::Index => (1.0, 10.0),
        Quantity::Absorption => (0.0, f64::MAX),
        Quantity::MetalIndex => (f64::MIN_POSITIVE, MAX_METAL),
        Quantity::MetalExtinction => (0.0, MAX_METAL),
    };
    if (least..=most).contains(&value) {
        return Ok(());
    }
    let shown_value = shown(value);
    let refusal = Refusal::new(match quantity {
        Quantity::MetalIndex if value <= 0.0 => format!("{name} is above 0, not {shown_value}{place}"),
        _ if value < least => format!("{name} is at least {least}, not {shown_value}{place}"),
        _ => format!("{name} is at most {}, not {shown_value}{place}", shown(most)),
    });
    Err(match quantity {
        Quantity::Reflectance | Quantity::Transmittance | Quantity::Share if (2.0..=100.0).contains(&value) => {
            refusal.help(format!("{PERCENT} Then write {}", shown(value / 100.0)))
        }
        Quantity::Reflectance | Quantity::Transmittance | Quantity::Share if (100.0..=255.0).contains(&value) => {
            refusal.help("a color from 0 to 255 is sRGB: its linear value is about (v / 255)^2.2")
        }
        _ => refusal,
    })
}

/// Six digits of a number.
pub(super) fn shown(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    if rounded == 0.0 || (1e-4..1e15).contains(&rounded.abs()) { rounded.to_string() } else { format!("{rounded:e}") }
}

pub(super) fn article(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Reflectance => "a reflectance",
        Quantity::Transmittance => "a transmittance",
        Quantity::Share => "a share",
        Quantity::Emission => "an emission",
        Quantity::Index => "a refractive index",
        Quantity::Absorption => "an absorption",
        Quantity::MetalIndex => "a metal's index n",
        Quantity::MetalExtinction => "a metal's extinction k",
    }
}
