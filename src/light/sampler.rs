use super::{Light, LightBounds, LightId, LightTree};
use crate::math::{DVec3, Distribution};
use crate::spectrum::Table;

/// A sampler that chooses one of many lights for a point, by what they may send there.
///
/// Finite lights are in a tree. The power of a sky depends on the scene's size, so all skies together are chosen as
/// often as the whole tree, and each in proportion to its irradiance.
#[derive(Clone, Debug)]
pub struct LightSampler {
    tree: LightTree,
    /// Probability of choosing a light of the tree.
    tree_probability: f64,
    /// The tree, then each infinite light.
    top_level: Distribution,
    /// The lights of the tree, then the infinite ones.
    lights: Vec<LightId>,
    /// Number of lights in the tree.
    finite: usize,
    /// Index of each light in `lights`; `None` if it is not sampled or does not shine.
    places: Vec<Option<usize>>,
}

/// A light drawn at random.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampledLight {
    /// The light.
    pub light: LightId,
    /// Its probability, above 0 and at most 1.
    pub probability: f64,
}

impl LightSampler {
    /// Creates a sampler of the lights that are sampled and shine.
    pub fn new(lights: &[Light<Table>]) -> Self {
        let sampled = || (0..lights.len()).filter(|&id| lights[id].is_sampled());
        let bounds = |id: LightId| Some((id, lights[id].bounds().filter(|light| light.intensity > 0.0)?));
        let (finite, bounds): (Vec<LightId>, Vec<LightBounds>) = sampled().filter_map(bounds).unzip();
        let skies = sampled().map(|id| (id, lights[id].irradiance())).filter(|sky| sky.1 > 0.0);
        let (infinite, irradiances): (Vec<LightId>, Vec<f64>) = skies.unzip();
        let weight = match (finite.is_empty(), infinite.is_empty()) {
            (true, _) => 0.0,
            (false, false) => irradiances.iter().sum(),
            (false, true) => 1.0,
        };
        let mut places = vec![None; lights.len()];
        let all = [finite.as_slice(), &infinite].concat();
        all.iter().enumerate().for_each(|(place, &id)| places[id] = Some(place));
        let top_level = Distribution::new(std::iter::once(weight).chain(irradiances));
        let tree_probability = top_level.probability(0);
        Self { tree: LightTree::new(&bounds), tree_probability, top_level, lights: all, finite: finite.len(), places }
    }

    /// Returns the lights that may be sampled, in order.
    pub fn lights(&self) -> Vec<LightId> {
        let mut lights = self.lights.clone();
        lights.sort_unstable();
        lights
    }

    /// Samples a light for a point on a surface with the given unit normal; `None` if the choice falls on the tree and
    /// none of its lights can reach the point.
    pub fn sample(&self, from: DVec3, normal: DVec3, u: f64) -> Option<SampledLight> {
        if u < self.tree_probability {
            let drawn = self.tree.sample(from, normal, false, u / self.tree_probability)?;
            return Some(SampledLight {
                light: self.lights[drawn.index],
                probability: drawn.probability * self.tree_probability,
            });
        }
        let choice = self.top_level.sample(u);
        let light = *self.lights.get(self.finite + choice.index.checked_sub(1)?)?;
        Some(SampledLight { light, probability: choice.probability })
    }

    /// Returns the probability with which `sample` draws a light.
    pub fn probability(&self, light: LightId, from: DVec3, normal: DVec3) -> f64 {
        match self.places[light] {
            None => 0.0,
            Some(place) if place < self.finite => {
                self.tree_probability * self.tree.probability(place, from, normal, false)
            }
            Some(place) => self.top_level.probability(place - self.finite + 1),
        }
    }
}
