//! Rough glass: directions compared with their pdf, conservation of energy, and rendered images.
//!
//! ```text
//! cargo test --test all rough_glass::
//! ```

mod furnaces;
mod lamps;
mod sides;
mod weights;

use abbe::material::{FacetSides, RoughInterface};

/// Calls `check` with each index from outside and from inside, at each roughness and cosine.
fn for_each_boundary(
    roughnesses: &[f64],
    indices: &[f64],
    cosines: &[f64],
    mut check: impl FnMut(&FacetSides, [f64; 2], f64, &str),
) {
    for roughness in roughnesses {
        let interface = RoughInterface::new(roughness * roughness);
        for &index in indices {
            for indices in [[1.0, index], [index, 1.0]] {
                let sides = interface.between(indices[0], indices[1]);
                for &cos in cosines {
                    check(&sides, indices, cos, &format!("{indices:?}, roughness {roughness}, cos {cos}"));
                }
            }
        }
    }
}
