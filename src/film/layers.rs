//! Layers: what a file may hold besides red, green, blue, coverage and depth.

use serde::{Deserialize, Serialize};

use crate::error::nearest;

/// A layer, or several of one kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[non_exhaustive]
pub enum Layer {
    /// Light that reaches the camera straight from emitting surfaces: `L E` in Heckbert's notation.
    Emission,
    /// Light that reaches the camera straight from the sky or the sun.
    Background,
    /// Light that was scattered once, by any kind of surface: `L (S|D) E`.
    Direct,
    /// Light that was scattered more than once.
    Indirect,
    /// Direct light that the first surface reflects diffusely.
    DiffuseDirect,
    /// Direct light that the first surface reflects glossily: rough metal, the coat of rough plastic.
    GlossyDirect,
    /// Direct light that the first surface reflects specularly.
    SpecularDirect,
    /// Direct light that the first surface transmits.
    TransmissionDirect,
    /// Indirect light that the first surface reflects diffusely.
    DiffuseIndirect,
    /// Indirect light that the first surface reflects glossily.
    GlossyIndirect,
    /// Indirect light that the first surface reflects specularly.
    SpecularIndirect,
    /// Indirect light that the first surface transmits.
    TransmissionIndirect,
    /// Light found by photons. It is part of the indirect light.
    Caustics,
    /// Light whose wavelengths parted on their way.
    Dispersed,
    /// One layer for each light or group of lights. Together they add up to the image.
    Lights,
    /// The albedo of the first surface: the fraction of light that it sends back, 0 to 1.
    Albedo,
    /// The unit shading normal of the first surface, on the camera's side, in world space.
    Normal,
    /// The unit geometric normal of the first surface.
    GeometricNormal,
    /// The world-space position on the first surface, of the nearest sample.
    Position,
    /// The texture coordinates on the first surface, of the nearest sample.
    Uv,
    /// The variance of the pixel's mean.
    Variance,
    /// The number of camera samples.
    Samples,
    /// The image of the first half of the samples, which is the larger half if their number is odd.
    HalfA,
    /// The image of the second half of the samples.
    HalfB,
    /// The energy audit: of the weight 1 that leaves the camera, the part not ended by a light, the sky or absorption.
    Residual,
    /// The fraction of the light on shadow catchers that other objects block.
    Shadow,
    /// A matte for each object that the camera sees, by Cryptomatte.
    CryptoObject,
    /// A matte for each material.
    CryptoMaterial,
    /// A matte for all instances of an object together.
    CryptoAsset,
    /// The second component of the Stokes vector, whose first component is the image: how much more of the light is
    /// polarized along the image's rows than along its columns.
    S1,
    /// The third component of the Stokes vector: how much more of the light is polarized along the diagonal from the
    /// lower left to the upper right than along the other one.
    S2,
    /// The fourth component of the Stokes vector: how much more of the light is circularly polarized to the right than
    /// to the left, seen toward the scene.
    S3,
    /// The degrees of polarization and of linear polarization, and the angle of the latter: see [`polarization`].
    Polarization,
}

impl Layer {
    /// The name that requests all layers.
    pub const ALL: &str = "all";

    /// All layers by the names that request them.
    pub const NAMES: [(&str, Self); 33] = [
        ("emission", Self::Emission),
        ("background", Self::Background),
        ("direct", Self::Direct),
        ("indirect", Self::Indirect),
        ("diffuse_direct", Self::DiffuseDirect),
        ("glossy_direct", Self::GlossyDirect),
        ("specular_direct", Self::SpecularDirect),
        ("transmission_direct", Self::TransmissionDirect),
        ("diffuse_indirect", Self::DiffuseIndirect),
        ("glossy_indirect", Self::GlossyIndirect),
        ("specular_indirect", Self::SpecularIndirect),
        ("transmission_indirect", Self::TransmissionIndirect),
        ("caustics", Self::Caustics),
        ("dispersed", Self::Dispersed),
        ("lights", Self::Lights),
        ("albedo", Self::Albedo),
        ("N", Self::Normal),
        ("Nd", Self::GeometricNormal),
        ("P", Self::Position),
        ("UV", Self::Uv),
        ("variance", Self::Variance),
        ("samples", Self::Samples),
        ("half_a", Self::HalfA),
        ("half_b", Self::HalfB),
        ("residual", Self::Residual),
        ("shadow", Self::Shadow),
        ("CryptoObject", Self::CryptoObject),
        ("CryptoMaterial", Self::CryptoMaterial),
        ("CryptoAsset", Self::CryptoAsset),
        ("S1", Self::S1),
        ("S2", Self::S2),
        ("S3", Self::S3),
        ("polarization", Self::Polarization),
    ];

