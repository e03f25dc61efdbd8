//! The spectrum that one pixel sees: the lamp is tuned through the visible, and each image is read at two pixels.
//!
//! The left pixel looks through a block of flint, the right one past it. Their ratio is what the block lets through.
//!
//! ```text
//! cargo run --release --example spectrum_of_a_pixel
//! ```

fn main() -> abbe::Result<()> {
    println!("  nm   through 10 cm of SF66");
    for nm in (380..=700).step_by(10) {
        let scene = abbe::Scene::parse(&bench(nm), "")?;
        let image = abbe::render(&scene, &abbe::Options::default())?;
        let green = |x| f64::from(image.rgb_at(x, 0)[1]);
        let share = green(0) / green(1);
        println!("{nm:4}   {share:.4}  {}", "#".repeat((60.0 * share) as usize));
    }
    Ok(())
}

/// A block in one half of the view, before a wall that shines at one wavelength. The film keeps XYZ, which no line
/// leaves dark.
fn bench(nm: u32) -> String {
    format!(
        "
        camera = {{ position = [0, 0, 1], look_at = [0, 0, 0], projection = \"orthographic\", height = 0.1 }}
        film = {{ width = 2, height = 1, filter = \"center\", color_space = \"lin_ciexyzd65_scene\" }}
        render = {{ model = {{ bands = 8 }}, meters_per_unit = 1 }}
        [material]
        block = {{ dielectric = {{ index = \"SF66\", absorption = \"SF66\" }} }}
        wall = {{ emissive = {{ radiance = {{ lines = [[{nm}, 1]] }} }} }}
        [[object]]
        shape.cube = {{ center = [-0.05, 0, 0], size = 0.1 }}
        material = \"block\"
        [[object]]
        shape.quad = {{ center = [0, 0, -1], u = [1, 0, 0], v = [0, 1, 0] }}
        material = \"wall\"
        "
    )
}
