//! Surveys what in a scene decides how its spectra must be carried.

use std::borrow::Cow;
use std::sync::Arc;

use super::films::{Film, films, plate, plate_transmittance};
use super::lights::{distinct_lights, farthest_apart};
use crate::material::{
    Conductor, Dielectric, Material, PathDifference, Plastic, conductor_reflectance, diffuse_transmittance,
};
use crate::scene::{PolarizationText, Scene};
use crate::spectrum::{
    Basis, ColorSpace, Curve, CurveKind, Dye, Emission, Lanes, MAX_LANES, PreparedDye, Quantity, Upsampler,
    normal_reflectance, visible,
};
use crate::trace::{Method, Transport};

/// The share of the error that the model of color may make; noise may make the rest.
const MODEL_SHARE: f64 = 1.0 / 3.0;
/// The relative error that an image aims at where the scene does not specify one.
const DEFAULT_ERROR: f64 = 0.03;
/// The seed of a plan's looks, whatever the image's: otherwise, its model of color could change from frame to frame.
const SEED: u64 = 0;

/// Returns the relative error of a color that its model may make.
pub(super) fn tolerance(scene: &Scene<Curve>) -> f64 {
    MODEL_SHARE * scene.render.error.unwrap_or(DEFAULT_ERROR)
}

/// Returns the magnitude of the channel that is farthest from 0: what an error of a color is relative to.
pub(super) fn max_channel(color: [f64; 3]) -> f64 {
    color.into_iter().fold(0.0_f64, |most, x| most.max(x.abs()))
}

/// Returns the error of a color in its worst channel.
pub(super) fn max_channel_error(found: [f64; 3], exact: [f64; 3]) -> f64 {
    max_channel(std::array::from_fn(|c| found[c] - exact[c]))
}

/// Returns what is left of light as lanes, one number for each.
pub(super) fn lanes(left: &[f64]) -> Lanes<MAX_LANES> {
    Lanes::from_fn(|i| left.get(i).map_or(0.0, |&x| x as f32))
}

/// Returns the method of paths that are as long as the scene allows.
pub(super) fn path_method(scene: &Scene<Curve>, basis: Basis, transport: Transport) -> Method {
    Method {
        diffuse_bounces: scene.render.diffuse_bounces.unwrap_or(u32::MAX),
        max_bounces: scene.render.max_bounces.unwrap_or(u32::MAX),
        ..Method::of_paths(basis, transport, SEED)
    }
}

/// Returns the method with which a plan looks where colors go: no path splits, and none is ended at random.
pub(super) fn look_method(scene: &Scene<Curve>, basis: Basis) -> Method {
    let transport = Transport::Random { split: 1.0, roulette: 0.0 };
    path_method(scene, basis, transport)
}

/// The colors of a scene: what shines and what tints.
pub(super) struct Survey<'a> {
    pub(super) color_space: ColorSpace,
    pub(super) upsampler: Upsampler,
    /// One light for each different spectrum: its curve as it is written, and its emission.
    pub(super) lights: Vec<(Curve, Emission)>,
    /// For each light of the scene, its index among these.
    pub(super) light_indices: Vec<usize>,
    /// Indices of the lights by which models are judged.
    reference_lights: Vec<usize>,
    tints: Vec<Tint<'a>>,
    /// The dyes, each with the reflectance of its surface.
    pub(super) dyes: Vec<(Dye, Cow<'a, Curve>)>,
}

