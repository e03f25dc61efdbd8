//! The film and the camera.

use super::context::Context;
use super::measures::{MAX_LENGTH, direction, long, point};
use crate::film::{Filter, Window};
use crate::math::DVec3;
use crate::scene::text::{At, Choice, Fields, Value, at};
use crate::scene::{Camera, FilmSettings, Lens, Projection};
use crate::spectrum::ColorSpace;

/// Most pixels in a row or column.
const MAX_SIDE: u32 = 65_536;
/// Most pixels in an image: at 20 bytes each, and as many again while the file is written, 10 GB.
const MAX_PIXELS: u64 = 1 << 28;
/// Nearest focus: what a lens bends by, radius over this, stays within f64.
const NEAREST_FOCUS: f64 = 1e-30;
/// Largest shift in heights of the image.
const MAX_SHIFT: f64 = 1000.0;

/// ```toml
/// [film]
/// width = 960
/// height = 540
/// crop = [100, 50, 320, 180]         # first column, first row from the top, width and height
/// ```
pub(super) fn film(value: Value) -> Option<FilmSettings> {
    Fields::read(value, |film| {
        let width = film.need("width", at(side));
        let height = film.need("height", at(side));
        let filter = film.or("filter", Filter::default(), filter);
        let spaces = ColorSpace::ALL.map(|space| (space.interop_id(), space));
        let color_space = film.or("color_space", ColorSpace::default(), |value| value.word(&spaces));
        let crop = film.maybe("crop", at(crop));
        let (width, height) = (width?.it, height?);
        let pixels = u64::from(width) * u64::from(height.it);
        if pixels > MAX_PIXELS {
            let message = format!("{width} x {} pixels are {pixels}; at most {MAX_PIXELS} fit", height.it);
            return height.place.refuse(message);
        }
        let (filter, color_space, crop) = (filter?, color_space?, crop?);
        let film = FilmSettings { width, height: height.it, filter, color_space, crop: crop.map(|crop| crop.it) };
        match crop.and_then(|crop| Some((crop.place, film.objection(crop.it)?))) {
            Some((place, message)) => {
                place.advise(message, "a crop is [first column, first row, width, height], from the top left corner")
            }
            None => Some(film),
        }
    })
}

fn side(value: Value) -> Option<u32> {
    match value.count()? {
        size @ 1..=MAX_SIDE => Some(size),
        size => value.refuse(format!("an image has 1 to {MAX_SIDE} pixels along each side, not {size}")),
    }
}

fn crop(value: Value) -> Option<Window> {
    let value = value.as_list("", "write [first column, first row, width, height]");
    let [left, top, width, height] = value.array(Value::count)?;
    Some(Window { left, top, width, height })
}

/// Filters with their widths.
const FILTER: Choice<for<'d> fn(Value<'d>) -> Option<Filter>> = Choice {
    name: "a filter",
    word: "filter",
    example: "{ gaussian = { sigma = 0.5 } }",
    apart: "leave one of them out",
    kinds: &[
        ("tent", |value| wide(value, |table| Some(Filter::Tent { radius: table.need("radius", Value::number)? }))),
        ("gaussian", |value| {
            wide(value, |table| Some(Filter::Gaussian { sigma: table.need("sigma", Value::number)? }))
        }),
        ("blackman-harris", |value| {
            wide(value, |table| Some(Filter::BlackmanHarris { radius: table.need("radius", Value::number)? }))
        }),
    ],
};

fn wide<'d>(value: Value<'d>, read: impl FnOnce(&mut Fields<'d>) -> Option<Filter>) -> Option<Filter> {
    Fields::read(value, |table| {
        let filter = read(table)?;
        match filter.too_wide() {
            Some((key, width, most)) => {
                let place = table.get(key).unwrap_or(value);
                place.refuse(format!("{key} is a width above 0 and at most {most} pixels, not {width}"))
            }
            None => Some(filter),
        }
    })
}

