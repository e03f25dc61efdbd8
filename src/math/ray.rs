use super::DVec3;

/// A half line: it starts at `origin` (excluded) and runs along the unit vector `direction`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Where the ray starts, in scene units.
    pub origin: DVec3,
    /// Unit vector along which light is followed backward.
    pub direction: DVec3,
}

impl Ray {
    /// Creates the ray from `origin` along `direction`, and normalizes `direction`.
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Self { origin, direction: unit(direction) }
    }

    /// Returns the point at distance `t` from the origin.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

/// Returns the unit vector along `v`. Its length is 1 to within 2 roundings.
///
/// Scaling alone leaves up to 3 roundings. One Newton step for 1 / |v| removes as much of this error as it can resolve.
#[inline]
pub fn unit(v: DVec3) -> DVec3 {
    let near = v.normalize();
    near + near * (0.5 * (1.0 - near.length_squared()))
}
