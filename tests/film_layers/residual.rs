//! The energy audit: all weight that leaves the camera ends somewhere, and the layer shows what a limit cuts off.

use abbe::film::Layer;
use abbe::trace::{self, Method};
use abbe::{Image, Scene, plan::plan};

use super::{ROOM, render_text, rgb};
use crate::support::larger::larger;
use crate::support::scenes::mean_and_variance;

/// Clear glass, absorbing glass, glass in water, a pane, a mirror and gold: no light path is random.
const SPECULAR: &str = r#"
camera = { position = [0, 1, 5], look_at = [0, 0.5, 0], vertical_fov = 30 }
film = { width = 32, height = 24, filter = "center" }
render = {}
light = [{ environment.radiance = 1 }]
[material]
tinted.dielectric = { index = 1.5, absorption = 0.1, transmittance = 0.8 }
flint.dielectric.index = "N-SF11"
water.dielectric = { index = "water", priority = -1 }
window.thin = { index = 1.5, transmittance = 0.95 }
silver.mirror.reflectance = 0.9
gold.conductor.metal = "Au"
[[object]]
shape.sphere = { center = [-0.8, 0.6, 0], radius = 0.6 }
material = "tinted"
[[object]]
shape.cube = { center = [0.8, 0.6, 0], size = 0.9 }
material = "flint"
[[object]]
shape.sphere = { center = [-0.3, 0.3, 0.5], radius = 0.3 }
material = "water"
[[object]]
shape.sphere = { center = [0, 1.6, 0], radius = 0.4 }
material = "gold"
[[object]]
shape.quad = { center = [0, 0.5, 2], u = [0.5, 0, 0.1], v = [0, 0.5, 0] }
material = "window"
[[object]]
shape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }
material = "silver"
"#;

fn residual(image: &Image) -> Vec<[f64; 3]> {
    rgb(image, "residual")
}

/// Returns the mean of each channel over the pixels and its distance from 0 in standard errors.
fn mean_and_z(residual: &[[f64; 3]]) -> [(f64, f64); 3] {
    [0, 1, 2].map(|channel| {
        let (mean, variance) = mean_and_variance(residual.iter().map(|rgb| rgb[channel]));
        (mean, if variance > 0.0 { mean / (variance / residual.len() as f64).sqrt() } else { 0.0 })
    })
}

#[test]
fn without_chance_all_weight_is_accounted_for_in_every_pixel() {
    for model in ["\"auto\"", "\"rgb\"", "{ bands = 12 }", "{ bands = 32 }"] {
        let scene = SPECULAR.replace("render = {}", &format!("render.model = {model}"));
        let image = render_text(&scene, &[Layer::Residual]);
        assert!(image.because().iter().any(|line| line.contains("transport deterministic")), "{:?}", image.because());
        let worst = residual(&image).as_flattened().iter().fold(0.0, |most: f64, x| larger(most, x.abs()));
        assert!(worst <= 1e-6, "model {model}: {worst}");
    }
}

/// The mean of the layer equals the stopped weight of the report, which is that of a white light whose channels are 1.
#[test]
fn a_limit_of_eight_bounces_shows_where_it_cuts() {
    let scene = SPECULAR.replace("render = {}", "render.max_bounces = 8");
    let image = render_text(&scene, &[Layer::Residual]);
    let residual = residual(&image);
    let bright = residual.iter().filter(|rgb| rgb[1] > 1e-3).count();
    assert!((10..residual.len() / 2).contains(&bright), "{bright} pixels");
    let mean = mean_and_z(&residual).iter().map(|(mean, _)| mean).sum::<f64>() / 3.0;
    let stopped = image.report().stopped;
    assert!((mean / stopped - 1.0).abs() < 0.05, "{mean} is not {stopped}");
}

/// With branches chosen and paths ended at random, the mean is 0 on all surfaces and for all ways to find light.
#[test]
fn by_chance_the_mean_is_nothing() {
    let more = [
        "",
        "[material.paint]\nmix = { materials = [\"coated\", \"silver\"], amount = 0.4 }\n\
         [material.net]\nmask = { material = \"gold\", opacity = 0.5 }\n\
         [material.frost]\ndielectric = { index = 1.5, roughness = 0.3 }\n\
         [[object]]\nshape.sphere = { center = [1, 0.3, 2], radius = 0.3 }\nmaterial = \"paint\"\n\
         [[object]]\nshape.quad = { center = [-1, 0.9, 2.2], u = [0.4, 0, 0], v = [0, 0.4, 0] }\nmaterial = \"net\"\n\
         [[object]]\nshape.sphere = { center = [-0.3, 0.4, 2.2], radius = 0.35 }\nmaterial = \"frost\"\n",
    ];
    for (more, model) in more.into_iter().zip(["hero", "auto"]) {
        let scene = ROOM.replace("samples = 8", &format!("samples = 32, model = \"{model}\"")) + more;
        let image = render_text(&scene, &[Layer::Residual]);
        let found = mean_and_z(&residual(&image));
        assert!(found.iter().all(|(_, z)| z.abs() <= 3.0), "{more}: {found:?}");
        assert!(residual(&image).as_flattened().iter().any(|&x| x.abs() > 1e-3), "nothing was left to chance");
    }
}

