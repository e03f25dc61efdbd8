//! Whether a curve can be what it is used as.

use super::curve::sellmeier_squared;
use super::curve_name::{illuminant_called, unknown_glass, unknown_illuminant, unknown_metal, unknown_reflectance};
use super::curve_range::{article, in_range, shown};
use super::{ColorSpace, Curve, CurveKind, Emission, Quantity, data};

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
pub(super) const SELLMEIER: &str =
    "c holds squared wavelengths in um^2: square the coefficients if they are wavelengths";
pub(super) const ABBE: &str = "for a glass, nd is about 1.4 to 2.1 and vd 18 to 95";

/// Everything that makes a curve unusable as a quantity, found before a ray is shot.
pub(super) fn check(curve: &Curve, quantity: Quantity) -> Result<(), Refusal> {
    kind_fits(curve, quantity)?;
    finite(curve)?;
    match &curve.kind {
        CurveKind::Samples(samples) => {
            ascending(samples)?;
            if let ([[nm, power]], Quantity::Emission) = (samples.as_slice(), quantity) {
                let refusal = Refusal::new("an emission of one sample is dark: it is 0 beyond its ends");
                let help = format!("for one wavelength write {{ lines = [[{nm}, {power}]] }}");
                return Err(refusal.help(help).at(&["samples"], 0));
            }
        }
        CurveKind::Lines(lines) => visible_lines(lines)?,
        CurveKind::Blackbody(kelvin) => blackbody(*kelvin)?,
        CurveKind::Sellmeier { b, c } => sellmeier(b, c)?,
        CurveKind::Abbe { vd, .. } if *vd <= 0.0 => {
            return Err(Refusal::new("an Abbe number is above 0").at(&["abbe", "vd"], None));
        }
        CurveKind::Abbe { nd, .. } if *nd <= 1.0 => {
            let refusal = Refusal::new(format!("a refractive index is above 1, not {}", shown(*nd)));
            return Err(refusal.help(ABBE).at(&["abbe", "nd"], None));
        }
        _ => {}
    }
    in_range(curve, quantity)?;
    let dark = |curve: &Curve| !Emission::new(curve, ColorSpace::default()).xyz()[1].is_normal();
    if curve.luminance.is_some_and(|luminance| luminance > 0.0) && dark(curve) {
        return Err(Refusal::new("a light without power has no luminance").at(&["luminance"], None));
    }
    Ok(())
}

fn kind_fits(curve: &Curve, quantity: Quantity) -> Result<(), Refusal> {
    use CurveKind::*;
    use Quantity::{Emission, Index, MetalExtinction, MetalIndex, Reflectance, Share, Transmittance};
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
        (Name(name), Reflectance | Transmittance | Share) if data::reflectance(name).is_some() => Ok(()),
        (Illuminant(name), Emission) => Err(unknown_illuminant(name).at(&["illuminant"], None)),
        (Name(name), Index) => Err(unknown_glass(name)),
        (Name(name), MetalIndex | MetalExtinction) => Err(unknown_metal(name)),
        (Name(name), Reflectance | Transmittance | Share) => Err(unknown_reflectance(name)),
        (kind @ (Image(_) | Checker { .. }), _) => Err(no_surface(kind, quantity)),
        (kind, _) => {
            let refusal = Refusal::new(format!("{} cannot be given by {}", article(quantity), form(kind)));
            let light = if let (Name(name), Emission) = (kind, quantity) { illuminant_called(name) } else { None };
            Err(refusal.help(light.unwrap_or_else(|| forms(quantity).into())))
        }
    }
}

/// Why something cannot vary over a surface.
fn no_surface(kind: &CurveKind, quantity: Quantity) -> Refusal {
    let message = format!("{} cannot be given by {}", article(quantity), form(kind));
    let why = match quantity {
        Quantity::Emission => "only a surface can show it: give an object an `emissive` material",
        Quantity::Index | Quantity::Absorption => "it belongs to the whole body, not to places on its surface",
        _ => "a metal is the same all over: give its parts materials of their own",
    };
    Refusal::new(message).help(why)
}

