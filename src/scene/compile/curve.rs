//! From a spectrum as written to a curve whose values are all known.

use super::context::Context;
use super::curve_name::{
    color_hint, illuminant_hint, image_hint, quoted_text_hint, temperature_hint, unknown_glass, unknown_illuminant,
    unknown_metal, unknown_reflectance,
};
use super::curve_range::{CurveError, check_value, factor, name_with_article, thin_layer_warning};
use super::curve_text::{CurveText, KindText, PAIRS_HELP, check_finite, not_finite};
use super::radiometry::scale_to_film;
use super::ranges::wavelength_unit_hint;
use super::spectrum_file::read_columns;
use crate::scene::text::{FileKind, Spanned, Value, six_digits, utf8};
use crate::scene::web_color::bytes_to_linear;
use crate::spectrum::{
    ColorSpace, Curve, CurveKind, Emission, Quantity, absorption_range_warning, cauchy_from_abbe, data,
    imitation_warning, index_range_warning, sellmeier_squared,
    visible::{FIRST_NM, LAST_NM, START_NM},
};

const TABLE_FILE: FileKind =
    FileKind { empty_name_message: "a file of samples needs a name", max_bytes: 1 << 26, endings: &[] };

const CAUCHY: &str = "for a glass, A is about 1.5 and B about 0.004 um^2";
const SELLMEIER: &str = "c holds squared wavelengths in um^2: square the coefficients if they are wavelengths";
const ABBE: &str = "for a glass, nd is about 1.4 to 2.1 and vd 18 to 95";

/// Converts a text to a spectrum that is the same all over a surface.
pub(super) fn curve<'d>(context: &mut Context, text: &CurveText<'d>, quantity: Quantity) -> Option<Curve> {
    if let (Some(luminance), false) = (text.luminance, quantity == Quantity::Emission) {
        return luminance.place.advise(format!("{} has no luminance", name_with_article(quantity)), "use `scale`");
    }
    check_finite(text.scale)?;
    text.luminance.map_or(Some(()), check_finite)?;
    let kind = kind(context, text, quantity)?;
    let curve = Curve { kind, scale: text.scale.value, luminance: text.luminance.map(|luminance| luminance.value) };
    if let Some(Spanned { place, value: luminance }) = text.luminance {
        place.reported(factor("a luminance", luminance))?;
        if luminance > 0.0 && !Emission::new(&curve, ColorSpace::default()).xyz()[1].is_normal() {
            return place.refuse("a light without power has no luminance");
        }
    }
    if quantity == Quantity::Index {
        let advice = [index_range_warning(&curve), imitation_warning(&curve)];
        advice.into_iter().flatten().for_each(|advice| context.warn_at(text.value, advice));
    }
    if let (Quantity::Thickness, CurveKind::Number(nm)) = (quantity, &curve.kind) {
        thin_layer_warning(nm * curve.scale).into_iter().for_each(|advice| context.warn_at(text.value, advice));
    }
    match quantity {
        Quantity::Emission => scale_to_film(context, text, curve),
        _ => Some(curve),
    }
}

/// Reports that a quantity cannot be written in this form.
fn refuse_form<T>(text: &CurveText, quantity: Quantity) -> Option<T> {
    let key = || format!("`{}`", text.place.key());
    let (form, help) = match text.kind {
        KindText::Name(name) if quantity == Quantity::Emission => {
            let light = color_hint(name).or_else(|| temperature_hint(name));
            (format!("the name {name:?}"), quoted_text_hint(name).or(light).or_else(|| illuminant_hint(name)))
        }
        KindText::Name(name) => {
            (format!("the name {name:?}"), quoted_text_hint(name).or_else(|| illuminant_hint(name)))
        }
        KindText::Image(_) | KindText::Checker(_) => (key(), Some(why_uniform(quantity).to_owned())),
        _ => (key(), None),
    };
    let help = help.unwrap_or_else(|| forms(quantity).into());
    text.value.advise(format!("{} cannot be given by {form}", name_with_article(quantity)), help)
}

/// Returns why a quantity cannot vary over a surface.
fn why_uniform(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Emission => "only a surface can show a pattern: give an object an `emissive` material",
        Quantity::Index | Quantity::Absorption => "it applies to the whole body, not to points on its surface",
        Quantity::Excitation | Quantity::Fluorescence => {
            "a dye is uniform: to vary it, `mix` its material with one that has none"
        }
        _ => "a metal is uniform: use separate materials for parts that differ",
    }
}

