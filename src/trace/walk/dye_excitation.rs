//! Where a path hits dyes: besides what the surface scatters, it may follow what excites each dye.

use super::excitation::Excitation;
use super::interaction::Interaction;
use super::path::Path;
use super::polarization::Polarization;
use crate::math::Sampler;
use crate::spectrum::{Lanes, Throughput};
use crate::trace::World;
use crate::trace::dyes::Dyes;
use crate::trace::received_light::ReceivedLight;

/// First branch number of the random numbers of dyes, beyond the branches that a path may take.
pub const DYE_BRANCH: usize = 160;
/// Use of the random numbers that choose a dye, and what the lanes stand for.
const CHOICE: u32 = 1;

/// A path at a surface with dyes.
pub struct DyeExcitation<'a, const N: usize, P> {
    pub world: &'a World,
    pub dyes: &'a Dyes,
    pub path: &'a Path<N, P>,
    pub interaction: &'a Interaction<'a, N>,
    /// Whether the path continues in all ways, or in one of them.
    pub follows_all: bool,
    /// The dye that the path's light excites, if the path has seen one.
    pub excitation: Option<&'a Excitation<N, P>>,
}

/// The ways in which the path continues.
pub struct ExcitedPaths<const N: usize, P> {
    pub paths: Vec<(Path<N, P>, Excitation<N, P>)>,
    /// The factor on what the surface scatters: 0 if one of the dyes is chosen.
    pub scatter_factor: f64,
}

impl<const N: usize, P: Polarization<N>> DyeExcitation<'_, N, P> {
    /// Chooses the ways that are followed.
    pub fn sample_paths(&self, sampler: &Sampler) -> ExcitedPaths<N, P> {
        let Self { world, dyes, path, interaction, follows_all, .. } = *self;
        let [mut u, wavelength, ..] = sampler.get_random_4d(path.key.child(DYE_BRANCH), CHOICE);
        let weight = path.throughput.weight(interaction.context.draw.shares(path.parted));
        let (mut paths, mut shares) = (Vec::new(), Vec::new());
        interaction.material.shares_of_dyes(&interaction.context, Lanes::ONE, &mut shares);
        let surface_dyes = dyes.of_object(&world.scene, interaction.object);
        let chances = dyes.chances(surface_dyes.clone());
        for (number, (dye, share)) in surface_dyes.zip(shares).enumerate() {
            let chance = chances.chance(dye);
            let is_chosen = (0.0..chance).contains(&u);
            u -= chance;
            if weight == 0.0 || !(follows_all || is_chosen) {
                continue;
            }
            let lanes = path.throughput.of(share * (1.0 / (weight * chance)) as f32);
            let excitation = self.excitation(dye, lanes, wavelength);
            // A dye that was chosen stands for all.
            let weight = if follows_all { weight * chance } else { weight };
            let excited_path = Path {
                throughput: Throughput::starting(excitation.draw.start()).scaled(weight),
                parted: false,
                polarization: path.polarization.for_excitation(),
                key: path.key.child(DYE_BRANCH + 1 + number),
                ..*path
            };
            paths.push((excited_path, excitation));
        }
        let scatter_factor = match follows_all {
            true => 1.0,
            false if u < 0.0 => 0.0,
            false => 1.0 / (1.0 - chances.total()),
        };
        ExcitedPaths { paths, scatter_factor }
    }

    /// Returns what the sensor receives from a dye that these lanes see. `wavelength` chooses what the lanes behind it
    /// stand for.
    fn excitation(&self, dye: usize, lanes: Lanes<N>, wavelength: f64) -> Excitation<N, P> {
        let Self { world, dyes, path, interaction, .. } = *self;
        let (seen_by, draw) = (interaction.context.draw, world.method.basis.draw(wavelength));
        let (source, parted) = (dyes.source(dye), path.parted);
        match self.excitation {
            None => {
                let (seen_by, polarization) = (seen_by.clone(), path.polarization);
                Excitation { source, lanes, sensor_draw: seen_by, parted, polarization, dye, draw }
            }
            Some(excitation) => {
                let brightness =
                    dyes.brightness(excitation.dye, &ReceivedLight { source, draw: seen_by, lanes: &lanes, parted });
                Excitation { lanes: excitation.lanes * brightness as f32, dye, draw, ..excitation.clone() }
            }
        }
    }
}
