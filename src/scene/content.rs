//! The contents of a scene, and ray queries against it.

use std::cell::Cell;
use std::collections::BTreeSet;
use std::path::PathBuf;
use std::sync::Arc;

use super::hit::{Hit, Primitive, RayEnds};
use super::index::{Index, accept_all};
use super::object::{Object, Visibility};
use super::{Camera, FilmSettings, RenderText};
use crate::film::{Format, Layer, RANKS};
use crate::light::{Light, LightId};
use crate::material::Material;
use crate::math::Ray;
use crate::spectrum::{Curve, Quantity};

/// A world in which every name has been resolved and every number checked.
#[derive(Clone, Debug)]
pub struct Scene<S = Curve> {
    /// The camera.
    pub camera: Camera,
    /// Size and meaning of the image.
    pub film: FilmSettings,
    /// What the image file contains.
    pub format: Format,
    /// How the image is rendered.
    pub render: RenderText,
    /// Surfaces, in the order of the file. Scenes that differ only in their spectra share them.
    pub objects: Arc<[Object]>,
    /// Materials, in the order in which objects first use them.
    pub materials: Vec<NamedMaterial<S>>,
    /// Everything that shines.
    pub lights: Vec<Light<S>>,
    /// The lights that rays see when they hit nothing.
    pub infinite_lights: Vec<LightId>,
    /// The name of each light's group. Lights of one group share a layer.
    pub light_groups: Vec<String>,
    /// Infinite lights that the camera does not see directly.
    pub hidden_lights: Vec<LightId>,
    /// Warnings that the author should know about but need not act on.
    pub warnings: Vec<String>,
    /// SHA-256 of the scene file, the values set in it and the files it names, as 64 hexadecimal digits.
    pub hash: String,
    /// The files that were read: the scene file first, then the files it includes, then all files that these name.
    pub files: Vec<PathBuf>,
    /// Overrides of values in the file, each as `KEY=VALUE`.
    pub settings: Vec<String>,
    /// Whether a warning already explains why the image may contain no light.
    pub(super) has_dark_warning: bool,
    pub(super) index: Arc<Index>,
}

/// A material and its name.
#[derive(Clone, Debug)]
pub struct NamedMaterial<S> {
    /// Its name in the scene file.
    pub name: String,
    /// The material.
    pub material: Material<S>,
}