/// Returns how a quantity may be written.
fn forms(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Emission => "write a number, { rgb = [red, green, blue] } or { illuminant = \"D65\" }",
        Quantity::Index => "write a number, a glass such as \"N-BK7\" or { samples = [[nm, n], ..] }",
        Quantity::MetalIndex | Quantity::MetalExtinction => "write a number or { samples = [[nm, value], ..] }",
        Quantity::Thickness => {
            "write a number in nm, or a grayscale image and the nm that its white stands for: { image = \
             \"thickness.png\", scale = 600 }"
        }
        Quantity::Excitation | Quantity::Fluorescence => {
            "write { samples = [[nm, value], ..] } or { file = \"dye.csv\" }"
        }
        Quantity::Reflectance | Quantity::Transmittance | Quantity::Share | Quantity::Absorption => {
            "write a number, { rgb = [red, green, blue] } or { samples = [[nm, value], ..] }"
        }
    }
}

/// Looks up and reads the kind of spectrum that a text gives.
fn kind<'d>(context: &mut Context, text: &CurveText<'d>, quantity: Quantity) -> Option<CurveKind> {
    if !text.fits(quantity) {
        return refuse_form(text, quantity);
    }
    let place = text.place;
    match &text.kind {
        KindText::Number(number) => {
            place.reported(check_value(quantity, number * text.scale.value, ""))?;
            Some(CurveKind::Number(*number))
        }
        KindText::Rgb(rgb) => {
            refuse_screen_color(text, quantity, *rgb)?;
            check_values(text, quantity, rgb.iter().copied())?;
            Some(CurveKind::Rgb(*rgb))
        }
        KindText::Samples(samples) => match check_samples(samples, quantity, text.scale.value) {
            Ok(()) => Some(CurveKind::Samples(samples.clone())),
            Err(refusal) => {
                let help = if is_transposed(samples) { Some(PAIRS_HELP.into()) } else { refusal.help };
                refusal.entry.map_or(text.value, |entry| place.entry(entry)).report(refusal.message, help)
            }
        },
        KindText::File(file) => read_sample_file(context, text, file, quantity),
        KindText::Cauchy(terms) => cauchy(text, *terms),
        KindText::Sellmeier { b, c } => sellmeier(text, b, c),
        KindText::Abbe { nd, vd } => abbe(text, *nd, *vd),
        KindText::Illuminant(name) => {
            let Some(light) = CurveKind::illuminant(name) else { return unknown_illuminant(name).report(place) };
            text.scale.place.reported(factor("a scale", text.scale.value))?;
            Some(light)
        }
        KindText::Blackbody(kelvin) => {
            place.reported(check_blackbody(*kelvin))?;
            text.scale.place.reported(factor("a scale", text.scale.value))?;
            Some(CurveKind::Blackbody(*kelvin))
        }
        KindText::Lines(lines) => {
            check_lines(text, lines)?;
            check_values(text, quantity, lines.iter().map(|line| line[1]))?;
            Some(CurveKind::Lines(lines.clone()))
        }
        KindText::Name(name) => catalog_curve(context, text, name, quantity),
        KindText::Image(_) | KindText::Checker(_) => refuse_form(text, quantity),
    }
}

/// Refuses a share that is a color from 0 to 255, as on screens.
fn refuse_screen_color(text: &CurveText, quantity: Quantity, rgb: [f64; 3]) -> Option<()> {
    let is_share = matches!(quantity, Quantity::Reflectance | Quantity::Transmittance | Quantity::Share);
    let first = rgb.iter().position(|x| *x > 1.0).filter(|_| is_share && text.scale.value == 1.0);
    // Numbers up to 100 may be meant in percent.
    let Some((first, color)) = first.filter(|_| rgb.iter().any(|x| *x > 100.0)).zip(bytes_to_linear(rgb)) else {
        return Some(());
    };
    let message = format!("{} is at most 1, not {}", name_with_article(quantity), six_digits(rgb[first]));
    let help = format!("a color from 0 to 255 is sRGB: its linear value is {color}");
    text.place.entry(first).advise(message, help)
}

/// Refuses a list that contains an impossible value.
fn check_values(text: &CurveText, quantity: Quantity, values: impl Iterator<Item = f64>) -> Option<()> {
    let scale = text.scale.value;
    values.enumerate().try_for_each(|(number, value)| {
        text.place.entry(number).reported(check_value(quantity, value * scale, &with_scale(scale)))
    })
}

/// Returns the part of a message that tells by which scale a value was multiplied.
fn with_scale(scale: f64) -> String {
    if scale == 1.0 { String::new() } else { format!(" with its scale of {}", six_digits(scale)) }
}

