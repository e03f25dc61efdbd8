use super::{Light, LightId, LightTree};
use crate::math::{DVec3, Distribution};
use crate::spectrum::Table;

/// Which of many lights is sampled from a point: by what they may send there.
///
/// Lights of a finite extent stand in a tree. The sky, whose power depends on the scene's size, gets as much as all of them
/// together, divided by the irradiance of its parts.
#[derive(Clone, Debug)]
pub struct LightSampler {
    tree: LightTree,
    /// The tree, then each infinite light.
    kinds: Distribution,
    /// The light of each entry of the tree.
    finite: Vec<LightId>,
    infinite: Vec<LightId>,
    /// Where each light stands.
    entries: Vec<Entry>,
}

/// A light drawn at random.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampledLight {
    /// Which one.
    pub light: LightId,
    /// How likely it was, above 0 and at most 1.
    pub probability: f64,
}

#[derive(Clone, Copy, Debug)]
enum Entry {
    /// Nowhere: it is not sampled, or does not shine.
    Absent,
    Finite(usize),
    Infinite(usize),
}

impl LightSampler {
    /// Of those lights that are sampled and shine.
    pub fn new(lights: &[Light<Table>]) -> Self {
        let (mut entries, mut finite, mut infinite) = (vec![Entry::Absent; lights.len()], Vec::new(), Vec::new());
        let (mut bounds, mut irradiances) = (Vec::new(), Vec::new());
        for (light, id) in lights.iter().zip(0..).filter(|(light, _)| light.is_sampled()) {
            match light.bounds() {
                Some(of_light) if of_light.intensity > 0.0 => {
                    entries[id] = Entry::Finite(finite.len());
                    finite.push(id);
                    bounds.push(of_light);
                }
                None if light.irradiance() > 0.0 => {
                    entries[id] = Entry::Infinite(infinite.len());
                    infinite.push(id);
                    irradiances.push(light.irradiance());
                }
                _ => {}
            }
        }
        let of_sky: f64 = irradiances.iter().sum();
        let of_tree = match (finite.is_empty(), infinite.is_empty()) {
            (true, _) => 0.0,
            (false, false) => of_sky,
            (false, true) => 1.0,
        };
        let kinds = Distribution::new(std::iter::once(of_tree).chain(irradiances));
        Self { tree: LightTree::new(&bounds), kinds, finite, infinite, entries }
    }

    /// The lights that are sampled from anywhere, in order.
    pub fn lights(&self) -> Vec<LightId> {
        let mut lights = [self.finite.as_slice(), &self.infinite].concat();
        lights.sort_unstable();
        lights
    }

    /// A light for a point on a surface of the given unit normal; none where no light can come from any.
    pub fn sample(&self, from: DVec3, normal: DVec3, u: f64) -> Option<SampledLight> {
        let kind = self.kinds.sample(u);
        if kind.index > 0 {
            return Some(SampledLight { light: self.infinite[kind.index - 1], probability: kind.probability });
        }
        let drawn = self.tree.sample(from, normal, false, kind.u)?;
        Some(SampledLight { light: self.finite[drawn.index], probability: drawn.probability * kind.probability })
    }

    /// How likely `sample` draws a light.
    pub fn probability(&self, light: LightId, from: DVec3, normal: DVec3) -> f64 {
        match self.entries[light] {
            Entry::Absent => 0.0,
            Entry::Finite(entry) => self.kinds.probability(0) * self.tree.probability(entry, from, normal, false),
            Entry::Infinite(entry) => self.kinds.probability(1 + entry),
        }
    }
}
