//! What a file may hold beside red, green, blue, coverage and depth.

use serde::{Deserialize, Serialize};

use crate::error::nearest;

/// A layer, or several of one kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Layer {
    /// Light straight from surfaces that shine: `L E` in Heckbert's notation.
    Emission,
    /// Light straight from the sky or the sun.
    Background,
    /// Light that was scattered once, by whatever surface: `L (S|D) E`.
    Direct,
    /// Light that was scattered more often.
    Indirect,
    /// Direct light that the first surface reflects diffusely.
    DiffuseDirect,
    /// Direct light that it reflects glossily: rough metal, the coat of rough plastic.
    GlossyDirect,
    /// What it mirrors.
    SpecularDirect,
    /// What comes through it.
    TransmissionDirect,
    /// Of the indirect light, what the first surface reflects diffusely.
    DiffuseIndirect,
    /// What it reflects glossily.
    GlossyIndirect,
    /// What it mirrors.
    SpecularIndirect,
    /// What comes through it.
    TransmissionIndirect,
    /// Light that photons found; it is part of the indirect light.
    Caustics,
    /// Light whose wavelengths parted on their way.
    Dispersed,
    /// One layer for each light, or group of lights. Together they are the image.
    Lights,
    /// The share of light that the first surface sends back, 0 to 1.
    Albedo,
    /// The unit normal by which the first surface scatters, on the camera's side, in the world's axes.
    Normal,
    /// The unit normal of the surface's own shape.
    GeometricNormal,
    /// The point of the first surface in the world, of the nearest sample.
    Position,
    /// Where images lie on it, of the nearest sample.
    Uv,
    /// Variance of the pixel's mean.
    Variance,
    /// Camera samples.
    Samples,
    /// The image of the first half of the samples, which is the larger one of an odd number.
    HalfA,
    /// The image of the second half.
    HalfB,
    /// The energy audit: of weight 1 that left the camera, what has not ended at a light, in the sky or absorbed.
    Residual,
    /// The share of the light on shadow catchers that other objects block.
    Shadow,
    /// A matte of each object that the camera sees, by Cryptomatte.
    CryptoObject,
    /// A matte of each material.
    CryptoMaterial,
    /// A matte of all instances of an object together.
    CryptoAsset,
    /// How much of the light is polarized along the image's rows more than along its columns: the second component of
    /// the Stokes vector, of which the image is the first.
    S1,
    /// How much of the light is polarized along the diagonal from the lower left to the upper right more than across
    /// it.
    S2,
    /// How much more of the light is circularly polarized to the right than to the left, seen toward the scene.
    S3,
    /// The degree of polarization, that of linear polarization, and the angle of the latter: see [`polarization`].
    Polarization,
}

impl Layer {
    /// The word that asks for all of them.
    pub const ALL: &str = "all";

    /// All of them by the names that ask for them.
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

    /// The components of the Stokes vector beside the image.
    pub const STOKES: [Self; 3] = [Self::S1, Self::S2, Self::S3];

    /// Every one that does not ask for light to be followed in another way.
    pub fn all() -> Vec<Self> {
        let all = Self::NAMES.iter().map(|(_, layer)| *layer);
        all.filter(|layer| !layer.is_of_polarization()).collect()
    }

    /// Whether it asks for polarization to be traced.
    pub fn is_of_polarization(self) -> bool {
        self == Self::Polarization || Self::STOKES.contains(&self)
    }

    /// Those that some names ask for, of which one may be the word for all.
    ///
    /// # Errors
    /// If there are no such layers: all of these, each with the name that was most likely meant.
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

    /// The name that asks for it, and that the file has unless there are several.
    pub fn name(self) -> &'static str {
        Self::NAMES.into_iter().find(|(_, layer)| *layer == self).map_or("", |(name, _)| name)
    }

    /// The names of its channels.
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

    /// Whether 16 bits are enough where the file has them: for light, and for numbers up to 1.
    pub fn may_be_half(self) -> bool {
        let exact = matches!(self, Self::Position | Self::Uv | Self::Variance | Self::Samples | Self::Residual);
        !exact && !self.is_matte() && !self.is_of_polarization()
    }

    /// Whether it is light to look at: what is computed with, such as an albedo or a half of the samples, is none.
    pub fn is_color(self) -> bool {
        self == Self::Shadow || self.is_light() && !Self::STOKES.contains(&self)
    }

    /// Whether its numbers are colors of the film's space: not where they are shares, squares or differences.
    pub fn has_color_space(self) -> bool {
        let is_color = self.is_color() && self != Self::Shadow;
        is_color || matches!(self, Self::Albedo | Self::HalfA | Self::HalfB)
    }

    /// Whether it holds what one lobe of the first surface sends to the camera.
    pub fn is_of_lobe(self) -> bool {
        use Layer::{DiffuseDirect, GlossyDirect, SpecularDirect, TransmissionDirect};
        use Layer::{DiffuseIndirect, GlossyIndirect, SpecularIndirect, TransmissionIndirect};
        matches!(self, DiffuseDirect | GlossyDirect | SpecularDirect | TransmissionDirect)
            || matches!(self, DiffuseIndirect | GlossyIndirect | SpecularIndirect | TransmissionIndirect)
    }

    /// Whether it holds light, which is filtered as the image is.
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

    /// Whether it is a matte.
    pub fn is_matte(self) -> bool {
        matches!(self, Self::CryptoObject | Self::CryptoMaterial | Self::CryptoAsset)
    }
}

