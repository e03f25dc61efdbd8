//! The emission of a light with its true colors: a spectrum on the visible grid, and ideal lines.

use super::color::{ColorSpace, Matrix, apply, weighted_sum};
use super::curve::interpolate;
use super::visible::{self, color_matching};
use super::{Curve, CurveKind, Quantity, Upsampler};

/// The emission of one curve, scaled so that sums with the color matching functions give film values.
#[derive(Clone, Debug, PartialEq)]
pub struct Emission {
    /// Power per nm, on the visible grid.
    spectrum: Vec<f64>,
    /// (wavelength in nm, power).
    lines: Vec<[f64; 2]>,
    /// Factors on XYZ that make the white of numbers and `rgb` exactly the film's.
    correction: [f64; 3],
    xyz_to_film: Matrix,
}

/// The film colors of a light, wavelength by wavelength.
#[derive(Clone, Debug)]
pub struct FilmColors {
    /// Wavelengths in nm.
    pub wavelengths_nm: Vec<f64>,
    columns: Vec<[f64; 3]>,
}

impl FilmColors {
    /// Returns the film color of the light, of which `transmitted` remains at each wavelength.
    pub fn color(&self, transmitted: &[f64]) -> [f64; 3] {
        weighted_sum(transmitted.iter().copied().zip(self.columns.iter().copied()))
    }
}

impl Emission {
    /// Creates the emission of a curve on a film.
    ///
    /// A flat spectrum of 1 has Y = 1, as have an illuminant and a blackbody by themselves. Numbers and `rgb` are
    /// multiples of the film's white.
    pub fn new(curve: &Curve, space: ColorSpace) -> Self {
        let curve = &*curve.level();
        let (mut lines, unit) = (Vec::new(), 1.0 / visible::y_integral());
        let plain = |power: &dyn Fn(f64) -> f64| (visible::wavelengths().map(power).collect(), [1.0; 3]);
        let (spectrum, correction): (Vec<f64>, _) = match &curve.kind {
            CurveKind::Number(level) => spectrum_of_color([*level; 3], space),
            CurveKind::Rgb(rgb) => spectrum_of_color(*rgb, space),
            CurveKind::Lines(pairs) => {
                lines = pairs.iter().map(|&[nm, power]| [nm, power * unit]).collect();
                plain(&|_| 0.0)
            }
            CurveKind::Samples(samples) => plain(&|nm| unit * on_grid(samples, nm)),
            kind => plain(&*kind.values(Quantity::Emission)),
        };
        let xyz_to_film = space.matrix_from_xyz().map(|row| std::array::from_fn(|i| row[i] * correction[i]));
        let mut emission = Self { spectrum, lines, correction, xyz_to_film };
        let luminance = emission.xyz()[1];
        let is_absolute =
            curve.kind.rgb().is_some() || matches!(curve.kind, CurveKind::Lines(_) | CurveKind::Samples(_));
        let factor = match curve.luminance {
            Some(wanted) if luminance > 0.0 => wanted / luminance,
            _ if luminance > 0.0 && !is_absolute => curve.scale / luminance,
            _ => curve.scale,
        };
        emission.spectrum.iter_mut().for_each(|power| *power *= factor);
        emission.lines.iter_mut().for_each(|line| line[1] *= factor);
        emission
    }

    /// Returns the spectrum, per nm on the visible grid, without the lines.
    pub fn spectrum(&self) -> &[f64] {
        &self.spectrum
    }

    /// Returns the ideal lines: (wavelength in nm, power).
    pub fn lines(&self) -> &[[f64; 2]] {
        &self.lines
    }

    /// Returns the factor from numbers of the spectrum to radiance, per nm and of lines, on the scale on which a flat
    /// spectrum of 1 is 1 and has Y = 1.
    pub(super) fn unit(&self) -> f64 {
        visible::y_integral() * self.correction[1]
    }

    /// Returns all of its power over the width of the visible range, on the scale on which a flat spectrum of 1 is 1
    /// per nm.
    pub(super) fn power(&self) -> f64 {
        self.total() * self.unit() / (visible::LAST_NM - visible::FIRST_NM)
    }