fn filter(value: Value) -> Option<Filter> {
    let named = Filter::PLAIN.map(|filter| (filter.name(), filter));
    match value.node() {
        toml::de::DeValue::String(_) => return value.word(&named),
        toml::de::DeValue::Table(_) => {}
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
/// ```
///
/// The film is absent if it is wrong.
pub(super) fn camera(context: &mut Context, value: Value, film: Option<&FilmSettings>) -> Option<Camera> {
    Fields::read(value, |camera| {
        let position = camera.need("position", point);
        let target = camera.need("look_at", at(point));
        let up = camera.or("up", DVec3::Y, direction);
        let projection = ProjectionText::read(camera);
        let near = camera.or("near", 0.0, |value| match value.number()? {
            near if (0.0..=MAX_LENGTH).contains(&near) => Some(near),
            near => value.refuse(format!("near is a distance from 0 to {MAX_LENGTH:e}, not {near}")),
        });
        let projection = projection.and_then(|text| text.projection(camera));
        let (position, target, up) = (position?, target?, up?);
        if (target.it - position).try_normalize().is_none() {
            return target.place.refuse("the camera looks at the very point where it stands");
        }
        let (opened, near, film) = (projection?, near?, film?);
        let (view, parallel) = Camera::new(position, target.it, up, opened.projection, [film.width, film.height]);
        if parallel {
            let warning = "camera.up is parallel to the viewing direction; another direction is taken";
            context.warnings.push(warning.into());
        }
        if opened.projection == Projection::Equirectangular && film.width != 2 * film.height {
            context.warnings.push(format!(
                "an equirectangular image is twice as wide as high; {} x {} pixels are stretched",
                film.width, film.height
            ));
        }
        Some(view.starting_at(near).shifted(opened.shift).with_lens(opened.lens))
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

/// What a camera says of its projection, some of which not every projection has.
struct ProjectionText<'d> {
    kind: ProjectionKind,
    /// Full angle from the bottom to the top of the image, in degrees: perspective alone.
    vertical_fov: Option<At<'d, f64>>,
    /// Height of the view in scene units: orthographic alone.
    height: Option<At<'d, f64>>,
    /// How far the window onto the world is moved to the right and up, in heights of the image.
    shift: Option<At<'d, [f64; 2]>>,
    /// A lens with an extent; without it everything is sharp.
    lens: Option<At<'d, Lens>>,
}

/// A projection by what opening.
struct Opened {
    projection: Projection,
    shift: [f64; 2],
    lens: Option<Lens>,
}

impl<'d> ProjectionText<'d> {
    fn read(camera: &mut Fields<'d>) -> Option<Self> {
        use ProjectionKind::{Equirectangular, Orthographic, Perspective};
        const KINDS: [(&str, ProjectionKind); 3] =
            [("perspective", Perspective), ("orthographic", Orthographic), ("equirectangular", Equirectangular)];
        let kind = camera.or("projection", Perspective, |value| value.word(&KINDS));
        let vertical_fov = camera.maybe("vertical_fov", at(Value::number));
        let height = camera.maybe("height", at(Value::number));
        let shift = camera.maybe("shift", at(shift));
        let lens = camera.maybe("lens", at(lens));
        Some(Self { kind: kind?, vertical_fov: vertical_fov?, height: height?, shift: shift?, lens: lens? })
    }

    /// The projection, if the camera has the keys for it and no other.
    fn projection(self, camera: &mut Fields) -> Option<Opened> {
        let projection = match self.kind {
            ProjectionKind::Perspective => {
                if let Some(height) = self.height {
                    let help = "give its vertical_fov, or write projection = \"orthographic\"";
                    return height.place.advise("a perspective camera has no height", help);
                }
                let Some(At { place, it: vertical_fov }) = self.vertical_fov else {
                    return camera.lack("vertical_fov", None);
                };
                if !(vertical_fov > 0.0 && vertical_fov < 180.0) {
                    return place.refuse(format!("a field of view lies between 0 and 180 degrees, not {vertical_fov}"));
                }
                Projection::Perspective { vertical_fov }
            }
            ProjectionKind::Orthographic => {
                let help = "give the height of the view in scene units: height = 2";
                if let Some(vertical_fov) = self.vertical_fov {
                    return vertical_fov.place.advise("an orthographic camera has no field of view", help);
                }
                let Some(height) = self.height else { return camera.lack("height", Some(help)) };
                Projection::Orthographic { height: long(height.place, "the height of a view", height.it)? }
            }
            ProjectionKind::Equirectangular => {
                let surplus = [
                    self.vertical_fov.map(|key| key.place),
                    self.height.map(|key| key.place),
                    self.shift.map(|key| key.place),
                    self.lens.map(|key| key.place),
                ];
                if let Some(place) = surplus.into_iter().flatten().next() {
                    let key = place.key();
                    let message = format!("an equirectangular camera sees the full sphere and has no {key}");
                    return place.advise(message, "leave it out, or choose another projection");
                }
                Projection::Equirectangular
            }
        };
        let shift = self.shift.map(|shift| shift.it).unwrap_or_default();
        Some(Opened { projection, shift, lens: self.lens.map(|lens| lens.it) })
    }
}

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
        let radius = lens.need("radius", |value| match value.number()? {
            radius if (0.0..=MAX_LENGTH).contains(&radius) => Some(radius),
            radius => value.refuse(format!("the radius of a lens is a length from 0 to {MAX_LENGTH:e}, not {radius}")),
        });
        let focus = lens.need("focus_distance", |value| match value.number()? {
            // An infinite distance is one; NaN is none.
            focus if (NEAREST_FOCUS..=f64::INFINITY).contains(&focus) => Some(focus),
            focus => {
                let message = format!("a focus lies at least {NEAREST_FOCUS:e} away, not {focus}");
                value.advise(message, "write inf to see sharply what is far away")
            }
        });
        Some(Lens::new(radius?, focus?))
    })
}