/// Returns whether two pairs are a list of two wavelengths and a list of two values.
fn is_transposed(pairs: &[[f64; 2]]) -> bool {
    let is_wavelength = |x: &f64| (100.0..=830.0).contains(x);
    matches!(pairs, [first, second] if first.iter().all(is_wavelength) && !second.iter().any(is_wavelength))
}

/// Refuses samples that cannot be a spectrum of a quantity.
fn check_samples(samples: &[[f64; 2]], quantity: Quantity, scale: f64) -> Result<(), CurveError> {
    if let Some(at) = samples.as_flattened().iter().position(|x| !x.is_finite()) {
        return Err(CurveError::new(not_finite(samples.as_flattened()[at])).at(at / 2));
    }
    check_ascending(samples)?;
    if let ([[nm, power]], Quantity::Emission) = (samples, quantity) {
        let refusal = CurveError::new("an emission with one sample gives no light: it is 0 outside its samples");
        return Err(refusal.help(format!("for one wavelength write {{ lines = [[{nm}, {power}]] }}")).at(0));
    }
    if let (Some([last, _]), Quantity::Emission) = (samples.last(), quantity)
        && *last <= START_NM
    {
        let refusal =
            CurveError::new(format!("an emission that ends at {last} nm gives no light: it is 0 outside its samples"));
        return Err(refusal.help("light is visible from 360 nm, and excites dyes from 300 nm").at(samples.len() - 1));
    }
    let check_value = |value: f64| check_value(quantity, value * scale, &with_scale(scale));
    samples.iter().enumerate().try_for_each(|(entry, pair)| {
        check_value(pair[1]).map_err(|refusal| match refusal.is_percent && scale == 1.0 {
            true => refusal.help("if these are in percent, add scale = 0.01").at(entry),
            false => refusal.at(entry),
        })
    })
}

fn check_ascending(samples: &[[f64; 2]]) -> Result<(), CurveError> {
    let Some([first, _]) = samples.first() else {
        return Err(CurveError::new("a table of samples holds at least one [wavelength in nm, value]"));
    };
    if are_swapped(samples) {
        let [value, nm] = samples[0].map(six_digits);
        let refusal = CurveError::new(format!("a first wavelength of {value} nm is far from visible light"));
        return Err(refusal.help(format!("the wavelength comes before its value: write [{nm}, {value}]")).at(0));
    }
    if let Some(i) = samples.windows(2).position(|pair| pair[1][0] <= pair[0][0]) {
        let [before, after] = [samples[i][0], samples[i + 1][0]];
        let refusal =
            CurveError::new(format!("wavelengths must increase from sample to sample ({after} after {before})"));
        let refusal = if after < before { refusal.help("sort them, the shortest first") } else { refusal };
        return Err(refusal.at(i + 1));
    }
    if (100.0..=830.0).contains(first) {
        return Ok(());
    }
    let help = wavelength_unit_hint(*first, 100.0..=830.0).unwrap_or("wavelengths are in nm".into());
    Err(CurveError::new(format!("a first wavelength of {first} nm is far from visible light")).help(help).at(0))
}

/// Returns whether pairs are written as `[value, wavelength in nm]`, with wavelengths that increase as in a spectrum.
fn are_swapped(samples: &[[f64; 2]]) -> bool {
    let is_value = |[value, nm]: &[f64; 2]| *value < 100.0 && (100.0..=MAX_TABLE_NM).contains(nm);
    samples.len() > 1 && samples.iter().all(is_value) && samples.is_sorted_by(|a, b| a[1] < b[1])
}

/// The longest wavelength in nm at which tables of visible light end.
const MAX_TABLE_NM: f64 = 2500.0;

fn read_sample_file<'d>(
    context: &mut Context,
    text: &CurveText<'d>,
    file: &str,
    quantity: Quantity,
) -> Option<CurveKind> {
    let place = text.place;
    // Without a column, the second one is read.
    let column = text.column.unwrap_or(Spanned { place, value: 2 });
    if column.value < 2 {
        return column.place.refuse("the values are in column 2 or later: column 1 holds the wavelengths");
    }
    if let Some(help) = image_hint(file) {
        return place.advise(format!("{file} is an image, not a table of samples"), help);
    }
    let table = place.reported(utf8(place.file(file, &TABLE_FILE)?, file, "save the table as CSV in UTF-8"))?;
    let rows = match read_columns(&table, column.value) {
        Ok(rows) => rows,
        Err(fault) => {
            let place = if fault.is_column && column.value != 2 { column.place } else { place };
            return place.report(format!("{file}{}", fault.message), fault.help);
        }
    };
    context.record_file(place.path(file), table.as_bytes());
    let samples: Vec<[f64; 2]> = rows.iter().map(|row| row.pair).collect();
    match check_samples(&samples, quantity, text.scale.value) {
        Ok(()) => Some(CurveKind::Samples(samples)),
        Err(CurveError { message, help, entry: Some(entry), .. }) => {
            place.report(format!("{file}, line {}: {message}", rows[entry].line), help)
        }
        Err(refusal) => refusal.report(text.value),
    }
}

