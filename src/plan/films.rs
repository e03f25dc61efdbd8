//! Films and wave plates in which light interferes, with which the survey judges lanes.

use std::borrow::Cow;

use crate::material::{
    COHERENT_NM, Coating, CoatingLayer, Layer, Material, PHASE_STEP, PathDifference, Retardance, Stack, Thin,
};
use crate::math::Complex;
use crate::spectrum::{Basis, Curve, CurveKind, Quantity};

/// A film that light meets at normal incidence, where its fringes are closest, and that reflects or transmits it.
pub(super) struct Film<'a> {
    coating: &'a Coating<Curve>,
    /// What lies beyond it; nothing behind a pane.
    substrate: Substrate<'a>,
    pub(super) crosses: bool,
    /// Whether layers of varying thickness are taken at their thickest, rather than at their mean.
    thickest: bool,
}

#[derive(Clone, Copy)]
enum Substrate<'a> {
    Nothing,
    Glass(&'a Curve),
    Metal(&'a Curve, &'a Curve),
}

/// Returns the films of a material itself, without the parts it is made of.
pub(super) fn films(material: &Material<Curve>) -> Vec<Film<'_>> {
    let (coating, substrate, lets_through) = match material {
        Material::Dielectric(glass) => (glass.coating.as_ref(), Substrate::Glass(&glass.index), true),
        Material::Thin(Thin::Film(film)) => (Some(film), Substrate::Nothing, true),
        Material::Conductor(metal) => (metal.coating.as_ref(), Substrate::Metal(&metal.n, &metal.k), false),
        Material::Plastic(plastic) => (plastic.coating.as_ref(), Substrate::Glass(&plastic.index), true),
        Material::Diffuse(_) | Material::Mirror(_) | Material::Emissive(_) => return Vec::new(),
        Material::Thin(Thin::Pane { .. }) => return Vec::new(),
        Material::Mix(_) | Material::Mask(_) | Material::Polarizer(_) | Material::Retarder(_) => return Vec::new(),
    };
    let Some(coating) = coating else { return Vec::new() };
    let varies = coating.layers.iter().any(|layer| layer.thickness.varies());
    let mut films = Vec::new();
    for thickest in if varies { &[true, false][..] } else { &[true] } {
        for crosses in if lets_through { &[false, true][..] } else { &[false] } {
            films.push(Film { coating, substrate, crosses: *crosses, thickest: *thickest });
        }
    }
    films
}

impl Film<'_> {
    /// Returns what is left of light at some wavelengths, given in nm with the relative widths of their bands. `read`
    /// returns the values of a curve at all of them.
    pub(super) fn remaining_light(&self, waves: &[[f64; 2]], read: impl Fn(Quantity, &Curve) -> Vec<f64>) -> Vec<f64> {
        let stacks = self.stacks(waves, &read);
        let (n, k) = match self.substrate {
            Substrate::Nothing => (vec![1.0; stacks.len()], vec![0.0; stacks.len()]),
            Substrate::Glass(index) => (read(Quantity::Index, index), vec![0.0; stacks.len()]),
            Substrate::Metal(n, k) => (read(Quantity::MetalIndex, n), read(Quantity::MetalExtinction, k)),
        };
        let share = |(i, stack): (usize, &Stack)| {
            let shares = stack.shares(1.0, Complex::new(n[i], -k[i]), 1.0);
            if self.crosses { shares.refracted.mean() } else { shares.reflected.mean() }
        };
        stacks.iter().enumerate().map(share).collect()
    }

    /// Returns the optical thickness of each layer in the middle of the spectrum, in nm.
    pub(super) fn optical_nm(&self) -> Vec<f64> {
        let read = |quantity, curve: &Curve| vec![curve.values(quantity)(MIDDLE_NM)];
        let stacks = self.stacks(&[[MIDDLE_NM, 0.0]], read);
        stacks.iter().flat_map(|stack| stack.layers().iter().map(Layer::optical_nm)).collect()
    }

    /// Returns the layers for each wavelength in nm and relative width of its band.
    fn stacks(&self, waves: &[[f64; 2]], read: impl Fn(Quantity, &Curve) -> Vec<f64>) -> Vec<Stack> {
        let layer_values = |layer: &CoatingLayer<Curve>| {
            let index_quantity = if layer.is_metal { Quantity::MetalIndex } else { Quantity::Index };
            let (n, k) = (read(index_quantity, &layer.index), read(Quantity::MetalExtinction, &layer.k));
            let thickness = read(Quantity::Thickness, &uniform_thickness(&layer.thickness, self.thickest));
            let lane = |i: usize| Layer { index: Complex::new(n[i], -k[i]), thickness_nm: thickness[i] };
            (0..n.len()).map(lane).collect()
        };
        let layers: Vec<Vec<Layer>> = self.coating.layers.iter().map(layer_values).collect();
        let stack = |(i, wave): (usize, &[f64; 2])| Stack::new(*wave, layers.iter().map(|lanes| lanes[i]));
        waves.iter().enumerate().map(stack).collect()
    }
}

