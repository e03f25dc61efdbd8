//! The lights that no surface gives.

use std::sync::Arc;

use sha2::Digest;

use super::compile::Compiler;
use super::description::StepText;
use super::description_light::{EnvironmentText, LightText, SpotText};
use super::gather::Gather;
use super::image_file::read_image;
use super::source::At;
use crate::error::{Error, Result};
use crate::light::{Environment, Light, LightId, Panorama, Point, Sky, Spot, Sun};
use crate::math::{DMat3, DVec3, Transform};
use crate::spectrum::{Curve, CurveKind, ImageText, Placement, Quantity};

impl Compiler<'_> {
    /// The lights that are right, and which of them rays see that meet nothing.
    pub(super) fn lights(&mut self, texts: &[Option<LightText>]) -> (Vec<Light<Curve>>, Vec<LightId>) {
        let (mut lights, mut skies, mut environments) = (Vec::new(), Vec::new(), 0);
        for (number, text) in texts.iter().enumerate() {
            let Some(text) = text else { continue };
            let top = At::top("light");
            let at = top.index(number);
            environments += usize::from(text.environment.is_some());
            let light = match kinds(text).iter().filter(|kind| kind.1).count() {
                1 if text.environment.is_some() && environments > 1 => {
                    let message = "a scene has at most one environment";
                    Err(self.source.mistake_at(&at.key("environment"), message, None))
                }
                1 => self.light(&at, text),
                _ => Err(self.not_one_kind(&at, text)),
            };
            if let Some(light) = self.kept(light) {
                skies.extend(light.is_sky().then_some(lights.len()));
                lights.push(light);
            }
        }
        (lights, skies)
    }

    fn not_one_kind(&self, at: &At, text: &LightText) -> Error {
        let kinds = kinds(text);
        let given = kinds.iter().filter(|kind| kind.1).map(|(kind, _)| at.key(kind));
        let (message, place, help) = match given.max_by_key(|place| self.source.span(place).start) {
            None => (
                "a light needs a kind: `environment`, `point`, `spot` or `sun`",
                *at,
                "such as environment = { radiance = 1 }",
            ),
            Some(last) => ("a light has exactly one kind", last, "start another [[light]] for the second"),
        };
        self.source.mistake_at(&place, message, Some(help.into()))
    }

    /// The only kind of light that an entry has.
    fn light(&mut self, at: &At, text: &LightText) -> Result<Light<Curve>> {
        if let Some(environment) = &text.environment {
            return Ok(Light::Environment(self.environment(&at.key("environment"), environment)?));
        }
        if let Some(point) = &text.point {
            let here = at.key("point");
            let position = self.point(&here.key("position"), point.position);
            let intensity = self.curve(&here.key("intensity"), &point.intensity, Quantity::Emission);
            let (_, intensity) = (position, intensity).gather()?;
            return Ok(Light::Point(Point { intensity, ..point.clone() }));
        }
        if let Some(spot) = &text.spot {
            return Ok(Light::Spot(self.spot(&at.key("spot"), spot)?));
        }
        let sun = text.sun.as_ref().expect("one kind was counted");
        let here = at.key("sun");
        let toward = self.direction(&here.key("toward"), sun.toward);
        let across = match sun.angular_diameter {
            degrees if (0.0..=180.0).contains(&degrees) => Ok(()),
            degrees => {
                let message = format!("a sun is 0 to 180 degrees across, not {degrees}");
                Err(self.source.mistake_at(&here.key("angular_diameter"), message, None))
            }
        };
        let irradiance = self.curve(&here.key("irradiance"), &sun.irradiance, Quantity::Emission);
        let (_, _, irradiance) = (toward, across, irradiance).gather()?;
        Ok(Light::Sun(Sun { irradiance, ..sun.clone() }))
    }

    fn spot(&mut self, at: &At, text: &SpotText) -> Result<Spot<Curve>> {
        let SpotText { position, cone_angle, blend, .. } = *text;
        let refuse = |key, message| Err(self.source.mistake_at(&at.key(key), message, None));
        let cone = match cone_angle {
            degrees if degrees > 0.0 && degrees <= 180.0 => Ok(()),
            degrees => refuse("cone_angle", format!("a cone is above 0 to 180 degrees wide, not {degrees}")),
        };
        let fading = match blend {
            part if (0.0..=1.0).contains(&part) => Ok(()),
            part => refuse("blend", format!("blend is a part of the cone, 0 to 1, not {part}")),
        };
        let toward = self.aim(at, text);
        let intensity = self.curve(&at.key("intensity"), &text.intensity, Quantity::Emission);
        let (_, _, toward, intensity) = (cone, fading, toward, intensity).gather()?;
        Ok(Spot { position, toward, cone_angle, blend, intensity })
    }

    /// The direction of a light that stands somewhere, given as such or by a point to look at.
    fn aim(&self, at: &At, text: &SpotText) -> Result<[f64; 3]> {
        let position = self.point(&at.key("position"), text.position);
        let refuse =
            |place: &At, message: &str, help: &str| Err(self.source.mistake_at(place, message, Some(help.into())));
        let toward = match (text.toward, text.look_at) {
            (Some(toward), None) => self.direction(&at.key("toward"), toward).map(|_| toward),
            (None, Some(target)) => {
                let target = self.point(&at.key("look_at"), target);
                let (position, target) = (position, target).gather()?;
                return match (target - position).try_normalize() {
                    Some(toward) => Ok(toward.to_array()),
                    None => refuse(
                        &at.key("look_at"),
                        "the spot looks at the very point where it stands",
                        "name another point",
                    ),
                };
            }
            (None, None) => {
                let help = "toward = [0, -1, 0] is a direction, look_at = [0, 0, 0] a point";
                refuse(at, "`toward` or `look_at` is missing", help)
            }
            (Some(_), Some(_)) => {
                let keys = ["toward", "look_at"];
                let later = keys.into_iter().max_by_key(|key| self.source.span(&at.key(key)).start).unwrap_or_default();
                let help = "`toward` is a direction, `look_at` a point: leave one of them out";
                refuse(&at.key(later), "a spot has `toward` or `look_at`, not both", help)
            }
        };
        (position, toward).gather().map(|(_, toward)| toward)
    }

    fn environment(&mut self, at: &At, text: &EnvironmentText) -> Result<Environment<Curve>> {
        let here = at.key("radiance");
        let CurveKind::Image(image) = &text.radiance.kind else {
            if !text.transform.is_empty() {
                let message = "an even environment looks the same after every turn";
                return Err(self.source.mistake_at(&at.key("transform"), message, Some("leave it out".into())));
            }
            return Ok(Environment { radiance: self.curve(&here, &text.radiance, Quantity::Emission)?, image: None });
        };
        if *image
            != (ImageText { file: image.file.clone(), encoding: None, channel: None, placement: Placement::default() })
        {
            let message =
                "the image of an environment fills all directions once, in linear light: only its `scale` is free";
            return Err(self.source.mistake_at(&here, message, None));
        }
        let factor = self.factor_on_image(&here, &text.radiance);
        let radiance = text.radiance.scale.into();
        let place = at.key("transform");
        let turn = match text.transform.iter().position(|step| !matches!(step, StepText::Rotate(_))) {
            Some(step) => {
                let message = "an environment has no place and no size: it can be turned only";
                let help = Some("write { rotate = { axis = [0, 1, 0], degrees = 90 } }".into());
                Err(self.source.mistake_at(&place.index(step), message, help))
            }
            None => self.transform(&place, &text.transform, Transform::IDENTITY),
        };
        let panorama = self.panorama(&here.key("image"), &image.file);
        let (_, turn, panorama) = (factor, turn, panorama).gather()?;
        let rotation = DMat3::from_cols(turn.vector(DVec3::X), turn.vector(DVec3::Y), turn.vector(DVec3::Z));
        Ok(Environment { radiance, image: Some(Sky::new(panorama, rotation)) })
    }

    fn panorama(&mut self, at: &At, file: &str) -> Result<Panorama> {
        let bytes = self.bytes_of_image(at, file)?;
        let image = read_image(std::path::Path::new(file), &bytes);
        let image = image.map_err(|(message, help)| self.source.mistake_at(at, message, help))?;
        self.hash.update(&bytes);
        let (width, height) = (image.width(), image.height());
        if width != 2 * height {
            let size = format!("{width} x {height}");
            self.warnings.push(format!("{at}: {file} is {size}; an image of all directions is twice as wide as high"));
        }
        Ok(Panorama::new(Arc::new(image)))
    }
}

/// The kinds a light may have, and which of them are given.
fn kinds(text: &LightText) -> [(&'static str, bool); 4] {
    let LightText { environment, point, spot, sun, .. } = text;
    [
        ("environment", environment.is_some()),
        ("point", point.is_some()),
        ("spot", spot.is_some()),
        ("sun", sun.is_some()),
    ]
}
