use super::DVec3;

/// A right-handed orthonormal frame about a unit normal; local z is the normal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    tangent: DVec3,
    bitangent: DVec3,
    normal: DVec3,
}

impl Frame {
    /// Creates the frame about the unit vector `normal`, without branches near the poles.
    ///
    /// Duff et al. 2017, *Building an Orthonormal Basis, Revisited*, listing 3.
    pub fn about(normal: DVec3) -> Self {
        let sign = 1f64.copysign(normal.z);
        let a = -1.0 / (sign + normal.z);
        let b = normal.x * normal.y * a;
        Self {
            tangent: DVec3::new(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x),
            bitangent: DVec3::new(b, sign + normal.y * normal.y * a, -normal.y),
            normal,
        }
    }

    /// Converts a vector from the frame's coordinates to the world's.
    pub fn to_world(&self, local: DVec3) -> DVec3 {
        self.tangent * local.x + self.bitangent * local.y + self.normal * local.z
    }

    /// Converts a vector from the world's coordinates to the frame's.
    pub fn to_local(&self, world: DVec3) -> DVec3 {
        DVec3::new(self.tangent.dot(world), self.bitangent.dot(world), self.normal.dot(world))
    }
}

/// Returns the horizontal unit vector perpendicular to `normal`, where +y is up. It points to the right for a viewer in
/// front of the surface. Returns +x if `normal` is vertical.
pub fn horizontal_tangent(normal: DVec3) -> DVec3 {
    DVec3::Y.cross(normal).try_normalize().unwrap_or(DVec3::X)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Row G1 of the stability catalog.
    #[test]
    fn g1_frames_are_orthonormal_at_the_poles_and_signed_zeros() {
        let normals = [
            DVec3::Z,
            -DVec3::Z,
            DVec3::new(0.0, 0.0, -1.0),
            DVec3::new(-0.0, -0.0, -1.0),
            DVec3::X,
            -DVec3::Y,
            DVec3::new(1e-9, -1e-9, -1.0).normalize(),
        ];
        let anywhere = (0..100_000).map(|i| {
            // Hammersley points in the unit square.
            let u = [(f64::from(i) + 0.5) / 1e5, f64::from((i as u32).reverse_bits()) / 4_294_967_296.0];
            crate::math::sample_sphere(u)
        });
        for normal in normals.into_iter().chain(anywhere) {
            let frame = Frame::about(normal);
            let (t, b, n) = (frame.tangent, frame.bitangent, frame.normal);
            for error in [t.dot(b), t.dot(n), b.dot(n), t.length() - 1.0, b.length() - 1.0] {
                assert!(error.abs() < 1e-15, "{normal}: {error}");
            }
            assert!(t.cross(b).dot(n) > 0.0);
        }
    }
}
