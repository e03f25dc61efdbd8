//! Decides how the light of a scene is found.

use super::caustics::{self, CausticChoice, SeenPhotons};
use super::indirect::{IndirectMethod, choose_indirect};
use super::photon_map;
use crate::light::Light;
use crate::scene::Scene;
use crate::spectrum::Curve;
use crate::trace::{LightPass, Method, RoomLight, Smoothness, World, pilot_noise, room_light};

/// A world with everything that finds its light.
pub(super) struct LitWorld {
    pub(super) world: World,
    pub(super) because: Vec<String>,
    /// A world in which photons have learned where to go.
    pub(super) guided: Option<World>,
}

impl LitWorld {
    pub(super) fn new(scene: &Scene<Curve>, unlit: &World) -> Self {
        // Skies may send photons through openings of a room.
        let may_use_openings = scene.lights.iter().any(Light::sends_photons_through_openings)
            && !caustics::targets(scene, &Smoothness::ALL).is_empty();
        let light = may_use_openings.then(|| room_light(unlit));
        let openings = light.as_ref().and_then(|light| light.openings.clone());
        let aimed = openings.map(|openings| unlit.with_bright(Some(openings)));
        let pilot_world = aimed.as_ref().unwrap_or(unlit);
        let photons = match SeenPhotons::new(scene, pilot_world) {
            Ok(photons) => photons,
            Err(no_photons) => return Self::with_caustics(scene, unlit, pilot_world, light, no_photons),
        };
        let choice = photons.choose(&pilot_noise(&photons.guided));
        let is_chosen = choice.caustics.is_some();
        let lit_world = Self::with_caustics(scene, unlit, pilot_world, light, choice);
        if is_chosen {
            return Self { guided: Some(photons.guided), ..lit_world };
        }
        let Method { light_vertices: true, light_pass: None, .. } = lit_world.world.method() else { return lit_world };
        // Light vertices remove noise next to which photons did not pay.
        let combined = lit_world.world.with_light_pass(photons.guided.method().light_pass.clone());
        let choice = photons.choose(&pilot_noise(&combined));
        if choice.caustics.is_none() {
            return lit_world;
        }
        let combined = Self::with_caustics(scene, unlit, pilot_world, None, choice);
        if !combined.world.method().light_vertices {
            return lit_world;
        }
        Self { guided: Some(photons.guided), ..combined }
    }

    /// Adds the caustics that were chosen. `light` is what lights the room, if that is known.
    fn with_caustics(
        scene: &Scene<Curve>,
        unlit: &World,
        pilot_world: &World,
        light: Option<RoomLight>,
        CausticChoice { caustics, reasons: caustic_reasons, no_map }: CausticChoice,
    ) -> Self {
        let shown_pass = caustics.as_ref().map(|caustics| caustics.pass(unlit, 0.0));
        let (light_pass, why_gathered) = photon_map::with_map(scene, pilot_world, shown_pass.as_ref(), no_map);
        // Why nothing is shown matters only where nothing is gathered either.
        let caustic_reasons = if shown_pass.is_some() || light_pass.is_none() { caustic_reasons } else { Vec::new() };
        let map = light_pass.as_ref().and_then(|pass| pass.map);
        let photons = caustics.as_ref().map_or(&[][..], |caustics| &caustics.photons);
        // Without photons, what was found to light the room still holds.
        let valid_light = light.filter(|_| light_pass.is_none());
        let indirect = choose_indirect(unlit.with_light_pass(light_pass), valid_light, photons);
        // Choose the best number of photons for the noise that all else leaves.
        let pass = caustics.as_ref().map(|caustics| caustics.pass(unlit, indirect.photons_per_sample()));
        let IndirectMethod { mut world, reasons, .. } = indirect;
        if let Some(pass) = pass {
            world = world.with_light_pass(Some(LightPass { map, ..pass }));
        }
        let reason = caustics.as_ref().and_then(|caustics| caustics.reason(&world));
        let left_to_chance = caustics::describe_unbounded(scene, &world);
        let because = reason
            .into_iter()
            .chain(left_to_chance)
            .chain(caustic_reasons)
            .chain(why_gathered)
            .chain(reasons)
            .collect();
        Self { world, because, guided: None }
    }
}
