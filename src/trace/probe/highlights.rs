//! Finds the highlights on the film that are smaller than a pixel, where surfaces mirror small lights to the camera.
//!
//! A smooth surface mirrors a light to the camera where its normal halves the angle between both directions. The search
//! starts where that is nearly so, and follows the film to such a point by Newton's method, as manifold exploration
//! does along longer paths (Jakob & Marschner 2012, *Manifold Exploration*).

use std::cell::Cell;
use std::f64::consts::{PI, TAU};

use crate::film::Filter;
use crate::light::{Environment, Light, LightId};
use crate::material::{Lobes, Material, reflect};
use crate::math::{Cone, DMat2, DVec2, DVec3, Frame};
use crate::scene::RayEnds;
use crate::shape::{Ball, SurfacePoint};
use crate::spectrum::Table;
use crate::trace::highlight::Highlight;
use crate::trace::walk::{SurfaceHit, shading};
use crate::trace::{Transport, World};

/// Points along the longer side of the format at which the search begins.
const SIDE: f64 = 128.0;
/// Largest number of lights whose mirror images are looked for, and of highlights that are kept.
const LIGHTS: usize = 16;
const HIGHLIGHTS: usize = 1024;
/// Half angle of the largest light that counts as small, in radians.
const SMALL: f64 = 0.2;
/// Directions that are drawn along each side of a square to find where the bright part of a sky is.
const DRAWN: u32 = 16;
/// Steps of Newton's method, and how often one is halved that leads farther away.
const STEPS: usize = 24;
const HALVINGS: usize = 8;
/// Distance of the points that tell how directions change over the film, in pixels.
const APART: f64 = 1e-4;
/// Share of a highlight's width that Newton's method may be off its center.
const CLOSE: f64 = 1e-2;
/// Area in square pixels up to which a highlight is small, and the longest half axis of its ellipse in pixels.
const LARGEST: f64 = 1.0;
const LONGEST: f64 = 16.0;
/// How much wider than the mirror image of a light its ellipse may be. Film and directions are not quite in proportion,
/// so the image is no ellipse. The first of these is taken beyond which a surface mirrors nothing of the light.
const MARGINS: [f64; 9] = [1.003, 1.006, 1.012, 1.025, 1.05, 1.1, 1.2, 1.4, 1.8];
/// Points on the rim of an ellipse where that is looked at.
const RIM: u32 = 16;
/// Half width of the ellipse of a rough surface's highlight, in widths of its slopes. A share of 1 / (1 + WIDTH^2) of the
/// light lies beyond.
const WIDTH: f64 = 6.0;

/// Returns the highlights of the format that are smaller than a pixel, whatever part of it is rendered.
pub fn small_highlights(world: &World) -> Vec<Highlight> {
    let scene = &world.scene;
    let is_random = matches!(world.method.transport, Transport::Random { .. });
    let is_sharp = !scene.camera.has_lens() && scene.film.filter != Filter::Center;
    let slopes: Vec<Option<f64>> = scene.materials.iter().map(|named| slopes(&named.material)).collect();
    if !is_random || !is_sharp || world.has_mattes || slopes.iter().all(Option::is_none) {
        return Vec::new();
    }
    let lights = small_lights(world);
    if lights.is_empty() {
        return Vec::new();
    }
    Search::new(world, slopes).highlights(&lights)
}

/// Returns the width of a material's slopes, 0 if any part of it is smooth; `None` if it mirrors nothing sharply.
fn slopes(material: &Material<Table>) -> Option<f64> {
    let of_part = |part: &Material<Table>| match part.roughness() {
        _ if !part.parts().is_empty() => None,
        _ if part.lobes().intersects(Lobes::DELTA_REFLECTION) => Some(0.0),
        roughness => {
            roughness.map(|r| r.value() * r.value()).filter(|_| part.lobes().intersects(Lobes::NARROW_REFLECTION))
        }
    };
    material.with_parts().into_iter().filter_map(of_part).min_by(f64::total_cmp)
}

/// A light that is looked for.
struct SmallLight {
    id: LightId,
    /// Its object, if it has one.
    object: Option<u32>,
    place: Place,
}

/// Where a light is.
enum Place {
    /// In a direction, within a half angle of this sine.
    Far { direction: DVec3, sin: f64 },
    /// In a ball.
    Near(Ball),
}

impl SmallLight {
    /// Returns the direction from a point to its center, the sine of its half angle and the distance.
    fn seen_from(&self, point: DVec3) -> Seen {
        match &self.place {
            &Place::Far { direction, sin } => Seen { direction, sin, distance: f64::INFINITY },
            Place::Near(ball) => {
                let way = ball.center - point;
                let distance = way.length();
                Seen { direction: way / distance, sin: ball.radius / distance, distance }
            }
        }
    }
}

/// How a light is seen from a point.
struct Seen {
    direction: DVec3,
    sin: f64,
    distance: f64,
}

