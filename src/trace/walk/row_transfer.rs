//! The ways in which light leaves a surface, and how rows of Stokes weights change along them.

use super::row_change::Change;
use crate::material::Mueller;
use crate::math::DVec3;
use crate::spectrum::{LaneSet, Lanes};

/// One way in which light leaves a surface.
pub struct Exitant<const N: usize> {
    /// The part of unpolarized light that leaves.
    pub value: Lanes<N>,
    /// The lanes that leave this way.
    pub lanes: LaneSet,
    /// The direction of the light on both sides of the surface: toward the viewer, and before it arrives.
    pub z: [DVec3; 2],
}

impl<const N: usize> Exitant<N> {
    /// Returns this way, followed forward: the light then comes from the viewer.
    pub fn reversed(self) -> Self {
        let [to, from] = self.z;
        Self { z: [-from, -to], ..self }
    }
}

/// How rows change along a branch.
#[derive(Debug)]
pub struct RowTransfer<const N: usize> {
    /// Whether any polarization is left. If not, nothing but `change.x` has a meaning.
    pub is_polarized: bool,
    pub mueller: Mueller<N>,
    pub change: Change<N>,
    /// The unit normal of the plane at which a shading normal folds the light.
    pub fold_plane: Option<DVec3>,
    /// Light that is folded into a direction to which light also comes unfolded.
    pub folded_light: Option<Box<FoldedLight<N>>>,
}

/// How rows change by light that is folded into the direction of other light.
#[derive(Debug)]
pub struct FoldedLight<const N: usize> {
    pub mueller: Mueller<N>,
    pub change: Change<N>,
    /// The parts that leave of the path's light: of the other light, and of the folded light.
    pub lights: [Lanes<N>; 2],
}

impl<const N: usize> RowTransfer<N> {
    pub fn new() -> Self {
        Self { is_polarized: false, mueller: Mueller::NONE, change: Change::NONE, fold_plane: None, folded_light: None }
    }
}
