use std::f64::consts::{PI, TAU};

use crate::film::Optics;
use crate::math::{DVec2, DVec3, Frame, Ray, disk, unit};

/// From where the scene is seen, and how directions become places in the image.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    position: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    projection: Projection,
    /// Half of the image in the plane one unit before the camera, or half of an orthographic view.
    half: DVec2,
    /// The middle of the image there.
    center: DVec2,
    size: DVec2,
    near: f64,
    pub(super) lens: Option<Lens>,
    /// Distance of the point looked at.
    reach: f64,
    /// Width of what is behind the lens, in mm. No ray depends on it.
    sensor_width: Option<f64>,
    filter: Option<PolarizingFilter>,
}

/// How directions become places in the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// Rays from one point through a window.
    Perspective {
        /// Full angle from the bottom to the top of the image, in degrees.
        vertical_fov: f64,
    },
    /// Parallel rays.
    Orthographic {
        /// Height of the view in scene units.
        height: f64,
    },
    /// Rays of the full sphere: longitude falls from half a turn at the left edge to minus half a turn at the right
    /// one, latitude from a quarter turn at the top. The viewing direction is in the middle, the camera's left at the
    /// left quarter: looking along +z, that is +x (OpenEXR, `ImfEnvmap.h`, `ENVMAP_LATLONG`).
    Equirectangular,
}

impl Projection {
    /// The name in a scene file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Perspective { .. } => "perspective",
            Self::Orthographic { .. } => "orthographic",
            Self::Equirectangular => "equirectangular",
        }
    }
}

/// A thin lens, on which the rays of a pixel start and behind which they meet again where it is focused.
///
/// Potmesil & Chakravarty 1981, *A Lens and Aperture Camera Model for Synthetic Image Generation*.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    pub(super) radius: f64,
    /// One over the distance of the plane in focus: 0 where that is infinitely far away.
    pub(super) inverse_focus: f64,
}

/// A linear polarizer before the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PolarizingFilter {
    /// The direction that it lets through, from the image's right toward its top, in radians.
    pub angle: f64,
    /// What it lets through of light across that direction, 0 to 1.
    pub extinction: f64,
}

impl PolarizingFilter {
    /// What it lets through of unpolarized light.
    pub fn transmittance(&self) -> f64 {
        0.5 * (1.0 + self.extinction)
    }
}

impl Lens {
    /// A lens of a radius, in focus at a distance along the viewing direction, which may be infinite.
    pub fn new(radius: f64, focus_distance: f64) -> Self {
        Self { radius, inverse_focus: 1.0 / focus_distance }
    }
}

