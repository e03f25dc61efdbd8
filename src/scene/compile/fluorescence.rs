//! Dyes in matte surfaces.

use super::spectrum_draft::{SpectrumDraft, spectrum};
use crate::material::{Diffuse, Fluorescence};
use crate::scene::text::{Fields, Value, six_digits};
use crate::spectrum::Curve;

pub(super) fn diffuse<'d>(fields: &mut Fields<'d>) -> Option<Diffuse<SpectrumDraft<'d>>> {
    let reflectance = spectrum(fields, "reflectance");
    let fluorescence = fields.maybe("fluorescence", |dye| Fields::read(dye, fluorescence))?;
    Some(Diffuse { reflectance, fluorescence })
}

fn fluorescence<'d>(fields: &mut Fields<'d>) -> Option<Fluorescence<SpectrumDraft<'d>>> {
    let [absorption, emission] = ["absorption", "emission"].map(|key| spectrum(fields, key));
    let help = "photons emitted per photon absorbed: 0.9 for most highlighters";
    let share = |value: Value| value.number_within(0.0..=1.0, "a quantum yield lies between 0 and 1", Some(help));
    let quantum_yield = fields.need("quantum_yield", share);
    Some(Fluorescence { absorption, emission, quantum_yield: quantum_yield? })
}

/// Returns where the absorption and the emission of a dye are written, if there is a dye.
pub(super) fn dye_values<'d>(diffuse: &Diffuse<SpectrumDraft<'d>>) -> Option<[Value<'d>; 2]> {
    let dye = diffuse.fluorescence.as_ref()?;
    match [dye.absorption, dye.emission] {
        [SpectrumDraft::Given(absorption), SpectrumDraft::Given(emission)] => Some([absorption, emission]),
        _ => None,
    }
}

/// Refuses a surface with a dye that returns more light than it receives.
pub(super) fn check_conservation(diffuse: &Diffuse<Curve>, [absorption, emission]: [Value; 2]) -> Option<()> {
    let Diffuse { reflectance, fluorescence: Some(dye) } = diffuse else { return Some(()) };
    let dye = dye.dye();
    if dye.quantum_yield > 0.0 && dye.power_per_nm() == 0.0 {
        return emission.refuse("the dye emits no light between 300 and 830 nm");
    }
    let shades = reflectance.representatives().into_iter().chain(reflectance.lightest());
    let Some(excess) = shades.into_iter().find_map(|shade| dye.energy_excess(&shade)) else { return Some(()) };
    let nm = excess.nm;
    if excess.used_share > 1.0 {
        let message = format!("reflectance and absorption add up to {} at {nm} nm", six_digits(excess.used_share));
        return absorption
            .advise(message, "they are shares of the same light: lower one of them until they add up to at most 1");
    }
    let message =
        format!("at {nm} nm, more power would leave than arrives: {} times as much", six_digits(excess.returned_share));
    absorption.advise(message, "a dye emits at longer wavelengths than it absorbs: end `absorption` below them")
}