/// Returns a Cauchy curve, n = A + B / wavelength^2.
fn cauchy(text: &CurveText, terms: [f64; 2]) -> Option<CurveKind> {
    let (kind, place) = (CurveKind::Cauchy(terms), text.place);
    match check_index(text.scale.value, &kind) {
        Ok(()) => Some(kind),
        Err(refusal) if (500.0..100_000.0).contains(&terms[1]) => {
            let help = format!("B is in um^2: if this is in nm^2, write {}", six_digits(terms[1] * 1e-6));
            refusal.help(help).report(place.entry(1))
        }
        Err(refusal) => refusal.help(CAUCHY).report(place),
    }
}

/// Returns the two-term Cauchy curve through n_d with the Abbe number V_d = (n_d - 1) / (n_F - n_C).
fn abbe(text: &CurveText, nd: Spanned<f64>, vd: Spanned<f64>) -> Option<CurveKind> {
    if vd.value <= 0.0 {
        return vd.place.refuse("an Abbe number is above 0");
    }
    if nd.value <= 1.0 {
        return nd.place.advise(format!("a refractive index is above 1, not {}", six_digits(nd.value)), ABBE);
    }
    let kind = CurveKind::Cauchy(cauchy_from_abbe(nd.value, vd.value));
    text.place.reported(check_index(text.scale.value, &kind).map_err(|refusal| refusal.help(ABBE)))?;
    Some(kind)
}

fn sellmeier(text: &CurveText, b: &Spanned<Vec<f64>>, c: &Spanned<Vec<f64>>) -> Option<CurveKind> {
    let place = text.place;
    if b.value.len() != c.value.len() || b.value.is_empty() {
        let (b, c) = (b.value.len(), c.value.len());
        return place.refuse(format!(
            "a Sellmeier curve needs equal numbers of b and c, at least one of each, not {b} and {c}"
        ));
    }
    if let Some(pole) = c.value.iter().position(|&c| c > 0.0 && (0.36..=0.83).contains(&c.sqrt())) {
        let nm = c.value[pole].sqrt() * 1e3;
        let message = format!("this Sellmeier curve has a pole at {nm:.0} nm, in visible light");
        return c.place.entry(pole).advise(message, SELLMEIER);
    }
    for nm in 360..=830 {
        let squared = sellmeier_squared(&b.value, &c.value, f64::from(nm) * 1e-3);
        if squared.is_nan() || squared <= 0.0 {
            return place
                .advise(format!("this Sellmeier curve gives n^2 = {} at {nm} nm", six_digits(squared)), SELLMEIER);
        }
    }
    let kind = CurveKind::Sellmeier { b: b.value.clone(), c: c.value.clone() };
    match check_index(text.scale.value, &kind) {
        Ok(()) => Some(kind),
        Err(refusal) if c.value.iter().all(|&c| c > 1e3) => {
            refusal.help("c is in um^2: if this is in nm^2, divide it by 1e6").report(c.place)
        }
        Err(refusal) => refusal.help(SELLMEIER).report(place),
    }
}

/// Checks that a formula of an index gives a possible value at all visible wavelengths. A value of exactly 1 comes from
/// coefficients that are 0 or in another unit.
fn check_index(scale: f64, kind: &CurveKind) -> Result<(), CurveError> {
    let curve = Curve { scale, ..kind.clone().into() };
    let value = curve.values(Quantity::Index);
    (360..=830).try_for_each(|nm| {
        let (value, place) = (value(f64::from(nm)), format!(" at {nm} nm"));
        if value == 1.0 {
            return Err(CurveError::new(format!("a refractive index is above 1, not 1{place}")));
        }
        check_value(Quantity::Index, value, &place)
    })
}

