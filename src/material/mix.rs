use super::{Branch, Incoming, Mueller, Part, Scatter, ScatterContext, Straight};
use crate::math::DVec3;
use crate::spectrum::{Lanes, Table};

/// Two materials in one place, in patches too fine to be seen. The second covers a share of the surface.
///
/// ```toml
/// mix = { materials = ["steel", "rust"], amount = 0.3 }     # three tenths of rust
/// ```
#[derive(Clone, Debug)]
pub struct Mix<S, M> {
    /// The materials, by name: any that reflect or transmit, including other mixes and masks.
    pub materials: [Part<M>; 2],
    /// Share of the surface that the second material covers, 0 to 1.
    pub amount: S,
}

impl<M: Scatter> Mix<Table, M> {
    /// Returns the share of each material, per lane.
    fn shares<const N: usize>(&self, context: &ScatterContext<N>) -> [Lanes<N>; 2] {
        let second = context.read(&self.amount);
        [Lanes::from_fn(|i| 1.0 - second[i]), second]
    }

    /// Returns each material with its share, per lane.
    pub(super) fn parts<const N: usize>(&self, context: &ScatterContext<N>) -> [(&M, Lanes<N>); 2] {
        let [first, second] = self.shares(context);
        let [a, b] = self.materials.each_ref().map(Part::material);
        [(a, first), (b, second)]
    }

    /// Returns the probability with which a direction is drawn from the second material rather than the first: its mean
    /// share.
    fn chance_of_second<const N: usize>(&self, context: &ScatterContext<N>) -> f64 {
        match self.materials.each_ref().map(|part| part.material().lobes().is_wide()) {
            [_, false] => 0.0,
            [false, true] => 1.0,
            [true, true] => {
                let share = context.present * context.read(&self.amount);
                f64::from(share.sum() / context.present.sum()).clamp(0.0, 1.0)
            }
        }
    }

    /// Adds one branch for everything that scatters widely, drawn from the mixture of both materials' densities, and
    /// one branch for each single direction in which either material sends light.
    pub(super) fn scatter<const N: usize>(
        &self,
        context: &ScatterContext<N>,
        u: [f64; 2],
        branches: &mut Vec<Branch<N>>,
    ) {
        let (shares, second, first) = (self.shares(context), self.chance_of_second(context), branches.len());
        let chosen = usize::from(u[0] < second);
        let u = [[(u[0] - second) / (1.0 - second), u[0] / second][chosen], u[1]];
        for (number, part) in self.materials.iter().enumerate() {
            let (material, share, start) = (part.material(), shares[number], branches.len());
            if share.is_zero() || (number != chosen && !material.lobes().has_delta()) {
                continue;
            }
            material.scatter(context, u, branches);
            let mut at = start;
            while at < branches.len() {
                let branch = branches[at].scaled(share);
                let (before, rest) = branches.split_at_mut(start);
                let same_direction = before[first..].iter_mut().find(|other| other.has_same_direction(&branch));
                let kept_branch = match (branch.pdf, same_direction) {
                    (Some(pdf), _) if number == chosen => {
                        let chances = [1.0 - second, second];
                        Some(self.drawn_from_both(context, branch, pdf, number, shares, chances))
                    }
                    (Some(_), _) => None,
                    (None, Some(other)) => {
                        other.join(&branch);
                        None
                    }
                    (None, None) => Some(branch),
                };
                match kept_branch {
                    Some(branch) => (rest[at - start], at) = (branch, at + 1),
                    None => _ = branches.remove(at),
                }
            }
        }
    }

    /// Turns a branch that was drawn from one material into one drawn from both, including what the other scatters
    /// there.
    fn drawn_from_both<const N: usize>(
        &self,
        context: &ScatterContext<N>,
        drawn: Branch<N>,
        pdf: f64,
        number: usize,
        shares: [Lanes<N>; 2],
        chances: [f64; 2],
    ) -> Branch<N> {
        let other = 1 - number;
        let Some((light, other_pdf)) = self.materials[other].material().evaluate(context, drawn.wi) else {
            // If only one material scatters widely, it is always the one that is drawn.
            return Branch {
                share: drawn.share * (1.0 / chances[number]) as f32,
                pdf: Some(chances[number] * pdf),
                ..drawn
            };
        };
        let mixture_pdf = chances[number] * pdf + chances[other] * other_pdf;
        let share = drawn.share * (pdf / mixture_pdf) as f32 + light * shares[other] * (1.0 / mixture_pdf) as f32;
        Branch { share, pdf: Some(mixture_pdf), ..drawn }
    }

    pub(super) fn evaluate<const N: usize>(&self, context: &ScatterContext<N>, wi: DVec3) -> Option<(Lanes<N>, f64)> {
        let (shares, second) = (self.shares(context), self.chance_of_second(context));
        let [a, b] = self.materials.each_ref().map(|part| part.material().evaluate(context, wi));
        if a.is_none() && b.is_none() {
            return None;
        }
        let (a, b) = (a.unwrap_or((Lanes::ZERO, 0.0)), b.unwrap_or((Lanes::ZERO, 0.0)));
        Some((a.0 * shares[0] + b.0 * shares[1], (1.0 - second) * a.1 + second * b.1))
    }

    pub(super) fn diffuse_part<const N: usize>(&self, context: &ScatterContext<N>, wi: DVec3) -> Lanes<N> {
        let (shares, [a, b]) = (self.shares(context), self.materials.each_ref().map(Part::material));
        a.diffuse_part(context, wi) * shares[0] + b.diffuse_part(context, wi) * shares[1]
    }

    pub(super) fn mueller<const N: usize>(
        &self,
        context: &ScatterContext<N>,
        incoming: Incoming,
        mueller: &mut Mueller<N>,
    ) {
        self.mix_muellers(context, mueller, |part, mueller| part.mueller(context, incoming, mueller));
    }

    pub(super) fn mueller_of_straight<const N: usize>(&self, context: &ScatterContext<N>, mueller: &mut Mueller<N>) {
        self.mix_muellers(context, mueller, |part, mueller| part.mueller_of_straight(context, mueller));
    }

    fn mix_muellers<const N: usize>(
        &self,
        context: &ScatterContext<N>,
        mueller: &mut Mueller<N>,
        set_mueller: impl Fn(&M, &mut Mueller<N>),
    ) {
        let ([(a, first), (b, second)], mut other) = (self.parts(context), Mueller::NONE);
        set_mueller(a, mueller);
        set_mueller(b, &mut other);
        mueller.scale(first);
        other.scale(second);
        mueller.add(&other);
    }

    /// Returns the share that passes straight through.
    pub(super) fn straight<const N: usize>(&self, context: &ScatterContext<N>) -> Option<Straight<N>> {
        let parts = self.materials.each_ref().map(|part| part.material().straight(context));
        Straight::combine(parts, self.shares(context))
    }

    pub(super) fn degree_of_scattered<const N: usize>(&self, context: &ScatterContext<N>, wi: DVec3) -> f32 {
        let wide = self.materials.iter().map(Part::material).filter(|material| material.lobes().is_wide());
        wide.map(|material| material.degree_of_scattered(context, wi)).fold(0.0, f32::max)
    }
}
