//! Lights as they stand in the scene file.

use serde::Deserialize;

use super::description::StepText;
use crate::light::{Point, Sun};
use crate::spectrum::Curve;

/// ```toml
/// [[light]]
/// environment = { radiance = 1 }
/// ```
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LightText {
    /// For messages.
    pub name: Option<String>,
    /// What rays meet that miss everything.
    pub environment: Option<EnvironmentText>,
    /// A point that shines.
    pub point: Option<Point<Curve>>,
    /// A point that shines into a cone.
    pub spot: Option<SpotText>,
    /// A disc in the sky.
    pub sun: Option<Sun<Curve>>,
}

/// ```toml
/// [[light]]
/// environment = { radiance = { image = "sky.exr" }, transform = [{ rotate = { axis = [0, 1, 0], degrees = 90 } }] }
/// ```
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EnvironmentText {
    /// What rays show that miss everything.
    pub radiance: Curve,
    /// Turns of an image.
    #[serde(default)]
    pub transform: Vec<StepText>,
}

/// ```toml
/// [[light]]
/// spot = { position = [0, 3, 0], look_at = [0, 0, 0], cone_angle = 40, intensity = 10 }     # or toward = [0, -1, 0]
/// ```
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SpotText {
    /// Where it is.
    pub position: [f64; 3],
    /// The direction in the middle of the cone, of any length.
    pub toward: Option<[f64; 3]>,
    /// The point in the middle of the cone, in place of the direction.
    pub look_at: Option<[f64; 3]>,
    /// Full angle of the cone, in degrees, above 0 to 180.
    pub cone_angle: f64,
    /// The outer part of the cone's half angle over which the light fades, 0 to 1.
    #[serde(default = "soft")]
    pub blend: f64,
    /// Radiance times area in the middle, in scene units.
    pub intensity: Curve,
}

fn soft() -> f64 {
    0.15
}
