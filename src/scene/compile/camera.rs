//! The camera.

use std::ops::Bound;

use super::context::Context;
use super::ranges::{MAX_LENGTH, direction, length, point, radians_hint};
use crate::math::DVec3;
use crate::scene::text::{Fields, Value, above_0_to, six_digits, spanned};
use crate::scene::{Camera, FilmSettings, Lens, PolarizingFilter, Projection};

/// Smallest focus distance. The slope by which a lens bends rays, its radius over this distance, stays within f64.
const MIN_FOCUS_DISTANCE: f64 = 1e-30;
/// Widest sensor, in mm: a kilometer.
const MAX_SENSOR_WIDTH: f64 = 1e6;
/// Largest shift, in heights of the image.
const MAX_SHIFT: f64 = 1000.0;

/// ```toml
/// [camera]
/// position = [0, 1.2, 6]
/// look_at = [0, 1, 0]
/// vertical_fov = 35          # degrees
/// lens = { radius = 0.02, focus_distance = 6 }
/// shift = [0, 0.2]           # of the image's height
/// sensor_width = 36          # mm; for the file alone
/// polarizer = { axis = 90 }  # a filter before it: degrees from the image's right toward its top
/// ```
///
/// `film` is none if the film has a mistake.
pub(super) fn camera(context: &mut Context, value: Value, film: Option<&FilmSettings>) -> Option<Camera> {
    Fields::read(value, |camera| {
        let position = camera.need("position", point);
        let target = camera.need("look_at", spanned(point));
        let up = camera.maybe("up", spanned(direction));
        let filter = camera.maybe("polarizer", filter);
        let named = camera.get("projection");
        let kind = named.map_or(Some(ProjectionKind::Perspective), |value| value.word(&PROJECTIONS));
        let projection = projection(context, camera, kind);
        let shift = camera.or("shift", [0.0; 2], shift);
        let far = position.zip(target.as_ref()).map(|(position, target)| (target.value - position).length());
        let lens = camera.maybe("lens", |value| lens(value, far));
        let near = camera.or("near", 0.0, |value| {
            value.number_within(0.0..=MAX_LENGTH, &format!("near is a distance from 0 to {MAX_LENGTH:e}"), None)
        });
        let sensor = camera.maybe("sensor_width", |value| sensor_width(value, kind?));
        let (position, target, up) = (position?, target?, up?);
        if (target.value - position).try_normalize().is_none() {
            return target.place.refuse("the camera looks at its own position");
        }
        let (projection, shift, lens, near, sensor, film) = (projection?, shift?, lens?, near?, sensor?, film?);
        let size = [film.width, film.height];
        let (view, parallel) =
            Camera::new(position, target.value, up.map_or(DVec3::Y, |up| up.value), projection, size);
        if parallel {
            let place = up.map_or(target.place, |up| up.place);
            context.warn_at(place, "`up` is parallel to the viewing direction; another direction is used");
        }
        if let Some(named) = named.filter(|_| projection == Projection::Equirectangular && size[0] != 2 * size[1]) {
            let [width, height] = size;
            let stretched = format!("{width} x {height} pixels are stretched");
            context.warn_at(named, format!("an equirectangular image is twice as wide as high; {stretched}"));
        }
        Some(view.starting_at(near).shifted(shift).with_lens(lens).on_sensor(sensor).behind(filter?))
    })
}

/// The mapping from directions to positions in the image.
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

