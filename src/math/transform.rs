use super::{DMat3, DVec3, unit};

/// An affine map of space, x -> linear * x + translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform {
    linear: DMat3,
    translation: DVec3,
}

impl Transform {
    /// The identity map.
    pub const IDENTITY: Self = Self { linear: DMat3::IDENTITY, translation: DVec3::ZERO };

    /// Creates the map that multiplies each coordinate by its factor.
    pub fn scale(factors: DVec3) -> Self {
        Self { linear: DMat3::from_diagonal(factors), ..Self::IDENTITY }
    }

    /// Creates the rotation by an angle in degrees, counterclockwise as seen from the tip of `axis`.
    pub fn rotate(axis: DVec3, degrees: f64) -> Self {
        // Rodrigues' rotation formula, with the exact values at quarter turns, which sin and cos only approximate.
        let (sin, cos) = match degrees.rem_euclid(360.0) {
            0.0 => (0.0, 1.0),
            90.0 => (1.0, 0.0),
            180.0 => (0.0, -1.0),
            270.0 => (-1.0, 0.0),
            other => libm::sincos(other.to_radians()),
        };
        let a = axis.normalize();
        let cross =
            DMat3::from_cols(DVec3::new(0.0, a.z, -a.y), DVec3::new(-a.z, 0.0, a.x), DVec3::new(a.y, -a.x, 0.0));
        let outer = DMat3::from_cols(a * a.x, a * a.y, a * a.z);
        Self { linear: DMat3::IDENTITY * cos + cross * sin + outer * (1.0 - cos), ..Self::IDENTITY }
    }