/// Something that tints light.
pub(super) enum Tint<'a> {
    /// Light leaves a diffuse surface.
    Diffuse(Cow<'a, Curve>),
    /// Light leaves the base of a plastic, of some reflectance, through its coat.
    Coated(&'a Plastic<Curve>, Cow<'a, Curve>),
    /// A factor on light that a smooth surface reflects or lets through.
    Filter(Quantity, Cow<'a, Curve>),
    /// A bare metal's reflection at an angle with this cosine, once or, where it is rough, more often.
    Metal(&'a Conductor<Curve>, f64),
    /// Light goes a distance through an absorbing body.
    Depth(&'a Curve, f64),
    /// Light meets layers in which it interferes.
    Film(Film<'a>),
    /// Light crosses a wave plate between crossed polarizers.
    Plate(PathDifference),
    /// Light meets a clear surface of a measured index at normal incidence, and is reflected or crosses it.
    Surface { index: &'a Curve, crosses: bool, together: bool },
}

/// Most lights of different spectra that are judged; of more, those farthest apart.
const MAX_LIGHTS: usize = 64;

impl<'a> Survey<'a> {
    /// Surveys a scene. If `together`, all lanes are refracted by one index.
    pub(super) fn new(scene: &'a Scene<Curve>, together: bool) -> Self {
        let space = scene.film.color_space;
        let (lights, light_indices) = distinct_lights(scene.lights.iter().map(|light| light.emission()), space);
        let reference_lights = farthest_apart(&lights, MAX_LIGHTS);
        let (mut tints, mut dyes) = (Vec::new(), Vec::new());
        let filters = |quantity, curve: &'a Curve| {
            curve.representatives().into_iter().map(move |shade| Tint::Filter(quantity, shade))
        };
        for (id, named) in scene.materials.iter().enumerate() {
            for material in named.material.with_parts() {
                let index = material.clear_index().filter(|index| index.is_measured());
                tints.extend(
                    index
                        .into_iter()
                        .flat_map(|index| [false, true].map(|crosses| Tint::Surface { index, crosses, together })),
                );
                tints.extend(films(material).into_iter().map(Tint::Film));
                if let Some(plate) = plate(material).filter(|_| scene.render.polarization != PolarizationText::Off) {
                    // Each object has its own plate, which turns with it.
                    let known = |tint: &Tint| matches!(tint, Tint::Plate(known) if known.nm.abs() == plate.nm.abs());
                    tints.extend((!tints.iter().any(known)).then_some(Tint::Plate(plate)));
                }
                match material {
                    Material::Diffuse(diffuse) => {
                        let shades = diffuse.reflectance.representatives();
                        dyes.extend(diffuse.fluorescence.iter().map(|dye| (dye.dye(), shades[0].clone())));
                        tints.extend(shades.into_iter().map(Tint::Diffuse));
                    }
                    Material::Plastic(plastic) => {
                        let shades = plastic.reflectance.representatives().into_iter();
                        tints.extend(shades.map(|shade| Tint::Coated(plastic, shade)));
                    }
                    Material::Thin(thin) => {
                        let left = thin.transmittance().into_iter();
                        tints.extend(left.flat_map(|left| filters(Quantity::Transmittance, left)));
                    }
                    Material::Mirror(mirror) => tints.extend(filters(Quantity::Reflectance, &mirror.reflectance)),
                    Material::Conductor(metal) if metal.coating.is_none() => tints.push(Tint::Metal(metal, 1.0)),
                    Material::Conductor(_) => {}
                    Material::Dielectric(glass) => {
                        tints.extend(filters(Quantity::Reflectance, &glass.reflectance));
                        tints.extend(filters(Quantity::Transmittance, &glass.transmittance));
                        tints.push(Tint::Depth(&glass.absorption, thickness(scene, id as u32)));
                    }
                    Material::Mix(mix) => tints.extend(filters(Quantity::Share, &mix.amount)),
                    Material::Mask(mask) => tints.extend(filters(Quantity::Share, &mask.opacity)),
                    Material::Emissive(lamp) => tints.extend(emission_tints(&lamp.radiance)),
                    Material::Polarizer(_) | Material::Retarder(_) => {}
                }
            }
        }
        let upsampler = Upsampler::new(space);
        Self { color_space: space, upsampler, lights, light_indices, reference_lights, tints, dyes }
    }

    /// Whether three numbers are all that is known of every color: numbers and `rgb` under the film's own white.
    pub(super) fn is_rgb_only(&self) -> bool {
        let white: Curve = CurveKind::Illuminant(Arc::new(self.color_space.white_light())).into();
        let white = Emission::new(&white, self.color_space);
        self.dyes.is_empty()
            && !self.has_fringes()
            && self.tints.iter().all(|tint| tint.curves().iter().all(|curve| !curve.is_measured()))
            && self.lights.iter().all(|(curve, light)| !curve.is_measured() || light.is_proportional_to(&white))
    }

    /// Whether light interferes anywhere, which three numbers cannot describe.
    pub(super) fn has_fringes(&self) -> bool {
        self.tints.iter().any(|tint| tint.has_fringes())
    }

    /// Whether dyes absorb light that the eye does not see: more than one part in a thousand of what excites them.
    pub(super) fn needs_ultraviolet(&self) -> bool {
        let excites_in_uv = |dye: &PreparedDye, light: &Emission| {
            let excited = dye.by(light);
            let smooth = visible::wavelengths().zip(&excited.smooth).filter(|part| part.0 < ULTRAVIOLET_NM);
            let lines = excited.lines.iter().filter(|line| line[0] < ULTRAVIOLET_NM);
            let uv_power: f64 = smooth.map(|part| *part.1).chain(lines.map(|line| line[1])).sum();
            uv_power > 1e-3 * excited.parts().sum::<f64>()
        };
        let mut dyes = self.dyes.iter().map(|(dye, _)| dye.prepared());
        dyes.any(|dye| self.reference_lights().any(|(_, light)| excites_in_uv(&dye, light)))
    }

    /// Returns the light of the whole scene, if all lights have the same spectrum.
    pub(super) fn common_light(&self) -> Option<Emission> {
        match self.lights.as_slice() {
            [] => Some(Emission::new(&1.0.into(), self.color_space)),
            [(_, light)] => Some(light.clone()),
            _ => None,
        }
    }

    pub(super) fn emissions(&self) -> Vec<Emission> {
        self.lights.iter().map(|(_, light)| light.clone()).collect()
    }

    /// Returns the lights by which models are judged.
    pub(super) fn reference_lights(&self) -> impl Iterator<Item = &(Curve, Emission)> {
        self.reference_lights.iter().map(|&light| &self.lights[light])
    }

    /// Returns what shines on surfaces, that is, the lights by which models are judged and the dyes; and the dyes
    /// alone.
    pub(super) fn emitters(&self) -> (Vec<Emission>, Vec<Dye>) {
        let lights = self.reference_lights().map(|(_, light)| light.clone());
        let dyes = self.dyes.iter().map(|(dye, _)| dye);
        (lights.chain(dyes.clone().map(|dye| dye.shines(self.color_space))).collect(), dyes.cloned().collect())
    }

    /// Returns the brightest ideal lines, ascending in nm.
    pub(super) fn lines(&self, most: usize) -> Vec<f64> {
        let brightness = |nm: f64, power: f64| power * visible::color_matching(nm).iter().sum::<f64>();
        let mut lines: Vec<[f64; 2]> = self.lights.iter().flat_map(|(_, light)| light.lines()).copied().collect();
        lines.sort_by(|a, b| brightness(b[0], b[1]).total_cmp(&brightness(a[0], a[1])));
        let mut chosen: Vec<f64> = Vec::new();
        for [nm, _] in lines {
            if chosen.len() < most && !chosen.contains(&nm) {
                chosen.push(nm);
            }
        }
        chosen.sort_by(f64::total_cmp);
        chosen
    }

    pub(super) fn scattering(&self, most: usize) -> Vec<&Tint<'a>> {
        self.farthest_from_gray(most, |tint| tint.is_scattering())
    }

    pub(super) fn smooth(&self, most: usize) -> Vec<&Tint<'a>> {
        let mut chosen = self.thickest_films(MAX_FILMS);
        let is_smooth_tint = |tint: &Tint| !tint.is_scattering() && !tint.is_flat() && !tint.has_fringes();
        chosen.extend(self.farthest_from_gray(most, is_smooth_tint));
        chosen
    }

    /// Returns the films and plates with the closest fringes.
    fn thickest_films(&self, most: usize) -> Vec<&Tint<'a>> {
        let thickness = |tint: &Tint| match tint {
            Tint::Film(film) => Some(film.optical_nm().iter().sum::<f64>()),
            // Light crosses a film twice.
            Tint::Plate(plate) => Some(0.5 * plate.nm.abs()),
            _ => None,
        };
        let mut films: Vec<_> = self.tints.iter().filter_map(|tint| Some((thickness(tint)?, tint))).collect();
        films.sort_by(|a, b| b.0.total_cmp(&a.0));
        films.into_iter().take(most).map(|(_, tint)| tint).collect()
    }

    /// Returns the clear surfaces only.
    pub(super) fn surfaces(&self, most: usize) -> Vec<&Tint<'a>> {
        self.farthest_from_gray(most, |tint| matches!(tint, Tint::Surface { .. }))
    }

    fn farthest_from_gray(&self, most: usize, predicate: impl Fn(&Tint) -> bool) -> Vec<&Tint<'a>> {
        let mut chosen: Vec<(f64, &Tint)> = self
            .tints
            .iter()
            .filter(|tint| predicate(tint))
            .map(|tint| {
                let values = tint.at(&[420.0, 450.0, 480.0, 510.0, 540.0, 570.0, 600.0, 630.0, 660.0], &self.upsampler);
                let (low, high) = values.iter().fold((f64::INFINITY, 0.0_f64), |(l, h), &x| (l.min(x), h.max(x)));
                ((high - low) / high.max(1e-9), tint)
            })
            .collect();
        chosen.sort_by(|a, b| b.0.total_cmp(&a.0));
        chosen.into_iter().take(most).map(|(_, tint)| tint).collect()
    }
}

