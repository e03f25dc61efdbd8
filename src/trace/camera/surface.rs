//! A surface that a path from the camera has hit, and how the path leaves it.

use crate::film::FirstSurface;
use crate::trace::media::Boundary;
use crate::trace::walk::{Interaction, PassThrough, Path, Polarization, SurfaceHit};

/// What passes through a surface, if anything does.
pub type Transmitted<const N: usize, P> = Option<PassThrough<N, P>>;

/// A surface that a path has hit.
pub struct Surface<'m, const N: usize, P> {
    pub surface_hit: &'m SurfaceHit,
    pub boundary: Boundary,
    /// What passes through the surface.
    pub transmitted: Option<&'m PassThrough<N, P>>,
    /// What the camera ray hits, unless it has hit something before.
    pub first: Option<FirstHit>,
    /// Probability with which the path continued from it and not through its holes. The throughput was divided by this.
    pub chance: f64,
}

impl<const N: usize, P: Polarization<N>> Surface<'_, N, P> {
    /// Returns the share of the camera sample for which the surface is the first: `unfiltered` times the weight there.
    pub fn share(&self, path: &Path<N, P>, interaction: &Interaction<N>, first: FirstSurface, unfiltered: f64) -> f64 {
        if first == FirstSurface::Met {
            return f64::from(u8::from(self.first == Some(FirstHit::Here)));
        }
        let is_smooth = interaction.lobes.has_delta() && !interaction.lobes.is_wide();
        if !path.is_seen || is_smooth {
            return 0.0;
        }
        let draw = interaction.context.draw;
        let shares = draw.shares(path.parted);
        let share_of = |transmitted: &PassThrough<N, P>| {
            path.throughput.through(transmitted.straight.share()).weight(shares) / path.eta_scale
        };
        // A surface covers what does not go through its holes, even if the whole path continued from it by a random
        // choice.
        let received = self.chance * path.weight(draw);
        unfiltered * (received - self.transmitted.map_or(0.0, share_of)) / draw.siblings(path.parted)
    }
}

/// How a path leaves a surface.
#[derive(Clone, Copy)]
pub struct PathContinuation<'m, const N: usize, P> {
    /// What passes through.
    pub transmitted: Option<&'m PassThrough<N, P>>,
    /// Whether what passes through is always followed, because the camera ray hits something behind the holes.
    pub must_pass: bool,
    /// Whether photons are gathered.
    pub gathers: bool,
}

/// What the camera ray hits, of a surface with holes and what is behind it.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum FirstHit {
    Here,
    Beyond,
}
