use crate::math::DVec3;

/// Vertices as exactly as they were given: files hold f32, scene files and transforms f64.
#[derive(Clone, Debug)]
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
    /// How many there are.
    pub fn count(&self) -> usize {
        match self {
            Self::Single(points) => points.len(),
            Self::Double(points) => points.len(),
        }
    }

    /// Vertex `index`, widened exactly.
    pub fn at(&self, index: u32) -> DVec3 {
        match self {
            Self::Single(points) => points[index as usize].map(f64::from).into(),
            Self::Double(points) => points[index as usize],
        }
    }
}
