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

    /// The smallest box around some points.
    pub fn around(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |bounds, point| bounds.union(Self { min: point, max: point }))
    }

    /// The box of the ellipsoid, ellipse or segment `center + axes * x`, |x| <= 1.
    pub fn of_ellipsoid(center: DVec3, axes: DMat3) -> Self {
        let rows = axes.transpose();
        let reach = DVec3::new(rows.x_axis.length(), rows.y_axis.length(), rows.z_axis.length());
        Self { min: center - reach, max: center + reach }
    }

    /// The smallest box around both.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// What is inside both; empty where they do not meet.
    pub fn intersection(self, other: Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// Whether it contains nothing.
    pub fn is_empty(&self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    /// Whether a point lies inside or on it.
    pub(crate) fn contains(&self, point: DVec3) -> bool {
        !(point.cmplt(self.min).any() || point.cmpgt(self.max).any())
    }

    /// How long it is along each axis; negative where it is empty.
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }

    /// Half the surface.
    pub fn half_area(&self) -> f64 {
        let DVec3 { x, y, z } = self.size().max(DVec3::ZERO);
        if self.is_empty() { 0.0 } else { x * y + y * z + z * x }
    }

    /// The box enlarged so that it contains every point computed on a surface inside it.
    ///
    /// `roundings` counts the chained roundings behind such a point.
    pub fn padded(self, roundings: u32) -> Self {
        let pad = self.min.abs().max(self.max.abs()) * super::gamma(roundings);
        Self { min: self.min - pad, max: self.max + pad }
    }

    /// The point halfway between the corners.
    pub fn center(&self) -> DVec3 {
        self.min * 0.5 + self.max * 0.5
    }
}
