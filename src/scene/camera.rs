use std::f64::consts::{PI, TAU};

use crate::film::Optics;
use crate::math::{DVec2, DVec3, Frame, Ray, sample_disk, unit};

/// The viewpoint, and the mapping from directions to positions in the image.
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    position: DVec3,
    right: DVec3,
    up: DVec3,
    forward: DVec3,
    projection: Projection,
    /// Half the size of the image in the plane one unit in front of the camera, or half the size of an orthographic
    /// view.
    half_size: DVec2,
    /// Center of the image in that plane.
    center: DVec2,
    size: DVec2,
    near: f64,
    pub(super) lens: Option<Lens>,
    /// Distance of the point that the camera looks at.
    reach: f64,
    /// Width of the sensor in mm. No ray depends on it.
    sensor_width: Option<f64>,
    filter: Option<PolarizingFilter>,
}

/// The mapping from directions to positions in the image.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
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
    /// Rays over the full sphere. The longitude falls from half a turn at the left edge to minus half a turn at the
    /// right edge, the latitude from a quarter turn at the top. The viewing direction is in the middle, and the
    /// camera's left is a quarter of the width from the left edge: when looking along +z, that is +x (OpenEXR,
    /// `ImfEnvmap.h`, `ENVMAP_LATLONG`).
    Equirectangular,
}

impl Projection {
    /// Returns the name in a scene file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Perspective { .. } => "perspective",
            Self::Orthographic { .. } => "orthographic",
            Self::Equirectangular => "equirectangular",
        }
    }
}

/// A thin lens. The rays of a pixel start on it and meet again in the plane of focus.
///
/// Potmesil & Chakravarty 1981, *A Lens and Aperture Camera Model for Synthetic Image Generation*.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    pub(super) radius: f64,
    /// One over the distance of the plane of focus; 0 if that is infinitely far away.
    pub(super) inverse_focus: f64,
}

/// A linear polarizer in front of the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PolarizingFilter {
    /// Angle of the axis along which it transmits, from the image's right toward its top, in radians.
    pub angle: f64,
    /// Transmittance across that axis, 0 to 1.
    pub extinction: f64,
}

impl PolarizingFilter {
    /// Returns the transmittance of unpolarized light.
    pub fn transmittance(&self) -> f64 {
        0.5 * (1.0 + self.extinction)
    }
}

impl Lens {
    /// Creates a lens of a radius, focused at a distance along the viewing direction, which may be infinite.
    pub fn new(radius: f64, focus_distance: f64) -> Self {
        Self { radius, inverse_focus: 1.0 / focus_distance }
    }
}

/// Angle in radians below which `up` and the viewing direction count as parallel.
const PARALLEL_ANGLE: f64 = 1e-4;

/// A point of the world as the camera sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// Position on the film, in pixels from the top left corner. It may lie outside the image.
    pub film: DVec2,
    /// Start of the camera ray to the point.
    pub start: DVec3,
    /// Unit vector from the point to the camera.
    pub direction: DVec3,
    /// Square pixels per unit of area at the point that faces the camera.
    ///
    /// Light that leaves a surface with radiance L contributes L x area x cosine x importance to the pixels that it is
    /// spread over.
    pub importance: f64,
}

