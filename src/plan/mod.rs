//! Floor 5: looks at a scene, decides how little of the world must be modeled to render it, and says why.

mod adaptive;
mod candidates;
mod caustics;
mod dyes;
mod films;
mod format;
mod indirect;
mod lighting;
mod lights;
mod model;
mod photon_gain;
mod photon_map;
mod polarization;
mod seen;
mod stopping;
mod survey;
mod transport;

use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::film::Window;
use crate::light::Light;
use crate::scene::Scene;
use crate::spectrum::{Basis, Curve};
use crate::trace::{
    FIRST_LOOK, Method, PhotonCost, PhotonTimes, Probe, Transport, bytes_of_film, photon_times, prepare_unguided,
    probe, small_highlights,
};
use caustics::left_out_point_light;
use format::{format_count, format_duration};
use lighting::LitWorld;
use model::Model;
use survey::path_method;

pub use candidates::Candidate;

/// How to render a scene and, in words, why.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[non_exhaustive]
pub struct Plan {
    /// What the tracer is to do.
    pub method: Method,
    /// The cost, how far colors may be off and what is left out; then one decision per line, with its numbers.
    pub because: Vec<String>,
    /// How many of these lines come before the decisions.
    pub summary_lines: usize,
    /// Estimated processor time of the render.
    pub processor_time: Duration,
    /// How many camera samples a photon counts as in the progress.
    pub photon_cost: PhotonCost,
    /// The models of color that were weighed, from few lanes to many; empty for a plan that was read from a file.
    #[serde(skip)]
    pub candidates: Vec<Candidate>,
    /// The lines that say what light is left out.
    pub left_out: Vec<String>,
    /// How far colors may be off, relative to the strongest channel, because spectra are carried in few lanes.
    pub model_error: f64,
    /// Relative error of the image because polarization is not traced, where that was measured.
    pub polarization_error: Option<f64>,
}

/// Samples per pixel where the scene does not specify them.
const DEFAULT_SAMPLES: u32 = 256;
/// Where wavelengths are drawn, refracted rays that are closer than this, in pixels, continue as one: a twentieth of
/// the visible dispersion, so that several surfaces in a row stay below it.
const TOGETHER_PIXELS: f64 = 0.01;

/// Decides how to render a scene.
///
/// # Panics
/// If a program has changed the scene since it was compiled, such as to one without pixels.
pub fn plan(scene: &Scene<Curve>) -> Plan {
    let Model { basis, error_line, error: model_error, because: mut decisions, next, candidates } = model::model(scene);
    let (method, reason) = base_method(scene, basis, model_error);
    decisions.push(reason);
    let unlit = prepare_unguided(scene, method);
    let highlights = small_highlights(&unlit);
    decisions.extend(format::highlights(&highlights));
    let unlit = unlit.with_highlights(highlights);
    let LitWorld { world, because, guided } = LitWorld::new(scene, &unlit);
    decisions.extend(because);
    let polarization = polarization::decide(scene, &world);
    decisions.extend(polarization.reason);
    let world = world.with_polarization(polarization.polarization);
    let adaptive = adaptive::decide(scene, &world);
    decisions.extend(adaptive.as_ref().map(adaptive::reason));
    let times_rays = adaptive.as_ref().map_or(1.0, |adaptive| adaptive.rays);
    let world = world.with_density(adaptive.map(|adaptive| adaptive.density));
    let method = Method { seed: scene.render.seed, ..world.method().clone() };
    let probe = probe(&world);
    let times = photon_times(&guided.map_or(world.clone(), |guided| world.clone().guided_by(&guided)));
    let average_probe = Probe { time: probe.time.mul_f64(times_rays), rays: probe.rays * times_rays, ..probe };
    let (cost, processor_time) = estimate_cost(scene, &method, &average_probe, times);
    let mut because = vec![cost];
    because.extend(stopping::reason(scene, method.stop.as_ref(), model_error));
    because.extend(describe_memory(scene, &method));
    because.extend(error_line);
    let left_out: Vec<String> = polarization.left_out.into_iter().chain(describe_left_out(scene, &method)).collect();
    because.extend(left_out.iter().cloned());
    let summary_lines = because.len();
    because.extend(decisions);
    if probe.parted > 0.0 {
        because.push(format!("lanes separate in {:.0} % of the camera samples", 100.0 * probe.parted));
    }
    because.extend(next.map(|basis| compare_cost(scene, &method, &probe, basis)));
    Plan {
        photon_cost: times.in_samples(average_probe.time),
        method,
        because,
        summary_lines,
        processor_time,
        candidates,
        left_out,
        model_error,
        polarization_error: polarization.error,
    }
}