    /// Creates the rotation of the quaternion x i + y j + z k + w, which is scaled to length 1. A quaternion of length
    /// 0 gives the identity.
    pub fn quaternion(vector: DVec3, w: f64) -> Self {
        let length = vector.length_squared() + w * w;
        if length == 0.0 {
            return Self::IDENTITY;
        }
        let column = |axis: DVec3| axis + vector.cross(vector.cross(axis) + axis * w) * (2.0 / length);
        Self { linear: DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z)), ..Self::IDENTITY }
    }

    /// Creates the map x -> linear * x + translation.
    pub fn affine(linear: DMat3, translation: DVec3) -> Self {
        Self { linear, translation }
    }

    /// Creates the translation by a vector.
    pub fn translate(by: DVec3) -> Self {
        Self { translation: by, ..Self::IDENTITY }
    }

    /// Returns this map followed by another.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        Self { linear: next.linear * self.linear, translation: next.linear * self.translation + next.translation }
    }

    /// Transforms a point.
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.linear * p + self.translation
    }

    /// Transforms a vector, the difference of two points.
    pub fn vector(&self, v: DVec3) -> DVec3 {
        self.linear * v
    }

    /// Returns the inverse map, accurate to a few roundings times the map's condition number. Returns `None` if one of
    /// its numbers is not finite.
    ///
    /// Scaling all lengths of a map by a power of two leaves the digits of its inverse unchanged.
    pub fn inverse(&self) -> Option<Self> {
        let size = self.size();
        let scaled = self.linear / size;
        let cofactors = cofactors(scaled);
        let linear = (cofactors / (scaled.x_axis.dot(cofactors.x_axis) * size)).transpose();
        let translation = -(linear * self.translation);
        (linear.is_finite() && translation.is_finite()).then_some(Self { linear, translation })
    }

    /// Returns the absolute values of the linear part: |M| in the error bounds of `point` and `vector`.
    pub fn magnitudes(&self) -> DMat3 {
        self.linear.abs()
    }

    /// Returns a bound of the rounding error of `point(p)`, per coordinate, for |p| up to `reach`: gamma(4) (|M| |p| +
    /// |t|).
    ///
    /// The three products, their two sums and the translation chain up to 4 roundings.
    pub fn rounding_error(&self, reach: DVec3) -> DVec3 {
        (self.magnitudes() * reach + self.translation.abs()) * super::gamma(4)
    }

    /// Returns a bound, per coordinate, of how far `then(back)` moves a point p, for |p| up to `reach`.
    ///
    /// With M and t for this map, N and s for `back`, it adds the deviation of the computed product from the identity
    /// and the roundings in computing it: gamma(4) (|N| |M| + 1) and gamma(5) (|N| |t| + |s|).
    pub fn round_trip_error(&self, back: &Self, reach: DVec3) -> DVec3 {
        let both = self.then(back);
        let deviation = (both.linear - DMat3::IDENTITY).abs();
        let rounded = back.magnitudes() * (self.magnitudes() * reach) + reach;
        let shifted = back.magnitudes() * self.translation.abs() + back.translation.abs();
        deviation * reach + both.translation.abs() + rounded * super::gamma(4) + shifted * super::gamma(5)
    }

    /// Multiplies a vector by the transposed linear part, which maps normals of the image back to the original.
    pub fn mul_transposed(&self, v: DVec3) -> DVec3 {
        self.linear.transpose() * v
    }

    /// Returns the unit normal of a transformed surface whose unit normal was `normal`. The front stays the front.
    ///
    /// It is computed from the cofactors, which neither overflow nor vanish before the map itself does.
    pub fn normal(&self, normal: DVec3) -> DVec3 {
        let scaled = self.linear / self.size();
        let cofactors = cofactors(scaled);
        let turned = cofactors * normal;
        let turned = unit(turned / power_of_two(turned.abs().max_element()));
        turned * 1f64.copysign(cofactors.z_axis.dot(scaled.z_axis))
    }

    /// Returns the inverse of the linear part, which maps differences of points back.
    pub fn inverse_linear(&self) -> DMat3 {
        let size = power_of_two(self.size());
        (self.linear / size).inverse() / size
    }

    /// Returns whether the map turns left hands into right hands.
    pub fn swaps_handedness(&self) -> bool {
        (self.linear / power_of_two(self.size())).determinant() < 0.0
    }

    /// Returns the corners of a triangle in the order that keeps its front in front, because a mirror image has the
    /// opposite winding.
    pub fn fix_winding<T>(&self, [a, b, c]: [T; 3]) -> [T; 3] {
        if self.swaps_handedness() { [a, c, b] } else { [a, b, c] }
    }

    /// Returns whether every plane stays a plane: the map is finite and flattens nothing.
    pub fn is_invertible(&self) -> bool {
        let scaled = self.linear * (1.0 / self.size());
        self.linear.is_finite() && self.translation.is_finite() && scaled.determinant().abs() > f64::MIN_POSITIVE
    }

    /// Returns the factor by which all lengths grow, if it is the same in all directions to a few roundings.
    pub fn uniform_scale(&self) -> Option<f64> {
        let [a, b, c] = [self.linear.x_axis, self.linear.y_axis, self.linear.z_axis];
        let tolerance = super::gamma(64);
        let lengths = [a.length(), b.length(), c.length()];
        let equal = lengths.iter().all(|l| (l / lengths[0] - 1.0).abs() <= tolerance);
        let square = [a.dot(b), b.dot(c), c.dot(a)].iter().all(|x| x.abs() <= tolerance * lengths[0] * lengths[0]);
        (equal && square).then_some(lengths[0])
    }

    /// Returns the largest absolute value of the linear part's entries, never 0.
    pub fn size(&self) -> f64 {
        let [a, b, c] = [self.linear.x_axis, self.linear.y_axis, self.linear.z_axis];
        a.abs().max(b.abs()).max(c.abs()).max_element().max(f64::MIN_POSITIVE)
    }
}

/// Returns the transposed inverse times the determinant.
fn cofactors(linear: DMat3) -> DMat3 {
    let [a, b, c] = [linear.x_axis, linear.y_axis, linear.z_axis];
    DMat3::from_cols(b.cross(c), c.cross(a), a.cross(b))
}

/// Returns the largest power of two that is not above a number. Numbers divided by it keep their digits, and their
/// squares stay in range.
fn power_of_two(number: f64) -> f64 {
    f64::from_bits(number.max(f64::MIN_POSITIVE).to_bits() & f64::INFINITY.to_bits())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_that_flatten_to_nearly_nothing_keep_normals_and_handedness() {
        for flat in [1.0, 1e-70, 1e-90, 1e-150] {
            let map = Transform::scale(DVec3::new(flat, -flat, 1.0)).then(&Transform::scale(DVec3::splat(1e-20)));
            assert!(map.is_invertible());
            assert_eq!((map.normal(DVec3::Z), map.swaps_handedness()), (DVec3::Z, true), "{flat}");
        }
    }

    #[test]
    fn maps_that_shrink_to_nearly_nothing_are_inverted() {
        let [small, large] = [-400.0, 400.0].map(|exponent| DVec3::splat(libm::exp2(exponent)));
        assert_eq!(Transform::scale(small).inverse_linear(), DMat3::from_diagonal(large));
    }
}
