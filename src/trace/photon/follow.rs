//! Photons: light traced forward over surfaces, to where it lands.

use std::f64::consts::PI;

use crate::light::{LeSample, LightId};
use crate::material::{Branch, Lobes, Scatter, ScatterContext};
use crate::math::{DVec3, Frame, Ray, Sampler, sample_cosine_hemisphere, unit};
use crate::shape::SurfacePoint;
use crate::spectrum::{Draw, Lanes};
use crate::trace::World;
use crate::trace::walk::{
    Interaction, OutgoingPath, PassThrough, Path, PathKind, Polarization, Polarized, Walker, shading,
};

/// The branch of what passes through holes, beyond those that a material may have.
const PASS_THROUGH_BRANCH: usize = 64;
/// The branch of what narrow lobes scatter separately.
const NARROW_BRANCH: usize = 65;
/// Probability that the material draws the direction of a photon, and not the cosine, where the shading normal is not
/// the surface's own. Diffuse materials never do.
const MATERIAL_PROBABILITY: f64 = 0.5;
/// Uses of the random numbers: where a photon leaves a surface, and whether it passes through one.
const SCATTER: u32 = 4;
const PASS_THROUGH: u32 = 9;

/// A photon, or a path from a light: how it starts, and where it goes.
pub struct Photon<'a, const N: usize> {
    /// How it leaves the light, with its flux per emission.
    pub emitted: &'a LeSample,
    pub light: LightId,
    /// What its lanes stand for.
    pub draw: &'a Draw<N>,
    pub sampler: &'a Sampler,
    pub scope: Surfaces,
    /// Whether it is of the first half of those sent with it.
    pub first_half: bool,
}

impl<const N: usize> Photon<'_, N> {
    /// Whether photons of the light pass contribute the light that starts along its way.
    pub fn is_for_light_pass(&self, world: &World) -> bool {
        world.is_found_by_photons(self.light, &self.toward_light())
    }

    /// Whether light paths for light vertices contribute the light that starts along its way.
    fn is_found_by_light_paths(&self, world: &World) -> bool {
        world.is_found_by_light_paths(self.light, &self.toward_light())
    }

    /// Returns the ray back along its way.
    fn toward_light(&self) -> Ray {
        let Ray { origin, direction } = self.emitted.ray;
        Ray { origin, direction: -direction }
    }
}

/// The point where a photon lands, and its path there.
pub struct PhotonHit<'a, const N: usize, P = Polarized> {
    pub path: &'a Path<N, P>,
    pub interaction: &'a Interaction<'a, N>,
    pub photon: &'a Photon<'a, N>,
}

impl<const N: usize, P> PhotonHit<'_, N, P> {
    /// Returns what the light emits along the photon's way.
    pub fn emission(&self, world: &World) -> Lanes<N> {
        let Photon { emitted, light, .. } = *self.photon;
        world.scene.lights[light].toward(self.interaction.context.draw, -emitted.ray.direction, emitted.uv())
    }

    /// Returns the flux of the photon, lane by lane.
    pub fn flux(&self, world: &World) -> Lanes<N> {
        self.path.throughput.scaled(self.photon.emitted.factor / self.path.eta_scale).of(self.emission(world))
    }
}

/// The surfaces from which a photon continues.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surfaces {
    /// Smooth ones, and those with narrow lobes only. The first must be one that photons are sent to, and may have
    /// other lobes too: paths over others are left to the camera's rays.
    Smooth,
    /// All surfaces.
    All,
}

/// Traces a photon over surfaces, and calls `land` where it lands on those that scatter widely.
///
/// Throughput is computed as if the light were the viewer; flux lacks the factor of radiance between media.
pub fn follow_photon<const N: usize, P: Polarization<N>>(
    walker: &mut Walker<N, P>,
    photon: &Photon<N>,
    land: &mut dyn FnMut(&Walker<N, P>, &PhotonHit<N, P>),
) {
    let mut path = Path::from_light(walker.world, photon.draw, photon.emitted.ray, photon.light);
    path.resampled = photon.is_found_by_light_paths(walker.world);
    *walker.pending.add(|| path) = path;
    while let Some(mut path) = walker.pending.take() {
        advance(walker, &mut path, photon, land);
        walker.pending.release(path);
    }
}

