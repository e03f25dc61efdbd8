//! What a scene holds, and what rays meet in it.

use std::cell::Cell;
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;

use super::hit::{Hit, Primitive, RayEnds};
use super::index::{Index, every};
use super::object::{Object, Visibility};
use super::{Camera, FilmSettings, RenderText};
use crate::film::{Format, Layer, RANKS};
use crate::light::{Light, LightId};
use crate::material::Material;
use crate::math::Ray;
use crate::spectrum::{Curve, Quantity};

/// A world in which every name has been found and every number checked.
#[derive(Clone, Debug)]
pub struct Scene<S = Curve> {
    /// The camera.
    pub camera: Camera,
    /// The image to make.
    pub film: FilmSettings,
    /// What its file holds.
    pub format: Format,
    /// How to render the image.
    pub render: RenderText,
    /// Surfaces, in the order of the file: shared by all scenes that differ only in their spectra.
    pub objects: Arc<[Object]>,
    /// Materials, in the order in which objects use them first.
    pub materials: Vec<NamedMaterial<S>>,
    /// Everything that shines.
    pub lights: Vec<Light<S>>,
    /// The lights that rays see which meet nothing.
    pub infinite_lights: Vec<LightId>,
    /// The group of each light, by its name: lights of one group share a layer.
    pub light_groups: Vec<String>,
    /// Infinite lights that the camera does not see directly.
    pub hidden_lights: Vec<LightId>,
    /// What the author should know but need not change.
    pub warnings: Vec<String>,
    /// SHA-256 of the scene file, the values set in it and the files it names, 64 hexadecimal digits.
    pub hash: String,
    /// The files that it was read from: its own first, those that it includes, and all that these name.
    pub files: Vec<PathBuf>,
    /// Values that were put in place of those of the file, each as `KEY=VALUE`.
    pub settings: Vec<String>,
    /// Whether the warnings say why there may be no light in the image.
    pub(super) is_dark_told: bool,
    pub(super) index: Arc<Index>,
}

/// A material and the name its author gave it.
#[derive(Clone, Debug)]
pub struct NamedMaterial<S> {
    /// Its name in the scene file.
    pub name: String,
    /// The material.
    pub material: Material<S>,
}

impl<S> Scene<S> {
    /// The same world with every spectrum converted; `convert` gets the quantity that a spectrum describes.
    pub fn map<T>(&self, mut convert: impl FnMut(Quantity, &S) -> T) -> Scene<T> {
        let materials = self.materials.iter();
        Scene {
            camera: self.camera.clone(),
            film: self.film,
            format: self.format.clone(),
            render: self.render.clone(),
            objects: self.objects.clone(),
            materials: materials
                .map(|m| NamedMaterial { name: m.name.clone(), material: m.material.map(&mut convert) })
                .collect(),
            lights: self.lights.iter().map(|light| light.map(&mut convert)).collect(),
            infinite_lights: self.infinite_lights.clone(),
            light_groups: self.light_groups.clone(),
            hidden_lights: self.hidden_lights.clone(),
            warnings: self.warnings.clone(),
            hash: self.hash.clone(),
            files: self.files.clone(),
            settings: self.settings.clone(),
            is_dark_told: self.is_dark_told,
            index: self.index.clone(),
        }
    }

    /// Whether an image without any light is neither meant nor explained by a warning.
    pub fn is_dark_by_surprise(&self) -> bool {
        let is_cut = |object: &Object| matches!(object.visibility, Visibility::ShadowCatcher | Visibility::Holdout);
        let is_whole = self.film.crop.is_none() && self.format.layers.is_empty();
        is_whole && !self.is_dark_told && !self.objects.iter().any(is_cut)
    }

    /// Channels of the layers that are made beside the image, and of its spectra.
    pub fn layer_channels(&self) -> u64 {
        let groups = self.light_groups.iter().collect::<BTreeSet<_>>().len();
        let images = |layer: &Layer| match layer {
            Layer::Lights => groups,
            layer if layer.is_matte() => RANKS / 2,
            _ => 1,
        };
        let layers = self.format.layers.iter().map(|layer| images(layer) * layer.channels().len()).sum::<usize>();
        let components = if self.format.has_stokes() { 4 } else { 1 };
        (layers + components * self.format.spectral.map_or(0, |bands| bands.count())) as u64
    }

