//! How interpolated lanes read a reflectance so that it has its true colors under the lights of a scene.

use serde::{Deserialize, Serialize};

use super::visible::{self, COUNT};

/// The projection of the spectrum of a reflectance or a transmittance onto lanes, by least squares.
///
/// Lanes that read a spectrum at their own wavelengths miss what lies in between. The projection finds the numbers
/// whose interpolation is closest to the spectrum, weighted by what light of each wavelength is worth to the eye and to
/// dyes. Among these, it takes those that have exactly the spectrum's color under each light, if there are enough lanes
/// for that. Light that meets several surfaces shows products of such spectra, which gain by being closest.
///
/// A spectrum within 0..1 is read as numbers within 0..1, and a flat one as its value.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Projection {
    /// Wavelengths in nm at which a spectrum is read in addition to those of the visible grid: ideal lines.
    lines_nm: Vec<f64>,
    /// Weight of each wavelength for each lane, by lane and wavelength.
    taken: Vec<Vec<f64>>,
    /// Weight of each lane's function for each lane: the matrix of the normal equations.
    gram: Vec<Vec<f64>>,
}

/// How the functions of all lanes share a wavelength, and what light there is worth.
pub(super) struct Part {
    /// The wavelength, in nm.
    pub(super) at_nm: f64,
    /// The share of each lane.
    pub(super) shares: Vec<f64>,
    /// Its worth to each measure, relative to all that the light is worth to it. A measure is CIE X, Y or Z under one
    /// light, or a dye that it excites.
    pub(super) worth: Vec<f64>,
}

/// Weight of what no measure sees, relative to all that they see, spread evenly over the lanes' wavelengths.
const UNSEEN_WEIGHT: f64 = 1e-3;
/// Weight of all wavelengths of the bands, spread evenly over them, if a spectral image is wanted. With more, edges in
/// spectra hardly come closer; with 1e-3 to 1, predicted colors of five gallery scenes are equally close.
const SHOWN_WEIGHT: f64 = 1.0;
/// Weight of a measure relative to that of all wavelengths, if it must be matched exactly.
const EXACT_WEIGHT: f64 = 1e5;
/// Weight of a measure if there are too many to match all exactly. Of weights from 0 to 1e5, it is close to the best
/// for one, two and four reflections by 123 measured colors under four lights in 8 to 32 lanes.
const BALANCED_WEIGHT: f64 = 10.0;

impl Projection {
    /// Creates the projection. `parts` holds the wavelengths of the visible grid, then ideal lines; `smooth` is the
    /// number of interpolated lanes, and `ends` are the first and last of their wavelengths in nm; `shown` are the
    /// limits of the bands that are wanted too.
    pub(super) fn new(parts: &[Part], smooth: usize, ends: [f64; 2], shown: Option<[f64; 2]>) -> Self {
        let (lanes, measures) = (parts[0].shares.len(), parts[0].worth.len());
        let measure_share = 1.0 / measures as f64;
        // Every exact measure uses up one of the lanes' numbers. Half of the numbers are left to come close.
        let measure_weight = measure_share * if 2 * measures <= smooth { EXACT_WEIGHT } else { BALANCED_WEIGHT };
        let even = |weight: f64, [first, last]: [f64; 2]| {
            move |at_nm: f64| if (first..=last).contains(&at_nm) { weight / (last - first + 1.0) } else { 0.0 }
        };
        let (unseen, shown) = (even(UNSEEN_WEIGHT, ends), shown.map(|shown| even(SHOWN_WEIGHT, shown)));
        let of_line = UNSEEN_WEIGHT / (ends[1] - ends[0] + 1.0);
        let mut taken = vec![vec![0.0; parts.len()]; lanes];
        for (number, part) in parts.iter().enumerate() {
            let seen_worth = measure_share * part.worth.iter().map(|x| x.abs()).sum::<f64>();
            let smooth = || unseen(part.at_nm) + shown.as_ref().map_or(0.0, |shown| shown(part.at_nm));
            let background = if number < COUNT { smooth() } else { of_line };
            taken
                .iter_mut()
                .zip(&part.shares)
                .for_each(|(lane, share)| lane[number] = (seen_worth + background) * share);
        }
        for measure in 0..measures {
            for (lane, taken) in taken.iter_mut().enumerate() {
                let weight =
                    measure_weight * parts.iter().map(|part| part.worth[measure] * part.shares[lane]).sum::<f64>();
                taken.iter_mut().zip(parts).for_each(|(taken, part)| *taken += weight * part.worth[measure]);
            }
        }
        let of_lane = |lane: usize| move |(taken, part): (&f64, &Part)| taken * part.shares[lane];
        let gram =
            taken.iter().map(|taken| (0..lanes).map(|j| taken.iter().zip(parts).map(of_lane(j)).sum()).collect());
        let gram = gram.collect();
        Self { lines_nm: parts[COUNT..].iter().map(|part| part.at_nm).collect(), taken, gram }
    }

