use crate::math::Ray;
use crate::shape::{Bvh, Pool, Shape, Vectors, Visitor};

/// Objects up to this many are tried one by one: a tree saves nothing there.
const FEW: usize = 12;

/// Finds the objects a ray may meet.
#[derive(Clone, Debug)]
pub(super) struct Index {
    /// Objects to try always: infinite ones, or all of a few.
    always: Vec<u32>,
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
        let (mut always, mut bounded, mut bounds) = (Vec::new(), Vec::new(), Vec::new());
        for (object, shape) in shapes.enumerate().filter(|(_, shape)| !(pools && Pool::takes(shape))) {
            match shape.bounds() {
                Some(boxed) => {
                    bounded.push(object as u32);
                    bounds.push(boxed);
                }
                None => always.push(object as u32),
            }
        }
        if bounded.len() <= FEW {
            always.append(&mut bounded);
            always.sort_unstable();
            bounds.clear();
        }
        Self { always, tree: Bvh::new::<1>(bounds.into_iter()), bounded, pool }
    }

    /// The pool of small objects.
    #[inline]
    pub(super) fn pool(&self) -> Option<&Pool> {
        self.pool.as_ref()
    }

    /// Calls `test(object, t_max)` for every object beside the pool that the ray may meet before `t_max`, nearer ones
    /// first.
    ///
    /// `test` answers the new `t_max`.
    #[inline]
    pub(super) fn nearest(&self, ray: &Ray, mut t_max: f64, mut test: impl FnMut(u32, f64) -> f64) {
        for &object in &self.always {
            t_max = test(object, t_max);
        }
        if !self.bounded.is_empty() {
            let test = |object, t_max| Some(test(object, t_max));
            self.tree.walk_in_order(ray, t_max, &mut Objects { index: self, test });
        }
    }

    /// Calls `test(object)` for objects beside the pool that the ray may meet before `t_max`, in any order, until one
    /// passes.
    #[inline]
    pub(super) fn any(&self, ray: &Ray, t_max: f64, mut test: impl FnMut(u32) -> bool) {
        if self.always.iter().any(|&object| test(object)) || self.bounded.is_empty() {
            return;
        }
        let test = |object, t_max| (!test(object)).then_some(t_max);
        self.tree.walk(ray, t_max, &mut Objects { index: self, test });
    }
}

/// Shows the objects of a leaf to a test, which answers the new `t_max`, or none to end the walk.
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
