//! The energy audit of splitting: whether all of the weight that left the camera has ended somewhere.
//!
//! A camera sample starts with weight 1 in each lane, or what a filter in front of the camera leaves of it. Surfaces
//! split it into branches, media and surfaces absorb some, and the rest ends where it hits a light or leaves the scene.
//! Choosing branches and ending paths at random adds or removes weight, but 0 on average. What is left when all paths
//! have ended was lost: to a bounce limit, or to a mistake.
//!
//! A weight is a share of flux: a throughput without the factor of radiance between media, each lane by its own index.
//! What a dye absorbs counts as absorbed; the paths that look for what excites it have no weight here.
//!
//! Where lanes part for the first time, the fixed lanes hand over to the heroes. Lanes that are together and lanes that
//! have parted therefore have separate balances.

use super::interaction::Interaction;
use super::path::Path;
use super::polarization::PassThrough;
use crate::material::{Branch, Straight};
use crate::spectrum::{Draw, Lanes, Throughput};
use crate::trace::World;
use crate::trace::media::{Media, index};
use crate::trace::white::White;

/// The balance of one camera sample after another.
pub struct Audit<'a, const N: usize> {
    world: &'a World,
    /// The refractive index of each lane around the camera.
    start: [f64; N],
    /// The weight of each lane that has not ended: of lanes that are together, and of lanes that have parted.
    open: [[f64; N]; 2],
}

impl<'a, const N: usize> Audit<'a, N> {
    pub fn new(world: &'a World) -> Self {
        Self { world, start: [1.0; N], open: [[0.0; N]; 2] }
    }

    /// Begins another camera sample with its first path.
    pub fn begin<P>(&mut self, path: &Path<N, P>, draw: &Draw<N>) {
        self.start = self.indices(&path.media, draw);
        self.open = [path.throughput.of(Lanes::ONE).0.map(f64::from), [0.0; N]];
    }

    /// Records that a path has ended, except for what passes through the surface, if anything does.
    pub fn end<P>(&mut self, path: &Path<N, P>, transmitted: Option<&PassThrough<N, P>>, draw: &Draw<N>) {
        let share = transmitted.map_or(Lanes::ZERO, |transmitted| transmitted.straight.share());
        let ended = self.weight(path, path.throughput, draw);
        self.close(path.parted, &std::array::from_fn(|i| ended[i] * (1.0 - f64::from(share[i]))));
    }

    /// Records that the medium around a path has absorbed some of the throughput that it had before.
    pub fn absorb<P>(&mut self, path: &Path<N, P>, before: Throughput<N>, draw: &Draw<N>) {
        if before != path.throughput {
            let [before, after] = [before, path.throughput].map(|throughput| self.weight(path, throughput, draw));
            self.close(path.parted, &std::array::from_fn(|i| before[i] - after[i]));
        }
    }

    /// Records that a surface has split a path into branches and what passes through.
    ///
    /// A clear surface absorbs nothing: what its branches lack, or have in excess, stays open. Any other surface is
    /// taken to absorb what they lack, because no separate formula says how much that is.
    pub fn split<P>(
        &mut self,
        path: &Path<N, P>,
        interaction: &Interaction<N>,
        branches: &[Branch<N>],
        straight: Option<&Straight<N>>,
    ) {
        let (context, draw) = (&interaction.context, interaction.context.draw);
        let received = self.weight(path, path.throughput, draw);
        let clear = interaction.material.absorbs_nothing();
        let (passing_share, parting) = (straight.map_or(Lanes::ZERO, Straight::share), draw.parting());
        let mut absorbed: [f64; N] = std::array::from_fn(|i| 1.0 - f64::from(passing_share[i]));
        let mut parted = [0.0; N];
        for branch in branches {
            for lane in 0..N {
                let ratio = context.beyond_of(lane) / context.incident_of(lane);
                let share = f64::from(branch.share[lane]) * if branch.crosses { ratio * ratio } else { 1.0 };
                absorbed[lane] -= share;
                parted[lane] += if branch.crosses && interaction.is_parting { share } else { 0.0 };
            }
        }
        let is_first_parting = interaction.is_parting && !path.parted;
        for lane in 0..N {
            // Where lanes part, those that do not cross hand over to those that do.
            let hands_over = interaction.is_parting && parting[lane] == 0.0;
            if clear && !hands_over {
                absorbed[lane] = 0.0;
            }
            let parted_share = if is_first_parting { received[lane] * parted[lane] } else { 0.0 };
            self.open[usize::from(path.parted)][lane] -= received[lane] * absorbed[lane] + parted_share;
            self.open[1][lane] += parted_share;
        }
    }

    /// Returns the weight that has not ended, as the film's red, green and blue of a white light.
    pub fn residual(&self, white: &White, draw: &Draw<N>) -> [f64; 3] {
        let [together, parted] = [false, true].map(|parted| {
            let open = self.open[usize::from(parted)];
            white.times(draw, Lanes::from_fn(|lane| open[lane] as f32), parted)
        });
        [0, 1, 2].map(|channel| together[channel] + parted[channel])
    }

    fn close(&mut self, parted: bool, ended: &[f64; N]) {
        self.open[usize::from(parted)].iter_mut().zip(ended).for_each(|(open, ended)| *open -= ended);
    }

    /// Returns a throughput at the end of a path as a share of the flux that left the camera.
    fn weight<P>(&self, path: &Path<N, P>, throughput: Throughput<N>, draw: &Draw<N>) -> [f64; N] {
        if path.excitation.is_some() {
            return [0.0; N];
        }
        let (lanes, here) = (throughput.of(Lanes::ONE), self.indices(&path.media, draw));
        std::array::from_fn(|lane| {
            let ratio = here[lane] / self.start[lane];
            f64::from(lanes[lane]) * ratio * ratio
        })
    }

    /// Returns the refractive index of each lane in the media around a place.
    fn indices(&self, media: &Media, draw: &Draw<N>) -> [f64; N] {
        index(&self.world.scene, draw, media.inside(&self.world.scene))
    }
}
