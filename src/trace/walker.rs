//! The one walk from surface to surface: under the camera's paths and under photons.

use std::cell::Cell;

use super::audit::Audit;
use super::first_lobe::FirstLobe;
use super::interaction::{Interaction, Meeting};
use super::media::Boundary;
use super::path::{Among, Path, PathKind, ScatterSample};
use super::polarization::{Onward, Polarization};
use super::polarized::Polarized;
use super::roulette::{LONG, survival};
use super::stats::Stats;
use super::{Transport, World, shading, straight};
use crate::material::{Branch, Straight};
use crate::math::Sampler;
use crate::spectrum::Draw;

/// Follows rays, one sample after another; its buffers live as long as it does.
pub(super) struct Walker<'a, const N: usize, P = Polarized> {
    pub(super) world: &'a World,
    pub(super) transport: Transport,
    pub(super) pending: Vec<Path<N, P>>,
    pub(super) branches: Vec<Branch<N>>,
    /// How light is polarized along each of them, where it is traced.
    polarizations: Vec<P>,
    /// The object that occluded the last light that was: the first to ask about the next one.
    pub(super) last_occluder: Cell<Option<u32>>,
    pub(super) stats: Stats,
    /// Where all weight ends, if somebody asks.
    pub(super) audit: Option<Audit<'a, N>>,
    /// Rays that were followed before this camera sample.
    pub(super) started: u64,
}

/// Use of the random numbers that choose a branch or end one.
const CHOICE: u32 = 2;

/// How much sooner roulette ends paths that leave a diffuse surface than those that leave a smooth one: what they still
/// gather varies little. Measured on the smallpt scene, where 1 takes 1.17 times as long to an equal error.
const SOONER: f64 = 5.0;

/// How a sample goes on that has met too many surfaces: what is left is mostly faint, and all branches are still
/// followed that are not.
const BY_CHANCE: Transport = Transport::Random { split: 0.01, roulette: 0.01 };

impl<'a, const N: usize, P: Polarization<N>> Walker<'a, N, P> {
    pub(super) fn new(world: &'a World, transport: Transport) -> Self {
        Self {
            world,
            transport,
            pending: Vec::new(),
            branches: Vec::new(),
            polarizations: Vec::new(),
            last_occluder: Cell::new(None),
            stats: Stats::default(),
            audit: None,
            started: 0,
        }
    }

    /// Follows a path along its ray, through the medium around it, to the next surface; none if it leaves the scene.
    #[inline(always)]
    pub(super) fn meet(&mut self, path: &mut Path<N, P>, draw: &Draw<N>) -> Option<Meeting> {
        self.stats.rays += 1;
        let hit = match path.kind {
            PathKind::Camera if self.world.hides_objects && path.among == Among::All => {
                self.world.scene.intersect_seen(&path.ray, path.left)
            }
            _ if path.among == Among::Plate => self.world.scene.intersect_plate(&path.ray, path.left),
            _ => self.world.scene.intersect_from(&path.ray, path.left),
        };
        let before = path.throughput;
        path.advance(self.world, draw, hit.map_or(f64::INFINITY, |hit| hit.crossing.t));
        if let Some(audit) = &mut self.audit {
            audit.absorb(path, before, draw);
        }
        let hit = hit?;
        path.left = Some(hit.primitive());
        let point = self.world.scene.objects[hit.object as usize].point(&path.ray, &hit.crossing);
        Some(Meeting { hit, point })
    }

    /// What goes straight on through the surface that a path has met; none if nothing does.
    #[inline(always)]
    pub(super) fn straight(&self, path: &Path<N, P>, draw: &Draw<N>, meeting: &Meeting) -> Option<Onward<N, P>> {
        straight::straight_on(self.world, draw, path, &meeting.hit, &meeting.point)
    }