/// Angle in radians below which `up` and the viewing direction count as parallel.
const PARALLEL: f64 = 1e-4;

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
    /// The pinhole camera at `position` that sees the point `target` in the middle of an image of `size` pixels.
    ///
    /// The second answer says whether `up` was so nearly parallel to the viewing direction that another was taken.
    pub fn new(position: DVec3, target: DVec3, up: DVec3, projection: Projection, size: [u32; 2]) -> (Self, bool) {
        let forward = (target - position).normalize();
        let across = forward.cross(up.normalize());
        let parallel = across.length() < PARALLEL;
        let right = if parallel { Frame::about(forward).to_world(DVec3::X) } else { across.normalize() };
        let size = DVec2::new(f64::from(size[0]), f64::from(size[1]));
        let half_height = match projection {
            Projection::Perspective { vertical_fov } => libm::tan(vertical_fov.to_radians() / 2.0),
            Projection::Orthographic { height } => height / 2.0,
            Projection::Equirectangular => 0.5,
        };
        let camera = Self {
            position,
            right,
            up: right.cross(forward),
            forward,
            projection,
            half: DVec2::new(half_height * size.x / size.y, half_height),
            center: DVec2::ZERO,
            size,
            near: 0.0,
            lens: None,
            reach: (target - position).length(),
            sensor_width: None,
            filter: None,
        };
        (camera, parallel)
    }

    /// The same camera with rays that start where their distance along the viewing direction is `near`; in an
    /// equirectangular image, at that distance.
    #[must_use]
    pub fn starting_at(self, near: f64) -> Self {
        Self { near, ..self }
    }

    /// The same camera with the window onto the world moved to the right and up by fractions of the image's height.
    #[must_use]
    pub fn shifted(self, [right, up]: [f64; 2]) -> Self {
        Self { center: DVec2::new(right, up) * (2.0 * self.half.y), ..self }
    }

    /// The same camera with a lens; one without extent is a pinhole.
    #[must_use]
    pub fn with_lens(self, lens: Option<Lens>) -> Self {
        Self { lens: lens.filter(|lens| lens.radius > 0.0), ..self }
    }

    /// The same camera, whose full image a sensor of this width in mm takes up.
    #[must_use]
    pub fn on_sensor(self, width: Option<f64>) -> Self {
        Self { sensor_width: width, ..self }
    }

    /// The same camera behind a filter.
    #[must_use]
    pub fn behind(self, filter: Option<PolarizingFilter>) -> Self {
        Self { filter, ..self }
    }

    /// What the lens and the sensor are like, as far as the scene says it. Of a perspective view a sensor's width tells
    /// how far behind the lens it is; a thin lens that is in focus at a distance d and has its image at a distance v is
    /// of the focal length 1 / (1 / v + 1 / d).
    pub fn optics(&self, meters_per_unit: Option<f64>) -> Optics {
        let (width, is_flat) = (2.0 * self.half.x, matches!(self.projection, Projection::Perspective { .. }));
        let sensor = self.sensor_width.filter(|_| is_flat);
        let pinhole_focal_length = sensor.map(|sensor| sensor / width);
        let lens = self.lens.zip(meters_per_unit);
        let mm = |lens: Lens, meters: f64| (1e3 * meters * lens.radius, lens.inverse_focus / (1e3 * meters));
        let of_lens = lens.zip(pinhole_focal_length).map(|((lens, meters), behind)| {
            let (radius, inverse_focus) = mm(lens, meters);
            let focal_length = 1.0 / (1.0 / behind + inverse_focus);
            (focal_length, focal_length / (2.0 * radius))
        });
        let (focal_length, f_number) = of_lens.unzip();
        Optics {
            near: Some(self.near).filter(|near| *near > 0.0),
            sensor: sensor.map(|across| [across, across * self.size.y / self.size.x]),
            pinhole_focal_length,
            focal_length,
            f_number,
            focus: lens.map(|(lens, meters)| meters / lens.inverse_focus),
        }
    }

    /// The ray through a point of the film, in pixels from the top left corner, and the middle of the lens.
    pub fn ray(&self, film: DVec2) -> Ray {
        let (start, along) = self.axis(film);
        Ray { origin: start + along * self.near, direction: unit(along) }
    }

    /// The ray through a point of the film and the point of the lens that belongs to a point of the unit square.
    ///
    /// A ray that starts at a point of the lens runs along (x, y, 1) - point / F: so all rays of one point of the film
    /// meet at distance F, and none is lost where 1 / F is 0.
    pub fn lens_ray(&self, film: DVec2, u: [f64; 2]) -> Ray {
        let Some(lens) = self.lens else { return self.ray(film) };
        let (start, along) = self.axis(film);
        let place = disk(u) * lens.radius;
        let place = self.right * place.x + self.up * place.y;
        let along = along - place * lens.inverse_focus;
        Ray { origin: start + place + along * self.near, direction: unit(along) }
    }

    /// How far behind the start of a ray, whose direction is a unit vector, the camera is: as far as the near plane is
    /// along it.
    pub fn way_to_start(&self, direction: DVec3) -> f64 {
        match self.projection {
            Projection::Equirectangular => self.near,
            _ => self.near / direction.dot(self.forward),
        }
    }

    /// Where the ray through the middle of the lens starts, but for the near plane, and where to: one unit forward, or
    /// one unit in all in an equirectangular image.
    fn axis(&self, film: DVec2) -> (DVec3, DVec3) {
        let x = (2.0 * film.x / self.size.x - 1.0) * self.half.x + self.center.x;
        let y = (1.0 - 2.0 * film.y / self.size.y) * self.half.y + self.center.y;
        match self.projection {
            Projection::Perspective { .. } => (self.position, self.forward + self.right * x + self.up * y),
            Projection::Orthographic { .. } => (self.position + self.right * x + self.up * y, self.forward),
            Projection::Equirectangular => {
                let (sin, cos) = libm::sincos(TAU * (0.5 - film.x / self.size.x));
                let (sin_latitude, cos_latitude) = libm::sincos(PI * (0.5 - film.y / self.size.y));
                let level = self.forward * cos - self.right * sin;
                (self.position, level * cos_latitude + self.up * sin_latitude)
            }
        }
    }

    /// What the image records as the depth of a point: its distance along the viewing direction, or its distance in an
    /// equirectangular image.
    pub fn depth(&self, point: DVec3) -> f64 {
        match self.projection {
            Projection::Equirectangular => (point - self.position).length(),
            _ => (point - self.position).dot(self.forward),
        }
    }

    /// The diameter of the image of a point at a depth, in heights of the whole image: 0 in focus, and of a pinhole.
    pub fn blur(&self, depth: f64) -> f64 {
        let Some(lens) = self.lens else { return 0.0 };
        let spread = match self.projection {
            Projection::Orthographic { .. } => 1.0 - depth * lens.inverse_focus,
            _ => 1.0 / depth - lens.inverse_focus,
        };
        lens.radius * spread.abs() / self.half.y
    }

    /// Where the camera is.
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// The unit vector along the camera's axis, toward the middle of an image without shift.
    pub fn forward(&self) -> DVec3 {
        self.forward
    }

    /// The projection onto the film.
    pub fn projection(&self) -> Projection {
        self.projection
    }

    /// The horizontal of the image, to the right, across a ray in a direction: x of Stokes vectors. A unit vector.
    pub fn image_right(&self, direction: DVec3) -> DVec3 {
        let right = match self.projection {
            Projection::Equirectangular => direction.cross(self.up),
            _ => self.right - direction * direction.dot(self.right),
        };
        right.try_normalize().unwrap_or(self.right)
    }

    /// The share of unpolarized light that reaches it: 1 without a filter before it.
    pub fn transmittance(&self) -> f64 {
        self.filter.map_or(1.0, |filter| filter.transmittance())
    }

    /// The filter before it, if there is one.
    pub fn filter(&self) -> Option<PolarizingFilter> {
        self.filter
    }

    /// Whether the rays of a point of the film start on a lens with an extent.
    pub fn has_lens(&self) -> bool {
        self.lens.is_some()
    }

    /// Whether rays start away from the camera's position.
    pub fn starts_away(&self) -> bool {
        self.near > 0.0 || self.has_lens() || matches!(self.projection, Projection::Orthographic { .. })
    }

    /// World to camera for row vectors: +x right, +y up, +z forward.
    pub fn world_to_camera(&self) -> [[f64; 4]; 4] {
        let [x, y, z] = [self.right, self.up, self.forward];
        let shift = [x, y, z].map(|axis| -self.position.dot(axis));
        [[x.x, y.x, z.x, 0.0], [x.y, y.y, z.y, 0.0], [x.z, y.z, z.z, 0.0], [shift[0], shift[1], shift[2], 1.0]]
    }

    /// World to normalized device coordinates for row vectors, after a division by the fourth number: x and y are 0 at
    /// the top left corner of the full image and 1 at the bottom right one; z grows with the distance. None of a view
    /// all around. What a lens blurs is where its middle sees it.
    pub fn world_to_ndc(&self) -> Option<[[f64; 4]; 4]> {
        let (scale, middle) = (0.5 / self.half, self.center * 0.5 / self.half);
        let (x, y) = (0.5 - middle.x, 0.5 + middle.y);
        let of_camera = match self.projection {
            Projection::Perspective { .. } => {
                [[scale.x, 0.0, 0.0, 0.0], [0.0, -scale.y, 0.0, 0.0], [x, y, 1.0, 1.0], [0.0, 0.0, -1.0, 0.0]]
            }
            Projection::Orthographic { .. } => {
                [[scale.x, 0.0, 0.0, 0.0], [0.0, -scale.y, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [x, y, 0.0, 1.0]]
            }
            Projection::Equirectangular => return None,
        };
        let product = |row: [f64; 4]| [0, 1, 2, 3].map(|to| (0..4).map(|i| row[i] * of_camera[i][to]).sum());
        Some(self.world_to_camera().map(product))
    }

    /// The angle of a pixel in the middle of the image, in radians.
    ///
    /// Pixels of an orthographic view have none; it is the angle under which one appears from as far away as the point
    /// looked at, or as the view is wide if that is more.
    pub fn pixel_angle(&self) -> f64 {
        let pixel = 2.0 * self.half.x / self.size.x;
        match self.projection {
            Projection::Perspective { .. } => pixel,
            Projection::Orthographic { .. } => pixel / self.reach.max(2.0 * self.half.length()),
            Projection::Equirectangular => (TAU / self.size.x).min(PI / self.size.y),
        }
    }

    /// How wide a pixel in the middle of the image is at a distance.
    pub fn pixel_width(&self, distance: f64) -> f64 {
        match self.projection {
            Projection::Orthographic { .. } => 2.0 * self.half.x / self.size.x,
            _ => self.pixel_angle() * distance,
        }
    }

    /// Width of the image in the plane one unit before the camera; 1 in an equirectangular image, which has no such
    /// width (OpenEXR, *Technical Introduction*).
    pub fn screen_window_width(&self) -> f64 {
        match self.projection {
            Projection::Equirectangular => 1.0,
            _ => 2.0 * self.half.x,
        }
    }

    /// The middle of the image in the plane one unit before the camera, to the right and up.
    pub fn screen_window_center(&self) -> [f64; 2] {
        self.center.into()
    }

    /// Where a point is seen through the point of the lens that belongs to a point of the unit square; none before the
    /// near plane or behind the camera.
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
        // A unit of area that faces the ray fills `length` of the window of parallel rays; of one a unit before the
        // camera it fills length / depth^2, as its solid angle is 1 / (length depth)^2 and the window's cosine 1 /
        // length.
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

    /// All places of the film that show what one of them shows, no farther than `reach` pixels outside of the image:
    /// itself and, in an equirectangular image, its copies beyond the seam and the poles.
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

#[cfg(test)]
mod tests {
    use super::*;

    const PROJECTION: Projection = Projection::Perspective { vertical_fov: 40.0 };

    /// Row C1 of the stability catalog.
    #[test]
    fn c1_the_frame_is_orthonormal_for_every_angle_between_up_and_view() {
        let target = DVec3::new(1.0, 2.0, -3.0);
        let side = Frame::about(target.normalize()).to_world(DVec3::X);
        for angle in [1.0, 1e-2, 1e-3, 1.01e-4, 1e-5, 1e-8, 0.0] {
            let up = target.normalize() * libm::cos(angle) + side * libm::sin(angle);
            let (camera, parallel) = Camera::new(DVec3::ZERO, target, up, PROJECTION, [4, 3]);
            assert_eq!(parallel, angle < 1e-4, "angle {angle}");
            let (r, u, f) = (camera.right, camera.up, camera.forward);
            for error in [r.dot(u), u.dot(f), f.dot(r), r.length() - 1.0, u.length() - 1.0, f.length() - 1.0] {
                assert!(error.abs() <= 1e-12, "angle {angle}: off by {error}");
            }
        }
    }
}
