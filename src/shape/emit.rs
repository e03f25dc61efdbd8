//! Points of shapes from which light starts, and the balls it is sent to.

use super::{Shape, SurfacePoint};
use crate::math::{DVec3, Frame, ball_surface, cone, disk, one_minus_cos_of_cone, triangle_coordinates};

/// A ball around something.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its middle.
    pub center: DVec3,
    /// Its radius.
    pub radius: f64,
}

impl Ball {
    /// Axis and 1 - cos of the half angle of the cone the ball fills, seen from a point; all directions, about any axis, from
    /// inside of it.
    pub fn cone_from(&self, from: DVec3) -> (DVec3, f64) {
        let way = self.center - from;
        let sin_squared = self.radius * self.radius / way.length_squared();
        if sin_squared < 1.0 { (way.normalize(), one_minus_cos_of_cone(sin_squared)) } else { (DVec3::Z, 2.0) }
    }

    /// Whether a point lies inside.
    pub fn contains(&self, point: DVec3) -> bool {
        (point - self.center).length_squared() <= self.radius * self.radius
    }

    /// The smallest ball around two.
    pub fn around(self, other: Self) -> Self {
        let way = other.center - self.center;
        let distance = way.length();
        if distance + other.radius <= self.radius {
            return self;
        }
        if distance + self.radius <= other.radius {
            return other;
        }
        let radius = 0.5 * (distance + self.radius + other.radius);
        Self { center: self.center + way * ((radius - self.radius) / distance), radius }
    }
}

impl Shape {
    /// A ball around the shape: itself if it is one, else that around its box; none for an infinite shape.
    pub fn ball(&self) -> Option<Ball> {
        let bounds = self.bounds()?;
        let (center, half) = (bounds.center(), 0.5 * (bounds.max - bounds.min));
        let radius = if matches!(self, Self::Sphere(_)) { half.max_element() } else { half.length() };
        Some(Ball { center, radius })
    }

    /// A point from which light may reach a ball, and its density per unit of area, which `emit_density` gives as well.
    ///
    /// Of a sphere, the cap that sees some of the ball, denser toward its middle as much as it sends more there; of other shapes,
    /// all of the surface. None of an infinite shape and of an instance.
    pub fn emit(&self, toward: &Ball, u: [f64; 2]) -> Option<(SurfacePoint, f64)> {
        let uniform = |point| Some((point, 1.0 / self.area()));
        match self {
            Self::Plane(_) | Self::Instance(_) => None,
            Self::Triangle(triangle) => uniform(triangle.point(triangle_coordinates(u))),
            Self::Disc(shape) => uniform(shape.point(disk(u).into())),
            Self::Quad(shape) => uniform(shape.point(u.map(|x| 2.0 * x - 1.0))),
            Self::Cube(cube) => {
                let (face, along) = cube.choose(u[0]);
                uniform(cube.face(face).point([2.0 * along - 1.0, 2.0 * u[1] - 1.0]))
            }
            Self::Mesh(mesh) => {
                let (triangle, along) = mesh.choose(u[0]);
                uniform(mesh.triangle(triangle).point(triangle_coordinates([along, u[1]])))
            }
            Self::Ellipsoid(ellipsoid) => {
                let unit = ball_surface(u);
                Some((ellipsoid.point_at(unit), ellipsoid.density_over(unit)))
            }
            Self::Sphere(sphere) => {
                let (axis, one_minus_cos) = cap(self.ball()?, toward);
                let u = if one_minus_cos < 2.0 { [1.0 - u[0].sqrt(), u[1]] } else { u };
                let normal = Frame::about(axis).to_world(cone(one_minus_cos, u).0);
                let point = sphere.point(sphere.over(normal));
                Some((point, self.emit_density(toward, &point)))
            }
        }
    }

    /// Density per unit of area with which `emit` draws a point of the shape for a ball.
    pub fn emit_density(&self, toward: &Ball, point: &SurfacePoint) -> f64 {
        match self {
            Self::Sphere(_) => {
                let Some((axis, one_minus_cos)) = self.ball().map(|own| cap(own, toward)) else { return 0.0 };
                // 1 - cos of the angle from the middle; a far ball gets light by the cosine, which is 0 at the rim.
                let here = 0.5 * (point.normal - axis).length_squared();
                let share = if one_minus_cos < 2.0 { 2.0 * (1.0 - here / one_minus_cos).max(0.0) } else { 1.0 };
                share * 2.0 / (one_minus_cos * self.area())
            }
            Self::Ellipsoid(ellipsoid) => ellipsoid.density_over(ellipsoid.unit_of(point.position)),
            _ => 1.0 / self.area(),
        }
    }
}

/// Axis and 1 - cos of the cap of a sphere that sees some of a ball: n . (c - l) > r - R for its unit normals n, if the
/// ball lies outside; else all of the sphere.
fn cap(sphere: Ball, toward: &Ball) -> (DVec3, f64) {
    let way = toward.center - sphere.center;
    let distance = way.length();
    if distance <= sphere.radius + toward.radius {
        return (DVec3::Z, 2.0);
    }
    (way / distance, 1.0 - (sphere.radius - toward.radius) / distance)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::shape::Sphere;

    #[test]
    fn the_cap_that_light_leaves_from_sees_the_ball_and_no_other_point_does() {
        let toward = Ball { center: DVec3::new(3.0, 1.0, -2.0), radius: 1.5 };
        let (center, radius) = (DVec3::new(-1.0, 0.5, 0.0), 0.7);
        let sphere = Shape::Sphere(Sphere::new(center, radius));
        let (axis, one_minus_cos) = cap(Ball { center, radius }, &toward);
        let sees = |normal: DVec3| {
            let point = center + normal * radius;
            // The farthest that the ball reaches beyond the plane that touches the sphere in this point.
            normal.dot(toward.center - point) + toward.radius > 0.0
        };
        let mut within = 0;
        for i in 0..10_000 {
            let normal = ball_surface([(f64::from(i) + 0.5) / 1e4, (f64::from(i) * 0.618_034).fract()]);
            let inside = 0.5 * (normal - axis).length_squared() <= one_minus_cos;
            assert_eq!(inside, sees(normal), "{normal}");
            within += i32::from(inside);
        }
        assert!((f64::from(within) / 1e4 - 0.5 * one_minus_cos).abs() < 1e-3);
        // Points drawn, each over its density, measure the cap: its area, and that of its inner half.
        let (mut all, mut inner) = (0.0, 0.0);
        for i in 0..10_000 {
            let u = [(f64::from(i) + 0.5) / 1e4, (f64::from(i) * 0.618_034).fract()];
            let (point, density) = sphere.emit(&toward, u).expect("a sphere has points");
            assert_eq!(sphere.emit_density(&toward, &point), density);
            all += 1e-4 / density;
            inner += if (point.normal - axis).length_squared() < one_minus_cos { 1e-4 / density } else { 0.0 };
        }
        let area = 2.0 * PI * radius * radius * one_minus_cos;
        assert!((all / area - 1.0).abs() < 0.01 && (inner / area - 0.5).abs() < 0.01, "{all} {inner} for {area}");
    }
}