    fn total(&self) -> f64 {
        self.spectrum.iter().sum::<f64>() + self.lines.iter().map(|line| line[1]).sum::<f64>()
    }

    /// Returns the power of the ideal lines at exactly a wavelength.
    pub(super) fn power_of_line(&self, wavelength_nm: f64) -> f64 {
        self.lines.iter().filter(|line| line[0] == wavelength_nm).map(|line| line[1]).sum()
    }

    /// Returns its CIE XYZ.
    pub fn xyz(&self) -> [f64; 3] {
        let sum = self.uncorrected_xyz();
        std::array::from_fn(|i| sum[i] * self.correction[i])
    }

    /// Returns the number that stands for its brightness in every lane: its strongest film channel.
    pub(super) fn level(&self) -> f64 {
        f64::from(self.color().iter().fold(0.0, |most: f64, x| most.max(x.abs())) as f32)
    }

    /// Returns its film color.
    pub fn color(&self) -> [f64; 3] {
        apply(&self.xyz_to_film, self.uncorrected_xyz())
    }

    fn uncorrected_xyz(&self) -> [f64; 3] {
        let lines = self.lines.iter().map(|&[nm, power]| (power, color_matching(nm)));
        weighted_sum(self.spectrum.iter().copied().zip(visible::observer()).chain(lines))
    }

    /// Returns the film color of a power of 1 at a wavelength.
    pub fn film_color(&self, wavelength_nm: f64) -> [f64; 3] {
        apply(&self.xyz_to_film, color_matching(wavelength_nm))
    }

    /// Returns the film color per nm at each wavelength of the visible grid, without the lines.
    pub fn columns(&self) -> impl Iterator<Item = [f64; 3]> {
        self.spectrum
            .iter()
            .zip(visible::observer())
            .map(|(power, cmf)| apply(&self.xyz_to_film, cmf.map(|x| power * x)))
    }

    /// Returns its film colors: per nm at the wavelengths of the visible grid, and at its lines.
    pub fn film_colors(&self) -> FilmColors {
        let of_line = |&[nm, power]: &[f64; 2]| self.film_color(nm).map(|x| x * power);
        FilmColors {
            wavelengths_nm: visible::wavelengths().chain(self.lines.iter().map(|line| line[0])).collect(),
            columns: self.columns().chain(self.lines.iter().map(of_line)).collect(),
        }
    }

    /// Returns whether two lights look alike apart from a factor, to a part in a million.
    pub fn looks_like(&self, other: &Self) -> bool {
        self.xyz_to_film == other.xyz_to_film && self.is_proportional_to(other)
    }

    /// Returns whether two spectra are alike apart from a factor, whatever colors are made of them.
    pub fn is_proportional_to(&self, other: &Self) -> bool {
        let (a, b) = (self.total(), other.total());
        let same = |x: f64, y: f64| (x / a - y / b).abs() <= 1e-6;
        self.lines.len() == other.lines.len()
            && self.lines.iter().zip(&other.lines).all(|(x, y)| x[0] == y[0] && same(x[1], y[1]))
            && self.spectrum.iter().zip(&other.spectrum).all(|(&x, &y)| same(x, y))
    }
}

/// Returns the spectrum of a color on the grid, and the factors on XYZ that make white exactly the film's.
fn spectrum_of_color(rgb: [f64; 3], space: ColorSpace) -> (Vec<f64>, [f64; 3]) {
    let (mut spectrum, correction) = visible::white(space);
    let [r, g, b] = rgb;
    if r == g && g == b {
        spectrum.iter_mut().for_each(|power| *power *= r);
    } else {
        let brightest = 2.0 * r.max(g).max(b);
        let tint = Upsampler::new(space).fit(rgb.map(|x| x / brightest));
        spectrum.iter_mut().zip(visible::wavelengths()).for_each(|(power, nm)| *power *= brightest * tint.at(nm));
    }
    (spectrum, correction)
}

