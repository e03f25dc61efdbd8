use crate::math::DVec3;

/// A direction from a point toward a shape, drawn at random.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeSample {
    /// Unit vector from the point to the shape.
    pub direction: DVec3,
    /// The part that was sampled, on shapes with several parts. The sample counts only if the nearest crossing lies on
    /// this part.
    pub part: Option<u32>,
    /// Density of the sample, if it is known before the crossing is.
    pub density: Option<Density>,
}

/// The density with which a shape is sampled from one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Density {
    /// Uniform over directions, with this density per steradian.
    SolidAngle(f64),
    /// Uniform over the surface, with this density per unit area.
    Area(f64),
}

impl ShapeSample {
    /// Creates a sample of a direction with a known density per steradian.
    pub(super) fn of_direction(direction: DVec3, pdf: f64) -> Self {
        Self { direction, part: None, density: Some(Density::SolidAngle(pdf)) }
    }

    /// Creates a sample of the direction along a vector to the shape, or returns `None` for a vector of length 0.
    pub fn along(vector: DVec3) -> Option<Self> {
        Some(Self { direction: vector.try_normalize()?, part: None, density: None })
    }

    /// Returns the sample, marked as lying on one of several parts.
    #[must_use]
    pub fn with_part(self, part: u32) -> Self {
        Self { part: Some(part), ..self }
    }

    pub(super) fn with_density(self, density: Density) -> Self {
        Self { density: Some(density), ..self }
    }

    /// Returns the sample with its density multiplied by the probability of choosing its part among several.
    #[must_use]
    pub fn times(self, probability: f64) -> Self {
        let scaled = |density| match density {
            Density::SolidAngle(density) => Density::SolidAngle(density * probability),
            Density::Area(density) => Density::Area(density * probability),
        };
        Self { density: self.density.map(scaled), ..self }
    }
}

impl Density {
    /// Returns the density per steradian of a direction that meets the surface at a distance and an angle with this
    /// cosine.
    pub fn toward(self, distance: f64, cos: f64) -> f64 {
        match self {
            Self::SolidAngle(density) => density,
            Self::Area(density) => density * distance * distance / cos,
        }
    }
}
