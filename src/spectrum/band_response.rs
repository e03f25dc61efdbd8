use std::sync::Arc;

use super::draw::Hero;
use super::visible::{COUNT, START_NM};
use super::{Draw, Lanes, WavelengthBands};

/// The contribution of each lane of one light to bands of wavelengths: radiance per nm, on the scale on which a flat
/// spectrum of 1 is 1 in every band.
///
/// It does for spectral images what [`Response`](super::Response) does for red, green and blue: it integrates the light
/// times the functions of the lanes exactly, so that narrow lines of a light stay as narrow as the bands.
#[derive(Clone, Debug, PartialEq)]
pub struct BandResponse {
    bands: WavelengthBands,
    /// Lane by lane, the mean over each band for a lane value of 1.
    columns: Arc<[f64]>,
    /// Light per nm at each entry of the fine grid. For ideal lines, all of their light.
    fine: Arc<[f64]>,
    /// Wavelengths of the ideal lines, in nm.
    lines_nm: Arc<[f64]>,
}

impl BandResponse {
    pub(super) fn new(bands: WavelengthBands, columns: Vec<f64>, fine: Vec<f64>, lines_nm: &[f64]) -> Self {
        assert!(columns.len().is_multiple_of(bands.count()));
        Self { bands, columns: columns.into(), fine: fine.into(), lines_nm: lines_nm.into() }
    }

    /// Adds sums of fixed lanes that never parted to the bands.
    pub fn add_fixed(&self, lanes: &[f64], bands: &mut [f64]) {
        for (lane, column) in lanes.iter().zip(self.columns.chunks_exact(self.bands.count())) {
            if *lane != 0.0 {
                bands.iter_mut().zip(column).for_each(|(sum, one)| *sum += lane * one);
            }
        }
    }

    /// Returns whether heroes carry the light that arrives in `lanes`. If so, `visit` gets the band and the light of
    /// each.
    pub fn visit_hero_bands<const N: usize>(
        &self,
        draw: &Draw<N>,
        lanes: &Lanes<N>,
        parted: bool,
        mut visit: impl FnMut(usize, f64),
    ) -> bool {
        let Some(heroes) = draw.carrying_heroes(lanes, parted) else { return false };
        for (_, hero, weight) in heroes {
            if let Some((band, light)) = self.hero(hero, weight) {
                visit(band, light);
            }
        }
        true
    }

    /// Returns the band of a hero of this weight, and the light that it contributes there.
    pub(super) fn hero(&self, hero: &Hero, weight: f64) -> Option<(usize, f64)> {
        let nm = match hero.below.checked_sub(COUNT) {
            Some(line) => self.lines_nm[line],
            None => START_NM + hero.below as f64 + hero.fraction,
        };
        let band = self.bands.band_at(nm)?;
        let (a, b) = (self.fine[hero.below], self.fine[hero.below + 1]);
        Some((band, weight * (a + hero.fraction * (b - a)) / self.bands.known_nm(band)))
    }
}
