//! What camera samples contribute to the bands of a spectral image.
//!
//! Lanes are summed over all samples of a pixel, and are distributed over the bands once for all of them.

use super::received_light::{ReceivedLight, SourceId};
use crate::scene::Scene;
use crate::spectrum::visible::{EFFICACY, y_integral};
use crate::spectrum::{BandResponse, Basis, Curve, CurveCache, Lanes, WavelengthBands};

/// The bands of a spectral image, and how the lanes of each light contribute to them.
#[derive(Clone, Debug)]
pub(super) struct Spectrum {
    pub(super) bands: WavelengthBands,
    /// Whether S1, S2 and S3 of each band are requested.
    pub(super) has_stokes: bool,
    /// Where their sums begin in a row: first those of all bands, then those of each other component.
    pub(super) offset: usize,
    /// The spectral radiance of a sum of 1: 1, or in W m^-2 sr^-1 nm^-1 if the scene's light is absolute.
    pub(super) unit: f64,
    /// For each source of light, the number of its response.
    response_of: Vec<usize>,
    responses: Vec<BandResponse>,
}

impl Spectrum {
    /// Returns `None` if lanes are not wavelengths.
    pub(super) fn new(scene: &Scene<Curve>, basis: &Basis, bands: WavelengthBands, offset: usize) -> Option<Self> {
        let (mut distinct, mut responses) = (CurveCache::default(), Vec::new());
        let mut response_of = Vec::new();
        let dyes = scene.materials.iter().flat_map(|named| named.material.dyes());
        for source in scene.lights.iter().map(|light| light.emission()).chain(dyes.map(|dye| &dye.emission)) {
            response_of.push(distinct.of(source, |curve| {
                responses.push(basis.band_response(curve, bands));
                responses.len() - 1
            }));
        }
        let responses = responses.into_iter().collect::<Option<_>>()?;
        // In absolute light, a flat spectrum of this radiance has the luminance of white.
        let unit = scene.format.white_luminance.map_or(1.0, |white| white / (EFFICACY * y_integral()));
        Some(Self { bands, has_stokes: scene.format.has_stokes(), offset, unit, response_of, responses })
    }

    /// Returns the number of values in a row.
    pub(super) fn row_len(&self) -> usize {
        self.components() * self.bands.count()
    }

    fn components(&self) -> usize {
        if self.has_stokes { 4 } else { 1 }
    }

    /// Returns how a source's lanes contribute to the bands.
    pub(super) fn response(&self, source: SourceId) -> &BandResponse {
        &self.responses[self.response_of[source]]
    }

    /// Returns light in all bands, times a factor, and its S1, S2 and S3, given as parts of it, if they are requested.
    pub(super) fn band_values<const N: usize>(
        &self,
        received: &ReceivedLight<N>,
        stokes: Option<&[Lanes<N>; 3]>,
        factor: f64,
    ) -> Vec<f64> {
        let ReceivedLight { source, draw, lanes, parted } = *received;
        let (response, mut all) = (self.response(source), vec![0.0; self.row_len()]);
        for (lanes, bands) in self.parts(lanes, stokes).zip(all.chunks_exact_mut(self.bands.count())) {
            if !response.visit_hero_bands(draw, &lanes, parted, |band, light| bands[band] += factor * light) {
                response.add_fixed(&lanes.0.map(|lane| factor * f64::from(lane)), bands);
            }
        }
        all
    }

    /// Returns the lanes of each component.
    fn parts<const N: usize>(
        &self,
        lanes: &Lanes<N>,
        stokes: Option<&[Lanes<N>; 3]>,
    ) -> impl Iterator<Item = Lanes<N>> {
        let others = stokes.filter(|_| self.has_stokes).into_iter().flatten();
        std::iter::once(*lanes).chain(others.map(|part| *lanes * *part))
    }
}

