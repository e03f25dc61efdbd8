//! How far dispersion pulls colors apart, measured by rays of two colors that are sent the same way.

use super::World;
use super::media::{self, Media};
use super::path::Path;
use super::shading;
use super::straight;
use crate::light::Light;
use crate::material::{Facets, Interface, Material, RoughSurface, reflect};
use crate::math::{BranchKey, DVec2, DVec3, Frame, Ray, Sampler, cosine_hemisphere, unit};
use crate::shape::SurfacePoint;
use crate::spectrum::Draw;

/// What rays of two colors found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// Share of the camera rays that meet a dispersive surface.
    pub seen: f64,
    /// How many pixels apart 400 and 700 nm show what lies behind dispersive surfaces: nine tenths of the rays less.
    pub seen_pixels: f64,
    /// The same for the light that comes through dispersive surfaces to diffuse ones.
    pub lit_pixels: f64,
}

/// The colors whose ways are compared, in nm: between them lies nearly all that is seen.
pub const COLORS_NM: [f64; 2] = [400.0, 700.0];
/// Camera rays along each side of the image.
const SIDE: u32 = 24;
/// Surfaces after which a ray is given up.
const LONGEST: usize = 24;
/// Length of the step to a ray's neighbor, in pixels.
const STEP: f64 = 1.0 / 16.0;

/// Sends a few hundred rays through a world of two lanes, those of [`COLORS_NM`].
pub fn spread(world: &World) -> Spread {
    let draw = Draw::<4>::fixed(2);
    let film = world.scene.film;
    let (mut seen, mut lit, mut rays) = (Vec::new(), Vec::new(), 0_u32);
    let alone = nothing_behind(world);
    let shines_from_somewhere = world.scene.lights.iter().any(|light| !light.is_even_sky());
    for place in 0..SIDE * SIDE {
        let spread = |i: u32, size: u32| (f64::from(i) + 0.5) * f64::from(size) / f64::from(SIDE);
        let at = DVec2::new(spread(place % SIDE, film.width), spread(place / SIDE, film.height));
        let sampler = Sampler::new(world.method.seed, [place, 0], 0);
        let walk = |offset: DVec2, lane: usize| {
            let ray = world.scene.camera.ray(at + offset);
            let media = Path::from_camera(world, &draw, ray).media;
            follow(world, &draw, lane, ray, media, &sampler)
        };
        let from_camera = [0, 1].map(|lane| walk(DVec2::ZERO, lane));
        let beside = walk(DVec2::new(STEP, 0.0), 0);
        rays += 1;
        if from_camera[0].dispersive {
            seen.push(if alone { 0.0 } else { apart(&from_camera, &beside, world.scene.camera.pixel_angle()) });
        }
        let (Some(start), Some(neighbor)) = (from_camera[0].point, beside.point) else { continue };
        if !from_camera[0].diffuse || world.method.diffuse_bounces == 0 || !shines_from_somewhere {
            continue;
        }
        let viewed = from_camera[0].direction.dot(start.normal);
        let normal = if viewed < 0.0 { start.normal } else { -start.normal };
        let [.., u, v] = sampler.four(BranchKey::CAMERA, 1);
        let direction = unit(Frame::about(normal).to_world(cosine_hemisphere([u, v])));
        let ray = start.leave(direction);
        let ends = [0, 1].map(|lane| follow(world, &draw, lane, ray, from_camera[0].media, &sampler));
        if ends[0].dispersive {
            let turned = angle(ends[0].direction, ends[1].direction);
            let pixel = (neighbor.position - start.position).length() / STEP;
            lit.push(if pixel > 0.0 { turned * ends[0].first_step / pixel } else { 0.0 });
        }
    }
    Spread { seen: seen.len() as f64 / f64::from(rays), seen_pixels: upper_decile(seen), lit_pixels: upper_decile(lit) }
}

/// Where a ray ends that follows smooth surfaces.
struct End {
    /// The surface it meets; none if it leaves the scene.
    point: Option<SurfacePoint>,
    /// The ray's last direction.
    direction: DVec3,
    /// Whether it is a surface that scatters widely.
    diffuse: bool,
    /// Whether the way leads over a dispersive surface.
    dispersive: bool,
    /// Distance to the first surface.
    first_step: f64,
    media: Media,
}