    /// The media at the surface that a path has met; none where the path goes on as if nothing were there, through the
    /// surface of a body that is hidden inside another of higher priority.
    #[inline(always)]
    pub(super) fn boundary(&mut self, path: &Path<N, P>, meeting: &Meeting) -> Option<Boundary> {
        let Meeting { hit, point } = meeting;
        let number = self.world.scene.objects[hit.object as usize].material;
        let enters = point.normal.dot(path.ray.direction) < 0.0;
        let (boundary, fits) = path.media.at_surface(&self.world.scene, number, enters);
        self.stats.unmatched += u64::from(!fits);
        if boundary.here == boundary.beyond && self.world.scene.material_of(hit.object).medium().is_some() {
            // No light was sampled through this surface, so what the path meets beyond counts in full.
            let (ray, key) = (point.leave(path.ray.direction), path.key.child(0));
            let kind = path.kind.then(self.world.has_map(), false, || Some(self.world.is_photon_target(hit.object)));
            self.pending.push(Path { ray, media: boundary.crossed, key, scatter: None, kind, ..*path });
            return None;
        }
        Some(boundary)
    }

    /// Makes the shares of the branches those of the path's light, which may be polarized.
    #[inline(always)]
    pub(super) fn polarize(&mut self, path: &Path<N, P>, at: &Interaction<N>) {
        path.polarization.split(at, &mut self.branches, &mut self.polarizations);
    }

    /// Leaves the branches alone that smooth surfaces have.
    pub(super) fn keep_single(&mut self) {
        let mut branches = self.branches.iter();
        self.polarizations.retain(|_| branches.next().is_some_and(|branch| branch.pdf.is_none()));
        self.branches.retain(|branch| branch.pdf.is_none());
    }

    /// Accounts for the branches and what goes straight on, if somebody asks.
    pub(super) fn account(&mut self, path: &Path<N, P>, at: &Interaction<N>, straight: Option<&Straight<N>>) {
        if let Some(audit) = &mut self.audit {
            audit.split(path, at, &self.branches, straight);
        }
    }

    /// Decides which of the branches are followed, and of what goes straight on: their paths become pending.
    pub(super) fn follow(&mut self, departure: &mut Departure<N, P>, sampler: &Sampler) {
        let path = departure.path;
        if let Some(onward) = &departure.onward {
            self.branches.push(Branch::onward(&path.ray, &onward.straight));
        }
        self.stats.partings += u64::from(self.branches.iter().filter(|branch| branch.crosses).count() > 1);
        departure.branches = self.branches.len();
        match self.rule() {
            Transport::Deterministic { cutoff, .. } => {
                for (number, branch) in self.branches.iter().enumerate() {
                    match departure.weight(branch) {
                        weight if weight < cutoff => self.stats.dropped += weight,
                        _ => {
                            self.pending.push(departure.path_along(number, branch, self.polarizations.get(number), 1.0))
                        }
                    }
                }
            }
            Transport::Random { roulette, .. } => {
                if self.branches.len() > 1 && !self.follows_all(path, departure.at.arrival.draw) {
                    self.choose(departure, sampler, roulette)
                } else {
                    self.follow_many(departure, sampler, roulette)
                }
            }
        }
    }

    /// Whether a path of several ways on follows all of them, or one.
    pub(super) fn follows_all(&self, path: &Path<N, P>, draw: &Draw<N>) -> bool {
        match self.rule() {
            Transport::Deterministic { .. } => true,
            Transport::Random { split, .. } => path.vertices < LONG && path.weight(draw) > split,
        }
    }

    /// Follows one branch, chosen by weight.
    fn choose(&mut self, departure: &Departure<N, P>, sampler: &Sampler, roulette: f64) {
        let weight = |number: usize| departure.weight(&self.branches[number]);
        let u = sampler.four_plain(departure.path.key, CHOICE);
        let total: f64 = (0..self.branches.len()).map(weight).sum();
        let mut left = u[0] * total;
        let mut bright = (0..self.branches.len()).filter(|&number| weight(number) != 0.0);
        let Some(last) = bright.clone().next_back() else { return };
        let chosen = bright.find(|&number| {
            left -= weight(number);
            left < 0.0
        });
        let number = chosen.unwrap_or(last);
        if let Some(factor) = survival(total, roulette, departure.path.vertices, || u[1]) {
            let factor = factor * total / weight(number);
            let (branch, known) = (&self.branches[number], self.polarizations.get(number));
            self.pending.push(departure.path_along(number, branch, known, factor));
        }
    }

