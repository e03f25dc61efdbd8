use std::sync::{Arc, OnceLock};

use crate::spectrum::{Draw, MAX_LANES};

/// What a material works out once for each lane that stands for the same light in every sample, by numbers that are
/// mostly the same wherever it is met, such as indices.
#[derive(Clone, Debug)]
pub(super) struct LaneCache<K, V>(Arc<OnceLock<OfLanes<K, V>>>);

type OfLanes<K, V> = Box<[OnceLock<(K, V)>; MAX_LANES]>;

impl<K: Copy + PartialEq, V> LaneCache<K, V> {
    /// Nothing so far.
    pub(super) fn new() -> Self {
        Self(Arc::default())
    }

    /// What `make` answered for a lane and the first `key`; none of another key, or where the lane's light changes.
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
        let (known, value) = lanes[lane].get_or_init(|| (key, make()));
        (*known == key).then_some(value)
    }
}