/// Reads a sampled emission on the grid, 0 beyond its ends. If samples lie between the steps of the grid, or if light
/// ends abruptly, each step gets the light around it, weighted by a hat function. Narrow lines then keep their power
/// wherever they peak, and no table gets wider than it is.
fn on_grid(samples: &[[f64; 2]], wavelength_nm: f64) -> f64 {
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else { return 0.0 };
    let at = |nm: f64| if (first[0]..=last[0]).contains(&nm) { interpolate(samples, nm) } else { 0.0 };
    // A table that is flat over the visible range has its full value in every step of it.
    let is_grid_end = |nm: f64| [visible::START_NM, visible::FIRST_NM, visible::LAST_NM].contains(&nm);
    let ends_abruptly = |end: &[f64; 2]| end[1] != 0.0 && !is_grid_end(end[0]) && (end[0] - wavelength_nm).abs() < 1.0;
    let is_end = |end: &[f64; 2]| end[0] == wavelength_nm && is_grid_end(end[0]);
    let is_on_steps = samples.iter().all(|sample| sample[0].fract() == 0.0);
    if [first, last].into_iter().any(is_end) || is_on_steps && ![first, last].into_iter().any(ends_abruptly) {
        return at(wavelength_nm);
    }
    let (from, to) = (wavelength_nm - 1.0, wavelength_nm + 1.0);
    let mut ends = vec![from, wavelength_nm, to];
    let begin = samples.partition_point(|sample| sample[0] <= from);
    ends.extend(samples[begin..].iter().map(|sample| sample[0]).take_while(|&nm| nm < to));
    ends.sort_by(f64::total_cmp);
    let hat_weighted = |nm: f64| at(nm) * (1.0 - (nm - wavelength_nm).abs());
    // Simpson's rule is exact: between two ends, both the light and the hat are linear.
    let part = |a: f64, b: f64| {
        let inside = |t: f64| hat_weighted(a + t * (b - a));
        // Evaluated just inside the ends, where an emission may begin or stop abruptly.
        (b - a) / 6.0 * (inside(1e-9) + 4.0 * inside(0.5) + inside(1.0 - 1e-9))
    };
    ends.windows(2).map(|pair| part(pair[0], pair[1])).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_even_table_has_the_light_of_its_width_wherever_it_ends() {
        for [from, to] in
            [[550.0, 560.0], [550.0, 551.0], [549.5, 560.5], [550.25, 560.0], [550.0, 550.5], [500.1, 600.7]]
        {
            let samples = [[from, 2.0], [to, 2.0]];
            let sum: f64 = visible::wavelengths().map(|nm| on_grid(&samples, nm)).sum();
            assert!((sum - 2.0 * (to - from)).abs() < 1e-6, "{from} to {to} nm: {sum}");
        }
        // A narrow line between the steps keeps its light, too.
        for [peak, width] in [[450.0, 1.0], [450.5, 1.0], [459.66, 1.3], [546.1, 1.7], [402.5, 2.5], [611.3, 4.2]] {
            let line = [[peak - width, 0.0], [peak, 3.0], [peak + width, 0.0]];
            let sum: f64 = visible::wavelengths().map(|nm| on_grid(&line, nm)).sum();
            assert!((sum - 3.0 * width).abs() < 1e-6, "{peak} nm: {sum} for {}", 3.0 * width);
        }
        let even = [[300.0, 2.0], [500.5, 2.0], [830.0, 2.0]];
        assert!(visible::wavelengths().all(|nm| (on_grid(&even, nm) - 2.0).abs() < 1e-12));
        // A table of whole wavelengths that ends at 0 has no jump: each step has the light at its wavelength.
        let peak = [[540.0, 0.0], [550.0, 1.0], [560.0, 0.0]];
        for nm in visible::wavelengths() {
            let expected = (1.0 - 0.1 * (nm - 550.0).abs()).max(0.0);
            assert!((on_grid(&peak, nm) - expected).abs() < 1e-12, "{nm} nm");
        }
    }
}
