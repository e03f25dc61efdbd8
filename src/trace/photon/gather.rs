//! Gathers photons around a place that a path from the camera has reached.
//!
//! The light on a disc of radius r is taken for the light at its center. This blurs: light that varies comes out too
//! bright by r^2 / 12 times its Laplacian. The radius is measured in pixels, seen along the path, and shrinks with the
//! number of samples to the power -1 / 6, at which bias and noise vanish at the same rate (Silverman 1986, *Density
//! Estimation for Statistics and Data Analysis*, section 4.3). The blur of an image is measured if a stop rule needs
//! it: see `blur.rs`.
//!
//! Photons count, whatever object they lie on, if their surface continues the one around the place and is visible from
//! a point above it. From that point, they are projected onto the disc in the tangent plane, so that those of a curved
//! surface fill the disc as those of a flat one do. At edges, a part of the disc has no such surface, and the sum is
//! divided by the share that has. The reciprocal of that share is the mean number of points of the disc that must be
//! drawn until one lies on such a surface (Booth 2007, *Unbiased Monte Carlo Estimation of the Reciprocal of an
//! Integral*): one, away from edges.

use std::cell::OnceCell;
use std::f64::consts::PI;

use super::kernel::Kernel;
use super::photon_map::{JointLanes, PhotonMap, SingleLane, StoredPhoton};
use crate::light::LightId;
use crate::math::{DVec2, DVec3, Frame, Ray, Sampler, unit};
use crate::shape::SurfacePoint;
use crate::spectrum::{Lanes, Wavelength};
use crate::trace::World;
use crate::trace::contribution::{Contribution, FoundBy, add};
use crate::trace::received_light::{ReceivedLight, SourceId};
use crate::trace::walk::{Excitation, Interaction, Path, Polarization, shading};

/// Surfaces whose normals differ by more than 60 degrees belong to different sides or walls.
const MIN_NORMAL_COSINE: f64 = 0.5;
/// How far, in radii, a surface may lie from where it would continue another: flat faces at 30 degrees lie nearer.
const MAX_STEP: f64 = 0.25;
/// Height above the place, in radii, of the point that sees photons, unless something is in the way. From there, all
/// that is gathered on a ball of the same radius is visible.
const MAX_HEIGHT: f64 = 4.0;
/// Most points of the disc that are drawn: what covers less of it is too small to be seen.
const MAX_POINTS: u32 = 1 << 12;
/// Branches of random numbers, beyond those that a path may take: for these points, and for the photon that is tested.
const POINT_BRANCH: usize = 128;
const CHOICE_BRANCH: usize = 129;

/// The sum of what was found, and one photon of it, drawn in proportion to its contribution.
struct GatheredSum<const N: usize> {
    sum: [f64; 3],
    /// What each photon contributes, if requested.
    parts: Option<Vec<PhotonShare<N>>>,
    weight: f64,
    drawn: Option<SampledPhoton>,
    u: f64,
}

struct SampledPhoton {
    position: DVec3,
    rgb: [f64; 3],
    weight: f64,
    /// Its index among the parts.
    part: usize,
    /// The share by which polarization may change it.
    change: f64,
}

/// Gathered light, and what each photon contributes to it, if requested.
pub struct Gathered<const N: usize> {
    pub all: Contribution,
    pub parts: Option<Vec<PhotonShare<N>>>,
}

/// What one photon contributes, up to a factor.
pub struct PhotonShare<const N: usize> {
    pub contribution: Contribution,
    /// Its S1, S2 and S3, if requested.
    pub stokes: Option<[[f64; 3]; 3]>,
    pub spectrum: PhotonSpectrum<N>,
    pub factor: f64,
}

/// The spectrum of a photon's contribution.
pub enum PhotonSpectrum<const N: usize> {
    /// The lanes in which the light of a source arrives at the sensor, whether they parted, and the shares of them that
    /// S1, S2 and S3 are, if their spectra are requested.
    Lanes { source: SourceId, lanes: Lanes<N>, parted: bool, stokes: Option<Box<[Lanes<N>; 3]>> },
    /// One wavelength.
    SingleLane(Wavelength),
}

