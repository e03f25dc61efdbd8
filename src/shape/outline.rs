use crate::math::{DVec3, unit};

/// A triangle or parallelogram as seen from a point, sampled uniformly in solid angle.
///
/// Peters 2021, *BRDF Importance Sampling for Polygonal Lights*, section 4.1: the polygon is a fan of spherical
/// triangles about the first corner. The first random number sweeps along the far side of the fan. The second divides
/// the arc from the corner to that point.
pub(super) struct Outline {
    corners: [DVec3; 4],
    parts: [SphericalTriangle; 2],
    /// Solid angle in steradians.
    pub(super) solid_angle: f64,
}

/// Terms of the solid angle of one spherical triangle, 2 atan2(volume, across + along).
///
/// Van Oosterom & Strackee 1983, *The Solid Angle of a Plane Triangle*: for the unit vectors a, b, c to the corners,
/// the volume is a . (b x c) and the other term is 1 + a . b + b . c + c . a. `along` is 1 + a . b, and `across` is the
/// rest.
#[derive(Clone, Copy, Default)]
struct SphericalTriangle {
    volume: f64,
    across: f64,
    along: f64,
}

/// Smallest solid angle that is sampled uniformly. Directions are accurate to 2^-51, so that for an outline at most 2
/// pi long, less than a millionth of the samples lies outside. It is also the smallest absolute value of a complex
/// number whose argument is taken. The terms of that number are accurate to a few 2^-52, and both vanish only if the
/// point lies on the fan's diagonal.
const MIN_SOLID_ANGLE: f64 = 1.0 / (1u64 << 28) as f64;

/// Distance, in half diagonals, beyond which sampling by area does as well: benches/README.md.
const MAX_RELATIVE_DISTANCE: f64 = 4.0;

/// Returns whether solid angles are worth their cost for a shape at the end of the vector `offset`. `radius2` is the
/// square of the shape's half diagonal.
pub(super) fn is_near(offset: DVec3, radius2: f64) -> bool {
    offset.length_squared() < MAX_RELATIVE_DISTANCE * MAX_RELATIVE_DISTANCE * radius2
}

impl Outline {
    /// Returns the outline of a flat polygon with three or four corners, in order. `cross` is the cross product of
    /// its first two edges, twice the area of a triangle. Returns `None` if the outline is too narrow to be sampled.
    pub(super) fn seen_from(from: DVec3, corners: &[DVec3], cross: DVec3) -> Option<Self> {
        let offsets: [DVec3; 4] = std::array::from_fn(|i| corners[i.min(corners.len() - 1)] - from);
        let lengths = offsets.map(|offset| offset.length());
        let units: [DVec3; 4] = std::array::from_fn(|i| offsets[i] / lengths[i]);
        let height = (0.5 * (offsets[0] + offsets[2])).dot(cross).abs();
        let mut parts = [SphericalTriangle::default(); 2];
        let (mut real, mut imaginary) = (1.0, 0.0);
        for (i, part) in parts.iter_mut().enumerate().take(corners.len() - 2) {
            let [apex, a, b] = [0, i + 1, i + 2];
            let volume = height / (lengths[apex] * lengths[a] * lengths[b]);
            let across = units[a].dot(units[b]) + units[apex].dot(units[b]);
            *part = SphericalTriangle { volume, across, along: 1.0 + units[apex].dot(units[a]) };
            // Half solid angles add up like the arguments of complex numbers.
            let sum = part.across + part.along;
            if volume.max(sum.abs()) < MIN_SOLID_ANGLE {
                return None;
            }
            (real, imaginary) = (real * sum - imaginary * volume, real * volume + imaginary * sum);
        }
        let solid_angle = 2.0 * libm::atan2(imaginary, real);
        (solid_angle >= MIN_SOLID_ANGLE).then_some(Self { corners: units, parts, solid_angle })
    }

