//! Learns where the sky is seen, by rays from the places that the camera's paths reach.

use std::cell::Cell;
use std::f64::consts::PI;
use std::sync::Arc;

use rayon::prelude::*;

use super::directions::{BESIDE, DIRECTIONS, direction, spread};
use super::openings::{Grid, Openings, SkyView};
use super::render::sample;
use super::straight;
use super::tracer::Tracer;
use super::width::{InLanes, in_lanes};
use super::{Transport, World};
use crate::light::{Light, LightId};
use crate::math::{Bounds, BranchKey, DVec3, Frame, Sampler, cosine_hemisphere, unit};
use crate::shape::{Sighting, SurfacePoint};
use crate::spectrum::{Draw, Lanes};

/// Sets these random numbers apart from those of the image.
const SEED: u64 = 0x736b_7976;
/// Rays that are sent ahead: one for so many camera samples of the whole image, and never more than so many. Of fewer than
/// the fewest nothing would be learned.
const SAMPLES_FOR_A_RAY: u64 = 8;
const MOST_RAYS: u64 = 1 << 21;
const FEWEST_RAYS: u64 = 1 << 14;
/// Part of them that finds out from which places some of the sky is seen, and not most of it.
const FIRST: u64 = 16;
/// Camera samples along each side of the image that look for places, and places that are enough.
const SIDE: u32 = 64;
const MANY_PLACES: usize = 1 << 15;
/// Cells along the longest side of the box around all places, the most that the rays are enough for.
const ALONG: [usize; 8] = [32, 24, 16, 12, 8, 6, 4, 2];
/// Places of a cell that send rays.
const PLACES: usize = 8;
/// Where more of the sky's light than this arrives, aiming at all of it is as good.
const OPEN: f64 = 0.5;
/// How often a sky is chosen by what arrives; else by what it sends.
const BY_ARRIVING: f64 = 0.8;
/// Directions to a sun from each place.
const EACH: usize = 4;

/// A place that scatters widely, with its unit normal on the lit side.
type Place = (SurfacePoint, DVec3);

impl World {
    /// Learns where the sky is seen from the places that paths reach; nothing where most of it is, or none.
    ///
    /// Looks at the whole image, also where only a part of it is made, so that all parts are made alike.
    pub(super) fn learn_openings(&mut self) {
        let film = self.scene.film;
        let samples = u64::from(film.width) * u64::from(film.height) * u64::from(self.method.samples);
        let rays = (samples / SAMPLES_FOR_A_RAY).min(MOST_RAYS);
        let sky = self.scene.environment().filter(|sky| self.targets.contains(sky));
        if let (Some(sky), Transport::Random { .. }) = (sky, self.method.transport)
            && rays >= FEWEST_RAYS
        {
            let learned = in_lanes(&self.method.basis, Learning { world: self, sky, rays });
            self.openings = learned.map(Arc::new);
        }
    }
}

struct Learning<'a> {
    world: &'a World,
    sky: LightId,
    rays: u64,
}

/// What was found around the places of a cell.
struct Found {
    /// Irradiance by the light from each cell of directions.
    light: Vec<f64>,
    /// The same sum if nothing hid the sky.
    all: f64,
    /// Irradiance by each sky that may be chosen.
    skies: Vec<f64>,
}

impl InLanes for Learning<'_> {
    type Output = Option<Openings>;
    fn run<const N: usize>(self) -> Option<Openings> {
        let draw = self.world.method.basis.draw(0.5);
        let places = self.inside::<N>(self.places::<N>(), &draw);
        if places.is_empty() {
            return None;
        }
        let bounds = Bounds::around(places.iter().map(|(point, _)| point.position));
        let (grid, cells) = ALONG.iter().find_map(|&along| self.cells(&bounds, along, &places))?;
        let radiance = self.radiance::<N>(&draw);
        let seen = |(number, cell): (usize, &Vec<u32>)| {
            let count = cell.len().min(PLACES);
            let chosen: Vec<Place> = (0..count).map(|i| places[cell[i * cell.len() / count] as usize]).collect();
            (count > 0).then(|| self.look::<N>(number as u32, &chosen, &radiance, &draw))
        };
        let found: Vec<Option<Found>> = cells.par_iter().enumerate().map(seen).collect();
        let mut openings = Openings { grid, cells: vec![0; cells.len()], views: Vec::new() };
        for (number, cell) in found.iter().enumerate() {
            if let Some(cell) = cell {
                let neighbors = grid.neighbors(number).filter_map(|other| found[other].as_ref());
                openings.views.push(self.view(cell, neighbors));
                openings.cells[number] = openings.views.len() as u32;
            }
        }
        openings.views.iter().any(SkyView::is_aimed).then_some(openings)
    }
}

