//! What a scene holds, and what rays meet in it.

use std::cell::Cell;
use std::collections::BTreeSet;
use std::sync::Arc;

use super::index::Index;
use super::{Camera, FilmSettings, Relief, RenderText};
use crate::film::{Format, Layer, RANKS};
use crate::light::{Light, LightId};
use crate::material::Material;
use crate::math::Ray;
use crate::shape::{Coordinates, Crossing, Shape, SurfacePoint, is_before};
use crate::spectrum::{Curve, Quantity};

/// Number of a material in its scene.
pub type MaterialId = u32;

/// A world in which every name has been found and every number checked.
#[derive(Clone, Debug)]
pub struct Scene<S = Curve> {
    /// From where it is seen.
    pub camera: Camera,
    /// The image to make.
    pub film: FilmSettings,
    /// What its file holds.
    pub format: Format,
    /// How to make it.
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
    /// Those of the infinite lights that the camera does not see straight.
    pub hidden_lights: Vec<LightId>,
    /// What the author should know but need not change.
    pub warnings: Vec<String>,
    /// SHA-256 of the scene file, the values set in it and the files it names, 64 hexadecimal digits.
    pub hash: String,
    /// Values that were put in place of those of the file, each as `KEY=VALUE`.
    pub settings: Vec<String>,
    pub(super) index: Arc<Index>,
}

/// A surface with its material.
#[derive(Clone, Debug)]
pub struct Object {
    /// Its name, or `object N` counted from 1.
    pub name: String,
    /// Where it is.
    pub shape: Arc<Shape>,
    /// What it does with light.
    pub material: MaterialId,
    /// The light it is, if it shines.
    pub light: Option<LightId>,
    /// Where its points lie in images, if its material varies over the surface.
    pub coordinates: Option<Arc<Coordinates>>,
    /// The same whatever its material is; none of a shape that has none.
    pub chart: Option<Arc<Coordinates>>,
    /// The name of what it is one of, if it is one of several instances; else its own.
    pub asset: String,
    /// The group of lights that it belongs to if it shines; its asset alone if absent.
    pub group: Option<String>,
    /// What the camera sees of it.
    pub sight: Sight,
    /// The image that bends its normal, if there is one.
    pub relief: Option<Arc<Relief>>,
}

/// What the camera sees of an object where it looks straight at it. Light, mirrors and shadows know no difference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sight {
    /// All of it.
    #[default]
    Shown,
    /// What is behind it.
    Hidden,
    /// Nothing: a hole in the image, of coverage 0.
    Holdout,
    /// What other objects change of the light on it: it stands for a surface of the plate that the image is laid over.
    ShadowCatcher,
}

impl Object {
    /// The surface at a crossing, with the normal that its relief gives it.
    #[inline]
    pub fn point(&self, ray: &Ray, crossing: &Crossing) -> SurfacePoint {
        let mut point = self.shape.point(ray, crossing);
        if let Some(relief) = &self.relief {
            point.shading = relief.normal(&self.shape, crossing, &point);
        }
        point
    }

    /// Where a point of its surface would lie in an image on it; (0, 0) if it has no coordinates.
    pub fn chart_uv(&self, crossing: &Crossing, point: &SurfacePoint) -> [f64; 2] {
        self.chart.as_ref().map_or([0.0; 2], |chart| chart.at(&self.shape, crossing, point.position))
    }

    /// Where a point of its surface lies in images on it; (0, 0) if there are none.
    pub fn uv(&self, crossing: &Crossing, point: &SurfacePoint) -> [f64; 2] {
        let coordinates = self.coordinates.as_ref();
        coordinates.map_or([0.0; 2], |coordinates| coordinates.at(&self.shape, crossing, point.position))
    }
}

/// A material and the name its author gave it.
#[derive(Clone, Debug)]
pub struct NamedMaterial<S> {
    /// Its name in the scene file.
    pub name: String,
    /// The material.
    pub material: Material<S>,
}

/// Where a ray first meets the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The object met.
    pub object: u32,
    /// Where on it.
    pub crossing: Crossing,
}

impl Hit {
    /// What was met.
    pub fn primitive(&self) -> Primitive {
        Primitive { object: self.object, part: self.crossing.part }
    }
}

/// A part of an object: a triangle of its mesh, a face of its cube, or all of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Primitive {
    /// The object.
    pub object: u32,
    /// The part, 0 of other shapes.
    pub part: u32,
}

impl Primitive {
    /// None.
    const NONE: Self = Self { object: u32::MAX, part: 0 };

    /// The part, if it is one of this object.
    fn of(self, object: u32) -> Option<u32> {
        (self.object == object).then_some(self.part)
    }
}

/// What a ray leads from and to, if those are surfaces.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ends {
    /// What the ray leaves. A triangle is not met again by a ray that leaves it, which is not tested.
    pub left: Option<Primitive>,
    /// The object of the light that it leads to, which does not occlude itself ..
    pub light: Option<u32>,
    /// .. but where one of its triangles is meant, which the others do occlude.
    pub part: Option<u32>,
}

impl From<Option<u32>> for Ends {
    fn from(light: Option<u32>) -> Self {
        Self { light, ..Self::default() }
    }
}