impl Camera {
    /// Creates a pinhole camera at `position` that sees the point `target` in the middle of an image of `size` pixels.
    ///
    /// Also returns whether `up` was so nearly parallel to the viewing direction that another direction was used.
    pub fn new(position: DVec3, target: DVec3, up: DVec3, projection: Projection, size: [u32; 2]) -> (Self, bool) {
        let forward = (target - position).normalize();
        let across = forward.cross(up.normalize());
        let parallel = across.length() < PARALLEL_ANGLE;
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
            half_size: DVec2::new(half_height * size.x / size.y, half_height),
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

    /// Returns the camera with rays that start at the distance `near`, measured along the viewing direction, or along
    /// the ray in an equirectangular image.
    #[must_use]
    pub fn starting_at(self, near: f64) -> Self {
        Self { near, ..self }
    }

    /// Returns the camera with its image window shifted to the right and up, in fractions of the image's height.
    #[must_use]
    pub fn shifted(self, [right, up]: [f64; 2]) -> Self {
        Self { center: DVec2::new(right, up) * (2.0 * self.half_size.y), ..self }
    }

    /// Returns the camera with a lens. A lens of radius 0 is a pinhole.
    #[must_use]
    pub fn with_lens(self, lens: Option<Lens>) -> Self {
        Self { lens: lens.filter(|lens| lens.radius > 0.0), ..self }
    }

    /// Returns the camera with a sensor of this width in mm, which the full image covers.
    #[must_use]
    pub fn on_sensor(self, width: Option<f64>) -> Self {
        Self { sensor_width: width, ..self }
    }

    /// Returns the camera with a filter in front of it.
    #[must_use]
    pub fn behind(self, filter: Option<PolarizingFilter>) -> Self {
        Self { filter, ..self }
    }

    /// Returns the data of the lens and the sensor that the scene gives. In a perspective view, the sensor's width
    /// determines its distance behind the lens. A thin lens focused at a distance d whose image is at a distance v has
    /// the focal length 1 / (1 / v + 1 / d).
    pub fn optics(&self, meters_per_unit: Option<f64>) -> Optics {
        let (width, is_flat) = (2.0 * self.half_size.x, matches!(self.projection, Projection::Perspective { .. }));
        let sensor = self.sensor_width.filter(|_| is_flat);
        let pinhole_focal_length = sensor.map(|sensor| sensor / width);
        let lens = self.lens.zip(meters_per_unit);
        let mm = |lens: Lens, meters: f64| (1e3 * meters * lens.radius, lens.inverse_focus / (1e3 * meters));
        let lens_data = lens.zip(pinhole_focal_length).map(|((lens, meters), behind)| {
            let (radius, inverse_focus) = mm(lens, meters);
            let focal_length = 1.0 / (1.0 / behind + inverse_focus);
            (focal_length, focal_length / (2.0 * radius))
        });
        let (focal_length, f_number) = lens_data.unzip();
        Optics {
            near: Some(self.near).filter(|near| *near > 0.0),
            sensor: sensor.map(|across| [across, across * self.size.y / self.size.x]),
            pinhole_focal_length,
            focal_length,
            f_number,
            focus: lens.map(|(lens, meters)| meters / lens.inverse_focus),
        }
    }

    /// Returns the ray through a point of the film, in pixels from the top left corner, and the center of the lens.
    pub fn ray(&self, film: DVec2) -> Ray {
        let (start, along) = self.chief_ray(film);
        Ray { origin: start + along * self.near, direction: unit(along) }
    }

    /// Returns the ray through a point of the film and the point of the lens to which a point of the unit square is
    /// mapped.
    pub fn lens_ray(&self, film: DVec2, u: [f64; 2]) -> Ray {
        self.ray_from_lens(film, sample_disk(u) * self.lens_radius())
    }

    /// Returns the ray through a point of the film and a point of the lens, given in scene units to the right and up.
    ///
    /// A ray that starts at a point p of the lens has the direction (x, y, 1) - p / F. Therefore all rays of one point
    /// of the film meet at distance F, and 1 / F may be 0.
    pub fn ray_from_lens(&self, film: DVec2, place: DVec2) -> Ray {
        let Some(lens) = self.lens else { return self.ray(film) };
        let (start, along) = self.chief_ray(film);
        let place = self.right * place.x + self.up * place.y;
        let along = along - place * lens.inverse_focus;
        Ray { origin: start + place + along * self.near, direction: unit(along) }
    }

    /// Returns the distance from the start of a ray back to the camera, which is that of the near plane along the ray.
    /// The direction is a unit vector.
    pub fn way_to_start(&self, direction: DVec3) -> f64 {
        match self.projection {
            Projection::Equirectangular => self.near,
            _ => self.near / direction.dot(self.forward),
        }
    }

    /// Returns the ray through the center of the lens: its origin, without the near plane, and its direction. The
    /// direction reaches one unit forward, or has length 1 in an equirectangular image.
    fn chief_ray(&self, film: DVec2) -> (DVec3, DVec3) {
        let x = (2.0 * film.x / self.size.x - 1.0) * self.half_size.x + self.center.x;
        let y = (1.0 - 2.0 * film.y / self.size.y) * self.half_size.y + self.center.y;
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

    /// Returns the depth of a point as the image records it: its distance along the viewing direction, or its distance
    /// from the camera in an equirectangular image.
    pub fn depth(&self, point: DVec3) -> f64 {
        match self.projection {
            Projection::Equirectangular => (point - self.position).length(),
            _ => (point - self.position).dot(self.forward),
        }
    }

    /// Returns the diameter of the blur circle of a point at a depth, in heights of the whole image. It is 0 in focus
    /// and for a pinhole.
    pub fn blur(&self, depth: f64) -> f64 {
        let Some(lens) = self.lens else { return 0.0 };
        let spread = match self.projection {
            Projection::Orthographic { .. } => 1.0 - depth * lens.inverse_focus,
            _ => 1.0 / depth - lens.inverse_focus,
        };
        lens.radius * spread.abs() / self.half_size.y
    }

    /// Returns the position of the camera.
    pub fn position(&self) -> DVec3 {
        self.position
    }

    /// Returns the unit vector along the camera's axis, toward the middle of an unshifted image.
    pub fn forward(&self) -> DVec3 {
        self.forward
    }

    /// Returns the projection onto the film.
    pub fn projection(&self) -> Projection {
        self.projection
    }

    /// Returns the unit vector perpendicular to a ray that points horizontally to the image's right: x of Stokes
    /// vectors.
    pub fn image_right(&self, direction: DVec3) -> DVec3 {
        let right = match self.projection {
            Projection::Equirectangular => direction.cross(self.up),
            _ => self.right - direction * direction.dot(self.right),
        };
        right.try_normalize().unwrap_or(self.right)
    }

    /// Returns the share of unpolarized light that reaches the camera; 1 without a filter.
    pub fn transmittance(&self) -> f64 {
        self.filter.map_or(1.0, |filter| filter.transmittance())
    }

    /// Returns the filter in front of the camera, if there is one.
    pub fn filter(&self) -> Option<PolarizingFilter> {
        self.filter
    }

    /// Returns whether the rays of a point of the film start on a lens with an extent.
    pub fn has_lens(&self) -> bool {
        self.lens.is_some()
    }

    /// Returns the radius of the lens in scene units; 0 for a pinhole.
    pub fn lens_radius(&self) -> f64 {
        self.lens.map_or(0.0, |lens| lens.radius)
    }

    /// Returns whether rays may start away from the camera's position.
    pub fn starts_away(&self) -> bool {
        self.near > 0.0 || self.has_lens() || matches!(self.projection, Projection::Orthographic { .. })
    }

    /// Returns the world-to-camera matrix for row vectors: +x right, +y up, +z forward.
    pub fn world_to_camera(&self) -> [[f64; 4]; 4] {
        let [x, y, z] = [self.right, self.up, self.forward];
        let shift = [x, y, z].map(|axis| -self.position.dot(axis));
        [[x.x, y.x, z.x, 0.0], [x.y, y.y, z.y, 0.0], [x.z, y.z, z.z, 0.0], [shift[0], shift[1], shift[2], 1.0]]
    }

    /// Returns the matrix from the world to normalized device coordinates, for row vectors and before the division by
    /// the fourth component. x and y are 0 at the top left corner of the full image and 1 at the bottom right corner; z
    /// increases with distance. An equirectangular view has none. What a lens blurs is mapped to where the lens's
    /// center sees it.
    pub fn world_to_ndc(&self) -> Option<[[f64; 4]; 4]> {
        let (scale, middle) = (0.5 / self.half_size, self.center * 0.5 / self.half_size);
        let (x, y) = (0.5 - middle.x, 0.5 + middle.y);
        let camera_to_ndc = match self.projection {
            Projection::Perspective { .. } => {
                [[scale.x, 0.0, 0.0, 0.0], [0.0, -scale.y, 0.0, 0.0], [x, y, 1.0, 1.0], [0.0, 0.0, -1.0, 0.0]]
            }
            Projection::Orthographic { .. } => {
                [[scale.x, 0.0, 0.0, 0.0], [0.0, -scale.y, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [x, y, 0.0, 1.0]]
            }
            Projection::Equirectangular => return None,
        };
        let product = |row: [f64; 4]| [0, 1, 2, 3].map(|to| (0..4).map(|i| row[i] * camera_to_ndc[i][to]).sum());
        Some(self.world_to_camera().map(product))
    }

    /// Returns the angle of a pixel in the middle of the image, in radians.
    ///
    /// Pixels of an orthographic view have no angle. It is then the angle of a pixel at a distance: that of the point
    /// looked at, or the length of the view's diagonal if that is larger.
    pub fn pixel_angle(&self) -> f64 {
        let pixel = 2.0 * self.half_size.x / self.size.x;
        match self.projection {
            Projection::Perspective { .. } => pixel,
            Projection::Orthographic { .. } => pixel / self.reach.max(2.0 * self.half_size.length()),
            Projection::Equirectangular => (TAU / self.size.x).min(PI / self.size.y),
        }
    }

    /// Returns the width of a pixel in the middle of the image, at a distance.
    pub fn pixel_width(&self, distance: f64) -> f64 {
        match self.projection {
            Projection::Orthographic { .. } => 2.0 * self.half_size.x / self.size.x,
            _ => self.pixel_angle() * distance,
        }
    }

    /// Returns the width of the image in the plane one unit in front of the camera; 1 for an equirectangular image,
    /// which has no such width (OpenEXR, *Technical Introduction*).
    pub fn screen_window_width(&self) -> f64 {
        match self.projection {
            Projection::Equirectangular => 1.0,
            _ => 2.0 * self.half_size.x,
        }
    }

    /// Returns the center of the image in the plane one unit in front of the camera, to the right and up.
    pub fn screen_window_center(&self) -> [f64; 2] {
        self.center.into()
    }

    /// Returns how a point is seen through the point of the lens to which a point of the unit square is mapped. Returns
    /// none for a point before the near plane or behind the camera.
    pub fn see(&self, point: DVec3, u: [f64; 2]) -> Option<Seen> {
        let to_point = point - self.position;
        if self.projection == Projection::Equirectangular {
            return self.see_equirectangular(to_point);
        }
        let depth = to_point.dot(self.forward);
        if !(depth > self.near && depth > 0.0) {
            return None;
        }
        let place = self.lens.map_or(DVec2::ZERO, |lens| sample_disk(u) * lens.radius);
        let bend = self.lens.map_or(DVec2::ZERO, |lens| place * lens.inverse_focus);
        let across = DVec2::new(to_point.dot(self.right), to_point.dot(self.up)) - place;
        // The ray runs along (slope, 1) from `corner` + `place`.
        let parallel = matches!(self.projection, Projection::Orthographic { .. });
        let slope = if parallel { -bend } else { across / depth };
        let corner = if parallel { across - slope * depth } else { DVec2::ZERO };
        let window = if parallel { corner } else { slope + bend };
        let scaled = (window - self.center) / self.half_size;
        let film = DVec2::new(0.5 * (1.0 + scaled.x), 0.5 * (1.0 - scaled.y)) * self.size;
        let in_world = |v: DVec2| self.right * v.x + self.up * v.y;
        let along = self.forward + in_world(slope);
        let length = along.length();
        let pixels = self.size.x * self.size.y / (4.0 * self.half_size.x * self.half_size.y);
        // A unit of area that faces the ray fills `length` of the window of parallel rays. Of a window one unit in
        // front of the camera it fills length / depth^2, since its solid angle is 1 / (length depth)^2 and the window's
        // cosine is 1 / length.
        let importance = if parallel { pixels * length } else { pixels * length / (depth * depth) };
        let start = self.position + in_world(corner + place) + along * self.near;
        Some(Seen { film, start, direction: -along / length, importance })
    }

    fn see_equirectangular(&self, to_point: DVec3) -> Option<Seen> {
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

    /// Returns all positions on the film that show what the position `film` shows, up to `reach` pixels outside the
    /// image: itself and, in an equirectangular image, its copies beyond the seam and the poles.
    pub fn places(&self, film: DVec2, reach: f64) -> Vec<DVec2> {
        if self.projection != Projection::Equirectangular {
            return vec![film];
        }
        let DVec2 { x: width, y: height } = self.size;
        let turns = |size: f64| (reach / size).ceil() as i32 + 1;
        let mut places = Vec::new();
        // Beyond a pole, the film continues on the opposite side, upside down.
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