/// Returns lights whose mirror images may be small, suns and skies first.
fn small_lights(world: &World) -> Vec<SmallLight> {
    let of = |(id, light): (LightId, &Light<Table>)| {
        let (object, place) = match light {
            Light::Sun(sun) => {
                let sin = libm::sin(0.5 * sun.angular_diameter.to_radians());
                (None, Place::Far { direction: sun.center_direction(), sin })
            }
            Light::Area(area) => (Some(area.object), Place::Near(area.visible_part()?.0)),
            Light::Point(point) => (None, Place::Near(Ball { center: point.position.into(), radius: 0.0 })),
            Light::Spot(spot) => (None, Place::Near(Ball { center: spot.position.into(), radius: 0.0 })),
            Light::Environment(sky) => (None, bright_part(sky)?),
        };
        Some(SmallLight { id, object, place })
    };
    let mut lights: Vec<SmallLight> = world.scene.lights.iter().enumerate().filter_map(of).collect();
    lights.sort_by_key(|light| matches!(light.place, Place::Near(_)));
    lights.truncate(LIGHTS);
    lights
}

/// Returns where the bright part of a sky's image is, such as the sun; `None` without one.
fn bright_part(sky: &Environment<Table>) -> Option<Place> {
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(DRAWN);
    let drawn = (0..DRAWN * DRAWN).map(|i| Some(sky.sample_bright([at(i % DRAWN), at(i / DRAWN)])?.0));
    let Cone { axis, one_minus_cos } = Cone::around(&drawn.collect::<Option<Vec<DVec3>>>()?)?;
    Some(Place::Far { direction: axis, sin: (one_minus_cos * (2.0 - one_minus_cos)).max(0.0).sqrt() })
}

/// What a point of the film shows.
struct Glimpse {
    object: u32,
    point: SurfacePoint,
    /// The unit vector to the camera, and the unit normal by which the surface mirrors.
    wo: DVec3,
    normal: DVec3,
    /// The width of the surface's slopes, 0 if it is smooth.
    slopes: f64,
}

impl Glimpse {
    /// Returns how far the surface is from mirroring a light: the difference of the two vectors that would be equal.
    /// They are the mirrored direction and that of the light or, on a rough surface, the facet's normal and that of the
    /// surface.
    fn mismatch(&self, light: &SmallLight) -> Mismatch {
        let Seen { direction, .. } = light.seen_from(self.point.position);
        if self.slopes == 0.0 {
            return Mismatch { wanted: direction, apart: reflect(self.wo, self.normal) - direction };
        }
        let half = (self.wo + direction).normalize_or_zero();
        Mismatch { wanted: self.normal, apart: half - self.normal }
    }
}

struct Mismatch {
    wanted: DVec3,
    apart: DVec3,
}

struct Search<'a> {
    world: &'a World,
    /// The width of each material's slopes; `None` if it mirrors nothing sharply.
    slopes: Vec<Option<f64>>,
    /// Distance of the points on the film at which it begins, in pixels.
    step: f64,
}

impl<'a> Search<'a> {
    fn new(world: &'a World, slopes: Vec<Option<f64>>) -> Self {
        let film = world.scene.film;
        Self { world, slopes, step: f64::from(film.width.max(film.height)) / SIDE }
    }

    fn highlights(&self, lights: &[SmallLight]) -> Vec<Highlight> {
        let film = self.world.scene.film;
        let [columns, rows] = [film.width, film.height].map(|size| (f64::from(size) / self.step).ceil() as usize);
        let at = |i: usize| DVec2::new((i % columns) as f64 + 0.5, (i / columns) as f64 + 0.5) * self.step;
        let glimpses: Vec<Option<Glimpse>> = (0..columns * rows).map(|i| self.look(at(i))).collect();
        let mut found: Vec<Highlight> = Vec::new();
        for light in lights {
            let squared = |glimpse: &Glimpse| glimpse.mismatch(light).apart.length_squared();
            let off: Vec<f64> =
                glimpses.iter().map(|glimpse| glimpse.as_ref().map_or(f64::INFINITY, squared)).collect();
            let is_nearest = |&i: &usize| {
                let Some(own) = &glimpses[i] else { return false };
                let (x, y) = (i % columns, i / columns);
                let beside = |j: usize| {
                    j != i && off[j] < off[i] && glimpses[j].as_ref().is_some_and(|other| other.object == own.object)
                };
                let [left, top] = [x, y].map(|at| at.saturating_sub(1));
                let [right, bottom] = [(x + 1).min(columns - 1), (y + 1).min(rows - 1)];
                !(top..=bottom).any(|y| (left..=right).any(|x| beside(y * columns + x)))
            };
            for i in (0..off.len()).filter(is_nearest) {
                let highlight = glimpses[i].as_ref().and_then(|glimpse| self.follow(at(i), glimpse.object, light));
                found.extend(highlight.filter(|new| !found.iter().any(|known| is_same(known, new))));
                if found.len() == HIGHLIGHTS {
                    return found;
                }
            }
        }
        found
    }

