//! The scene file, verbatim: what of a [`Description`] is there was well formed, nothing more.

use std::collections::BTreeMap;

use serde::{Deserialize, Deserializer};

use super::description_light::LightText;
use super::description_relief::{BumpMapText, NormalMapText};
use super::description_view::{CameraText, FilmText};
use super::structure::Mistake;
use crate::material::Material;
use crate::spectrum::Curve;

/// A whole scene file, and what is wrong with its words.
#[derive(Clone, Debug)]
pub struct Description {
    /// From where and how the scene is seen; absent if that is missing or wrong.
    pub camera: Option<CameraText>,
    /// The image to make; absent if that is missing or wrong.
    pub film: Option<FilmText>,
    /// How to make it; everything optional.
    pub render: RenderText,
    /// Materials by name, without those that are wrong.
    pub material: BTreeMap<String, Option<Material<Curve>>>,
    /// Surfaces, without those that are wrong.
    pub object: Vec<Option<ObjectText>>,
    /// Light that no surface gives, without what is wrong.
    pub light: Vec<Option<LightText>>,
    /// Whether there are materials of which the name is not known.
    pub(super) nameless: bool,
    pub(super) mistakes: Vec<Mistake>,
}

/// ```toml
/// [render]
/// samples = 256
/// seed = 0
/// ```
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RenderText {
    /// How spectra are carried.
    #[serde(default)]
    pub model: ModelText,
    /// Relative error of the image that is wanted: a third of it is what the model of color may miss.
    pub error: Option<f64>,
    /// Length of a scene unit in meters: needed where a glass brings its own absorption.
    pub meters_per_unit: Option<f64>,
    /// Camera samples per pixel.
    pub samples: Option<u32>,
    /// Chooses another set of random numbers.
    #[serde(default)]
    pub seed: u64,
    /// How often light may leave a diffuse surface for another before it is gathered from the lights; no limit if absent.
    pub diffuse_bounces: Option<u32>,
    /// How often light may leave any surface, glass and mirrors included; no limit if absent.
    pub max_bounces: Option<u32>,
    /// Whether caustics may have a light pass of their own.
    #[serde(default)]
    pub caustics: CausticsText,
}

/// ```toml
/// render.caustics = "auto"     # "off"
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum CausticsText {
    /// Photons, where the scene needs them.
    #[default]
    Auto,
    /// Left to chance.
    Off,
}

/// ```toml
/// render.model = "auto"     # "rgb", { bands = 16 }, "hero"
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ModelText {
    /// The least that the scene needs.
    #[default]
    Auto,
    /// Three bands: red, green, blue.
    Rgb,
    /// As many fixed wavelengths: 8, 12, 16 or 32.
    Bands(u32),
    /// Fixed wavelengths, and some that are drawn and part in dispersive glass.
    Hero,
}

/// ```toml
/// [[object]]
/// shape.sphere = { center = [0, 1, 0], radius = 1 }
/// material = "glass"
/// # transform = [{ scale = 2 }]
/// # bump_map = { image = "dents.png", depth = 0.02 }
/// # instances = [[{ translate = [1, 0, 0] }], [{ translate = [3, 0, 0] }, { scale = [-1, 1, 1] }]]
/// ```
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObjectText {
    /// For messages.
    pub name: Option<String>,
    /// Where the surface is.
    pub shape: ShapeText,
    /// Name of its material.
    pub material: String,
    /// Steps applied to the shape in this order.
    #[serde(default)]
    pub transform: Vec<StepText>,
    /// Further steps for each of many such shapes, after `transform`; one shape if absent.
    pub instances: Option<Vec<Vec<StepText>>>,
    /// An image of directions that bends its normal.
    pub normal_map: Option<NormalMapText>,
    /// An image of heights that bends its normal.
    pub bump_map: Option<BumpMapText>,
}

/// The shapes, each documented where it is implemented, in `shape`.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
#[allow(missing_docs)]
pub enum ShapeText {
    Plane(PlaneText),
    Triangle(TriangleText),
    Sphere(SphereText),
    Disc(DiscText),
    Quad(QuadText),
    Cube(CubeText),
    Mesh(MeshText),
}

/// `plane = { point = [0, 0, 0], normal = [0, 1, 0] }`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs)]
pub struct PlaneText {
    pub point: [f64; 3],
    pub normal: [f64; 3],
}

/// `triangle = { points = [[0, 0, 0], [1, 0, 0], [0, 1, 0]] }`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs)]
pub struct TriangleText {
    pub points: Vec<[f64; 3]>,
}

/// `sphere = { center = [0, 1, 0], radius = 1 }`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs)]
pub struct SphereText {
    pub center: [f64; 3],
    pub radius: f64,
}

/// `disc = { center = [0, 1, 0], normal = [0, 1, 0], radius = 1, u = [1, 0, 0] }`, `u` optional
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs)]
pub struct DiscText {
    pub center: [f64; 3],
    pub normal: [f64; 3],
    pub radius: f64,
    pub u: Option<[f64; 3]>,
}

/// `quad = { center = [0, 4, 0], u = [1, 0, 0], v = [0, 0, 1] }`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs)]
pub struct QuadText {
    pub center: [f64; 3],
    pub u: [f64; 3],
    pub v: [f64; 3],
}

/// `cube = { center = [0, 1, 0], size = 2 }`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs)]
pub struct CubeText {
    pub center: [f64; 3],
    #[serde(deserialize_with = "number_or_three")]
    pub size: [f64; 3],
}

/// `mesh = { file = "cup.ply", smooth = true }`, or in place of the file `points`, `faces`, `normals` and `uv`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs)]
pub struct MeshText {
    pub file: Option<String>,
    pub points: Option<Vec<[f64; 3]>>,
    pub faces: Option<Vec<[u32; 3]>>,
    pub normals: Option<Vec<[f64; 3]>>,
    pub uv: Option<Vec<[f64; 2]>>,
    #[serde(default)]
    pub smooth: bool,
}

/// One step of a transform: `{ scale = 2 }`, `{ rotate = { axis = [0, 1, 0], degrees = 30 } }`, `{ translate = [0, 1, 0] }`.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum StepText {
    /// A factor, or one for each axis.
    #[serde(deserialize_with = "number_or_three")]
    Scale([f64; 3]),
    /// A turn.
    Rotate(RotateText),
    /// A shift.
    Translate([f64; 3]),
}

/// `rotate = { axis = [0, 1, 0], degrees = 30 }`
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
#[allow(missing_docs)]
pub struct RotateText {
    pub axis: [f64; 3],
    pub degrees: f64,
}

/// A number that stands for all three axes, or three numbers.
fn number_or_three<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[f64; 3], D::Error> {
    struct Three;
    impl<'de> serde::de::Visitor<'de> for Three {
        type Value = [f64; 3];
        fn expecting(&self, formatter: &mut std::fmt::Formatter) -> std::fmt::Result {
            formatter.write_str("a number or [x, y, z]")
        }
        fn visit_f64<E>(self, value: f64) -> Result<[f64; 3], E> {
            Ok([value; 3])
        }
        fn visit_i64<E>(self, value: i64) -> Result<[f64; 3], E> {
            Ok([value as f64; 3])
        }
        fn visit_seq<A: serde::de::SeqAccess<'de>>(self, sequence: A) -> Result<[f64; 3], A::Error> {
            Deserialize::deserialize(serde::de::value::SeqAccessDeserializer::new(sequence))
        }
    }
    deserializer.deserialize_any(Three)
}
