//! The lights that no surface gives.

use std::sync::Arc;

use sha2::Digest;

use super::Scene;
use super::compile::Compiler;
use super::description::{EnvironmentText, LightText, StepText};
use super::image_file::read_image;
use super::source::At;
use crate::error::{Error, Result};
use crate::light::{Environment, Light, Panorama, Point, Sky, Spot, Sun};
use crate::math::{DMat3, DVec3, Transform};
use crate::spectrum::{Curve, CurveKind, ImageText, Placement, Quantity};

impl Compiler<'_> {
    pub(super) fn lights(&mut self, lights: &[LightText], scene: &mut Scene<Curve>) -> Result<()> {
        for (number, text) in lights.iter().enumerate() {
            let top = At::top("light");
            let at = top.index(number);
            if kinds(text).iter().filter(|kind| kind.1).count() != 1 {
                return Err(self.not_one_kind(&at, text));
            }
            let light = self.light(&at, text)?;
            if let (Light::Environment(_), Some(_)) = (&light, scene.environment()) {
                let message = "a scene has at most one environment";
                return Err(self.source.mistake_at(&at.key("environment"), message, None));
            }
            if light.is_sky() {
                scene.skies.push(scene.lights.len());
            }
            scene.lights.push(light);
        }
        Ok(())
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
            self.point(&here.key("position"), point.position)?;
            let intensity = self.curve(&here.key("intensity"), &point.intensity, Quantity::Emission)?;
            return Ok(Light::Point(Point { intensity, ..point.clone() }));
        }
        if let Some(spot) = &text.spot {
            let here = at.key("spot");
            self.point(&here.key("position"), spot.position)?;
            self.direction(&here.key("toward"), spot.toward)?;
            let refuse = |key, message| Err(self.source.mistake_at(&here.key(key), message, None));
            if !(spot.cone_angle > 0.0 && spot.cone_angle <= 180.0) {
                return refuse("cone_angle", format!("a cone is above 0 to 180 degrees wide, not {}", spot.cone_angle));
            }
            if !(0.0..=1.0).contains(&spot.blend) {
                return refuse("blend", format!("blend is a part of the cone, 0 to 1, not {}", spot.blend));
            }
            let intensity = self.curve(&here.key("intensity"), &spot.intensity, Quantity::Emission)?;
            return Ok(Light::Spot(Spot { intensity, ..spot.clone() }));
        }
        let sun = text.sun.as_ref().expect("one kind was counted");
        let here = at.key("sun");
        self.direction(&here.key("toward"), sun.toward)?;
        if !(0.0..=180.0).contains(&sun.angular_diameter) {
            let message = format!("a sun is 0 to 180 degrees across, not {}", sun.angular_diameter);
            return Err(self.source.mistake_at(&here.key("angular_diameter"), message, None));
        }
        let irradiance = self.curve(&here.key("irradiance"), &sun.irradiance, Quantity::Emission)?;
        Ok(Light::Sun(Sun { irradiance, ..sun.clone() }))
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
        self.factor_on_image(&here, &text.radiance)?;
        let radiance = text.radiance.scale.into();
        let place = at.key("transform");
        if let Some(step) = text.transform.iter().position(|step| !matches!(step, StepText::Rotate(_))) {
            let message = "an environment has no place and no size: it can be turned only";
            let help = Some("write { rotate = { axis = [0, 1, 0], degrees = 90 } }".into());
            return Err(self.source.mistake_at(&place.index(step), message, help));
        }
        let turn = self.transform(&place, &text.transform, Transform::IDENTITY)?;
        let rotation = DMat3::from_cols(turn.vector(DVec3::X), turn.vector(DVec3::Y), turn.vector(DVec3::Z));
        let panorama = self.panorama(&here.key("image"), &image.file)?;
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