/// Returns what does not depend on how light is found, and an explanation of which branches are followed.
fn base_method(scene: &Scene<Curve>, basis: Basis, model_error: f64) -> (Method, String) {
    let together = if basis.draws_wavelengths() { TOGETHER_PIXELS * scene.camera.pixel_angle() } else { 0.0 };
    let (transport, reason) = transport::transport(scene, &basis, together);
    let stop = stopping::stop(&scene.render, scene.film.window(), model_error);
    let samples = match (transport, scene.render.samples) {
        _ if stop.is_some() => stopping::NOMINAL_SAMPLES,
        (_, Some(samples)) => samples,
        (Transport::Deterministic { .. }, None) => 1,
        (Transport::Random { .. }, None) => DEFAULT_SAMPLES,
    };
    (Method { together, samples, stop, ..path_method(scene, basis, transport) }, reason)
}

/// Describes the memory of the film and its layers, where that is much.
fn describe_memory(scene: &Scene<Curve>, method: &Method) -> impl Iterator<Item = String> {
    let memory_line = |what: String, bytes: u64| {
        let gigabytes = bytes as f64 / 1e9;
        (gigabytes >= 1.0).then(|| format!("{what} take {gigabytes:.1} GB of memory"))
    };
    let Window { width, height, .. } = scene.film.window();
    let film = memory_line(format!("film: {width} x {height} pixels"), bytes_of_film(scene, method));
    let channels = scene.layer_channels();
    let layers = memory_line(format!("layers: {channels} channels beside the image"), scene.layer_bytes());
    film.into_iter().chain(layers)
}

/// Describes which light is left out.
fn describe_left_out(scene: &Scene<Curve>, method: &Method) -> Vec<String> {
    let mut lines = Vec::new();
    let lobes = || scene.materials.iter().map(|named| named.material.lobes());
    let has_wide_lobe = |diffuse| lobes().any(|lobes| lobes.is_wide() && lobes.is_diffuse() == diffuse);
    let lit = match [has_wide_lobe(true), has_wide_lobe(false)] {
        [false, false] => None,
        [true, false] => Some("diffuse"),
        [false, true] => Some("rough"),
        [true, true] => Some("diffuse or rough"),
    };
    if let (Some(lit), false) = (lit, scene.lights.iter().all(Light::is_extended)) {
        lines.extend(left_out_point_light(scene, method, lit));
    }
    if let Some(bounces) = scene.render.max_bounces {
        lines.push(format!("max_bounces {bounces}: light from longer paths is left out; the report says how much"));
    }
    match scene.render.diffuse_bounces.filter(|_| has_wide_lobe(true)) {
        Some(0) => lines.push("diffuse_bounces 0: diffuse surfaces receive only direct light".into()),
        Some(bounces) => lines.push(format!(
            "diffuse_bounces {bounces}: light after more diffuse bounces is left out; the report says how much"
        )),
        None => {}
    }
    lines
}

/// Estimates the cost of the whole from a few hundred samples.
fn estimate_cost(scene: &Scene<Curve>, method: &Method, probe: &Probe, times: PhotonTimes) -> (String, Duration) {
    let window = scene.film.window();
    let samples = window.pixels() as f64 * f64::from(method.samples);
    let map_photons = method.map().map_or(0, |map| map.all_photons());
    let shown_photons = method.light_pass.as_ref().map_or(0, |pass| pass.photons);
    let photons = shown_photons + map_photons;
    let photon_time = times.splatted.mul_f64(shown_photons as f64) + times.stored.mul_f64(map_photons as f64);
    let light_path_time = probe.light_paths.mul_f64(f64::from(method.samples));
    let time = probe.time.mul_f64(samples) + photon_time + light_path_time;
    let (share, link) = match method.stop {
        Some(_) => (f64::from(FIRST_LOOK) / f64::from(method.samples), " for each"),
        None => (1.0, ":"),
    };
    let (sample_count, photons) = ((share * f64::from(method.samples)) as u32, (share * photons as f64) as u64);
    let line = format!(
        "cost: about {} of processor time{link} {sample_count} sample{} per pixel, {:.1} rays each{}",
        format_duration(share * time.as_secs_f64()),
        if sample_count == 1 { "" } else { "s" },
        probe.rays,
        if photons > 0 { format!(", and {} photons", format_count(photons)) } else { String::new() },
    );
    (line, time)
}

/// Describes what another model of color would cost.
fn compare_cost(scene: &Scene<Curve>, method: &Method, own_probe: &Probe, basis: Basis) -> String {
    let name = basis.name();
    let other = probe(&prepare_unguided(scene, Method { basis, ..method.clone() }));
    let times = other.time.as_secs_f64() / own_probe.time.as_secs_f64();
    let what = if method.basis.draws_wavelengths() { "without dispersion, as" } else { "with" };
    format!("for comparison: {what} {name}, a sample would take {times:.1} times as long")
}
