//! Finds the highlights on the film that are smaller than a pixel: small lights that the camera sees, or that surfaces
//! mirror or refract to it. If there is a lens, finds those that it blurs instead.
//!
//! Rays from the film are followed along a few chains of surfaces. The search starts where the last surface nearly
//! sends the ray to a light, and follows the film to such a point by Newton's method, as manifold exploration does
//! (Jakob & Marschner 2012, *Manifold Exploration*).

use std::cell::Cell;
use std::f64::consts::PI;

use super::small_light::{ApparentLight, Place, SmallLight, SmallLights};
use super::specular_chain::{CHAINS, ChainEnd, SpecularChain};
use crate::film::Filter;
use crate::material::{Lobes, Material};
use crate::math::{DMat2, DVec2, DVec3, Frame};
use crate::scene::RayEnds;
use crate::spectrum::Table;
use crate::trace::highlight::{Highlight, longest_half_axis, rim};
use crate::trace::lens_light::LensLight;
use crate::trace::{RAYS_OF_A_LOOK, SmallHighlights, Transport, World};

/// Points along the longer side of the format at which the search for what a first surface mirrors begins, and how
/// much wider apart they are for longer chains of surfaces.
const SEARCH_POINTS: f64 = 128.0;
const LONG_CHAIN_STEP: f64 = 2.0;
/// Largest number of lights whose images in surfaces are looked for, and of highlights that are kept.
const MAX_LIGHTS: usize = 128;
const MAX_HIGHLIGHTS: usize = 1024;
/// Distance in scene units, more than that of a near plane, at which the camera's image of a direction is as if it were
/// infinitely far.
const FAR: f64 = 1e40;
/// Half angle of the largest light that counts as small, in radians.
const MAX_HALF_ANGLE: f64 = 0.2;
/// Steps of Newton's method, and how often one is halved that leads farther away.
const MAX_NEWTON_STEPS: usize = 24;
const MAX_HALVINGS: usize = 8;
/// Distance of the points that tell how directions change over the film, in pixels.
const FILM_STEP: f64 = 1e-4;
/// Share of a highlight's width that Newton's method may be off its center.
const TOLERANCE: f64 = 1e-2;
/// Area in square pixels up to which a highlight is small, and the longest half axis of its ellipse in pixels.
const MAX_AREA: f64 = 1.0;
const MAX_HALF_AXIS: f64 = 16.0;
/// How much wider than the image of a light its ellipse may be. Film and directions are not quite in proportion,
/// so the image is no ellipse. The first of these is taken beyond which nothing of the light is seen.
const MARGINS: [f64; 11] = [1.0003, 1.001, 1.003, 1.006, 1.012, 1.025, 1.05, 1.1, 1.2, 1.4, 1.8];
/// Radii of the rings on which points are looked at if something occludes the center of an image, relative to its own.
const RINGS: [f64; 2] = [0.5, 0.9];
/// Points of the lens through which images are looked at, as a share of its radius.
const LENS_ARM: f64 = 0.7;
/// Factor by which the part of the lens that sees an image is larger than measured, and the largest factor that images
/// seen through other points of the lens may require.
const LENS_MARGIN: f64 = 1.03;
const MAX_LENS_MARGIN: f64 = 3.0;
/// Largest share of the lens that such a part may have: samples of the whole lens hit a larger one often.
const MAX_LENS_SHARE: f64 = 0.25;
/// Half width of the ellipse of a rough surface's highlight, in widths of its slopes. With this half width W, a
/// share of 1 / (1 + W^2) of the light lies beyond.
const ROUGH_HALF_WIDTH: f64 = 6.0;

