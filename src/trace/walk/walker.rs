//! The one walk from surface to surface, shared by camera paths and photons.

use std::cell::Cell;

use super::audit::Audit;
use super::interaction::{Interaction, SurfaceHit};
use super::path::{ObjectSet, Path, PathKind, ScatterSample};
use super::polarization::{PassThrough, Polarization};
use super::polarized::Polarized;
use super::reusing_stack::Slots;
use super::roulette::{LONG_PATH, play_roulette};
use super::{pass_through, shading};
use crate::material::{Branch, Lobes, Straight};
use crate::math::Sampler;
use crate::shape::SurfacePoint;
use crate::spectrum::Draw;
use crate::trace::first_lobe::FirstLobe;
use crate::trace::media::Boundary;
use crate::trace::stats::Stats;
use crate::trace::{Transport, World};

/// Follows rays, one sample after another, and reuses its buffers.
pub struct Walker<'a, const N: usize, P: Polarization<N> = Polarized> {
    pub world: &'a World,
    pub transport: Transport,
    pub pending: Slots<Path<N, P>>,
    pub branches: Vec<Branch<N>>,
    /// How polarization changes along each of the branches, where it is traced.
    transfers: Slots<P::RowTransfer>,
    /// The object that last occluded a light, which is tested first for the next one.
    pub last_occluder: Cell<Option<u32>>,
    pub stats: Stats,
    /// The audit of where all weight ends, if it is requested.
    pub audit: Option<Audit<'a, N>>,
    /// Number of rays that were followed before this camera sample.
    pub rays_before: u64,
}

/// Use of the random numbers that choose a branch or end a path.
const CHOICE: u32 = 2;

/// How much sooner roulette ends paths that leave a diffuse surface than those that leave a smooth one: what they still
/// gather varies little. Measured on the smallpt scene, where 1 takes 1.17 times as long to the same error.
const DIFFUSE_ROULETTE_FACTOR: f64 = 5.0;

/// How a sample continues that has hit too many surfaces: by all bright branches, and by one of the faint ones.
const FALLBACK_TRANSPORT: Transport = Transport::Random { split: 0.01, roulette: 0.01 };

impl<'a, const N: usize, P: Polarization<N>> Walker<'a, N, P> {
    pub fn new(world: &'a World, transport: Transport) -> Self {
        Self {
            world,
            transport,
            pending: Slots::new(),
            branches: Vec::new(),
            transfers: Slots::new(),
            last_occluder: Cell::new(None),
            stats: Stats::default(),
            audit: None,
            rays_before: 0,
        }
    }

    /// Follows a path along its ray, through the medium around it, to the next surface; `None` if it leaves the scene.
    #[inline(always)]
    pub fn next_hit(&mut self, path: &mut Path<N, P>, draw: &Draw<N>) -> Option<SurfaceHit> {
        self.stats.rays += 1;
        let skips_hidden = self.world.hides_objects && path.kind.is_from_camera() && path.object_set == ObjectSet::All;
        let hit = match path.object_set {
            ObjectSet::All if skips_hidden => self.world.scene.intersect_seen(&path.ray, path.last_primitive),
            ObjectSet::All => self.world.scene.intersect_from(&path.ray, path.last_primitive),
            ObjectSet::Plate => {
                self.world.scene.intersect_plate(&path.ray, path.last_primitive, path.kind.is_from_camera())
            }
        };
        let skips_hidden_media = skips_hidden && self.world.has_media;
        if skips_hidden_media && path.last_primitive.is_some() {
            path.switch_media(self.world, draw, self.world.media_seen_at(path.ray.origin));
        }
        let before = path.throughput;
        path.advance(self.world, draw, hit.map_or(f64::INFINITY, |hit| hit.intersection.t));
        if let Some(audit) = &mut self.audit {
            audit.absorb(path, before, draw);
        }
        let surface_hit = SurfaceHit::new(self.world, &path.ray, hit?);
        if skips_hidden_media {
            let hidden = self.world.media_hidden_at(&path.ray, &surface_hit.point);
            path.switch_media(self.world, draw, path.media.combined_with(&hidden));
        }
        path.last_primitive = Some(surface_hit.hit.primitive());
        Some(surface_hit)
    }

    /// Returns what passes through the surface that a path has hit; `None` if nothing does.
    #[inline(always)]
    pub fn straight(&self, path: &Path<N, P>, draw: &Draw<N>, surface_hit: &SurfaceHit) -> Option<PassThrough<N, P>> {
        let lets_through = self.world.is_see_through(surface_hit.hit.object);
        if lets_through { pass_through::pass_through_of_path(self.world, draw, path, surface_hit) } else { None }
    }