/// The place where a camera path gathers the photons around it.
pub struct GatherPoint<'a, const N: usize, P> {
    pub world: &'a World,
    pub path: &'a Path<N, P>,
    pub interaction: &'a Interaction<'a, N>,
    /// The dye that the photons excite, if the path follows its light.
    pub excitation: Option<&'a Excitation<N, P>>,
}

/// What the sensor receives of one photon: the total, its S1, S2 and S3, and its spectrum.
struct ReceivedPhoton<const N: usize> {
    rgb: [f64; 3],
    stokes: Option<[[f64; 3]; 3]>,
    spectrum: PhotonSpectrum<N>,
}

impl<const N: usize> ReceivedPhoton<N> {
    /// Returns what the sensor receives of light that arrives in lanes.
    fn new(world: &World, received: &ReceivedLight<N>, stokes: Option<[Lanes<N>; 3]>) -> Self {
        let ReceivedLight { source, lanes, parted, .. } = *received;
        let band_stokes = stokes.filter(|_| world.layers.spectrum.is_some()).map(Box::new);
        Self {
            rgb: received.rgb(&world.responses),
            stokes: stokes.map(|stokes| stokes.map(|part| received.times(part, &world.responses))),
            spectrum: PhotonSpectrum::Lanes { source, lanes: *lanes, parted, stokes: band_stokes },
        }
    }
}

/// A search for the photons around a place.
struct PhotonSearch<'a, const N: usize, P> {
    center: &'a GatherPoint<'a, N, P>,
    kernel: &'a Kernel<N>,
    /// Whether the path arrives at the front of the surface.
    is_front: bool,
    /// Whether light crosses the surface: then a surface close behind it is another one.
    crosses: bool,
    radius: f64,
    /// The point above the place, once a photon asks for it.
    eye: OnceCell<Eye>,
}

/// The point above a place that sees photons.
#[derive(Clone, Copy)]
struct Eye {
    position: DVec3,
    height: f64,
}

/// Returns what the sensor receives of the photons around a place that a path has reached; if `split`, photon by photon
/// as well. How much of it polarization may change is estimated from the photon that is tested.
pub fn gather<const N: usize, P: Polarization<N>>(
    photons: &PhotonMap<N, P>,
    kernel: &Kernel<N>,
    center: &GatherPoint<N, P>,
    sampler: &Sampler,
    split: bool,
) -> Gathered<N> {
    let GatherPoint { world, path, interaction, .. } = center;
    let [u, u_gather, ..] = sampler.get_random_4d(path.key.child(CHOICE_BRANCH), 0);
    let crosses = interaction.lobes.is_transmissive();
    let has_any = photons.crosses || !crosses;
    let Some(map) = world.method.map().filter(|map| has_any && u_gather < map.chance) else {
        return Gathered { all: center.all([0.0; 3], 0.0), parts: split.then(Vec::new) };
    };
    let (position, radius) = (interaction.point.position, kernel.radius * world.scene.camera.pixel_width(path.length));
    let search = PhotonSearch {
        center,
        kernel,
        is_front: interaction.flat.dot(interaction.point.normal) > 0.0,
        crosses,
        radius,
        eye: OnceCell::new(),
    };
    let mut found = GatheredSum { sum: [0.0; 3], parts: split.then(Vec::new), weight: 0.0, drawn: None, u };
    photons.together.visit_near(position, radius, &mut |position, photon| {
        search.add_joint(&mut found, position, photon);
    });
    photons.alone.visit_near(position, radius, &mut |position, photon| {
        search.add_single(&mut found, position, photon);
    });
    let (rgb, polarization_change) = search.seen_of(&mut found, sampler);
    let (rgb, polarization_change) = (rgb.map(|x| x / map.chance), polarization_change / map.chance);
    found.parts.iter_mut().flatten().for_each(|part| part.factor /= map.chance);
    Gathered { all: center.all(rgb, polarization_change), parts: found.parts }
}

