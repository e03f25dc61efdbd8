use std::f64::consts::{PI, TAU};

use serde::{Deserialize, Serialize};

use super::toward_ball::TowardBall;
use crate::math::{DVec3, Ray, sample_cosine_about, unit};
use crate::shape::Ball;

/// A rectangle through which a sky's light enters a room.
///
/// Its methods treat rays as straight lines: whether a ray crosses it, ahead of its origin or behind it, does not
/// depend on anything that lies in between.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Opening {
    /// Its center.
    pub center: DVec3,
    /// Half edges at right angles. Their cross product points into the room.
    pub half: [DVec3; 2],
}

impl Opening {
    /// Returns its area.
    pub fn area(&self) -> f64 {
        let [u, v] = self.half;
        4.0 * u.cross(v).length()
    }

    /// Returns the unit normal that points into the room.
    fn normal(&self) -> DVec3 {
        let [u, v] = self.half;
        unit(u.cross(v).normalize())
    }

    /// Estimates the solid angle in steradians that it subtends at a point.
    pub fn solid_angle_from(&self, point: DVec3) -> f64 {
        let to_center = self.center - point;
        let distance_squared = to_center.length_squared();
        (self.area() * self.normal().dot(to_center).abs() / (distance_squared * distance_squared.sqrt())).min(TAU)
    }

    /// Returns its point for a place of the unit square.
    pub fn point(&self, [a, b]: [f64; 2]) -> DVec3 {
        let [u, v] = self.half;
        self.center + u * (2.0 * a - 1.0) + v * (2.0 * b - 1.0)
    }

    /// Returns how a photon leaves one of its points toward a ball.
    pub(super) fn toward<'a>(&self, ball: &'a Ball, from: DVec3) -> TowardBall<'a> {
        TowardBall { ball, from, normal: self.normal(), front_probability: 1.0 }
    }

    /// Samples the ray of a photon from one of its points toward a ball.
    pub(super) fn ray_toward(&self, ball: &Ball, guide_uv: [f64; 2], u: [f64; 2]) -> Option<Ray> {
        let origin = self.point(u);
        Some(Ray { origin, direction: self.toward(ball, origin).sample(guide_uv)? })
    }

    /// Returns the pdf with which `ray_toward` draws the line of a ray, per unit of area across it and steradian.
    pub(super) fn pdf_toward(&self, ball: &Ball, ray: &Ray, guide: impl Fn([f64; 2]) -> f64) -> f64 {
        let Some(from) = self.crossing(ray) else { return 0.0 };
        let toward = self.toward(ball, from);
        toward.pdf(ray.direction, guide) / (self.area() * toward.normal.dot(ray.direction).abs())
    }

    /// Returns the point where the line of a ray crosses it.
    fn crossing(&self, ray: &Ray) -> Option<DVec3> {
        let [u, v] = self.half;
        let across = u.cross(v);
        let t = across.dot(self.center - ray.origin) / across.dot(ray.direction);
        let place = ray.at(t) - self.center;
        let is_within = |half: DVec3| place.dot(half).abs() <= half.length_squared();
        (is_within(u) && is_within(v)).then(|| ray.at(t))
    }

    /// Returns whether the line of a ray crosses it into the room.
    pub fn is_entered_by(&self, ray: &Ray) -> bool {
        self.normal().dot(ray.direction) > 0.0 && self.crossing(ray).is_some()
    }

    /// Samples a light path's ray through one of several openings, cosine-distributed, and returns it with the pdf of
    /// its line over all of them, per unit of area across it and steradian; `None` if there are no openings.
    pub fn ray_through(openings: &[Self], [a, b, c, d]: [f64; 4]) -> Option<(Ray, f64)> {
        let all: f64 = openings.iter().map(Self::area).sum();
        let mut remaining = a * all;
        let is_chosen = |opening: &&Self| {
            remaining -= opening.area();
            remaining < 0.0
        };
        let chosen = openings.iter().find(is_chosen).or(openings.last())?;
        // The random number is reused: it is uniform within the area of the chosen opening.
        let a = (1.0 + remaining / chosen.area()).clamp(0.0, 1.0);
        let ray = Ray { origin: chosen.point([a, b]), direction: sample_cosine_about(chosen.normal(), [c, d]) };
        let entered = openings.iter().filter(|opening| opening.is_entered_by(&ray)).count();
        Some((ray, entered as f64 / (PI * all)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two openings of different sizes, one behind the other. Each draws its share of the lines that cross both.
    fn openings() -> [Opening; 2] {
        let at = |z: f64, side: f64| Opening {
            center: DVec3::new(0.1, -0.2, z),
            half: [DVec3::new(0.8 * side, 0.6 * side, 0.0), DVec3::new(-0.3, 0.4, 0.0)],
        };
        [at(0.0, 1.0), at(0.5, 0.4)]
    }

    /// The measure of lines that enter a rectangle is pi times its area. For both, lines through both count once.
    #[test]
    fn lines_through_openings_are_drawn_with_the_stated_density() {
        let openings = openings();
        let side = 64;
        let mid = |i: u32| (f64::from(i) + 0.5) / f64::from(side);
        let (mut measure, mut both, mut count) = (0.0, 0.0, 0.0);
        for number in 0..side * side {
            for [a, b] in [[0.11, 0.37], [0.42, 0.81], [0.63, 0.22], [0.97, 0.58]] {
                let u = [libm::fmod(a + mid(number % side), 1.0), libm::fmod(b + mid(number / side), 1.0)];
                let v = [libm::fmod(7.0 * u[1] + a, 1.0), libm::fmod(11.0 * u[0] + b, 1.0)];
                let (ray, pdf) = Opening::ray_through(&openings, [u[0], u[1], v[0], v[1]]).expect("there are some");
                let entered = openings.iter().filter(|opening| opening.is_entered_by(&ray)).count();
                assert!(entered > 0 && pdf > 0.0, "{ray:?} enters none");
                measure += 1.0 / pdf;
                both += f64::from(u8::from(entered == 2)) / pdf;
                count += 1.0;
            }
        }
        let all = PI * openings.iter().map(Opening::area).sum::<f64>();
        assert!(both / count > 0.05 * all, "{both} of lines through both");
        assert!(((measure + both) / count / all - 1.0).abs() < 1e-2, "{} for {all}", (measure + both) / count);
    }

    #[test]
    fn a_line_crosses_an_opening_wherever_its_ray_begins() {
        let opening = openings()[0];
        for (place, direction, is_through) in [
            ([0.1, -0.2, 3.0], [0.0, 0.0, 1.0], true),
            ([0.1, -0.2, -3.0], [0.0, 0.0, 1.0], true),
            ([0.1, -0.2, 3.0], [0.0, 0.0, -1.0], false),
            ([3.1, -0.2, 3.0], [1.0, 0.0, 1.0], true),
            ([3.1, -0.2, 3.0], [0.0, 0.0, 1.0], false),
            ([0.1, -0.2, 0.0], [1.0, 0.0, 0.0], false),
        ] {
            let direction = unit(DVec3::from(direction).normalize());
            let ray = Ray { origin: DVec3::from(place), direction };
            assert_eq!(opening.is_entered_by(&ray), is_through, "{ray:?}");
        }
    }
}