/// Returns the highlights of the format that are smaller than a pixel, or that a lens blurs, whatever part of it is
/// rendered.
pub fn small_highlights(world: &World) -> SmallHighlights {
    let scene = &world.scene;
    let is_random = matches!(world.method.transport, Transport::Random { .. });
    // Points of the film that are all in the middle of a pixel cannot be aimed, but points of the lens can.
    let can_aim = scene.camera.has_lens() || scene.film.filter != Filter::Center;
    if !is_random || !can_aim || world.has_mattes {
        return SmallHighlights::default();
    }
    let small_lights = SmallLights::new(world, MAX_HIGHLIGHTS);
    let slopes: Vec<Option<f64>> = scene.materials.iter().map(|named| slopes(&named.material)).collect();
    let film = scene.film;
    let step = f64::from(film.width.max(film.height)) / SEARCH_POINTS;
    let chain_of = |events| SpecularChain { world, events, slopes: &slopes };
    let no_surfaces = Search::new(chain_of(&[]), step);
    let searched = small_lights.in_parts(MAX_HIGHLIGHTS).take_while(|_| no_surfaces.rays.get() < RAYS_OF_A_LOOK);
    let mut found: Vec<Found> =
        searched.filter_map(|light| no_surfaces.seen_light(&light)).take(MAX_HIGHLIGHTS).collect();
    let lights: Vec<SmallLight> = small_lights.in_parts(MAX_LIGHTS).take(MAX_LIGHTS).collect();
    let chains = match lights.is_empty() || slopes.iter().all(Option::is_none) {
        true => Vec::new(),
        false => CHAINS.map(chain_of).into_iter().filter(SpecularChain::is_possible).collect(),
    };
    let mut rays = RAYS_OF_A_LOOK;
    for chain in chains {
        let step = if chain.events.len() == 1 { step } else { LONG_CHAIN_STEP * step };
        let search = Search::new(chain, step);
        // The short chains come first, and show most.
        search.add_highlights(&lights, rays / 2, &mut found);
        rays = rays.saturating_sub(search.rays.get());
    }
    let (on_lens, on_film): (Vec<_>, Vec<_>) = found.into_iter().partition(|found| found.on_lens.is_some());
    SmallHighlights {
        on_film: on_film.into_iter().map(|found| found.highlight).collect(),
        on_lens: on_lens.into_iter().filter_map(|found| found.on_lens).collect(),
    }
}

/// A highlight as the middle of the lens sees it and, if there is a lens, what the lens makes of it.
struct Found {
    highlight: Highlight,
    on_lens: Option<LensLight>,
}

/// The image of a light's center through a point of the lens.
struct Image {
    film: DVec2,
    end: ChainEnd,
    /// The change of the place on the film with the difference of the vectors that are compared.
    inverse_jacobian: DMat2,
}

/// Returns the width of a material's slopes, 0 if any part of it is smooth; `None` if it mirrors nothing sharply.
fn slopes(material: &Material<Table>) -> Option<f64> {
    let part_slopes = |part: &Material<Table>| match part.roughness() {
        _ if !part.parts().is_empty() => None,
        _ if part.lobes().intersects(Lobes::DELTA_REFLECTION) => Some(0.0),
        roughness => {
            roughness.map(|r| r.value() * r.value()).filter(|_| part.lobes().intersects(Lobes::NARROW_REFLECTION))
        }
    };
    material.with_parts().into_iter().filter_map(part_slopes).min_by(f64::total_cmp)
}

/// How far a surface is from sending the light of a source to the camera: the difference of two unit vectors, and the
/// one that the other should be equal to. They are the direction of the light and the one in which a smooth surface
/// sends the ray, or the normal of a rough surface and that of the facet which mirrors the light.
struct Mismatch {
    target: DVec3,
    difference: DVec3,
}

impl Mismatch {
    fn of(light: &SmallLight, end: &ChainEnd) -> Self {
        let ApparentLight { direction, .. } = light.seen_from(end.point.position);
        if end.slopes == 0.0 {
            return Self { target: direction, difference: end.outgoing - direction };
        }
        let half = (end.wo + direction).normalize_or_zero();
        Self { target: end.normal, difference: half - end.normal }
    }
}

