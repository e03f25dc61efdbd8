//! Adjacent bands of equal width, which a spectral image tells apart.

use serde::{Deserialize, Serialize};

use super::visible::{LAST_NM, START_NM};

/// Bands of wavelengths, each around its center.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct WavelengthBands {
    first_nm: f64,
    step_nm: f64,
    count: usize,
}

impl Default for WavelengthBands {
    /// Returns 81 bands of 5 nm, centered on 380 to 780 nm.
    fn default() -> Self {
        Self { first_nm: 380.0, step_nm: 5.0, count: 81 }
    }
}

impl WavelengthBands {
    /// Maximum number of bands of an image.
    pub const MAX_COUNT: usize = 1000;

    /// Creates bands whose centers lie `step_nm` apart, from `from_nm` to the last that is not beyond `to_nm`; `None`
    /// unless the step is positive and the number of bands is 1 to [`MAX_COUNT`](Self::MAX_COUNT).
    pub fn new(from_nm: f64, to_nm: f64, step_nm: f64) -> Option<Self> {
        // The last band still counts if only rounding of the ends puts it beyond `to_nm`.
        let rounding = 4.0 * f64::EPSILON * (from_nm.abs() + to_nm.abs());
        let steps = ((to_nm - from_nm + rounding) / step_nm).floor();
        let fits = step_nm > 0.0 && (0.0..Self::MAX_COUNT as f64).contains(&steps);
        fits.then(|| Self { first_nm: from_nm, step_nm, count: steps as usize + 1 })
    }

    /// Returns the number of bands.
    pub fn count(&self) -> usize {
        self.count
    }

    /// Returns the distance from center to center in nm, which is also the width of each band.
    pub fn step_nm(&self) -> f64 {
        self.step_nm
    }

    /// Returns the range of all bands in nm, cut to the grid on which light is known.
    pub fn range_nm(&self) -> [f64; 2] {
        let start = self.first_nm - 0.5 * self.step_nm;
        [start.max(START_NM), (start + self.count as f64 * self.step_nm).min(LAST_NM)]
    }

    /// Returns how much of a band, in nm, lies where light is known, on the [grid](super::visible).
    pub(super) fn known_nm(&self, band: usize) -> f64 {
        let middle = self.first_nm + band as f64 * self.step_nm;
        let [below, above] = [-0.5, 0.5].map(|half| middle + half * self.step_nm);
        let [from, to] = [below.max(START_NM), above.min(LAST_NM)];
        if [from, to] == [below, above] { self.step_nm } else { to - from }
    }

    /// Returns the centers in nm, ascending.
    pub fn centers_nm(&self) -> impl ExactSizeIterator<Item = f64> + use<> {
        let Self { first_nm, step_nm, count } = *self;
        (0..count).map(move |band| first_nm + band as f64 * step_nm)
    }

    /// Returns the band of a wavelength; between two bands, the upper one.
    pub(super) fn band_at(&self, wavelength_nm: f64) -> Option<usize> {
        let band = ((wavelength_nm - self.first_nm) / self.step_nm + 0.5).floor();
        (0.0..self.count as f64).contains(&band).then_some(band as usize)
    }

    /// Returns each band that overlaps the nm around a wavelength, and how much of the overlap lies where light is
    /// known.
    pub(super) fn around(&self, wavelength_nm: f64) -> impl Iterator<Item = (usize, f64)> + use<> {
        let Self { first_nm, step_nm, count } = *self;
        let start = first_nm - 0.5 * step_nm;
        let [from, to] = [(wavelength_nm - 0.5).max(START_NM), (wavelength_nm + 0.5).min(LAST_NM)];
        let at = |nm: f64| ((nm - start) / step_nm).floor().clamp(0.0, count as f64 - 1.0) as usize;
        (at(from)..=at(to)).filter_map(move |band| {
            let below = start + band as f64 * step_nm;
            let inside = to.min(below + step_nm) - from.max(below);
            (inside > 0.0).then_some((band, inside))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_nm_lies_in_bands_by_its_whole_width() {
        for (from, to, step) in [(380.0, 780.0, 5.0), (400.0, 700.0, 0.4), (390.0, 720.0, 7.3), (550.0, 550.0, 1.0)] {
            let bands = WavelengthBands::new(from, to, step).unwrap();
            let mut widths = vec![0.0; bands.count()];
            for nm in 300..=830 {
                bands.around(f64::from(nm)).for_each(|(band, width)| widths[band] += width);
            }
            assert!(widths.iter().all(|width| (width / step - 1.0).abs() < 1e-12), "{from} to {to} by {step}");
            let centers: Vec<f64> = bands.centers_nm().collect();
            assert!(centers.iter().enumerate().all(|(band, &nm)| bands.band_at(nm) == Some(band)));
            assert!(centers[centers.len() - 1] <= to + 1e-9 && centers[centers.len() - 1] + step > to);
        }
    }

    #[test]
    fn rounding_does_not_drop_the_last_band() {
        for tenths in 3000..8000_u32 {
            for (step, steps) in [(1, 2), (1, 5), (1, 500), (3, 7), (11, 50), (25, 4)] {
                let [from, to, step] = [tenths, tenths + step * steps, step].map(|tenth| f64::from(tenth) / 10.0);
                let bands = WavelengthBands::new(from, to, step).unwrap();
                assert_eq!(bands.count(), steps as usize + 1, "{from} to {to} by {step}");
                assert_eq!(WavelengthBands::new(from, to - 1e-9, step).unwrap().count(), steps as usize);
            }
        }
    }

    #[test]
    fn no_bands_or_too_many_bands_are_refused() {
        assert_eq!(WavelengthBands::new(380.0, 780.0, 5.0), Some(WavelengthBands::default()));
        assert!(WavelengthBands::new(780.0, 380.0, 5.0).is_none());
        assert!(WavelengthBands::new(380.0, 780.0, 0.0).is_none());
        assert!(WavelengthBands::new(380.0, 780.0, -5.0).is_none());
        assert!(WavelengthBands::new(380.0, 780.0, f64::NAN).is_none());
        assert!(WavelengthBands::new(380.0, 780.0, 0.01).is_none());
    }
}