    /// The components of the Stokes vector besides the image.
    pub const STOKES: [Self; 3] = [Self::S1, Self::S2, Self::S3];

    /// Returns all layers except those of polarization, which change how light is traced.
    pub fn all() -> Vec<Self> {
        let all = Self::NAMES.iter().map(|(_, layer)| *layer);
        all.filter(|layer| !layer.is_of_polarization()).collect()
    }

    /// Returns whether the layer requires tracing polarization.
    pub fn is_of_polarization(self) -> bool {
        self == Self::Polarization || Self::STOKES.contains(&self)
    }

    /// Returns the layers with the given names. One of the names may be [`Self::ALL`].
    ///
    /// # Errors
    /// If some names are unknown. The message lists all of these, each with the name that was most likely meant.
    pub fn of_names<'a>(names: impl Iterator<Item = &'a str>) -> Result<Vec<Self>, String> {
        let (mut layers, mut unknown) = (Vec::new(), Vec::new());
        for name in names {
            match Self::NAMES.iter().find(|(known, _)| *known == name) {
                Some((_, layer)) => layers.push(*layer),
                None if name == Self::ALL => layers.extend(Self::all()),
                None => unknown.push(name),
            }
        }
        if unknown.is_empty() { Ok(layers) } else { Err(unknown_layers(&unknown)) }
    }

    /// Returns the name that requests the layer. The file uses it too, unless one request makes several layers.
    pub fn name(self) -> &'static str {
        Self::NAMES.into_iter().find(|(_, layer)| *layer == self).map_or("", |(name, _)| name)
    }

    /// Returns the names of the channels.
    pub fn channels(self) -> &'static [&'static str] {
        match self {
            Self::Normal | Self::GeometricNormal | Self::Position => &["X", "Y", "Z"],
            Self::Uv => &["U", "V"],
            Self::Samples => &["V"],
            Self::CryptoObject | Self::CryptoMaterial | Self::CryptoAsset => &["r", "g", "b", "a"],
            Self::Polarization => &["degree", "linear_degree", "angle"],
            _ => &["R", "G", "B"],
        }
    }

    /// Returns whether 16 bits suffice if the file uses them, as they do for light and for values up to 1.
    pub fn may_be_half(self) -> bool {
        let is_exact = matches!(self, Self::Position | Self::Uv | Self::Variance | Self::Samples | Self::Residual);
        !is_exact && !self.is_matte() && !self.is_of_polarization()
    }

    /// Returns whether the layer is meant for viewing. Data for computation, such as an albedo or a half image, is not.
    pub fn is_color(self) -> bool {
        self == Self::Shadow || self.is_light() && !Self::STOKES.contains(&self)
    }

    /// Returns whether the values are colors in the film's color space, not fractions, squares or differences.
    pub fn has_color_space(self) -> bool {
        let is_color = self.is_color() && self != Self::Shadow;
        is_color || matches!(self, Self::Albedo | Self::HalfA | Self::HalfB)
    }

    /// Returns whether the layer holds what one lobe of the first surface sends to the camera.
    pub fn is_of_lobe(self) -> bool {
        use Layer::{DiffuseDirect, GlossyDirect, SpecularDirect, TransmissionDirect};
        use Layer::{DiffuseIndirect, GlossyIndirect, SpecularIndirect, TransmissionIndirect};
        matches!(self, DiffuseDirect | GlossyDirect | SpecularDirect | TransmissionDirect)
            || matches!(self, DiffuseIndirect | GlossyIndirect | SpecularIndirect | TransmissionIndirect)
    }

    /// Returns whether the layer holds light, and so is filtered like the image.
    pub fn is_light(self) -> bool {
        match self {
            Self::Emission | Self::Background | Self::Direct | Self::Indirect => true,
            Self::DiffuseDirect | Self::GlossyDirect | Self::SpecularDirect | Self::TransmissionDirect => true,
            Self::DiffuseIndirect | Self::GlossyIndirect | Self::SpecularIndirect | Self::TransmissionIndirect => true,
            Self::Caustics | Self::Dispersed | Self::Lights | Self::S1 | Self::S2 | Self::S3 => true,
            Self::Albedo | Self::Normal | Self::GeometricNormal | Self::Position | Self::Uv | Self::Shadow => false,
            Self::Variance | Self::Samples | Self::HalfA | Self::HalfB | Self::Residual => false,
            Self::Polarization | Self::CryptoObject | Self::CryptoMaterial | Self::CryptoAsset => false,
        }
    }

    /// Returns whether the layer is a matte.
    pub fn is_matte(self) -> bool {
        matches!(self, Self::CryptoObject | Self::CryptoMaterial | Self::CryptoAsset)
    }
}