struct Search<'a> {
    chain: SpecularChain<'a>,
    /// Distance of the points on the film at which it begins, in pixels.
    step: f64,
    /// The number of rays of the film that Newton's method has followed so far.
    rays: Cell<u64>,
}

impl<'a> Search<'a> {
    fn new(chain: SpecularChain<'a>, step: f64) -> Self {
        Self { chain, step, rays: Cell::new(0) }
    }

    /// Returns the highlight that is the light itself, if the camera sees it.
    fn seen_light(&self, light: &SmallLight) -> Option<Found> {
        let scene = &self.chain.world.scene;
        if light.object.is_some_and(|object| !scene.is_seen(object)) {
            return None;
        }
        let camera = &scene.camera;
        let point = match &light.place {
            Place::Far { direction, .. } => camera.position() + direction * FAR,
            Place::Near(ball) => ball.center,
        };
        let film = camera.see(point, [0.5; 2])?.film;
        let found = self.follow(film, &self.chain.trace(film, DVec2::ZERO)?, light)?;
        let (window, filter) = (scene.film.whole(), scene.film.filter);
        let is_seen = match &found.on_lens {
            None => found.highlight.is_seen_in(window, filter),
            Some(on_lens) => on_lens.is_seen_in(window, filter, camera.lens_radius()),
        };
        is_seen.then_some(found)
    }

    /// Adds the highlights of some lights that are not known yet, as far as about `rays` rays lead. Each light may take
    /// an equal share of what those before it have left.
    fn add_highlights(&self, lights: &[SmallLight], rays: u64, found: &mut Vec<Found>) {
        let film = self.chain.world.scene.film;
        let [columns, rows] = [film.width, film.height].map(|size| (f64::from(size) / self.step).ceil() as usize);
        let film_point = |i: usize| DVec2::new((i % columns) as f64 + 0.5, (i / columns) as f64 + 0.5) * self.step;
        let ends: Vec<Option<ChainEnd>> =
            (0..columns * rows).map(|i| self.chain.trace(film_point(i), DVec2::ZERO)).collect();
        if ends.iter().all(Option::is_none) {
            return;
        }
        for (light, left) in lights.iter().zip((1..=lights.len() as u64).rev()) {
            let squared_mismatch = |end: &ChainEnd| Mismatch::of(light, end).difference.length_squared();
            let squared_mismatches: Vec<f64> =
                ends.iter().map(|end| end.as_ref().map_or(f64::INFINITY, squared_mismatch)).collect();
            let is_nearest = |&i: &usize| {
                let Some(center) = &ends[i] else { return false };
                let (x, y) = (i % columns, i / columns);
                let is_better_neighbor = |j: usize| {
                    j != i
                        && squared_mismatches[j] < squared_mismatches[i]
                        && ends[j].as_ref().is_some_and(|other| other.objects == center.objects)
                };
                let [left, top] = [x, y].map(|at| at.saturating_sub(1));
                let [right, bottom] = [(x + 1).min(columns - 1), (y + 1).min(rows - 1)];
                !(top..=bottom).any(|y| (left..=right).any(|x| is_better_neighbor(y * columns + x)))
            };
            let mut starts: Vec<usize> = (0..squared_mismatches.len()).filter(is_nearest).collect();
            starts.sort_by(|&i, &j| squared_mismatches[i].total_cmp(&squared_mismatches[j]));
            let max_rays = self.rays.get() + rays.saturating_sub(self.rays.get()) / left;
            for i in starts {
                if found.len() == MAX_HIGHLIGHTS || self.rays.get() >= max_rays {
                    break;
                }
                let new = ends[i].as_ref().and_then(|end| self.follow(film_point(i), end, light));
                let is_known = |new: &Found| found.iter().any(|known| is_same(&known.highlight, &new.highlight));
                found.extend(new.filter(|new| !is_known(new)));
            }
        }
    }