/// How a quantity may be written.
fn forms(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Emission => "write a number, { rgb = [red, green, blue] } or { illuminant = \"D65\" }",
        Quantity::Index => "write a number, a glass such as \"N-BK7\" or { samples = [[nm, n], ..] }",
        Quantity::MetalIndex | Quantity::MetalExtinction => "write a number or { samples = [[nm, value], ..] }",
        Quantity::Reflectance | Quantity::Transmittance | Quantity::Share | Quantity::Absorption => {
            "write a number, { rgb = [red, green, blue] } or { samples = [[nm, value], ..] }"
        }
    }
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
        CurveKind::Image(_) | CurveKind::Texture(_) | CurveKind::Checker { .. } => Vec::new(),
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
        let refusal = Refusal::new(message).at(&["samples"], i + 1);
        let descending = samples[i + 1][0] < samples[i][0];
        return Err(if descending { refusal.help("sort them, the shortest first") } else { refusal });
    }
    if (100.0..=830.0).contains(first) {
        return Ok(());
    }
    let refusal = Refusal::new(format!("a first wavelength of {first} nm is far from visible light"));
    let help = unit_of_wavelength(*first, 100.0).unwrap_or("wavelengths are in nm".into());
    Err(refusal.help(help).at(&["samples"], 0))
}

/// The unit that a wavelength seems to be in, if it would be `least` to 830 nm in that.
fn unit_of_wavelength(given: f64, least: f64) -> Option<String> {
    let units = [("um", 1e3), ("Angstrom", 0.1), ("m", 1e9)].map(|(unit, nm)| (unit, given * nm));
    let (unit, nm) = units.into_iter().find(|(_, nm)| (least..=830.0).contains(nm))?;
    Some(format!("in {unit}? Wavelengths are in nm: then write {}", shown(nm)))
}

fn visible_lines(lines: &[[f64; 2]]) -> Result<(), Refusal> {
    if lines.is_empty() {
        return Err(Refusal::new("a light of lines has at least one [wavelength in nm, power]"));
    }
    match lines.iter().position(|[nm, _]| !(360.0..=830.0).contains(nm)) {
        Some(entry) => {
            let nm = lines[entry][0];
            let help = unit_of_wavelength(nm, 360.0).unwrap_or("leave it out: it cannot be seen".into());
            let message = format!("a line lies within 360 to 830 nm, not at {}", shown(nm));
            Err(Refusal::new(message).help(help).at(&["lines"], entry))
        }
        None => Ok(()),
    }
}

fn blackbody(kelvin: f64) -> Result<(), Refusal> {
    if (100.0..=1e9).contains(&kelvin) {
        return Ok(());
    }
    let refusal = Refusal::new(format!("a blackbody has 100 to 1e9 kelvin, not {}", shown(kelvin)));
    let units = [("kK", 1e3), ("MK", 1e6)].map(|(unit, factor)| (unit, kelvin * factor));
    let help = match units.into_iter().find(|(_, kelvin)| (1000.0..=40_000.0).contains(kelvin)) {
        Some((unit, kelvin)) => format!("in {unit}? Temperatures are in kelvin: then write {}", shown(kelvin)),
        None => "a candle has 1900, the sun 5772".into(),
    };
    Err(refusal.help(help).at(&["blackbody"], None))
}

fn sellmeier(b: &[f64], c: &[f64]) -> Result<(), Refusal> {
    if b.len() != c.len() || b.is_empty() {
        let message = format!("a Sellmeier curve has as many b as c, here {} and {}", b.len(), c.len());
        return Err(Refusal::new(message).at(&["sellmeier"], None));
    }
    if let Some(pole) = c.iter().position(|&c| c > 0.0 && (0.36..=0.83).contains(&c.sqrt())) {
        let message = format!("this Sellmeier curve has a pole at {:.0} nm, in visible light", c[pole].sqrt() * 1e3);
        return Err(Refusal::new(message).help(SELLMEIER).at(&["sellmeier", "c"], pole));
    }
    for nm in 360..=830 {
        let squared = sellmeier_squared(b, c, f64::from(nm) * 1e-3);
        if squared.is_nan() || squared <= 0.0 {
            let message = format!("this Sellmeier curve gives n^2 = {} at {nm} nm", shown(squared));
            return Err(Refusal::new(message).help(SELLMEIER).at(&["sellmeier"], None));
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
        CurveKind::Image(_) | CurveKind::Texture(_) => "`image`".into(),
        CurveKind::Checker { .. } => "`checker`".into(),
        CurveKind::Name(name) => format!("the name {name:?}"),
    }
}
