//! What layers of surfaces hold where a pixel is covered in part.

use abbe::film::Layer;

use super::{rendered, rgb};

/// A ball of radius 1 before nothing.
const BALL: &str = "camera = { position = [0, 0, 4], look_at = [0, 0, 0], vertical_fov = 40 }\n\
    film = { width = 16, height = 16 }\nrender.samples = 16\nmaterial.white.diffuse.reflectance = 0.5\n\
    light = [{ environment.radiance = 1 }]\n\
    object = [{ shape.sphere = { center = [0, 0, 0], radius = 1 }, material = \"white\" }]\n";

#[test]
fn at_edges_albedo_and_normals_are_premultiplied_and_places_are_whole() {
    let image = rendered(BALL, &[Layer::Albedo, Layer::Normal, Layer::Position]);
    let length = |layer: &str, pixel: usize| {
        let axes =
            ["X", "Y", "Z"].map(|axis| f64::from(image.layer(&format!("{layer}.{axis}")).expect("there")[pixel]));
        axes.map(|x| x * x).iter().sum::<f64>().sqrt()
    };
    let (covered, albedo) = (image.layer("A").expect("there is alpha"), rgb(&image, "albedo"));
    let edges: Vec<usize> = (0..covered.len()).filter(|&pixel| covered[pixel] > 0.0 && covered[pixel] < 1.0).collect();
    assert!(edges.len() > 20, "{} pixels at the edge", edges.len());
    for pixel in edges {
        let share = f64::from(covered[pixel]);
        assert!((albedo[pixel][1] - 0.5 * share).abs() < 1e-5, "{} of {share}", albedo[pixel][1]);
        // Normals within a pixel are at most a few tenths apart.
        let normal = length("N", pixel);
        assert!(normal <= share + 1e-6 && normal > 0.9 * share, "{normal} of {share}");
        assert!((length("P", pixel) - 1.0).abs() < 1e-5, "a place is on the ball");
    }
}
