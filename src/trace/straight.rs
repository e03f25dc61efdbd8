//! Light that goes straight on through the holes of masks and through panes that bend nothing.

use std::cell::Cell;

use super::interaction::arrival;
use super::media;
use super::path::{Among, Path};
use super::polarization::Polarized;
use super::{Transport, World, shading};
use crate::material::{Scatter, Straight};
use crate::math::{Ray, Sampler};
use crate::scene::{Ends, Hit, MaterialId, Sight};
use crate::shape::SurfacePoint;
use crate::spectrum::{Draw, Lanes};

/// Use of the random numbers of a ray from the camera that meets a surface with holes.
const COVER: u32 = 4;

/// The share of each lane of a path that goes straight on where it meets a surface; none if nothing does.
#[inline]
pub(super) fn straight_on<const N: usize>(
    world: &World,
    draw: &Draw<N>,
    path: &Path<N>,
    hit: &Hit,
    point: &SurfacePoint,
) -> Option<Straight<N>> {
    if world.is_see_through(hit.object) { through_surface(world, draw, path, hit, point) } else { None }
}

/// The same of a surface that lets light straight on.
#[cold]
#[inline(never)]
fn through_surface<const N: usize>(
    world: &World,
    draw: &Draw<N>,
    path: &Path<N>,
    hit: &Hit,
    point: &SurfacePoint,
) -> Option<Straight<N>> {
    let present = path.throughput.present();
    let straight = straight_at(world, draw, &path.ray, present, path.media.inside(&world.scene), hit, point)?;
    (!(straight.share() * present).is_zero()).then_some(straight)
}

/// Whether a ray from the camera counts as having met a surface, which may have holes: a pane is met, a hole is not.
pub(super) fn is_met<const N: usize>(
    world: &World,
    draw: &Draw<N>,
    sampler: &Sampler,
    path: &Path<N>,
    straight: Option<&Straight<N>>,
) -> bool {
    let Some(straight) = straight.filter(|straight| !straight.holes.is_zero()) else { return true };
    let u = match world.method.transport {
        Transport::Deterministic { .. } => 0.5,
        Transport::Random { .. } => sampler.four_plain(path.key, COVER)[0],
    };
    let shares = draw.shares(path.parted);
    path.throughput.through(straight.holes).weight(shares) <= u * path.throughput.weight(shares)
}

/// The straight way of light to a place, which something may occlude.
pub(super) struct Passage<'a> {
    /// From the place toward the light.
    pub(super) ray: &'a Ray,
    /// How far away the light is.
    pub(super) distance: f64,
    pub(super) ends: Ends,
    /// The medium around the ray.
    pub(super) inside: Option<MaterialId>,
    /// Which objects may occlude it.
    pub(super) past: Past,
    /// The object that occluded a light last.
    pub(super) last_occluder: &'a Cell<Option<u32>>,
}

/// Which objects may occlude a way.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Past {
    /// Those that are there for a path.
    Objects(Among),
    /// Those that are not hidden from the camera, to which it leads.
    Seen,
}

impl Past {
    fn is_all(self, world: &World) -> bool {
        self == Self::Objects(Among::All) || !world.hides_objects
    }

    fn has(self, world: &World, object: u32) -> bool {
        match self {
            Self::Objects(Among::All) => true,
            Self::Objects(Among::Plate) => world.scene.is_of_plate(object),
            Self::Seen => world.sight(object) != Sight::Hidden,
        }
    }
}

impl Passage<'_> {
    /// What arrives of light through holes, panes and the medium, and how far panes polarize it; none if something
    /// occludes it. `light` is asked only if nothing does.
    #[inline]
    pub(super) fn arriving<const N: usize>(
        &self,
        world: &World,
        draw: &Draw<N>,
        light: impl FnOnce() -> Lanes<N>,
    ) -> Option<(Lanes<N>, Polarized)> {
        let Self { ray, distance, ends, inside, past, last_occluder } = *self;
        let (mut arriving, polarized);
        let all = past.is_all(world);
        if !all || world.has_see_through() {
            let is_there = |object| all || past.has(world, object);
            let closed = |object| !world.is_see_through(object) && is_there(object);
            if world.scene.is_occluded_by(ray, distance, ends, last_occluder, closed) {
                return None;
            }
            let (share, of_panes) = transmittance(world, draw, ray, distance, inside, is_there)?;
            (arriving, polarized) = (light() * share, of_panes);
        } else if world.scene.is_occluded(ray, distance, ends, last_occluder) {
            return None;
        } else {
            (arriving, polarized) = (light(), Polarized::NOT);
        }
        if let Some(material) = inside {
            arriving = arriving * media::medium(&world.scene, material).transmission(draw, distance);
        }
        Some((arriving, polarized))
    }
}

/// The share of each lane that goes straight on through all surfaces before a light at a distance that let it, and how
/// far these polarize it; none if no light does.
///
/// `inside` is the medium around the ray.
#[cold]
#[inline(never)]
fn transmittance<const N: usize>(
    world: &World,
    draw: &Draw<N>,
    ray: &Ray,
    distance: f64,
    inside: Option<MaterialId>,
    is_there: impl Fn(u32) -> bool,
) -> Option<(Lanes<N>, Polarized)> {
    let (mut ray, mut left, mut all, mut polarized) = (*ray, distance, Lanes::ONE, Polarized::NOT);
    let counts = |object: u32| world.is_see_through(object) && is_there(object);
    while let Some(hit) = world.scene.nearest(&ray, left, counts) {
        let point = world.scene.objects[hit.object as usize].point(&ray, &hit.crossing);
        let straight = straight_at(world, draw, &ray, Lanes::ONE, inside, &hit, &point)?;
        (all, polarized) = (all * straight.share(), polarized.after(straight.polarization));
        if all.is_zero() {
            return None;
        }
        left -= hit.crossing.t;
        ray = point.leave(ray.direction);
    }
    Some((all, polarized))
}

/// The share of each lane that a material lets straight on where a ray meets it: what every ray asks.
pub(super) fn straight_at<const N: usize>(
    world: &World,
    draw: &Draw<N>,
    ray: &Ray,
    present: Lanes<N>,
    inside: Option<MaterialId>,
    hit: &Hit,
    point: &SurfacePoint,
) -> Option<Straight<N>> {
    let (wo, uv) = (-ray.direction, world.scene.objects[hit.object as usize].uv(&hit.crossing, point));
    let [_, normal] = shading::normals(point, wo);
    let arrival = arrival(world, draw, wo, normal, uv, present, [inside; 2]);
    world.scene.material_of(hit.object).straight(&arrival)
}