    /// Samples a direction within the outline, with density 1 / `solid_angle`.
    pub(super) fn sample(&self, u: [f64; 2]) -> DVec3 {
        let (mut sin, mut cos) = libm::sincos(0.5 * u[0] * self.solid_angle);
        let (mut part, mut number) = (self.parts[0], 0);
        if self.parts[1].volume > 0.0 {
            // The rest beyond the first triangle, from the sine and cosine of the difference of the angles.
            let sum = part.across + part.along;
            let rest = sin * sum - cos * part.volume;
            if rest > 0.0 {
                let length = (sum * sum + part.volume * part.volume).sqrt();
                (sin, cos) = (rest / length, (cos * sum + sin * part.volume) / length);
                (part, number) = (self.parts[1], 1);
            }
        }
        let [apex, a, b] = [self.corners[0], self.corners[number + 1], self.corners[number + 2]];
        // The direction m = x a + y b for which a, the apex and the mirror image of a behind m enclose the requested
        // solid angle. Both terms of the formula are linear in m.
        let middle = a * (part.volume * cos - part.across * sin) + b * (part.along * sin);
        let far = middle * (2.0 * a.dot(middle) / middle.length_squared()) - a;
        // Heights above the apex are sampled uniformly. 1 - cos is computed from the chord, which keeps its digits on
        // short arcs.
        let end = 0.5 * (far - apex).length_squared();
        let x = u[1] * end;
        let across = far - apex * (1.0 - end);
        let stretch = ((x * (2.0 - x)) / (end * (2.0 - end))).max(0.0).sqrt();
        unit(apex * (1.0 - x) + across * if stretch.is_finite() { stretch } else { 0.0 })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    fn square(side: f64, center: DVec3) -> Option<Outline> {
        let (u, v) = (DVec3::X * 0.5 * side, DVec3::Y * 0.5 * side);
        Outline::seen_from(
            DVec3::ZERO,
            &[center - u - v, center + u - v, center + u + v, center - u + v],
            4.0 * u.cross(v),
        )
    }

    #[test]
    fn l4_solid_angles_keep_six_digits_in_any_position() {
        // A pyramid over a square of side s and height h: 4 atan(s^2 / (4 h sqrt(s^2 / 2 + h^2))).
        for side in [1.0f64, 1e-2, 1e-4] {
            let exact = 4.0 * libm::atan(0.25 * side * side / (0.5 * side * side + 1.0).sqrt());
            let outline = square(side, DVec3::Z).expect("it is wide enough");
            assert!((outline.solid_angle / exact - 1.0).abs() < 1e-12, "{side}: {} {exact}", outline.solid_angle);
        }
        for height in [1e-7f64, 1e-4, 0.1, 1.0, 3.0] {
            let exact = 4.0 * libm::atan(0.25 / (height * (0.5 + height * height).sqrt()));
            let outline = square(1.0, DVec3::Z * height).expect("it is near");
            assert!((outline.solid_angle / exact - 1.0).abs() < 1e-8, "{height}: {} {exact}", outline.solid_angle);
        }
        // Seen along its plane: the difference of two rectangles that begin below the point, by their corners as above.
        for height in [1e-1f64, 1e-2, 1e-4, 1e-6, 1e-7] {
            let outline = square(1.0, DVec3::new(1.0, 0.0, height)).expect("it is near and wide enough");
            // Each rectangle fills nearly half of all directions: their complements keep the digits.
            let corner = |x: f64| 2.0 * libm::atan2(x * 0.5, height * (x * x + 0.25 + height * height).sqrt());
            let flat = |x: f64| 2.0 * libm::atan2(height * (x * x + 0.25 + height * height).sqrt(), x * 0.5);
            let exact = if height > 0.05 { corner(1.5) - corner(0.5) } else { flat(0.5) - flat(1.5) };
            assert!((outline.solid_angle / exact - 1.0).abs() < 1e-6, "{height}: {} {exact}", outline.solid_angle);
        }
    }

    #[test]
    fn l5_outlines_seen_edge_on_are_left_to_their_area() {
        assert!(square(1.0, DVec3::X).is_none() && square(1.0, DVec3::new(0.5, 0.5, 0.0)).is_none());
        assert!(square(1.0, DVec3::X + DVec3::Z * 1e-12).is_none());
        assert!(square(1.0, DVec3::ZERO).is_none() && square(1.0, DVec3::Z * 1e-300).is_none());
        let around = square(1.0, DVec3::new(0.1, 0.2, 1e-300)).expect("it fills half of all directions");
        assert!((around.solid_angle / (2.0 * PI) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn directions_lie_within_the_outline_at_the_ends_of_the_unit_square() {
        for center in [DVec3::Z, DVec3::Z * 1e-4, DVec3::new(0.5, 0.2, 1e-3), DVec3::new(2.0, 0.0, 0.3)] {
            let outline = square(1.0, center).expect("it is near");
            for u in (0..9).flat_map(|i| (0..9).map(move |j| [i, j].map(|k| f64::from(k) * 0.124_999_99))) {
                let direction = outline.sample(u);
                let at = direction * (center.z / direction.z) - center;
                let out = (at.abs().max_element() - 0.5).max(0.0);
                assert!(direction.is_finite() && out < 1e-6, "{center} {u:?}: {direction} is {out} beside");
            }
        }
    }
}