    /// Returns the number of each lane, for a spectrum that can be read at any wavelength in nm.
    pub(super) fn read(&self, spectrum: &dyn Fn(f64) -> f64) -> Vec<f64> {
        let values: Vec<f64> = visible::wavelengths().chain(self.lines_nm.iter().copied()).map(spectrum).collect();
        if values.iter().all(|&x| x == values[0]) {
            return vec![values[0]; self.gram.len()];
        }
        let range = [values.iter().copied().fold(0.0, f64::min), values.iter().copied().fold(1.0, f64::max)];
        let taken = self.taken.iter().map(|taken| taken.iter().zip(&values).map(|(a, b)| a * b).sum());
        self.solve_within(range, taken.collect())
    }

    /// Returns the closest numbers within a range. Numbers beyond it are held at its end, and the others make up for
    /// what that misses.
    fn solve_within(&self, [low, high]: [f64; 2], taken: Vec<f64>) -> Vec<f64> {
        let mut held: Vec<Option<f64>> = vec![None; taken.len()];
        loop {
            let numbers = self.solve(&taken, &held);
            let mut exceeds = false;
            for (held, &number) in held.iter_mut().zip(&numbers) {
                if held.is_none() && !(low..=high).contains(&number) {
                    *held = Some(number.clamp(low, high));
                    exceeds = true;
                }
            }
            if !exceeds {
                return numbers;
            }
        }
    }

    /// Solves for the closest numbers, of which some are held, by Cholesky factorization of the normal equations.
    fn solve(&self, taken: &[f64], held: &[Option<f64>]) -> Vec<f64> {
        let free: Vec<usize> = (0..taken.len()).filter(|&lane| held[lane].is_none()).collect();
        let held_sum = |lane: usize| held.iter().zip(&self.gram[lane]).map(|(x, g)| x.unwrap_or(0.0) * g).sum::<f64>();
        let mut numbers: Vec<f64> = held.iter().map(|x| x.unwrap_or(0.0)).collect();
        let mut factor = vec![vec![0.0; free.len()]; free.len()];
        let mut rhs = vec![0.0; free.len()];
        for i in 0..free.len() {
            for j in 0..=i {
                let partial_sum: f64 = (0..j).map(|k| factor[i][k] * factor[j][k]).sum();
                let left = self.gram[free[i]][free[j]] - partial_sum;
                factor[i][j] = if i == j { left.sqrt() } else { left / factor[j][j] };
            }
            let partial_sum: f64 = (0..i).map(|k| factor[i][k] * rhs[k]).sum();
            rhs[i] = (taken[free[i]] - held_sum(free[i]) - partial_sum) / factor[i][i];
        }
        for i in (0..free.len()).rev() {
            let partial_sum: f64 = (i + 1..free.len()).map(|k| factor[k][i] * numbers[free[k]]).sum();
            numbers[free[i]] = (rhs[i] - partial_sum) / factor[i][i];
        }
        numbers
    }
}
