//! Contents of surface layers in partly covered pixels.

use abbe::film::Layer;

use super::{render_text, rgb};

/// A ball of radius 1 with no surface behind it.
const BALL: &str = "camera = { position = [0, 0, 4], look_at = [0, 0, 0], vertical_fov = 40 }\n\
    film = { width = 16, height = 16 }\nrender.samples = 16\nmaterial.white.diffuse.reflectance = 0.5\n\
    light = [{ environment.radiance = 1 }]\n\
    object = [{ shape.sphere = { center = [0, 0, 0], radius = 1 }, material = \"white\" }]\n";

#[test]
fn at_edges_albedo_and_normals_are_premultiplied_and_places_are_whole() {
    let image = render_text(BALL, &[Layer::Albedo, Layer::Normal, Layer::Position]);
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
        // Normals within a pixel differ by at most a few tenths.
        let normal = length("N", pixel);
        assert!(normal <= share + 1e-6 && normal > 0.9 * share, "{normal} of {share}");
        assert!((length("P", pixel) - 1.0).abs() < 1e-5, "a place is on the ball");
    }
}

/// A sheet with holes counts in proportion to its opacity and whatever is behind it counts for the rest, for either
/// definition of the first surface. With a holdout elsewhere, each sample passes through the holes or not at random.
#[test]
fn albedo_and_normals_of_a_sheet_with_holes_are_of_what_it_covers() {
    let opacities = [(0.1, false), (0.5, false), (0.9, false), (0.1, true), (0.3, true), (0.5, true), (0.9, true)];
    for (first, has_holdout) in [("met", false), ("visible", false), ("met", true), ("visible", true)] {
        for (opacity, has_wall) in opacities {
            sheet_with_holes(first, has_holdout, opacity, has_wall);
        }
    }
}

fn sheet_with_holes(first: &str, has_holdout: bool, opacity: f64, has_wall: bool) {
    let object = |z: f64, material: &str| {
        format!("{{ shape.quad = {{ center = [0, 0, {z}], u = [9, 0, 0], v = [0, 9, 0] }}, {material} }}, ")
    };
    let behind = if has_wall { object(-1.0, "material = \"gray\"") } else { String::new() };
    let holdout = if has_holdout { object(9.0, "material = \"gray\", holdout = true") } else { String::new() };
    let scene = format!(
        "camera = {{ position = [0, 0, 4], look_at = [0, 0, 0], vertical_fov = 20 }}\n\
         film = {{ width = 8, height = 8, first = \"{first}\" }}\nrender.samples = 256\n\
         material.gray.diffuse.reflectance = 0.5\nmaterial.pink.diffuse.reflectance = 0.8\n\
         material.net.mask = {{ material = \"pink\", opacity = {opacity} }}\n\
         light = [{{ environment.radiance = 1 }}]\nobject = [{behind}{holdout}{}]\n",
        object(0.0, "material = \"net\"")
    );
    let image = render_text(&scene, &[Layer::Albedo, Layer::Normal]);
    let mean = |name: &str| {
        let values = image.layer(name).expect("there");
        values.iter().map(|&x| f64::from(x)).sum::<f64>() / values.len() as f64
    };
    let [expected, covered] =
        if has_wall { [0.8 * opacity + 0.5 * (1.0 - opacity), 1.0] } else { [0.8 * opacity, opacity] };
    // Each sample hits the sheet or misses it at random.
    let deviation = (opacity * (1.0 - opacity) / (64.0 * 256.0_f64)).sqrt();
    for (name, expected) in [("albedo.R", expected), ("N.Z", covered), ("A", covered)] {
        let found = mean(name);
        assert!(
            (found - expected).abs() < 5.0 * deviation,
            "{first}, holdout {has_holdout}, {opacity}, wall {has_wall}, {name}: {found} for {expected}"
        );
    }
}

/// A pane with holes in front of a wall. Half of the light hits the pane, which reflects or transmits all of it. The
/// other half passes through the holes.
#[test]
fn the_albedo_behind_a_pane_with_holes_counts_once() {
    let text = "camera = { position = [0, 0, 5], look_at = [0, 0, 0], vertical_fov = 5 }\n\
        film = { width = 16, height = 16 }\nrender = { samples = 256, model = \"rgb\" }\n[material]\n\
        wall.diffuse.reflectance = 0.8\npane.thin.index = 1.5\n\
        sheet.mask = { material = \"pane\", opacity = 0.5 }\n\
        [[object]]\nshape.quad = { center = [0, 0, 0], u = [9, 0, 0], v = [0, 9, 0] }\nmaterial = \"sheet\"\n\
        [[object]]\nshape.quad = { center = [0, 0, -1], u = [9, 0, 0], v = [0, 9, 0] }\nmaterial = \"wall\"\n\
        [[light]]\npoint = { position = [1, 1, 4], intensity = 10 }\n";
    let albedo = rgb(&render_text(text, &[Layer::Albedo]), "albedo");
    let mean = albedo.iter().map(|rgb| rgb[1]).sum::<f64>() / albedo.len() as f64;
    // Each sample has an albedo of 1 or 0.8, at random.
    let sigma = 0.1 / libm::sqrt(256.0 * 256.0);
    assert!((mean - 0.9).abs() < 5.0 * sigma, "{mean} for 0.9 +- {sigma:.1e}");
}

/// White has a Z above 1 in CIE XYZ.
#[test]
fn albedo_of_white_is_the_white_of_the_film() {
    for (space, white) in [("lin_ciexyzd65_scene", [0.9505, 1.0, 1.0891]), ("lin_ap1_scene", [1.0; 3])] {
        let film = format!("film = {{ width = 4, height = 4, color_space = \"{space}\" }}");
        let text = BALL
            .replace("film = { width = 16, height = 16 }", &film)
            .replace("vertical_fov = 40", "vertical_fov = 4")
            .replace("reflectance = 0.5", "reflectance = 1");
        for pixel in rgb(&render_text(&text, &[Layer::Albedo]), "albedo") {
            let is_white = (0..3).all(|i| (pixel[i] - white[i]).abs() < 2e-4);
            assert!(is_white, "{space}: {pixel:?} for {white:?}");
        }
    }
}