impl<const N: usize, P: Polarization<N>> GatherPoint<'_, N, P> {
    /// Returns all that is gathered. Photons together have no single light, lobe or path, but came over at least two
    /// surfaces, as they do wherever the path has left one.
    fn all(&self, rgb: [f64; 3], polarization_change: f64) -> Contribution {
        let (found, first, bounces) = (FoundBy::Gathered, self.path.first, self.path.bounces + 2);
        Contribution { light: None, found, rgb, polarization_change, first, bounces, dispersed: false }
    }

    /// Returns what one photon contributes, up to a factor.
    fn contribution<T, L>(
        &self,
        photon: &StoredPhoton<T, L>,
        light: LightId,
        rgb: [f64; 3],
        parted: bool,
    ) -> Contribution {
        let Self { world, path, interaction, excitation } = self;
        let (light, found, bounces) = (Some(light), FoundBy::Gathered, path.bounces + photon.surfaces);
        let first = path.first_lobe(world, interaction, photon.wi, photon.wi.dot(interaction.flat) < 0.0);
        let dispersed = parted || excitation.is_some_and(|excitation| excitation.parted);
        Contribution { light, found, rgb, polarization_change: 0.0, first, bounces, dispersed }
    }

    /// Whether lanes part on the way of the path and of a photon from the direction `wi`.
    fn parted(&self, wi: DVec3) -> bool {
        self.path.parted || (self.interaction.is_parting && wi.dot(self.interaction.flat) < 0.0)
    }
}