/// Returns what to request in place of a layer that other renderers call `name`.
pub fn layer_elsewhere(name: &str) -> Option<&'static str> {
    match name.to_lowercase().as_str() {
        "z" | "depth" | "mist" => Some("leave it out: Z is in every file"),
        "beauty" | "rgb" | "rgba" | "r" | "g" | "b" | "a" | "alpha" => {
            Some("leave it out: the image and its A are in every file")
        }
        "normal" | "normals" | "denoising normal" => Some("normals are in N"),
        "diffuse_color" | "diffcol" | "base_color" | "denoising albedo" => Some("colors of surfaces are in albedo"),
        "position" | "positions" => Some("positions are in P"),
        "luminance" => Some("the image has it: the Y of its colors, in cd/m2 if the light is absolute"),
        "illuminance" | "irradiance" => Some("it is pi times what a white matte surface shows"),
        light if light.starts_with("light_") => Some("ask for lights: it writes one such layer for each light"),
        "crypto" | "cryptomatte" => Some("ask for CryptoObject, CryptoMaterial or CryptoAsset"),
        _ => None,
    }
}

/// Returns the error message for one or more unknown names.
fn unknown_layers(unknown: &[&str]) -> String {
    let known = || Layer::NAMES.iter().map(|(known, _)| *known).chain([Layer::ALL]);
    let list = || known().collect::<Vec<_>>().join(", ");
    let near = |name: &str| nearest(name, known()).map(|near| format!("did you mean {near}?"));
    if let [name] = unknown {
        return match (layer_elsewhere(name), near(name)) {
            (Some(help), _) => format!("there is no layer `{name}` ({help})"),
            (None, Some(near)) => format!("there is no layer `{name}`: {near}"),
            (None, None) => format!("there is no layer `{name}`: known are {}", list()),
        };
    }
    let meant = |name: &&str| layer_elsewhere(name).map(str::to_owned).or_else(|| near(name));
    let meant: Vec<Option<String>> = unknown.iter().map(meant).collect();
    let described = |(name, meant): (&&str, &Option<String>)| match meant {
        Some(meant) => format!("`{name}` ({meant})"),
        None => format!("`{name}`"),
    };
    let described = unknown.iter().zip(&meant).map(described).collect::<Vec<_>>().join(", ");
    let list = if meant.contains(&None) { format!("; known are {}", list()) } else { String::new() };
    format!("there are no layers {described}{list}")
}

/// Returns the degree of polarization, the degree of linear polarization, both 0 to 1, and the angle of linear
/// polarization. Takes the luminances S0 to S3 of the Stokes vector. The angle is measured from the image's right
/// counterclockwise, above -90 to 90 degrees. All three are 0 if there is no light.
///
/// sqrt(S1^2 + S2^2 + S3^2) / S0, sqrt(S1^2 + S2^2) / S0 and atan2(S2, S1) / 2 (Hecht 2017, *Optics*, section 8.13.1).
pub fn polarization([s0, s1, s2, s3]: [f64; 4]) -> [f64; 3] {
    if s0 <= 0.0 {
        return [0.0; 3];
    }
    let linear = libm::hypot(s1, s2);
    let angle = 0.5 * libm::atan2(s2, s1).to_degrees();
    // Polarization along the columns gives 90 degrees, however S2 was rounded.
    let angle = if angle <= -90.0 { 90.0 } else { angle };
    [(libm::hypot(linear, s3) / s0).min(1.0), (linear / s0).min(1.0), angle]
}

/// Which surface counts as the first one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum FirstSurface {
    /// The surface that the camera ray hits.
    #[default]
    Met,
    /// The surface that is seen, also in mirrors and through smooth glass.
    Visible,
}

impl FirstSurface {
    /// Both variants by their names in a scene file.
    pub const NAMES: [(&str, Self); 2] = [("met", Self::Met), ("visible", Self::Visible)];
}

/// A layer of a finished image.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LayerImage {
    /// The kind of layer.
    pub layer: Layer,
    /// The name in the file.
    pub name: String,
    /// The values of all channels, pixel by pixel.
    pub values: Vec<f32>,
}

impl LayerImage {
    /// Returns the number of values per pixel.
    pub fn numbers(&self) -> usize {
        self.layer.channels().len()
    }

    /// Returns one channel, row by row from the top left.
    pub fn channel(&self, number: usize) -> impl ExactSizeIterator<Item = f32> + '_ {
        self.values.iter().skip(number).step_by(self.numbers()).copied()
    }
}

/// The longest channel name that every reader preserves.
pub const MAX_NAME_BYTES: usize = 31;

/// Returns the name of a light's layer: `light_` and the light's name, in which `_` replaces all characters except
/// letters and digits.
pub fn light_layer_name(name: &str) -> String {
    let plain = |letter: char| if letter.is_ascii_alphanumeric() { letter } else { '_' };
    format!("light_{}", name.chars().map(plain).collect::<String>())
}