/// Traces a photon to the next surface.
#[inline(always)]
fn advance<const N: usize, P: Polarization<N>>(
    walker: &mut Walker<N, P>,
    path: &mut Path<N, P>,
    photon: &Photon<N>,
    land: &mut dyn FnMut(&Walker<N, P>, &PhotonHit<N, P>),
) {
    let &Photon { draw, sampler, scope, .. } = photon;
    let world = walker.world;
    if path.vertices >= walker.transport.max_surfaces() {
        return;
    }
    let Some(surface_hit) = walker.next_hit(path, draw) else { return };
    if let Some(transmitted) = walker.straight(path, draw, &surface_hit)
        && pass_through(walker, path, photon, &surface_hit.point, &transmitted)
    {
        return;
    }
    let is_first = path.vertices == 0;
    let is_smooth = is_first || path.kind == PathKind::Other;
    let is_target = is_smooth && world.is_photon_target(surface_hit.hit.object, surface_hit.point.position);
    // Whether gathered photons contribute what smooth lobes scatter.
    let is_left_to_map = is_target && scope != Surfaces::Smooth && world.has_map() && photon.is_for_light_pass(world);
    match scope {
        Surfaces::Smooth if is_first && !is_target => return,
        Surfaces::All if is_first && !is_target => path.kind = PathKind::Wide,
        _ => {}
    }
    let boundary = match walker.boundary(path, &surface_hit) {
        Ok(boundary) => boundary,
        Err(hidden) => return walker.pass_hidden(path, &surface_hit, &hidden),
    };
    path.vertices += 1;
    if world.ends_light_paths(surface_hit.hit.object) {
        if scope == Surfaces::All {
            return;
        }
        path.resampled = false;
    }
    let interaction = Interaction::new(world, draw, &path.incident_ray(), &surface_hit, boundary);
    let lobes = interaction.lobes;
    if scope != Surfaces::Smooth && path.surfaces() == 1 && (path.hidden_vertices > 0 || !lobes.is_diffuse()) {
        // A path from the camera has to leave the next diffuse surface to reach this one, or to reach a light that a
        // hidden surface keeps from being sampled. It leaves none to sample a light.
        path.diffuse_left = path.diffuse_left.saturating_sub(1);
    }
    // The limits of bounces are those of paths from the camera.
    let is_allowed = path.surfaces() <= world.method.max_bounces && !(lobes.is_diffuse() && path.diffuse_left == 0);
    let may_land = scope != Surfaces::Smooth || path.vertices > 1;
    if lobes.is_wide() && is_allowed && may_land && !(path.is_narrow && lobes.is_narrow()) {
        land(walker, &PhotonHit { path, interaction: &interaction, photon });
    }
    let continues = path.surfaces() < world.method.max_bounces;
    let is_narrow = lobes.is_narrow() || (is_first && lobes.has_narrow_apart());
    let separates_narrow = is_target && is_narrow && (scope == Surfaces::Smooth || is_left_to_map);
    if separates_narrow && continues {
        let path = Path { key: path.key.child(NARROW_BRANCH), ..*path };
        scatter(walker, &path, &interaction.with_lobes(Lobes::NARROW), sampler);
    }
    if scope == Surfaces::Smooth || !lobes.is_wide() {
        scatter_smooth(walker, path, interaction, sampler);
    } else if is_allowed && continues {
        let narrow = if separates_narrow { Lobes::NARROW } else { Lobes::NONE };
        scatter(walker, path, &interaction.with_lobes(Lobes::ALL.without(narrow)), sampler);
    }
}

/// Lets a photon pass through a surface. Returns false if the photon hits the surface as well. A photon that carries
/// little does only one of both: otherwise, each of a stack of panes would double the photons that it reflects.
#[cold]
fn pass_through<const N: usize, P: Polarization<N>>(
    walker: &mut Walker<N, P>,
    path: &mut Path<N, P>,
    Photon { draw, sampler, .. }: &Photon<N>,
    point: &SurfacePoint,
    transmitted: &PassThrough<N, P>,
) -> bool {
    let (throughput, key) =
        (path.throughput.through(transmitted.straight.share()), path.key.child(PASS_THROUGH_BRANCH));
    let passed_path = Path { throughput, key, polarization: transmitted.polarization, ..path.beyond_surface(point) };
    let all = throughput == path.throughput;
    if all || walker.follows_all(path, draw) {
        *walker.pending.add(|| *path) = passed_path;
        return all;
    }
    let shares = draw.shares(path.parted);
    let share = throughput.weight(shares) / path.throughput.weight(shares);
    if sampler.get_random_4d(path.key, PASS_THROUGH)[0] < share {
        *walker.pending.add(|| *path) = Path { throughput: throughput.scaled(1.0 / share), ..passed_path };
        return true;
    }
    path.throughput = path.throughput.scaled(1.0 / (1.0 - share));
    false
}