    /// Follows the image of a light from a point of the film to its center. Returns what is found there if it is small.
    fn follow(&self, start: DVec2, near: &ChainEnd, light: &SmallLight) -> Option<Found> {
        self.found(&self.image(DVec2::ZERO, start, near, light)?, light)
    }

    /// Follows the image of a light through a point of the lens from a point of the film to its center.
    fn image(&self, place: DVec2, start: DVec2, near: &ChainEnd, light: &SmallLight) -> Option<Image> {
        let trace = |film: DVec2| self.trace_like(film, place, near);
        let (mut film, mut end) = (start, trace(start)?);
        for _ in 0..MAX_NEWTON_STEPS {
            let Mismatch { target, difference } = Mismatch::of(light, &end);
            let frame = Frame::about(target);
            let local_difference = |end: &ChainEnd| frame.to_local(Mismatch::of(light, end).difference).truncate();
            let current = local_difference(&end);
            let derivative = |step: DVec2| Some((local_difference(&trace(film + step)?) - current) / (step.x + step.y));
            let column = |step: DVec2| derivative(step).or_else(|| derivative(-step));
            let jacobian = DMat2::from_cols(column(DVec2::X * FILM_STEP)?, column(DVec2::Y * FILM_STEP)?);
            let inverse_jacobian = jacobian.inverse();
            if !inverse_jacobian.is_finite() {
                return None;
            }
            if current.length() <= TOLERANCE * self.width(&end, light) {
                return Some(Image { film: film - inverse_jacobian * current, end, inverse_jacobian });
            }
            let mut step = (inverse_jacobian * -current).clamp_length_max(4.0 * self.step);
            let is_nearer = |next: &ChainEnd| Mismatch::of(light, next).difference.length() < difference.length();
            let next = (0..MAX_HALVINGS).find_map(|_| {
                let next = trace(film + step).filter(is_nearer).map(|next| (film + step, next));
                step *= 0.5;
                next
            });
            (film, end) = next?;
        }
        None
    }

    /// Follows the ray of a point of the film and a point of the lens; `None` if other things become of it than of
    /// another.
    fn trace_like(&self, film: DVec2, place: DVec2, other: &ChainEnd) -> Option<ChainEnd> {
        self.rays.set(self.rays.get() + 1);
        self.chain.trace(film, place).filter(|end| end.objects == other.objects)
    }

    /// Returns the half width of a highlight, as a difference of the vectors that [`Mismatch`] compares.
    fn width(&self, end: &ChainEnd, light: &SmallLight) -> f64 {
        let ApparentLight { sin, .. } = light.seen_from(end.point.position);
        match end.slopes {
            0.0 => sin,
            slopes => slopes.hypot(0.5 * sin / end.wo.dot(end.normal)),
        }
    }

    /// Returns how much wider an ellipse about a point of the film must be to contain the image of a light.
    fn margin(&self, film: DVec2, center: &ChainEnd, light: &SmallLight, radii: DMat2) -> f64 {
        let is_lit = |end: ChainEnd| {
            let ApparentLight { sin, .. } = light.seen_from(end.point.position);
            Mismatch::of(light, &end).difference.length() < sin
        };
        let contains_image = |margin: &&f64| {
            rim().all(|point| {
                !self.trace_like(film + radii * (point * **margin), DVec2::ZERO, center).is_some_and(is_lit)
            })
        };
        *MARGINS.iter().find(contains_image).unwrap_or(&MARGINS[MARGINS.len() - 1])
    }

    /// Returns whether a surface shows a light that nothing occludes.
    fn shows_light(&self, end: &ChainEnd, light: &SmallLight) -> bool {
        let world = self.chain.world;
        let is_from_camera = self.chain.bounces() == 0;
        let counts = |object| !world.is_see_through(object) && (!is_from_camera || world.scene.is_seen(object));
        let ends = RayEnds { light: light.object, ..RayEnds::default() };
        let ApparentLight { direction, distance, .. } = light.seen_from(end.point.position);
        let ray = end.point.leave(if end.slopes == 0.0 { end.outgoing } else { direction });
        !world.scene.is_occluded_by(&ray, distance, ends, &Cell::new(None), &counts)
    }

