//! Decides whether caustics need a light pass of their own.

use std::f64::consts::TAU;

use super::format::{describe_effort, format_count};
use super::photon_gain::{OfferedPhotons, PhotonGain, rounded};
use crate::light::{Light, LightId, Opening};
use crate::material::Material;
use crate::math::{DVec2, DVec3, median};
use crate::scene::{AutoText, Scene};
use crate::spectrum::Curve;
use crate::trace::{
    Effort, LightPass, Method, PhotonWorth, PilotNoise, Smoothness, Transport, World, piloted, seen_photons,
};

/// Solid angle in steradians of a lamp that rays hit so often that photons cost the same (`benches/rooms.rs`).
const MAX_SOLID_ANGLE: f64 = 0.5;
/// Fewest photons of a light pass: with fewer, it does not learn where to send them.
const MIN_PHOTONS: f64 = 65_536.0;
/// Fewest and most photons per camera sample: a number outside of this range is badly measured.
const MIN_PHOTONS_PER_SAMPLE: f64 = 1.0 / 16.0;
const MAX_PHOTONS_PER_SAMPLE: f64 = 4.0;
/// A gain within this of 1 tells nothing about what is seen through glass: photons contribute nothing besides the rest.
const NEGLIGIBLE_GAIN: f64 = 0.01;
/// Pairs of a light and a place whose solid angles are computed.
const MAX_PAIRS: usize = 1 << 19;
/// Camera rays along each side of the image that look for surfaces on which caustics may lie.
const RAYS_PER_SIDE: u32 = 24;

/// Whether photons show caustics to the camera.
pub(super) struct CausticChoice {
    pub(super) caustics: Option<Box<Caustics>>,
    pub(super) reasons: Vec<String>,
    /// Whether photons are not gathered either, since they do not pay where the camera would see them.
    pub(super) no_map: bool,
}

impl CausticChoice {
    fn none(reasons: Vec<String>, no_map: bool) -> Self {
        Self { caustics: None, reasons, no_map }
    }
}

/// Caustics that photons show.
pub(super) struct Caustics {
    /// The photons of each light that sends them.
    pub(super) photons: Vec<PhotonWorth>,
    /// The openings through which a sky sends them.
    openings: Vec<Opening>,
    /// How smooth the objects are that they are sent to.
    smoothness: Vec<Smoothness>,
    /// Descriptions of the lights that send them, and of what they are sent to.
    from: String,
    to: String,
    /// The share of the photons that is seen.
    seen_share: f64,
    /// How many times as long chance takes to the same error, if it finds them.
    gain: Option<Effort>,
}

impl Caustics {
    /// Returns the light pass with `per_sample` photons for each camera sample.
    pub(super) fn pass(&self, world: &World, per_sample: f64) -> LightPass {
        let mut lights: Vec<LightId> = self.photons.iter().flat_map(|photons| photons.lights.clone()).collect();
        lights.sort_unstable();
        lights.dedup();
        let per_sample = rounded(per_sample.clamp(MIN_PHOTONS_PER_SAMPLE, MAX_PHOTONS_PER_SAMPLE));
        LightPass {
            photons: (per_sample * world.samples_of_the_format()).max(MIN_PHOTONS).ceil() as u64,
            lights,
            openings: self.openings.clone(),
            to: self.smoothness.clone(),
            map: None,
        }
    }

    /// Returns the explanation for the user.
    pub(super) fn reason(&self, world: &World) -> Option<String> {
        let Self { from, to, seen_share: seen, gain, .. } = self;
        let (method, photons) = (world.method(), world.method().light_pass.as_ref()?.photons);
        let all = if method.stop.is_none() { format!("{} ", format_count(photons)) } else { String::new() };
        let slowdown = gain.map_or(String::new(), |gain| format!("; without them, {}", describe_effort(gain)));
        Some(format!(
            "photon tracing: {all}photons from {from} toward {to}, {:.2} for each camera sample; {} of them are \
             seen{slowdown}",
            photons as f64 / world.samples_of_the_format(),
            if *seen < 0.095 { format!("{:.1} %", 100.0 * seen) } else { format!("{:.0} %", 100.0 * seen) },
        ))
    }
}