impl<S> Scene<S> {
    /// The same world with every spectrum converted; `convert` is told what the spectrum describes.
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
            settings: self.settings.clone(),
            index: self.index.clone(),
        }
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

    /// Bytes of memory that layers take: of each number a sum in 64 bits, another where a filter subtracts samples, its
    /// value in 32, and that again while the file is written.
    pub fn layer_bytes(&self) -> u64 {
        let each = if self.film.filter.is_signed() { 24 } else { 16 };
        each * self.layer_channels() * self.film.window().pixels()
    }

    /// The light that fills the whole sky, if there is one.
    pub fn environment(&self) -> Option<LightId> {
        self.infinite_lights.iter().copied().find(|&sky| matches!(self.lights[sky], Light::Environment(_)))
    }

    /// The material of an object.
    pub fn material_of(&self, object: u32) -> &Material<S> {
        &self.materials[self.objects[object as usize].material as usize].material
    }

    /// The nearest surface along a ray; of equally near ones, that of the object listed first.
    pub fn intersect(&self, ray: &Ray) -> Option<Hit> {
        self.intersect_from(ray, None)
    }

    /// The nearest surface along a ray that leaves a surface.
    pub fn intersect_from(&self, ray: &Ray, left: Option<Primitive>) -> Option<Hit> {
        self.nearest_from(ray, f64::INFINITY, left, |_| true)
    }

    /// The nearest surface along a ray of the camera, which may have left one through which light goes straight on.
    pub fn intersect_seen(&self, ray: &Ray, left: Option<Primitive>) -> Option<Hit> {
        self.nearest_from(ray, f64::INFINITY, left, |object| self.objects[object as usize].sight != Sight::Hidden)
    }

    /// The nearest surface of the plate's world along a ray: see [`Scene::is_of_plate`].
    pub fn intersect_plate(&self, ray: &Ray, left: Option<Primitive>) -> Option<Hit> {
        self.nearest_from(ray, f64::INFINITY, left, |object| self.is_of_plate(object))
    }

    /// Whether an object stands for something that is in the plate, or lights it: a shadow catcher, a holdout, a lamp.
    pub fn is_of_plate(&self, object: u32) -> bool {
        let object = &self.objects[object as usize];
        object.light.is_some() || matches!(object.sight, Sight::ShadowCatcher | Sight::Holdout)
    }

    /// The nearest surface along a ray up to a distance, of those objects that count.
    #[inline]
    pub fn nearest(&self, ray: &Ray, distance: f64, counts: impl Fn(u32) -> bool) -> Option<Hit> {
        self.nearest_from(ray, distance, None, counts)
    }

    #[inline]
    fn nearest_from(
        &self,
        ray: &Ray,
        distance: f64,
        left: Option<Primitive>,
        counts: impl Fn(u32) -> bool,
    ) -> Option<Hit> {
        let triangle = left.map(|left| [left.object, left.part]);
        let left = left.unwrap_or(Primitive::NONE);
        let pooled = self.index.pool().and_then(|pool| pool.nearest(ray, distance, triangle, &counts));
        let mut nearest = pooled.map(|(object, crossing)| Hit { object, crossing });
        let limit = nearest.map_or(distance, |hit| hit.crossing.t);
        self.index.nearest(ray, limit, |object, limit| {
            if !counts(object) {
                return limit;
            }
            let shape = &self.objects[object as usize].shape;
            if let Some(crossing) = shape.intersect_from(ray, limit, left.of(object)) {
                if nearest.is_none_or(|n| crossing.t < n.crossing.t || object < n.object) {
                    nearest = Some(Hit { object, crossing });
                }
                return crossing.t;
            }
            limit
        });
        nearest
    }

    /// Whether anything lies before a light at `distance`; the light's own object does not hide it.
    ///
    /// `last_occluder` remembers what hid a light last: it is asked first, for it often hides the next one as well.
    pub fn is_occluded(
        &self,
        ray: &Ray,
        distance: f64,
        ends: impl Into<Ends>,
        last_occluder: &Cell<Option<u32>>,
    ) -> bool {
        self.is_occluded_by(ray, distance, ends, last_occluder, |_| true)
    }

    /// Whether any object that counts lies before a light at `distance`; the light's own does not occlude it.
    #[inline]
    pub fn is_occluded_by(
        &self,
        ray: &Ray,
        distance: f64,
        ends: impl Into<Ends>,
        last_occluder: &Cell<Option<u32>>,
        counts: impl Fn(u32) -> bool,
    ) -> bool {
        let ends = ends.into();
        let Ends { left, light, part } = ends;
        // An object listed after the light's own does not hide it by an equal distance.
        let hides_at = |[object, other]: [u32; 2], t: f64| match light {
            Some(light) if light == object => part.is_some_and(|part| is_before([other, part], [t, distance])),
            _ if !counts(object) => false,
            Some(light) if light < object => t < distance,
            _ => true,
        };
        let triangle = left.map(|left| [left.object, left.part]);
        if self.index.pool().is_some_and(|pool| pool.any(ray, distance, triangle, hides_at)) {
            return true;
        }
        let last = last_occluder.get();
        if last.is_some_and(|last| self.hides(last, ray, distance, ends, &counts)) {
            return true;
        }
        let mut hidden = false;
        self.index.any(ray, distance, |object| {
            hidden = Some(object) != last && self.hides(object, ray, distance, ends, &counts);
            if hidden {
                last_occluder.set(Some(object));
            }
            hidden
        });
        hidden
    }

    /// Whether an object beside the pool that counts lies before a light at `distance`.
    #[inline(always)]
    fn hides(&self, object: u32, ray: &Ray, distance: f64, ends: Ends, counts: impl Fn(u32) -> bool) -> bool {
        let shape = &self.objects[object as usize].shape;
        match ends.light {
            Some(light) if light == object => ends.part.is_some_and(|part| shape.hides(ray, part, distance)),
            _ if !counts(object) => false,
            light => {
                let is_later = light.is_some_and(|light| light < object);
                let t_max = if is_later { distance.next_down() } else { distance };
                shape.is_crossed_from(ray, t_max, ends.left.and_then(|left| left.of(object)))
            }
        }
    }
}
