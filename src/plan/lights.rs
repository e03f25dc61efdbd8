//! Finds lights of different spectra.

use std::collections::HashMap;

use crate::spectrum::{ColorSpace, Curve, Distinct, Emission, visible};

/// Steps of the spectrum by which lights are told apart at a glance.
const GLANCE: usize = 24;

/// Returns a light's spectrum in coarse steps, whose sum is 1.
fn glance(emission: &Emission) -> [f64; GLANCE] {
    let mut steps = [0.0; GLANCE];
    let count = visible::COUNT as f64;
    let step = |nm: f64| (((nm - visible::START_NM) / count * GLANCE as f64) as usize).min(GLANCE - 1);
    visible::wavelengths().zip(emission.spectrum()).for_each(|(nm, power)| steps[step(nm)] += power);
    emission.lines().iter().for_each(|&[nm, power]| steps[step(nm)] += power);
    let total: f64 = steps.iter().sum();
    if total > 0.0 { steps.map(|x| x / total) } else { steps }
}

/// Returns the lights of different spectra, and which of them each curve is.
pub(super) fn different<'a>(
    curves: impl Iterator<Item = &'a Curve>,
    space: ColorSpace,
) -> (Vec<(Curve, Emission)>, Vec<usize>) {
    let mut known: Vec<(Curve, Emission)> = Vec::new();
    let mut alike: HashMap<[i64; GLANCE], Vec<usize>> = HashMap::new();
    // Thousands of lamps often have the same curve: no spectrum need be computed to see that.
    let mut looked_at = Distinct::default();
    let number = |curve: &'a Curve| {
        looked_at.of(curve, |curve| {
            let emission = Emission::new(curve, space);
            let alike = alike.entry(glance(&emission).map(|x| (x * 1e6).round() as i64)).or_default();
            if let Some(&number) = alike.iter().find(|&&number| known[number].1.looks_like(&emission)) {
                return number;
            }
            alike.push(known.len());
            known.push((curve.clone(), emission));
            known.len() - 1
        })
    };
    let numbers = curves.map(number).collect();
    (known, numbers)
}

/// Chooses at most `most` of the lights, each as far as possible from all before it.
pub(super) fn farthest_apart(lights: &[(Curve, Emission)], most: usize) -> Vec<usize> {
    if lights.len() <= most {
        return (0..lights.len()).collect();
    }
    let glances: Vec<[f64; GLANCE]> = lights.iter().map(|(_, emission)| glance(emission)).collect();
    let mut distances = vec![f64::INFINITY; lights.len()];
    let (mut chosen, mut next) = (Vec::new(), 0);
    while chosen.len() < most {
        chosen.push(next);
        for (distance, other) in distances.iter_mut().zip(&glances) {
            let apart = other.iter().zip(&glances[next]).map(|(a, b)| (a - b).abs()).sum();
            *distance = distance.min(apart);
        }
        next = (0..lights.len()).max_by(|&a, &b| distances[a].total_cmp(&distances[b])).unwrap_or(0);
    }
    chosen
}
