//! Whether a curve can be what it is used as.

use super::curve::sellmeier_squared;
use super::data;
use super::{Curve, CurveKind, Quantity};

/// Why a curve cannot be what it is used as.
#[derive(Clone, Debug, PartialEq)]
pub struct Refusal {
    /// What is wrong.
    pub message: String,
    /// What to do, where that is known.
    pub help: Option<String>,
    /// Keys within the curve's table that lead to the mistake; none if it is the whole curve.
    pub keys: &'static [&'static str],
    /// The entry of the list that these keys lead to, if it is one entry.
    pub entry: Option<usize>,
}

impl Refusal {
    fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), help: None, keys: &[], entry: None }
    }

    fn help(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }

    fn at(self, keys: &'static [&'static str], entry: impl Into<Option<usize>>) -> Self {
        Self { keys, entry: entry.into(), ..self }
    }
}

/// Largest emission: far within f32, which film and lanes hold.
const MAX_EMISSION: f64 = 1e30;
/// Largest n and k: several times those of any metal in visible light.
const MAX_METAL: f64 = 100.0;

const CAUCHY: &str = "for a glass, A is about 1.5 and B about 0.004 um^2";

/// Everything that makes a curve unusable as a quantity, found before a ray is shot.
pub(super) fn check(curve: &Curve, quantity: Quantity) -> Result<(), Refusal> {
    kind_fits(curve, quantity)?;
    finite(curve)?;
    match &curve.kind {
        CurveKind::Samples(samples) => ascending(samples)?,
        CurveKind::Sellmeier { b, c } => sellmeier(b, c)?,
        CurveKind::Abbe { vd, .. } if *vd <= 0.0 => {
            return Err(Refusal::new("an Abbe number is above 0").at(&["abbe", "vd"], None));
        }
        _ => {}
    }
    in_range(curve, quantity)
}

fn kind_fits(curve: &Curve, quantity: Quantity) -> Result<(), Refusal> {
    use Quantity::*;
    match (&curve.kind, quantity) {
        (CurveKind::Number(_) | CurveKind::Rgb(_), _) => Ok(()),
        (CurveKind::Samples(_), Index | Absorption | MetalIndex | MetalExtinction) => Ok(()),
        (CurveKind::Cauchy(_) | CurveKind::Sellmeier { .. } | CurveKind::Abbe { .. }, Index) => Ok(()),
        (CurveKind::Name(name), Index) if data::glass(name).is_some() => Ok(()),
        (CurveKind::Name(name), MetalIndex | MetalExtinction) if data::metal(name).is_some() => Ok(()),
        (CurveKind::Name(name), Index) => {
            let other = data::metal(name).map(|metal| format!("a metal: conductor = {{ metal = \"{}\" }}", metal.name));
            Err(unknown(name, "glass", data::known_as(), other))
        }
        (CurveKind::Name(name), MetalIndex | MetalExtinction) => {
            let other =
                data::glass(name).map(|glass| format!("a glass: dielectric = {{ index = \"{}\" }}", glass.name()));
            let names = data::metals().flat_map(|metal| [vec![metal.name], metal.aliases].concat());
            Err(unknown(name, "metal", names, other))
        }
        (kind, _) => {
            let message = format!("{} cannot be given by {}", article(quantity), form(kind));
            Err(Refusal::new(message).help("write a number or { rgb = [red, green, blue] }"))
        }
    }
}

fn unknown<'a>(name: &str, what: &str, names: impl Iterator<Item = &'a str>, other: Option<String>) -> Refusal {
    let near = crate::error::nearest(name, names);
    let help = match (other, near) {
        (Some(other), _) => format!("it is {other}"),
        (None, Some(near)) => format!("did you mean \"{near}\"?"),
        (None, None) => format!("`render catalog {what}` lists the known names"),
    };
    Refusal::new(format!("there is no {what} named {name:?}")).help(help)
}

fn finite(curve: &Curve) -> Result<(), Refusal> {
    let lists: Vec<(&'static [&'static str], &[f64])> = match &curve.kind {
        CurveKind::Number(x) => vec![(&[], std::slice::from_ref(x))],
        CurveKind::Rgb(rgb) => vec![(&["rgb"], rgb)],
        CurveKind::Samples(samples) => samples.iter().map(|pair| (&["samples"] as _, pair.as_slice())).collect(),
        CurveKind::Cauchy(ab) => vec![(&["cauchy"], ab)],
        CurveKind::Sellmeier { b, c } => vec![(&["sellmeier", "b"], b), (&["sellmeier", "c"], c)],
        CurveKind::Abbe { nd, vd } => {
            vec![(&["abbe", "nd"], std::slice::from_ref(nd)), (&["abbe", "vd"], std::slice::from_ref(vd))]
        }
        CurveKind::Name(_) => Vec::new(),
    };
    let scale: (&[&str], &[f64]) = (&["scale"], std::slice::from_ref(&curve.scale));
    for (number, (keys, list)) in lists.into_iter().chain([scale]).enumerate() {
        if let Some(entry) = list.iter().position(|x| !x.is_finite()) {
            let message = format!("a spectrum is made of finite numbers, not {}", list[entry]);
            return Err(Refusal::new(message).at(keys, if keys == ["samples"] { number } else { entry }));
        }
    }
    Ok(())
}

