use std::f64::consts::PI;

use super::{DVec3, Frame, cone, disk_in_square, square_around_disk, unit};

/// All directions within an angle of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cone {
    /// Unit vector in the middle.
    pub axis: DVec3,
    /// 1 - cos of the half angle, 0 to 2: the solid angle is 2 pi times that.
    pub one_minus_cos: f64,
}

impl Cone {
    /// Every direction.
    pub const ALL: Self = Self { axis: DVec3::Z, one_minus_cos: 2.0 };

    /// Whether it holds every direction.
    pub fn is_all(&self) -> bool {
        self.one_minus_cos >= 2.0
    }

    /// The cone around unit vectors, at least one, nearly the narrowest: none if they cancel.
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

    /// Whether a unit vector lies in the cone: |d - a|^2 = 2 (1 - cos) keeps its digits in the narrowest cones.
    pub fn contains(&self, direction: DVec3) -> bool {
        0.5 * (direction - self.axis).length_squared() <= self.one_minus_cos
    }

    /// A direction of the cone, uniform by solid angle.
    pub fn sample_uniform(&self, u: [f64; 2]) -> DVec3 {
        Frame::about(self.axis).to_world(cone(self.one_minus_cos, u))
    }

    /// Density per steradian with which `sample_uniform` draws directions.
    pub fn uniform_pdf(&self) -> f64 {
        1.0 / (2.0 * PI * self.one_minus_cos)
    }

    /// A direction of the cone for a place of the unit square: equal areas of the disk in it are equal solid angles, as
    /// 1 - cos is r^2 times the cone's. None beside the disk.
    pub fn sample(&self, place: [f64; 2]) -> Option<DVec3> {
        let [x, y] = disk_in_square(place)?;
        let here = (x * x + y * y) * self.one_minus_cos;
        let stretch = (self.one_minus_cos * (2.0 - here)).sqrt();
        Some(unit(Frame::about(self.axis).to_world(DVec3::new(x * stretch, y * stretch, 1.0 - here))))
    }

    /// Density per steradian with which `sample` draws a unit vector from places of a density of their own on the
    /// square; 0 beside the cone.
    pub fn pdf(&self, direction: DVec3, density_at: impl Fn([f64; 2]) -> f64) -> f64 {
        // For unit vectors, without the rounding of 1 - cos.
        let here = 0.5 * (direction - self.axis).length_squared();
        let local = Frame::about(self.axis).to_local(direction);
        let stretch = (self.one_minus_cos * (2.0 - here)).sqrt();
        if !(stretch > 0.0 && here < self.one_minus_cos) {
            return 0.0;
        }
        // The square is 4 / pi times as large as the disk, which stands for 2 pi (1 - cos).
        let place = square_around_disk([local.x / stretch, local.y / stretch]);
        place.map_or(0.0, |place| density_at(place) / (8.0 * self.one_minus_cos))
    }
}