fn check_lines(text: &CurveText, lines: &[[f64; 2]]) -> Option<()> {
    if lines.is_empty() {
        return text.value.refuse("`lines` holds at least one [wavelength in nm, power]");
    }
    match lines.iter().position(|[nm, _]| !(FIRST_NM..=LAST_NM).contains(nm)) {
        Some(entry) => {
            let nm = lines[entry][0];
            let help = match is_transposed(lines) {
                true => PAIRS_HELP.into(),
                false => {
                    wavelength_unit_hint(nm, FIRST_NM..=LAST_NM).unwrap_or("leave it out: it cannot be seen".into())
                }
            };
            let message = format!("a line lies between 360 and 830 nm, not at {}", six_digits(nm));
            text.place.entry(entry).advise(message, help)
        }
        None => Some(()),
    }
}

fn check_blackbody(kelvin: f64) -> Result<(), CurveError> {
    if (100.0..=1e9).contains(&kelvin) {
        return Ok(());
    }
    let refusal =
        CurveError::new(format!("the temperature of a blackbody is 100 to 1e9 kelvin, not {}", six_digits(kelvin)));
    let units = [("kK", 1e3), ("MK", 1e6)].map(|(unit, factor)| (unit, kelvin * factor));
    Err(refusal.help(match units.into_iter().find(|(_, kelvin)| (1000.0..=40_000.0).contains(kelvin)) {
        Some((unit, kelvin)) => {
            format!("temperatures are in kelvin: if this one is in {unit}, write {}", six_digits(kelvin))
        }
        None => "a candle is at about 1900, the sun at 5772".into(),
    }))
}

/// Looks up an entry of the catalog.
fn catalog_curve(context: &mut Context, text: &CurveText, name: &str, quantity: Quantity) -> Option<CurveKind> {
    let place = text.value;
    let (found, unknown): (_, fn(&str) -> CurveError) = match quantity {
        Quantity::Index => (CurveKind::glass(name), unknown_glass),
        Quantity::MetalIndex | Quantity::MetalExtinction => (CurveKind::metal(name), unknown_metal),
        Quantity::Absorption => return absorption(context, place, name),
        Quantity::Reflectance | Quantity::Transmittance | Quantity::Share => {
            (CurveKind::reflectance(name), unknown_reflectance)
        }
        Quantity::Emission | Quantity::Thickness | Quantity::Excitation | Quantity::Fluorescence => {
            return refuse_form(text, quantity);
        }
    };
    found.or_else(|| unknown(name).report(place))
}

/// Returns the absorption of a glass of the catalog per scene unit.
fn absorption(context: &mut Context, place: Value, name: &str) -> Option<CurveKind> {
    let Some(glass) = data::glass(name) else { return unknown_glass(name).report(place) };
    if glass.extinction.is_empty() {
        let message = format!("the catalog has no absorption for {}", glass.key);
        let help = "`render catalog glass` lists the glasses that have it; or write { samples = [[nm, per unit], ..] }";
        return place.advise(message, help);
    }
    let Some(meters) = context.meters_per_unit else {
        let message =
            format!("the absorption of {name} is known per meter, but the scene does not say how long its unit is");
        return place.advise(message, "for a scene in centimeters: [render] meters_per_unit = 0.01");
    };
    absorption_range_warning(&glass).into_iter().for_each(|advice| context.warn_at(place, advice));
    // 4 pi k / wavelength, base e (Born & Wolf 1999, section 14.1).
    let per_meter = |k: f64, nm: f64| 4.0 * std::f64::consts::PI * k / (nm * 1e-9);
    Some(CurveKind::Samples(glass.extinction.iter().map(|&[nm, k]| [nm, per_meter(k, nm) * meters]).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Entries of the catalog are used without a check.
    #[test]
    fn every_entry_of_the_catalog_is_possible() {
        let glasses = data::glasses().map(|glass| (CurveKind::glass(glass.key), Quantity::Index));
        let metals = data::metals().flat_map(|metal| {
            [Quantity::MetalIndex, Quantity::MetalExtinction].map(|which| (CurveKind::metal(metal.name), which))
        });
        let patches = data::reflectances();
        let patches = patches.map(|patch| (CurveKind::reflectance(patch.name), Quantity::Reflectance));
        let mut count = 0;
        for (kind, quantity) in glasses.chain(metals).chain(patches) {
            let kind = kind.expect("it is found by its name");
            let value = kind.values(quantity);
            for nm in 360..=830 {
                let found = check_value(quantity, value(f64::from(nm)), "").err().map(|refusal| refusal.message);
                assert_eq!(found, None, "{kind:?} at {nm} nm");
            }
            count += 1;
        }
        assert!(count > 1000, "{count}");
    }
}
