use std::sync::{Arc, OnceLock};

use crate::spectrum::{Draw, MAX_LANES};

/// A value that a material computes once for each lane that stands for the same light in every sample. It depends on a
/// key, such as indices, that is mostly the same wherever the material is hit.
#[derive(Clone, Debug)]
pub(super) struct LaneCache<K, V>(Arc<OnceLock<LaneEntries<K, V>>>);

type LaneEntries<K, V> = Box<[OnceLock<(K, V)>; MAX_LANES]>;

impl<K: Copy + PartialEq, V> LaneCache<K, V> {
    /// Makes an empty cache.
    pub(super) fn new() -> Self {
        Self(Arc::default())
    }

    /// Returns what `make` returned for a lane and its first `key`. Returns None for any other key, and for lanes whose
    /// light changes between samples.
    pub(super) fn get<const N: usize>(
        &self,
        draw: &Draw<N>,
        lane: usize,
        key: K,
        make: impl FnOnce() -> V,
    ) -> Option<&V> {
        if !draw.is_fixed(lane) {
            return None;
        }
        let lanes = self.0.get_or_init(|| Box::new([const { OnceLock::new() }; MAX_LANES]));
        let (first_key, value) = lanes[lane].get_or_init(|| (key, make()));
        (*first_key == key).then_some(value)
    }
}
