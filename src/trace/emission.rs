//! How photons leave the lights.

use std::cell::Cell;
use std::f64::consts::PI;

use super::aims::{Aim, Aims};
use crate::light::{Area, Light};
use crate::math::{DVec3, Frame, Ray, cosine_hemisphere, unit};
use crate::scene::Scene;
use crate::shape::{Sides, SurfacePoint};
use crate::spectrum::Table;

/// A photon on its way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Emitted {
    pub(super) ray: Ray,
    /// The factor on the light's emission that makes the photon's flux of it.
    pub(super) factor: f64,
}

/// How often the outer side of a closed lamp around which an object is built sends a photon, and not the inner one.
const OUTWARD: f64 = 0.875;

impl Aims {
    /// The place on an aim's square for two random numbers.
    pub(super) fn place(&self, number: usize, u: [f64; 2]) -> [f64; 2] {
        self.aims[number].guide.draw(u)
    }

    /// A photon of an aim for a place on its square and two random numbers; none where the light does not shine.
    ///
    /// Its flux is divided by how many photons all aims of the light send along the same line: their cones may overlap.
    pub(super) fn emit(&self, scene: &Scene<Table>, number: usize, place: [f64; 2], u: [f64; 2]) -> Option<Emitted> {
        let aim = &self.aims[number];
        let light = &scene.lights[aim.light];
        let (ray, flux, sent) = match light {
            Light::Point(_) | Light::Spot(_) => {
                let direction = in_cone(aim.lobe, place)?;
                let (origin, part) = match light {
                    Light::Spot(spot) => (spot.position, spot.part(direction)),
                    Light::Point(point) => (point.position, 1.0),
                    _ => return None,
                };
                let density = |aim: &Aim| Some(per_steradian(aim, aim.lobe.1, place_in_cone(aim.lobe, direction)?));
                let own = per_steradian(aim, aim.lobe.1, place);
                (Ray { origin: origin.into(), direction }, part, self.sent(number, own, density))
            }
            Light::Area(area) => {
                let (point, of_point) = area.shape.emit(&aim.ball, u)?;
                let (direction, along) = toward(area, aim, &point, place)?;
                let cos = point.normal.dot(direction);
                if !area.sides.shine(cos > 0.0) {
                    return None;
                }
                let density = |aim: &Aim| {
                    let along = density_toward(area, aim, &point, direction)?;
                    Some(along * area.shape.emit_density(&aim.ball, &point))
                };
                (point.leave(direction), cos.abs(), self.sent(number, along * of_point, density))
            }
            Light::Sun(_) => {
                let sighting = light.aim(aim.ball.center, DVec3::Y, u)?;
                let sky = sighting.direction;
                let frame = Frame::about(sky);
                let [x, y] = on_disc(place)?;
                let point = aim.ball.center + frame.to_world(DVec3::new(x, y, 0.0) * aim.ball.radius);
                let view = light.view(&Ray { origin: point, direction: sky }, DVec3::Y, &sighting)?;
                let per_area = |aim: &Aim, place| aim.guide.density(place) / (4.0 * aim.ball.radius * aim.ball.radius);
                let density = |aim: &Aim| {
                    let local = frame.to_local(point - aim.ball.center) / aim.ball.radius;
                    Some(per_area(aim, place_on_square([local.x, local.y])?))
                };
                // From outside of all that is finite: only a plane can hide the sun there.
                let out = (self.world.center - point).dot(sky) + 2.0 * self.world.radius;
                let start = Ray { origin: point + sky * out, direction: sky };
                if scene.is_hidden(&start, f64::INFINITY, None, &Cell::new(None)) {
                    return None;
                }
                let flux = view.factor / view.pdf.unwrap_or(1.0);
                (Ray { direction: -sky, ..start }, flux, self.sent(number, per_area(aim, place), density))
            }
            Light::Environment(_) => return None,
        };
        let factor = flux / sent;
        (factor > 0.0 && factor.is_finite()).then_some(Emitted { ray, factor })
    }

