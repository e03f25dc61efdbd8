//! Which clear bodies a ray is inside of.

use crate::light::{Light, LightId};
use crate::material::{Dielectric, Index};
use crate::math::{DVec3, Frame, Ray, unit};
use crate::scene::{MaterialId, Scene};
use crate::shape::{Plane, Shape, SurfacePoint};
use crate::spectrum::{Draw, Lanes, Table};

/// Maximum number of different media that may overlap in one place: a lens of varying index is made of many shells.
pub const MAX_MEDIA: usize = 16;

/// The media around a point, each with the number of its bodies around the point.
///
/// If there are several, the medium of highest priority is really there (Schmidt & Budge 2002, *Simple Nested
/// Dielectrics in Ray Traced Images*). Counting by material lets one body be made of many objects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Media {
    materials: [MaterialId; MAX_MEDIA],
    counts: [u16; MAX_MEDIA],
    len: u8,
}

/// A predicate that tells whether an object counts.
type ObjectFilter<'a> = &'a dyn Fn(u32) -> bool;

/// The change of a ray's media where it crosses a surface.
#[derive(Clone, Copy)]
pub(super) struct Boundary {
    /// The medium on the side that the ray comes from; `None` is vacuum.
    pub(super) here: Option<MaterialId>,
    /// The medium that it enters if it crosses the surface.
    pub(super) beyond: Option<MaterialId>,
    /// The body that it then enters or leaves; `None` if the media around it stay the same.
    change: Option<MediumChange>,
}

/// A body that a ray enters or leaves.
#[derive(Clone, Copy)]
struct MediumChange {
    material: MaterialId,
    enters: bool,
}

impl Boundary {
    /// Returns the medium that the ray comes from, and the one that it enters if it crosses the surface.
    pub(super) fn sides(&self) -> [Option<MaterialId>; 2] {
        [self.here, self.beyond]
    }
}

impl Media {
    /// Finds the media around a point. A straight walk from the point to infinity leaves every body around the point
    /// more often than it enters it. This does not hold for half spaces, which may reach to infinity. They are counted
    /// by the planes that the point lies behind.
    pub(super) fn around(scene: &Scene<Table>, start: DVec3, direction: DVec3) -> Self {
        Self::around_among(scene, start, direction, &|_| true)
    }

    /// Finds the media around a point, among the objects that count. The straight walk starts near `direction`.
    pub(super) fn around_among(scene: &Scene<Table>, start: DVec3, direction: DVec3, counts: ObjectFilter) -> Self {
        let is_bounded = |object: u32| scene.objects[object as usize].shape.is_bounded() && counts(object);
        let balance = Self::exit_balance(scene, start, perturbed(direction), &is_bounded);
        let mut media = Self::default();
        for (material, count) in balance.into_iter().filter(|(_, count)| *count > 0) {
            media = media.with(material, count as u32);
        }
        for (material, count) in half_spaces_around(scene, start, direction, counts) {
            media = media.with(material, count);
        }
        media
    }

    /// Returns how much more often a walk to infinity leaves bodies of each medium than it enters them.
    fn exit_balance(
        scene: &Scene<Table>,
        start: DVec3,
        direction: DVec3,
        counts: ObjectFilter,
    ) -> Vec<(MaterialId, i32)> {
        let mut balance: Vec<(MaterialId, i32)> = Vec::new();
        for MediumChange { material, enters } in medium_changes(scene, Ray { origin: start, direction }, None, counts) {
            let step = if enters { -1 } else { 1 };
            match balance.iter_mut().find(|(known, _)| *known == material) {
                Some((_, count)) => *count += step,
                None => balance.push((material, step)),
            }
        }
        balance
    }

    /// Returns the media after a straight walk from one point to another, through the objects that count.
    pub(super) fn after_walk(self, scene: &Scene<Table>, [from, to]: [DVec3; 2], counts: ObjectFilter) -> Self {
        let Some(direction) = (to - from).try_normalize() else { return self };
        medium_changes(scene, Ray { origin: from, direction }, Some(to), counts).fold(self, Self::after_change)
    }

    /// Returns the medium that is really there.
    pub(super) fn inside(&self, scene: &Scene<Table>) -> Option<MaterialId> {
        strongest(scene, self.materials[..self.len as usize].iter().copied())
    }

    /// Returns the boundary where a ray crosses a body's surface; `None` if it never entered the body, or if there is
    /// no room for another medium.
    fn boundary(&self, scene: &Scene<Table>, material: MaterialId, enters: bool) -> Option<Boundary> {
        let (here, slot) = (self.inside(scene), self.slot(material));
        let beyond = if enters {
            let has_room = slot.map_or((self.len as usize) < MAX_MEDIA, |slot| self.counts[slot] < u16::MAX);
            has_room.then(|| strongest(scene, here.into_iter().chain([material])))?
        } else if self.counts[slot?] > 1 || here != Some(material) {
            here
        } else {
            let others = self.materials[..self.len as usize].iter().copied();
            strongest(scene, others.filter(|other| *other != material))
        };
        Some(Boundary { here, beyond, change: Some(MediumChange { material, enters }) })
    }