/// Photons that the camera sees, before it is known whether they are worth their time.
pub(super) struct SeenPhotons<'a> {
    scene: &'a Scene<Curve>,
    /// A world that sends them, and in which they have learned where to go.
    pub(super) guided: World,
    offered: OfferedPhotons,
    /// The lights whose photons are seen.
    seen_lights: Vec<SizedLight>,
    /// For each light of the scene, the share of its photons that is seen.
    seen_shares: Vec<f64>,
    /// Lights that rays hit by chance.
    large_lights: Vec<SizedLight>,
    openings: Vec<Opening>,
    /// Description of what they are sent to.
    to: String,
    /// Explanation of which lights' photons are not seen.
    unseen: Option<String>,
}

impl<'a> SeenPhotons<'a> {
    /// Returns the photons of a scene that the camera sees, or why there are none.
    pub(super) fn new(scene: &'a Scene<Curve>, unguided: &World) -> Result<Self, CausticChoice> {
        let Sources { small, large, openings } = sources(scene, unguided)
            .map_err(|why| CausticChoice::none(why.into_iter().collect(), !visible_receivers(scene).is_empty()))?;
        let photon_count = unguided.samples_of_the_format().max(MIN_PHOTONS).ceil() as u64;
        let lights = small.iter().map(|light| light.0).collect();
        let all = Smoothness::ALL.to_vec();
        let pass = LightPass { photons: photon_count, lights, openings: openings.clone(), to: all, map: None };
        let guided = piloted(unguided, pass);
        if let Some(why) = nowhere_to_aim(scene, &guided) {
            return Err(CausticChoice::none(vec![why], true));
        }
        let share = seen_photons(&guided);
        let sizes = small.clone();
        let size = |light: LightId| sizes.iter().find(|(id, _)| *id == light).map_or(0.0, |&(_, size)| size);
        let (seen, unseen): (Vec<_>, Vec<_>) = small.into_iter().partition(|&(id, _)| share[id] > 0.0);
        let to = describe_targets(scene, &Smoothness::ALL);
        let unseen = (!unseen.is_empty()).then(|| {
            let from = named(scene, &unseen);
            format!("no caustic from {from} in sight: of thousands of photons toward {to}, none was seen")
        });
        if seen.is_empty() {
            return Err(CausticChoice::none(unseen.into_iter().collect(), false));
        }
        let offered = OfferedPhotons::new(scene, &guided, size);
        Ok(Self {
            scene,
            guided,
            offered,
            seen_lights: seen,
            seen_shares: share,
            large_lights: large,
            openings,
            to,
            unseen,
        })
    }

    /// Chooses the photons that are worth their time, given the noise of camera samples, and tells why.
    pub(super) fn choose(&self, noise: &PilotNoise) -> CausticChoice {
        let Self { scene, to, .. } = self;
        let PhotonGain { mut photons, gain, to_smooth } = self.offered.weigh(noise);
        photons.retain(|photons| self.seen_lights.iter().any(|(id, _)| photons.lights.contains(id)));
        let sends_photons = |&(id, _): &SizedLight| photons.iter().any(|photons| photons.lights.contains(&id));
        let (sending, left): (Vec<_>, Vec<_>) = self.seen_lights.iter().partition(|&light| sends_photons(light));
        let large: Vec<_> = self.large_lights.iter().copied().chain(left).collect();
        let mut lines: Vec<String> = self.unseen.iter().cloned().collect();
        if sending.is_empty() {
            let (from, why) = (named(scene, &large), why_not_worth(gain));
            lines.push(format!("no photon tracing: photons from {from} toward {to} are seen, but {why}"));
            return CausticChoice::none(lines, gain.is_none_or(|gain| to_smooth && !gain.is_equal(NEGLIGIBLE_GAIN)));
        }
        if !large.is_empty() {
            lines.push(format!("left to chance: caustics from {}", named(scene, &large)));
        }
        let seen_share = sending.iter().map(|&(id, _)| self.seen_shares[id]).fold(0.0, f64::max);
        let smoothness: Vec<_> =
            Smoothness::ALL.into_iter().filter(|smooth| photons.iter().any(|photons| photons.to == *smooth)).collect();
        let left = Smoothness::ALL.into_iter().filter(|left| !smoothness.contains(left));
        lines.extend(left.filter_map(|left| {
            let name = &scene.objects[*targets(scene, &[left]).first()?].name;
            let (how, points) = match left {
                Smoothness::Whole => ("smooth", point_light_note(scene)),
                Smoothness::Partial => ("smooth only in part", point_light_note(scene)),
                Smoothness::Narrow | Smoothness::NarrowPartial => ("nearly smooth", ""),
            };
            Some(format!("left to chance: caustics of {name}, which is {how}{points}"))
        }));
        let (from, to, openings) =
            (named(scene, &sending), describe_targets(scene, &smoothness), self.openings.clone());
        let caustics = Box::new(Caustics { photons, openings, smoothness, from, to, seen_share, gain });
        CausticChoice { caustics: Some(caustics), reasons: lines, no_map: false }
    }
}

