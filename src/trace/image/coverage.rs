//! Which objects the pixels of a tile show.

use serde::{Deserialize, Serialize};

use crate::film::RANKS;

/// For each pixel, the objects that its camera samples hit, and how many samples hit each.
#[derive(Default, Serialize, Deserialize)]
pub struct Coverage(Vec<Vec<ObjectSamples>>);

#[derive(Clone, Copy, Serialize, Deserialize)]
struct ObjectSamples {
    object: u32,
    samples: u32,
}

impl Coverage {
    pub fn new(pixels: usize) -> Self {
        Self(vec![Vec::new(); pixels])
    }

    pub fn pixels(&self) -> usize {
        self.0.len()
    }

    /// Whether all object numbers are less than `objects`.
    pub fn is_valid_for(&self, objects: usize) -> bool {
        self.0.iter().flatten().all(|entry| (entry.object as usize) < objects)
    }

    /// Counts a camera sample that hit an object.
    pub fn add(&mut self, pixel: usize, object: u32) {
        let pixel = &mut self.0[pixel];
        match pixel.iter_mut().find(|entry| entry.object == object) {
            Some(entry) => entry.samples += 1,
            None => pixel.push(ObjectSamples { object, samples: 1 }),
        }
    }

    /// Returns the ids that cover most of a pixel, as the bits of f32, and the samples of each, in descending order.
    /// Each object has an id, which several may share.
    pub fn ranks(&self, pixel: usize, ids: &[u32]) -> [(u32, u32); RANKS] {
        let mut found: Vec<(u32, u32)> = Vec::new();
        for &ObjectSamples { object, samples } in self.0.get(pixel).into_iter().flatten() {
            let id = ids[object as usize];
            match found.iter_mut().find(|(known, _)| *known == id) {
                Some((_, sum)) => *sum += samples,
                None => found.push((id, samples)),
            }
        }
        found.sort_by_key(|&(id, samples)| (std::cmp::Reverse(samples), id));
        found.resize(RANKS, (0, 0));
        std::array::from_fn(|rank| found[rank])
    }
}