    /// Follows all branches that roulette leaves.
    fn follow_many(&mut self, departure: &Departure<N, P>, sampler: &Sampler, roulette: f64) {
        let sooner = if departure.at.lobes.is_diffuse() { SOONER } else { 1.0 };
        for (number, branch) in self.branches.iter().enumerate() {
            let u = || sampler.four_plain(departure.path.key.child(number), CHOICE)[2];
            let weight = departure.weight(branch);
            let roulette = if branch.pdf.is_some() { roulette * sooner } else { roulette };
            if weight != 0.0
                && let Some(factor) = survival(weight, roulette, departure.path.vertices, u)
            {
                self.pending.push(departure.path_along(number, branch, self.polarizations.get(number), factor));
            }
        }
    }

    /// Which branches are followed by now. Where light has more ways than can be followed, one is chosen, which leaves
    /// the mean what it is.
    fn rule(&self) -> Transport {
        match self.transport {
            Transport::Deterministic { most, .. } if self.surfaces() > most => BY_CHANCE,
            asked => asked,
        }
    }

    /// Surfaces met by this camera sample or photon.
    pub(super) fn surfaces(&self) -> u64 {
        self.stats.rays - self.started
    }
}

/// A path that leaves a surface.
pub(super) struct Departure<'a, const N: usize, P = Polarized> {
    world: &'a World,
    path: &'a Path<N, P>,
    at: &'a Interaction<'a, N>,
    /// From where lights were sampled, if they were.
    scatter: Option<&'a ScatterSample>,
    /// What goes straight on: the last branch.
    onward: Option<&'a Onward<N, P>>,
    branches: usize,
}

impl<'a, const N: usize, P: Polarization<N>> Departure<'a, N, P> {
    pub(super) fn new(world: &'a World, path: &'a Path<N, P>, at: &'a Interaction<'a, N>) -> Self {
        Self { world, path, at, scatter: None, onward: None, branches: 0 }
    }

    /// With lights sampled here, and what goes straight on.
    pub(super) fn with(self, scatter: Option<&'a ScatterSample>, onward: Option<&'a Onward<N, P>>) -> Self {
        Self { scatter, onward, ..self }
    }

    /// Whether a branch is what goes straight on.
    fn is_onward(&self, number: usize) -> bool {
        self.onward.is_some() && number + 1 == self.branches
    }

    /// The weight of the path along a branch.
    #[inline]
    fn weight(&self, branch: &Branch<N>) -> f64 {
        let Self { path, at, .. } = self;
        let shares = at.arrival.draw.shares(path.parted || (at.parts && branch.crosses));
        path.throughput.through(branch.share).weight(shares) / (path.eta_scale * branch.eta_scale)
    }

    /// The path along a branch, followed with probability 1 / `factor`. `known` is how its light is polarized, where
    /// that is known already.
    #[inline(always)]
    fn path_along(&self, number: usize, branch: &Branch<N>, known: Option<&P>, factor: f64) -> Path<N, P> {
        let Self { world, path, at, .. } = self;
        if let Some(onward) = self.onward.filter(|_| self.is_onward(number)) {
            let beyond = path.passed_in_part(at.point, onward);
            return Path { throughput: beyond.throughput.scaled(factor), key: path.key.child(number), ..beyond };
        }
        let (wide, crosses) = (branch.pdf.is_some(), branch.crosses);
        let aimed = || {
            let followed = shading::is_plain(at.point, at.arrival.wo, branch.wi, crosses);
            followed.then(|| world.is_photon_target(at.object))
        };
        Path {
            ray: at.point.leave(branch.wi),
            left: path.left,
            throughput: path.throughput.through(branch.share).scaled(factor),
            eta_scale: path.eta_scale * branch.eta_scale,
            media: if crosses { at.boundary.crossed } else { path.media },
            parted: path.parted || (at.parts && crosses),
            key: path.key.child(number),
            vertices: path.vertices,
            length: path.length,
            kind: path.kind.then(world.has_map(), wide, aimed),
            diffuse_left: path.diffuse_left - u32::from(wide && at.lobes.is_diffuse()),
            scatter: branch.pdf.and_then(|pdf| self.scatter.map(|scatter| scatter.toward(pdf, crosses))),
            polarization: path.polarization.along(at, branch, known),
            bounces: path.bounces + 1,
            is_seen: path.is_seen && !wide && !at.lobes.is_wide(),
            among: path.among,
            excitation: path.excitation,
            first: match path.bounces {
                0 if !wide && !crosses && world.layers.tell_lobes_apart() => Some(FirstLobe::Specular),
                _ => at.first_lobe(world, path.lobe(), branch.wi, crosses),
            },
        }
    }
}
