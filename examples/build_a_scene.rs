//! A scene built by a program: a spiral of glass balls under a uniform sky and a sun, written as an EXR and a picture.
//!
//! ```text
//! cargo run --release --example build_a_scene
//! ```

use abbe::toml::{Table, toml};

fn main() -> abbe::Result<()> {
    let mut scene = toml! {
        camera = { position = [0, 5, 7], look_at = [0, 0.3, 0], vertical_fov = 32 }
        film = { width = 480, height = 270 }
        light = [{ environment = { radiance = 0.5 } }, { sun = { toward = [1, 2, 0.5], irradiance = 3 } }]
        object = [{ material = "floor", shape = { plane = { point = [0, 0, 0], normal = [0, 1, 0] } } }]

        [material]
        floor = { diffuse = { reflectance = { rgb = [0.2, 0.22, 0.25] } } }
        glass = { dielectric = { index = "N-BK7" } }
    };
    let objects = scene["object"].as_array_mut().expect("a list");
    for number in 0..24 {
        let (angle, distance) = (0.7 * f64::from(number), 0.4 + 0.1 * f64::from(number));
        let radius = 0.12 + 0.012 * f64::from(number);
        let mut sphere = Table::new();
        sphere.insert("center".into(), vec![distance * angle.cos(), radius, distance * angle.sin()].into());
        sphere.insert("radius".into(), radius.into());
        objects.push(toml! { material = "glass" }.into());
        let ball = objects.last_mut().and_then(|ball| ball.as_table_mut()).expect("a table");
        ball.insert("shape".into(), Table::from_iter([("sphere".to_owned(), sphere.into())]).into());
    }
    let scene = abbe::Scene::from_table(&scene, "")?;
    let image = abbe::render(&scene, &abbe::Options { samples: Some(64), ..Default::default() })?;
    image.write_exr("spiral.exr")?;
    image.write_png("spiral.png", 0.0)?;
    println!("{}\nwrote spiral.exr and spiral.png", image.because().join("\n"));
    Ok(())
}
