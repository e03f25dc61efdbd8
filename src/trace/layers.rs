//! The layers that are requested besides the image, and where their sums are stored.

use std::collections::HashMap;

use super::contribution::{Contribution, FoundBy, add};
use super::first_lobe::FirstLobe;
use super::spectrum_sample::Spectrum;
use super::white::White;
use crate::film::{FirstSurface, Layer, Manifest, id, light_layer_name};
use crate::scene::Scene;
use crate::spectrum::{Basis, Curve, apply};

/// The layers of a world's image.
///
/// Each pixel, each camera sample and the splatted photons of each pixel have a row of numbers: three sums for a layer
/// of light, and so on, in the order of the layers.
#[derive(Clone, Debug, Default)]
pub(super) struct Layers {
    /// The requested layers, in the order of the request.
    pub(super) requested: Vec<Layer>,
    /// For each layer that exists, where its numbers begin, if it is requested.
    offsets: Vec<Option<usize>>,
    /// Length of a row.
    pub(super) row_len: usize,
    /// The group of each light, and the names of the groups' layers.
    group_of: Vec<usize>,
    pub(super) groups: Vec<String>,
    /// Which surface counts as the first.
    pub(super) first: FirstSurface,
    /// The IDs by which mattes tell objects apart: for each requested matte, an ID for each object.
    pub(super) ids: Vec<(Layer, Vec<u32>)>,
    /// Where the numbers of shadow catchers begin, if there are any: see [`CatcherLight`].
    catcher_offset: Option<usize>,
    /// The bands of a spectral image, if one is requested.
    pub(super) spectrum: Option<Spectrum>,
    /// Whether light is separated by the lobe of the first surface.
    pub(super) separates_lobes: bool,
    /// A light of radiance 1, used to measure albedo, lobes and residual.
    pub(super) white: Option<White>,
    /// The luminance of unit red, green and blue.
    luminance: [f64; 3],
    /// The color of the film's white: the largest possible albedo.
    pub(super) film_white: [f64; 3],
}

/// Returns the name of each object in a matte.
fn names<S>(scene: &Scene<S>, matte: Layer) -> impl Iterator<Item = &str> {
    scene.objects.iter().map(move |object| match matte {
        Layer::CryptoMaterial => scene.materials[object.material as usize].name.as_str(),
        Layer::CryptoAsset => &object.asset,
        _ => &object.name,
    })
}

/// Light that a pixel's shadow catchers send to the camera, as color or as luminance, or sums of it.
#[derive(Clone, Copy)]
pub(super) struct CatcherLight<T> {
    /// The light with all objects.
    pub(super) with_objects: T,
    /// The light with only those objects that are in the plate or light it.
    pub(super) without_objects: T,
    /// The share of the pixel that shadow catchers cover.
    pub(super) share: f64,
}

impl CatcherLight<[f64; 3]> {
    /// Returns the share of each channel that other objects take, times that of the pixel; negative if they add light.
    pub(super) fn shadow(&self) -> [f64; 3] {
        [0, 1, 2].map(|channel| self.share * missing_share(self.with_objects[channel], self.without_objects[channel]))
    }
}

/// Returns the share of some light that is missing with all objects present; 0 if there is no light.
fn missing_share(with: f64, without: f64) -> f64 {
    if without > 0.0 { 1.0 - with / without } else { 0.0 }
}

impl CatcherLight<f64> {
    /// Returns what was added to the sum since `before`.
    pub(super) fn minus(self, before: Self) -> Self {
        Self {
            with_objects: self.with_objects - before.with_objects,
            without_objects: self.without_objects - before.without_objects,
            share: self.share - before.share,
        }
    }

    /// Returns the alpha: the share of luminance that other objects take, times that of the pixel; 0 if they add light.
    pub(super) fn coverage(&self) -> f64 {
        (self.share * missing_share(self.with_objects, self.without_objects)).clamp(0.0, self.share)
    }
}

/// Values for shadow catchers: two colors and a share.
const CATCHER_VALUES: usize = 7;
/// Values for polarization: the luminance of each Stokes component.
pub(super) const STOKES_VALUES: usize = 4;
/// Values for a half of the samples: a color, and how many samples it has.
pub(super) const HALF_VALUES: usize = 4;

