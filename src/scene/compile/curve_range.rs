//! The values that are possible for the quantity that a spectrum describes.

use crate::scene::text::{Fault, Value, six_digits};
use crate::spectrum::Quantity;

/// Largest emission: far within f32, which stores film and lanes.
pub(super) const MAX_EMISSION: f64 = 1e30;
/// Largest n and k: several times those of any metal in visible light.
const MAX_METAL_INDEX: f64 = 100.0;
/// Largest thickness of an interference layer, in nm: 100 um.
const MAX_THICKNESS_NM: f64 = 1e5;
/// A thickness below this many nm, far less than an atom, must be meant in another unit.
const MIN_THICKNESS_NM: f64 = 1e-3;

/// Why a spectrum cannot be used for a quantity.
pub(super) struct CurveError {
    pub(super) message: String,
    /// What to do, if that is known.
    pub(super) help: Option<String>,
    /// Whether the value would be right if it were meant in percent.
    pub(super) is_percent: bool,
    /// The wrong entry of a list, if a single entry is wrong.
    pub(super) entry: Option<usize>,
}

impl CurveError {
    pub(super) fn new(message: impl Into<String>) -> Self {
        Self { message: message.into(), help: None, is_percent: false, entry: None }
    }

    pub(super) fn help(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }

    pub(super) fn at(self, entry: usize) -> Self {
        Self { entry: Some(entry), ..self }
    }

    pub(super) fn report<T>(self, place: Value) -> Option<T> {
        place.report(self.message, self.help)
    }
}

impl From<CurveError> for Fault {
    fn from(CurveError { message, help, .. }: CurveError) -> Self {
        Self { message, help }
    }
}

/// Returns whether a value can be a factor on the brightness of a light.
pub(super) fn is_factor(value: f64) -> bool {
    (0.0..=MAX_EMISSION).contains(&value)
}

/// Checks a factor on the brightness of a whole light.
pub(super) fn factor(name: &str, value: f64) -> Result<(), CurveError> {
    let bound = match value {
        _ if value < 0.0 => "at least 0".to_owned(),
        _ if value > MAX_EMISSION => format!("at most {}", six_digits(MAX_EMISSION)),
        _ => return Ok(()),
    };
    Err(CurveError::new(format!("{name} is {bound}, not {}", six_digits(value))))
}

/// Checks that a value is possible for a quantity. `place` says in the message where the value is.
pub(super) fn check_value(quantity: Quantity, value: f64, place: &str) -> Result<(), CurveError> {
    let name = name_with_article(quantity);
    let (min, max, is_share) = match quantity {
        Quantity::Reflectance | Quantity::Transmittance | Quantity::Share | Quantity::Excitation => (0.0, 1.0, true),
        Quantity::Emission | Quantity::Fluorescence => (0.0, MAX_EMISSION, false),
        Quantity::Index => (1.0, 10.0, false),
        Quantity::Absorption => (0.0, f64::MAX, false),
        Quantity::MetalIndex => (f64::MIN_POSITIVE, MAX_METAL_INDEX, false),
        Quantity::MetalExtinction => (0.0, MAX_METAL_INDEX, false),
        Quantity::Thickness => return check_thickness(value, place),
    };
    if (min..=max).contains(&value) {
        return Ok(());
    }
    let shown_value = six_digits(value);
    let refusal = CurveError::new(match quantity {
        Quantity::MetalIndex if value <= 0.0 => format!("{name} is above 0, not {shown_value}{place}"),
        _ if value < min => format!("{name} is at least {min}, not {shown_value}{place}"),
        _ => format!("{name} is at most {}, not {shown_value}{place}", six_digits(max)),
    });
    Err(match value {
        2.0..=100.0 if is_share => CurveError {
            is_percent: true,
            ..refusal.help(format!("if this is in percent, write {}", six_digits(value / 100.0)))
        },
        100.0..=255.0 if is_share => {
            refusal.help("a color from 0 to 255 is sRGB: its linear value is about (v / 255)^2.2")
        }
        0.55..=0.8 if quantity == Quantity::Index => refusal
            .help(format!("if this is the index around it divided by its own, write {}", six_digits(1.0 / value))),
        _ => refusal,
    })
}

/// Checks that a layer's thickness in nm is neither too small for a layer nor too large for visible interference.
pub(super) fn check_thickness(nm: f64, place: &str) -> Result<(), CurveError> {
    let (name, value) = (name_with_article(Quantity::Thickness), six_digits(nm));
    if nm == 0.0 || (MIN_THICKNESS_NM..=MAX_THICKNESS_NM).contains(&nm) {
        return Ok(());
    }
    if nm < 0.0 {
        return Err(CurveError::new(format!("{name} is at least 0, not {value} nm{place}")));
    }
    if nm > MAX_THICKNESS_NM {
        let refusal = CurveError::new(format!("{name} is at most {MAX_THICKNESS_NM} nm, not {value} nm{place}"));
        return Err(refusal.help("interference in a thicker layer is invisible: for glass, leave the layer out"));
    }
    let refusal = CurveError::new(format!("{name} of {value} nm{place} is less than that of an atom"));
    let in_nm = nm * 1e9;
    let help = (1.0..=MAX_THICKNESS_NM).contains(&in_nm);
    Err(if help { refusal.help(format!("it is in nm: if this is in m, write {}", six_digits(in_nm))) } else { refusal })
}

/// Returns a warning about a layer so thin that um were probably meant.
pub(super) fn thin_layer_warning(nm: f64) -> Option<String> {
    let is_thin = (MIN_THICKNESS_NM..VISIBLE_THICKNESS_NM).contains(&nm);
    is_thin.then(|| {
        format!(
            "a layer of {} nm is too thin to be seen; if um are meant, write {}",
            six_digits(nm),
            six_digits(nm * 1e3)
        )
    })
}

/// Thickness in nm below which no layer is visible.
const VISIBLE_THICKNESS_NM: f64 = 1.0;

pub(super) fn name_with_article(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Reflectance => "a reflectance",
        Quantity::Transmittance => "a transmittance",
        Quantity::Share => "a share",
        Quantity::Emission => "an emission",
        Quantity::Index => "a refractive index",
        Quantity::Absorption => "an absorption",
        Quantity::MetalIndex => "a metal's index n",
        Quantity::MetalExtinction => "a metal's extinction k",
        Quantity::Thickness => "a layer's thickness",
        Quantity::Excitation => "a dye's absorption",
        Quantity::Fluorescence => "a dye's emission",
    }
}
