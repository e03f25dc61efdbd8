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
/// Part of them that finds out whether the sky is seen at all, and of how many it is enough to see that it is.
const FIRST: u64 = 16;
const ENOUGH: u64 = 1024;
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
/// The reflectance that is taken for that of what the sun shines on.
const GRAY: f64 = 0.5;
/// How many of the paths leave diffuse surfaces toward what the sun shines on, at most; fewer where its light is little beside
/// what comes from all around, which is taken for a share of its mean over all places.
const FOLLOWED: f64 = 0.5;
const AMBIENT: f64 = 0.25;

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
    /// Irradiance by what the sun shines on in each cell of directions.
    sunlit: Vec<f64>,
    /// Irradiance by each sky that may be chosen.
    skies: Vec<f64>,
}

impl InLanes for Learning<'_> {
    type Output = Option<Openings>;
    fn run<const N: usize>(self) -> Option<Openings> {
        let places = self.places::<N>();
        let draw = self.world.method.basis.draw(0.5);
        if places.is_empty() || !self.is_seen_through_openings::<N>(&places, &draw) {
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
        let known = found.iter().flatten();
        let usual = known.clone().flat_map(|cell| &cell.sunlit).sum::<f64>() / known.count().max(1) as f64;
        let mut openings = Openings { grid, cells: vec![0; cells.len()], views: Vec::new() };
        for (number, cell) in found.iter().enumerate() {
            if let Some(cell) = cell {
                let neighbors = grid.neighbors(number).filter_map(|other| found[other].as_ref());
                openings.views.push(self.view(cell, neighbors, AMBIENT * usual));
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

    /// Whether some of the sky is seen, but not most of it.
    fn is_seen_through_openings<const N: usize>(&self, places: &[Place], draw: &Draw<N>) -> bool {
        let mut seen = 0.0;
        for number in 0..self.rays / FIRST {
            let u = self.numbers([u32::MAX, 0], number as u32);
            let (point, normal) = &places[((u[2] * places.len() as f64) as usize).min(places.len() - 1)];
            let direction = unit(Frame::about(*normal).to_world(cosine_hemisphere([u[0], u[1]])));
            seen += self.arriving(point, direction, draw);
            if number + 1 == ENOUGH && seen > OPEN * ENOUGH as f64 {
                return false;
            }
        }
        seen > 0.0
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
        let mut found =
            Found { light: vec![0.0; DIRECTIONS], all: 0.0, sunlit: vec![0.0; DIRECTIONS], skies: Vec::new() };
        for number in 0..DIRECTIONS {
            let u = self.numbers([cell, 1], number as u32);
            let toward = direction(number, [u[0], u[1]]);
            let first = (u[2] * places.len() as f64) as usize;
            let above = |i: usize| {
                let (point, normal) = &places[(first + i) % places.len()];
                Some((point, normal.dot(toward))).filter(|(_, cos)| *cos > 0.0)
            };
            if let Some((point, cos)) = (0..places.len()).find_map(above) {
                let angle = cos * (4.0 * PI / DIRECTIONS as f64);
                let whole = radiance[number] * angle;
                found.all += whole;
                match self.opaque(point, toward) {
                    None => found.light[number] = whole * self.transmitted(point, toward, f64::INFINITY, draw),
                    Some((distance, lit)) => {
                        let shining = self.of_suns(([cell, 1], DIRECTIONS + number), &lit, draw);
                        if shining > 0.0 {
                            found.sunlit[number] =
                                GRAY / PI * angle * shining * self.transmitted(point, toward, distance, draw);
                        }
                    }
                }
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

    /// The irradiance by all suns at a place.
    fn of_suns<const N: usize>(&self, number: ([u32; 2], usize), place: &Place, draw: &Draw<N>) -> f64 {
        let skies = self.world.choice.skies().iter();
        let suns = skies.filter(|(id, _)| matches!(self.world.scene.lights[*id], Light::Sun(_)));
        suns.map(|(id, _)| self.of_sun(*id, number, place, draw)).sum()
    }

    /// The nearest surface in a direction that lets nothing straight on: its distance, and the place with its normal on this side.
    fn opaque(&self, point: &SurfacePoint, toward: DVec3) -> Option<(f64, Place)> {
        let (scene, ray) = (&self.world.scene, point.leave(toward));
        let hit = scene.nearest(&ray, f64::INFINITY, |object| !self.world.is_see_through(object))?;
        let point = scene.objects[hit.object as usize].point(&ray, &hit.crossing);
        let normal = if point.normal.dot(toward) < 0.0 { point.normal } else { -point.normal };
        Some((hit.crossing.t, (point, normal)))
    }

    /// The view from a cell: what was found there and around. `usual` is what of such light comes from all around.
    fn view<'a>(&self, found: &Found, neighbors: impl Iterator<Item = &'a Found>, usual: f64) -> SkyView {
        let [mut light, mut sunlit] = [found.light.clone(), found.sunlit.clone()];
        let add =
            |sum: &mut [f64], more: &[f64]| sum.iter_mut().zip(more).for_each(|(sum, more)| *sum += BESIDE * more);
        for neighbor in neighbors {
            add(&mut light, &neighbor.light);
            add(&mut sunlit, &neighbor.sunlit);
        }
        let all: f64 = found.skies.iter().sum();
        let chosen = |(&arriving, &(_, sent)): (&f64, &(LightId, f64))| {
            if all > 0.0 { BY_ARRIVING * arriving / all + (1.0 - BY_ARRIVING) * sent } else { sent }
        };
        let skies = found.skies.iter().zip(self.world.choice.skies()).map(chosen).collect();
        let sky = (found.light.iter().sum::<f64>() < OPEN * found.all).then(|| spread(&light));
        let shining: f64 = found.sunlit.iter().sum();
        let share = if shining > 0.0 { FOLLOWED * shining / (shining + usual) } else { 0.0 };
        let sunlit = (share > 0.0).then(|| spread(&sunlit));
        SkyView::new(sky.as_deref(), sunlit.as_deref().map(|sunlit| (sunlit, share)), skies)
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
