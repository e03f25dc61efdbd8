//! Finds lights of different spectra.

use std::collections::HashMap;

use crate::spectrum::{ColorSpace, Curve, CurveCache, Emission, visible};

/// Steps of the spectrum by which lights are told apart at a glance.
const COARSE_STEPS: usize = 24;

/// Returns a light's spectrum in coarse steps, whose sum is 1.
fn coarse_spectrum(emission: &Emission) -> [f64; COARSE_STEPS] {
    let mut steps = [0.0; COARSE_STEPS];
    let count = visible::COUNT as f64;
    let step = |nm: f64| (((nm - visible::START_NM) / count * COARSE_STEPS as f64) as usize).min(COARSE_STEPS - 1);
    visible::wavelengths().zip(emission.spectrum()).for_each(|(nm, power)| steps[step(nm)] += power);
    emission.lines().iter().for_each(|&[nm, power]| steps[step(nm)] += power);
    let total: f64 = steps.iter().sum();
    if total > 0.0 { steps.map(|x| x / total) } else { steps }
}

/// Returns the lights of different spectra, and which of them each curve is.
pub(super) fn distinct_lights<'a>(
    curves: impl Iterator<Item = &'a Curve>,
    space: ColorSpace,
) -> (Vec<(Curve, Emission)>, Vec<usize>) {
    let mut distinct: Vec<(Curve, Emission)> = Vec::new();
    let mut alike: HashMap<[i64; COARSE_STEPS], Vec<usize>> = HashMap::new();
    // Thousands of lamps often have the same curve: no spectrum need be computed to see that.
    let mut distinct_curves = CurveCache::default();
    let number = |curve: &'a Curve| {
        distinct_curves.of(curve, |curve| {
            let emission = Emission::new(curve, space);
            let alike = alike.entry(coarse_spectrum(&emission).map(|x| (x * 1e6).round() as i64)).or_default();
            if let Some(&number) = alike.iter().find(|&&number| distinct[number].1.looks_like(&emission)) {
                return number;
            }
            alike.push(distinct.len());
            distinct.push((curve.clone(), emission));
            distinct.len() - 1
        })
    };
    let numbers = curves.map(number).collect();
    (distinct, numbers)
}

/// Chooses at most `max_count` of the lights, each as far as possible from all before it.
pub(super) fn farthest_apart(lights: &[(Curve, Emission)], max_count: usize) -> Vec<usize> {
    if lights.len() <= max_count {
        return (0..lights.len()).collect();
    }
    let coarse_spectra: Vec<[f64; COARSE_STEPS]> =
        lights.iter().map(|(_, emission)| coarse_spectrum(emission)).collect();
    let mut distances = vec![f64::INFINITY; lights.len()];
    let (mut chosen, mut next) = (Vec::new(), 0);
    while chosen.len() < max_count {
        chosen.push(next);
        for (distance, other) in distances.iter_mut().zip(&coarse_spectra) {
            let difference = other.iter().zip(&coarse_spectra[next]).map(|(a, b)| (a - b).abs()).sum();
            *distance = distance.min(difference);
        }
        next = (0..lights.len()).max_by(|&a, &b| distances[a].total_cmp(&distances[b])).unwrap_or(0);
    }
    chosen
}