    /// Returns what a point of the film shows; `None` if that mirrors nothing sharply.
    fn look(&self, film: DVec2) -> Option<Glimpse> {
        let scene = &self.world.scene;
        let ray = scene.camera.ray(film);
        let hit = scene.intersect_seen(&ray, None)?;
        let slopes = self.slopes[scene.objects[hit.object as usize].material as usize]?;
        let (wo, SurfaceHit { point, .. }) = (-ray.direction, SurfaceHit::new(self.world, &ray, hit));
        let [_, normal] = shading::normals(&point, wo);
        Some(Glimpse { object: hit.object, point, wo, normal, slopes })
    }

    /// Follows an object's mirror image of a light from a point of the film to its center. Returns the highlight there
    /// if it is small.
    fn follow(&self, start: DVec2, object: u32, light: &SmallLight) -> Option<Highlight> {
        let look = |film: DVec2| self.look(film).filter(|glimpse| glimpse.object == object);
        let (mut film, mut glimpse) = (start, look(start)?);
        for _ in 0..STEPS {
            let Mismatch { wanted, apart } = glimpse.mismatch(light);
            let frame = Frame::about(wanted);
            let flat = |glimpse: &Glimpse| frame.to_local(glimpse.mismatch(light).apart).truncate();
            let here = flat(&glimpse);
            let change = |way: DVec2| Some((flat(&look(film + way)?) - here) / (way.x + way.y));
            let along = |way: DVec2| change(way).or_else(|| change(-way));
            let change = DMat2::from_cols(along(DVec2::X * APART)?, along(DVec2::Y * APART)?);
            let back = change.inverse();
            if !back.is_finite() {
                return None;
            }
            let width = self.width(&glimpse, light);
            if here.length() <= CLOSE * width {
                return self.highlight(film - back * here, &glimpse, light, back);
            }
            let mut way = (back * -here).clamp_length_max(4.0 * self.step);
            let is_nearer = |next: &Glimpse| next.mismatch(light).apart.length() < apart.length();
            let next = (0..HALVINGS).find_map(|_| {
                let next = look(film + way).filter(is_nearer).map(|next| (film + way, next));
                way *= 0.5;
                next
            });
            (film, glimpse) = next?;
        }
        None
    }

    /// Returns the half width of a highlight, as a difference of the vectors that [`Glimpse::mismatch`] compares.
    fn width(&self, glimpse: &Glimpse, light: &SmallLight) -> f64 {
        let Seen { sin, .. } = light.seen_from(glimpse.point.position);
        match glimpse.slopes {
            0.0 => sin,
            slopes => slopes.hypot(0.5 * sin / glimpse.wo.dot(glimpse.normal)),
        }
    }

    /// Returns how much wider an ellipse about a point of the film must be to contain the mirror image of a light.
    fn margin(&self, film: DVec2, object: u32, light: &SmallLight, radii: DMat2) -> f64 {
        let is_lit = |glimpse: Glimpse| {
            let Seen { sin, .. } = light.seen_from(glimpse.point.position);
            glimpse.object == object && glimpse.mismatch(light).apart.length() < sin
        };
        let is_beyond = |margin: &&f64| {
            (0..RIM).all(|i| {
                let (sin, cos) = libm::sincos(TAU * f64::from(i) / f64::from(RIM));
                !self.look(film + radii * (DVec2::new(cos, sin) * **margin)).is_some_and(is_lit)
            })
        };
        *MARGINS.iter().find(is_beyond).unwrap_or(&MARGINS[MARGINS.len() - 1])
    }

    /// Returns the highlight at a point of the film, if it is small and its light is not occluded. `back` is the change
    /// of the place on the film with the difference of the vectors that are compared.
    fn highlight(&self, film: DVec2, glimpse: &Glimpse, light: &SmallLight, back: DMat2) -> Option<Highlight> {
        let Seen { direction, sin, distance } = light.seen_from(glimpse.point.position);
        let width = self.width(glimpse, light);
        let (reach, peak) = match glimpse.slopes {
            0.0 => (self.margin(film, glimpse.object, light, back * width), 0.0),
            _ => (WIDTH, WIDTH * WIDTH),
        };
        let radii = back * (reach * width);
        let longest =
            0.5 * (radii.x_axis + radii.y_axis.perp()).length() + 0.5 * (radii.x_axis - radii.y_axis.perp()).length();
        let is_small = PI * width * width * back.determinant().abs() < LARGEST && longest < LONGEST;
        if width == 0.0 || sin >= SMALL || !is_small || glimpse.normal.dot(direction) <= 0.0 {
            return None;
        }
        let world = self.world;
        let (ends, counts) =
            (RayEnds { light: light.object, ..RayEnds::default() }, |object| !world.is_see_through(object));
        let ray = glimpse.point.leave(direction);
        let is_occluded = world.scene.is_occluded_by(&ray, distance, ends, &Cell::new(None), &counts);
        (!is_occluded).then(|| Highlight {
            light: light.id,
            center: film.to_array(),
            radii: radii.to_cols_array_2d(),
            peak,
        })
    }
}

/// Whether two searches ended at the same highlight.
fn is_same(known: &Highlight, new: &Highlight) -> bool {
    known.light == new.light && known.contains(new.center.into()) && new.contains(known.center.into())
}