/// Describes what photons are sent to.
fn describe_targets(scene: &Scene<Curve>, smooth: &[Smoothness]) -> String {
    match targets(scene, smooth).as_slice() {
        [one] => scene.objects[*one].name.clone(),
        many => format!("{} smooth objects", many.len()),
    }
}

/// Explains why the photons of a world are sent nowhere, if that is so.
fn nowhere_to_aim(scene: &Scene<Curve>, world: &World) -> Option<String> {
    let has_bounds = |&object: &usize| scene.objects[object].shape.is_bounded();
    let targets = targets(scene, &Smoothness::ALL);
    let name = &scene.objects[*targets.first()?].name;
    (!world.reaches_without_end() && !targets.iter().any(has_bounds)).then(|| {
        let why = format!("{name} is unbounded and not seen, so photons cannot be aimed at it");
        format!("no photon tracing: {why}{}", point_light_note(scene))
    })
}

/// Describes the caustics of unbounded surfaces that the photons of a world leave to chance.
pub(super) fn describe_unbounded(scene: &Scene<Curve>, world: &World) -> Option<String> {
    let pass = world.method().light_pass.as_ref()?;
    let unbounded = targets(scene, &pass.to).into_iter().find(|&object| !scene.objects[object].shape.is_bounded())?;
    let where_left = if world.reaches_without_end() { ", far beyond where it is seen" } else { " and is not seen" };
    let name = &scene.objects[unbounded].name;
    Some(format!("left to chance: caustics of {name}, which is unbounded{where_left}{}", point_light_note(scene)))
}

/// Explains why photons that are seen are not sent: how long an equal error would take with them, or nothing is lit.
fn why_not_worth(gain: Option<Effort>) -> String {
    let Some(gain) = gain else { return "the surfaces they land on are black".into() };
    let is_small = gain.judged() > 1.0 && gain.of_whole.is_none_or(|of_whole| of_whole > 1.0);
    let small = if is_small { ", which is too small a gain to be sure of" } else { "" };
    format!("with them, {}{small}", describe_effort(gain.inverse()))
}

/// A light and the solid angle under which at least half of some places see it.
pub(super) type SizedLight = (LightId, f64);

/// Lights whose caustics chance would hardly find, and the other lights.
pub(super) struct Sources {
    pub(super) small: Vec<SizedLight>,
    large: Vec<SizedLight>,
    /// The openings through which skies among them shine.
    pub(super) openings: Vec<Opening>,
}

impl Sources {
    /// Returns the sampled lights of a world; small ones can send photons and are seen under less than `max_size`.
    pub(super) fn new(world: &World, places: &[DVec3], max_size: f64) -> Self {
        let lights = &world.scene().lights;
        // Use only some of the places, so that all pairs with lights can be computed.
        let step = places.len() * lights.len() / MAX_PAIRS + 1;
        let places: Vec<DVec3> = places.iter().copied().step_by(step).collect();
        let openings = world.openings();
        let are_small = openings_solid_angle(&openings, &places).is_some_and(|size| size < max_size);
        let openings = if are_small { openings } else { Vec::new() };
        let mut sources = Self { small: Vec::new(), large: Vec::new(), openings };
        for (id, light) in lights.iter().enumerate().filter(|(_, light)| light.is_sampled()) {
            match solid_angle(light, &sources.openings, &places) {
                Some(size) if size < max_size && light.sends_photons_with(&sources.openings) => {
                    sources.small.push((id, size));
                }
                Some(size) => sources.large.push((id, size)),
                None => {}
            }
        }
        sources
    }
}

