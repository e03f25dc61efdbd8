//! Camera and film as they stand in the scene file.

use serde::Deserialize;

use crate::film::Filter;
use crate::spectrum::ColorSpace;

/// ```toml
/// [camera]
/// position = [0, 1.2, 6]
/// look_at = [0, 1, 0]
/// vertical_fov = 35          # degrees
/// lens = { radius = 0.02, focus_distance = 6 }
/// shift = [0, 0.2]           # of the image's height
/// ```
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CameraText {
    /// Where the camera is.
    pub position: [f64; 3],
    /// The point in the middle of the image, but for the shift.
    pub look_at: [f64; 3],
    /// The direction that is up in the image.
    #[serde(default = "up")]
    pub up: [f64; 3],
    /// How directions become places in the image.
    #[serde(default)]
    pub projection: ProjectionText,
    /// Full angle from the bottom to the top of the image, in degrees: perspective alone.
    pub vertical_fov: Option<f64>,
    /// Height of the view in scene units: orthographic alone.
    pub height: Option<f64>,
    /// How far the window onto the world is moved to the right and up, in heights of the image.
    pub shift: Option<[f64; 2]>,
    /// A lens with an extent; without it everything is sharp.
    pub lens: Option<LensText>,
    /// Rays start at this distance along the viewing direction, or along themselves in an equirectangular image.
    #[serde(default)]
    pub near: f64,
}

/// ```toml
/// camera.projection = "orthographic"
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ProjectionText {
    /// Rays from one point through a window.
    #[default]
    Perspective,
    /// Parallel rays.
    Orthographic,
    /// Rays of the full sphere, by longitude and latitude.
    Equirectangular,
}

/// `lens = { radius = 0.02, focus_distance = 6 }`
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LensText {
    /// Radius of the opening in scene units; 0 is a pinhole.
    pub radius: f64,
    /// Distance along the viewing direction at which points are sharp; `inf` for those infinitely far away.
    pub focus_distance: f64,
}

fn up() -> [f64; 3] {
    [0.0, 1.0, 0.0]
}

/// ```toml
/// [film]
/// width = 960
/// height = 540
/// crop = [100, 50, 320, 180]         # left, top, width, height in pixels
/// ```
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FilmText {
    /// Pixels per row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Where in its pixel a sample falls.
    #[serde(default)]
    pub filter: Filter,
    /// What the numbers of the file mean.
    #[serde(default)]
    pub color_space: ColorSpace,
    /// The only part to render: first column, first row from the top, width and height.
    pub crop: Option<[u32; 4]>,
}
