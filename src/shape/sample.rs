use crate::math::DVec3;

/// A direction from a point toward a shape, drawn at random.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShapeSample {
    /// Unit vector from the point to the shape.
    pub direction: DVec3,
    /// The part that was drawn, on shapes of several: the sample counts only if the nearest crossing lies on it.
    pub part: Option<u32>,
    /// How densely it was drawn, where that is known before the crossing is.
    pub density: Option<Density>,
}

/// How densely a shape is sampled from one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Density {
    /// Evenly over directions, this many per steradian.
    SolidAngle(f64),
    /// Evenly over the surface, this many per unit of area.
    Area(f64),
}

impl ShapeSample {
    /// A direction of a known density per steradian.
    pub(super) fn of_direction(direction: DVec3, pdf: f64) -> Self {
        Self { direction, part: None, density: Some(Density::SolidAngle(pdf)) }
    }

    /// The direction along a vector to the shape; none of length 0.
    pub fn along(vector: DVec3) -> Option<Self> {
        Some(Self { direction: vector.try_normalize()?, part: None, density: None })
    }

    /// The sample, if it lies on one of several parts.
    #[must_use]
    pub fn with_part(self, part: u32) -> Self {
        Self { part: Some(part), ..self }
    }

    pub(super) fn with_density(self, density: Density) -> Self {
        Self { density: Some(density), ..self }
    }

    /// The sample, if its part is only one of several and is chosen with a probability.
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
    /// Per steradian, of a direction that meets the surface at a distance and an angle of this cosine.
    pub fn toward(self, distance: f64, cos: f64) -> f64 {
        match self {
            Self::SolidAngle(density) => density,
            Self::Area(density) => density * distance * distance / cos,
        }
    }
}
