//! Light that passes through the holes of masks.

use super::path::Path;
use super::{Transport, World, media};
use crate::material::Arrival;
use crate::math::{Ray, Sampler};
use crate::scene::{Hit, MaterialId};
use crate::shape::SurfacePoint;
use crate::spectrum::{Draw, Lanes};

/// Use of the random numbers of a ray from the camera that meets a surface with holes.
const COVER: u32 = 4;

/// The share of each lane of a path that passes straight on where it meets a surface; none if nothing does.
#[inline]
pub(super) fn passing<const N: usize>(
    world: &World,
    draw: &Draw<N>,
    path: &Path<N>,
    hit: &Hit,
    point: &SurfacePoint,
) -> Option<Lanes<N>> {
    if world.has_holes(hit.object) { passing_in_part(world, draw, path, hit, point) } else { None }
}

/// The same of a surface with holes.
#[cold]
#[inline(never)]
fn passing_in_part<const N: usize>(
    world: &World,
    draw: &Draw<N>,
    path: &Path<N>,
    hit: &Hit,
    point: &SurfacePoint,
) -> Option<Lanes<N>> {
    let present = path.throughput.present();
    let share = passing_at(world, draw, (&path.ray, present), path.media.inside(world), (hit, point))?;
    (!(share * present).is_zero()).then_some(share)
}

/// Whether a ray from the camera counts as having met a surface, of which a share may let it pass.
pub(super) fn is_met<const N: usize>(
    world: &World,
    draw: &Draw<N>,
    sampler: &Sampler,
    path: &Path<N>,
    passing: Option<Lanes<N>>,
) -> bool {
    let Some(passing) = passing else { return true };
    let u = match world.method.transport {
        Transport::Deterministic { .. } => 0.5,
        Transport::Random { .. } => sampler.four_plain(path.key, COVER)[0],
    };
    let shares = draw.shares(path.parted);
    path.throughput.through(passing).weight(shares) <= u * path.throughput.weight(shares)
}

/// The share of each lane that passes all holes before a light at a distance; none if no light does.
///
/// `inside` is the medium around the ray.
pub(super) fn through_holes<const N: usize>(
    world: &World,
    draw: &Draw<N>,
    ray: &Ray,
    distance: f64,
    inside: Option<MaterialId>,
) -> Option<Lanes<N>> {
    let (mut ray, mut left, mut all) = (*ray, distance, Lanes::ONE);
    while let Some(hit) = world.scene.nearest(&ray, left, |object| world.has_holes(object)) {
        let point = world.scene.objects[hit.object as usize].shape.point(&ray, &hit.crossing);
        all = all * passing_at(world, draw, (&ray, Lanes::ONE), inside, (&hit, &point))?;
        if all.is_zero() {
            return None;
        }
        left -= hit.crossing.t;
        ray = point.leave(ray.direction);
    }
    Some(all)
}

/// The share of each lane that a material lets straight through where a ray meets it: what every ray asks.
pub(super) fn passing_at<const N: usize>(
    world: &World,
    draw: &Draw<N>,
    (ray, present): (&Ray, Lanes<N>),
    inside: Option<MaterialId>,
    (hit, point): (&Hit, &SurfacePoint),
) -> Option<Lanes<N>> {
    let index = media::index(world, draw, inside);
    let normal = if point.normal.dot(ray.direction) < 0.0 { point.normal } else { -point.normal };
    let (wo, together) = (-ray.direction, world.method.together);
    let uv = world.scene.objects[hit.object as usize].uv(&hit.crossing, point);
    let (incident, beyond, direction_indices) = (index, index, [None; 2]);
    let arrival = Arrival { wo, normal, uv, draw, present, incident, beyond, direction_indices, together };
    world.scene.material_of(hit.object).passing(&arrival)
}