    /// Returns whether the center of a highlight shows its light, or other points of it do. `radii` are those of the
    /// light's image.
    fn is_unoccluded(&self, image: &Image, light: &SmallLight, radii: DMat2) -> bool {
        let rings = RINGS.into_iter().flat_map(|ring| rim().map(move |point| point * ring));
        let trace = |point: DVec2| self.trace_like(image.film + radii * point, DVec2::ZERO, &image.end);
        let mut others = rings.filter_map(trace);
        self.shows_light(&image.end, light) || others.any(|end| self.shows_light(&end, light))
    }

    /// Returns the highlight at the image of a light, if it is small and shows its light.
    fn found(&self, image: &Image, light: &SmallLight) -> Option<Found> {
        let Image { film, end, inverse_jacobian } = image;
        let ApparentLight { direction, sin, .. } = light.seen_from(end.point.position);
        let width = self.width(end, light);
        let radii = *inverse_jacobian * width;
        let has_lens = self.chain.world.scene.camera.has_lens();
        let is_small = has_lens || PI * radii.determinant().abs() < MAX_AREA;
        let is_on_that_side = direction.dot(end.normal) * end.outgoing.dot(end.normal) > 0.0;
        if width == 0.0 || sin >= MAX_HALF_ANGLE || !is_small || !is_on_that_side {
            return None;
        }
        if !has_lens && !self.is_unoccluded(image, light, radii) {
            return None;
        }
        let (reach, peak) = match end.slopes {
            0.0 => (self.margin(*film, end, light, radii), 0.0),
            _ => (ROUGH_HALF_WIDTH, ROUGH_HALF_WIDTH * ROUGH_HALF_WIDTH),
        };
        let highlight = Highlight {
            light: light.id,
            bounces: self.chain.bounces(),
            center: film.to_array(),
            radii: (radii * reach).to_cols_array_2d(),
            peak,
        };
        if has_lens {
            let on_lens = Some(self.on_lens(image, light, radii * reach)?);
            return Some(Found { highlight, on_lens });
        }
        (highlight.longest_half_axis() < MAX_HALF_AXIS).then_some(Found { highlight, on_lens: None })
    }

    /// Returns the part of the lens that sees an image with some `radii` on the film from each point of the film, if
    /// that part is small, and some of the image is shown.
    ///
    /// The image moves over the film as the point of the lens moves. For lights themselves, this map is affine.
    fn on_lens(&self, image: &Image, light: &SmallLight, radii: DMat2) -> Option<LensLight> {
        if image.end.slopes != 0.0 {
            return None;
        }
        let lens_radius = self.chain.world.scene.camera.lens_radius();
        let through = |place: DVec2| Some((place, self.image(place, image.film, &image.end, light)?));
        let arms =
            [DVec2::X, DVec2::Y].map(|axis| [1.0, -1.0].map(|sign| through(axis * (sign * LENS_ARM * lens_radius))));
        // From both sides, or from one and the middle.
        let column = |[one, other]: &[Option<(DVec2, Image)>; 2]| {
            let middle = (DVec2::ZERO, image.film);
            let [a, b] = [one, other].map(|arm| arm.as_ref().map_or(middle, |(place, image)| (*place, image.film)));
            let length = (a.0 - b.0).length();
            (length > 0.0).then(|| (a.1 - b.1) / length)
        };
        let moves = DMat2::from_cols(column(&arms[0])?, column(&arms[1])?);
        let per_pixel = moves.inverse();
        let images: Vec<(DVec2, Image)> = arms.into_iter().flatten().flatten().collect();
        let is_shown =
            self.shows_light(&image.end, light) || images.iter().any(|(_, image)| self.shows_light(&image.end, light));
        if !per_pixel.is_finite() || !is_shown {
            return None;
        }
        // How far images lie from where the affine map has them, and how much larger they are, in radii. Both are taken
        // to grow toward the rim of the lens.
        let to_radii = radii.inverse();
        let margin = |(place, other): &(DVec2, Image)| {
            let bend = to_radii * (other.film - image.film - moves * *place);
            let size = to_radii * (other.inverse_jacobian * self.width(&other.end, light));
            1.0 + (bend.length() + (longest_half_axis(size) - 1.0).max(0.0)) / (LENS_ARM * LENS_ARM)
        };
        let margin = images.iter().map(margin).fold(1.0, f64::max);
        let found = LensLight {
            light: light.id,
            bounces: self.chain.bounces(),
            center: image.film.to_array(),
            per_pixel: per_pixel.to_cols_array_2d(),
            radii: (per_pixel * radii * (LENS_MARGIN * margin)).to_cols_array_2d(),
        };
        (found.share(lens_radius) < MAX_LENS_SHARE && margin < MAX_LENS_MARGIN).then_some(found)
    }
}

