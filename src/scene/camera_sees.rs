//! Where a camera sees a point: the inverse of its rays.

use std::f64::consts::{PI, TAU};

use super::{Camera, Projection};
use crate::math::{DVec2, DVec3, disk};

/// How a camera sees a point of the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Where on the film, in pixels from the top left corner; beyond the image as well.
    pub film: DVec2,
    /// Where the camera's ray to the point starts.
    pub start: DVec3,
    /// Unit vector from the point to the camera.
    pub direction: DVec3,
    /// Square pixels per unit of area at the point that faces the camera.
    ///
    /// Light that leaves a surface with radiance L adds L x area x cosine x importance to the pixels it is spread over.
    pub importance: f64,
}

impl Camera {
    /// Where a point is seen through the point of the lens that belongs to a point of the unit square; none before the near
    /// plane or behind the camera.
    pub fn see(&self, point: DVec3, u: [f64; 2]) -> Option<Seen> {
        let to_point = point - self.position;
        if self.projection == Projection::Equirectangular {
            return self.see_all_around(to_point);
        }
        let depth = to_point.dot(self.forward);
        if !(depth > self.near && depth > 0.0) {
            return None;
        }
        let place = self.lens.map_or(DVec2::ZERO, |lens| disk(u) * lens.radius);
        let bend = self.lens.map_or(DVec2::ZERO, |lens| place * lens.inverse_focus);
        let across = DVec2::new(to_point.dot(self.right), to_point.dot(self.up)) - place;
        // The ray runs along (slope, 1) from `corner` + `place`.
        let parallel = matches!(self.projection, Projection::Orthographic { .. });
        let slope = if parallel { -bend } else { across / depth };
        let corner = if parallel { across - slope * depth } else { DVec2::ZERO };
        let window = if parallel { corner } else { slope + bend };
        let scaled = (window - self.center) / self.half;
        let film = DVec2::new(0.5 * (1.0 + scaled.x), 0.5 * (1.0 - scaled.y)) * self.size;
        let in_world = |v: DVec2| self.right * v.x + self.up * v.y;
        let along = self.forward + in_world(slope);
        let length = along.length();
        let pixels = self.size.x * self.size.y / (4.0 * self.half.x * self.half.y);
        // A unit of area that faces the ray fills `length` of the window of parallel rays; of one a unit before the camera
        // it fills length / depth^2, as its solid angle is 1 / (length depth)^2 and the window's cosine 1 / length.
        let importance = if parallel { pixels * length } else { pixels * length / (depth * depth) };
        let start = self.position + in_world(corner + place) + along * self.near;
        Some(Seen { film, start, direction: -along / length, importance })
    }

    fn see_all_around(&self, to_point: DVec3) -> Option<Seen> {
        let distance = to_point.length();
        if !(distance > self.near && distance > 0.0) {
            return None;
        }
        let along = to_point / distance;
        let (x, y, z) = (along.dot(self.right), along.dot(self.up), along.dot(self.forward));
        let level = (x * x + z * z).sqrt();
        let longitude = libm::atan2(-x, z);
        let latitude = libm::atan2(y, level);
        let film = DVec2::new(0.5 - longitude / TAU, 0.5 - latitude / PI) * self.size;
        let importance = self.size.x * self.size.y / (TAU * PI * level * distance * distance);
        let start = self.position + along * self.near;
        importance.is_finite().then_some(Seen { film, start, direction: -along, importance })
    }

    /// All places of the film that show what one of them shows, no farther than `reach` pixels outside of the image: itself
    /// and, in an equirectangular image, its copies beyond the seam and the poles.
    pub fn places(&self, film: DVec2, reach: f64) -> Vec<DVec2> {
        if self.projection != Projection::Equirectangular {
            return vec![film];
        }
        let DVec2 { x: width, y: height } = self.size;
        let turns = |size: f64| (reach / size).ceil() as i32 + 1;
        let mut places = Vec::new();
        // Beyond a pole the film goes on at the other side of it, upside down.
        for start in [film, DVec2::new(film.x + 0.5 * width, -film.y)] {
            for (i, j) in
                (-turns(width)..=turns(width)).flat_map(|i| (-turns(height)..=turns(height)).map(move |j| (i, j)))
            {
                let place = start + DVec2::new(f64::from(i) * width, f64::from(j) * 2.0 * height);
                let inside = |x: f64, size: f64| x >= -reach && x <= size + reach;
                if inside(place.x, width) && inside(place.y, height) {
                    places.push(place);
                }
            }
        }
        places
    }
}
