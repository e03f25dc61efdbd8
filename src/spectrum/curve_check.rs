//! Whether a curve can be what it is used as.

use super::curve::sellmeier_squared;
use super::curve_range::{article, in_range, shown};
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
    pub(super) fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), help: None, keys: &[], entry: None }
    }

    pub(super) fn help(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }

    pub(super) fn at(self, keys: &'static [&'static str], entry: impl Into<Option<usize>>) -> Self {
        Self { keys, entry: entry.into(), ..self }
    }
}

pub(super) const CAUCHY: &str = "for a glass, A is about 1.5 and B about 0.004 um^2";

/// Everything that makes a curve unusable as a quantity, found before a ray is shot.
pub(super) fn check(curve: &Curve, quantity: Quantity) -> Result<(), Refusal> {
    kind_fits(curve, quantity)?;
    finite(curve)?;
    match &curve.kind {
        CurveKind::Samples(samples) => ascending(samples)?,
        CurveKind::Lines(lines) => visible_lines(lines)?,
        CurveKind::Blackbody(kelvin) if !(100.0..=1e9).contains(kelvin) => {
            let refusal = Refusal::new(format!("a blackbody has 100 to 1e9 kelvin, not {}", shown(*kelvin)));
            return Err(refusal.help("a candle has 1900, the sun 5772").at(&["blackbody"], None));
        }
        CurveKind::Sellmeier { b, c } => sellmeier(b, c)?,
        CurveKind::Abbe { vd, .. } if *vd <= 0.0 => {
            return Err(Refusal::new("an Abbe number is above 0").at(&["abbe", "vd"], None));
        }
        _ => {}
    }
    in_range(curve, quantity)
}

fn kind_fits(curve: &Curve, quantity: Quantity) -> Result<(), Refusal> {
    use CurveKind::*;
    use Quantity::{Emission, Index, MetalExtinction, MetalIndex, Reflectance, Transmittance};
    if curve.luminance.is_some() && quantity != Emission {
        let refusal = Refusal::new(format!("{} has no luminance", article(quantity)));
        return Err(refusal.help("use `scale`").at(&["luminance"], None));
    }
    match (&curve.kind, quantity) {
        (Number(_) | Rgb(_) | Samples(_), _) => Ok(()),
        (Cauchy(_) | Sellmeier { .. } | Abbe { .. }, Index) => Ok(()),
        (Illuminant(name), Emission) if data::illuminant(name).is_some() => Ok(()),
        (Blackbody(_) | Lines(_), Emission) => Ok(()),
        (Name(name), Index) if data::glass(name).is_some() => Ok(()),
        (Name(name), MetalIndex | MetalExtinction) if data::metal(name).is_some() => Ok(()),
        (Name(name), Reflectance | Transmittance) if data::reflectance(name).is_some() => Ok(()),
        (Illuminant(name), Emission) => {
            let names = data::illuminants().map(|illuminant| illuminant.name);
            Err(unknown(name, "illuminant", names, None).at(&["illuminant"], None))
        }
        (Name(name), Index) => Err(unknown_glass(name)),
        (Name(name), MetalIndex | MetalExtinction) => {
            let other =
                data::glass(name).map(|glass| format!("a glass: dielectric = {{ index = \"{}\" }}", glass.name()));
            let names = data::metals().flat_map(|metal| [vec![metal.name], metal.aliases].concat());
            Err(unknown(name, "metal", names, other))
        }
        (Name(name), Reflectance | Transmittance) => {
            let other = data::metal(name).map(|metal| format!("a metal: conductor = {{ metal = \"{}\" }}", metal.name));
            Err(unknown(name, "reflectance", data::reflectances().map(|patch| patch.name), other))
        }
        (Name(name), Emission) if data::illuminant(name).is_some() => {
            let refusal = Refusal::new(format!("{} cannot be given by {}", article(quantity), form(&curve.kind)));
            Err(refusal.help(format!("it is an illuminant: write {{ illuminant = \"{name}\" }}")))
        }
        (kind, Emission) => {
            let message = format!("{} cannot be given by {}", article(quantity), form(kind));
            Err(Refusal::new(message).help("write a number, { rgb = [red, green, blue] } or { illuminant = \"D65\" }"))
        }
        (kind, _) => {
            let message = format!("{} cannot be given by {}", article(quantity), form(kind));
            Err(Refusal::new(message).help("write a number or { rgb = [red, green, blue] }"))
        }
    }
}

/// A name that no glass has.
pub(super) fn unknown_glass(name: &str) -> Refusal {
    let metal = data::metal(name).map(|metal| format!("a metal: conductor = {{ metal = \"{}\" }}", metal.name));
    unknown(name, "glass", data::known_as(), metal)
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
        CurveKind::Lines(lines) => lines.iter().map(|pair| (&["lines"] as _, pair.as_slice())).collect(),
        CurveKind::Blackbody(kelvin) => vec![(&["blackbody"], std::slice::from_ref(kelvin))],
        CurveKind::Name(_) | CurveKind::File { .. } | CurveKind::Illuminant(_) => Vec::new(),
    };
    let scale: (&[&str], &[f64]) = (&["scale"], std::slice::from_ref(&curve.scale));
    let luminance: (&[&str], &[f64]) = (&["luminance"], curve.luminance.as_slice());
    for (number, (keys, list)) in lists.into_iter().chain([scale, luminance]).enumerate() {
        if let Some(entry) = list.iter().position(|x| !x.is_finite()) {
            let message = format!("a spectrum is made of finite numbers, not {}", list[entry]);
            let pairs = keys == ["samples"] || keys == ["lines"];
            return Err(Refusal::new(message).at(keys, if pairs { number } else { entry }));
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

fn visible_lines(lines: &[[f64; 2]]) -> Result<(), Refusal> {
    if lines.is_empty() {
        return Err(Refusal::new("a light of lines has at least one [wavelength in nm, power]"));
    }
    match lines.iter().position(|[nm, _]| !(360.0..=830.0).contains(nm)) {
        Some(entry) => {
            let message = format!("a line lies within 360 to 830 nm, not at {}", shown(lines[entry][0]));
            Err(Refusal::new(message).at(&["lines"], entry))
        }
        None => Ok(()),
    }
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

fn form(kind: &CurveKind) -> String {
    match kind {
        CurveKind::Number(_) => "a number".into(),
        CurveKind::Rgb(_) => "`rgb`".into(),
        CurveKind::Samples(_) => "`samples`".into(),
        CurveKind::Cauchy(_) => "`cauchy`".into(),
        CurveKind::Sellmeier { .. } => "`sellmeier`".into(),
        CurveKind::Abbe { .. } => "`abbe`".into(),
        CurveKind::File { .. } => "`file`".into(),
        CurveKind::Illuminant(_) => "`illuminant`".into(),
        CurveKind::Blackbody(_) => "`blackbody`".into(),
        CurveKind::Lines(_) => "`lines`".into(),
        CurveKind::Name(name) => format!("the name {name:?}"),
    }
}
