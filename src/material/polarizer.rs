use super::{Block, Mueller, ScatterContext, Straight};
use crate::math::DVec3;
use crate::spectrum::Lanes;

/// A sheet that transmits light that is polarized along its axis. Light passes straight through, as in `thin`.
///
/// The sheet absorbs the field along its other axis, which is perpendicular to the normal and to the first one. At
/// oblique incidence it transmits the field along the direction perpendicular to the ray and to that other axis (a
/// sheet of dichroic molecules: Korger et al. 2013, *The Polarization Properties of a Tilted Polarizer*). If its axis
/// is along the normal, no direction is favored and the transmitted light is unpolarized.
///
/// ```toml
/// polarizer = { axis = [1, 0, 0] }     # in the object's space, before its transform; extinction = 0 if absent
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polarizer {
    /// The direction of the field that it transmits, of any length.
    pub axis: DVec3,
    /// Share transmitted of light polarized across its axis, 0 to 1.
    pub extinction: f64,
}

impl Polarizer {
    /// Returns the share that passes straight through.
    pub(super) fn straight<const N: usize>(&self) -> Straight<N> {
        let panes = Lanes([(0.5 * (1.0 + self.extinction)) as f32; N]);
        let polarization = ((1.0 - self.extinction) / (1.0 + self.extinction)) as f32;
        Straight { holes: Lanes::ZERO, panes, polarization }
    }

    pub(super) fn mueller<const N: usize>(&self, context: &ScatterContext<N>, mueller: &mut Mueller<N>) {
        match projected_axis(context, self.axis) {
            Some(axis) => mueller.set_lanes(axis, context.present.nonzero(), |_| Block::of_polarizer(self.extinction)),
            None => *mueller = Mueller::NONE,
        }
    }
}

/// Returns the direction perpendicular to the ray and to the sheet's other axis, which is perpendicular to `axis` and
/// the normal. Returns None if `axis` is along the normal.
pub(super) fn projected_axis<const N: usize>(context: &ScatterContext<N>, axis: DVec3) -> Option<DVec3> {
    let other = context.normal.cross(axis.try_normalize()?).try_normalize()?;
    other.cross(context.wo).try_normalize()
}
