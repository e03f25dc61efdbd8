//! The transmittance of a plate of glass by its index: rendered, beside Fresnel's closed form, as a chart.
//!
//! ```text
//! cargo run --release --example sweep_an_index
//! ```

fn main() -> abbe::Result<()> {
    println!("index  rendered  exact     transmittance");
    for step in 0..=14 {
        let index = 1.1 + 0.1 * f64::from(step);
        let scene = abbe::Scene::parse(&plate(index), "")?;
        let rendered = f64::from(abbe::render(&scene, &abbe::Options::default())?.rgb_at(0, 0)[1]);
        // All reflections between both faces: (1 - r) / (1 + r), Born & Wolf 1999, section 7.6.
        let r = ((index - 1.0) / (index + 1.0)).powi(2);
        let exact = (1.0 - r) / (1.0 + r);
        println!("{index:.1}    {rendered:.6}  {exact:.6}  {}", "#".repeat((60.0 * rendered) as usize));
    }
    Ok(())
}

/// Returns a plate in front of a wall of radiance 1, without other light.
fn plate(index: f64) -> String {
    format!(
        "
        camera = {{ position = [0, 0, 5], look_at = [0, 0, 0], vertical_fov = 0.001 }}
        film = {{ width = 1, height = 1, filter = \"center\" }}
        [material]
        plate = {{ dielectric = {{ index = {index:?} }} }}
        wall = {{ emissive = {{ radiance = 1 }} }}
        [[object]]
        shape.cube = {{ center = [0, 0, 0], size = [4, 4, 0.1] }}
        material = \"plate\"
        [[object]]
        shape.quad = {{ center = [0, 0, -2], u = [2, 0, 0], v = [0, 2, 0] }}
        material = \"wall\"
        "
    )
}
