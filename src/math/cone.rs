use std::f64::consts::PI;

use super::{DVec3, Frame, cone, disk_to_square, square_to_disk, unit};

/// All directions within an angle of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Unit vector in the middle of the cone.
    pub axis: DVec3,
    /// 1 - cos of the half angle, from 0 to 2. The solid angle is 2 pi times this value.
    pub one_minus_cos: f64,
}

impl Cone {
    /// The cone of all directions.
    pub const ALL: Self = Self { axis: DVec3::Z, one_minus_cos: 2.0 };

    /// Returns whether the cone contains every direction.
    pub fn is_all(&self) -> bool {
        self.one_minus_cos >= 2.0
    }

    /// Returns nearly the narrowest cone around unit vectors, of which there is at least one. Returns `None` if they
    /// cancel.
    ///
    /// Badoiu & Clarkson 2003, *Smaller Core-Sets for Balls*.
    pub fn around(directions: &[DVec3]) -> Option<Self> {
        let mut middle = directions.iter().sum::<DVec3>() / directions.len() as f64;
        let distance = |from: DVec3| move |direction: &DVec3| (*direction - from).length_squared();
        for step in 1..=100_u32 {
            let farthest = directions.iter().max_by(|a, b| distance(middle)(a).total_cmp(&distance(middle)(b)))?;
            middle += (*farthest - middle) / f64::from(step + 1);
        }
        let axis = middle.try_normalize()?;
        Some(Self { axis, one_minus_cos: 0.5 * directions.iter().map(distance(axis)).fold(0.0, f64::max) })
    }

    /// Returns whether a unit vector d lies in the cone about the axis a. Computing 1 - cos as |d - a|^2 / 2 keeps full
    /// precision in the narrowest cones.
    pub fn contains(&self, direction: DVec3) -> bool {
        0.5 * (direction - self.axis).length_squared() <= self.one_minus_cos
    }

    /// Samples a direction in the cone, uniformly in solid angle.
    pub fn sample_uniform(&self, u: [f64; 2]) -> DVec3 {
        Frame::about(self.axis).to_world(cone(self.one_minus_cos, u))
    }

    /// Returns the density per steradian with which `sample_uniform` draws directions.
    pub fn uniform_pdf(&self) -> f64 {
        1.0 / (2.0 * PI * self.one_minus_cos)
    }

    /// Maps a point of the unit square to a direction in the cone. Equal areas of the inscribed disk map to equal solid
    /// angles, because 1 - cos is r^2 times that of the cone. Returns `None` outside the disk.
    pub fn sample(&self, place: [f64; 2]) -> Option<DVec3> {
        let [x, y] = square_to_disk(place)?;
        let here = (x * x + y * y) * self.one_minus_cos;
        let stretch = (self.one_minus_cos * (2.0 - here)).sqrt();
        Some(unit(Frame::about(self.axis).to_world(DVec3::new(x * stretch, y * stretch, 1.0 - here))))
    }

    /// Returns the density per steradian with which `sample` draws a unit vector if `density_at` is the density of the
    /// points of the square. Returns 0 outside the cone.
    pub fn pdf(&self, direction: DVec3, density_at: impl Fn([f64; 2]) -> f64) -> f64 {
        // This is 1 - cos for unit vectors, without the rounding of the subtraction.
        let here = 0.5 * (direction - self.axis).length_squared();
        let local = Frame::about(self.axis).to_local(direction);
        let stretch = (self.one_minus_cos * (2.0 - here)).sqrt();
        if !(stretch > 0.0 && here < self.one_minus_cos) {
            return 0.0;
        }
        // The square has 4 / pi times the area of the disk, which maps to a solid angle of 2 pi (1 - cos).
        let place = disk_to_square([local.x / stretch, local.y / stretch]);
        place.map_or(0.0, |place| density_at(place) / (8.0 * self.one_minus_cos))
    }
}
