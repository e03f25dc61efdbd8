//! The loop that follows rays back to the light.

use super::direct::{Gathering, add, weight_of_meeting};
use super::media;
use super::path::{Drawn, Path};
use super::{Transport, World};
use crate::light::Light;
use crate::material::{Arrival, Branch};
use crate::math::{Ray, Sampler};
use crate::scene::Hit;
use crate::shape::SurfacePoint;
use crate::spectrum::Draw;

/// Follows the rays of camera samples, one sample after another; its buffers live as long as it does.
pub(super) struct Tracer<'a, const N: usize> {
    world: &'a World,
    pending: Vec<Path<N>>,
    branches: Vec<Branch<N>>,
    pub(super) tally: Tally,
}

/// What happened to the rays of many samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Tally {
    /// Rays followed, without those to lights.
    pub(super) rays: u64,
    /// Weight of the branches that deterministic transport did not follow.
    pub(super) dropped: f64,
    /// Weight of paths that met more surfaces than any path should.
    pub(super) stopped: f64,
    /// Surfaces of bodies that were left without having been entered.
    pub(super) unmatched: u64,
    /// Surfaces at which lanes parted.
    pub(super) partings: u64,
    /// Bound of the weight that polarization would move: the sum of weight x |P_A P_B| over consecutive smooth surfaces.
    pub(super) polarization: f64,
}

/// Surfaces after which a path is stopped: light caught in a clear body for good, which no weight would end.
const LAST_VERTEX: u32 = 1_000;
/// Surfaces after which roulette ends even a path that loses nothing, one time in a hundred.
const LONG: u32 = 64;
/// The most certain that a long path is to go on.
const SURE: f64 = 0.99;
/// The least likely that a faint path goes on, so that none comes back brighter than ten times.
const UNLIKELY: f64 = 0.1;

/// Uses of the random numbers at a vertex.
const SCATTER: u32 = 1;
const CHOICE: u32 = 2;

impl<'a, const N: usize> Tracer<'a, N> {
    pub(super) fn new(world: &'a World) -> Self {
        Self { world, pending: Vec::new(), branches: Vec::new(), tally: Tally::default() }
    }

    /// What the sensor receives along a camera ray, and what the ray met first.
    pub(super) fn radiance(&mut self, ray: Ray, draw: &Draw<N>, sampler: &Sampler) -> ([f64; 3], Option<SurfacePoint>) {
        let mut sum = [0.0; 3];
        let mut first = None;
        let mut next = Some(Path::from_camera(self.world, draw, ray));
        while let Some(mut path) = next.take().or_else(|| self.pending.pop()) {
            self.tally.rays += 1;
            let Some(hit) = self.world.scene.intersect(&path.ray) else {
                path.absorb(self.world, draw, f64::INFINITY);
                add(&mut sum, self.background(&path, draw));
                continue;
            };
            path.absorb(self.world, draw, hit.crossing.t);
            let point = self.world.scene.objects[hit.object as usize].shape.point(&path.ray, &hit.crossing);
            if path.vertices == 0 {
                first = Some(point);
            }
            path.vertices += 1;
            add(&mut sum, self.emission(&path, draw, &hit, &point));
            add(&mut sum, self.scatter(&path, draw, sampler, &hit, &point));
            next = self.pending.pop();
        }
        (sum, first)
    }

    /// The light of the environment at the end of a path that meets nothing.
    fn background(&self, path: &Path<N>, draw: &Draw<N>) -> [f64; 3] {
        let Some(id) = self.world.scene.environment else { return [0.0; 3] };
        let weight = weight_of_meeting(self.world, id, path.drawn.as_ref(), &path.ray, None);
        let light = path.throughput.scaled(weight).of(draw.read(self.world.scene.lights[id].emission()));
        self.world.responses[id].sensor(draw, light)
    }

    /// The light of a surface that shines by itself.
    fn emission(&self, path: &Path<N>, draw: &Draw<N>, hit: &Hit, point: &SurfacePoint) -> [f64; 3] {
        let Some(id) = self.world.scene.objects[hit.object as usize].light else { return [0.0; 3] };
        let Light::Area(area) = &self.world.scene.lights[id] else { return [0.0; 3] };
        if !area.sides.shine(point.normal.dot(path.ray.direction) < 0.0) {
            return [0.0; 3];
        }
        let weight = weight_of_meeting(self.world, id, path.drawn.as_ref(), &path.ray, Some(&hit.crossing));
        let light = path.throughput.scaled(weight).of(draw.read(&area.radiance));
        self.world.responses[id].sensor(draw, light)
    }