/// Lets a photon continue from a surface that scatters widely, by the given lobes. Its shares are those that the camera
/// would see along the reverse path.
fn scatter<const N: usize, P: Polarization<N>>(
    walker: &mut Walker<N, P>,
    path: &Path<N, P>,
    interaction: &Interaction<N>,
    sampler: &Sampler,
) {
    let Interaction { material, point, context, flat, .. } = interaction;
    let u = sampler.get_4d(path.key, SCATTER);
    walker.branches.clear();
    if point.shading == point.normal {
        material.scatter(context, [u[0], u[1]], &mut walker.branches);
        walker.polarize(path, interaction);
        let is_reciprocal = material.is_reciprocal();
        let needs_reversal = |branch: &Branch<N>| !is_reciprocal && branch.pdf.is_some();
        walker
            .branches
            .iter_mut()
            .filter(|branch| needs_reversal(branch))
            .for_each(|branch| reverse_share(interaction, branch));
        convert_to_flux(context, walker.branches.iter_mut().filter(|branch| !needs_reversal(branch)));
    } else {
        // With shading normals that depend on the viewer, light may arrive from directions that the material never
        // draws. The material therefore draws only a part of the directions.
        let material_probability = if interaction.lobes.is_diffuse() { 0.0 } else { MATERIAL_PROBABILITY };
        if u[2] < material_probability {
            shading::scatter(material, context, *flat, [u[0], u[1]], &mut walker.branches);
        } else {
            let wi = unit(Frame::about(*flat).to_world(sample_cosine_hemisphere([u[0], u[1]])));
            walker.branches.push(Branch::drawn(wi, Lanes::ZERO, 0.0));
        }
        walker.branches.retain_mut(|branch| {
            let (is_wide, cos) = (branch.pdf.is_some() && !branch.crosses, branch.wi.dot(*flat));
            let Some(seen) = bsdf_cos_seen_from(interaction, branch.wi).filter(|_| is_wide && cos > 0.0) else {
                return false;
            };
            let material_pdf = || shading::evaluate(material, context, *flat, branch.wi).map_or(0.0, |(_, pdf)| pdf);
            let material_pdf = if material_probability > 0.0 { material_pdf() } else { 0.0 };
            let pdf = material_probability * material_pdf + (1.0 - material_probability) * cos / PI;
            branch.share = seen * (cos / (context.wo.dot(*flat) * pdf)) as f32;
            branch.pdf = Some(pdf);
            true
        });
        walker.polarize_forward(path, interaction);
    }
    // From the camera, a path has to leave the next surface to reach the first one, by whatever lobe.
    let all_diffuse = path.surfaces() == 1 && path.hidden_vertices == 0;
    walker.follow(&mut OutgoingPath { all_diffuse, ..OutgoingPath::new(walker.world, path, interaction) }, sampler);
}

/// Returns the BSDF, times the cosine of arrival, of a photon that the camera sees from its outgoing direction.
fn bsdf_cos_seen_from<const N: usize>(interaction: &Interaction<N>, direction: DVec3) -> Option<Lanes<N>> {
    let viewed = interaction.viewed_from(direction);
    shading::evaluate(interaction.material, &viewed.context, viewed.flat, interaction.context.wo)
        .map(|(bsdf_cos, _)| bsdf_cos)
}

/// Replaces the share of a branch by that of the reverse direction: materials need not be reciprocal.
fn reverse_share<const N: usize>(interaction: &Interaction<N>, branch: &mut Branch<N>) {
    let forward = shading::evaluate(interaction.material, &interaction.context, interaction.flat, branch.wi);
    let (Some((forward, _)), Some(back)) = (forward, bsdf_cos_seen_from(interaction, branch.wi)) else {
        branch.share = Lanes::ZERO;
        return;
    };
    // Radiance changes between media, and flux does not.
    let cosines =
        (branch.wi.dot(interaction.flat) / interaction.context.wo.dot(interaction.flat)).abs() * branch.eta_scale;
    let ratio = |i: usize| if forward[i] == 0.0 { 0.0 } else { back[i] * cosines as f32 / forward[i] };
    branch.share = branch.share * Lanes::from_fn(ratio);
}

/// Lets a photon continue over a smooth surface.
fn scatter_smooth<const N: usize, P: Polarization<N>>(
    walker: &mut Walker<N, P>,
    path: &Path<N, P>,
    interaction: Interaction<N>,
    sampler: &Sampler,
) {
    let unbent = shading::unbent_normal(interaction.point, interaction.context.wo);
    let interaction = interaction.with_normal(unbent);
    let Interaction { material, point, context, .. } = &interaction;
    let continues = interaction.lobes.has_delta() && context.wo.dot(context.normal) > 0.0;
    if !continues || path.surfaces() >= walker.world.method.max_bounces {
        return;
    }
    walker.branches.clear();
    let u = sampler.get_random_4d(path.key, SCATTER);
    material.scatter(context, [u[0], u[1]], &mut walker.branches);
    let back = context.wo;
    walker
        .branches
        .retain(|branch| branch.pdf.is_none() && shading::is_reversible(point, branch.wi, back, branch.crosses));
    walker.polarize(path, &interaction);
    for branch in &mut walker.branches {
        branch.share = branch.share * shading::forward_factor(point, branch.wi, back) as f32;
    }
    convert_to_flux(context, walker.branches.iter_mut());
    walker.follow(&mut OutgoingPath::new(walker.world, path, &interaction), sampler);
}

/// Turns shares of radiance that cross a smooth surface into shares of flux.
fn convert_to_flux<'a, const N: usize>(context: &ScatterContext<N>, branches: impl Iterator<Item = &'a mut Branch<N>>) {
    if let Some(forward) = context.forward() {
        branches.filter(|branch| branch.crosses).for_each(|branch| branch.share = branch.share * forward);
    }
}
