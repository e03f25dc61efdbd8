//! The film and the camera.

use std::ops::Bound;

use toml::de::DeValue;

use super::context::Context;
use super::measures::{MAX_LENGTH, direction, length, point};
use crate::film::{Compression, Filter, FirstSurface, Format, Layer, Mitchell, Overscan, Precision, Window};
use crate::math::DVec3;
use crate::scene::text::{At, Choice, Fields, Value, above_0_to, at};
use crate::scene::{Camera, FilmSettings, Lens, Projection};
use crate::spectrum::visible::{FIRST_NM, LAST_NM};
use crate::spectrum::{ColorSpace, WavelengthBands};

/// Nearest focus: what a lens bends by, radius over this, stays within f64.
const NEAREST_FOCUS: f64 = 1e-30;
/// Largest luminance of white: that of the sun is 1.6e9.
const MOST_LUMINOUS: f64 = 1e12;
/// Widest sensor, in mm: a kilometer.
const WIDEST_SENSOR: f64 = 1e6;
/// Largest shift in heights of the image.
const MAX_SHIFT: f64 = 1000.0;

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
/// spectral = true                    # or { from = 380, to = 780, step = 5 }, in nm: a spectral image beside it
/// radiometry = "absolute"            # lights are given in cd/m2, lx, cd, or in watts per nm
/// white_luminance = 100              # cd/m2 of red, green and blue of 1
/// metadata = { owner = "Ernst Abbe", comments = "shot 12" }
/// ```
pub(super) fn film(value: Value) -> Option<(FilmSettings, Format)> {
    Fields::read(value, |film| {
        let width = film.need("width", at(side));
        let height = film.need("height", at(side));
        let filter = film.or("filter", Filter::default(), filter);
        let spaces = ColorSpace::ALL.map(|space| (space.interop_id(), space));
        let color_space = film.or("color_space", ColorSpace::default(), |value| value.word(&spaces));
        let overscan = film.maybe("overscan", at(overscan));
        let crop = film.maybe("crop", at(crop));
        let format = format(film);
        let (width, height) = (width?.it, height?);
        let (pixels, most) = (u64::from(width) * u64::from(height.it), FilmSettings::MAX_PIXELS);
        if pixels > most {
            return height.place.refuse(format!("{width} x {} pixels are {pixels}; at most {most} fit", height.it));
        }
        let (filter, color_space, height, overscan, crop) = (filter?, color_space?, height.it, overscan?, crop?);
        let film = FilmSettings {
            width,
            height,
            filter,
            color_space,
            overscan: overscan.map_or(Overscan::default(), |overscan| overscan.it),
            crop: crop.map(|crop| crop.it),
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

/// What the file holds.
fn format(film: &mut Fields) -> Option<Format> {
    let layers = film.or("layers", Vec::new(), layers);
    let first = film.or("first", FirstSurface::default(), |value| value.word(&FirstSurface::NAMES));
    let precision = film.maybe("precision", |value| value.word(&Precision::NAMES));
    let compression = film.maybe("compression", at(compression));
    let multipart = film.or("multipart", false, Value::yes_or_no);
    let spectral = film.or("spectral", None, spectral);
    let metadata = film.or("metadata", [None, None], |value| {
        Fields::read(value, |metadata| {
            let [owner, comments] = ["owner", "comments"].map(|key| metadata.maybe(key, line));
            Some([owner?, comments?])
        })
    });
    let white_luminance = white_luminance(film);
    let [owner, comments] = metadata?;
    let (layers, first, compressed, multipart) = (layers?, first?, compression?, multipart?);
    let (place, compression) = compressed.map_or((None, Compression::default()), |at| (Some(at.place), at.it));
    let precision = precision?.unwrap_or(match compression.is_of_16_bits() {
        true => Precision::Half,
        false => Precision::default(),
    });
    let (white_luminance, spectral) = (white_luminance?, spectral?);
    let format =
        Format { layers, first, precision, compression, multipart, spectral, white_luminance, owner, comments };
    match place.and_then(|place| Some((place, format.objection()?))) {
        Some((place, (message, help))) => place.advise(message, help),
        None => Some(format),
    }
}

/// Luminance of red, green and blue of 1, if the scene's light is absolute.
fn white_luminance(film: &mut Fields) -> Option<Option<f64>> {
    let is_absolute = film.or("radiometry", false, |value| value.word(&[("absolute", true), ("relative", false)]));
    let help = "in cd/m2: 100 is about that of a screen's white";
    let what = format!("a luminance of white is above 0 to {MOST_LUMINOUS:e}");
    let white =
        film.maybe("white_luminance", at(|value: Value| value.within(above_0_to(MOST_LUMINOUS), &what, Some(help))));
    match (is_absolute?, white?) {
        (true, white) => Some(Some(white.map_or(1.0, |white| white.it))),
        (false, None) => Some(None),
        (false, Some(At { place, .. })) => place.refuse_key(
            "a luminance of white goes with radiometry = \"absolute\"",
            Some("add that, or leave it out".into()),
        ),
    }
}

/// The bands of a spectral image: true for those that most programs expect, or from where to where, in nm, and the
/// width of each.
fn spectral(value: Value) -> Option<Option<WavelengthBands>> {
    match value.node() {
        DeValue::Boolean(true) => return Some(Some(WavelengthBands::default())),
        DeValue::Boolean(false) => return Some(None),
        DeValue::Table(_) => {}
        _ => return value.wanted("true, or a table such as { from = 380, to = 780, step = 5 }"),
    }
    let [from, to, step] = Fields::read(value, |bands| {
        let nm = |value: Value| value.within(FIRST_NM..=LAST_NM, "a band lies between 360 and 830 nm", None);
        let width = |value: Value| {
            let between = (Bound::Excluded(0.0), Bound::Included(LAST_NM - FIRST_NM));
            value.within(between, "a step is a width above 0 and at most 470 nm", None)
        };
        let [from, to, step] = [bands.or("from", 380.0, nm), bands.or("to", 780.0, nm), bands.or("step", 5.0, width)];
        Some([from?, to?, step?])
    })?;
    let most = WavelengthBands::MOST;
    match WavelengthBands::new(from, to, step) {
        Some(bands) => Some(Some(bands)),
        None if from > to => value.refuse(format!("the last band, at {to} nm, lies before the first, at {from} nm")),
        None => value.refuse(format!("a step of {step} nm makes more than the {most} bands that fit")),
    }
}

fn compression(value: Value) -> Option<Compression> {
    match value.node().as_str() {
        Some(name @ ("b44" | "b44a")) => {
            let message =
                format!("the compression {name} is not written: dark pixels lose their colors beside bright ones");
            value.advise(message, "\"dwaa\" makes smaller files; \"piz\" and \"zip\" lose nothing")
        }
        _ => value.word(&Compression::NAMES),
    }
}

fn layers(value: Value) -> Option<Vec<Layer>> {
    match value.node().as_str() {
        Some(Layer::ALL) => return Some(Layer::all()),
        Some(word) => {
            return value.advise("`layers` is a list", format!("write layers = [\"{word}\"], or \"{}\"", Layer::ALL));
        }
        None => {}
    }
    value
        .as_list("layer", "write a list such as [\"albedo\", \"N\"], or \"all\"")
        .list(|layer| layer.word(&Layer::NAMES))
}

/// Text for the header of the file, which a 0 would end.
fn line(value: Value) -> Option<String> {
    let text = value.text()?;
    match text.contains('\0') {
        true => value.refuse("text of a file's header has no character 0"),
        false => Some(text.to_owned()),
    }
}

fn side(value: Value) -> Option<u32> {
    match value.count()? {
        size @ 1..=FilmSettings::MAX_SIDE => Some(size),
        size => {
            let most = FilmSettings::MAX_SIDE;
            value.refuse(format!("an image has 1 to {most} pixels along each side, not {size}"))
        }
    }
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
        _ => value.wanted("a number of pixels or a list [left, top, right, bottom]"),
    }
}

/// Filters with their widths or parameters.
const FILTER: Choice<for<'d> fn(Value<'d>) -> Option<Filter>> = Choice {
    name: "a filter",
    word: "filter",
    example: "{ gaussian = { sigma = 0.5 } }",
    apart: "leave one of them out",
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
            move |value: Value| value.within(0.0..=1.0, &format!("{key} lies between 0 and 1"), Some(CUBICS))
        };
        let [b, c] = ["b", "c"].map(|key| table.need(key, parameter(key)));
        Some(Filter::Mitchell(Mitchell { b: b?, c: c? }))
    })
}