impl<const N: usize, P: Polarization<N>> PhotonSearch<'_, N, P> {
    /// Adds a photon whose lanes have not parted.
    fn add_joint(&self, found: &mut GatheredSum<N>, position: DVec3, photon: &StoredPhoton<JointLanes<N>, P::Stored>) {
        let Self { center, kernel, .. } = self;
        let GatherPoint { world, path, interaction, excitation } = center;
        let Some(density) = self.density(position, photon) else { return };
        let Some((mut bsdf_cos, _)) =
            shading::evaluate(interaction.material, &interaction.context, interaction.flat, photon.wi)
        else {
            return;
        };
        let (draw, parted, payload) = (interaction.context.draw, center.parted(photon.wi), &photon.payload);
        let has_heroes = draw.hero_factor(parted).is_some();
        let onto_heroes = |lanes: Lanes<N>| kernel.matching.onto_heroes(draw, lanes);
        let flux = if has_heroes { onto_heroes(payload.flux) } else { payload.flux };
        let read = if has_heroes { Some(P::convert_stored(&photon.polarization, onto_heroes)) } else { None };
        let light = read.as_ref().unwrap_or(&photon.polarization);
        let joined = path.polarization.join(interaction, photon.wi, light, &mut bsdf_cos);
        let lanes = path.throughput.of(bsdf_cos * flux);
        let received = ReceivedLight { source: payload.light, draw, lanes: &lanes, parted };
        let ReceivedPhoton { rgb, stokes, spectrum } = match excitation {
            None => ReceivedPhoton::new(world, &received, joined.stokes()),
            Some(dye) => {
                dye.with_received(world, &received, |seen| ReceivedPhoton::new(world, seen, dye.polarization.stokes()))
            }
        };
        let contribution = center.contribution(photon, payload.light, rgb, parted);
        let part = PhotonShare { contribution, stokes, spectrum, factor: density };
        found.add(world, position, part, || {
            path.polarization.change_of_joined(interaction, photon.wi, light, &joined, lanes)
        });
    }

    /// Adds a photon of one wavelength, whose lanes have parted.
    fn add_single(&self, found: &mut GatheredSum<N>, position: DVec3, photon: &StoredPhoton<SingleLane, P::Stored>) {
        let Self { center, kernel, .. } = self;
        let GatherPoint { world, path, interaction, excitation } = center;
        let SingleLane { wavelength, light, weight, color } = &photon.payload;
        let (draw, parted) = (interaction.context.draw, center.parted(photon.wi));
        let has_heroes = draw.hero_factor(parted).is_some();
        let read = |lanes: Lanes<N>| match has_heroes {
            true => kernel.matching.matching_light(draw, wavelength, lanes, parted),
            false => kernel.matching.read(wavelength, lanes),
        };
        // Most photons with parted wavelengths meet paths with other wavelengths.
        if has_heroes && read(path.throughput.present()) == 0.0 {
            return;
        }
        let Some(density) = self.density(position, photon) else { return };
        let Some((mut bsdf_cos, _)) =
            shading::evaluate(interaction.material, &interaction.context, interaction.flat, photon.wi)
        else {
            return;
        };
        let joined = path.polarization.join(interaction, photon.wi, &photon.polarization, &mut bsdf_cos);
        let lanes = path.throughput.of(bsdf_cos);
        let seen = read(lanes);
        let ReceivedPhoton { rgb, stokes, spectrum } = match excitation {
            None => {
                let share = |part: Lanes<N>| if seen == 0.0 { 0.0 } else { read(lanes * part) / seen };
                let stokes = joined.stokes().map(|stokes| stokes.map(|part| color.map(|x| x * share(part))));
                ReceivedPhoton { rgb: *color, stokes, spectrum: PhotonSpectrum::SingleLane(*wavelength) }
            }
            Some(dye) => {
                let brightness = weight * dye.brightness(world, *light, wavelength);
                dye.with_brightness(brightness, |seen| ReceivedPhoton::new(world, seen, dye.polarization.stokes()))
            }
        };
        let contribution = center.contribution(photon, *light, rgb, true);
        let part = PhotonShare { contribution, stokes, spectrum, factor: density * seen };
        found.add(world, position, part, || {
            path.polarization.change_of_joined(interaction, photon.wi, &photon.polarization, &joined, lanes)
        });
    }

    /// Returns the weight of a photon per area of the tangent plane at the place, if it counts.
    fn density<T, L>(&self, position: DVec3, photon: &StoredPhoton<T, L>) -> Option<f64> {
        let GatherPoint { world, path, interaction, .. } = self.center;
        let within_limit = path.surfaces() + photon.surfaces - 1 <= world.method.max_bounces;
        // Where a path looks for light at light vertices, those account for what surfaces scatter of the photon's
        // light.
        let is_counted = path.resampled && photon.is_resampled;
        if !within_limit
            || is_counted
            || photon.crosses != self.crosses
            || !self.continues(position, photon.flat, photon.is_front)
        {
            return None;
        }
        let (flat, eye, squared_radius) = (interaction.flat, self.eye(), self.radius * self.radius);
        let way = position - interaction.point.position;
        let elevation = way.dot(flat);
        // How much farther from the eye its projection onto the disc is.
        let stretch = eye.height / (eye.height - elevation);
        if elevation >= eye.height || stretch * self.stretch() < 1.0 {
            return None;
        }
        let projected = (way - flat * elevation) * stretch;
        // The Epanechnikov kernel, which integrates to 1 over the disc.
        let kernel = 2.0 * (1.0 - projected.length_squared() / squared_radius) / (PI * squared_radius);
        let sight = position - eye.position;
        let area_ratio = stretch * stretch * (sight.dot(photon.flat) / sight.dot(flat)).abs();
        (kernel > 0.0).then_some(kernel * area_ratio)
    }

    /// Returns the point above the place that sees photons.
    fn eye(&self) -> Eye {
        *self.eye.get_or_init(|| {
            let GatherPoint { world, interaction, .. } = self.center;
            let up = interaction.point.leave(interaction.flat);
            let top = MAX_HEIGHT * self.radius;
            let clearance = world.scene.nearest(&up, 2.0 * top, &|_| true).map_or(top, |hit| 0.5 * hit.intersection.t);
            let position = up.at(top.min(clearance));
            Eye { position, height: (position - interaction.point.position).dot(interaction.flat) }
        })
    }

    /// Returns how far photons may lie from the eye, relative to their projections onto the disc.
    fn stretch(&self) -> f64 {
        1.0 + MAX_STEP * self.radius / self.eye().height
    }

    /// Whether a surface continues that of the place. `flat` is its unit normal on the side from which it is reached,
    /// and `is_front` tells whether that is the front.
    fn continues(&self, position: DVec3, flat: DVec3, is_front: bool) -> bool {
        let Interaction { point, flat: own, .. } = self.center.interaction;
        let cos = flat.dot(*own);
        // The far face of a thin body, too, is reached from the other side, but from the front.
        if cos.abs() < MIN_NORMAL_COSINE || (cos < 0.0 && is_front == self.is_front) {
            return false;
        }
        // A chord of a ball is perpendicular to the sum of the normals at its ends.
        let (chord, normals) = (position - point.position, *own + flat * cos.signum());
        chord.length_squared() < self.radius * self.radius && 0.5 * chord.dot(normals).abs() <= MAX_STEP * self.radius
    }

    /// Returns the visible part of the sum, divided by the visible share of the disc, and how much polarization may
    /// change it.
    fn seen_of(&self, found: &mut GatheredSum<N>, sampler: &Sampler) -> ([f64; 3], f64) {
        let GatherPoint { world, path, interaction, .. } = self.center;
        let GatheredSum { mut sum, ref mut parts, weight, drawn: ref chosen, .. } = *found;
        let Some(chosen) = chosen else { return (sum, 0.0) };
        let weight_ratio = weight / chosen.weight;
        let mut polarization_change = weight_ratio * chosen.change * world.amount(chosen.rgb);
        let (from, stretch) = (self.eye().position, self.stretch());
        if !self.sees(from, chosen.position, 1.0).unwrap_or(true) {
            (0..3).for_each(|i| sum[i] -= chosen.rgb[i] * weight_ratio);
            if let Some(parts) = parts {
                parts[chosen.part].factor *= 1.0 - weight_ratio;
            }
            polarization_change = 0.0;
        }
        let frame = Frame::about(interaction.flat);
        let mut drawn = 0;
        while drawn < MAX_POINTS {
            let [a, b, c, d] = sampler.get_random_4d(path.key.child(POINT_BRANCH), drawn);
            for u in [[a, b], [c, d]] {
                drawn += 1;
                let DVec2 { x, y } = self.radius * sample_kernel(u);
                let to = interaction.point.position + frame.to_world(DVec3::new(x, y, 0.0));
                if self.sees(from, to, stretch) == Some(true) {
                    let drawn = f64::from(drawn);
                    parts.iter_mut().flatten().for_each(|part| part.factor *= drawn);
                    return (sum.map(|x| x * drawn), polarization_change * drawn);
                }
            }
        }
        (sum, polarization_change)
    }

    /// Whether a ray to a point, or `stretch` times as far, hits a surface that continues this one; `None` for no hit.
    fn sees(&self, from: DVec3, to: DVec3, stretch: f64) -> Option<bool> {
        let scene = &self.center.world.scene;
        let way = to - from;
        let ray = Ray { origin: from, direction: unit(way) };
        let hit = scene.nearest(&ray, way.length() * stretch, &|_| true)?;
        let SurfacePoint { position, normal, .. } =
            scene.objects[hit.object as usize].shape.point(&ray, &hit.intersection);
        let is_front = normal.dot(ray.direction) < 0.0;
        let flat = if is_front { normal } else { -normal };
        let continues = flat.dot(self.center.interaction.flat) > 0.0 && self.continues(position, flat, is_front);
        Some(continues && scene.material_of(hit.object).lobes().is_wide())
    }
}

impl<const N: usize> GatheredSum<N> {
    fn add(&mut self, world: &World, position: DVec3, part: PhotonShare<N>, change: impl FnOnce() -> f64) {
        let rgb = part.contribution.rgb.map(|x| part.factor * x);
        let weight = world.amount(rgb);
        add(&mut self.sum, rgb);
        let number = self.parts.as_ref().map_or(0, Vec::len);
        if let Some(parts) = &mut self.parts {
            parts.push(part);
        }
        if weight == 0.0 {
            return;
        }
        self.weight += weight;
        // What is left of a random number after a choice is a random number again.
        let chance = weight / self.weight;
        if self.u < chance {
            self.drawn = Some(SampledPhoton { position, rgb, weight, part: number, change: change() });
            self.u /= chance;
        } else {
            self.u = (self.u - chance) / (1.0 - chance);
        }
    }
}

/// Returns a point of the unit disc, drawn by the kernel: the share within a squared radius q is 2 q - q^2.
fn sample_kernel([u, v]: [f64; 2]) -> DVec2 {
    let radius = (1.0 - (1.0 - u).sqrt()).sqrt();
    let (sin, cos) = libm::sincos(2.0 * PI * v);
    DVec2::new(radius * cos, radius * sin)
}