/// What one camera sample after another contributes to the bands.
pub(super) struct SpectrumSample<'a, const N: usize> {
    spectrum: &'a Spectrum,
    /// Light of the current sample: lanes that never parted, with the number of their component and response and a
    /// factor; and light of single wavelengths, with the number of its component and band.
    unparted: Vec<(usize, Lanes<N>, f64)>,
    single: Vec<(usize, f64)>,
    /// Sums over the samples that were kept: those that are added, and those that are subtracted.
    sums: [SpectrumSums<N>; 2],
}

/// Sums over samples, one component after another: lanes by their response, and bands.
#[derive(Clone)]
struct SpectrumSums<const N: usize> {
    lanes: Vec<[f64; N]>,
    bands: Vec<f64>,
}

impl<'a, const N: usize> SpectrumSample<'a, N> {
    pub(super) fn new(spectrum: &'a Spectrum) -> Self {
        let lanes = vec![[0.0; N]; spectrum.components() * spectrum.responses.len()];
        let nothing = SpectrumSums { lanes, bands: vec![0.0; spectrum.row_len()] };
        Self { spectrum, unparted: Vec::new(), single: Vec::new(), sums: [nothing.clone(), nothing] }
    }

    /// Begins another sample.
    pub(super) fn begin(&mut self) {
        self.unparted.clear();
        self.single.clear();
    }

    /// Receives light, times a factor, with its S1, S2 and S3 as parts of it.
    pub(super) fn receive(&mut self, received: &ReceivedLight<N>, stokes: Option<&[Lanes<N>; 3]>, factor: f64) {
        let Self { spectrum, unparted, single, .. } = self;
        let ReceivedLight { source, draw, lanes, parted } = *received;
        for (component, lanes) in spectrum.parts(lanes, stokes).enumerate() {
            let first_band = component * spectrum.bands.count();
            let found = |band, light| single.push((first_band + band, factor * light));
            if !spectrum.response(source).visit_hero_bands(draw, &lanes, parted, found) {
                let response = component * spectrum.responses.len() + spectrum.response_of[source];
                unparted.push((response, lanes, factor));
            }
        }
    }

    /// Receives a component of light of a single wavelength: its band, if it falls into any, and its amount.
    pub(super) fn receive_single(&mut self, component: usize, found: Option<(usize, f64)>) {
        if component < self.spectrum.components() {
            let first_band = component * self.spectrum.bands.count();
            self.single.extend(found.map(|(band, light)| (first_band + band, light)));
        }
    }

    /// Returns how a source's lanes contribute to the bands.
    pub(super) fn response(&self, source: SourceId) -> &'a BandResponse {
        self.spectrum.response(source)
    }

    /// Keeps what the sample has received, to be added or subtracted.
    pub(super) fn keep(&mut self, is_subtracted: bool) {
        let SpectrumSums { lanes: sums, bands } = &mut self.sums[usize::from(is_subtracted)];
        for (response, lanes, factor) in self.unparted.drain(..) {
            let sums = sums[response].iter_mut().zip(lanes.0);
            sums.for_each(|(sum, lane)| *sum += factor * f64::from(lane));
        }
        self.single.drain(..).for_each(|(band, light)| bands[band] += light);
    }

    /// Adds everything that was kept to rows of sums, and resets it. If nothing is subtracted, the second may be empty.
    pub(super) fn add_sums_to(&mut self, rows: [&mut [f64]; 2]) {
        let Self { spectrum, sums: kept, .. } = self;
        for (row, kept) in rows.into_iter().zip(kept).filter(|(row, _)| !row.is_empty()) {
            let row = &mut row[spectrum.offset..][..kept.bands.len()];
            let components = kept.lanes.chunks_exact_mut(spectrum.responses.len().max(1));
            for (bands, lanes) in row.chunks_exact_mut(spectrum.bands.count()).zip(components) {
                for (response, lanes) in spectrum.responses.iter().zip(lanes) {
                    response.add_fixed(&std::mem::replace(lanes, [0.0; N]), bands);
                }
            }
            row.iter_mut().zip(&mut kept.bands).for_each(|(sum, light)| *sum += std::mem::take(light));
        }
    }
}