impl Layers {
    pub(super) fn new(scene: &Scene<Curve>, basis: &Basis) -> Self {
        let color_space = scene.film.color_space;
        let (luminance, film_white) =
            (color_space.to_xyz()[1], apply(&color_space.matrix_from_xyz(), color_space.white()));
        let (offsets, first) = (vec![None; Layer::NAMES.len()], scene.format.first);
        let mut layers = Self { offsets, first, luminance, film_white, ..Self::default() };
        let mut group_numbers = HashMap::new();
        for group in &scene.light_groups {
            let name = light_layer_name(group);
            let number = *group_numbers.entry(name.clone()).or_insert(layers.groups.len());
            layers.group_of.push(number);
            layers.groups.extend((number == layers.groups.len()).then_some(name));
        }
        for &layer in &scene.format.layers {
            if layers.offset(layer).is_none() {
                layers.offsets[layer as usize] = Some(layers.row_len);
                layers.requested.push(layer);
                layers.row_len += match layer {
                    Layer::Lights => 3 * layers.groups.len(),
                    Layer::HalfA | Layer::HalfB => HALF_VALUES,
                    Layer::Polarization => STOKES_VALUES,
                    Layer::Samples | Layer::Shadow => 0,
                    _ if layer.is_matte() => 0,
                    _ => layer.channels().len(),
                };
            }
        }
        if scene.has_shadow_catchers() {
            layers.catcher_offset = Some(layers.row_len);
            layers.row_len += CATCHER_VALUES;
        }
        if let Some(bands) = scene.format.spectral {
            layers.spectrum = Spectrum::new(scene, basis, bands, layers.row_len);
            layers.row_len += layers.spectrum.as_ref().map_or(0, Spectrum::row_len);
        }
        let mattes = layers.requested.iter().filter(|layer| layer.is_matte());
        layers.ids = mattes.map(|&matte| (matte, names(scene, matte).map(id).collect())).collect();
        layers.separates_lobes = layers.requested.iter().any(|layer| layer.is_of_lobe());
        if layers.separates_lobes || layers.offset(Layer::Albedo).or(layers.offset(Layer::Residual)).is_some() {
            layers.white = Some(White::new(basis));
        }
        layers
    }

    /// Returns the manifests that name what the IDs of the mattes stand for.
    pub(super) fn manifests<S>(&self, scene: &Scene<S>) -> Vec<Manifest> {
        self.ids.iter().map(|(matte, _)| Manifest::new(matte.name(), names(scene, *matte))).collect()
    }

    pub(super) fn is_empty(&self) -> bool {
        self.requested.is_empty() && self.catcher_offset.is_none() && self.spectrum.is_none()
    }

    /// Returns where in a row the numbers of a layer begin; `None` if it is not requested.
    #[inline]
    pub(super) fn offset(&self, layer: Layer) -> Option<usize> {
        self.offsets[layer as usize]
    }

    /// Returns whether layers need each gathered photon's light, spectrum or polarization, or whether it was dispersed.
    pub(super) fn needs_photon_details(&self) -> bool {
        self.offset(Layer::Lights).or(self.offset(Layer::Dispersed)).is_some()
            || self.has_stokes()
            || self.spectrum.is_some()
    }

    /// Returns whether any layer shows first surfaces.
    pub(super) fn shows_surfaces(&self) -> bool {
        use Layer::{Albedo, GeometricNormal, Normal, Position, Uv};
        [Albedo, Normal, GeometricNormal, Position, Uv].iter().any(|layer| self.offset(*layer).is_some())
    }

    pub(super) fn has_catchers(&self) -> bool {
        self.catcher_offset.is_some()
    }

    /// Writes the light on a shadow catcher into an empty row.
    pub(super) fn write_catcher(&self, row: &mut [f64], [with, without]: [[f64; 3]; 2]) {
        let Some(offset) = self.catcher_offset else { return };
        row[offset..offset + 3].copy_from_slice(&with);
        row[offset + 3..offset + 6].copy_from_slice(&without);
        row[offset + 6] = 1.0;
    }

    /// Adds the light of a photon on a shadow catcher to a row.
    pub(super) fn add_caught_photon(&self, row: &mut [f64], rgb: [f64; 3]) {
        if let Some(offset) = self.catcher_offset {
            add(&mut row[offset..], rgb);
        }
    }

    /// Returns by how much other objects change the light on a shadow catcher, if there is one. Alpha follows from it.
    pub(super) fn catcher_change(&self, row: &[f64]) -> [f64; 3] {
        self.catcher_offset
            .map_or([0.0; 3], |offset| [0, 1, 2].map(|channel| row[offset + channel] - row[offset + 3 + channel]))
    }

    /// Returns the light of shadow catchers, from the sums of `kept` samples and what photons splat.
    pub(super) fn catcher_light(&self, sums: &[f64], splatted: &[f64], kept: f64) -> Option<CatcherLight<[f64; 3]>> {
        let offset = self.catcher_offset?;
        let mean =
            |number: usize| sums[offset + number] / kept + splatted.get(offset + number).copied().unwrap_or_default();
        let [with, without] = [0, 3].map(|first| [0, 1, 2].map(|channel| mean(first + channel)));
        Some(CatcherLight { with_objects: with, without_objects: without, share: mean(6) })
    }

