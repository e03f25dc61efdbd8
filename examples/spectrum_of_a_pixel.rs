//! The spectrum that one pixel sees, beside that of another: what a block of flint transmits.
//!
//! The left pixel looks through the block, the right one past it.
//!
//! ```text
//! cargo run --release --example spectrum_of_a_pixel
//! ```

const BENCH: &str = r#"
camera = { position = [0, 0, 1], look_at = [0, 0, 0], projection = "orthographic", height = 0.1 }
film = { width = 2, height = 1, filter = "center", spectral = { from = 380, to = 700, step = 10 } }
render = { meters_per_unit = 1 }
[material]
block = { dielectric = { index = "SF66", absorption = "SF66" } }
wall = { emissive = { radiance = 1 } }
[[object]]
shape.cube = { center = [-0.05, 0, 0], size = 0.1 }
material = "block"
[[object]]
shape.quad = { center = [0, 0, -1], u = [1, 0, 0], v = [0, 1, 0] }
material = "wall"
"#;

fn main() -> abbe::Result<()> {
    let image = abbe::render(&abbe::Scene::parse(BENCH, "")?, &abbe::Options::default())?;
    let [through, past] = [0, 1].map(|x| image.spectrum_at(x, 0).expect("the scene asks for spectra"));
    println!("  nm   through 10 cm of SF66");
    for ([nm, seen], [_, wall]) in through.into_iter().zip(past) {
        let share = seen / wall;
        println!("{nm:4}   {share:.4}  {}", "#".repeat((60.0 * share) as usize));
    }
    Ok(())
}