const CUBICS: &str = "\"mitchell\" alone has b = 1/3 and c = 1/3; b = 0 and c = 0.5 are the spline of Catmull and Rom";

fn filter(value: Value) -> Option<Filter> {
    let named = Filter::PLAIN.map(|filter| (filter.name(), filter));
    match value.node() {
        DeValue::String(_) => return value.word(&named),
        DeValue::Table(_) => {}
        _ => return value.wanted("a name in quotes or a table such as { gaussian = { sigma = 0.5 } }"),
    }
    let kind = FILTER.kind(value)?;
    let plain = kind.key();
    if !FILTER.knows(plain) && named.iter().any(|(name, _)| *name == plain) {
        let help = format!("write filter = \"{plain}\"");
        return kind.refuse_key(format!("the filter `{plain}` has no width"), Some(help));
    }
    FILTER.reader(kind)?(kind)
}

/// ```toml
/// [camera]
/// position = [0, 1.2, 6]
/// look_at = [0, 1, 0]
/// vertical_fov = 35          # degrees
/// lens = { radius = 0.02, focus_distance = 6 }
/// shift = [0, 0.2]           # of the image's height
/// sensor_width = 36          # mm; for the file alone
/// ```
///
/// The film is absent if it is wrong.
pub(super) fn camera(context: &mut Context, value: Value, film: Option<&FilmSettings>) -> Option<Camera> {
    Fields::read(value, |camera| {
        let position = camera.need("position", point);
        let target = camera.need("look_at", at(point));
        let up = camera.or("up", DVec3::Y, direction);
        let kind = camera.or("projection", ProjectionKind::Perspective, |value| value.word(&PROJECTIONS));
        let keys = ["vertical_fov", "height", "shift", "lens"].map(|key| camera.get(key));
        let near = camera.or("near", 0.0, |value| {
            value.within(0.0..=MAX_LENGTH, &format!("near is a distance from 0 to {MAX_LENGTH:e}"), None)
        });
        let sensor = camera.maybe("sensor_width", |value| sensor_width(value, kind?));
        let projection = kind.and_then(|kind| projection(camera, kind, keys));
        let [_, _, shifted, opened] = keys;
        let shift = shifted.map_or(Some([0.0; 2]), shift);
        let lens = opened.map_or(Some(None), |value| lens(value).map(Some));
        let (position, target, up) = (position?, target?, up?);
        if (target.it - position).try_normalize().is_none() {
            return target.place.refuse("the camera looks at the very point where it stands");
        }
        let (projection, shift, lens, near, sensor, film) = (projection?, shift?, lens?, near?, sensor?, film?);
        let (view, parallel) = Camera::new(position, target.it, up, projection, [film.width, film.height]);
        if parallel {
            let warning = "camera.up is parallel to the viewing direction; another direction is taken";
            context.warn(warning);
        }
        if projection == Projection::Equirectangular && film.width != 2 * film.height {
            context.warn(format!(
                "an equirectangular image is twice as wide as high; {} x {} pixels are stretched",
                film.width, film.height
            ));
        }
        Some(view.starting_at(near).shifted(shift).with_lens(lens).on_sensor(sensor))
    })
}