    /// Returns the media behind a boundary of these media.
    pub(super) fn after_crossing(self, boundary: &Boundary) -> Self {
        boundary.change.map_or(self, |change| self.after_change(change))
    }

    /// Returns the media behind the surface of a body; unchanged if the surface does not fit them.
    fn after_change(self, MediumChange { material, enters }: MediumChange) -> Self {
        if enters { self.after_entering(material) } else { self.after_leaving(material) }.unwrap_or(self)
    }

    /// Returns the boundary where a ray of this direction crosses a surface of any material, which may bound no medium.
    /// Also returns whether the surface fits the media around the ray.
    pub(super) fn at_surface(
        &self,
        scene: &Scene<Table>,
        material: MaterialId,
        point: &SurfacePoint,
        direction: DVec3,
    ) -> (Boundary, bool) {
        let (here, enters) = (self.inside(scene), point.normal.dot(direction) < 0.0);
        let same = Boundary { here, beyond: here, change: None };
        if scene.materials[material as usize].material.medium().is_none() {
            return (same, true);
        }
        self.boundary(scene, material, enters).map_or((same, false), |boundary| (boundary, true))
    }

    /// Returns these media combined with others.
    pub(super) fn combined_with(self, others: &Self) -> Self {
        let entries = others.materials.iter().zip(&others.counts).take(others.len as usize);
        entries.fold(self, |media, (&material, &count)| media.with(material, count.into()))
    }

    /// Returns these media with `count` more bodies of one medium, or as many as there is room for.
    fn with(self, material: MaterialId, count: u32) -> Self {
        (0..count).fold(self, |media, _| media.after_entering(material).unwrap_or(media))
    }

    fn after_entering(mut self, material: MaterialId) -> Option<Self> {
        let len = self.len as usize;
        match self.slot(material) {
            Some(slot) => self.counts[slot] = self.counts[slot].checked_add(1)?,
            None if len < MAX_MEDIA => {
                (self.materials[len], self.counts[len]) = (material, 1);
                self.len += 1;
            }
            None => return None,
        }
        Some(self)
    }

    fn after_leaving(mut self, material: MaterialId) -> Option<Self> {
        let len = self.len as usize;
        let slot = self.slot(material)?;
        self.counts[slot] -= 1;
        if self.counts[slot] == 0 {
            self.materials.copy_within(slot + 1..len, slot);
            self.counts.copy_within(slot + 1..len, slot);
            (self.materials[len - 1], self.counts[len - 1]) = (0, 0);
            self.len -= 1;
        }
        Some(self)
    }

    fn slot(&self, material: MaterialId) -> Option<usize> {
        self.materials[..self.len as usize].iter().position(|known| *known == material)
    }
}

/// Maximum number of surfaces that a straight walk crosses. A longer walk is taken to be endless.
const MAX_CROSSINGS: usize = 100_000;

/// Lists the clear bodies that a straight walk to a point or to infinity enters and leaves, among the objects that
/// count.
fn medium_changes(
    scene: &Scene<Table>,
    mut ray: Ray,
    to: Option<DVec3>,
    counts: ObjectFilter,
) -> impl Iterator<Item = MediumChange> {
    let is_of_body = move |object: u32| scene.material_of(object).medium().is_some() && counts(object);
    let surfaces = std::iter::from_fn(move || {
        let remaining_distance = to.map_or(f64::INFINITY, |to| (to - ray.origin).dot(ray.direction));
        let hit = scene.nearest(&ray, f64::INFINITY, &is_of_body);
        let hit = hit.filter(|hit| hit.intersection.t <= remaining_distance)?;
        let object = &scene.objects[hit.object as usize];
        let point = object.shape.point(&ray, &hit.intersection);
        let enters = point.normal.dot(ray.direction) < 0.0;
        ray = point.leave(ray.direction);
        Some(MediumChange { material: object.material, enters })
    });
    surfaces.take(MAX_CROSSINGS)
}

/// Returns how many half spaces of each medium a point lies in, among the planes that count.
///
/// Two planes that face away from each other bound a slab. Every point is behind at least one of them, so that one does
/// not count. The number of half spaces around a point at infinity is therefore subtracted: the smallest of those
/// forward, backward, and in the mean direction that the planes of the medium face.
fn half_spaces_around(
    scene: &Scene<Table>,
    start: DVec3,
    direction: DVec3,
    counts: ObjectFilter,
) -> Vec<(MaterialId, u32)> {
    let mut planes: Vec<(MaterialId, Vec<&Plane>)> = Vec::new();
    for (number, object) in scene.unbounded().filter(|(number, _)| counts(*number)) {
        let is_medium = scene.material_of(number).medium().is_some();
        let Shape::Plane(plane) = &*object.shape else { continue };
        match planes.iter_mut().find(|(known, _)| *known == object.material) {
            _ if !is_medium => {}
            Some((_, others)) => others.push(plane),
            None => planes.push((object.material, vec![plane])),
        }
    }
    let count = |planes: &[&Plane]| {
        let count_around = |way: DVec3| planes.iter().filter(|plane| plane.normal().dot(perturbed(way)) < 0.0).count();
        let mean_normal = planes.iter().map(|plane| plane.normal()).sum::<DVec3>().try_normalize();
        let least = [Some(direction), Some(-direction), mean_normal].into_iter().flatten().map(count_around).min();
        planes.iter().filter(|plane| plane.is_behind(start)).count().saturating_sub(least.unwrap_or(0)) as u32
    };
    planes.into_iter().map(|(material, planes)| (material, count(&planes))).filter(|(_, count)| *count > 0).collect()
}

