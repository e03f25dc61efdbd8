//! The white furnace: under a sky of 1, whatever reflects or transmits all light shows 1, at every roughness, index and
//! angle. Prints a table of the lowest and highest values of each material.
//!
//! ```text
//! cargo test --release --test all white_furnace:: -- --nocapture
//! ```

use abbe::material::{Index, Lobes, Material, ScatterContext};
use abbe::spectrum::{Draw, Table};

use crate::support::materials::{self, LOSSLESS, context, direction_at, material};

const ROUGHNESSES: [f64; 7] = [0.0, 0.05, 0.2, 0.4, 0.6, 0.8, 1.0];
const INDICES: [f64; 5] = [1.1, 1.33, 1.52, 1.9, 2.5];
const COSINES: [f64; 10] = [0.001, 0.01, 0.04, 0.1, 0.2, 0.35, 0.5, 0.7, 0.9, 1.0];
const DRAWS: u32 = 1 << 14;

/// Returns what a surface between two media shows of a uniform sky, where radiance over n^2 is 1 everywhere. The second
/// result is, for glass, how far noise may move it.
///
/// A rough boundary is sampled with more than the two evenly spread numbers. The noise of the others is judged by its
/// spread.
fn furnace(material: &Material<Table>, indices: [f64; 2], cos: f64) -> [f64; 2] {
    let draw = Draw::<4>::fixed(3);
    let context =
        ScatterContext { beyond: Index::Same(indices[1]), ..context(&draw, direction_at(cos, 0.4), indices[0]) };
    let [[shown, error], ..] = materials::furnace(material, &context, DRAWS);
    [shown, if material.lobes().intersects(Lobes::GLOSSY_TRANSMISSION) { 3.0 * error } else { 0.0 }]
}

/// The name in the table, a material of one roughness, and the indices that it lies between.
type Row = (String, String, Vec<[f64; 2]>);

fn rows() -> Vec<Row> {
    let (air, mut rows) = (vec![[1.0; 2]], Vec::new());
    for text in [
        "diffuse = { reflectance = 1 }",
        "mirror = { reflectance = 1 }",
        "thin = { index = 1.5 }",
        "mix = { materials = [\"white\", \"mirror\"], amount = 0.3 }",
        "mix = { materials = [\"rough\", \"silver\"], amount = 0.7 }",
        "mask = { material = \"rough\", opacity = 0.4 }",
    ] {
        rows.push((text.to_owned(), text.to_owned(), air.clone()));
    }
    for roughness in ROUGHNESSES {
        let metal = format!("conductor = {{ {LOSSLESS}, roughness = {roughness:?} }}");
        rows.push((format!("conductor, roughness {roughness}"), metal, air.clone()));
        for index in INDICES {
            let plastic = format!("plastic = {{ reflectance = 1, index = {index:?}, roughness = {roughness:?} }}");
            rows.push((format!("plastic of {index}, roughness {roughness}"), plastic, air.clone()));
            let glass = format!("dielectric = {{ index = {index:?}, roughness = {roughness:?} }}");
            let sides = vec![[1.0, index], [index, 1.0]];
            rows.push((format!("dielectric of {index}, roughness {roughness}"), glass, sides));
        }
    }
    rows
}

#[test]
fn nothing_is_lost_beyond_half_a_percent_nor_won_beyond_a_thousandth() {
    let mut worst = [1.0f64; 2];
    for (name, text, sides) in rows() {
        let material = material(&text);
        let [mut lowest, mut highest] = [f64::INFINITY, 0.0f64];
        for (&indices, cos) in sides.iter().flat_map(|indices| COSINES.map(|cos| (indices, cos))) {
            let [shown, chance] = furnace(&material, indices, cos);
            [lowest, highest] = [lowest.min(shown), highest.max(shown)];
            let allowed = 0.995 - chance..=1.001 + chance;
            assert!(allowed.contains(&shown), "{name}: {shown} between {indices:?} at the cosine {cos}");
        }
        println!("{name:<64} {lowest:.5} to {highest:.5}");
        worst = [worst[0].min(lowest), worst[1].max(highest)];
    }
    println!("{:<64} {:.5} to {:.5}", "all", worst[0], worst[1]);
}