/// Paths that end because light vertices contribute their light have ended at a light. Paths that a limit of diffuse
/// bounces cuts off have not.
#[test]
fn light_vertices_end_paths_and_a_limit_of_diffuse_bounces_loses_them() {
    let text = |render: &str, layers: &str| {
        format!(
            "camera = {{ position = [0, 0, 2.9], look_at = [0, 0, 0], vertical_fov = 60 }}\n\
             film = {{ width = 16, height = 16, layers = [{layers}] }}\nrender = {{ samples = 64{render} }}\n\
             material.wall.diffuse.reflectance = 0.7\n\
             material.lamp.emissive = {{ radiance = 4, sides = \"front\" }}\n\
             [[object]]\nshape.cube = {{ center = [0, 0, 0], size = 6 }}\nmaterial = \"wall\"\n\
             [[object]]\nshape.quad = {{ center = [0, 2.9, 0], u = [1, 0, 0], v = [0, 0, 1] }}\nmaterial = \"lamp\"\n"
        )
    };
    let room = |render: &str| {
        let scene = Scene::parse(&text(render, "\"residual\""), "").expect("the scene is valid");
        let world = trace::prepare(&scene, Method { light_vertices: true, ..plan(&scene).method });
        let film = trace::render(&world, &|_| ()).0;
        let numbers: Vec<f64> = film.layers[0].values.iter().map(|&x| f64::from(x)).collect();
        mean_and_z(numbers.as_chunks().0)
    };
    // The report states the stopped weight without a layer, from some of the paths.
    let stopped = |render: &str, light_vertices: bool| {
        let scene = Scene::parse(&text(render, ""), "").expect("the scene is valid");
        let method = Method { light_vertices, ..plan(&scene).method };
        trace::render(&trace::prepare(&scene, method), &|_| ()).1.stopped
    };
    for limit in [", diffuse_bounces = 0", ", diffuse_bounces = 2", ", max_bounces = 1", ", max_bounces = 4"] {
        let [with, without] = [true, false].map(|light_vertices| stopped(limit, light_vertices));
        let residual = room(limit);
        let residual = residual.iter().map(|(mean, _)| mean).sum::<f64>() / 3.0;
        assert!((with / without - 1.0).abs() < 0.05, "{limit}: {with} with light vertices, {without} without");
        assert!((residual / without - 1.0).abs() < 0.05, "{limit}: {residual} in the layer, {without} in the report");
    }
    assert_eq!([true, false].map(|light_vertices| stopped("", light_vertices)), [0.0; 2]);
    let unlimited = room("");
    assert!(unlimited.iter().all(|(_, z)| z.abs() <= 3.0), "{unlimited:?}");
    // The first wall scatters 0.7 of the arriving weight, and none of it may leave the wall. The lamp absorbs what hits
    // it.
    let limited = room(", diffuse_bounces = 0");
    assert!(limited.iter().all(|(mean, _)| (0.6..=0.7).contains(mean)), "{limited:?}");
}

/// A filter blocks half of all light before any surface. That is no loss and does not belong to the color of a surface.
#[test]
fn a_filter_before_the_camera_is_accounted_for() {
    let behind = |scene: &str| scene.replacen("vertical_fov = 30", "vertical_fov = 30, polarizer = { axis = 20 }", 1);
    let image = render_text(&behind(SPECULAR), &[Layer::Residual]);
    let worst = residual(&image).as_flattened().iter().fold(0.0, |most: f64, x| larger(most, x.abs()));
    assert!(worst <= 1e-6, "{worst}");
    let floor = "camera = { position = [0, 1, 5], look_at = [0, 0.5, 0], vertical_fov = 30 }\n\
                 film = { width = 8, height = 6, first = \"visible\" }\nrender = { samples = 4, model = \"rgb\" }\n\
                 light = [{ environment.radiance = 1 }]\n\
                 material.paint.diffuse.reflectance = { rgb = [0.2, 0.3, 0.4] }\n\
                 [[object]]\nshape.plane = { point = [0, 0, 0], normal = [0, 1, 0] }\nmaterial = \"paint\"\n";
    let [bare, behind] = [floor, &behind(floor)].map(|scene| render_text(scene, &[Layer::Albedo, Layer::Normal]));
    for channel in ["albedo.R", "albedo.G", "albedo.B", "N.X", "N.Y", "N.Z"] {
        let [bare, behind] = [&bare, &behind].map(|image| image.layer(channel).expect("it was asked for"));
        assert!(bare.iter().any(|&x| x != 0.0) || matches!(channel, "N.X" | "N.Z"), "{channel} is empty");
        assert!(bare.iter().zip(behind).all(|(a, b)| (a - b).abs() <= 1e-6), "{channel}");
    }
}