/// Returns which of several media in one place is really there.
fn strongest(scene: &Scene<Table>, media: impl Iterator<Item = MaterialId>) -> Option<MaterialId> {
    media.max_by_key(|material| (medium(scene, *material).priority, *material))
}

/// Returns a unit vector near another. A direction given by a scene, toward what the camera looks at or straight up,
/// may lead exactly to a corner of an outline. It is hit once where a body is entered and left, or not.
fn perturbed(direction: DVec3) -> DVec3 {
    unit(Frame::about(direction).to_world(DVec3::new(7.31e-4, 4.19e-4, 1.0)))
}

/// Returns the dielectric that fills a medium.
pub(super) fn medium(scene: &Scene<Table>, material: MaterialId) -> &Dielectric<Table> {
    scene.materials[material as usize].material.medium().expect("only dielectrics become media")
}

/// Returns the refractive index of a medium, per lane; 1 in vacuum.
pub(super) fn index<const N: usize>(scene: &Scene<Table>, draw: &Draw<N>, inside: Option<MaterialId>) -> [f64; N] {
    match inside {
        Some(material) => draw.read_exact(&medium(scene, material).index),
        None => [1.0; N],
    }
}

/// Returns the factor from radiance in the second medium to radiance in the first, per lane: radiance is proportional
/// to the square of the index.
pub(super) fn radiance_factor<const N: usize>(
    scene: &Scene<Table>,
    draw: &Draw<N>,
    sides: [Option<MaterialId>; 2],
) -> Lanes<N> {
    let [here, there] = sides.map(|side| index(scene, draw, side));
    Lanes::from_fn(|lane| {
        let ratio = here[lane] / there[lane];
        (ratio * ratio) as f32
    })
}

/// Returns the refractive index of a medium without reading it for any lane; 1 in vacuum.
pub(super) fn index_around(scene: &Scene<Table>, inside: Option<MaterialId>) -> Index<'_> {
    match inside.map(|material| &medium(scene, material).index) {
        Some(table) if table.is_flat() => Index::Same(table.bins()[0]),
        Some(table) => Index::Own(table),
        None => Index::Same(1.0),
    }
}

/// Returns the index by which all rays are refracted on each side of a surface; `None` if each lane has its own.
///
/// Shares are exact where media have flat faces, and no lane loses or gains light anywhere. Two effects are neglected.
/// A lane travels as far inside as the ray. A surface that scatters widely there receives light from outside over the
/// ray's solid angle, which is (n / d)^2 of the light of a lane of index n if the ray has index d.
pub(super) fn direction_indices(scene: &Scene<Table>, sides: [Option<MaterialId>; 2]) -> [Option<f64>; 2] {
    let tables = sides.map(|side| side.map(|material| &medium(scene, material).index));
    if tables.iter().flatten().all(|table| table.direction().is_none()) {
        return [None; 2];
    }
    tables.map(|table| match table {
        Some(table) => table.direction().or_else(|| table.is_flat().then(|| table.bins()[0])),
        None => Some(1.0),
    })
}

/// Returns whether there are more media than may overlap in one place.
pub(super) fn has_too_many(scene: &Scene<Table>) -> bool {
    scene.materials.iter().filter(|named| named.material.medium().is_some()).nth(MAX_MEDIA).is_some()
}

/// Returns the bodies around each light; `None` where they may differ from point to point.
pub(super) fn media_of_lights(scene: &Scene<Table>) -> Vec<Option<Media>> {
    (0..scene.lights.len()).map(|light| media_of(scene, light)).collect()
}

/// Returns the bodies around a light; `None` if they may differ from point to point.
fn media_of(scene: &Scene<Table>, light: LightId) -> Option<Media> {
    if scene.materials.iter().all(|named| named.material.medium().is_none()) {
        return Some(Media::default());
    }
    match &scene.lights[light] {
        Light::Point(point) => Some(Media::around(scene, point.position.into(), DVec3::Y)),
        Light::Spot(spot) => Some(Media::around(scene, spot.position.into(), DVec3::Y)),
        Light::Area(area) => {
            let light_bounds = area.shape.bounds()?;
            let clear = (0..scene.objects.len()).filter(|&i| scene.material_of(i as u32).medium().is_some());
            let is_outside = clear.map(|i| scene.objects[i].shape.bounds()).all(|other| {
                other.is_some_and(|other| {
                    light_bounds.max.cmplt(other.min).any() || light_bounds.min.cmpgt(other.max).any()
                })
            });
            is_outside.then(Media::default)
        }
        Light::Sun(_) | Light::Environment(_) => Some(Media::default()),
    }
}
