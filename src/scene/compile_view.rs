//! From camera and film as written to ones that can be used.

use super::compile::Compiler;
use super::compile_shape::MAX_LENGTH;
use super::description_view::{CameraText, FilmText, LensText, ProjectionText};
use super::gather::{Gather, all, told_elsewhere};
use super::source::At;
use super::{Camera, FilmSettings, Lens, Projection};
use crate::error::Result;
use crate::film::Window;

/// Most pixels in a row or column.
const MAX_SIDE: u32 = 65_536;
/// Most pixels in an image: at 20 bytes each, and as many again while the file is written, 10 GB.
const MAX_PIXELS: u64 = 1 << 28;
/// Nearest focus: what a lens bends by, radius over this, stays within f64.
const NEAREST_FOCUS: f64 = 1e-30;
/// Largest shift in heights of the image.
const MAX_SHIFT: f64 = 1000.0;

impl Compiler<'_> {
    pub(super) fn film(&mut self, film: &FilmText) -> Result<FilmSettings> {
        let at = At::top("film");
        let sides = all([("width", film.width), ("height", film.height)].map(|(key, size)| match size {
            1..=MAX_SIDE => Ok(size),
            _ => {
                let message = format!("an image has 1 to {MAX_SIDE} pixels along each side, not {size}");
                Err(self.source.mistake_at(&at.key(key), message, None))
            }
        }));
        let pixels = u64::from(film.width) * u64::from(film.height);
        let size = sides.and_then(|_| match pixels {
            ..=MAX_PIXELS => Ok(()),
            _ => {
                let message = format!("{} x {} pixels are {pixels}; at most {MAX_PIXELS} fit", film.width, film.height);
                Err(self.source.mistake_at(&at.key("height"), message, None))
            }
        });
        let filter = match film.filter.too_wide() {
            Some((key, width, most)) => {
                let message = format!("{key} is a width above 0 and at most {most} pixels, not {width}");
                let (filter, kind) = (at.key("filter"), film.filter.name());
                Err(self.source.mistake_at(&filter.key(kind).key(key), message, None))
            }
            None => Ok(()),
        };
        (size, filter).gather()?;
        let FilmText { width, height, filter, color_space, crop } = *film;
        let crop = crop.map(|[left, top, width, height]| Window { left, top, width, height });
        let settings = FilmSettings { width, height, filter, color_space, crop };
        match crop.and_then(|crop| settings.objection(crop)) {
            Some(message) => {
                let help = "a crop is [first column, first row, width, height], from the top left corner";
                Err(self.source.mistake_at(&at.key("crop"), message, Some(help.into())))
            }
            None => Ok(settings),
        }
    }

    /// The camera; the film is absent if it is wrong.
    pub(super) fn camera(&mut self, camera: &CameraText, film: Option<&FilmSettings>) -> Result<Camera> {
        let at = At::top("camera");
        let position = self.point(&at.key("position"), camera.position);
        let target = self.point(&at.key("look_at"), camera.look_at);
        let view =
            (position, target).gather().and_then(|(position, target)| match (target - position).try_normalize() {
                Some(_) => Ok((position, target)),
                None => {
                    let message = "the camera looks at the very point where it stands";
                    Err(self.source.mistake_at(&at.key("look_at"), message, None))
                }
            });
        let up = self.direction(&at.key("up"), camera.up);
        let projection = self.projection(&at, camera);
        let near = match camera.near {
            near if (0.0..=MAX_LENGTH).contains(&near) => Ok(near),
            near => {
                let message = format!("near is a distance from 0 to {MAX_LENGTH:e}, not {near}");
                Err(self.source.mistake_at(&at.key("near"), message, None))
            }
        };
        let shift = self.shift(&at.key("shift"), camera.shift);
        let lens = camera.lens.map(|lens| self.lens(&at.key("lens"), lens)).transpose();
        let (seen, opened) = ((view, up, projection).gather(), (near, shift, lens).gather()).gather()?;
        let (((position, target), up, projection), (near, shift, lens)) = (seen, opened);
        let Some(film) = film else { return told_elsewhere() };
        let (view, parallel) = Camera::new(position, target, up, projection, [film.width, film.height]);
        if parallel {
            self.warnings.push("camera.up is parallel to the viewing direction; another direction is taken".into());
        }
        if projection == Projection::Equirectangular && film.width != 2 * film.height {
            self.warnings.push(format!(
                "an equirectangular image is twice as wide as high; {} x {} pixels are stretched",
                film.width, film.height
            ));
        }
        Ok(view.starting_at(near).shifted(shift).with_lens(lens))
    }

    /// What the camera projects, if it has the keys for it and no other.
    fn projection(&self, at: &At, camera: &CameraText) -> Result<Projection> {
        let refuse = |key: &str, message: &str, help: &str| {
            Err(self.source.mistake_at(&at.key(key), message, Some(help.into())))
        };
        match camera.projection {
            ProjectionText::Perspective => {
                if camera.height.is_some() {
                    let help = "give its vertical_fov, or write projection = \"orthographic\"";
                    return refuse("height", "a perspective camera has no height", help);
                }
                let Some(vertical_fov) = camera.vertical_fov else {
                    return Err(self.source.mistake_at(at, "`vertical_fov` is missing", None));
                };
                if !(vertical_fov > 0.0 && vertical_fov < 180.0) {
                    let message = format!("a field of view lies between 0 and 180 degrees, not {vertical_fov}");
                    return Err(self.source.mistake_at(&at.key("vertical_fov"), message, None));
                }
                Ok(Projection::Perspective { vertical_fov })
            }
            ProjectionText::Orthographic => {
                let help = "give the height of the view in scene units: height = 2";
                if camera.vertical_fov.is_some() {
                    return refuse("vertical_fov", "an orthographic camera has no field of view", help);
                }
                let Some(height) = camera.height else {
                    return Err(self.source.mistake_at(at, "`height` is missing", Some(help.into())));
                };
                Ok(Projection::Orthographic { height: self.length(&at.key("height"), "the height of a view", height)? })
            }
            ProjectionText::Equirectangular => {
                let help = "leave it out, or choose another projection";
                let surplus = [
                    ("vertical_fov", camera.vertical_fov.is_some()),
                    ("height", camera.height.is_some()),
                    ("shift", camera.shift.is_some()),
                    ("lens", camera.lens.is_some()),
                ];
                match surplus.into_iter().find(|(_, given)| *given) {
                    Some((key, _)) => {
                        refuse(key, &format!("an equirectangular camera sees the full sphere and has no {key}"), help)
                    }
                    None => Ok(Projection::Equirectangular),
                }
            }
        }
    }

    fn shift(&self, at: &At, shift: Option<[f64; 2]>) -> Result<[f64; 2]> {
        let shift = shift.unwrap_or_default();
        match shift.iter().position(|part| !(-MAX_SHIFT..=MAX_SHIFT).contains(part)) {
            Some(axis) => {
                let message =
                    format!("a shift is -{MAX_SHIFT} to {MAX_SHIFT} heights of the image, not {}", shift[axis]);
                Err(self.source.mistake_at(&at.index(axis), message, None))
            }
            None => Ok(shift),
        }
    }

    fn lens(&self, at: &At, lens: LensText) -> Result<Lens> {
        let radius = match lens.radius {
            radius if (0.0..=MAX_LENGTH).contains(&radius) => Ok(radius),
            radius => {
                let message = format!("the radius of a lens is a length from 0 to {MAX_LENGTH:e}, not {radius}");
                Err(self.source.mistake_at(&at.key("radius"), message, None))
            }
        };
        let focus = match lens.focus_distance {
            // An infinite distance is one; NaN is none.
            focus if (NEAREST_FOCUS..=f64::INFINITY).contains(&focus) => Ok(focus),
            focus => {
                let message = format!("a focus lies at least {NEAREST_FOCUS:e} away, not {focus}");
                let help = "write inf to see sharply what is far away";
                Err(self.source.mistake_at(&at.key("focus_distance"), message, Some(help.into())))
            }
        };
        let (radius, focus) = (radius, focus).gather()?;
        Ok(Lens::new(radius, focus))
    }
}