/// Whether two searches ended at the same highlight.
fn is_same(known: &Highlight, new: &Highlight) -> bool {
    (known.light, known.bounces) == (new.light, new.bounces)
        && known.contains(new.center.into())
        && new.contains(known.center.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use crate::spectrum::{Basis, ColorSpace};
    use crate::trace::Method;
    use crate::trace::highlight::RIM_POINTS;

    #[test]
    fn the_search_ends_when_its_rays_are_used_up() {
        let mut text = String::from(
            "camera = { position = [0, 0, 12], look_at = [0, 0, 0], vertical_fov = 40 }\nfilm = { width = 64, height = 64 }\n\
             [material.ball]\nmirror.reflectance = 0.9\n[material.lamp]\nemissive.radiance = 1\n",
        );
        for (name, x, y, z, radius) in (0..9)
            .map(|i| ("ball", 2 * (i % 3) - 2, 2 * (i / 3) - 2, 0, 0.7))
            .chain((0..2).map(|i| ("lamp", 3 - 6 * i, 5, 9, 0.02)))
        {
            text += &format!(
                "[[object]]\nmaterial = \"{name}\"\nshape.sphere = {{ center = [{x}, {y}, {z}], radius = {radius} }}\n"
            );
        }
        let scene = Scene::parse(&text, ".").expect("it is a scene");
        let transport = Transport::Random { split: 0.05, roulette: 0.05 };
        let world = World::new(&scene, Method::of_paths(Basis::rgb(ColorSpace::Rec709), transport, 0));
        let slopes: Vec<Option<f64>> = world.scene.materials.iter().map(|named| slopes(&named.material)).collect();
        let lights: Vec<SmallLight> = SmallLights::new(&world, MAX_LIGHTS).in_parts(MAX_LIGHTS).collect();
        let search = |rays: u64| {
            let search = Search::new(SpecularChain { world: &world, events: CHAINS[0], slopes: &slopes }, 0.5);
            let mut found = Vec::new();
            search.add_highlights(&lights, rays, &mut found);
            let of_light = |light: &SmallLight| found.iter().filter(|found| found.highlight.light == light.id).count();
            (lights.iter().map(of_light).collect::<Vec<_>>(), search.rays.get())
        };
        let (all, rays) = search(RAYS_OF_A_LOOK);
        assert!(all == [9, 9] && rays < RAYS_OF_A_LOOK / 50, "{all:?}, {rays} rays");
        // A start takes two rays for each step of Newton's method and one for each halved step, and looks at rings.
        let of_steps = MAX_NEWTON_STEPS * (2 + MAX_HALVINGS);
        let most_of_a_start = (of_steps + RIM_POINTS as usize * (RINGS.len() + MARGINS.len())) as u64;
        let (some, rays) = search(100);
        assert!(some.iter().all(|count| (1..9).contains(count)), "{some:?}");
        assert!(rays < 100 + 2 * most_of_a_start, "{rays} rays");
    }
}