    /// Gathers light at a surface and sends the path on; answers what lights sent straight to the surface.
    fn scatter(
        &mut self,
        path: &Path<N>,
        draw: &Draw<N>,
        sampler: &Sampler,
        hit: &Hit,
        point: &SurfacePoint,
    ) -> [f64; 3] {
        let world = self.world;
        let object = &world.scene.objects[hit.object as usize];
        let material = world.scene.material_of(hit.object);
        let front = point.normal.dot(path.ray.direction) < 0.0;
        let normal = if front { point.normal } else { -point.normal };

        // Find the media on both sides; a body hidden inside another of higher priority has no surface there.
        let (mut here, mut crossed) = (path.media.inside(world), path.media);
        let mut beyond = here;
        if material.medium().is_some() {
            match path.media.boundary(world, object.material, front) {
                Some(boundary) => (here, beyond, crossed) = (boundary.here, boundary.beyond, boundary.crossed),
                None => self.tally.unmatched += 1,
            }
            if here == beyond {
                let onward = point.leave(path.ray.direction);
                // No light was aimed at through this surface, so what the path meets beyond counts in full.
                let drawn = None;
                self.pending.push(Path { ray: onward, media: crossed, key: path.key.child(0), drawn, ..*path });
                return [0.0; 3];
            }
        }
        let arrival = Arrival {
            wo: -path.ray.direction,
            normal,
            draw,
            present: path.throughput.present(),
            incident: media::index(world, draw, here),
            beyond: media::index(world, draw, beyond),
        };

        // Gather light from the lights where light scatters widely.
        let mut direct = [0.0; 3];
        let (mut u, mut drawn) = ([0.0; 4], None);
        let goes_on = path.diffuse_left > 0;
        let wide = material.scatters_widely();
        if wide {
            u = sampler.four(path.key, SCATTER);
            let aims_at_all = world.aims_at_all(path.weight(draw));
            let throughput = path.throughput;
            let gathering =
                Gathering { world, material, arrival: &arrival, point, throughput, goes_on, aims_at_all, u };
            direct = gathering.direct(sampler, path.key);
            drawn = Some(Drawn { pdf: 0.0, normal, aimed_at_all: aims_at_all });
            if !goes_on {
                return direct;
            }
        }

        // Send the path on.
        self.branches.clear();
        material.scatter(&arrival, [u[2], u[3]], &mut self.branches);
        let child = |number: usize, branch: &Branch<N>| Path {
            ray: point.leave(branch.wi),
            throughput: path.throughput.through(branch.share),
            eta_scale: path.eta_scale * branch.eta_scale,
            media: if branch.crosses { crossed } else { path.media },
            key: path.key.child(number),
            vertices: path.vertices,
            diffuse_left: path.diffuse_left - u32::from(wide),
            drawn: branch.pdf.map(|pdf| Drawn { pdf, ..drawn.expect("only wide scattering has a density") }),
            polarization: branch.polarization,
        };
        self.tally.partings += u64::from(self.branches.iter().filter(|branch| branch.crosses).count() > 1);
        let children = self.branches.iter().enumerate().map(|(number, branch)| child(number, branch));
        follow(world, path, draw, sampler, children, &mut self.pending, &mut self.tally);
        direct
    }
}

/// Decides which children of a vertex are followed, and pushes them.
fn follow<const N: usize>(
    world: &World,
    path: &Path<N>,
    draw: &Draw<N>,
    sampler: &Sampler,
    children: impl Iterator<Item = Path<N>> + Clone,
    pending: &mut Vec<Path<N>>,
    tally: &mut Tally,
) {
    let weighed = children.map(|child| (child.weight(draw), child)).filter(|(weight, _)| *weight > 0.0);
    if path.polarization != 0.0 {
        let moved = |(weight, child): (f64, Path<N>)| weight * f64::from(path.polarization * child.polarization).abs();
        tally.polarization += weighed.clone().map(moved).sum::<f64>();
    }
    if path.vertices >= LAST_VERTEX && matches!(world.method.transport, Transport::Deterministic { .. }) {
        tally.stopped += weighed.map(|(weight, _)| weight).sum::<f64>();
        return;
    }
    match world.method.transport {
        Transport::Deterministic { cutoff } => {
            for (weight, child) in weighed {
                if weight >= cutoff { pending.push(child) } else { tally.dropped += weight }
            }
        }
        Transport::Random { split, roulette } => {
            let count = weighed.clone().count();
            let mut numbers = None;
            let mut u = |i: usize| numbers.get_or_insert_with(|| sampler.four(path.key, CHOICE))[i];
            if count > 1 && path.weight(draw) <= split {
                // Follow one, by its weight.
                let total: f64 = weighed.clone().map(|(weight, _)| weight).sum();
                let mut left = u(0) * total;
                let chosen = weighed.clone().find(|(weight, _)| {
                    left -= weight;
                    left < 0.0
                });
                if let Some((weight, mut child)) = chosen.or_else(|| weighed.last()) {
                    child.throughput = child.throughput.scaled(total / weight);
                    pending.extend(survivor(child, total, roulette, u(1)));
                }
            } else {
                for (number, (weight, child)) in weighed.enumerate() {
                    // A child that surely goes on needs no random number.
                    if weight >= roulette && path.vertices < LONG {
                        pending.push(child);
                    } else {
                        let number = if number < 3 { u(number + 1) } else { sampler.four(child.key, CHOICE)[0] };
                        pending.extend(survivor(child, weight, roulette, number));
                    }
                }
            }
        }
    }
}

/// Russian roulette on the weight (Arvo & Kirk 1990): the child made up for those that end, or none.
fn survivor<const N: usize>(mut child: Path<N>, weight: f64, roulette: f64, u: f64) -> Option<Path<N>> {
    let mut chance = (weight / roulette).clamp(UNLIKELY, 1.0);
    if child.vertices >= LONG {
        chance = chance.min(SURE);
    }
    if u >= chance {
        return None;
    }
    child.throughput = child.throughput.scaled(1.0 / chance);
    Some(child)
}
