//! Colors of images as spectra.

use super::{Curve, CurveKind, Lanes, Table};

/// The largest numbers of the lattice's colors.
const LEVELS: [f32; 3] = [0.5, 0.8, 1.0];
/// The smallest number of a color divided by its largest. Beyond the last ratio, there is only gray.
const DISTANCES: [f32; 2] = [0.0, 0.2];

/// Returns spectra of a lattice of colors, from which the spectrum of any color is interpolated: no texel of an image
/// needs a fit of its own.
///
/// The lattice has the six hues (1, s, s) and (1, 1, s), at a few distances s from gray and a few levels of brightness.
/// For each, a smooth reflectance with exactly this color is fitted. Any other color is a sum of those around it, with
/// weights that are linear in the color. Its spectrum therefore has exactly its color, stays within 0..1, and is flat
/// if the color is gray. With one distance and one level, this is Smits 1999, *An RGB-to-Spectrum Conversion for
/// Reflectances*. But fully saturated colors as bright as white have steep edges, which 16 lanes miss by 3 %, while
/// sums of more moderate colors are as smooth as a fit.
///
/// The order is by level, distance from gray and hue: red, green, blue, then what lacks red, green, blue. `tabulate`
/// reads a transmittance.
pub(super) fn palette(tabulate: impl Fn(&Curve) -> Table) -> Vec<Table> {
    let mut tints = Vec::new();
    for level in LEVELS {
        for distance in DISTANCES {
            for hue in 0..6 {
                let most = |channel: usize| if hue < 3 { channel == hue } else { channel != hue - 3 };
                let number = |channel| f64::from(if most(channel) { level } else { level * distance });
                let curve = CurveKind::Rgb([0, 1, 2].map(number)).into();
                tints.push(tabulate(&curve));
            }
        }
    }
    tints
}

/// Returns the factor on white that has a color. If `bounded`, no lane exceeds 1 where no number of the color does.
#[inline]
pub(super) fn tint_factor<const N: usize>(
    palette: &[Table],
    read: impl Fn(&Table) -> Lanes<N>,
    color: [f32; 3],
    bounded: bool,
) -> Lanes<N> {
    let (mut strongest, mut weakest) = (0, 0);
    for channel in 1..3 {
        strongest = if color[channel] > color[strongest] { channel } else { strongest };
        weakest = if color[channel] <= color[weakest] { channel } else { weakest };
    }
    let (most, least) = (color[strongest], color[weakest]);
    if most == least {
        return Lanes::ONE * most;
    }
    let middle = color[3 - strongest - weakest];
    // How far the hue lies from the strongest color alone toward the one that lacks the weakest.
    let hue = (middle - least) / (most - least);
    let ratio = least / most;
    let shape = |level: usize, distance: usize, amount: f32| {
        let tint = |hue: usize, amount: f32| read(&palette[(level * 2 + distance) * 6 + hue]) * amount;
        let mut sum = tint(strongest, amount * (1.0 - hue));
        if hue > 0.0 {
            sum += tint(3 + weakest, amount * hue);
        }
        sum
    };
    let at_level = |level: usize, amount: f32| {
        let edge = DISTANCES[1];
        if ratio < edge {
            let toward = ratio / edge;
            shape(level, 0, amount * (1.0 - toward)) + shape(level, 1, amount * toward)
        } else {
            let toward = (ratio - edge) / (1.0 - edge);
            shape(level, 1, amount * (1.0 - toward)) + Lanes::ONE * (amount * toward * LEVELS[level])
        }
    };
    if !bounded || most <= LEVELS[0] {
        return at_level(0, most / LEVELS[0]);
    }
    let lower = usize::from(most > LEVELS[1]);
    let toward = (most - LEVELS[lower]) / (LEVELS[lower + 1] - LEVELS[lower]);
    at_level(lower, 1.0 - toward) + at_level(lower + 1, toward)
}
