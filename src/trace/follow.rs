//! Which branches of a path are followed.

use super::Transport;
use super::path::Path;
use super::roulette::survival;
use super::tracer::Tracer;
use crate::material::Branch;
use crate::math::Sampler;
use crate::spectrum::Draw;

/// Use of the random numbers that choose a branch or end one.
const CHOICE: u32 = 2;

/// How a sample goes on that has met too many surfaces: what is left is mostly faint, and all branches are still followed that are not.
const BY_CHANCE: Transport = Transport::Random { split: 0.01, roulette: 0.01 };

impl<const N: usize> Tracer<'_, N> {
    /// Which branches are followed by now. Where light has more ways than can be followed, one is chosen, which leaves the
    /// mean what it is.
    fn rule(&self) -> Transport {
        match self.transport {
            Transport::Deterministic { most, .. } if self.surfaces() > most => BY_CHANCE,
            asked => asked,
        }
    }

    /// Surfaces met by this camera sample or photon.
    pub(super) fn surfaces(&self) -> u64 {
        self.tally.rays - self.started
    }

    /// Decides which branches are followed; `child(number, branch, factor)` makes the path of one.
    pub(super) fn follow(
        &mut self,
        path: &Path<N>,
        draw: &Draw<N>,
        sampler: &Sampler,
        (parts, sooner): (bool, f64),
        child: impl Fn(usize, &Branch<N>, f64) -> Path<N>,
    ) -> Option<Path<N>> {
        let sooner = |branch: &Branch<N>| if branch.pdf.is_some() { sooner } else { 1.0 };
        let parted = |branch: &Branch<N>| path.parted || (parts && branch.crosses);
        let weight_of = |branch: &Branch<N>| {
            let shares = draw.shares(parted(branch));
            path.throughput.through(branch.share).weight(shares) / (path.eta_scale * branch.eta_scale)
        };
        match self.rule() {
            Transport::Deterministic { cutoff, .. } => {
                for (number, branch) in self.branches.iter().enumerate() {
                    match weight_of(branch) {
                        weight if weight < cutoff => self.tally.dropped += weight,
                        _ => self.pending.push(child(number, branch, 1.0)),
                    }
                }
                None
            }
            Transport::Random { split, roulette } => {
                if self.branches.len() > 1 && path.weight(draw) <= split {
                    let u = sampler.four_plain(path.key, CHOICE);
                    let total: f64 = self.branches.iter().map(weight_of).sum();
                    let mut left = u[0] * total;
                    let mut bright = (0..self.branches.len()).filter(|&i| weight_of(&self.branches[i]) != 0.0);
                    let last = bright.clone().next_back()?;
                    let chosen = bright.find(|&i| {
                        left -= weight_of(&self.branches[i]);
                        left < 0.0
                    });
                    let number = chosen.unwrap_or(last);
                    let branch = &self.branches[number];
                    let factor = survival(total, roulette, path.vertices, || u[1])?;
                    return Some(child(number, branch, factor * total / weight_of(branch)));
                }
                let mut next = None;
                for (number, branch) in self.branches.iter().enumerate() {
                    let u = || sampler.four_plain(path.key.child(number), CHOICE)[2];
                    let weight = weight_of(branch);
                    if weight != 0.0
                        && let Some(factor) = survival(weight, roulette * sooner(branch), path.vertices, u)
                    {
                        self.pending.extend(next.replace(child(number, branch, factor)));
                    }
                }
                next
            }
        }
    }
}
