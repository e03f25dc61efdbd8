//! Rows H7 and H11: images of one pixel and of one row, and scenes with nothing in them.

use abbe::film::DEPTH_OF_NOTHING;
use abbe::plan::plan;
use abbe::trace::{prepare, render};

use crate::support::scenes::{SPLITTING, environment, render_film, scene};

fn view(width: u32, height: u32, fov: f64) -> String {
    format!(
        "camera = {{ position = [0, 0, 5], look_at = [0, 0, 0], vertical_fov = {fov:?} }}\n\
         film = {{ width = {width}, height = {height} }}\n"
    )
}

/// A white ball in a white sky: every pixel is 1, and the ball is present.
#[test]
fn h7_images_of_one_pixel_one_row_and_one_column_are_whole() {
    let ball = "[material.white]\ndiffuse.reflectance = 1\n[[object]]\nmaterial = \"white\"\n\
                shape.sphere = { center = [0, 0, 0], radius = 1 }\n";
    let longest = 30_000;
    for (width, height, fov) in
        [(1, 1, 20.0), (longest, 1, 0.002), (1, longest, 60.0), (65_536, 1, 0.001), (1, 65_536, 60.0)]
    {
        for filter in ["box", "gaussian", "center"] {
            let text = view(width, height, fov) + ball + &environment(1.0);
            let text = text.replace("film = {", &format!("film = {{ filter = \"{filter}\","));
            let (film, report) = render_film(&text, SPLITTING);
            assert_eq!((report.non_finite, report.samples), (0, u64::from(width) * u64::from(height)));
            assert_eq!(film.pixels.len(), (width * height) as usize);
            for (at, pixel) in film.pixels.iter().enumerate() {
                let is_white = pixel.rgb.iter().all(|x| (x - 1.0).abs() < 1e-5);
                assert!(is_white, "{filter}, pixel {at} of {width} x {height}: {pixel:?}");
            }
            let seen = film.pixels.iter().filter(|pixel| pixel.depth != DEPTH_OF_NOTHING).count();
            // A wide filter may take its only sample from outside of the pixel.
            assert!(seen > 0 || filter == "gaussian", "{filter}, {width} x {height}: the ball is not there");
        }
    }
}

#[test]
fn h11_a_scene_with_nothing_in_it_is_planned_and_black() {
    let lamp = "[material.lamp]\nemissive.radiance = 0\n[[object]]\nmaterial = \"lamp\"\n\
                shape.sphere = { center = [0, 0, 0], radius = 1 }\n";
    for (text, alpha) in [("", 0.0), ("[[light]]\nenvironment = { radiance = 0 }\n", 0.0), (lamp, 1.0)] {
        let scene = scene(&(view(4, 4, 10.0) + text));
        let (film, report) = render(&prepare(&scene, plan(&scene).method), &|_| ());
        assert_eq!((report.non_finite, report.unmatched), (0, 0));
        assert!(film.pixels.iter().all(|pixel| pixel.rgb == [0.0; 3] && pixel.alpha == alpha), "{text}");
    }
    for radiance in ["0", "{ rgb = [0, 0, 0] }", "{ samples = [[400, 0], [700, 0]] }", "{ lines = [[589, 0]] }"] {
        let scene = scene(&(view(4, 4, 10.0) + &lamp.replace("radiance = 0", &format!("radiance = {radiance}"))));
        let is_told = scene.warnings.iter().any(|warning| warning.starts_with("nothing emits light"));
        assert!(scene.lights.is_empty() && is_told, "{radiance}: {:?}", scene.warnings);
    }
}
