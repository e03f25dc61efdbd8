//! A ray of one color, followed over smooth surfaces along the branch that carries most of its light.

use crate::material::{Dielectric, Facets, Interface, Material, RoughSurface, reflect};
use crate::math::{BranchKey, DVec2, DVec3, Frame, Ray, Sampler, unit};
use crate::shape::SurfacePoint;
use crate::spectrum::{Draw, Table};
use crate::trace::media::Media;
use crate::trace::walk::{SurfaceHit, pass_through, shading};
use crate::trace::{World, media};

/// Number of surfaces after which a ray is given up. Total reflection keeps one in six rays in a diamond for more than
/// 24.
const MAX_SURFACES: usize = 64;
/// Share of the light above which a fainter branch counts: half of what glass mirrors.
const MIN_SHARE: f64 = 0.02;
/// Rough reflectance of a glossy surface.
const ROUGH_REFLECTANCE: f64 = 0.05;
/// Use of the random numbers at a surface.
const SURFACE: u32 = 7;

/// The branch that is followed where light may take two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FollowedBranch {
    Brighter,
    /// The fainter branch at the first surface that has one, then the brighter one.
    FainterFirst,
    /// The fainter branch where light would first leave a dispersive body, then the brighter one: as in a rainbow.
    FainterInside,
}

/// The path of a ray of one color.
#[derive(Default)]
pub struct ColorWalk {
    /// Its straight segments: where each starts, and how long it is; infinite if it leaves the scene.
    pub legs: Vec<(Ray, f64)>,
    /// The objects that it met before its end.
    pub crossed_objects: Vec<u32>,
    /// Number of surfaces that deflected it, or let it enter or leave a body: `max_bounces` limits it.
    pub surfaces: u32,
    /// The surface at which it ends, and its object; `None` if it leaves the scene or is lost.
    pub end: Option<(SurfacePoint, u32)>,
    /// Whether that surface scatters widely.
    pub diffuse: bool,
    /// Whether it hit a dispersive surface.
    pub dispersive: bool,
    /// The share of the light that takes this path; 0 for a ray that is lost.
    pub weight: f64,
    /// The share of the fainter branch at the first surface that has one.
    pub fork: f64,
    /// The share of the fainter branch at the first surface that has one and is hit inside a dispersive body.
    pub fork_inside: f64,
    media: Media,
}

impl ColorWalk {
    /// Returns whether it leaves the scene.
    pub fn leaves_scene(&self) -> bool {
        self.length().is_infinite()
    }

    /// Returns the length of its last segment.
    pub fn length(&self) -> f64 {
        self.legs.last().map_or(f64::INFINITY, |leg| leg.1)
    }

    /// Returns the ray of its last segment.
    pub fn last(&self) -> Option<&Ray> {
        self.legs.last().map(|leg| &leg.0)
    }

    /// Decides whether a branch with this share of the light is taken; `is_inside` means inside a dispersive body.
    fn choose_branch(&mut self, share: f64, is_inside: bool, choice: FollowedBranch) -> bool {
        let (weight, fainter) = (self.weight, share.min(1.0 - share));
        let record_fork = |fork: &mut f64| {
            let is_first = *fork == 0.0 && fainter >= MIN_SHARE;
            if is_first {
                *fork = weight * fainter;
            }
            is_first
        };
        let (first, inside) = (record_fork(&mut self.fork), is_inside && record_fork(&mut self.fork_inside));
        let takes_fainter = match choice {
            FollowedBranch::Brighter => false,
            FollowedBranch::FainterFirst => first,
            FollowedBranch::FainterInside => inside,
        };
        self.weight *= if takes_fainter { fainter } else { 1.0 - fainter };
        (share > 0.5) != takes_fainter
    }
}

/// A surface that a walk hits, with four random numbers.
#[derive(Clone, Copy)]
struct WalkSurface<'a> {
    ray: &'a Ray,
    surface_hit: &'a SurfaceHit,
    u: [f64; 4],
    lane: usize,
    choice: FollowedBranch,
}

/// How a walk continues at a surface.
enum Next {
    /// Straight on, as if nothing were there.
    Straight,
    Toward(DVec3),
    End,
    Lost,
}

