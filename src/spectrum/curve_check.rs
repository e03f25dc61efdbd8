//! Whether a curve can be what it is used as.

use super::curve::sellmeier_squared;
use super::data;
use super::{Curve, CurveKind, Quantity};

type Refusal = (String, Option<String>);

/// Everything that makes a curve unusable as a quantity, found before a ray is shot.
pub(super) fn check(curve: &Curve, quantity: Quantity) -> Result<(), Refusal> {
    finite(curve)?;
    kind_fits(curve, quantity)?;
    match &curve.kind {
        CurveKind::Samples(samples) => ascending(samples)?,
        CurveKind::Sellmeier { b, c } => sellmeier(b, c)?,
        CurveKind::Abbe { vd, .. } if *vd <= 0.0 => {
            return refuse(format!("an Abbe number is positive, this one is {vd}"), None);
        }
        _ => {}
    }
    in_range(curve, quantity)
}

fn refuse(message: String, help: Option<String>) -> Result<(), Refusal> {
    Err((message, help))
}

fn finite(curve: &Curve) -> Result<(), Refusal> {
    let numbers: Vec<f64> = match &curve.kind {
        CurveKind::Number(x) => vec![*x],
        CurveKind::Rgb(rgb) => rgb.to_vec(),
        CurveKind::Samples(samples) => samples.concat(),
        CurveKind::Cauchy(ab) => ab.to_vec(),
        CurveKind::Sellmeier { b, c } => [b.as_slice(), c].concat(),
        CurveKind::Abbe { nd, vd } => vec![*nd, *vd],
        CurveKind::Name(_) => Vec::new(),
    };
    match numbers.iter().chain([&curve.scale]).find(|x| !x.is_finite()) {
        Some(x) => refuse(format!("a spectrum is made of finite numbers, this one holds {x}"), None),
        None => Ok(()),
    }
}

fn kind_fits(curve: &Curve, quantity: Quantity) -> Result<(), Refusal> {
    use Quantity::*;
    match (&curve.kind, quantity) {
        (CurveKind::Number(_) | CurveKind::Rgb(_), _) => Ok(()),
        (CurveKind::Samples(_), Index | Absorption | MetalIndex | MetalExtinction) => Ok(()),
        (CurveKind::Cauchy(_) | CurveKind::Sellmeier { .. } | CurveKind::Abbe { .. }, Index) => Ok(()),
        (CurveKind::Name(name), Index) => known(name, "glass", data::glass(name).is_some(), data::glass_names()),
        (CurveKind::Name(name), MetalIndex | MetalExtinction) => {
            known(name, "metal", data::metal(name).is_some(), data::metal_names())
        }
        (CurveKind::Name(name), _) => {
            refuse(format!("{} is a number or {{ rgb = [r, g, b] }}, not the name \"{name}\"", article(quantity)), None)
        }
        _ => refuse(format!("{} is a number or {{ rgb = [r, g, b] }} here", article(quantity)), None),
    }
}

fn known<'a>(name: &str, what: &str, found: bool, names: impl Iterator<Item = &'a str>) -> Result<(), Refusal> {
    if found {
        return Ok(());
    }
    let names: Vec<&str> = names.collect();
    let help = match crate::error::nearest(name, names.iter().copied()) {
        Some(near) => format!("did you mean \"{near}\"?"),
        None => format!("known names: {}", names.join(", ")),
    };
    refuse(format!("there is no {what} named \"{name}\""), Some(help))
}

fn ascending(samples: &[[f64; 2]]) -> Result<(), Refusal> {
    if samples.is_empty() {
        return refuse("a table of samples holds at least one [wavelength in nm, value]".into(), None);
    }
    if let Some(pair) = samples.windows(2).find(|pair| pair[1][0] <= pair[0][0]) {
        return refuse(format!("wavelengths must increase ({} after {} nm)", pair[1][0], pair[0][0]), None);
    }
    if samples[0][0] < 100.0 {
        let help = format!("wavelengths are in nm: did you mean {}?", samples[0][0] * 1e3);
        return refuse(format!("a wavelength of {} nm is far from visible light", samples[0][0]), Some(help));
    }
    Ok(())
}

fn sellmeier(b: &[f64], c: &[f64]) -> Result<(), Refusal> {
    if b.len() != c.len() || b.is_empty() {
        let (b, c) = (b.len(), c.len());
        return refuse(format!("a Sellmeier curve has as many b as c, at least one ({b} and {c} here)"), None);
    }
    let help = "c holds squared resonance wavelengths in um^2: square the coefficients if they are wavelengths";
    if let Some(pole) = c.iter().find(|&&c| c > 0.0 && (0.36..=0.83).contains(&c.sqrt())) {
        let nm = pole.sqrt() * 1e3;
        return refuse(format!("this Sellmeier curve has a pole at {nm:.0} nm, in visible light"), Some(help.into()));
    }
    for nm in 360..=830 {
        let squared = sellmeier_squared(b, c, f64::from(nm) * 1e-3);
        if squared.is_nan() || squared <= 0.0 {
            return refuse(format!("this Sellmeier curve gives n^2 = {squared:.3} at {nm} nm"), Some(help.into()));
        }
    }
    Ok(())
}

fn article(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Reflectance => "a reflectance",
        Quantity::Transmittance => "a transmittance",
        Quantity::Emission => "an emission",
        Quantity::Index => "a refractive index",
        Quantity::Absorption => "an absorption",
        Quantity::MetalIndex => "a metal's index n",
        Quantity::MetalExtinction => "a metal's extinction k",
    }
}

/// Every value between 360 and 830 nm is possible for the quantity.
fn in_range(curve: &Curve, quantity: Quantity) -> Result<(), Refusal> {
    let wavelengths = (360..=830).map(f64::from);
    let values: Vec<f64> = match &curve.kind {
        CurveKind::Number(x) => vec![x * curve.scale],
        CurveKind::Rgb(rgb) => rgb.iter().map(|x| x * curve.scale).collect(),
        CurveKind::Samples(samples) => samples.iter().map(|s| s[1] * curve.scale).collect(),
        _ => wavelengths.map(|nm| curve.at(quantity, nm)).collect(),
    };
    let name = article(quantity);
    for value in values {
        match quantity {
            Quantity::Reflectance | Quantity::Transmittance if !(0.0..=1.0).contains(&value) => {
                let percent =
                    (value > 1.0 && value <= 100.0).then(|| format!("in percent? Then write {}", value / 100.0));
                return refuse(format!("{name} lies within 0 and 1, not {value}"), percent);
            }
            Quantity::Index if value < 1.0 => {
                return refuse(format!("{name} is at least 1, not {value}"), None);
            }
            Quantity::Index if value > 10.0 => {
                return refuse(format!("{name} of {value} is beyond any glass; at most 10 is accepted"), None);
            }
            Quantity::MetalIndex if value <= 0.0 => return refuse(format!("{name} is above 0, not {value}"), None),
            Quantity::Emission | Quantity::Absorption | Quantity::MetalExtinction if value < 0.0 => {
                return refuse(format!("{name} is not negative, as {value} is"), None);
            }
            _ => {}
        }
    }
    Ok(())
}
