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

impl<const N: usize> Tracer<'_, N> {
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
        if path.polarization != 0.0 {
            let moved = |branch: &Branch<N>| {
                let degree = f64::from(path.polarization * branch.polarization).abs();
                weight_of(branch) * degree / draw.siblings(parted(branch))
            };
            self.tally.polarization += self.branches.iter().map(moved).sum::<f64>();
        }
        match self.transport {
            Transport::Deterministic { cutoff } => {
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