impl<S> Scene<S> {
    /// Returns the same world with every spectrum converted. `convert` also receives the quantity that the spectrum
    /// describes.
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
            has_dark_warning: self.has_dark_warning,
            index: self.index.clone(),
        }
    }

    /// Returns whether an image without any light would be neither intended nor explained by a warning.
    pub fn is_dark_by_surprise(&self) -> bool {
        let is_cut = |object: &Object| matches!(object.visibility, Visibility::ShadowCatcher | Visibility::Holdout);
        let is_whole = self.film.crop.is_none() && self.format.layers.is_empty();
        is_whole && !self.has_dark_warning && !self.objects.iter().any(is_cut)
    }

    /// Returns the number of channels of all layers beside the image, and of its spectral bands.
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

    /// Returns the memory of all layers, in bytes. Each number takes a 64-bit sum, another one if the filter has
    /// negative lobes, and a 32-bit value. With shadow catchers, the sums from which alpha is computed are added.
    pub fn layer_bytes(&self) -> u64 {
        let sums = if self.film.filter.is_signed() { 16 } else { 8 };
        let caught = if self.has_shadow_catchers() { 8 * sums } else { 0 };
        (self.layer_channels() * (sums + 4) + caught) * self.film.window().pixels()
    }

    /// Returns the environment light, if there is one.
    pub fn environment(&self) -> Option<LightId> {
        self.infinite_lights.iter().copied().find(|&sky| matches!(self.lights[sky], Light::Environment(_)))
    }

    /// Returns the material of an object.
    pub fn material_of(&self, object: u32) -> &Material<S> {
        &self.materials[self.objects[object as usize].material as usize].material
    }

    /// Returns whether an object is a clear body, or a part of the surface of one.
    pub(super) fn is_clear(&self, object: u32) -> bool {
        self.material_of(object).medium().is_some()
    }

    /// Returns the nearest hit along a ray. Of equally near hits, returns that of the object listed first.
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.intersect_from(ray, None)
    }

    /// Returns the nearest hit along a ray that may start on the primitive `from`.
    pub fn intersect_from(&self, ray: &Ray, from: Option<Primitive>) -> Option<Hit> {
        self.nearest_from(ray, f64::INFINITY, from, accept_all)
    }

    /// Returns the nearest hit along a camera ray. The ray may start on a primitive `from` that it passed straight
    /// through.
    pub fn intersect_seen(&self, ray: &Ray, from: Option<Primitive>) -> Option<Hit> {
        self.nearest_from(ray, f64::INFINITY, from, |object| self.is_seen(object))
    }

    /// Returns whether the camera sees an object, or at least the hole that it cuts.
    pub fn is_seen(&self, object: u32) -> bool {
        self.objects[object as usize].visibility != Visibility::Hidden
    }

    /// Returns the nearest hit along a ray in the world of the plate ([`Scene::is_of_plate`]). A camera ray
    /// (`is_camera_ray`) does not hit what is hidden from the camera.
    pub fn intersect_plate(&self, ray: &Ray, from: Option<Primitive>, is_camera_ray: bool) -> Option<Hit> {
        let is_there = |object| self.is_of_plate(object) && (!is_camera_ray || self.is_seen(object));
        self.nearest_from(ray, f64::INFINITY, from, is_there)
    }

    /// Returns whether an object stands for something in the plate or lights it: a shadow catcher, a holdout or a lamp.
    pub fn is_of_plate(&self, object: u32) -> bool {
        let object = &self.objects[object as usize];
        object.light.is_some() || matches!(object.visibility, Visibility::ShadowCatcher | Visibility::Holdout)
    }

    /// Returns whether any object is a shadow catcher.
    pub fn has_shadow_catchers(&self) -> bool {
        self.objects.iter().any(|object| object.visibility == Visibility::ShadowCatcher)
    }

    /// Returns the nearest hit along a ray up to a distance, among the objects for which `accept` holds.
    pub fn nearest(&self, ray: &Ray, distance: f64, accept: &dyn Fn(u32) -> bool) -> Option<Hit> {
        self.nearest_from(ray, distance, None, accept)
    }

    /// Returns the objects without bounds, which are planes, with their numbers.
    pub fn unbounded(&self) -> impl Iterator<Item = (u32, &Object)> {
        let all = self.index.always_tested.iter().map(|&number| (number, &self.objects[number as usize]));
        all.filter(|(_, object)| !object.shape.is_bounded())
    }

    #[inline]
    fn nearest_from(
        &self,
        ray: &Ray,
        distance: f64,
        from: Option<Primitive>,
        accept: impl Fn(u32) -> bool,
    ) -> Option<Hit> {
        let hit = self.index.nearest(&self.objects, ray, distance, from, &accept)?;
        if self.objects[hit.object as usize].contact == 0.0 || !self.is_clear(hit.object) {
            return Some(hit);
        }
        self.opaque_at(ray, from, &hit, &accept).or(Some(hit))
    }

    /// Returns the hit of an opaque surface in the place where a ray has hit a clear one. Beyond the clear surface, the
    /// ray would start behind the opaque one and miss it.
    #[cold]
    fn opaque_at(&self, ray: &Ray, from: Option<Primitive>, clear: &Hit, accept: &dyn Fn(u32) -> bool) -> Option<Hit> {
        let next = self.objects[clear.object as usize].point(ray, &clear.intersection).leave(ray.direction);
        let distance = (next.origin - ray.origin).dot(ray.direction);
        let is_opaque = |object| !self.is_clear(object) && !self.material_of(object).is_see_through();
        self.index.nearest(&self.objects, ray, distance, from, |object| is_opaque(object) && accept(object))
    }

    /// Returns whether anything lies before a light at `distance`. The light's own object does not occlude it, unless
    /// `ends` names one of its parts: then its other parts may.
    ///
    /// `last_occluder` caches the object that last occluded a light. It is tested first, since it often occludes the
    /// next one as well.
    pub fn is_occluded(
        &self,
        ray: &Ray,
        distance: f64,
        ends: impl Into<RayEnds>,
        last_occluder: &Cell<Option<u32>>,
    ) -> bool {
        self.index.is_occluded(&self.objects, ray, distance, ends.into(), last_occluder, accept_all)
    }

    /// Returns whether an object for which `accept` holds lies before a light at `distance`. The light's own object
    /// does not occlude it, unless `ends` names one of its parts: then its other parts may.
    pub fn is_occluded_by(
        &self,
        ray: &Ray,
        distance: f64,
        ends: impl Into<RayEnds>,
        last_occluder: &Cell<Option<u32>>,
        accept: &dyn Fn(u32) -> bool,
    ) -> bool {
        self.index.is_occluded(&self.objects, ray, distance, ends.into(), last_occluder, accept)
    }
}