/// Follows one lane; where light may go two ways, random numbers choose, the same for both colors.
fn follow(world: &World, draw: &Draw<4>, lane: usize, ray: Ray, media: Media, sampler: &Sampler) -> End {
    let mut end =
        End { point: None, direction: ray.direction, diffuse: false, dispersive: false, first_step: 0.0, media };
    let (mut ray, mut key) = (ray, BranchKey::CAMERA);
    for number in 0..LONGEST {
        end.direction = ray.direction;
        let Some(hit) = world.scene.intersect(&ray) else { return end };
        let object = &world.scene.objects[hit.object as usize];
        let point = object.point(&ray, &hit.crossing);
        if number == 0 {
            end.first_step = hit.crossing.t;
        }
        let front = point.normal.dot(ray.direction) < 0.0;
        let wo = -ray.direction;
        let [_, normal] = shading::normals(&point, wo);
        key = key.child(0);
        let straight =
            |ray| straight::straight_at(world, draw, (ray, draw.start()), end.media.inside(world), (&hit, &point));
        if world.is_see_through(hit.object)
            && straight(&ray).is_some_and(|on| sampler.four_plain(key, 7)[1] < f64::from(on.share()[0]))
        {
            ray = point.leave(ray.direction);
            continue;
        }
        let direction = match world.scene.material_of(hit.object) {
            Material::Dielectric(glass) => {
                let Some(boundary) = end.media.boundary(world, object.material, front) else {
                    ray = point.leave(ray.direction);
                    continue;
                };
                let indices = [boundary.here, boundary.beyond].map(|inside| media::index(world, draw, inside));
                end.dispersive |= indices.iter().any(|index| index[0] != index[1]);
                let [n1, n2] = indices.map(|index| index[lane]);
                let [u, _, across @ ..] = sampler.four_plain(key, 7);
                // The same facet for both colors.
                let facets = glass.roughness.interface().map(|rough| rough.facets());
                let facet = facets.map_or(normal, |facets| visible(facets, wo, normal, across));
                let interface = Interface::new(n1, n2, wo.dot(facet));
                // The first color's reflectance decides for both, but where it is reflected totally: there the edge has colors.
                let first = Interface::new(indices[0][0], indices[1][0], wo.dot(facet));
                let chance = if first.transmittance == 0.0 { interface.reflectance } else { first.reflectance };
                let (direction, side) = if n1 != n2 && (interface.transmittance == 0.0 || u < chance) {
                    (reflect(wo, facet), 1.0)
                } else {
                    end.media = boundary.crossed;
                    (if n1 == n2 { ray.direction } else { interface.refract(wo, facet) }, -1.0)
                };
                if facets.is_some() && direction.dot(normal) * side <= 0.0 {
                    return end;
                }
                direction
            }
            Material::Mirror(_) => reflect(wo, normal),
            Material::Thin(_) => ray.direction,
            Material::Conductor(metal) => match metal.roughness.surface() {
                None => reflect(wo, normal),
                // The same facet for both colors, as if it were all there is.
                Some(surface) => {
                    let [.., u, v] = sampler.four_plain(key, 7);
                    match mirrored(surface, wo, normal, [u, v]) {
                        Some(direction) => direction,
                        None => return end,
                    }
                }
            },
            material => {
                end.diffuse = material.scatters_widely();
                end.point = Some(point);
                return end;
            }
        };
        ray = point.leave(direction);
    }
    end
}

/// The normal of a facet that is visible from `wo`.
fn visible(facets: &Facets, wo: DVec3, normal: DVec3, u: [f64; 2]) -> DVec3 {
    let frame = Frame::about(normal);
    let local = frame.to_local(wo);
    frame.to_world(facets.visible_normal(DVec3 { z: local.z.max(0.0), ..local }, u))
}

/// The mirror image of `wo` about a visible facet; none if it lies below the surface.
fn mirrored(surface: &RoughSurface, wo: DVec3, normal: DVec3, u: [f64; 2]) -> Option<DVec3> {
    let frame = Frame::about(normal);
    let local = frame.to_local(wo);
    let wi = reflect(local, surface.facets().visible_normal(local, u));
    (wi.z > 0.0).then(|| unit(frame.to_world(wi)))
}

/// How many pixels lie between the ends of two colors, where the first one's neighbor shows how far a pixel goes.
fn apart(ends: &[End; 2], beside: &End, pixel_angle: f64) -> f64 {
    let pixels = |apart: f64, step: f64| if step > 0.0 { apart / (step / STEP) } else { 0.0 };
    // Parallel rays stay parallel behind flat glass: there a pixel has the angle that the camera gives it.
    let turn = |neighbor: f64| if neighbor > 0.0 { neighbor } else { pixel_angle * STEP };
    match [&ends[0], &ends[1], beside].map(|end| end.point.map(|point| point.position)) {
        [Some(a), Some(b), Some(neighbor)] => pixels((a - b).length(), (a - neighbor).length()),
        _ => pixels(angle(ends[0].direction, ends[1].direction), turn(angle(ends[0].direction, beside.direction))),
    }
}

/// Whether clear bodies stand alone in an even environment, so that whatever they bend looks the same.
fn nothing_behind(world: &World) -> bool {
    let clear = |object: u32| world.scene.material_of(object).medium().is_some();
    (0..world.scene.objects.len()).all(|object| clear(object as u32))
        && world.scene.lights.iter().all(Light::is_even_sky)
}

fn angle(a: DVec3, b: DVec3) -> f64 {
    libm::atan2(a.cross(b).length(), a.dot(b))
}

fn upper_decile(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    if values.is_empty() { 0.0 } else { values[(values.len() * 9 / 10).min(values.len() - 1)] }
}
