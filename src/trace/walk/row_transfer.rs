//! Ways by which light leaves a surface, and what becomes of rows of Stokes weights along them.

use super::change::Change;
use crate::material::Mueller;
use crate::math::DVec3;
use crate::spectrum::{LaneSet, Lanes};

/// One way by which light leaves a surface.
pub struct Exitant<const N: usize> {
    /// What leaves of unpolarized light.
    pub value: Lanes<N>,
    /// The lanes that do.
    pub lanes: LaneSet,
    /// The direction of the light on both sides of the surface, to the viewer and before it arrives.
    pub z: [DVec3; 2],
}

impl<const N: usize> Exitant<N> {
    /// The same followed forward: the light's source is the viewer.
    pub fn turned_back(self) -> Self {
        let [to, from] = self.z;
        Self { z: [-from, -to], ..self }
    }
}

/// What becomes of rows along a branch.
#[derive(Debug)]
pub struct RowTransfer<const N: usize> {
    /// Whether any polarization is left: what there is beside `change.x` otherwise has no meaning.
    pub is_any_left: bool,
    pub mueller: Mueller<N>,
    pub change: Change<N>,
    /// The unit normal of the plane at which a shading normal folds the light.
    pub folded_at: Option<DVec3>,
    /// What comes folded to a direction to which light comes straight as well.
    pub folded_light: Option<Box<FoldedTransport<N>>>,
}

/// What becomes of rows by light that is folded to the direction of other light.
#[derive(Debug)]
pub struct FoldedTransport<const N: usize> {
    pub mueller: Mueller<N>,
    pub change: Change<N>,
    /// What leaves of the path's light: of the other light, and of this one.
    pub lights: [Lanes<N>; 2],
}

impl<const N: usize> RowTransfer<N> {
    pub fn new() -> Self {
        Self { is_any_left: false, mueller: Mueller::NONE, change: Change::NONE, folded_at: None, folded_light: None }
    }
}