/// A world of two lanes, one for each color that is compared.
pub struct Colors<'a> {
    pub world: &'a World,
    pub draw: Draw<4>,
}

impl Colors<'_> {
    /// Returns whether a medium has two different indices.
    pub fn is_dispersive(&self, glass: &Dielectric<Table>) -> bool {
        let index: [f64; 4] = self.draw.read_exact(&glass.index);
        index[0] != index[1]
    }

    /// Follows one lane. If light may take two branches, the first lane decides for both. Objects that the camera does
    /// not see do not exist for its ray until the ray is deflected.
    pub fn walk(
        &self,
        lane: usize,
        mut ray: Ray,
        mut is_from_camera: bool,
        media: Media,
        sampler: &Sampler,
        choice: FollowedBranch,
    ) -> ColorWalk {
        let (legs, met) = (Vec::with_capacity(4), Vec::with_capacity(4));
        let mut walk = ColorWalk { legs, crossed_objects: met, weight: 1.0, media, ..ColorWalk::default() };
        let mut key = BranchKey::CAMERA;
        for _ in 0..MAX_SURFACES {
            let hit = match is_from_camera {
                true => self.world.scene.intersect_seen(&ray, None),
                false => self.world.scene.intersect(&ray),
            };
            walk.legs.push((ray, hit.map_or(f64::INFINITY, |hit| hit.intersection.t)));
            let Some(met) = hit else { return walk };
            let surface_hit = SurfaceHit::new(self.world, &ray, met);
            key = key.child(0);
            let surface = WalkSurface {
                ray: &ray,
                surface_hit: &surface_hit,
                u: sampler.get_random_4d(key, SURFACE),
                lane,
                choice,
            };
            match self.next(&mut walk, &surface) {
                Next::Straight => ray = surface_hit.point.leave(ray.direction),
                Next::Toward(direction) => (ray, is_from_camera) = (surface_hit.point.leave(direction), false),
                Next::End => {
                    walk.end = Some((surface_hit.point, met.object));
                    return walk;
                }
                Next::Lost => break,
            }
            walk.crossed_objects.push(met.object);
        }
        walk.weight = 0.0;
        walk
    }

    /// Returns how a walk continues at a surface. Beyond the bounce limit, surfaces show only their own light.
    fn next(&self, walk: &mut ColorWalk, surface: &WalkSurface) -> Next {
        let next = self.continuation(walk, surface);
        if !matches!(next, Next::Toward(_) | Next::End) {
            return next;
        }
        if walk.surfaces < self.world.method.max_bounces {
            walk.surfaces += u32::from(matches!(next, Next::Toward(_)));
            return next;
        }
        let is_light = self.world.scene.objects[surface.surface_hit.hit.object as usize].light.is_some();
        if is_light { Next::End } else { Next::Lost }
    }

    /// Returns how a walk continues at a surface, whatever the bounce limit.
    fn continuation(&self, walk: &mut ColorWalk, surface: &WalkSurface) -> Next {
        let WalkSurface { ray, surface_hit, u, choice, .. } = *surface;
        let (world, draw, wo) = (self.world, &self.draw, -ray.direction);
        let [_, normal] = shading::normals(&surface_hit.point, wo);
        let inside = walk.media.inside(&world.scene);
        if walk.choose_branch(
            pass_through::hole_transmittance(world, draw, ray, inside, surface_hit)[0].into(),
            false,
            choice,
        ) {
            return Next::Straight;
        }
        match world.scene.material_of(surface_hit.hit.object) {
            Material::Dielectric(glass) => self.next_at_glass(walk, surface, glass),
            Material::Mirror(_) => Next::Toward(reflect(wo, normal)),
            Material::Thin(pane) => {
                let here = media::index(&world.scene, draw, inside)[0];
                let one = pane.reflectance_of_one_surface(draw, 0, here, wo.dot(normal));
                // The reflectance of both surfaces, without absorption (Born & Wolf 1999, section 7.6).
                let mirrored = 2.0 * one / (1.0 + one);
                if walk.choose_branch(mirrored, false, choice) {
                    Next::Toward(reflect(wo, normal))
                } else {
                    Next::Straight
                }
            }
            Material::Conductor(metal) => match metal.roughness.surface() {
                None => Next::Toward(reflect(wo, normal)),
                // Both colors use the same facet, as if there were no others.
                Some(surface) => mirrored(surface, wo, normal, [u[2], u[3]]).map_or(Next::Lost, Next::Toward),
            },
            material if material.lobes().has_delta() && walk.choose_branch(ROUGH_REFLECTANCE, false, choice) => {
                Next::Toward(reflect(wo, normal))
            }
            material => {
                walk.diffuse = material.lobes().is_wide();
                Next::End
            }
        }
    }

    /// Returns how a walk continues at the surface of a clear body.
    fn next_at_glass(&self, walk: &mut ColorWalk, surface: &WalkSurface, glass: &Dielectric<Table>) -> Next {
        let WalkSurface { ray, surface_hit: SurfaceHit { hit, point }, u, lane, choice } = *surface;
        let (world, draw, wo) = (self.world, &self.draw, -ray.direction);
        let [_, normal] = shading::normals(point, wo);
        let material = world.scene.objects[hit.object as usize].material;
        let (boundary, _) = walk.media.at_surface(&world.scene, material, point, ray.direction);
        if boundary.here == boundary.beyond {
            walk.media = walk.media.after_crossing(&boundary);
            return Next::Straight;
        }
        let indices = boundary.sides().map(|inside| media::index(&world.scene, draw, inside));
        walk.dispersive |= indices.iter().any(|index| index[0] != index[1]);
        let [n1, n2] = indices.map(|index| index[lane]);
        // Both colors use the same facet.
        let facets = glass.roughness.interface().map(|rough| rough.facets());
        let facet = facets.map_or(normal, |facets| visible_facet(facets, wo, normal, [u[2], u[3]]));
        let interface = Interface::new(n1, n2, wo.dot(facet));
        // The first color's reflectance decides for both, unless it is reflected totally: there the edge has colors.
        let first = Interface::new(indices[0][0], indices[1][0], wo.dot(facet));
        let chance = if first.transmittance == 0.0 { interface.reflectance } else { first.reflectance };
        let inside = indices[0][0] != indices[0][1];
        let is_reflected = n1 != n2 && (walk.choose_branch(chance, inside, choice) || interface.transmittance == 0.0);
        let (direction, side) = if is_reflected {
            (reflect(wo, facet), 1.0)
        } else {
            walk.media = walk.media.after_crossing(&boundary);
            (if n1 == n2 { ray.direction } else { interface.refract(wo, facet) }, -1.0)
        };
        if facets.is_some() && direction.dot(normal) * side <= 0.0 { Next::Lost } else { Next::Toward(direction) }
    }
}

