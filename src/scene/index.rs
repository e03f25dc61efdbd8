//! How rays find surfaces. Nothing here depends on lanes or spectra, so it is compiled once for all of them: in one
//! version for all objects, and in one for the objects that a predicate selects.

use std::cell::Cell;

use super::hit::{Hit, Primitive, RayEnds};
use super::object::Object;
use crate::math::Ray;
use crate::shape::{Bvh, Pool, Shape, Visitor, is_before};

/// Up to this many objects are tested one by one, since a tree saves nothing there.
const MAX_LINEAR_OBJECTS: usize = 12;

/// Finds the objects that a ray may hit.
#[derive(Clone, Debug)]
pub(super) struct Index {
    /// Objects that every ray tests: unbounded ones, or all of them if there are few.
    pub(super) always_tested: Vec<u32>,
    tree: Bvh,
    /// The object of each item in the tree.
    tree_objects: Vec<u32>,
    /// The triangles of all small objects, if there is more than one such object.
    pool: Option<Pool>,
}

impl Index {
    pub(super) fn new<'a>(shapes: impl Iterator<Item = &'a Shape> + Clone) -> Self {
        let has_pool = shapes.clone().filter(|shape| Pool::takes(shape)).count() > 1;
        let pool = has_pool.then(|| Pool::new((0..).zip(shapes.clone())));
        let unpooled = (0..).zip(shapes).filter(|(_, shape)| !(has_pool && Pool::takes(shape)));
        let has_tree = unpooled.clone().filter(|(_, shape)| shape.is_bounded()).count() > MAX_LINEAR_OBJECTS;
        let (in_tree, always_tested): (Vec<_>, Vec<_>) =
            unpooled.partition(|(_, shape)| has_tree && shape.is_bounded());
        let mut boxes = Vec::with_capacity(in_tree.len());
        for (item, (_, shape)) in (0..).zip(&in_tree) {
            shape.boxes(in_tree.len(), |bounds| boxes.push((item, bounds)));
        }
        let [always_tested, tree_objects] =
            [always_tested, in_tree].map(|objects| objects.into_iter().map(|object| object.0).collect());
        Self { always_tested, tree: Bvh::of_parts::<1>(boxes.into_iter()), tree_objects, pool }
    }

    /// Finds the nearest hit along a ray up to a distance, among the objects for which `accept` holds. Of equally near
    /// hits, returns that of the object listed first.
    pub(super) fn nearest(
        &self,
        objects: &[Object],
        ray: &Ray,
        distance: f64,
        start: Option<Primitive>,
        accept: impl Fn(u32) -> bool,
    ) -> Option<Hit> {
        let triangle = start.map(|start| [start.object, start.part]);
        let start = start.unwrap_or(Primitive::NONE);
        let pooled = self.pool.as_ref().and_then(|pool| pool.nearest(ray, distance, triangle, &accept));
        let mut nearest = pooled.map(|(object, intersection)| Hit { object, intersection });
        let limit = nearest.map_or(distance, |hit| hit.intersection.t);
        self.search::<true>(ray, limit, |object, limit| {
            if !accept(object) {
                return Some(limit);
            }
            let shape = &objects[object as usize].shape;
            if let Some(intersection) = shape.intersect_from(ray, limit, start.part_of(object)) {
                if nearest.is_none_or(|n| intersection.t < n.intersection.t || object < n.object) {
                    nearest = Some(Hit { object, intersection });
                }
                return Some(intersection.t);
            }
            Some(limit)
        });
        nearest
    }

    /// Returns whether an object for which `accept` holds lies before a light at `distance`. The light's own object
    /// does not occlude it, unless `ends` names one of its parts: then its other parts may.
    pub(super) fn is_occluded(
        &self,
        objects: &[Object],
        ray: &Ray,
        distance: f64,
        ends: RayEnds,
        last_occluder: &Cell<Option<u32>>,
        accept: impl Fn(u32) -> bool,
    ) -> bool {
        let RayEnds { start, light, part } = ends;
        // An object listed after the light's own does not hide it at an equal distance.
        let hides_at = |[object, other]: [u32; 2], t: f64| match light {
            Some(light) if light == object => part.is_some_and(|part| is_before([other, part], [t, distance])),
            _ if !accept(object) => false,
            Some(light) if light < object => t < distance,
            _ => true,
        };
        let triangle = start.map(|start| [start.object, start.part]);
        if self.pool.as_ref().is_some_and(|pool| pool.any(ray, distance, triangle, hides_at)) {
            return true;
        }
        let hides = |object: u32| {
            let shape = &objects[object as usize].shape;
            match light {
                Some(light) if light == object => part.is_some_and(|part| shape.hides(ray, part, distance)),
                _ if !accept(object) => false,
                light => {
                    let is_later = light.is_some_and(|light| light < object);
                    let t_max = if is_later { distance.next_down() } else { distance };
                    shape.is_crossed(ray, t_max, start.and_then(|start| start.part_of(object)))
                }
            }
        };
        let last = last_occluder.get();
        if last.is_some_and(hides) {
            return true;
        }
        let mut is_hidden = false;
        self.search::<false>(ray, distance, |object, limit| {
            is_hidden = Some(object) != last && hides(object);
            if is_hidden {
                last_occluder.set(Some(object));
            }
            (!is_hidden).then_some(limit)
        });
        is_hidden
    }

    /// Calls `test(object, t_max)` for the objects outside the pool that the ray may hit before `t_max`, nearer ones
    /// first if `ORDERED`. `test` returns the new `t_max`, or none to stop.
    #[inline]
    fn search<const ORDERED: bool>(&self, ray: &Ray, mut t_max: f64, mut test: impl FnMut(u32, f64) -> Option<f64>) {
        for &object in &self.always_tested {
            let Some(limit) = test(object, t_max) else { return };
            t_max = limit;
        }
        if !self.tree_objects.is_empty() {
            self.tree.walk::<ORDERED>(ray, t_max, &mut ObjectVisitor { index: self, test });
        }
    }
}

/// Counts every object.
pub(super) fn accept_all(_: u32) -> bool {
    true
}

/// Passes the objects of a leaf to a test, which returns the new `t_max`, or none to stop the traversal.
struct ObjectVisitor<'a, F> {
    index: &'a Index,
    test: F,
}

impl<F: FnMut(u32, f64) -> Option<f64>> Visitor for ObjectVisitor<'_, F> {
    #[inline]
    fn visit(&mut self, first: usize, groups: usize, mut t_max: f64) -> Option<f64> {
        for &item in &self.index.tree.items()[first..first + groups] {
            t_max = (self.test)(self.index.tree_objects[item as usize], t_max)?;
        }
        Some(t_max)
    }
}
