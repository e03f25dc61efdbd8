use crate::math::DVec3;

/// Vertices in the precision in which they were given: files hold f32, scene files and transforms f64.
#[derive(Clone, Debug, PartialEq)]
pub enum Vertices {
    /// As a mesh file stores them.
    Single(Vec<[f32; 3]>),
    /// As a scene file writes them, or after a transform.
    Double(Vec<DVec3>),
}

impl Default for Vertices {
    fn default() -> Self {
        Self::Single(Vec::new())
    }
}

impl Vertices {
    /// Returns the number of vertices.
    pub fn count(&self) -> usize {
        match self {
            Self::Single(points) => points.len(),
            Self::Double(points) => points.len(),
        }
    }

    /// Returns vertex `index`, widened exactly.
    pub fn at(&self, index: u32) -> DVec3 {
        match self {
            Self::Single(points) => points[index as usize].map(f64::from).into(),
            Self::Double(points) => points[index as usize],
        }
    }

    /// Returns, for each vertex, one vertex that stands for all at the same place.
    pub(super) fn welded(&self) -> Vec<u32> {
        // Adding 0 turns -0 into 0: they are the same place.
        let position_bits = |index: u32| self.at(index).to_array().map(|x| (x + 0.0).to_bits());
        let mut order: Vec<u32> = (0..self.count() as u32).collect();
        order.sort_unstable_by_key(|&index| position_bits(index));
        let mut welded = vec![0; order.len()];
        for same in order.chunk_by(|&a, &b| position_bits(a) == position_bits(b)) {
            same.iter().for_each(|&index| welded[index as usize] = same[0]);
        }
        welded
    }
}
