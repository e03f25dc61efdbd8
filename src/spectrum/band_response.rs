use std::sync::Arc;

use super::draw::Hero;
use super::visible::{COUNT, START_NM};
use super::{Draw, Lanes, WavelengthBands};

/// What each lane of one light is to bands of wavelengths: radiance per nm, on the scale on which an even spectrum of 1
/// is 1 in every band.
///
/// It is to a spectral image what [`Response`](super::Response) is to red, green and blue: light times the functions of
/// the lanes, integrated exactly, so that narrow lines of a light stay as narrow as the bands.
#[derive(Clone, Debug, PartialEq)]
pub struct BandResponse {
    bands: WavelengthBands,
    /// Lane by lane, the mean over each band of a lane of 1.
    columns: Arc<[f64]>,
    /// The same light per nm at each entry of the fine grid; of ideal lines, all of it.
    fine: Arc<[f64]>,
    /// Where those lines are, in nm.
    lines_nm: Arc<[f64]>,
}

impl BandResponse {
    pub(super) fn new(bands: WavelengthBands, columns: Vec<f64>, fine: Vec<f64>, lines_nm: &[f64]) -> Self {
        assert!(columns.len().is_multiple_of(bands.count()));
        Self { bands, columns: columns.into(), fine: fine.into(), lines_nm: lines_nm.into() }
    }

    /// Adds sums of fixed lanes, while lanes were together, to the bands.
    pub fn add_fixed(&self, lanes: &[f64], bands: &mut [f64]) {
        for (lane, column) in lanes.iter().zip(self.columns.chunks_exact(self.bands.count())) {
            if *lane != 0.0 {
                bands.iter_mut().zip(column).for_each(|(sum, one)| *sum += lane * one);
            }
        }
    }

    /// Whether heroes carry light that arrives in lanes; `found` gets the band and the light of each.
    pub fn heroes<const N: usize>(
        &self,
        draw: &Draw<N>,
        lanes: &Lanes<N>,
        parted: bool,
        mut found: impl FnMut(usize, f64),
    ) -> bool {
        let Some(heroes) = draw.carrying(lanes, parted) else { return false };
        for (_, hero, weight) in heroes {
            if let Some((band, light)) = self.hero(hero, weight) {
                found(band, light);
            }
        }
        true
    }

    /// The band of a hero of some weight, and the light it brings there.
    pub(super) fn hero(&self, hero: &Hero, weight: f64) -> Option<(usize, f64)> {
        let nm = match hero.below.checked_sub(COUNT) {
            Some(line) => self.lines_nm[line],
            None => START_NM + hero.below as f64 + hero.fraction,
        };
        let band = self.bands.of(nm)?;
        let (a, b) = (self.fine[hero.below], self.fine[hero.below + 1]);
        Some((band, weight * (a + hero.fraction * (b - a)) / self.bands.known_nm(band)))
    }
}
