//! What the camera sees, directly or via other surfaces, estimated roughly with a few thousand rays.
//!
//! Rays pass straight through clear bodies, panes and cutouts.

use std::cell::Cell;

use crate::light::Light;
use crate::material::{Material, reflect};
use crate::math::{Bounds, BranchKey, DVec2, DVec3, Ray, Sampler, sample_cosine_about};
use crate::scene::{Hit, Projection, Scene};
use crate::shape::SurfacePoint;
use crate::spectrum::Curve;

/// Camera rays along each side of the image.
const GRID_SIDE: u32 = 24;
/// Maximum number of surfaces that turn a path, and of all surfaces on it.
const MAX_BOUNCES: usize = 6;
const MAX_SURFACES: usize = 64;
/// Number of places seen by the camera that another place is tested against.
const OTHER_PLACES: u32 = 4;

/// One side of an opaque surface.
pub(super) struct SurfaceSide {
    pub(super) point: SurfacePoint,
    /// Unit normal on that side.
    pub(super) normal: DVec3,
    pub(super) object: u32,
}

/// The places on a few paths from the camera, and the number of rays traced.
pub(super) struct View<'a> {
    pub(super) scene: &'a Scene<Curve>,
    /// The places where paths from the camera hit surfaces.
    pub(super) places: Vec<SurfaceSide>,
    /// Rays traced so far.
    pub(super) rays: Cell<u64>,
    occluder: Cell<Option<u32>>,
}

impl<'a> View<'a> {
    pub(super) fn new(scene: &'a Scene<Curve>) -> Self {
        Self { scene, places: Vec::new(), rays: Cell::new(0), occluder: Cell::new(None) }
    }

    /// Follows the camera's rays, in an order that soon covers the image, until `found` returns `true` for the places
    /// on one of them.
    pub(super) fn look(&mut self, mut found: impl FnMut(&Self, &[SurfaceSide]) -> bool) {
        // A stride that is coprime to the number of rays visits them all.
        for i in (0..GRID_SIDE * GRID_SIDE).map(|i| (i * 229) % (GRID_SIDE * GRID_SIDE)) {
            let mut places = Vec::new();
            self.walk(true, self.camera_ray(i), &Sampler::new(1, [i, 0], 0), |place| {
                places.push(place);
                false
            });
            let is_done = found(self, &places);
            self.places.append(&mut places);
            if is_done {
                return;
            }
        }
    }

    /// Follows a ray over surfaces that scatter evenly or mirror. `met` receives each of them and ends the walk by
    /// returning `true`, which is then the result. A camera ray passes straight through what the camera does not see.
    pub(super) fn walk(
        &self,
        is_camera: bool,
        mut ray: Ray,
        sampler: &Sampler,
        mut met: impl FnMut(SurfaceSide) -> bool,
    ) -> bool {
        let (mut key, mut bounces) = (BranchKey::CAMERA, 0);
        for _ in 0..MAX_SURFACES {
            self.rays.set(self.rays.get() + 1);
            let is_camera_ray = is_camera && bounces == 0;
            let hit = if is_camera_ray { self.scene.intersect_seen(&ray, None) } else { self.scene.intersect(&ray) };
            let Some(hit) = hit else { return false };
            let point = self.scene.objects[hit.object as usize].point(&ray, &hit.intersection);
            let material = self.scene.material_of(hit.object);
            let [u, v, pass, _] = sampler.get_random_4d(key, 0);
            key = key.child(0);
            if !self.is_opaque(hit.object) && (!material.lobes().is_wide() || pass < 0.5) {
                ray = point.leave(ray.direction);
                continue;
            }
            let normal = if point.normal.dot(ray.direction) < 0.0 { point.normal } else { -point.normal };
            bounces += 1;
            if met(SurfaceSide { point, normal, object: hit.object }) {
                return true;
            }
            if bounces == MAX_BOUNCES || matches!(material, Material::Emissive(_)) {
                return false;
            }
            let direction = match material.lobes().is_wide() {
                true => sample_cosine_about(normal, [u, v]),
                false => reflect(-ray.direction, normal),
            };
            ray = point.leave(direction);
        }
        false
    }

    /// Returns one of the rays of a grid over the image, counted row by row.
    fn camera_ray(&self, number: u32) -> Ray {
        let film = self.scene.film;
        let at = |i: u32, size: u32| (f64::from(i) + 0.5) * f64::from(size) / f64::from(GRID_SIDE);
        self.scene.camera.ray(DVec2::new(at(number % GRID_SIDE, film.width), at(number / GRID_SIDE, film.height)))
    }

    /// Returns what each ray of the grid over the image hits first.
    fn first_hits(&self) -> impl Iterator<Item = Option<(Ray, Hit)>> {
        (0..GRID_SIDE * GRID_SIDE).map(|i| {
            let ray = self.camera_ray(i);
            Some((ray, self.scene.intersect_seen(&ray, None)?))
        })
    }

