use super::visible;
use super::{ColorSpace, Curve, Emission, Quantity, Upsampler};

/// A dye, which absorbs light and emits it again at other wavelengths: fluorescence.
///
/// A photon absorbed at the wavelength i leaves at the wavelength o with the probability Q e(o) per nm. Q is the
/// quantum yield, and e is the dye's emission in photons, with integral 1. In terms of power this is Q a(i) e(o) i / o,
/// where a is the absorbed share: a matrix of rank 1 (Donaldson 1954, *Spectrophotometry of Fluorescent Pigments*).
#[derive(Clone, Debug, PartialEq)]
pub struct Dye {
    /// Share of the light that it absorbs, 0 to 1.
    pub absorption: Curve,
    /// Its emission, in power per nm on any scale.
    pub emission: Curve,
    /// Number of photons emitted for each that is absorbed, 0 to 1.
    pub quantum_yield: f64,
}

/// How brightly a dye shines under a light, as a factor on its emission.
#[derive(Clone, Debug)]
pub struct Excited {
    /// Contribution of each wavelength of the grid, per nm.
    pub smooth: Vec<f64>,
    /// Contribution of each ideal line: its wavelength in nm, and the factor.
    pub lines: Vec<[f64; 2]>,
}

impl Excited {
    /// Returns the contribution of the ideal lines at exactly a wavelength in nm.
    pub(super) fn by_line(&self, wavelength_nm: f64) -> f64 {
        self.lines.iter().filter(|line| line[0] == wavelength_nm).map(|line| line[1]).sum()
    }

    /// Returns the contributions of all parts of the light: first those of the grid, then the lines.
    pub fn parts(&self) -> impl Iterator<Item = f64> {
        self.smooth.iter().copied().chain(self.lines.iter().map(|line| line[1]))
    }
}

/// A dye with all values that are the same under every light.
#[derive(Clone, Debug)]
pub struct PreparedDye<'a> {
    dye: &'a Dye,
    /// Share of light that it absorbs, on the visible grid.
    absorbed: Vec<f64>,
    power_per_nm: f64,
    /// Total power that it emits, on the scale of flat spectra.
    shines: f64,
}

impl PreparedDye<'_> {
    /// Returns the dye.
    pub fn dye(&self) -> &Dye {
        self.dye
    }

    /// How brightly it shines under a light.
    pub fn by(&self, light: &Emission) -> Excited {
        let scale = if self.shines > 0.0 { self.power_per_nm * light.unit() / self.shines } else { 0.0 };
        let of = |nm: f64, absorbed: f64, light: f64| scale * nm * absorbed * light;
        let parts = visible::wavelengths().zip(&self.absorbed).zip(light.spectrum());
        let smooth = parts.map(|((nm, &absorbed), &light)| of(nm, absorbed, light)).collect();
        let absorbed = self.dye.absorbed();
        let lines = light.lines().iter().map(|&[nm, light]| [nm, of(nm, absorbed(nm), light)]).collect();
        Excited { smooth, lines }
    }
}

/// A wavelength at which a surface would return more light than it receives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyExcess {
    /// The wavelength of the light, in nm.
    pub nm: f64,
    /// Share of the light that is reflected, or absorbed by the dye.
    pub used_share: f64,
    /// Share of the light's power that is reflected or emitted again.
    pub returned_share: f64,
}

/// Tolerance for the rounded digits of curves.
const ROUNDING_TOLERANCE: f64 = 1e-9;

impl Dye {
    /// Returns the share of light that it absorbs at a wavelength in nm, 0 to 1.
    pub fn absorbed(&self) -> Box<dyn Fn(f64) -> f64 + '_> {
        self.absorption.values(Quantity::Excitation)
    }

    /// Returns the emitted power over the product of the absorbed power and its wavelength in nm: 1 / nm.
    pub fn power_per_nm(&self) -> f64 {
        self.power_of(&self.shines(ColorSpace::default()))
    }

    fn power_of(&self, shines: &Emission) -> f64 {
        let photons: f64 = visible::wavelengths().zip(shines.spectrum()).map(|(nm, power)| nm * power).sum();
        if photons > 0.0 { self.quantum_yield * shines.spectrum().iter().sum::<f64>() / photons } else { 0.0 }
    }

    /// Returns the first wavelength at which a surface with this reflectance would return more light than it receives.
    pub fn energy_excess(&self, reflectance: &Curve) -> Option<EnergyExcess> {
        let (upsampler, absorbed, power) =
            (Upsampler::new(ColorSpace::default()), self.absorbed(), self.power_per_nm());
        let reflected = reflectance.reader(Quantity::Reflectance, &upsampler);
        let at = |nm: f64| EnergyExcess {
            nm,
            used_share: reflected(nm) + absorbed(nm),
            returned_share: reflected(nm) + absorbed(nm) * power * nm,
        };
        visible::wavelengths()
            .map(at)
            .find(|found| found.used_share.max(found.returned_share) > 1.0 + ROUNDING_TOLERANCE)
    }

    /// Returns the light that it emits, for a film.
    pub fn shines(&self, space: ColorSpace) -> Emission {
        Emission::new(&self.emission, space)
    }

    /// Prepares the dye for lights: computes what is the same under all of them.
    pub fn prepared(&self) -> PreparedDye<'_> {
        let (shines, absorbed) = (self.shines(ColorSpace::default()), self.absorbed());
        let total = shines.spectrum().iter().sum::<f64>();
        PreparedDye {
            dye: self,
            absorbed: visible::wavelengths().map(absorbed).collect(),
            power_per_nm: self.power_of(&shines),
            shines: if total > 0.0 { total * shines.unit() } else { 0.0 },
        }
    }
}
