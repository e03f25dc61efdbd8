//! What a path knows of the polarization of its light.

use std::fmt::Debug;

use super::excitation::Excitation;
use super::interaction::Interaction;
use super::slots::Slots;
use crate::light::Light;
use crate::material::{Branch, Material, ScatterContext, Straight};
use crate::math::{DVec3, Ray};
use crate::spectrum::{Lanes, Table};
use crate::trace::World;
use crate::trace::received_light::ReceivedLight;

/// What of a path's light passes through where it hits a surface.
#[derive(Clone, Copy, Debug)]
pub struct PassThrough<const N: usize, P> {
    pub straight: Straight<N>,
    /// How the path's light is polarized beyond.
    pub polarization: P,
}

pub struct FoundLight<'a, const N: usize, P> {
    pub world: &'a World,
    pub received: &'a ReceivedLight<'a, N>,
    /// The dye that it excites, where the path has seen one.
    pub excitation: Option<&'a Excitation<N, P>>,
    /// What the sensor gets of it.
    pub rgb: [f64; 3],
    /// Whether lanes have parted anywhere on its way.
    pub dispersed: bool,
}

impl<'a, const N: usize, P> FoundLight<'a, N, P> {
    #[inline]
    pub fn new(world: &'a World, received: &'a ReceivedLight<'a, N>, excitation: Option<&'a Excitation<N, P>>) -> Self {
        let rgb = match excitation {
            None => received.rgb(&world.responses),
            Some(excitation) => excitation.seen(world, received, |seen| seen.rgb(&world.responses)),
        };
        let dispersed = received.parted || excitation.is_some_and(|excitation| excitation.parted);
        Self { world, received, excitation, rgb, dispersed }
    }
}

/// How the light of a photon reaches the camera.
pub struct SeenPhoton<const N: usize> {
    /// By what share polarization may change each lane.
    pub change: Lanes<N>,
    /// The factor by which a filter changes it.
    pub factor: Option<Lanes<N>>,
    /// S1, S2 and S3 over S0, if they are asked for.
    pub stokes: Option<[Lanes<N>; 3]>,
}

/// What a path knows of the polarization of its light: [`Polarized`](super::polarized::Polarized), by how much it may
/// matter that polarization is not traced, or [`Rows`](super::rows::Rows), all of it.
///
/// Densities never depend on it, nor do directions: all ways to sample light agree on them.
pub trait Polarization<const N: usize>: Copy + Debug + Send + Sync + 'static {
    /// What is kept of it with a photon that has landed.
    type Stored: Clone + Debug + Send + Sync;
    /// What becomes of it along a branch that may be followed.
    type RowTransfer: Debug;

    /// Of a path that starts at the camera along a ray.
    fn of_camera(world: &World, ray: &Ray) -> Self;

    /// Of a path that starts at a light, which shines unpolarized.
    fn of_light(world: &World, ray: &Ray) -> Self;

    /// After a surface that lets some light pass through; makes that the share that does.
    fn through(self, material: &Material<Table>, context: &ScatterContext<N>, straight: &mut Straight<N>) -> Self;

    /// Before branches are chosen: makes their shares those of the path's light, and puts what becomes of it along each
    /// of them into `ways`. Nothing is put there where that can wait until one is chosen.
    fn split(&self, at: &Interaction<N>, branches: &mut [Branch<N>], ways: &mut Slots<Self::RowTransfer>);

    /// Becomes what it is along a branch when it was `before`; `split` has told of those that are followed back to the
    /// lights, and none has of those that `forward` follows.
    fn become_along(&mut self, before: &Self, at: &Interaction<N>, branch: &Branch<N>, way: Option<&Self::RowTransfer>);

    /// On the way from a surface along the unit vector `wi` to a light or panes; makes `bsdf_cos` that of the path.
    fn toward(&self, at: &Interaction<N>, wi: DVec3, bsdf_cos: &mut Lanes<N>) -> Self;

    /// How much of light along `wi`, `on_its_way` by `toward` and panes, polarization may change, as X + Y + Z.
    fn moved(&self, at: &Interaction<N>, wi: DVec3, on_its_way: &Self, light: &FoundLight<N, Self>) -> f64;

    /// The same of light that the path has hit.
    fn moved_of_met(&self, light: &FoundLight<N, Self>) -> f64;

    /// Of the light that excites a dye, where the path sees one: evenly, whatever its polarization.
    fn exciting(&self) -> Self;

    /// Where the path hits polarized light that comes from the unit vector `wi`; makes `shone`, what the light would
    /// be that is not, what the path takes of it. None where the light is not polarized.
    fn lit_by(&self, light: &Light<Table>, wi: DVec3, shone: &mut Lanes<N>) -> Option<Self>;

    /// Of light that is followed forward: beyond a surface, to which it came from the unit vector `wi`, on its way to
    /// the viewer. Makes `bsdf_cos`, by the surface as it is viewed, that of the path's light.
    fn forward(&self, viewed: &Interaction<N>, wi: DVec3, bsdf_cos: &mut Lanes<N>) -> Self;

    /// What the camera sees of a photon that came to it from there along a ray of its own; `on_its_way` is by `forward`
    /// and panes, `viewed` the surface as the camera sees it.
    fn seen(
        &self,
        at: &Interaction<N>,
        viewed: &ScatterContext<N>,
        on_its_way: &Self,
        world: &World,
        ray: &Ray,
    ) -> SeenPhoton<N>;

    /// What is kept of it where a photon has landed.
    fn landed(&self, at: &Interaction<N>) -> Self::Stored;

    /// Joins a camera path at a surface with a photon that landed near, along `wi`; makes `bsdf_cos` that of both.
    fn join(&self, at: &Interaction<N>, wi: DVec3, photon: &Self::Stored, bsdf_cos: &mut Lanes<N>) -> Self;

    /// By what share polarization may change the light of a photon, along a unit vector, that `join` joined with lanes.
    fn change_of_joined(
        &self,
        at: &Interaction<N>,
        wi: DVec3,
        photon: &Self::Stored,
        joined: &Self,
        lanes: Lanes<N>,
    ) -> f64;

    /// What is kept with a photon, its lanes read as others.
    fn read_stored(photon: &Self::Stored, read: impl Fn(Lanes<N>) -> Lanes<N>) -> Self::Stored;

    /// S1, S2 and S3 of unpolarized light that the path has hit, each as a factor on S0, if they are asked for.
    fn stokes(&self) -> Option<[Lanes<N>; 3]>;
}