const MIDDLE_NM: f64 = 550.0;

/// Returns a uniform thickness: for one that varies, the most or the mean.
fn uniform_thickness(thickness: &Curve, thickest: bool) -> Cow<'_, Curve> {
    let number = |number: f64| Cow::Owned(Curve { kind: CurveKind::Number(number), ..thickness.clone() });
    match &thickness.kind {
        CurveKind::Texture(texture) if thickest => number(f64::from(texture.image.brightest().1)),
        CurveKind::Texture(texture) => number(texture.image.mean()[0]),
        CurveKind::Checker { cells, .. } => {
            let cell_thickness = |cell: &Curve| {
                let uniform_thickness = uniform_thickness(cell, thickest);
                uniform_thickness.scale * uniform_thickness.kind.rgb().map_or(0.0, |rgb| rgb[0])
            };
            let [a, b] = cells.each_ref().map(cell_thickness);
            number(if thickest { a.max(b) } else { 0.5 * (a + b) })
        }
        _ => Cow::Borrowed(thickness),
    }
}

/// Returns the plate of a material itself that shows fringes between polarizers, if it is one.
pub(super) fn plate(material: &Material<Curve>) -> Option<PathDifference> {
    match material {
        Material::Retarder(retarder) => match retarder.retardance {
            Retardance::Path(path) => Some(path),
            Retardance::Phase(_) => None,
        },
        _ => None,
    }
}

/// Returns what two crossed polarizers let through of light polarized along the first, with a plate at 45 degrees
/// between them, for each wavelength in nm and relative width of its band: sin^2 of half its phase.
pub(super) fn plate_transmittance(plate: PathDifference, waves: &[[f64; 2]]) -> Vec<f64> {
    waves.iter().map(|wave| 0.5 * (1.0 - plate.block(*wave).c)).collect()
}

/// Describes how lanes read the films and the plates of a material; `None` without any.
pub(super) fn describe(material: &Material<Curve>, basis: &Basis) -> Option<String> {
    let waves: Vec<_> = basis.waves().of_fixed_lanes().collect();
    if let Some(plate) = material.with_parts().into_iter().find_map(plate) {
        return Some(describe_plate(plate, basis, &waves));
    }
    let films = films(material);
    let thickest = films.first().filter(|film| film.thickest)?;
    let read = |quantity, curve: &Curve| basis.tabulate(quantity, curve).bins().to_vec();
    let widest = thickest.stacks(&waves, read).iter().map(Stack::phase_step).fold(0.0, f64::max);
    let optical = thickest.optical_nm();
    let count = thickest.coating.layers.len();
    let layers = if count == 1 { "a layer".to_owned() } else { format!("{count} layers") };
    let how = if basis.fixed_lanes() <= 3 {
        format!("its light interferes {}", describe_three_bands(basis))
    } else if widest <= PHASE_STEP {
        "its light interferes at each lane's own wavelength".to_owned()
    } else if optical.iter().all(|&nm| nm <= COHERENT_NM) {
        "its light interferes over each lane's band of wavelengths".to_owned()
    } else {
        format!(
            "layers of an optical thickness above {COHERENT_NM} nm show interference only for emission lines, and the \
             mean over all phases otherwise"
        )
    };
    let total = optical.iter().sum::<f64>().round();
    Some(format!("{layers} of an optical thickness of up to {total} nm; {how}"))
}

/// Describes where three bands read what has fringes.
fn describe_three_bands(basis: &Basis) -> String {
    let [red, green, blue] = [0, 1, 2].map(|band| basis.wavelengths_nm()[band].round());
    format!("at {red}, {green} and {blue} nm only, as three bands have no other wavelengths")
}

fn describe_plate(plate: PathDifference, basis: &Basis, waves: &[[f64; 2]]) -> String {
    let widest = waves.iter().map(|wave| plate.phase_step(*wave)).fold(0.0, f64::max);
    let how = if basis.fixed_lanes() <= 3 {
        format!("its phase is that {}", describe_three_bands(basis))
    } else if widest <= PHASE_STEP {
        "its phase is that at each lane's own wavelength".to_owned()
    } else {
        "its phase is averaged over each lane's band of wavelengths, except for emission lines".to_owned()
    };
    format!("a retardation of {} nm; {how}", plate.nm)
}