/// Returns the lights from which photons may be sent, or why none are sent, if that is worth telling.
fn sources(scene: &Scene<Curve>, world: &World) -> Result<Sources, Option<String>> {
    if let Some(why) = no_caustics(scene) {
        return Err(Some(format!("no caustics: {why}")));
    }
    if matches!(world.method().transport, Transport::Deterministic { .. }) {
        return Err(None);
    }
    if scene.render.caustics == AutoText::Off {
        return Err(Some(format!("caustics \"off\": no photon tracing{}", point_light_note(scene))));
    }
    let places = visible_receivers(scene);
    if places.is_empty() {
        let why = "the camera sees no diffuse or rough surface except through glass or in mirrors, where caustics";
        return Err(Some(format!("no photon tracing: {why} are left to chance{}", point_light_note(scene))));
    }
    let sources = Sources::new(world, &places, MAX_SOLID_ANGLE);
    if sources.small.is_empty() {
        let why = match sources.large.as_slice() {
            [] if scene.lights.iter().any(|light| light.polarization().is_some() && !light.is_even_sky()) => {
                "caustics from a polarized image of the sky are left to chance".into()
            }
            [] => "rays find the sky often enough by chance".into(),
            lights => format!("rays hit {} often enough by chance", named(scene, lights)),
        };
        return Err(Some(format!("no photon tracing: {why}")));
    }
    Ok(sources)
}

/// Explains why a scene has no caustics, if it has none.
fn no_caustics(scene: &Scene<Curve>) -> Option<&'static str> {
    if targets(scene, &Smoothness::ALL).is_empty() {
        Some("no surface is smooth glass, a mirror or polished metal")
    } else if scene.materials.iter().any(|named| may_receive(scene, &named.material)) {
        scene.lights.is_empty().then_some("nothing shines")
    } else if scene.materials.iter().any(|named| named.material.lobes().is_diffuse()) {
        Some("with diffuse_bounces 0, diffuse surfaces receive only direct light")
    } else {
        Some("there is no diffuse or rough surface to show one")
    }
}

/// Returns the objects of some kinds of smoothness.
pub(super) fn targets(scene: &Scene<Curve>, smooth: &[Smoothness]) -> Vec<usize> {
    (0..scene.objects.len()).filter(|&object| Smoothness::sent_to(scene, object, smooth).is_some()).collect()
}

/// Whether caustics can be seen on a material.
fn may_receive(scene: &Scene<Curve>, material: &Material<Curve>) -> bool {
    material.lobes().is_wide() && !(material.lobes().is_diffuse() && scene.render.diffuse_bounces == Some(0))
}

/// Returns the solid angle under which all openings together are seen from at least half of some places.
fn openings_solid_angle(openings: &[Opening], places: &[DVec3]) -> Option<f64> {
    let from = |place: &DVec3| openings.iter().map(|opening| opening.solid_angle_from(*place)).sum();
    median(places.iter().map(from).collect()).filter(|_| !openings.is_empty())
}

/// Describes what cannot be hit by chance at all.
fn point_light_note(scene: &Scene<Curve>) -> &'static str {
    if scene.lights.iter().all(Light::is_extended) { "" } else { "; caustics from point lights are left out" }
}

