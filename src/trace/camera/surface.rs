//! A surface that a path from the camera has met, and how the path leaves it.

use crate::trace::media::Boundary;
use crate::trace::walk::{Meeting, Onward};

/// What goes straight on through a surface, if anything does.
pub type Onwards<const N: usize, P> = Option<Onward<N, P>>;

/// A surface that a path has met.
pub struct Surface<'m, const N: usize, P> {
    pub meeting: &'m Meeting,
    pub boundary: Boundary,
    /// What goes straight on.
    pub onward: Option<&'m Onward<N, P>>,
    /// What the camera ray meets, unless it has met something before.
    pub first: Option<First>,
    /// How likely the path went on from it and not through its holes, if that was left to chance: its throughput is
    /// divided by this.
    pub chance: f64,
}

/// How a path leaves a surface.
#[derive(Clone, Copy)]
pub struct Leaving<'m, const N: usize, P> {
    /// What goes straight on.
    pub onward: Option<&'m Onward<N, P>>,
    /// Whether that is followed for certain: behind the surface's holes the camera ray meets something.
    pub is_awaited: bool,
    /// Whether photons are gathered.
    pub gathers: bool,
}

/// Of a surface with holes and what is behind them, what the camera ray meets.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum First {
    Here,
    Beyond,
}