/// How directions become places in the image.
#[derive(Clone, Copy)]
enum ProjectionKind {
    /// Rays from one point through a window.
    Perspective,
    /// Parallel rays.
    Orthographic,
    /// Rays of the full sphere, by longitude and latitude.
    Equirectangular,
}

const PROJECTIONS: [(&str, ProjectionKind); 3] = [
    ("perspective", ProjectionKind::Perspective),
    ("orthographic", ProjectionKind::Orthographic),
    ("equirectangular", ProjectionKind::Equirectangular),
];

/// The projection, if the camera has the keys for it and no other: of a vertical field of view in degrees, the height
/// of the view in scene units, a shift and a lens.
fn projection(
    camera: &mut Fields,
    kind: ProjectionKind,
    [vertical_fov, height, shift, lens]: [Option<Value>; 4],
) -> Option<Projection> {
    match (kind, vertical_fov, height) {
        (ProjectionKind::Perspective, _, Some(height)) => {
            let help = "give its vertical_fov, or write projection = \"orthographic\"";
            height.advise("a perspective camera has no height", help)
        }
        (ProjectionKind::Perspective, Some(value), None) => {
            let between = (Bound::Excluded(0.0), Bound::Excluded(180.0));
            let vertical_fov = value.within(between, "a field of view lies between 0 and 180 degrees", None)?;
            Some(Projection::Perspective { vertical_fov })
        }
        (ProjectionKind::Perspective, None, None) => camera.lack("vertical_fov", None),
        (ProjectionKind::Orthographic, Some(value), _) => {
            value.advise("an orthographic camera has no field of view", HEIGHT)
        }
        (ProjectionKind::Orthographic, None, Some(height)) => {
            Some(Projection::Orthographic { height: length(height, "the height of a view")? })
        }
        (ProjectionKind::Orthographic, None, None) => camera.lack("height", Some(HEIGHT)),
        (ProjectionKind::Equirectangular, ..) => match [vertical_fov, height, shift, lens].into_iter().flatten().next()
        {
            Some(value) => {
                let message = format!("an equirectangular camera sees the full sphere and has no {}", value.key());
                value.advise(message, "leave it out, or choose another projection")
            }
            None => Some(Projection::Equirectangular),
        },
    }
}