/// Rays of the camera that share their random numbers, and the branch that they follow.
pub struct CameraRays<'a> {
    pub colors: &'a Colors<'a>,
    pub sampler: Sampler,
    pub choice: FollowedBranch,
}

impl CameraRays<'_> {
    /// Follows one lane through a place on the film.
    pub fn walk(&self, point: DVec2, lane: usize) -> ColorWalk {
        let world = self.colors.world;
        let ray = world.scene.camera.ray(point);
        self.colors.walk(lane, ray, true, world.media_at_camera(&ray), &self.sampler, self.choice)
    }
}

/// Samples the normal of a facet that is visible from `wo`.
pub fn visible_facet(facets: &Facets, wo: DVec3, normal: DVec3, u: [f64; 2]) -> DVec3 {
    let frame = Frame::about(normal);
    let local = frame.to_local(wo);
    frame.to_world(facets.visible_normal(DVec3 { z: local.z.max(0.0), ..local }, u))
}

/// Returns the mirror image of `wo` about a visible facet; `None` if it lies below the surface.
fn mirrored(surface: &RoughSurface, wo: DVec3, normal: DVec3, u: [f64; 2]) -> Option<DVec3> {
    let frame = Frame::about(normal);
    let local = frame.to_local(wo);
    let wi = reflect(local, surface.facets().visible_normal(local, u));
    (wi.z > 0.0).then(|| unit(frame.to_world(wi)))
}