/// Describes which light of points is left out that smooth surfaces cast on surfaces called `lit`, diffuse or rough.
pub(super) fn left_out_point_light(scene: &Scene<Curve>, method: &Method, lit: &str) -> Vec<String> {
    let smooth = || (0..scene.objects.len()).filter(|&object| scene.material_of(object as u32).is_smooth_somewhere());
    let line = |surfaces: &str, object: usize, suffix: &str| {
        let name = &scene.materials[scene.objects[object].material as usize].name;
        format!("left out: light from point lights that reaches {lit} surfaces via {surfaces} ({name}){suffix}")
    };
    let vertex_note = if method.light_vertices { "; some of it is found at light vertices" } else { "" };
    let Some(pass) = &method.light_pass else {
        return smooth().next().map(|object| line("smooth ones", object, vertex_note)).into_iter().collect();
    };
    let unseen = ", seen in a mirror, through glass or via another surface";
    let aimed = smooth().find(|&object| Smoothness::sent_to(scene, object, &pass.to).is_some());
    let aimed = aimed.filter(|_| pass.map.is_none()).map(|object| line("smooth ones", object, unseen));
    let unaimed = |smooth: Smoothness, surfaces: &str| {
        let left = targets(scene, &[smooth]).into_iter().find(|_| !pass.to.contains(&smooth))?;
        Some(line(surfaces, left, vertex_note))
    };
    let unaimed = [
        unaimed(Smoothness::Whole, "smooth ones"),
        unaimed(Smoothness::Partial, "surfaces that are smooth only in part"),
    ];
    let unaimed = unaimed.into_iter().flatten();
    aimed.into_iter().chain(unaimed).collect()
}

/// Names lights, with the solid angle under which their bright parts are seen.
fn named(scene: &Scene<Curve>, lights: &[SizedLight]) -> String {
    let name = |&(id, size): &SizedLight| {
        let name = match &scene.lights[id] {
            Light::Area(area) => scene.objects[area.object as usize].name.clone(),
            Light::Point(_) => "a point light".into(),
            Light::Spot(_) => "a spotlight".into(),
            Light::Sun(_) => "the sun".into(),
            Light::Environment(environment) if environment.bright_part().is_none() => "the sky through openings".into(),
            Light::Environment(_) => "the bright parts of the image of the sky".into(),
        };
        if size > 0.0 { format!("{name} (solid angle {size:.1e} sr)") } else { name }
    };
    match lights {
        [one] => name(one),
        [first, ..] => format!("{} lights such as {}", lights.len(), name(first)),
        [] => "no light".into(),
    }
}

/// Returns points that the camera sees on surfaces that may show caustics; the same for any part of the image.
fn visible_receivers(scene: &Scene<Curve>) -> Vec<DVec3> {
    let film = scene.film;
    let at = |i: u32, size: u32| (f64::from(i) + 0.5) * f64::from(size) / f64::from(RAYS_PER_SIDE);
    let rays = (0..RAYS_PER_SIDE * RAYS_PER_SIDE)
        .map(|i| scene.camera.ray(DVec2::new(at(i % RAYS_PER_SIDE, film.width), at(i / RAYS_PER_SIDE, film.height))));
    let place = |ray| {
        // What is seen through a pane is lit as well.
        let stops_ray = |object| {
            let material = scene.material_of(object);
            scene.is_seen(object) && (may_receive(scene, material) || !material.is_see_through())
        };
        let hit = scene.nearest(&ray, f64::INFINITY, &stops_ray)?;
        may_receive(scene, scene.material_of(hit.object)).then(|| ray.at(hit.intersection.t))
    };
    rays.filter_map(place).collect()
}

/// Returns the solid angle, in steradians, under which at least half of some places see a light: its visible bright
/// part or, for a sky without one, the openings to it. Returns `None` for a sky that is seen without openings.
fn solid_angle<S>(light: &Light<S>, openings: &[Opening], places: &[DVec3]) -> Option<f64> {
    match light {
        Light::Point(_) | Light::Spot(_) => Some(0.0),
        Light::Sun(sun) => Some(sun.solid_angle()),
        Light::Environment(environment) => {
            let bright = environment.bright_part().map(|bright| bright.solid_angle);
            bright.or_else(|| openings_solid_angle(openings, places).filter(|_| light.sends_photons_through_openings()))
        }
        Light::Area(area) => {
            let (ball, size) = area.visible_part()?;
            let from = |place: &DVec3| {
                let distance_squared = (ball.center - *place).length_squared();
                area.bright_share() * (TAU * ball.cone_from(*place).one_minus_cos).min(size / distance_squared)
            };
            median(places.iter().map(from).collect())
        }
    }
}
