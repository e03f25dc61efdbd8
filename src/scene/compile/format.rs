//! What an image file contains, and how its numbers are stored.

use toml::de::DeValue;

use super::ranges::wavelength_unit_hint;
use crate::film::{Compression, FirstSurface, Format, Layer, Precision};
use crate::scene::text::{Fields, Spanned, Value, above_0_to, spanned};
use crate::spectrum::WavelengthBands;
use crate::spectrum::visible::{FIRST_NM, LAST_NM};

/// Largest luminance of white. That of the sun is 1.6e9.
const MAX_WHITE_LUMINANCE: f64 = 1e12;

/// Reads what the file contains.
pub(super) fn format(film: &mut Fields) -> Option<Format> {
    let layers = film.or("layers", Vec::new(), layers);
    let first = film.or("first", FirstSurface::default(), |value| value.word(&FirstSurface::NAMES));
    let precision = film.maybe("precision", |value| value.word(&Precision::NAMES));
    let compression = film.maybe("compression", spanned(compression));
    let multipart = film.or("multipart", false, Value::yes_or_no);
    let stokes = film.or("stokes", false, Value::yes_or_no);
    let spectral = film.or("spectral", None, spectral);
    let metadata = film.or("metadata", ([None, None], None), |value| {
        Fields::read(value, |metadata| {
            let [owner, comments] = ["owner", "comments"].map(|key| metadata.maybe(key, line));
            let rate = metadata.maybe("frames_per_second", rate);
            Some(([owner?, comments?], rate?))
        })
    });
    let white_luminance = white_luminance(film);
    let ([owner, comments], frames_per_second) = metadata?;
    let (layers, first, compressed, multipart, stokes) = (layers?, first?, compression?, multipart?, stokes?);
    let (place, compression) = compressed.map_or((None, Compression::default()), |at| (Some(at.place), at.value));
    let precision = precision?.unwrap_or(match compression.is_of_16_bits() {
        true => Precision::Half,
        false => Precision::default(),
    });
    let (white_luminance, spectral) = (white_luminance?, spectral?);
    let mut format = Format {
        layers: Vec::new(),
        stokes,
        first,
        precision,
        compression,
        multipart,
        spectral,
        white_luminance,
        owner,
        comments,
        frames_per_second,
    };
    format.ask_for(&layers);
    match place.and_then(|place| Some((place, format.objection()?))) {
        Some((place, (message, help))) => place.advise(message, help),
        None => Some(format),
    }
}

/// Reads the luminance of red, green and blue of 1, if the scene's light is absolute.
fn white_luminance(film: &mut Fields) -> Option<Option<f64>> {
    let is_absolute = film.or("radiometry", false, |value| value.word(&[("absolute", true), ("relative", false)]));
    let help = "in cd/m2: the white of a screen is about 100";
    let rule = format!("a luminance of white is above 0 and at most {MAX_WHITE_LUMINANCE:e}");
    let white = film.maybe(
        "white_luminance",
        spanned(|value: Value| value.number_within(above_0_to(MAX_WHITE_LUMINANCE), &rule, Some(help))),
    );
    match (is_absolute?, white?) {
        (true, white) => Some(Some(white.map_or(1.0, |white| white.value))),
        (false, None) => Some(None),
        (false, Some(Spanned { place, .. })) => place.refuse_key(
            "a luminance of white needs radiometry = \"absolute\"",
            Some("add that, or leave it out".into()),
        ),
    }
}

/// Reads the bands of a spectral image: true for those that most programs expect, or the first and the last band and
/// the width of each, in nm.
fn spectral(value: Value) -> Option<Option<WavelengthBands>> {
    match value.node() {
        DeValue::Boolean(true) => return Some(Some(WavelengthBands::default())),
        DeValue::Boolean(false) => return Some(None),
        DeValue::Table(_) => {}
        _ => return value.expected("true, or a table such as { from = 380, to = 780, step = 5 }"),
    }
    let [from, to, step] = Fields::read(value, |bands| {
        let nm = |value: Value| {
            let visible_nm = FIRST_NM..=LAST_NM;
            let unit = wavelength_unit_hint(value.number()?, visible_nm.clone());
            value.number_within(visible_nm, "a band lies between 360 and 830 nm", unit.as_deref())
        };
        let most = above_0_to(LAST_NM - FIRST_NM);
        let width = |value: Value| value.number_within(most, "a step is a width above 0 and at most 470 nm", None);
        let [from, to, step] = [bands.or("from", 380.0, nm), bands.or("to", 780.0, nm), bands.or("step", 5.0, width)];
        Some([from?, to?, step?])
    })?;
    let most = WavelengthBands::MAX_COUNT;
    match WavelengthBands::new(from, to, step) {
        Some(bands) => Some(Some(bands)),
        None if from > to => value.refuse(format!("the last band, at {to} nm, lies before the first, at {from} nm")),
        None => {
            let message = format!("a step of {step} nm gives more than the maximum of {most} bands");
            value.report(message, wavelength_unit_hint(step, 1.0..=50.0))
        }
    }
}

fn compression(value: Value) -> Option<Compression> {
    match value.node().as_str() {
        Some(name @ ("b44" | "b44a")) => {
            let message =
                format!("the compression {name} is not supported: dark pixels lose their colors next to bright ones");
            value.advise(message, "\"dwaa\" makes smaller files; \"piz\" and \"zip\" are lossless")
        }
        _ => value.word(&Compression::NAMES),
    }
}

fn layers(value: Value) -> Option<Vec<Layer>> {
    match value.node().as_str() {
        Some(Layer::ALL) => return Some(Layer::all()),
        Some(word) => {
            let words = word.split([',', ' ']).filter(|word| !word.is_empty());
            let list: Vec<String> = words.map(|word| format!("\"{word}\"")).collect();
            let help = format!("write layers = [{}], or \"{}\"", list.join(", "), Layer::ALL);
            return value.advise("`layers` is a list", help);
        }
        None => {}
    }
    let layers = value.each(|layer| match layer.node().as_str() {
        Some(Layer::ALL) => Some(Layer::all()),
        _ => layer.word(&Layer::NAMES).map(|layer| vec![layer]),
    });
    layers.map(|layers| layers.concat())
}

/// Whole frame rates that television runs at 1000 / 1001 of their speed, and gives with two or three digits.
const TELEVISION_RATES: [u32; 5] = [24, 30, 48, 60, 120];

/// Reads a frame rate, as a number of frames and the seconds that they take.
fn rate(value: Value) -> Option<[u32; 2]> {
    let help = Some("for instance: 24, or 23.976");
    let rate = value.number_within(
        above_0_to(1000.0),
        "a rate is a number of frames per second, above 0 and at most 1000",
        help,
    )?;
    let is_slowed = |whole: &u32| (rate - f64::from(*whole) / 1.001).abs() < 0.005;
    Some(match TELEVISION_RATES.into_iter().find(is_slowed) {
        Some(whole) => [1000 * whole, 1001],
        None if rate.fract() == 0.0 => [rate as u32, 1],
        None => [(1000.0 * rate).round().max(1.0) as u32, 1000],
    })
}

/// Reads a text for the header of the file, in which a 0 would end it.
fn line(value: Value) -> Option<String> {
    let text = value.text()?;
    match text.contains('\0') {
        true => value.refuse("text for a file's header cannot contain the character 0"),
        false => Some(text.to_owned()),
    }
}
