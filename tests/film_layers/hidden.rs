//! Transparent bodies that are hidden from the camera, and the objects inside them.

use abbe::Image;
use abbe::film::Layer;

use super::{beauty, render_text, rgb};

const PIXELS: usize = 16;

/// Renders a body that is hidden from the camera, with `rest` inside and behind it.
fn render_hidden_body(body: &str, rest: &str, samples: u32) -> Image {
    let text = format!(
        "camera = {{ position = [0, 0, 5], look_at = [0, 0, 0], vertical_fov = 10 }}\nfilm = {{ width = 4, height = 4 }}\n\
         render = {{ samples = {samples}, model = \"rgb\" }}\n[material]\nbody.dielectric = {{ {body} }}\n\
         white.diffuse.reflectance = 1\nblack.diffuse.reflectance = 0\nlamp.emissive.radiance = 2\n\
         sheet.mask = {{ material = \"black\", opacity = 0.25 }}\n\
         [[object]]\nshape.cube = {{ center = [0, 0, 0], size = 2 }}\nmaterial = \"body\"\nvisible_to_camera = false\n{rest}"
    );
    render_text(&text, &[Layer::Residual])
}

fn mean(colors: &[[f64; 3]]) -> f64 {
    colors.iter().map(|color| color[1]).sum::<f64>() / colors.len() as f64
}

/// Inside a medium of index n, radiance is n^2 times the radiance outside. Light that leaves the medium loses this
/// factor.
#[test]
fn a_white_ball_in_a_hidden_body_is_as_bright_as_the_sky_around_both() {
    const SAMPLES: u32 = 1024;
    let ball = "[[object]]\nshape.sphere = { center = [0, 0, 0], radius = 0.6 }\nmaterial = \"white\"\n\
        [[light]]\nenvironment = { radiance = 1 }\n";
    let image = render_hidden_body("index = 1.5", ball, SAMPLES);
    let (shown, lost) = (mean(&beauty(&image)), mean(&rgb(&image, "residual")));
    // Russian roulette is the only source of noise. It is at most as bright as the paths that are followed in place of
    // those it ends, so the error of a sample is less than 1/4, root mean square.
    let five_sigma = 5.0 * 0.25 / (PIXELS as f64 * f64::from(SAMPLES)).sqrt();
    assert!((shown - 1.0).abs() < five_sigma && lost.abs() < five_sigma, "{shown}, of which {lost} is lost");
}

#[test]
fn behind_holes_in_a_hidden_body_the_camera_sees_as_if_that_were_not_there() {
    let sheet = "[[object]]\nshape.quad = { center = [0, 0, 0], u = [0.8, 0, 0], v = [0, 0.8, 0] }\nmaterial = \"sheet\"\n\
        [[object]]\nshape.quad = { center = [0, 0, -2], u = [3, 0, 0], v = [0, 3, 0] }\nmaterial = \"lamp\"\n";
    for body in ["index = 1, absorption = 1", "index = 1.5, absorption = 0.5"] {
        for color in beauty(&render_hidden_body(body, sheet, 4)) {
            assert!((color[1] - 0.75 * 2.0).abs() < 1e-6, "{body}: {color:?}");
        }
    }
}

/// Light that passes through holes and panes is seen as if they were not there. Reflected or refracted light is not
/// seen directly.
#[test]
fn what_the_camera_does_not_see_is_hidden_behind_holes_and_panes_and_not_in_mirrors_and_glass() {
    let quad = "quad = { center = [0, 0, 0], u = [3, 0, 0], v = [0, 3, 0] }";
    let cube = "cube = { center = [0, 0, 0], size = [6, 6, 1] }";
    let lamp = "[[object]]\nshape.sphere = { center = [0, 0, 0], radius = 50 }\nmaterial = \"lamp\"\n".to_owned();
    let sky = "[[light]]\nenvironment = { radiance = 2 }\n".to_owned();
    for (front, shape, open, hidden) in [
        ("mask = { material = \"black\", opacity = 0.5 }", quad, 0.5, 0.0),
        ("thin = { index = 1, transmittance = 0.5 }", quad, 0.5, 0.0),
        ("polarizer.axis = [1, 0, 0]", quad, 0.5, 0.0),
        ("mirror.reflectance = 0.5", quad, 0.5, 0.5),
        ("dielectric = { index = 1, transmittance = 0.8 }", cube, 0.64, 0.64),
    ] {
        for around in [&lamp, &sky] {
            for (visibility, share) in [("", open), ("visible_to_camera = false\n", hidden)] {
                let text = format!(
                    "camera = {{ position = [0, 0, 5], look_at = [0, 0, 0], vertical_fov = 10 }}\n\
                     film = {{ width = 2, height = 2 }}\nrender.samples = 4\n[material]\nlamp.emissive.radiance = 2\n\
                     black.diffuse.reflectance = 0\nfront.{front}\n\
                     [[object]]\nshape.{shape}\nmaterial = \"front\"\n{around}{visibility}"
                );
                for color in beauty(&render_text(&text, &[Layer::Residual])) {
                    assert!((color[1] - 2.0 * share).abs() < 1e-5, "{front}, {around}{visibility}: {color:?}");
                }
            }
        }
    }
}