    /// Returns the media at the surface that a path has hit.
    ///
    /// # Errors
    /// [`HiddenHit`] if the surface is that of a body hidden inside another of higher priority.
    #[inline(always)]
    pub fn boundary(&mut self, path: &Path<N, P>, surface_hit: &SurfaceHit) -> Result<Boundary, HiddenHit> {
        let SurfaceHit { hit, point } = surface_hit;
        let number = self.world.scene.objects[hit.object as usize].material;
        let (boundary, fits) = path.media.at_surface(&self.world.scene, number, point, path.ray.direction);
        self.stats.unmatched += u64::from(!fits);
        let is_hidden = boundary.here == boundary.beyond && self.world.scene.material_of(hit.object).medium().is_some();
        if is_hidden { Err(HiddenHit(boundary)) } else { Ok(boundary) }
    }

    /// Adds the pending path that goes on through a hidden surface as if nothing were there.
    #[cold]
    pub fn pass_hidden(&mut self, path: &Path<N, P>, surface_hit: &SurfaceHit, HiddenHit(boundary): &HiddenHit) {
        let kind = path.kind.past_hidden();
        let left_to_photons =
            kind == PathKind::Smooth && self.world.is_photon_target(surface_hit.hit.object, surface_hit.point.position);
        let next = self.pending.add(|| *path);
        // No light was sampled through this surface, so what the path hits beyond counts in full.
        let (key, media) = (path.key.child(0), path.media.after_crossing(boundary));
        *next = Path { scatter: None, key, media, kind, left_to_photons, ..*path };
        next.ray = surface_hit.point.leave(path.ray.direction);
        (next.vertices, next.hidden_vertices) = (path.vertices + 1, path.hidden_vertices + 1);
    }

    /// Adds the pending path that passes through a surface, if any light does.
    pub fn pass_partly(&mut self, path: &Path<N, P>, point: &SurfacePoint, transmitted: Option<&PassThrough<N, P>>) {
        if let Some(transmitted) = transmitted {
            *self.pending.add(|| *path) = Path { key: path.key.child(0), ..path.transmitted_part(point, transmitted) };
        }
    }

    /// Converts the shares of the branches to those of the path's light, which may be polarized.
    #[inline(always)]
    pub fn polarize(&mut self, path: &Path<N, P>, interaction: &Interaction<N>) {
        path.polarization.split(interaction, &mut self.branches, &mut self.transfers);
    }

    /// Polarizes the light of branches that is followed forward, by shading normals that depend on the viewer.
    pub fn polarize_forward(&mut self, path: &Path<N, P>, interaction: &Interaction<N>) {
        self.transfers.clear();
        for branch in &mut self.branches {
            path.polarization.after_forward_scattering(
                &interaction.viewed_from(branch.wi),
                interaction.context.wo,
                &mut branch.share,
            );
        }
    }

    /// Keeps only the branches of smooth surfaces: diffuse surfaces may send on no more light.
    pub fn keep_delta_branches(&mut self, outgoing: &OutgoingPath<N, P>) {
        let wide = self.branches.iter().filter(|branch| branch.pdf.is_some());
        let left_out = |branch: &Branch<N>| outgoing.weight(branch) * f64::from(outgoing.aiming_factor(branch));
        self.stats.stopped += wide.map(left_out).sum::<f64>() / outgoing.siblings();
        self.transfers.retain(|number| self.branches[number].pdf.is_none());
        self.branches.retain(|branch| branch.pdf.is_none());
    }

    /// Reports the branches and what passes through to the audit, if there is one.
    pub fn report_to_audit(&mut self, path: &Path<N, P>, interaction: &Interaction<N>, straight: Option<&Straight<N>>) {
        if let Some(audit) = &mut self.audit {
            audit.split(path, interaction, &self.branches, straight);
        }
    }

    /// Decides which branches, and how much of what passes through, are followed. Their paths become pending.
    pub fn follow(&mut self, outgoing: &mut OutgoingPath<N, P>, sampler: &Sampler) {
        let path = outgoing.path;
        if let Some(transmitted) = &outgoing.transmitted {
            self.branches.push(Branch::through(&path.ray, &transmitted.straight));
        }
        self.stats.partings += u64::from(self.branches.iter().filter(|branch| branch.crosses).count() > 1);
        outgoing.branches = self.branches.len();
        if outgoing.must_pass
            && let Some(straight_branch) = self.branches.pop()
        {
            outgoing.add_pending(self.branches.len(), &straight_branch, None, 1.0, &mut self.pending);
        }
        match self.current_transport() {
            Transport::Deterministic { cutoff, .. } => {
                for (number, branch) in self.branches.iter().enumerate() {
                    match outgoing.weight(branch) {
                        weight if weight < cutoff => self.stats.dropped += weight,
                        _ => outgoing.add_pending(number, branch, self.transfers.get(number), 1.0, &mut self.pending),
                    }
                }
            }
            Transport::Random { roulette, .. } => {
                if self.branches.len() > 1 && !self.follows_all(path, outgoing.interaction.context.draw) {
                    self.follow_one(outgoing, sampler, roulette)
                } else {
                    self.follow_many(outgoing, sampler, roulette)
                }
            }
        }
    }