fn ascending(samples: &[[f64; 2]]) -> Result<(), Refusal> {
    let Some([first, _]) = samples.first() else {
        return Err(Refusal::new("a table of samples holds at least one [wavelength in nm, value]"));
    };
    if let Some(i) = samples.windows(2).position(|pair| pair[1][0] <= pair[0][0]) {
        let message =
            format!("wavelengths increase from sample to sample ({} after {})", samples[i + 1][0], samples[i][0]);
        return Err(Refusal::new(message).at(&["samples"], i + 1));
    }
    if (100.0..=830.0).contains(first) {
        return Ok(());
    }
    let refusal =
        Refusal::new(format!("a first wavelength of {first} nm is far from visible light")).at(&["samples"], 0);
    let other_units = [("um", 1e3), ("Angstrom", 0.1)].into_iter();
    let meant = other_units.map(|(unit, nm)| (unit, first * nm)).find(|(_, nm)| (100.0..=830.0).contains(nm));
    Err(match meant {
        Some((unit, nm)) => refusal.help(format!("in {unit}? Wavelengths are in nm: then write {}", shown(nm))),
        None => refusal.help("wavelengths are in nm"),
    })
}

fn sellmeier(b: &[f64], c: &[f64]) -> Result<(), Refusal> {
    if b.len() != c.len() || b.is_empty() {
        let message = format!("a Sellmeier curve has as many b as c, here {} and {}", b.len(), c.len());
        return Err(Refusal::new(message).at(&["sellmeier"], None));
    }
    let help = "c holds squared wavelengths in um^2: square the coefficients if they are wavelengths";
    if let Some(pole) = c.iter().position(|&c| c > 0.0 && (0.36..=0.83).contains(&c.sqrt())) {
        let message = format!("this Sellmeier curve has a pole at {:.0} nm, in visible light", c[pole].sqrt() * 1e3);
        return Err(Refusal::new(message).help(help).at(&["sellmeier", "c"], pole));
    }
    for nm in 360..=830 {
        let squared = sellmeier_squared(b, c, f64::from(nm) * 1e-3);
        if squared.is_nan() || squared <= 0.0 {
            let message = format!("this Sellmeier curve gives n^2 = {} at {nm} nm", shown(squared));
            return Err(Refusal::new(message).help(help).at(&["sellmeier"], None));
        }
    }
    Ok(())
}

/// Every value between 360 and 830 nm is possible for the quantity.
fn in_range(curve: &Curve, quantity: Quantity) -> Result<(), Refusal> {
    let scale = if curve.scale == 1.0 { String::new() } else { format!(" with its scale of {}", shown(curve.scale)) };
    let list = |keys, values: &[f64]| {
        let mut scaled = values.iter().map(|x| x * curve.scale).enumerate();
        scaled
            .try_for_each(|(entry, value)| possible(quantity, value, &scale).map_err(|refusal| refusal.at(keys, entry)))
    };
    match &curve.kind {
        CurveKind::Number(x) => possible(quantity, x * curve.scale, ""),
        CurveKind::Rgb(rgb) => list(&["rgb"], rgb),
        CurveKind::Samples(samples) => list(&["samples"], &samples.iter().map(|pair| pair[1]).collect::<Vec<_>>()),
        kind => (360..=830).try_for_each(|nm| {
            let value = curve.at(quantity, f64::from(nm));
            possible(quantity, value, &format!(" at {nm} nm")).map_err(|refusal| match kind {
                CurveKind::Cauchy(_) => refusal.help(CAUCHY).at(&["cauchy"], None),
                _ => refusal,
            })
        }),
    }
}

fn possible(quantity: Quantity, value: f64, place: &str) -> Result<(), Refusal> {
    let name = article(quantity);
    let (least, most) = match quantity {
        Quantity::Reflectance | Quantity::Transmittance => (0.0, 1.0),
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
        Quantity::Reflectance | Quantity::Transmittance if (2.0..=100.0).contains(&value) => {
            refusal.help(format!("in percent? Then write {}", shown(value / 100.0)))
        }
        Quantity::Reflectance | Quantity::Transmittance if (100.0..=255.0).contains(&value) => {
            refusal.help("a color from 0 to 255 is sRGB: its linear value is about (v / 255)^2.2")
        }
        _ => refusal,
    })
}

/// Six digits of a number.
fn shown(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    if rounded == 0.0 || (1e-4..1e15).contains(&rounded.abs()) { rounded.to_string() } else { format!("{rounded:e}") }
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

fn form(kind: &CurveKind) -> String {
    match kind {
        CurveKind::Number(_) => "a number".into(),
        CurveKind::Rgb(_) => "`rgb`".into(),
        CurveKind::Samples(_) => "`samples`".into(),
        CurveKind::Cauchy(_) => "`cauchy`".into(),
        CurveKind::Sellmeier { .. } => "`sellmeier`".into(),
        CurveKind::Abbe { .. } => "`abbe`".into(),
        CurveKind::Name(name) => format!("the name {name:?}"),
    }
}