/// Wavelength in nm below which lanes of visible light carry nothing that excites dyes.
const ULTRAVIOLET_NM: f64 = 390.0;

/// Most films and plates by which models are judged; each film counts as it reflects and as it transmits.
const MAX_FILMS: usize = 4;

/// Returns how thick the thickest body of a material is, measured by the smallest side of a body's bounds.
fn thickness(scene: &Scene<Curve>, material: u32) -> f64 {
    let bodies = scene.objects.iter().filter(|object| object.material == material);
    let sizes = bodies.filter_map(|object| object.shape.bounds()).map(|bounds| bounds.size().min_element());
    sizes.fold(0.0, f64::max)
}

impl Tint<'_> {
    /// Returns the spectra that decide how lanes must be carried: what an index makes of white is nearly white.
    fn curves(&self) -> Vec<&Curve> {
        match self {
            Self::Diffuse(curve) | Self::Filter(_, curve) => vec![curve],
            Self::Depth(curve, _) => vec![curve],
            Self::Metal(metal, _) => vec![&metal.n, &metal.k],
            Self::Coated(_, reflectance) => vec![reflectance],
            Self::Surface { .. } | Self::Film(_) | Self::Plate(_) => Vec::new(),
        }
    }

    pub(super) fn has_fringes(&self) -> bool {
        matches!(self, Self::Film(_) | Self::Plate(_))
    }

    fn is_scattering(&self) -> bool {
        matches!(self, Self::Diffuse(_) | Self::Coated(..))
    }

    fn is_flat(&self) -> bool {
        !(matches!(self, Self::Surface { .. }) || self.has_fringes())
            && self.curves().iter().all(|curve| matches!(curve.kind, CurveKind::Number(_)))
    }

    /// Returns what is left of the light at wavelengths in nm.
    pub(super) fn at(&self, wavelengths_nm: &[f64], upsampler: &Upsampler) -> Vec<f64> {
        // Sums over 1 nm have the fringes of bands of 1 nm.
        let waves: Vec<_> = wavelengths_nm.iter().map(|&nm| [nm, 1.0 / nm]).collect();
        self.evaluate(&waves, |quantity, curve| {
            let reader = curve.reader(quantity, upsampler);
            wavelengths_nm.iter().map(|&nm| reader(nm)).collect()
        })
    }

    /// Returns what is left of the light in the lanes of a basis.
    pub(super) fn in_basis(&self, basis: &Basis) -> Vec<f64> {
        let basis = match self {
            Self::Surface { together: true, .. } => Cow::Owned(basis.clone().kept_together()),
            _ => Cow::Borrowed(basis),
        };
        let waves: Vec<_> = basis.waves().of_fixed_lanes().collect();
        self.evaluate(&waves, |quantity, curve| basis.tabulate(quantity, curve).bins().to_vec())
    }

    /// Returns what is left of light at some wavelengths, given in nm with the relative widths of their bands. `read`
    /// returns the values of a curve at all of them.
    fn evaluate(&self, waves: &[[f64; 2]], read: impl Fn(Quantity, &Curve) -> Vec<f64>) -> Vec<f64> {
        match self {
            Self::Diffuse(curve) => read(Quantity::Reflectance, curve),
            Self::Coated(plastic, reflectance) => {
                let index = read(Quantity::Index, &plastic.index);
                let coated = |(r, n): (f64, f64)| {
                    let internal_reflectance = 1.0 - diffuse_transmittance(n) / (n * n);
                    r * (1.0 - internal_reflectance) / (1.0 - r * internal_reflectance)
                };
                read(Quantity::Reflectance, reflectance).into_iter().zip(index).map(coated).collect()
            }
            Self::Filter(quantity, curve) => read(*quantity, curve),
            Self::Film(film) => film.remaining_light(waves, read),
            Self::Plate(plate) => plate_transmittance(*plate, waves),
            Self::Metal(metal, cos) => {
                let (n, k) = (read(Quantity::MetalIndex, &metal.n), read(Quantity::MetalExtinction, &metal.k));
                let reflected = n.into_iter().zip(k).map(|(n, k)| match *cos {
                    1.0 => normal_reflectance(n, k),
                    cos => 0.5 * conductor_reflectance(1.0, n, k, cos).iter().sum::<f64>(),
                });
                match metal.roughness.surface() {
                    None => reflected.collect(),
                    Some(surface) => {
                        let missing = surface.mean_missing_energy();
                        reflected.map(|r| r + missing * (surface.multiply_reflected(r) - r)).collect()
                    }
                }
            }
            Self::Depth(curve, depth) => {
                read(Quantity::Absorption, curve).into_iter().map(|a| libm::exp(-a * depth)).collect()
            }
            Self::Surface { index, crosses, .. } => {
                let reflected = read(Quantity::Index, index).into_iter().map(|n| normal_reflectance(n, 0.0));
                reflected.map(|r| if *crosses { 1.0 - r } else { r }).collect()
            }
        }
    }
}

/// Returns the colors of a shining image or pattern, as filters of its white that are half as bright.
fn emission_tints(radiance: &Curve) -> Vec<Tint<'_>> {
    let colors =
        radiance.representatives().into_iter().filter(|_| radiance.varies()).filter_map(|shade| shade.kind.rgb());
    let filter = |rgb: [f64; 3]| {
        let most = 2.0 * rgb.into_iter().fold(0.0, f64::max);
        let half = CurveKind::Rgb(rgb.map(|x| x / most));
        (most > 0.0).then(|| Tint::Filter(Quantity::Transmittance, Cow::Owned(half.into())))
    };
    colors.filter_map(filter).collect()
}

/// Whether rays of different colors go different ways in a glass.
pub(super) fn disperses(glass: &Dielectric<Curve>) -> bool {
    match &glass.index.kind {
        CurveKind::Number(_) | CurveKind::Rgb(_) => false,
        CurveKind::Cauchy([_, b]) => *b != 0.0,
        _ => true,
    }
}