    /// Returns whether a path with several branches follows all of them, or only one.
    pub fn follows_all(&self, path: &Path<N, P>, draw: &Draw<N>) -> bool {
        match self.current_transport() {
            Transport::Deterministic { .. } => true,
            Transport::Random { split, .. } => path.vertices < LONG_PATH && path.weight(draw) > split,
        }
    }

    fn follow_one(&mut self, outgoing: &OutgoingPath<N, P>, sampler: &Sampler, roulette: f64) {
        let weight = |number: usize| outgoing.weight(&self.branches[number]);
        let u = sampler.get_random_4d(outgoing.path.key, CHOICE);
        let total: f64 = (0..self.branches.len()).map(weight).sum();
        let mut remaining = u[0] * total;
        let mut bright = (0..self.branches.len()).filter(|&number| weight(number) != 0.0);
        let Some(last) = bright.clone().next_back() else { return };
        let chosen = bright.find(|&number| {
            remaining -= weight(number);
            remaining < 0.0
        });
        let number = chosen.unwrap_or(last);
        if let Some(factor) = play_roulette(total, roulette, outgoing.path.vertices, || u[1]) {
            let factor = factor * total / weight(number);
            let (branch, transfer) = (&self.branches[number], self.transfers.get(number));
            outgoing.add_pending(number, branch, transfer, factor, &mut self.pending);
        }
    }

    /// Follows all branches that survive roulette.
    fn follow_many(&mut self, outgoing: &OutgoingPath<N, P>, sampler: &Sampler, roulette: f64) {
        let is_diffuse = outgoing.interaction.lobes.is_diffuse();
        let is_seen = outgoing.is_seen && self.world.has_soft_light;
        for (number, branch) in self.branches.iter().enumerate() {
            let u = || sampler.get_random_4d(outgoing.path.key.child(number), CHOICE)[2];
            let (weight, wide) = (outgoing.weight(branch), branch.pdf.is_some() && is_diffuse);
            let roulette = if wide { roulette * DIFFUSE_ROULETTE_FACTOR } else { roulette };
            // In soft light, dark surfaces make pixels as dark as paths. These must be no noisier than bright ones.
            let roulette_weight =
                if wide && is_seen { outgoing.path.weight(outgoing.interaction.context.draw) } else { weight };
            if weight != 0.0
                && let Some(factor) = play_roulette(roulette_weight, roulette, outgoing.path.vertices, u)
            {
                outgoing.add_pending(number, branch, self.transfers.get(number), factor, &mut self.pending);
            }
        }
    }

    /// Returns how branches are followed at this point of the sample. If light has too many ways, one is chosen, which
    /// keeps the mean.
    fn current_transport(&self) -> Transport {
        match self.transport {
            Transport::Deterministic { max_sample_surfaces: max, .. } if self.surfaces() > max => FALLBACK_TRANSPORT,
            transport => transport,
        }
    }

    pub fn surfaces(&self) -> u64 {
        self.stats.rays - self.rays_before
    }
}

/// The surface of a body hidden inside another of higher priority, and the effect of crossing it.
pub struct HiddenHit(Boundary);

/// A path that leaves a surface.
pub struct OutgoingPath<'a, const N: usize, P = Polarized> {
    pub world: &'a World,
    pub path: &'a Path<N, P>,
    pub interaction: &'a Interaction<'a, N>,
    /// Where lights were sampled, if they were.
    pub scatter: Option<&'a ScatterSample>,
    /// What passes through the surface, as the last branch.
    pub transmitted: Option<&'a PassThrough<N, P>>,
    /// Whether what passes through is always followed, because the camera ray hits something behind the surface.
    pub must_pass: bool,
    /// Whether the camera sees the surface.
    pub is_seen: bool,
    /// Whether all branches count as leaving a diffuse surface, and not only the wide ones.
    pub all_diffuse: bool,
    /// Number of branches, once they are followed.
    pub branches: usize,
}

