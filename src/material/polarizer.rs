use super::{Block, Mueller, ScatterContext, Straight};
use crate::math::DVec3;
use crate::spectrum::Lanes;

/// A sheet that lets light through which is polarized along its axis. Light goes straight on, as through `thin`.
///
/// What it absorbs is the field along its other axis, across the normal and the first one: light that meets the sheet
/// aslant is let through along the direction across the ray and that one (a sheet of dichroic molecules: Korger et al.
/// 2013, *The Polarization Properties of a Tilted Polarizer*). Where its axis is along the normal, no direction is
/// favored and what gets through is unpolarized.
///
/// ```toml
/// polarizer = { axis = [1, 0, 0] }     # in the object's space, before its transform; extinction = 0 if absent
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polarizer {
    /// The direction that it lets through, of any length.
    pub axis: DVec3,
    /// What it lets through of light across its axis, 0 to 1.
    pub extinction: f64,
}

impl Polarizer {
    /// What goes straight on.
    pub(super) fn straight<const N: usize>(&self) -> Straight<N> {
        let panes = Lanes([(0.5 * (1.0 + self.extinction)) as f32; N]);
        let polarization = ((1.0 - self.extinction) / (1.0 + self.extinction)) as f32;
        Straight { holes: Lanes::ZERO, panes, polarization }
    }

    pub(super) fn mueller<const N: usize>(&self, context: &ScatterContext<N>, mueller: &mut Mueller<N>) {
        match let_through(context, self.axis) {
            Some(axis) => mueller.set_lanes(axis, context.present.not_zero(), |_| Block::of_polarizer(self.extinction)),
            None => *mueller = Mueller::NONE,
        }
    }
}

/// Across a ray and the axis of a sheet that lies across another one; none where that one is along the normal.
pub(super) fn let_through<const N: usize>(context: &ScatterContext<N>, axis: DVec3) -> Option<DVec3> {
    let other = context.normal.cross(axis.try_normalize()?).try_normalize()?;
    other.cross(context.wo).try_normalize()
}
