//! Finds the highlights on the film that are smaller than a pixel: small lights that the camera sees, or that surfaces
//! mirror or refract to it.
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
use crate::trace::highlight::{Highlight, rim};
use crate::trace::{RAYS_OF_A_LOOK, Transport, World};

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
/// Half width of the ellipse of a rough surface's highlight, in widths of its slopes. With this half width W, a
/// share of 1 / (1 + W^2) of the light lies beyond.
const ROUGH_HALF_WIDTH: f64 = 6.0;

/// Returns the highlights of the format that are smaller than a pixel, whatever part of it is rendered.
pub fn small_highlights(world: &World) -> Vec<Highlight> {
    let scene = &world.scene;
    let is_random = matches!(world.method.transport, Transport::Random { .. });
    let is_sharp = !scene.camera.has_lens() && scene.film.filter != Filter::Center;
    if !is_random || !is_sharp || world.has_mattes {
        return Vec::new();
    }
    let small_lights = SmallLights::new(world, MAX_HIGHLIGHTS);
    let slopes: Vec<Option<f64>> = scene.materials.iter().map(|named| slopes(&named.material)).collect();
    let film = scene.film;
    let step = f64::from(film.width.max(film.height)) / SEARCH_POINTS;
    let chain_of = |events| SpecularChain { world, events, slopes: &slopes };
    let no_surfaces = Search::new(chain_of(&[]), step);
    let searched = small_lights.in_parts(MAX_HIGHLIGHTS).take_while(|_| no_surfaces.rays.get() < RAYS_OF_A_LOOK);
    let mut found: Vec<Highlight> =
        searched.filter_map(|light| no_surfaces.seen_light(&light)).take(MAX_HIGHLIGHTS).collect();
    let lights: Vec<SmallLight> = small_lights.in_parts(MAX_LIGHTS).take(MAX_LIGHTS).collect();
    if lights.is_empty() || slopes.iter().all(Option::is_none) {
        return found;
    }
    let chains: Vec<SpecularChain> = CHAINS.map(chain_of).into_iter().filter(SpecularChain::is_possible).collect();
    let mut rays = RAYS_OF_A_LOOK;
    for chain in chains {
        let step = if chain.events.len() == 1 { step } else { LONG_CHAIN_STEP * step };
        let search = Search::new(chain, step);
        // The short chains come first, and show most.
        search.add_highlights(&lights, rays / 2, &mut found);
        rays = rays.saturating_sub(search.rays.get());
    }
    found
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
    fn seen_light(&self, light: &SmallLight) -> Option<Highlight> {
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
        let highlight = self.follow(film, &self.chain.trace(film)?, light)?;
        highlight.is_seen_in(scene.film.whole(), scene.film.filter).then_some(highlight)
    }

    /// Adds the highlights of some lights that are not known yet, as far as about `rays` rays lead. Each light may take
    /// an equal share of what those before it have left.
    fn add_highlights(&self, lights: &[SmallLight], rays: u64, found: &mut Vec<Highlight>) {
        let film = self.chain.world.scene.film;
        let [columns, rows] = [film.width, film.height].map(|size| (f64::from(size) / self.step).ceil() as usize);
        let film_point = |i: usize| DVec2::new((i % columns) as f64 + 0.5, (i / columns) as f64 + 0.5) * self.step;
        let ends: Vec<Option<ChainEnd>> = (0..columns * rows).map(|i| self.chain.trace(film_point(i))).collect();
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
                let highlight = ends[i].as_ref().and_then(|end| self.follow(film_point(i), end, light));
                found.extend(highlight.filter(|new| !found.iter().any(|known| is_same(known, new))));
            }
        }
    }

    /// Follows the image of a light from a point of the film to its center. Returns the highlight there if it is small.
    fn follow(&self, start: DVec2, near: &ChainEnd, light: &SmallLight) -> Option<Highlight> {
        let trace = |film: DVec2| self.trace_like(film, near);
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
            let width = self.width(&end, light);
            if current.length() <= TOLERANCE * width {
                return self.highlight(film - inverse_jacobian * current, &end, light, inverse_jacobian);
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

    /// Follows the ray of a point of the film; `None` if other things become of it than of another.
    fn trace_like(&self, film: DVec2, other: &ChainEnd) -> Option<ChainEnd> {
        self.rays.set(self.rays.get() + 1);
        self.chain.trace(film).filter(|end| end.objects == other.objects)
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
            rim().all(|point| !self.trace_like(film + radii * (point * **margin), center).is_some_and(is_lit))
        };
        *MARGINS.iter().find(contains_image).unwrap_or(&MARGINS[MARGINS.len() - 1])
    }

    /// Returns whether the center of a highlight shows its light, or other points of it do. `radii` are those of the
    /// light's image around a point of the film.
    fn is_unoccluded(&self, film: DVec2, center: &ChainEnd, light: &SmallLight, radii: DMat2) -> bool {
        let world = self.chain.world;
        let is_from_camera = self.chain.bounces() == 0;
        let counts = |object| !world.is_see_through(object) && (!is_from_camera || world.scene.is_seen(object));
        let ends = RayEnds { light: light.object, ..RayEnds::default() };
        let shows_light = |end: &ChainEnd| {
            let ApparentLight { direction, distance, .. } = light.seen_from(end.point.position);
            let ray = end.point.leave(if end.slopes == 0.0 { end.outgoing } else { direction });
            !world.scene.is_occluded_by(&ray, distance, ends, &Cell::new(None), &counts)
        };
        let rings = RINGS.into_iter().flat_map(|ring| rim().map(move |point| point * ring));
        let mut others = rings.filter_map(|point| self.trace_like(film + radii * point, center));
        shows_light(center) || others.any(|end| shows_light(&end))
    }

    /// Returns the highlight at a point of the film, if it is small and shows its light. `inverse_jacobian`
    /// is the change of the place on the film with the difference of the vectors that are compared.
    fn highlight(&self, film: DVec2, end: &ChainEnd, light: &SmallLight, inverse_jacobian: DMat2) -> Option<Highlight> {
        let ApparentLight { direction, sin, .. } = light.seen_from(end.point.position);
        let width = self.width(end, light);
        let is_small = PI * width * width * inverse_jacobian.determinant().abs() < MAX_AREA;
        let is_on_that_side = direction.dot(end.normal) * end.outgoing.dot(end.normal) > 0.0;
        if width == 0.0 || sin >= MAX_HALF_ANGLE || !is_small || !is_on_that_side {
            return None;
        }
        let image = inverse_jacobian * width;
        if !self.is_unoccluded(film, end, light, image) {
            return None;
        }
        let (reach, peak) = match end.slopes {
            0.0 => (self.margin(film, end, light, image), 0.0),
            _ => (ROUGH_HALF_WIDTH, ROUGH_HALF_WIDTH * ROUGH_HALF_WIDTH),
        };
        let highlight = Highlight {
            light: light.id,
            bounces: self.chain.bounces(),
            center: film.to_array(),
            radii: (image * reach).to_cols_array_2d(),
            peak,
        };
        (highlight.longest_half_axis() < MAX_HALF_AXIS).then_some(highlight)
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
            let of_light = |light: &SmallLight| found.iter().filter(|highlight| highlight.light == light.id).count();
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
