//! Measured optical data, looked up by name. Written by `tools/tabulate.py`.

mod color;
mod glass;
mod metal;
mod rows;
#[cfg(test)]
mod tests;

pub use color::{Illuminant, Reflectance, color_matching, illuminant, illuminants, reflectance, reflectances};
pub use glass::{Formula, GLASS_MAKERS, Glass, bare, glass, glass_makers, glass_names, glasses, known_as};
pub use metal::{Metal, metal, metal_names, metals};

/// Linear between samples (x, values), flat beyond the ends.
pub(super) fn interpolate<const N: usize>(samples: &[[f64; N]], x: f64) -> [f64; N] {
    let after = samples.partition_point(|sample| sample[0] < x);
    if after == 0 {
        return samples[0];
    }
    let Some(high) = samples.get(after) else {
        return samples[samples.len() - 1];
    };
    let low = samples[after - 1];
    let t = (x - low[0]) / (high[0] - low[0]);
    std::array::from_fn(|i| low[i] + (high[i] - low[i]) * t)
}
