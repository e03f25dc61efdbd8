//! Where lights are really seen that may be hidden for the most part.

use super::World;
use super::render::sample;
use super::tracer::Tracer;
use super::width::{InLanes, in_lanes};
use crate::light::LightId;
use crate::math::{DVec3, Sampler};

/// Camera samples along each side of the image.
const SIDE: u32 = 64;
/// Lights met that tell enough.
const ENOUGH: usize = 2048;
/// Sets these random numbers apart from those of the image.
const SEED: u64 = 0x6c61_6d70;

/// The lights that paths meet by chance, with the unit normals there. The whole image counts, also where only a part of
/// it is made, so that all parts are made alike.
pub(super) fn normals_met(world: &World) -> Vec<(LightId, DVec3)> {
    in_lanes(&world.method.basis, Looking { world })
}

struct Looking<'a> {
    world: &'a World,
}

impl InLanes for Looking<'_> {
    type Output = Vec<(LightId, DVec3)>;
    fn run<const N: usize>(self) -> Self::Output {
        let (world, film) = (self.world, self.world.scene.film);
        let mut tracer = Tracer::<N>::new(world);
        tracer.met = Some(Vec::new());
        // A stride that is coprime to the number of places visits them all, far ones first.
        let places = SIDE * SIDE;
        for place in (0..places).map(|i| (i * 1597) % places) {
            let [x, y] = film.whole().middle_of_cell(SIDE, place);
            sample(world, &mut tracer, &Sampler::new(world.method.seed ^ SEED, [x, y], place), x, y);
            if tracer.met.as_ref().is_some_and(|met| met.len() >= ENOUGH) {
                break;
            }
        }
        tracer.met.unwrap_or_default()
    }
}
