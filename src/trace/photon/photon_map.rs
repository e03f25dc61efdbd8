//! Caustics that the camera does not see directly. Photons are stored where they land, and paths from the camera gather
//! them around the places that they reach over other surfaces.
//!
//! Each photon draws its own wavelengths, as each camera sample does. One whose lanes have not parted is stored with
//! its fixed lanes. If they have parted, each wavelength is stored separately, with the color of its light.

use super::batch::{batches_of_pass, trace_batch};
use super::follow::{Photon, PhotonHit};
use super::kd_tree::KdTree;
use super::kernel::Kernel;
use crate::light::LightId;
use crate::math::DVec3;
use crate::spectrum::{Lanes, Matching, Wavelength};
use crate::trace::World;
use crate::trace::parallel::in_parallel;
use crate::trace::pass::Pass;
use crate::trace::stats::Stats;
use crate::trace::walk::{Interaction, Polarization, Polarized, Walker};

/// A photon as the map stores it: where it landed, and what it carries.
#[derive(Clone, Debug)]
pub struct StoredPhoton<T, L = Polarized> {
    /// Unit vector back along its path.
    pub wi: DVec3,
    /// The surface's own unit normal there, on the side it came from.
    pub flat: DVec3,
    /// Whether that is the front.
    pub is_front: bool,
    /// Whether light crosses the surface.
    pub crosses: bool,
    /// Number of surfaces it hit, the last one included.
    pub surfaces: u32,
    /// Whether light vertices account for what surfaces scatter of its light.
    pub is_resampled: bool,
    /// How its light is polarized.
    pub polarization: L,
    pub payload: T,
}

#[derive(Clone, Debug)]
pub struct JointLanes<const N: usize> {
    /// Flux, lane by lane, divided by the cosine of its arrival.
    pub flux: Lanes<N>,
    pub light: LightId,
}

/// One wavelength of lanes that have parted.
#[derive(Clone, Debug)]
pub struct SingleLane {
    pub wavelength: Wavelength,
    pub light: LightId,
    /// Its flux, divided by the cosine of its arrival.
    pub weight: f64,
    /// The film's color of `weight`.
    pub color: [f64; 3],
}

pub struct PhotonMap<const N: usize, P: Polarization<N> = Polarized> {
    pub together: KdTree<StoredPhoton<JointLanes<N>, P::Stored>>,
    pub alone: KdTree<StoredPhoton<SingleLane, P::Stored>>,
    /// Whether any photon landed on a surface that light crosses.
    pub crosses: bool,
    pub kernel: Kernel<N>,
    /// A kernel that blurs half as much, if the blur is to be measured.
    pub half_blur: Option<Kernel<N>>,
    pub sent: u64,
    pub stats: Stats,
}

/// Sets these random numbers apart from the others.
const SEED: u64 = 0x6d61_7073;

/// What is stored of a photon where it lands.
pub enum PhotonRecord<const N: usize, L = Polarized> {
    JointLanes(StoredPhoton<JointLanes<N>, L>),
    SingleLane(StoredPhoton<SingleLane, L>),
}

pub fn photons<const N: usize, P: Polarization<N>>(world: &World, pass: &Pass) -> Option<PhotonMap<N, P>> {
    let (targets, kernel) = (world.map_targets.as_ref()?, Kernel::of_pass(world, pass)?);
    let targets = &*pass.targets(world, targets, world.method.map()?.count);
    let (seed, before) = pass.photon_seed();
    let batches = batches_of_pass(targets, before, seed ^ SEED);
    let done = in_parallel(batches.len(), &|number| {
        trace_batch(world, targets, batches[number], false, &store_photon::<N, P>)
    });
    let mut stats = Stats::default();
    let (mut together, mut alone) = (Vec::new(), Vec::new());
    for sent in done {
        stats += sent.stats;
        for (place, kept) in sent.records {
            match kept {
                PhotonRecord::JointLanes(photon) if photon.payload.flux.0.iter().all(|x| x.is_finite()) => {
                    together.push((place, photon));
                }
                PhotonRecord::SingleLane(photon) if photon.payload.weight.is_finite() => alone.push((place, photon)),
                _ => stats.non_finite += 1,
            }
        }
    }
    let sent = batches.iter().map(|batch| batch.count).sum();
    let crosses = together.iter().any(|(_, photon)| photon.crosses) || alone.iter().any(|(_, photon)| photon.crosses);
    let (together, alone) = (KdTree::new(together), KdTree::new(alone));
    let half_blur = pass.replicate.map(|_| kernel.half_blur(world));
    Some(PhotonMap { together, alone, crosses, kernel, half_blur, sent, stats })
}

/// Stores a photon where it lands.
pub fn store_photon<const N: usize, P: Polarization<N>>(
    Walker { world, .. }: &Walker<N, P>,
    photon_hit: &PhotonHit<N, P>,
    kept: &mut Vec<(DVec3, PhotonRecord<N, P::Stored>)>,
) {
    let PhotonHit { path, interaction, photon: Photon { light, .. } } = *photon_hit;
    let Interaction { context, flat, point, .. } = interaction;
    let flux = photon_hit.flux(world) * (1.0 / context.wo.dot(*flat).abs()) as f32;
    let photon = StoredPhoton {
        wi: context.wo,
        flat: *flat,
        is_front: flat.dot(point.normal) > 0.0,
        crosses: interaction.lobes.is_transmissive(),
        surfaces: path.surfaces(),
        is_resampled: path.resampled,
        polarization: path.polarization.to_stored(interaction),
        payload: (),
    };
    let (light, response) = (*light, &world.responses[*light]);
    let is_split = Matching::<N>::alone(context.draw, flux, path.parted, |lane, wavelength, weight| {
        let of_lane = |lanes: Lanes<N>| Lanes([lanes[lane]; N]);
        let polarization = P::convert_stored(&photon.polarization, of_lane);
        let color = wavelength.worth(response).map(|x| weight * x);
        let payload = SingleLane { wavelength, light, weight, color };
        kept.push((point.position, PhotonRecord::SingleLane(photon.with(polarization, payload))));
    });
    if !is_split {
        let polarization = photon.polarization.clone();
        kept.push((point.position, PhotonRecord::JointLanes(photon.with(polarization, JointLanes { flux, light }))));
    }
}

impl<L> StoredPhoton<(), L> {
    fn with<T>(&self, polarization: L, payload: T) -> StoredPhoton<T, L> {
        let Self { wi, flat, is_front, crosses, surfaces, is_resampled, .. } = *self;
        StoredPhoton { wi, flat, is_front, crosses, surfaces, is_resampled, polarization, payload }
    }
}

impl<const N: usize, P: Polarization<N>> PhotonMap<N, P> {
    /// Returns the number of photons within a radius of a place.
    pub fn count_near(&self, place: DVec3, radius: f64) -> u64 {
        let mut count = 0;
        self.together.visit_near(place, radius, &mut |_, _| count += 1);
        self.alone.visit_near(place, radius, &mut |_, _| count += 1);
        count
    }
}
