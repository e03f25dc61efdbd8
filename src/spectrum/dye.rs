use super::visible;
use super::{ColorSpace, Curve, Emission, Quantity, Upsampler};

/// What a surface absorbs and shines again at other wavelengths: fluorescence.
///
/// Of a photon absorbed at the wavelength i, a photon leaves at the wavelength o by a chance of Q e(o) per nm, with Q
/// the quantum yield and e the dye's emission in photons, of integral 1. Of power it is Q a(i) e(o) i / o, with a the
/// share that is absorbed: a matrix of rank 1 (Donaldson 1954, *Spectrophotometry of Fluorescent Pigments*).
#[derive(Clone, Debug, PartialEq)]
pub struct Dye {
    /// The share of the light that it absorbs, 0 to 1.
    pub absorption: Curve,
    /// What it shines, in power per nm on any scale.
    pub emission: Curve,
    /// How many photons leave of one that is absorbed, 0 to 1.
    pub quantum_yield: f64,
}

/// How brightly a dye shines under a light, as a factor on its emission.
#[derive(Clone, Debug)]
pub struct Excited {
    /// What each wavelength of the grid adds, per nm.
    pub smooth: Vec<f64>,
    /// What each ideal line adds: its wavelength in nm, and the factor.
    pub lines: Vec<[f64; 2]>,
}

impl Excited {
    /// What the ideal lines at exactly a wavelength in nm add.
    pub(super) fn by_line(&self, wavelength_nm: f64) -> f64 {
        self.lines.iter().filter(|line| line[0] == wavelength_nm).map(|line| line[1]).sum()
    }

    /// What all parts of the light add: first those of the grid, then the lines.
    pub fn parts(&self) -> impl Iterator<Item = f64> {
        self.smooth.iter().copied().chain(self.lines.iter().map(|line| line[1]))
    }
}

/// A dye with all that is the same under every light.
#[derive(Clone, Debug)]
pub struct Excitable<'a> {
    dye: &'a Dye,
    /// The share of light that it absorbs, on the visible grid.
    absorbed: Vec<f64>,
    power_per_nm: f64,
    /// All that it shines, as power on the scale of even spectra.
    shines: f64,
}

impl Excitable<'_> {
    /// The dye.
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

/// Where a surface would give back more light than it gets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyExcess {
    /// The wavelength of the light, in nm.
    pub nm: f64,
    /// The share of it that is reflected or absorbed by the dye.
    pub taken: f64,
    /// The share of its power that is reflected or shines again.
    pub given: f64,
}

/// What the digits of curves may add up to.
const ROUNDED: f64 = 1e-9;

impl Dye {
    /// The share of light that it absorbs at a wavelength in nm, 0 to 1.
    pub fn absorbed(&self) -> Box<dyn Fn(f64) -> f64 + '_> {
        self.absorption.values(Quantity::Excitation)
    }

    /// Power that it shines, over that which it absorbs times the wavelength in nm at which it does: 1 / nm.
    pub fn power_per_nm(&self) -> f64 {
        self.power_of(&self.shines(ColorSpace::default()))
    }

    fn power_of(&self, shines: &Emission) -> f64 {
        let photons: f64 = visible::wavelengths().zip(shines.spectrum()).map(|(nm, power)| nm * power).sum();
        if photons > 0.0 { self.quantum_yield * shines.spectrum().iter().sum::<f64>() / photons } else { 0.0 }
    }

    /// The first wavelength at which a surface of a reflectance would give back more light than it gets.
    pub fn excess(&self, reflectance: &Curve) -> Option<EnergyExcess> {
        let (upsampler, absorbed, power) =
            (Upsampler::new(ColorSpace::default()), self.absorbed(), self.power_per_nm());
        let reflected = reflectance.reader(Quantity::Reflectance, &upsampler);
        let at = |nm: f64| EnergyExcess {
            nm,
            taken: reflected(nm) + absorbed(nm),
            given: reflected(nm) + absorbed(nm) * power * nm,
        };
        visible::wavelengths().map(at).find(|found| found.taken.max(found.given) > 1.0 + ROUNDED)
    }

    /// The light that it shines, for a film.
    pub fn shines(&self, space: ColorSpace) -> Emission {
        Emission::new(&self.emission, space)
    }

    /// It as lights excite it.
    pub fn excitable(&self) -> Excitable<'_> {
        let (shines, absorbed) = (self.shines(ColorSpace::default()), self.absorbed());
        let total = shines.spectrum().iter().sum::<f64>();
        Excitable {
            dye: self,
            absorbed: visible::wavelengths().map(absorbed).collect(),
            power_per_nm: self.power_of(&shines),
            shines: if total > 0.0 { total * shines.unit() } else { 0.0 },
        }
    }
}
