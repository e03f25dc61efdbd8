use serde::{Deserialize, Serialize};

use super::{DMat3, DVec3};

/// An axis-aligned box, empty when any `min` exceeds its `max`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Bounds {
    /// Smallest coordinates.
    pub min: DVec3,
    /// Largest coordinates.
    pub max: DVec3,
}

impl Bounds {
    /// The box that contains nothing.
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// Returns the smallest box that contains all points.
    pub fn around(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |bounds, point| bounds.union(Self { min: point, max: point }))
    }

    /// Returns the bounding box of the ellipsoid, ellipse or segment `center + axes * x`, |x| <= 1.
    pub fn of_ellipsoid(center: DVec3, axes: DMat3) -> Self {
        let rows = axes.transpose();
        let reach = DVec3::new(rows.x_axis.length(), rows.y_axis.length(), rows.z_axis.length());
        Self { min: center - reach, max: center + reach }
    }

    /// Returns the smallest box that contains both boxes.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Returns the overlap of both boxes, which is empty if they do not meet.
    #[must_use]
    pub fn intersection(self, other: Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// Returns whether the box contains nothing.
    pub fn is_empty(&self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// Returns whether a point lies inside the box or on its boundary.
    pub(crate) fn contains(&self, point: DVec3) -> bool {
        !(point.cmplt(self.min).any() || point.cmpgt(self.max).any())
    }

    /// Returns the length along each axis, negative where the box is empty.
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }

    /// Returns half the surface area, 0 for an empty box.
    pub fn half_area(&self) -> f64 {
        let DVec3 { x, y, z } = self.size().max(DVec3::ZERO);
        if self.is_empty() { 0.0 } else { x * y + y * z + z * x }
    }

    /// Returns the box enlarged so that it contains every computed point of a surface inside it.
    ///
    /// `roundings` is the number of chained roundings in the computation of such a point.
    #[must_use]
    pub fn padded(self, roundings: u32) -> Self {
        let pad = self.min.abs().max(self.max.abs()) * super::gamma(roundings);
        Self { min: self.min - pad, max: self.max + pad }
    }

    /// Returns the point halfway between the corners.
    pub fn center(&self) -> DVec3 {
        self.min * 0.5 + self.max * 0.5
    }
}
