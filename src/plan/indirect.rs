//! Decides how light between surfaces is found.

use std::cell::OnceCell;

use super::format::describe_effort;
use crate::light::Light;
use crate::spectrum::Table;
use crate::trace::{
    BrightPlaces, PhotonWorth, PilotNoise, RoomLight, SkyOpenings, World, light_paths_reach, pilot_noise, room_light,
    with_light_vertices,
};

/// Fewest camera samples of an image with light vertices. With fewer, there would be so few light paths that their
/// noise, which all pixels share, would show in means over the image.
const MIN_SAMPLES: f64 = 1e6;

/// A world with one way to find light between surfaces.
pub(super) struct IndirectMethod<'a> {
    pub(super) world: World,
    /// The explanations for the user.
    pub(super) reasons: Vec<String>,
    /// The photons of each light that show caustics, in addition to that light.
    photons: &'a [PhotonWorth],
    noise: OnceCell<PilotNoise>,
    /// How many times as long bounces alone, as surfaces scatter them, take to the same error.
    gain: f64,
}

/// Chooses how light between surfaces is found: by light vertices, by bounces that are aimed at bright places, or by
/// both, whichever pays most, if any does. Finds what lights the room, unless that is given.
pub(super) fn choose_indirect(world: World, light: Option<RoomLight>, photons: &[PhotonWorth]) -> IndirectMethod<'_> {
    let plain = IndirectMethod { world, reasons: Vec::new(), photons, noise: OnceCell::new(), gain: 1.0 };
    let light = light.unwrap_or_else(|| room_light(&plain.world));
    let openings = light.openings.as_ref().map(BrightPlaces::openings).unwrap_or_default();
    if let RoomLight { openings: Some(places), is_rare: true, .. } = light {
        let aimed = plain.aimed_at_openings(places);
        return aimed.with_light_vertices(&openings).unwrap_or(aimed);
    }
    let aimed = plain.aimed(light);
    let vertex_method = plain.with_light_vertices(&openings);
    let both = match (&vertex_method, &aimed) {
        (Some(vertex_method), _) => vertex_method.aimed(room_light(&vertex_method.world)),
        (None, Some(aimed)) => aimed.with_light_vertices(&openings),
        (None, None) => None,
    };
    let others = [vertex_method, both, aimed].into_iter().flatten();
    others.fold(plain, |best, other| if other.gain > best.gain { other } else { best })
}

impl IndirectMethod<'_> {
    /// Returns the number of photons per camera sample that takes the least time to an error.
    pub(super) fn photons_per_sample(&self) -> f64 {
        self.noise().photons_per_sample(self.photons)
    }

    fn noise(&self) -> &PilotNoise {
        self.noise.get_or_init(|| pilot_noise(&self.world))
    }

    /// Returns a method with another world, if that is clearly better.
    fn try_world(&self, world: World, reason: impl FnOnce(&World, &str) -> String) -> Option<Self> {
        let noise = pilot_noise(&world);
        let gain = noise.gain_over(self.noise(), self.photons)?;
        let slowdown = describe_effort(gain);
        let reasons = self.reasons.iter().cloned().chain([reason(&world, &slowdown)]).collect();
        gain.is_clear().then(|| Self {
            world,
            reasons,
            photons: self.photons,
            noise: noise.into(),
            gain: self.gain * gain.judged(),
        })
    }

    /// Adds light vertices, with paths of skies through some openings. Light paths do not support dyes.
    fn with_light_vertices(&self, openings: &SkyOpenings) -> Option<Self> {
        if self.world.samples_of_the_format() < MIN_SAMPLES
            || self.world.method().diffuse_bounces == 0
            || self.world.fluoresces()
        {
            return None;
        }
        let with_vertices = with_light_vertices(&self.world, openings).filter(light_paths_reach)?;
        self.try_world(with_vertices, |world, slowdown| {
            let light = describe_light(world);
            format!("{light} is found at light vertices; without them, {slowdown}")
        })
    }

    /// Aims bounces at bright places or at openings, whichever pays most, if any do.
    fn aimed(&self, RoomLight { places, openings, .. }: RoomLight) -> Option<Self> {
        let aim_at = |places: BrightPlaces| {
            let description = describe_places(&places);
            self.try_world(self.world.with_bright(Some(places)), |_, slowdown| {
                format!("{description}; otherwise, {slowdown}")
            })
        };
        let [places, openings] = [places.and_then(aim_at), openings.and_then(aim_at)];
        let gain_of = |way: &Option<Self>| way.as_ref().map_or(0.0, |way| way.gain);
        if gain_of(&openings) > gain_of(&places) { openings } else { places }
    }

    /// Aims bounces at openings so small that a pilot without aim would find too little light to compare with.
    fn aimed_at_openings(self, openings: BrightPlaces) -> Self {
        let reason = format!("{}; otherwise, hardly any would find light", describe_places(&openings));
        let world = self.world.with_bright(Some(openings));
        Self { world, reasons: vec![reason], noise: OnceCell::new(), ..self }
    }
}

/// Describes what bounces are aimed at.
fn describe_places(places: &BrightPlaces) -> String {
    let count = places.places.len();
    let description = match (places.are_openings, count) {
        (false, 1) => "1 bright place that lights it".into(),
        (false, _) => format!("{count} bright places that light it"),
        (true, 1) => "1 opening that lets light in".into(),
        (true, _) => format!("{count} openings that let light in"),
    };
    format!("bounces in the room are aimed at {description}")
}

/// Describes which light is found at light vertices.
fn describe_light(world: &World) -> String {
    let lights = &world.scene().lights;
    if !lights.iter().any(Light::is_infinite) {
        return "light between surfaces".into();
    }
    let any_sunlit = |is_kind: &dyn Fn(&Light<Table>) -> bool| {
        world.method().sunlit.iter().any(|sunlit| is_kind(&lights[sunlit.light]))
    };
    let is_sky = |light: &Light<Table>| light.sends_photons_through_openings();
    let has_openings = !world.method().openings.openings.is_empty() && lights.iter().any(is_sky);
    let kinds = [
        ("suns", any_sunlit(&|light| matches!(light, Light::Sun(_)))),
        ("the bright parts of the image of the sky", any_sunlit(&|light| matches!(light, Light::Environment(_)))),
        ("the sky through openings", has_openings),
        ("lamps", lights.iter().any(|light| !light.is_infinite())),
    ];
    let kinds: Vec<&str> = kinds.into_iter().filter(|kind| kind.1).map(|kind| kind.0).collect();
    match kinds[..] {
        ["suns"] => "sunlight between surfaces".into(),
        _ => format!("light between surfaces that comes from {}", kinds.join(" or ")),
    }
}