/// Reads the projection. The camera must have the keys for it and no others.
fn projection(context: &mut Context, camera: &mut Fields, kind: Option<ProjectionKind>) -> Option<Projection> {
    let keys = ["vertical_fov", "height", "shift", "lens"].map(|key| camera.get(key));
    let [vertical_fov, height, ..] = keys;
    match (kind?, vertical_fov, height) {
        (ProjectionKind::Perspective, _, Some(height)) => {
            let help = "give its vertical_fov, or write projection = \"orthographic\"";
            height.advise("a perspective camera has no height", help)
        }
        (ProjectionKind::Perspective, Some(value), None) => {
            let between = (Bound::Excluded(0.0), Bound::Excluded(180.0));
            let vertical_fov = value.number_within(between, "a field of view lies between 0 and 180 degrees", None)?;
            if let Some(radians) = radians_hint(vertical_fov) {
                context.warn_at(value, format!("a field of view of {vertical_fov} degrees is very narrow{radians}"));
            }
            Some(Projection::Perspective { vertical_fov })
        }
        (ProjectionKind::Perspective, None, None) => camera.report_missing("vertical_fov", None),
        (ProjectionKind::Orthographic, Some(value), _) => {
            value.advise("an orthographic camera has no field of view", HEIGHT_HELP)
        }
        (ProjectionKind::Orthographic, None, Some(height)) => {
            Some(Projection::Orthographic { height: length(height, "the height of a view")? })
        }
        (ProjectionKind::Orthographic, None, None) => camera.report_missing("height", Some(HEIGHT_HELP)),
        (ProjectionKind::Equirectangular, ..) => match keys.into_iter().flatten().next() {
            Some(value) => {
                let message = format!("an equirectangular camera sees the full sphere and has no {}", value.key());
                value.advise(message, "leave it out, or choose another projection")
            }
            None => Some(Projection::Equirectangular),
        },
    }
}

/// Reads the width of the sensor in mm, or that of the film in a film camera.
fn sensor_width(value: Value, kind: ProjectionKind) -> Option<f64> {
    match kind {
        ProjectionKind::Perspective => {
            let help = "in millimeters: 36 for a full-frame camera, 24.9 for Super 35";
            value.number_within(
                above_0_to(MAX_SENSOR_WIDTH),
                &format!("a sensor width is above 0 and at most {MAX_SENSOR_WIDTH:e} mm"),
                Some(help),
            )
        }
        _ => value.advise("only a perspective camera has a focal length and a sensor", "leave it out"),
    }
}

const HEIGHT_HELP: &str = "give the height of the view in scene units: height = 2";

fn shift(value: Value) -> Option<[f64; 2]> {
    let shift: [f64; 2] = value.as_list("", "write [right, up] in image heights").numbers()?;
    match shift.iter().position(|part| !(-MAX_SHIFT..=MAX_SHIFT).contains(part)) {
        Some(axis) => {
            let message =
                format!("a shift lies between -{MAX_SHIFT} and {MAX_SHIFT} image heights, not {}", shift[axis]);
            value.entry(axis).refuse(message)
        }
        None => Some(shift),
    }
}

/// Reads `lens = { radius = 0.02, focus_distance = 6 }`: the radius of the aperture in scene units, 0 for a pinhole,
/// and the distance along the viewing direction at which points are sharp, `inf` for infinity. `far` is the distance of
/// the point that the camera looks at.
fn lens(value: Value, far: Option<f64>) -> Option<Lens> {
    Fields::read(value, |lens| {
        let radius = lens.need("radius", |value| {
            value.number_within(
                0.0..=MAX_LENGTH,
                &format!("the radius of a lens is a length from 0 to {MAX_LENGTH:e}"),
                None,
            )
        });
        let Some(focus) = lens.get("focus_distance") else {
            let help = far.map(|far| format!("`look_at` is {} scene units away", six_digits(far)));
            return lens.report_missing("focus_distance", help.as_deref());
        };
        let help = "write inf to focus at infinity";
        let rule = format!("a focus distance is at least {MIN_FOCUS_DISTANCE:e}");
        let focus = focus.number_within(MIN_FOCUS_DISTANCE..=f64::INFINITY, &rule, Some(help));
        Some(Lens::new(radius?, focus?))
    })
}

/// Reads `polarizer = { axis = 90, extinction = 0 }`: the direction of its axis in degrees, and its transmittance
/// across the axis.
fn filter(value: Value) -> Option<PolarizingFilter> {
    Fields::read(value, |filter| {
        let axis = filter.need("axis", |value| {
            let help = "in degrees: 0 points to the right of the image, 90 to its top";
            value.number_within(-360.0..=360.0, "an axis lies between -360 and 360 degrees", Some(help))
        });
        let extinction = filter.or("extinction", 0.0, extinction);
        Some(PolarizingFilter { angle: axis?.to_radians(), extinction: extinction? })
    })
}

/// Reads the transmittance of a polarizer across its axis, relative to that along the axis.
pub(super) fn extinction(value: Value) -> Option<f64> {
    let help = "relative to the transmittance along the axis: 0 for a perfect polarizer, about 0.0001 for a sheet";
    value.number_within(0.0..=1.0, "an extinction lies between 0 and 1", Some(help))
}
