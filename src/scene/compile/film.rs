//! The film: its pixels and its filter.

use toml::de::DeValue;

use super::format::format;
use crate::film::{Filter, Format, Mitchell, Overscan, Window};
use crate::scene::FilmSettings;
use crate::scene::text::{Choice, Fields, Value, spanned};
use crate::spectrum::ColorSpace;

/// ```toml
/// [film]
/// width = 960
/// height = 540
/// overscan = 16                      # pixels around the format, or [left, top, right, bottom]
/// crop = [100, 50, 320, 180]         # first column, first row from the top, width and height
/// layers = ["albedo", "N", "lights"]
/// first = "visible"                  # albedo, N and others of what is seen in mirrors and through glass
/// precision = "half"
/// compression = "piz"
/// multipart = true
/// stokes = true                      # layers S1, S2, S3: how the light is polarized
/// spectral = true                    # or { from = 380, to = 780, step = 5 }, in nm: a spectral image beside it
/// radiometry = "absolute"            # lights are given in cd/m2, lx, cd, or in watts per nm
/// white_luminance = 100              # cd/m2 of red, green and blue of 1
/// metadata = { owner = "Ernst Abbe", comments = "shot 12", frames_per_second = 24 }
/// ```
pub(super) fn film(value: Value) -> Option<(FilmSettings, Format)> {
    Fields::read(value, |film| {
        let width = film.need("width", side);
        let height = film.need("height", spanned(side));
        let filter = film.or("filter", Filter::default(), filter);
        let spaces = ColorSpace::ALL.map(|space| (space.interop_id(), space));
        let color_space = film.or("color_space", ColorSpace::default(), |value| value.word(&spaces));
        let overscan = film.maybe("overscan", spanned(overscan));
        let crop = film.maybe("crop", spanned(crop));
        let format = format(film);
        let (width, height) = (width?, height?);
        let (pixels, most) = (u64::from(width) * u64::from(height.value), FilmSettings::MAX_PIXELS);
        if pixels > most {
            let message = format!("{width} x {} is {pixels} pixels; at most {most} fit", height.value);
            let [across, down] = [width, height.value].map(u64::from);
            let (wide, high) = ((most * across / down).isqrt(), (most * down / across).isqrt());
            return height.place.advise(message, format!("at this aspect ratio, {wide} x {high} pixels fit"));
        }
        let (filter, color_space, height, overscan, crop) = (filter?, color_space?, height.value, overscan?, crop?);
        let film = FilmSettings {
            width,
            height,
            filter,
            color_space,
            overscan: overscan.map(|overscan| overscan.value).unwrap_or_default(),
            crop: crop.map(|crop| crop.value),
        };
        if let Some((overscan, message)) = overscan.zip(film.objection_to_overscan()) {
            return overscan.place.advise(message, "overscan is a number of pixels, or [left, top, right, bottom]");
        }
        if let Some((crop, message)) = crop.zip(film.objection_to_crop()) {
            let help = "a crop is [first column, first row, width, height], from the top left corner";
            return crop.place.advise(message, help);
        }
        Some((film, format?))
    })
}

fn side(value: Value) -> Option<u32> {
    value.whole_number(1..=FilmSettings::MAX_SIDE.into())
}

fn crop(value: Value) -> Option<Window> {
    let value = value.as_list("", "write [first column, first row, width, height]");
    let [left, top, width, height] = value.array(Some)?;
    Some(Window { left: left.integer()?, top: top.integer()?, width: width.count()?, height: height.count()? })
}

fn overscan(value: Value) -> Option<Overscan> {
    match value.node() {
        DeValue::Integer(_) | DeValue::Float(_) => value.count().map(Overscan::even),
        DeValue::Array(_) => {
            let [left, top, right, bottom] =
                value.as_list("", "write [left, top, right, bottom]").array(Value::count)?;
            Some(Overscan { left, top, right, bottom })
        }
        _ => value.expected("a number of pixels or a list [left, top, right, bottom]"),
    }
}

/// The filters that have a width or parameters.
const FILTER: Choice<for<'d> fn(Value<'d>) -> Option<Filter>> = Choice {
    name: "a filter",
    word: "filter",
    example: "{ gaussian = { sigma = 0.5 } }",
    second_kind_help: "leave one of them out",
    outside_keys: &[],
    kinds: &[
        ("tent", |value| wide(value, "radius", |radius| Filter::Tent { radius })),
        ("gaussian", |value| wide(value, "sigma", |sigma| Filter::Gaussian { sigma })),
        ("blackman-harris", |value| wide(value, "radius", |radius| Filter::BlackmanHarris { radius })),
        ("mitchell", mitchell),
    ],
};

fn wide(value: Value, key: &'static str, filter: fn(f64) -> Filter) -> Option<Filter> {
    let width = |value: Value| {
        let filter = filter(value.number()?);
        match filter.too_wide() {
            Some((key, width, most)) => {
                value.refuse(format!("{key} is a width above 0 and at most {most} pixels, not {width}"))
            }
            None => Some(filter),
        }
    };
    Fields::read(value, |table| table.need(key, width))
}

fn mitchell(value: Value) -> Option<Filter> {
    Fields::read(value, |table| {
        let parameter = |key: &'static str| {
            move |value: Value| {
                value.number_within(0.0..=1.0, &format!("{key} lies between 0 and 1"), Some(MITCHELL_HELP))
            }
        };
        let [b, c] = ["b", "c"].map(|key| table.need(key, parameter(key)));
        Some(Filter::Mitchell(Mitchell { b: b?, c: c? }))
    })
}

const MITCHELL_HELP: &str = "\"mitchell\" alone has b = 1/3 and c = 1/3; b = 0 and c = 0.5 give the Catmull-Rom spline";

fn filter(value: Value) -> Option<Filter> {
    let named = Filter::PLAIN.map(|filter| (filter.name(), filter));
    match value.node() {
        DeValue::String(_) => return value.word(&named),
        DeValue::Table(_) => {}
        _ => return value.expected("a name in quotes or a table such as { gaussian = { sigma = 0.5 } }"),
    }
    let kind = FILTER.kind(value)?;
    let plain = kind.key();
    if !FILTER.knows(plain) && named.iter().any(|(name, _)| *name == plain) {
        let help = format!("write filter = \"{plain}\"");
        return kind.refuse_key(format!("the filter `{plain}` has no width"), Some(help));
    }
    FILTER.reader(kind)?(kind)
}
