use crate::math::Ray;
use crate::shape::{Bvh, Shape};

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
}

impl Index {
    pub(super) fn new<'a>(shapes: impl Iterator<Item = &'a Shape>) -> Self {
        let (mut always, mut bounded, mut bounds) = (Vec::new(), Vec::new(), Vec::new());
        for (object, shape) in shapes.enumerate() {
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
        Self { always, tree: Bvh::new(&bounds), bounded }
    }

    /// Calls `test(object, t_max)` for every object the ray may meet before `t_max`.
    ///
    /// `test` answers the new `t_max`, or none to end the walk.
    #[inline]
    pub(super) fn walk(&self, ray: &Ray, mut t_max: f64, mut test: impl FnMut(u32, f64) -> Option<f64>) {
        for &object in &self.always {
            match test(object, t_max) {
                Some(nearer) => t_max = nearer,
                None => return,
            }
        }
        self.tree.walk(ray, t_max, |item, limit| test(self.bounded[item as usize], limit));
    }
}
