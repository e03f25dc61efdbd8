use crate::math::{Bounds, Cone, DVec3, one_minus_cos_of_cone};

/// A bounding ball.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Center of the ball.
    pub center: DVec3,
    /// Radius of the ball.
    pub radius: f64,
}

impl Ball {
    /// Creates the ball through the corners of a box.
    pub fn of_box(bounds: &Bounds) -> Self {
        Self { center: bounds.center(), radius: 0.5 * bounds.size().length() }
    }

    /// Returns the cone of directions in which the ball is seen from a point, or all directions if the point is inside.
    pub fn cone_from(&self, from: DVec3) -> Cone {
        let to_other = self.center - from;
        let sin_squared = self.radius * self.radius / to_other.length_squared();
        if sin_squared < 1.0 {
            Cone { axis: to_other.normalize(), one_minus_cos: one_minus_cos_of_cone(sin_squared) }
        } else {
            Cone::ALL
        }
    }

    /// Returns whether a point lies inside the ball.
    pub fn contains(&self, point: DVec3) -> bool {
        (point - self.center).length_squared() <= self.radius * self.radius
    }

    /// Returns the smallest ball that contains two balls.
    #[must_use]
    pub fn around(self, other: Self) -> Self {
        let to_other = other.center - self.center;
        let distance = to_other.length();
        if distance + other.radius <= self.radius {
            return self;
        }
        if distance + self.radius <= other.radius {
            return other;
        }
        let radius = 0.5 * (distance + self.radius + other.radius);
        Self { center: self.center + to_other * ((radius - self.radius) / distance), radius }
    }

    /// Returns the unit normals n of the points of the ball's surface that see some part of another ball. With centers
    /// l and c and radii r and R, these satisfy n . (c - l) > r - R if the balls lie apart. Otherwise returns all
    /// normals.
    pub fn cap_toward(&self, other: &Self) -> Cone {
        let to_other = other.center - self.center;
        let distance = to_other.length();
        if distance <= self.radius + other.radius {
            return Cone::ALL;
        }
        Cone { axis: to_other / distance, one_minus_cos: 1.0 - (self.radius - other.radius) / distance }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::math::sample_sphere;
    use crate::shape::{Shape, Sphere};

    #[test]
    fn the_cap_that_light_leaves_from_sees_the_ball_and_no_other_point_does() {
        let toward = Ball { center: DVec3::new(3.0, 1.0, -2.0), radius: 1.5 };
        let (center, radius) = (DVec3::new(-1.0, 0.5, 0.0), 0.7);
        let sphere = Shape::Sphere(Sphere::new(center, radius));
        let Cone { axis, one_minus_cos } = Ball { center, radius }.cap_toward(&toward);
        let sees = |normal: DVec3| {
            let point = center + normal * radius;
            // How far the ball reaches beyond the plane that touches the sphere at this point.
            normal.dot(toward.center - point) + toward.radius > 0.0
        };
        let mut within = 0;
        for i in 0..10_000 {
            let normal = sample_sphere([(f64::from(i) + 0.5) / 1e4, (f64::from(i) * 0.618_034).fract()]);
            let inside = 0.5 * (normal - axis).length_squared() <= one_minus_cos;
            assert_eq!(inside, sees(normal), "{normal}");
            within += i32::from(inside);
        }
        assert!((f64::from(within) / 1e4 - 0.5 * one_minus_cos).abs() < 1e-3);
        // Sums of 1 / density over sampled points estimate the area of the cap, and that of its inner half.
        let (mut all, mut inner) = (0.0, 0.0);
        for i in 0..10_000 {
            let u = [(f64::from(i) + 0.5) / 1e4, (f64::from(i) * 0.618_034).fract()];
            let point = sphere.sample_emission(&toward, u).expect("a sphere has points");
            let density = sphere.pdf_emission(&toward, &point);
            all += 1e-4 / density;
            inner += if (point.normal - axis).length_squared() < one_minus_cos { 1e-4 / density } else { 0.0 };
        }
        let area = 2.0 * PI * radius * radius * one_minus_cos;
        assert!((all / area - 1.0).abs() < 0.01 && (inner / area - 0.5).abs() < 0.01, "{all} {inner} for {area}");
    }

    #[test]
    fn light_leaves_most_often_from_the_part_that_is_seen_and_from_elsewhere_as_often_as_its_density_says() {
        let toward = Ball { center: DVec3::new(3.0, 1.0, -2.0), radius: 1.5 };
        let (center, radius) = (DVec3::new(-1.0, 0.5, 0.0), 0.7);
        let sphere = Sphere::new(center, radius);
        let seen = Cone { axis: (toward.center - center).normalize(), one_minus_cos: 0.02 };
        let (mut all, mut part, mut drawn) = (0.0, 0.0, 0.0);
        for i in 0..100_000 {
            let u = [(f64::from(i) + 0.5) / 1e5, (f64::from(i) * 0.618_034).fract()];
            let point = sphere.sample_cap_emission(&seen, &toward, u);
            let density = sphere.pdf_cap_emission(&seen, &toward, &point);
            let is_seen = seen.contains(point.normal);
            all += 1e-5 / density;
            part += if is_seen { 1e-5 / density } else { 0.0 };
            drawn += if is_seen { 1e-5 } else { 0.0 };
        }
        let area = |one_minus_cos: f64| 2.0 * PI * radius * radius * one_minus_cos;
        let whole = area(Ball { center, radius }.cap_toward(&toward).one_minus_cos);
        assert!((all / whole - 1.0).abs() < 0.01, "{all} for {whole}");
        assert!((part / area(0.02) - 1.0).abs() < 0.01 && drawn > 0.95, "{part} for {}, {drawn}", area(0.02));
    }
}