    /// Returns the luminance of the light of shadow catchers.
    pub(super) fn catcher_luminance(&self, caught: &CatcherLight<[f64; 3]>) -> CatcherLight<f64> {
        let [with, without] = [&caught.with_objects, &caught.without_objects].map(|rgb| self.luminance_of(rgb));
        CatcherLight { with_objects: with, without_objects: without, share: caught.share }
    }

    /// Adds the numbers of shadow catchers to sums.
    pub(super) fn add_catcher(&self, sums: &mut [f64], row: &[f64]) {
        if let Some(offset) = self.catcher_offset {
            let more = &row[offset..offset + CATCHER_VALUES];
            sums[offset..offset + CATCHER_VALUES].iter_mut().zip(more).for_each(|(sum, more)| *sum += more);
        }
    }

    /// Adds light to the layers of a row, by the lobe of the first surface.
    fn add_by_lobe(&self, row: &mut [f64], first: FirstLobe, bounces: u32, rgb: &[f64; 3]) {
        let mut add = |direct: Layer, indirect: Layer, share: [f64; 3]| {
            let layer = if bounces == 1 { direct } else { indirect };
            self.add_to(layer, row, std::array::from_fn(|channel| share[channel] * rgb[channel]));
        };
        match first {
            FirstLobe::Reflected { diffuse } => {
                let diffuse = diffuse.map(f64::from);
                add(Layer::DiffuseDirect, Layer::DiffuseIndirect, diffuse);
                add(Layer::GlossyDirect, Layer::GlossyIndirect, diffuse.map(|share| 1.0 - share));
            }
            FirstLobe::Specular => add(Layer::SpecularDirect, Layer::SpecularIndirect, [1.0; 3]),
            FirstLobe::Transmitted => add(Layer::TransmissionDirect, Layer::TransmissionIndirect, [1.0; 3]),
        }
    }

    /// Adds three numbers to a layer's numbers in a row, if the layer is requested.
    #[inline]
    pub(super) fn add_to(&self, layer: Layer, row: &mut [f64], numbers: [f64; 3]) {
        if let Some(offset) = self.offset(layer) {
            add(&mut row[offset..], numbers);
        }
    }

    /// Returns whether any layer needs Stokes vectors.
    pub(super) fn has_stokes(&self) -> bool {
        self.requested.iter().copied().any(Layer::is_of_polarization)
    }

    /// Adds S1, S2 and S3 of light, times a factor, to a row.
    #[cold]
    pub(super) fn add_stokes(&self, row: &mut [f64], stokes: [[f64; 3]; 3], factor: f64) {
        for (layer, color) in Layer::STOKES.into_iter().zip(stokes) {
            self.add_to(layer, row, color.map(|x| factor * x));
        }
        let [s1, s2, s3] = stokes.map(|color| factor * self.luminance_of(&color));
        if let Some(offset) = self.offset(Layer::Polarization) {
            add(&mut row[offset + 1..], [s1, s2, s3]);
        }
    }

    pub(super) fn luminance_of(&self, rgb: &[f64; 3]) -> f64 {
        (0..3).map(|channel| self.luminance[channel] * rgb[channel]).sum()
    }

    /// Adds light to a row.
    pub(super) fn add(&self, row: &mut [f64], contribution: &Contribution) {
        let Contribution { light, found, rgb, bounces, dispersed, first, .. } = contribution;
        if let Some(first) = first.filter(|_| *bounces > 0) {
            self.add_by_lobe(row, first, *bounces, rgb);
        }
        let kind = match (bounces, found) {
            (0, FoundBy::Hit { normal: Some(_), .. }) => Layer::Emission,
            (0, _) => Layer::Background,
            (1, _) => Layer::Direct,
            _ => Layer::Indirect,
        };
        self.add_to(kind, row, *rgb);
        if let FoundBy::Gathered | FoundBy::Splatted = found {
            self.add_to(Layer::Caustics, row, *rgb);
        }
        if *dispersed {
            self.add_to(Layer::Dispersed, row, *rgb);
        }
        if let Some(offset) = self.offset(Layer::Polarization) {
            row[offset] += self.luminance_of(rgb);
        }
        if let (Some(offset), Some(light)) = (self.offset(Layer::Lights), light) {
            add(&mut row[offset + 3 * self.group_of[*light]..], *rgb);
        }
    }
}