    /// Bytes of memory that layers take: of each number a sum in 64 bits, another where a filter subtracts samples, and
    /// its value in 32; and the sums of which alpha is made where there are shadow catchers.
    pub fn layer_bytes(&self) -> u64 {
        let sums = if self.film.filter.is_signed() { 16 } else { 8 };
        let caught = if self.has_shadow_catchers() { 8 * sums } else { 0 };
        (self.layer_channels() * (sums + 4) + caught) * self.film.window().pixels()
    }

    /// The light that fills the whole sky, if there is one.
    pub fn environment(&self) -> Option<LightId> {
        self.infinite_lights.iter().copied().find(|&sky| matches!(self.lights[sky], Light::Environment(_)))
    }

    /// The material of an object.
    pub fn material_of(&self, object: u32) -> &Material<S> {
        &self.materials[self.objects[object as usize].material as usize].material
    }

    /// Whether an object is a clear body, or a part of its surface.
    pub(super) fn is_clear(&self, object: u32) -> bool {
        self.material_of(object).medium().is_some()
    }

    /// The nearest surface along a ray; of equally near ones, that of the object listed first.
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.intersect_from(ray, None)
    }

    /// The nearest surface along a ray that leaves a surface.
    pub fn intersect_from(&self, ray: &Ray, left: Option<Primitive>) -> Option<Hit> {
        self.index.nearest(&self.objects, ray, f64::INFINITY, left, every)
    }

    /// The nearest surface along a ray of the camera, which may have left one through which light goes straight on.
    pub fn intersect_seen(&self, ray: &Ray, left: Option<Primitive>) -> Option<Hit> {
        self.nearest_from(ray, left, &|object| self.is_seen(object))
    }

    /// Whether the camera sees an object, or at least its hole.
    pub fn is_seen(&self, object: u32) -> bool {
        self.objects[object as usize].visibility != Visibility::Hidden
    }

    /// The nearest surface of the plate's world along a ray, which may be of the camera: see [`Scene::is_of_plate`].
    pub fn intersect_plate(&self, ray: &Ray, left: Option<Primitive>, of_camera: bool) -> Option<Hit> {
        self.nearest_from(ray, left, &|object| self.is_of_plate(object) && (!of_camera || self.is_seen(object)))
    }

    /// Whether an object stands for something that is in the plate, or lights it: a shadow catcher, a holdout, a lamp.
    pub fn is_of_plate(&self, object: u32) -> bool {
        let object = &self.objects[object as usize];
        object.light.is_some() || matches!(object.visibility, Visibility::ShadowCatcher | Visibility::Holdout)
    }

    /// Whether any object is a shadow catcher.
    pub fn has_shadow_catchers(&self) -> bool {
        self.objects.iter().any(|object| object.visibility == Visibility::ShadowCatcher)
    }

    /// The nearest surface along a ray up to a distance, of those objects that count.
    pub fn nearest(&self, ray: &Ray, distance: f64, counts: &dyn Fn(u32) -> bool) -> Option<Hit> {
        self.index.nearest(&self.objects, ray, distance, None, counts)
    }

    /// Objects without bounds: planes.
    pub fn unbounded(&self) -> impl Iterator<Item = (u32, &Object)> {
        let all = self.index.always.iter().map(|&number| (number, &self.objects[number as usize]));
        all.filter(|(_, object)| !object.shape.is_bounded())
    }

    fn nearest_from(&self, ray: &Ray, left: Option<Primitive>, counts: &dyn Fn(u32) -> bool) -> Option<Hit> {
        self.index.nearest(&self.objects, ray, f64::INFINITY, left, counts)
    }

    /// Whether anything lies before a light at `distance`; the light's own object does not hide it.
    ///
    /// `last_occluder` remembers what hid a light last: it is asked first, for it often hides the next one as well.
    pub fn is_occluded(
        &self,
        ray: &Ray,
        distance: f64,
        ends: impl Into<RayEnds>,
        last_occluder: &Cell<Option<u32>>,
    ) -> bool {
        self.index.is_occluded(&self.objects, ray, distance, ends.into(), last_occluder, every)
    }

    /// Whether any object that counts lies before a light at `distance`; the light's own does not occlude it.
    pub fn is_occluded_by(
        &self,
        ray: &Ray,
        distance: f64,
        ends: impl Into<RayEnds>,
        last_occluder: &Cell<Option<u32>>,
        counts: &dyn Fn(u32) -> bool,
    ) -> bool {
        self.index.is_occluded(&self.objects, ray, distance, ends.into(), last_occluder, counts)
    }
}