impl<'a, const N: usize, P: Polarization<N>> OutgoingPath<'a, N, P> {
    pub fn new(world: &'a World, path: &'a Path<N, P>, interaction: &'a Interaction<'a, N>) -> Self {
        let (scatter, transmitted) = (None, None);
        Self {
            world,
            path,
            interaction,
            scatter,
            transmitted,
            must_pass: false,
            is_seen: false,
            all_diffuse: false,
            branches: 0,
        }
    }

    /// Returns how many paths together stand for this one.
    fn siblings(&self) -> f64 {
        self.interaction.context.draw.siblings(self.path.parted)
    }

    /// Returns the weight of the path along a branch.
    #[inline]
    fn weight(&self, branch: &Branch<N>) -> f64 {
        let Self { path, interaction, .. } = self;
        let shares = interaction.context.draw.shares(path.parted || (interaction.is_parting && branch.crosses));
        path.throughput.through(branch.share).weight(shares) / (path.eta_scale * branch.eta_scale)
    }

    /// Returns the factor of the densities of aimed bounces on the throughput: `eta_scale` if a branch does not cross.
    fn aiming_factor(&self, branch: &Branch<N>) -> f32 {
        if branch.crosses { self.path.aiming_factor } else { self.path.aiming_factor * branch.eta_scale as f32 }
    }

    /// Adds the pending path along a branch, which is followed with probability 1 / `factor`. `transfer` is how its
    /// polarization changes, if that is known already.
    ///
    /// Paths are large, so it is built in place.
    #[inline(always)]
    fn add_pending(
        &self,
        number: usize,
        branch: &Branch<N>,
        transfer: Option<&P::RowTransfer>,
        factor: f64,
        pending: &mut Slots<Path<N, P>>,
    ) {
        let Self { world, path, interaction, .. } = self;
        if let Some(transmitted) = self.transmitted.filter(|_| number + 1 == self.branches) {
            let passed_path = path.transmitted_part(interaction.point, transmitted);
            let (throughput, key) = (passed_path.throughput.scaled(factor), path.key.child(number));
            *pending.add(|| passed_path) = Path { throughput, key, ..passed_path };
            return;
        }
        let (wide, crosses) = (branch.pdf.is_some(), branch.crosses);
        let reversible = || shading::is_reversible(interaction.point, interaction.context.wo, branch.wi, crosses);
        let left_to_photons = wide && path.leaves_narrow_to_photons(world, interaction);
        let counts_as_smooth = left_to_photons && interaction.lobes.is_narrow();
        // A photon that leaves by the lobe that is left to photons has hit only smooth surfaces so far.
        let counts_as_wide = wide && interaction.context.lobes != Lobes::NARROW;
        let next = pending.add(|| **path);
        next.ray = interaction.point.leave(branch.wi);
        next.last_primitive = path.last_primitive;
        next.throughput = path.throughput.through(branch.share).scaled(factor);
        (next.eta_scale, next.aiming_factor) = (path.eta_scale * branch.eta_scale, self.aiming_factor(branch));
        next.media = if crosses { path.media.after_crossing(&interaction.boundary) } else { path.media };
        next.parted = path.parted || (interaction.is_parting && crosses);
        next.key = path.key.child(number);
        (next.vertices, next.hidden_vertices) = (path.vertices, path.hidden_vertices);
        next.length = path.length;
        next.kind = match counts_as_smooth {
            true => PathKind::Smooth,
            false => path.kind.after_bounce(world.has_map(), counts_as_wide, reversible),
        };
        next.left_to_photons = match wide {
            true => left_to_photons,
            false => {
                next.kind == PathKind::Smooth && world.is_photon_target(interaction.object, interaction.point.position)
            }
        };
        next.is_narrow = match wide && !counts_as_smooth {
            true => interaction.lobes.intersection(interaction.context.lobes).is_narrow(),
            false => path.is_narrow,
        };
        next.diffuse_left = path.diffuse_left - u32::from((wide || self.all_diffuse) && interaction.lobes.is_diffuse());
        next.scatter = branch.pdf.and_then(|pdf| self.scatter.map(|scatter| scatter.with_pdf(pdf, crosses)));
        next.polarization.follow(&path.polarization, interaction, branch, transfer);
        next.bounces = path.bounces + 1;
        next.is_seen = path.is_seen && !wide && !interaction.lobes.is_wide();
        next.object_set = path.object_set;
        next.resampled = path.resampled;
        next.ignores_light = path.ignores_light;
        next.excitation = path.excitation;
        next.first = match path.bounces {
            0 if !wide && !crosses && world.layers.separates_lobes => Some(FirstLobe::Specular),
            _ => path.first_lobe(world, interaction, branch.wi, crosses),
        };
    }
}