/// What to ask for in place of a layer that other renderers have by this name.
pub fn layer_elsewhere(name: &str) -> Option<&'static str> {
    match name.to_lowercase().as_str() {
        "z" | "depth" | "mist" => Some("leave it out: Z is in every file"),
        "beauty" | "rgb" | "rgba" | "r" | "g" | "b" | "a" | "alpha" => {
            Some("leave it out: the image and its A are in every file")
        }
        "normal" | "normals" | "denoising normal" => Some("normals are in N"),
        "diffuse_color" | "diffcol" | "base_color" | "denoising albedo" => Some("colors of surfaces are in albedo"),
        "position" | "positions" => Some("places are in P"),
        "luminance" => Some("the image has it: it is Y of its colors, in cd/m2 of absolute light"),
        "illuminance" | "irradiance" => Some("it is pi times what a white matte surface shows"),
        light if light.starts_with("light_") => Some("ask for lights: it brings one such layer for each light"),
        "crypto" | "cryptomatte" => Some("ask for CryptoObject, CryptoMaterial or CryptoAsset"),
        _ => None,
    }
}

/// The message on names that no layer has, at least one.
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
    let told = |(name, meant): (&&str, &Option<String>)| match meant {
        Some(meant) => format!("`{name}` ({meant})"),
        None => format!("`{name}`"),
    };
    let told = unknown.iter().zip(&meant).map(told).collect::<Vec<_>>().join(", ");
    let list = if meant.contains(&None) { format!("; known are {}", list()) } else { String::new() };
    format!("there are no layers {told}{list}")
}

/// The degree of polarization of light, the degree of its linear polarization, both 0 to 1, and the angle of the latter
/// from the image's right counterclockwise, above -90 to 90 degrees, by the luminances S0 to S3 of its Stokes vector;
/// 0 of no light.
///
/// sqrt(S1^2 + S2^2 + S3^2) / S0, sqrt(S1^2 + S2^2) / S0 and atan2(S2, S1) / 2 (Hecht 2017, *Optics*, section 8.13.1).
pub fn polarization([s0, s1, s2, s3]: [f64; 4]) -> [f64; 3] {
    if s0 <= 0.0 {
        return [0.0; 3];
    }
    let linear = libm::hypot(s1, s2);
    let angle = 0.5 * libm::atan2(s2, s1).to_degrees();
    // What lies along the columns is so whichever way S2 was rounded.
    let angle = if angle <= -90.0 { 90.0 } else { angle };
    [(libm::hypot(linear, s3) / s0).min(1.0), (linear / s0).min(1.0), angle]
}

/// Which surface is the first.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum FirstSurface {
    /// The one that the camera ray meets.
    #[default]
    Met,
    /// The one that is seen, in mirrors and through smooth glass as well.
    Visible,
}

impl FirstSurface {
    /// Both by their names in a scene file.
    pub const NAMES: [(&str, Self); 2] = [("met", Self::Met), ("visible", Self::Visible)];
}

/// A layer of a finished image.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LayerImage {
    /// What it is.
    pub layer: Layer,
    /// Its name in the file.
    pub name: String,
    /// The numbers of all channels of a pixel, pixel by pixel.
    pub values: Vec<f32>,
}

impl LayerImage {
    /// Numbers of a pixel.
    pub fn numbers(&self) -> usize {
        self.layer.channels().len()
    }

    /// One of its channels, row by row from the top left.
    pub fn channel(&self, number: usize) -> impl ExactSizeIterator<Item = f32> + '_ {
        self.values.iter().skip(number).step_by(self.numbers()).copied()
    }
}

/// Longest name of a channel that every reader keeps.
pub const LONGEST_NAME: usize = 31;

/// The name of a light's layer: `light_` and its name, in which other characters than letters and digits become `_`.
pub fn light_layer_name(name: &str) -> String {
    let plain = |letter: char| if letter.is_ascii_alphanumeric() { letter } else { '_' };
    format!("light_{}", name.chars().map(plain).collect::<String>())
}