    /// How many photons all aims of a light send along a line, per unit of its measure; `own` is the density of the aim that
    /// did.
    fn sent(&self, number: usize, own: f64, density: impl Fn(&Aim) -> Option<f64>) -> f64 {
        let light = self.aims[number].light;
        let of_light = |aim: &Aim| aim.light == light;
        let first = self.aims[..number].iter().rposition(|aim| !of_light(aim)).map_or(0, |before| before + 1);
        let aims = (first..).zip(self.aims[first..].iter().take_while(|aim| of_light(aim)));
        let of = |(other, aim): (usize, &Aim)| {
            aim.photons as f64 * if other == number { own } else { density(aim).unwrap_or(0.0) }
        };
        aims.map(of).sum()
    }
}

/// A place of the square as one of the disc in it, |q| < 1; none beside the disc.
fn on_disc(place: [f64; 2]) -> Option<[f64; 2]> {
    let [x, y] = place.map(|x| 2.0 * x - 1.0);
    (x * x + y * y < 1.0).then_some([x, y])
}

fn place_on_square([x, y]: [f64; 2]) -> Option<[f64; 2]> {
    (x * x + y * y < 1.0).then_some([0.5 * (x + 1.0), 0.5 * (y + 1.0)])
}

/// A direction of a cone for a place of the square: equal areas of the disc in it are equal solid angles, 1 - cos = r^2
/// times the cone's.
fn in_cone((axis, one_minus_cos): (DVec3, f64), place: [f64; 2]) -> Option<DVec3> {
    let [x, y] = on_disc(place)?;
    let here = (x * x + y * y) * one_minus_cos;
    let stretch = (one_minus_cos * (2.0 - here)).sqrt();
    Some(unit(Frame::about(axis).to_world(DVec3::new(x * stretch, y * stretch, 1.0 - here))))
}

/// The place of the square for a direction; none beside the cone.
fn place_in_cone((axis, one_minus_cos): (DVec3, f64), direction: DVec3) -> Option<[f64; 2]> {
    // For unit vectors, without the rounding of 1 - cos.
    let here = 0.5 * (direction - axis).length_squared();
    let local = Frame::about(axis).to_local(direction);
    let stretch = (one_minus_cos * (2.0 - here)).sqrt();
    if stretch > 0.0 {
        place_on_square([local.x / stretch, local.y / stretch]).filter(|_| here < one_minus_cos)
    } else {
        None
    }
}

/// The density of directions of a cone: a part of the square is 8 (1 - cos) times as large as a solid angle.
fn per_steradian(aim: &Aim, one_minus_cos: f64, place: [f64; 2]) -> f64 {
    aim.guide.density(place) / (8.0 * one_minus_cos)
}

/// A direction from a point of a lamp and its density: in the cone that a ball fills; by its cosine where the lamp is inside
/// the ball.
fn toward(area: &Area<Table>, aim: &Aim, from: &SurfacePoint, place: [f64; 2]) -> Option<(DVec3, f64)> {
    let cone = aim.ball.cone_from(from.position);
    if cone.1 < 2.0 {
        return Some((in_cone(cone, place)?, per_steradian(aim, cone.1, place)));
    }
    let front = front(area);
    let [u, v] = place;
    let (side, u) = if u < front { (from.normal, u / front) } else { (-from.normal, (u - front) / (1.0 - front)) };
    let direction = unit(Frame::about(side).to_world(cosine_hemisphere([u, v])));
    Some((direction, density_toward(area, aim, from, direction)?))
}

/// The density of that direction; none where it does not lead to the ball.
fn density_toward(area: &Area<Table>, aim: &Aim, from: &SurfacePoint, direction: DVec3) -> Option<f64> {
    let cone = aim.ball.cone_from(from.position);
    if cone.1 < 2.0 {
        return Some(per_steradian(aim, cone.1, place_in_cone(cone, direction)?));
    }
    let cos = from.normal.dot(direction);
    let front = front(area);
    Some(if cos > 0.0 { front } else { 1.0 - front } * cos.abs() / PI)
}

/// How often a point of a lamp inside a ball shines from its front.
fn front(area: &Area<Table>) -> f64 {
    match (area.sides, area.shape.is_closed()) {
        (Sides::Front, _) => 1.0,
        (Sides::Both, true) => OUTWARD,
        (Sides::Both, false) => 0.5,
    }
}