impl Learning<'_> {
    /// Places that scatter widely on the camera's paths.
    fn places<const N: usize>(&self) -> Vec<Place> {
        let (world, film) = (self.world, self.world.scene.film);
        let mut tracer = Tracer::<N>::new(world);
        tracer.lit = Some(Vec::new());
        // A stride that is coprime to the number of places visits them all, far ones first.
        let places = SIDE * SIDE;
        for place in (0..places).map(|i| (i * 1597) % places).take((self.rays / FIRST) as usize) {
            let spread = |i: u32, size: u32| ((u64::from(2 * i + 1) * u64::from(size)) / u64::from(2 * SIDE)) as u32;
            let (x, y) = (spread(place % SIDE, film.width), spread(place / SIDE, film.height));
            sample(world, &mut tracer, &Sampler::new(world.method.seed ^ SEED, [x, y], place), x, y);
            if tracer.lit.as_ref().is_some_and(|lit| lit.len() >= MANY_PLACES) {
                break;
            }
        }
        tracer.lit.unwrap_or_default()
    }

    /// Those places that do not see most of the sky; none if that is most of them, or if nothing of the sky is seen from any.
    fn inside<const N: usize>(&self, places: Vec<Place>, draw: &Draw<N>) -> Vec<Place> {
        let (count, mut seen) = (places.len(), 0.0);
        let each = (self.rays / FIRST / count.max(1) as u64).clamp(4, 64) as u32;
        let numbered = (0..).zip(places);
        let inside = |(number, place): (u32, Place)| {
            let arriving = |i: u32| {
                let u = self.numbers([number, 0], i);
                let direction = unit(Frame::about(place.1).to_world(cosine_hemisphere([u[0], u[1]])));
                self.arriving(&place.0, direction, draw)
            };
            let sum: f64 = (0..each).map(arriving).sum();
            (sum <= OPEN * f64::from(each)).then(|| {
                seen += sum;
                place
            })
        };
        let found: Vec<Place> = numbered.filter_map(inside).collect();
        if seen == 0.0 || 2 * found.len() < count { Vec::new() } else { found }
    }

    /// A grid and the places in each of its cells; none if the rays are too few for so many.
    fn cells(&self, bounds: &Bounds, along: usize, places: &[Place]) -> Option<(Grid, Vec<Vec<u32>>)> {
        let grid = Grid::new(bounds, along);
        let mut cells = vec![Vec::new(); grid.counts.iter().product()];
        for (number, (point, _)) in (0..).zip(places) {
            cells[grid.cell(point.position)?].push(number);
        }
        let used = cells.iter().filter(|cell| !cell.is_empty()).count();
        (used as u64 <= self.rays / (DIRECTIONS as u64 / 2)).then_some((grid, cells))
    }

    /// The sky's mean radiance in each cell of directions.
    fn radiance<const N: usize>(&self, draw: &Draw<N>) -> Vec<f64> {
        const ACROSS: usize = 4;
        let sky = &self.world.scene.lights[self.sky];
        let at = |i: usize| (i as f64 + 0.5) / ACROSS as f64;
        let mean = |cell: usize| {
            let toward = |i: usize| sky.toward(draw, direction(cell, [at(i % ACROSS), at(i / ACROSS)]), [0.0; 2]);
            let sum: f64 = (0..ACROSS * ACROSS).map(|i| brightness(draw, toward(i))).sum();
            sum / (ACROSS * ACROSS) as f64
        };
        if sky.is_even_sky() { vec![mean(0); DIRECTIONS] } else { (0..DIRECTIONS).map(mean).collect() }
    }

    /// What the places of a cell see of the skies: each direction from one of those that it can light.
    fn look<const N: usize>(&self, cell: u32, places: &[Place], radiance: &[f64], draw: &Draw<N>) -> Found {
        let world = self.world;
        let mut found = Found { light: vec![0.0; DIRECTIONS], all: 0.0, skies: Vec::new() };
        for (number, radiance) in radiance.iter().enumerate() {
            let u = self.numbers([cell, 1], number as u32);
            let toward = direction(number, [u[0], u[1]]);
            let first = (u[2] * places.len() as f64) as usize;
            let above = |i: usize| {
                let (point, normal) = &places[(first + i) % places.len()];
                Some((point, normal.dot(toward))).filter(|(_, cos)| *cos > 0.0)
            };
            if let Some((point, cos)) = (0..places.len()).find_map(above) {
                let angle = cos * (4.0 * PI / DIRECTIONS as f64);
                let whole = radiance * angle;
                found.all += whole;
                found.light[number] = whole * self.arriving(point, toward, draw);
            }
        }
        for (id, _) in world.choice.skies() {
            let irradiance = match &world.scene.lights[*id] {
                Light::Environment(_) => found.light.iter().sum(),
                _ => {
                    let one = |i: usize| self.of_sun(*id, ([cell, 2 + *id as u32], i), &places[i / EACH], draw);
                    (0..EACH * places.len()).map(one).sum::<f64>() / (EACH * places.len()) as f64
                }
            };
            found.skies.push(irradiance);
        }
        found
    }

    /// The irradiance by a sun at a place, by one direction to it.
    fn of_sun<const N: usize>(&self, id: LightId, number: ([u32; 2], usize), place: &Place, draw: &Draw<N>) -> f64 {
        let (u, (point, normal)) = (self.numbers(number.0, number.1 as u32), place);
        let sun = &self.world.scene.lights[id];
        let Some(Sighting { direction, .. }) = sun.aim(point.position, *normal, [u[0], u[1]]) else { return 0.0 };
        let cos = normal.dot(direction);
        if cos <= 0.0 {
            return 0.0;
        }
        cos * self.arriving(point, direction, draw) * brightness(draw, sun.toward(draw, direction, [0.0; 2]))
    }

    /// The view from a cell: what was found there and around.
    fn view<'a>(&self, found: &Found, neighbors: impl Iterator<Item = &'a Found>) -> SkyView {
        let mut light = found.light.clone();
        for neighbor in neighbors {
            light.iter_mut().zip(&neighbor.light).for_each(|(sum, more)| *sum += BESIDE * more);
        }
        let all: f64 = found.skies.iter().sum();
        let chosen = |(&arriving, &(_, sent)): (&f64, &(LightId, f64))| {
            if all > 0.0 { BY_ARRIVING * arriving / all + (1.0 - BY_ARRIVING) * sent } else { sent }
        };
        let skies = found.skies.iter().zip(self.world.choice.skies()).map(chosen).collect();
        let sky = (found.light.iter().sum::<f64>() < OPEN * found.all).then(|| spread(&light));
        SkyView::new(sky.as_deref(), skies)
    }

    /// The share of the light from a direction of the sky that arrives at a place.
    fn arriving<const N: usize>(&self, point: &SurfacePoint, toward: DVec3, draw: &Draw<N>) -> f64 {
        let (world, ray) = (self.world, point.leave(toward));
        let closed = |object| !world.is_see_through(object);
        if world.scene.is_hidden_by(&ray, f64::INFINITY, None, &Cell::new(None), closed) {
            return 0.0;
        }
        self.transmitted(point, toward, f64::INFINITY, draw)
    }

    /// The share of light that goes straight on up to a distance, where nothing hides it.
    fn transmitted<const N: usize>(&self, point: &SurfacePoint, toward: DVec3, distance: f64, draw: &Draw<N>) -> f64 {
        if !self.world.has_see_through() {
            return 1.0;
        }
        let all = straight::transmittance(self.world, draw, &point.leave(toward), distance, None);
        all.map_or(0.0, |(share, _)| brightness(draw, share))
    }

    fn numbers(&self, place: [u32; 2], number: u32) -> [f64; 4] {
        Sampler::new(self.world.method.seed ^ SEED, place, number).four_plain(BranchKey::CAMERA, 0)
    }
}

/// The mean of what the lanes carry.
fn brightness<const N: usize>(draw: &Draw<N>, light: Lanes<N>) -> f64 {
    f64::from((light * *draw.shares(false)).sum())
}