    /// Returns the objects that the rays of the grid over the image hit first, each with whether its back was hit.
    pub(super) fn first_objects(&self) -> impl Iterator<Item = Option<(u32, bool)>> {
        self.first_hits().map(|met| {
            let (ray, hit) = met?;
            let point = self.scene.objects[hit.object as usize].point(&ray, &hit.intersection);
            Some((hit.object, point.normal.dot(ray.direction) > 0.0))
        })
    }

    /// Returns the depths at which the rays of the grid over the image first hit something.
    pub(super) fn depths(&self) -> impl Iterator<Item = f64> {
        let depth = |(ray, hit): (Ray, Hit)| self.scene.camera.depth(ray.origin + ray.direction * hit.intersection.t);
        self.first_hits().flatten().map(depth)
    }

    /// Returns whether light never crosses an object.
    fn is_opaque(&self, object: u32) -> bool {
        let material = self.scene.material_of(object);
        !material.lobes().is_transmissive() && !material.is_see_through()
    }

    pub(super) fn is_occluded(&self, ray: &Ray, distance: f64, light: Option<u32>) -> bool {
        self.rays.set(self.rays.get() + 1);
        self.scene.is_occluded_by(ray, distance, light, &self.occluder, &|object| self.is_opaque(object))
    }

    /// Returns whether the camera, or one of a few places on its paths, sees a place.
    pub(super) fn is_seen(&self, place: &SurfaceSide, number: u32) -> bool {
        let from = place.point.position;
        let to_camera = match self.scene.camera.projection() {
            Projection::Orthographic { .. } => self.scene.camera.see(from, [0.5; 2]).map(|seen| seen.start),
            _ => Some(self.scene.camera.position()),
        };
        if to_camera.is_some_and(|to| self.is_unoccluded(place, to)) {
            return true;
        }
        let chosen =
            (0..OTHER_PLACES).map(|i| &self.places[((number * OTHER_PLACES + i) * 7919) as usize % self.places.len()]);
        chosen.into_iter().any(|other| {
            let back = from - other.point.position;
            other.normal.dot(back) > 0.0 && self.is_unoccluded(place, other.point.leave(back).origin)
        })
    }

    /// Returns whether a place on a lamp is visible in the image.
    pub(super) fn is_in_view(&self, place: &SurfaceSide) -> bool {
        let Some(seen) = self.scene.camera.see(place.point.position, [0.5; 2]) else { return false };
        let size = DVec2::new(self.scene.film.width.into(), self.scene.film.height.into());
        let inside = seen.film.cmpge(DVec2::ZERO).all() && seen.film.cmple(size).all();
        inside && self.is_unoccluded(place, seen.start)
    }

    /// Returns whether the image may show an object that lies between the rays of the grid: the box of an object
    /// reaches into the image or lies around the camera, or a ray through a corner of the image hits something.
    pub(super) fn may_miss_an_object(&self) -> bool {
        let Scene { camera, film, objects, .. } = self.scene;
        let size = DVec2::new(film.width.into(), film.height.into());
        let overlaps_image = |bounds: Bounds| {
            let corner = |i: u32| {
                let upper = |axis: u32| if i >> axis & 1 == 0 { bounds.min } else { bounds.max };
                DVec3::new(upper(0).x, upper(1).y, upper(2).z)
            };
            let seen: Vec<DVec2> = (0..8).filter_map(|i| Some(camera.see(corner(i), [0.5; 2])?.film)).collect();
            let low = seen.iter().copied().fold(DVec2::INFINITY, DVec2::min);
            let high = seen.iter().copied().fold(DVec2::NEG_INFINITY, DVec2::max);
            let is_partly_seen = !seen.is_empty() && seen.len() < 8;
            is_partly_seen || (low.cmple(size).all() && high.cmpge(DVec2::ZERO).all())
        };
        let corners = [DVec2::ZERO, DVec2::new(size.x, 0.0), DVec2::new(0.0, size.y), size];
        let seen = (0..objects.len()).filter(|&object| self.scene.is_seen(object as u32));
        seen.filter_map(|object| objects[object].shape.bounds()).any(overlaps_image)
            || corners.iter().any(|&corner| self.scene.intersect_seen(&camera.ray(corner), None).is_some())
    }

    /// Returns whether nothing opaque lies between a place and a point in front of it.
    fn is_unoccluded(&self, place: &SurfaceSide, to: DVec3) -> bool {
        let above = to - place.point.position;
        if above.dot(place.normal) <= 0.0 {
            return false;
        }
        let origin = place.point.leave(above).origin;
        let offset = to - origin;
        let Some(direction) = offset.try_normalize() else { return true };
        !self.is_occluded(&Ray { origin, direction }, offset.length(), None)
    }
}

impl SurfaceSide {
    /// Returns whether this side of the surface is where the light shines.
    pub(super) fn shines(&self, light: &Light<Curve>) -> bool {
        let front = self.point.normal.dot(self.normal) > 0.0;
        matches!(light, Light::Area(area) if area.object == self.object && area.sides.shine(front))
    }
}
