use crate::math::{DVec2, DVec3, Frame, Ray, unit};

/// A pinhole camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    position: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    /// Half of the image in the plane one unit before the camera.
    half: DVec2,
    size: DVec2,
    near: f64,
}

/// Angle in radians below which `up` and the viewing direction count as parallel.
const PARALLEL: f64 = 1e-4;

impl Camera {
    /// The camera at `position` that sees the point `target` in the middle of an image of `size` pixels.
    ///
    /// `vertical_fov` is in degrees; rays start where their distance along the viewing direction is `near`. The second
    /// answer says whether `up` was so nearly parallel to the viewing direction that another was taken.
    pub fn new(
        position: DVec3,
        target: DVec3,
        up: DVec3,
        vertical_fov: f64,
        near: f64,
        size: [u32; 2],
    ) -> (Self, bool) {
        let forward = (target - position).normalize();
        let across = forward.cross(up.normalize());
        let parallel = across.length() < PARALLEL;
        let right = if parallel { Frame::about(forward).to_world(DVec3::X) } else { across.normalize() };
        let size = DVec2::new(f64::from(size[0]), f64::from(size[1]));
        let half_height = libm::tan(vertical_fov.to_radians() / 2.0);
        let half = DVec2::new(half_height * size.x / size.y, half_height);
        let camera = Self { position, right, up: right.cross(forward), forward, half, size, near };
        (camera, parallel)
    }

    /// The ray through a point of the film, in pixels from the top left corner.
    pub fn ray(&self, film: DVec2) -> Ray {
        let x = (2.0 * film.x / self.size.x - 1.0) * self.half.x;
        let y = (1.0 - 2.0 * film.y / self.size.y) * self.half.y;
        let along = self.forward + self.right * x + self.up * y;
        Ray { origin: self.position + along * self.near, direction: unit(along) }
    }

    /// Distance of a point along the viewing direction.
    pub fn depth(&self, point: DVec3) -> f64 {
        (point - self.position).dot(self.forward)
    }

    /// Where the camera is.
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// The unit vector toward the middle of the image.
    pub fn forward(&self) -> DVec3 {
        self.forward
    }

    /// Whether rays start away from the camera.
    pub fn starts_away(&self) -> bool {
        self.near > 0.0
    }

    /// World to camera for row vectors: +x right, +y up, +z forward.
    pub fn world_to_camera(&self) -> [[f64; 4]; 4] {
        let [x, y, z] = [self.right, self.up, self.forward];
        let shift = [x, y, z].map(|axis| -self.position.dot(axis));
        [[x.x, y.x, z.x, 0.0], [x.y, y.y, z.y, 0.0], [x.z, y.z, z.z, 0.0], [shift[0], shift[1], shift[2], 1.0]]
    }

    /// The angle of a pixel in the middle of the image, in radians.
    pub fn pixel_angle(&self) -> f64 {
        2.0 * self.half.x / self.size.x
    }

    /// Width of the image in the plane one unit before the camera.
    pub fn screen_window_width(&self) -> f64 {
        2.0 * self.half.x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Row C1 of the stability catalog.
    #[test]
    fn c1_the_frame_is_orthonormal_for_every_angle_between_up_and_view() {
        let target = DVec3::new(1.0, 2.0, -3.0);
        let side = Frame::about(target.normalize()).to_world(DVec3::X);
        for angle in [1.0, 1e-2, 1e-3, 1.01e-4, 1e-5, 1e-8, 0.0] {
            let up = target.normalize() * libm::cos(angle) + side * libm::sin(angle);
            let (camera, parallel) = Camera::new(DVec3::ZERO, target, up, 40.0, 0.0, [4, 3]);
            assert_eq!(parallel, angle < 1e-4, "angle {angle}");
            let (r, u, f) = (camera.right, camera.up, camera.forward);
            for error in [r.dot(u), u.dot(f), f.dot(r), r.length() - 1.0, u.length() - 1.0, f.length() - 1.0] {
                assert!(error.abs() <= 1e-12, "angle {angle}: off by {error}");
            }
        }
    }
}
