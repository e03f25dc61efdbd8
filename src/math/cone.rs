use super::{DVec3, Frame, disk_in_square, square_around_disk, unit};

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

    /// Solid angle of the square that `direction_at` maps to the cone, the corners beside the disk included.
    pub fn of_square(&self) -> f64 {
        8.0 * self.one_minus_cos
    }

    /// A direction of the cone for a place of the unit square: equal areas of the disk in it are equal solid angles, 1 - cos =
    /// r^2 times the cone's. None beside the disk.
    pub fn direction_at(&self, place: [f64; 2]) -> Option<DVec3> {
        let [x, y] = disk_in_square(place)?;
        let here = (x * x + y * y) * self.one_minus_cos;
        let stretch = (self.one_minus_cos * (2.0 - here)).sqrt();
        Some(unit(Frame::about(self.axis).to_world(DVec3::new(x * stretch, y * stretch, 1.0 - here))))
    }

    /// The place that `direction_at` takes to a direction; none of a direction beside the cone.
    pub fn place_of(&self, direction: DVec3) -> Option<[f64; 2]> {
        // For unit vectors, without the rounding of 1 - cos.
        let here = 0.5 * (direction - self.axis).length_squared();
        let local = Frame::about(self.axis).to_local(direction);
        let stretch = (self.one_minus_cos * (2.0 - here)).sqrt();
        if stretch > 0.0 {
            square_around_disk([local.x / stretch, local.y / stretch]).filter(|_| here < self.one_minus_cos)
        } else {
            None
        }
    }
}
