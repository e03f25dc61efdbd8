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
    /// The ray from `origin` along `direction`, which is normalized here.
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        Self { origin, direction: unit(direction) }
    }

    /// The point at distance `t` from the origin.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

/// The unit vector along `v`, whose length is 1 within 2 roundings.
///
/// Scaling alone leaves up to 3; one Newton step for 1 / |v| takes back what it can see.
#[inline]
pub fn unit(v: DVec3) -> DVec3 {
    let near = v.normalize();
    near + near * (0.5 * (1.0 - near.length_squared()))
}
