//! What all camera samples of a pass share: gathered photons and vertices of light paths.

use super::light_paths::{LightPaths, SAMPLES_PER_SET};
use super::light_vertices::LightVertices;
use super::photon_map::{PhotonMap, photons};
use crate::trace::World;
use crate::trace::pass::Pass;
use crate::trace::stats::Stats;
use crate::trace::walk::{Polarization, Polarized};

/// The photons and light vertices that the paths of one pass use.
pub struct PassLight<const N: usize, P: Polarization<N> = Polarized> {
    pub photons: Option<PhotonMap<N, P>>,
    vertices: Vec<LightVertices<N>>,
}

impl<const N: usize, P: Polarization<N>> PassLight<N, P> {
    pub fn new(world: &World, pass: &Pass) -> Self {
        let photons = photons::<N, P>(world, pass);
        let numbers = &pass.numbers;
        let vertices = match LightPaths::new(world, pass.seed) {
            Some(light_paths) => {
                let vertices_for =
                    |first: u32| light_paths.vertices_for::<N, P>(first..(first + SAMPLES_PER_SET).min(numbers.end));
                numbers.clone().step_by(SAMPLES_PER_SET as usize).map(vertices_for).collect()
            }
            None => Vec::new(),
        };
        Self { photons, vertices }
    }

    /// Returns the vertices that a sample uses, counted from the first sample of the pass.
    pub fn vertices(&self, sample: u32) -> Option<&LightVertices<N>> {
        self.vertices.get((sample / SAMPLES_PER_SET) as usize)
    }

    pub fn sent(&self) -> u64 {
        self.photons.as_ref().map_or(0, |photons| photons.sent)
    }

    /// Adds its statistics to those of others.
    pub fn add_to(&self, stats: &mut Stats) {
        self.photons.iter().for_each(|photons| *stats += photons.stats);
        self.vertices.iter().for_each(|set| *stats += set.stats);
    }
}
