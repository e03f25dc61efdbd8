//! How rays find surfaces. What is asked here knows nothing of lanes or spectra, so that it is compiled once for all:
//! for all objects, and for those that a function counts.

use std::cell::Cell;

use super::hit::{Hit, Primitive, RayEnds};
use super::object::Object;
use crate::math::Ray;
use crate::shape::{Bvh, Pool, Shape, Vectors, Visitor, is_before};

/// Objects up to this many are tried one by one: a tree saves nothing there.
const FEW: usize = 12;

/// Finds the objects a ray may meet.
#[derive(Clone, Debug)]
pub(super) struct Index {
    /// Objects to try always: infinite ones, or all of a few.
    pub(super) always: Vec<u32>,
    tree: Bvh,
    /// Object of each item of the tree.
    bounded: Vec<u32>,
    /// The triangles of small objects, if there are several.
    pool: Option<Pool>,
}

impl Index {
    pub(super) fn new<'a>(shapes: impl Iterator<Item = &'a Shape> + Clone) -> Self {
        let pools = shapes.clone().filter(|shape| Pool::takes(shape)).count() > 1;
        let pool = pools.then(|| Pool::new((0..).zip(shapes.clone())));
        let own = (0..).zip(shapes).filter(|(_, shape)| !(pools && Pool::takes(shape)));
        let is_treed = own.clone().filter(|(_, shape)| shape.is_bounded()).count() > FEW;
        let (treed, always): (Vec<_>, Vec<_>) = own.partition(|(_, shape)| is_treed && shape.is_bounded());
        let mut boxes = Vec::with_capacity(treed.len());
        for (item, (_, shape)) in (0..).zip(&treed) {
            shape.boxes(treed.len(), |bounds| boxes.push((item, bounds)));
        }
        let [always, bounded] = [always, treed].map(|objects| objects.into_iter().map(|object| object.0).collect());
        Self { always, tree: Bvh::of_parts::<1>(boxes.into_iter()), bounded, pool }
    }

    /// The nearest surface along a ray up to a distance, of those objects that count; of equally near ones, that of the
    /// object listed first.
    pub(super) fn nearest(
        &self,
        objects: &[Object],
        ray: &Ray,
        distance: f64,
        left: Option<Primitive>,
        counts: impl Fn(u32) -> bool,
    ) -> Option<Hit> {
        let triangle = left.map(|left| [left.object, left.part]);
        let left = left.unwrap_or(Primitive::NONE);
        let pooled = self.pool.as_ref().and_then(|pool| pool.nearest(ray, distance, triangle, &counts));
        let mut nearest = pooled.map(|(object, intersection)| Hit { object, intersection });
        let limit = nearest.map_or(distance, |hit| hit.intersection.t);
        self.search::<true>(ray, limit, |object, limit| {
            if !counts(object) {
                return Some(limit);
            }
            let shape = &objects[object as usize].shape;
            if let Some(intersection) = shape.intersect_from(ray, limit, left.of(object)) {
                if nearest.is_none_or(|n| intersection.t < n.intersection.t || object < n.object) {
                    nearest = Some(Hit { object, intersection });
                }
                return Some(intersection.t);
            }
            Some(limit)
        });
        nearest
    }

    /// Whether any object that counts lies before a light at `distance`; the light's own does not occlude it.
    pub(super) fn is_occluded(
        &self,
        objects: &[Object],
        ray: &Ray,
        distance: f64,
        ends: RayEnds,
        last_occluder: &Cell<Option<u32>>,
        counts: impl Fn(u32) -> bool,
    ) -> bool {
        let RayEnds { left, light, part } = ends;
        // An object listed after the light's own does not hide it by an equal distance.
        let hides_at = |[object, other]: [u32; 2], t: f64| match light {
            Some(light) if light == object => part.is_some_and(|part| is_before([other, part], [t, distance])),
            _ if !counts(object) => false,
            Some(light) if light < object => t < distance,
            _ => true,
        };
        let triangle = left.map(|left| [left.object, left.part]);
        if self.pool.as_ref().is_some_and(|pool| pool.any(ray, distance, triangle, hides_at)) {
            return true;
        }
        let hides = |object: u32| {
            let shape = &objects[object as usize].shape;
            match light {
                Some(light) if light == object => part.is_some_and(|part| shape.hides(ray, part, distance)),
                _ if !counts(object) => false,
                light => {
                    let is_later = light.is_some_and(|light| light < object);
                    let t_max = if is_later { distance.next_down() } else { distance };
                    shape.is_crossed(ray, t_max, left.and_then(|left| left.of(object)))
                }
            }
        };
        let last = last_occluder.get();
        if last.is_some_and(hides) {
            return true;
        }
        let mut hidden = false;
        self.search::<false>(ray, distance, |object, limit| {
            hidden = Some(object) != last && hides(object);
            if hidden {
                last_occluder.set(Some(object));
            }
            (!hidden).then_some(limit)
        });
        hidden
    }

    /// Calls `test(object, t_max)` for objects beside the pool that the ray may meet before `t_max`, nearer ones first
    /// if `ORDERED`; `test` returns the new `t_max`, or none to end.
    #[inline]
    fn search<const ORDERED: bool>(&self, ray: &Ray, mut t_max: f64, mut test: impl FnMut(u32, f64) -> Option<f64>) {
        for &object in &self.always {
            let Some(limit) = test(object, t_max) else { return };
            t_max = limit;
        }
        if !self.bounded.is_empty() {
            self.tree.walk::<ORDERED>(ray, t_max, &mut Objects { index: self, test });
        }
    }
}

/// Counts every object.
pub(super) fn every(_: u32) -> bool {
    true
}

/// Shows the objects of a leaf to a test, which returns the new `t_max`, or none to end the walk.
struct Objects<'a, F> {
    index: &'a Index,
    test: F,
}

impl<F: FnMut(u32, f64) -> Option<f64>> Visitor for Objects<'_, F> {
    #[inline]
    fn visit(&mut self, _: impl Vectors, first: usize, groups: usize, mut t_max: f64) -> Option<f64> {
        for &item in &self.index.tree.items()[first..first + groups] {
            t_max = (self.test)(self.index.bounded[item as usize], t_max)?;
        }
        Some(t_max)
    }
}