/// Width of the sensor in mm, or of the film in a camera.
fn sensor_width(value: Value, kind: ProjectionKind) -> Option<f64> {
    match kind {
        ProjectionKind::Perspective => {
            let help = "in millimeters: 36 of a full-frame camera, 24.9 of Super 35";
            value.within(
                above_0_to(WIDEST_SENSOR),
                &format!("a sensor is above 0 to {WIDEST_SENSOR:e} mm wide"),
                Some(help),
            )
        }
        _ => value.advise("only a perspective camera has a focal length, which its sensor tells", "leave it out"),
    }
}

const HEIGHT: &str = "give the height of the view in scene units: height = 2";

fn shift(value: Value) -> Option<[f64; 2]> {
    let shift: [f64; 2] = value.as_list("", "write [right, up] in heights of the image").numbers()?;
    match shift.iter().position(|part| !(-MAX_SHIFT..=MAX_SHIFT).contains(part)) {
        Some(axis) => {
            let message = format!("a shift is -{MAX_SHIFT} to {MAX_SHIFT} heights of the image, not {}", shift[axis]);
            value.entry(axis).refuse(message)
        }
        None => Some(shift),
    }
}

/// `lens = { radius = 0.02, focus_distance = 6 }`: the radius of the opening in scene units, 0 for a pinhole, and the
/// distance along the viewing direction at which points are sharp, `inf` for those infinitely far away.
fn lens(value: Value) -> Option<Lens> {
    Fields::read(value, |lens| {
        let radius = lens.need("radius", |value| {
            value.within(0.0..=MAX_LENGTH, &format!("the radius of a lens is a length from 0 to {MAX_LENGTH:e}"), None)
        });
        let focus = lens.need("focus_distance", |value| {
            let help = "write inf to see sharply what is far away";
            let what = format!("a focus lies at least {NEAREST_FOCUS:e} away");
            value.within(NEAREST_FOCUS..=f64::INFINITY, &what, Some(help))
        });
        Some(Lens::new(radius?, focus?))
    })
}
