//! A surface that a path from the camera has met, and how the path leaves it.

use crate::trace::media::Boundary;
use crate::trace::walk::{PassThrough, SurfaceHit};

/// What goes straight on through a surface, if anything does.
pub type Through<const N: usize, P> = Option<PassThrough<N, P>>;

/// A surface that a path has met.
pub struct Surface<'m, const N: usize, P> {
    pub surface_hit: &'m SurfaceHit,
    pub boundary: Boundary,
    /// What goes straight on.
    pub through: Option<&'m PassThrough<N, P>>,
    /// What the camera ray meets, unless it has met something before.
    pub first: Option<FirstMet>,
    /// How likely the path went on from it and not through its holes, if that was left to chance: its throughput is
    /// divided by this.
    pub chance: f64,
}

/// How a path leaves a surface.
#[derive(Clone, Copy)]
pub struct PathContinuation<'m, const N: usize, P> {
    /// What goes straight on.
    pub through: Option<&'m PassThrough<N, P>>,
    /// Whether that is followed for certain: behind the surface's holes the camera ray meets something.
    pub is_awaited: bool,
    /// Whether photons are gathered.
    pub gathers: bool,
}

/// Of a surface with holes and what is behind them, what the camera ray meets.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum FirstMet {
    Here,
    Beyond,
}
