//! What a path carries about the polarization of its light.

use std::fmt::Debug;

use super::excitation::Excitation;
use super::interaction::Interaction;
use super::reusing_stack::Slots;
use crate::light::Light;
use crate::material::{Branch, Material, ScatterContext, Straight};
use crate::math::{DVec3, Ray};
use crate::spectrum::{Lanes, Table};
use crate::trace::World;
use crate::trace::received_light::ReceivedLight;

/// The part of a path's light that passes through a surface that it hits.
#[derive(Clone, Copy, Debug)]
pub struct PassThrough<const N: usize, P> {
    pub straight: Straight<N>,
    /// The polarization of the path's light beyond.
    pub polarization: P,
}

pub struct FoundLight<'a, const N: usize, P> {
    pub world: &'a World,
    pub received: &'a ReceivedLight<'a, N>,
    /// The dye that it excites, if the path has seen one.
    pub excitation: Option<&'a Excitation<N, P>>,
    /// The color that the sensor receives.
    pub rgb: [f64; 3],
    /// Whether lanes have parted anywhere on its way.
    pub dispersed: bool,
}

impl<'a, const N: usize, P> FoundLight<'a, N, P> {
    #[inline]
    pub fn new(world: &'a World, received: &'a ReceivedLight<'a, N>, excitation: Option<&'a Excitation<N, P>>) -> Self {
        let rgb = match excitation {
            None => received.rgb(&world.responses),
            Some(excitation) => excitation.with_received(world, received, |seen| seen.rgb(&world.responses)),
        };
        let dispersed = received.parted || excitation.is_some_and(|excitation| excitation.parted);
        Self { world, received, excitation, rgb, dispersed }
    }
}

/// How the light of a photon reaches the camera.
pub struct SeenPhoton<const N: usize> {
    /// The share by which polarization may change each lane.
    pub change: Lanes<N>,
    /// The factor by which a filter changes it.
    pub factor: Option<Lanes<N>>,
    /// S1, S2 and S3 relative to S0, if they are requested.
    pub stokes: Option<[Lanes<N>; 3]>,
}

/// The polarization state that a path carries. [`Polarized`](super::polarized::Polarized) bounds how much it may matter
/// that polarization is not traced. [`Rows`](super::rows::Rows) traces it.
///
/// Neither densities nor directions depend on it, so all techniques that sample light agree on them.
pub trait Polarization<const N: usize>: Copy + Debug + Send + Sync + 'static {
    /// What is stored of it with a photon that has landed.
    type Stored: Clone + Debug + Send + Sync;
    /// How it changes along a branch that may be followed.
    type RowTransfer: Debug;

    /// Returns the state of a path that starts at the camera along a ray.
    fn at_camera(world: &World, ray: &Ray) -> Self;

    /// Returns the state of a path that starts at a light, which emits unpolarized light.
    fn at_light(world: &World, ray: &Ray) -> Self;

    /// Returns the state after a surface that lets light pass through, and sets `straight` to the share that passes.
    fn pass(self, material: &Material<Table>, context: &ScatterContext<N>, straight: &mut Straight<N>) -> Self;

    /// Converts the shares of branches to those of the path's light, before branches are chosen, and adds to
    /// `transfers` how the state changes along each of them. Adds nothing if that can wait until one is chosen.
    fn split(&self, interaction: &Interaction<N>, branches: &mut [Branch<N>], transfers: &mut Slots<Self::RowTransfer>);

    /// Becomes the state along a branch, given the state `before`. `split` has computed `transfer` for branches that
    /// are followed back to the lights. It is `None` for those that `after_forward_scattering` follows.
    fn follow(
        &mut self,
        before: &Self,
        interaction: &Interaction<N>,
        branch: &Branch<N>,
        transfer: Option<&Self::RowTransfer>,
    );

    /// Returns the state on the way from a surface along the unit vector `wi` to a light or panes. Converts `bsdf_cos`
    /// to that of the path.
    fn toward_light(&self, interaction: &Interaction<N>, wi: DVec3, bsdf_cos: &mut Lanes<N>) -> Self;

    /// Returns how much polarization may change light along `wi`, as X + Y + Z. `on_its_way` is by `toward_light` and
    /// panes.
    fn change_along(
        &self,
        interaction: &Interaction<N>,
        wi: DVec3,
        on_its_way: &Self,
        light: &FoundLight<N, Self>,
    ) -> f64;

    /// Returns how much polarization may change light that the path has hit, as X + Y + Z.
    fn change_of_hit(&self, light: &FoundLight<N, Self>) -> f64;

    /// Returns the state of light that excites a dye where the path sees one: the dye absorbs all polarizations alike.
    fn for_excitation(&self) -> Self;

    /// Returns the state where the path hits polarized light from the unit vector `wi`, or `None` if the light is
    /// unpolarized. Converts `emission` from what an unpolarized light would emit to what the path receives.
    fn at_polarized_light(&self, light: &Light<Table>, wi: DVec3, emission: &mut Lanes<N>) -> Option<Self>;

    /// Returns the state of light that is followed forward, beyond a surface that it reached from the unit vector `wi`,
    /// on its way to the viewer. Converts `bsdf_cos`, of the surface as it is viewed, to that of the path's light.
    fn after_forward_scattering(&self, viewed: &Interaction<N>, wi: DVec3, bsdf_cos: &mut Lanes<N>) -> Self;

    /// Returns what the camera sees of a photon along a camera ray. `on_its_way` is the state by
    /// `after_forward_scattering` and panes, and `viewed` is the surface as the camera sees it.
    fn see(
        &self,
        interaction: &Interaction<N>,
        viewed: &ScatterContext<N>,
        on_its_way: &Self,
        world: &World,
        ray: &Ray,
    ) -> SeenPhoton<N>;

    /// Returns what is stored of it where a photon has landed.
    fn to_stored(&self, interaction: &Interaction<N>) -> Self::Stored;

    /// Joins a camera path at a surface with a photon that landed near, along `wi`. Makes `bsdf_cos` that of both.
    fn join(&self, interaction: &Interaction<N>, wi: DVec3, photon: &Self::Stored, bsdf_cos: &mut Lanes<N>) -> Self;

    /// Returns the share by which polarization may change a photon's light, along a unit vector, that `join` joined.
    fn change_of_joined(
        &self,
        interaction: &Interaction<N>,
        wi: DVec3,
        photon: &Self::Stored,
        joined: &Self,
        lanes: Lanes<N>,
    ) -> f64;

    /// Converts what is stored with a photon to other lanes.
    fn convert_stored(photon: &Self::Stored, read: impl Fn(Lanes<N>) -> Lanes<N>) -> Self::Stored;

    /// Returns S1, S2 and S3 of unpolarized light that the path has hit, as factors on S0, if they are requested.
    fn stokes(&self) -> Option<[Lanes<N>; 3]>;
}
