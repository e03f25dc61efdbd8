//! Camera metadata in files, and the flags for crop and overscan.

use exr::image::{AnyChannels, FlatSamples, Image, Layer};
use exr::meta::attribute::{AttributeValue, EnvironmentMap, Text};
use exr::prelude::{IntegerBounds, Vec2, read_first_flat_layer_from_file};

use crate::support::run::{Folder, render};

const SCENE: &str = r#"
[camera]
position = [0, 0, 0]
look_at = [0, 0, 1]
vertical_fov = 90
[film]
width = 8
height = 4
[render]
samples = 2
[[light]]
environment = { radiance = 1 }
"#;

fn read_output(folder: &Folder, scene: &str, flags: &[&str]) -> Image<Layer<AnyChannels<FlatSamples>>> {
    folder.write("scene.toml", scene);
    let answer = render(folder, &[&["scene.toml", "--exr", "image.exr", "--png", "image.png"], flags].concat());
    assert_eq!((answer.code, &*answer.stdout), (Some(0), ""), "{}", answer.stderr);
    read_first_flat_layer_from_file(folder.path_of("image.exr")).expect("an EXR")
}

#[test]
fn a_crop_is_the_data_window_of_the_full_display_window() {
    let folder = Folder::new();
    let cropped = SCENE.replace("height = 4", "height = 4\ncrop = [3, 1, 4, 2]");
    for (scene, flags) in
        [(cropped.as_str(), &[][..]), (SCENE, &["--crop", "3,1,4,2"]), (&cropped, &["--crop", "3, 1, 4, 2"])]
    {
        let image = read_output(&folder, scene, flags);
        assert_eq!(image.attributes.display_window, IntegerBounds::from_dimensions((8, 4)));
        assert_eq!(image.layer_data.attributes.layer_position, Vec2(3, 1));
        assert_eq!(image.layer_data.size, Vec2(4, 2));
        assert_eq!(image.layer_data.attributes.screen_window_width, 4.0);
        let picture = folder.read("image.png");
        // A PNG stores its size in its first chunk.
        assert_eq!(picture[16..24], [0, 0, 0, 4, 0, 0, 0, 2]);
    }
}

#[test]
fn overscan_begins_before_the_display_window() {
    let folder = Folder::new();
    let wide = SCENE.replace("height = 4", "height = 4\noverscan = [3, 1, 2, 0]");
    for (scene, flags, corner, size) in [
        (wide.as_str(), &[][..], Vec2(-3, -1), Vec2(13, 5)),
        (SCENE, &["--overscan", "3,1,2,0"], Vec2(-3, -1), Vec2(13, 5)),
        (&wide, &["--overscan", "2"], Vec2(-2, -2), Vec2(12, 8)),
        (&wide, &["--overscan", "0"], Vec2(0, 0), Vec2(8, 4)),
        (&wide, &["--crop", "-3,-1,4,2"], Vec2(-3, -1), Vec2(4, 2)),
        (&wide, &["--crop", "8, 3, 2, 1"], Vec2(8, 3), Vec2(2, 1)),
    ] {
        let image = read_output(&folder, scene, flags);
        assert_eq!(image.attributes.display_window, IntegerBounds::from_dimensions((8, 4)));
        assert_eq!((image.layer_data.attributes.layer_position, image.layer_data.size), (corner, size), "{flags:?}");
        // The screen window is the one of the display window.
        assert_eq!(image.layer_data.attributes.screen_window_width, 4.0);
        let picture = folder.read("image.png");
        assert_eq!(picture[16..24], [0, 0, 0, size.x() as u8, 0, 0, 0, size.y() as u8]);
    }
}

#[test]
fn impossible_overscan_is_refused() {
    let folder = Folder::with("scene.toml", SCENE);
    let refused = |flags: &[&str]| {
        let answer = render(&folder, &[&["scene.toml"], flags].concat());
        (answer.code, answer.stderr)
    };
    let wide = "error: an image with its overscan has at most 65536 pixels along each side, not 80008\n\
                help: --overscan takes one number of pixels, or four: left, top, right and bottom\n";
    assert_eq!(refused(&["--overscan", "40000"]), (Some(2), wide.to_owned()));
    let beyond = "error: this crop ends before column 10, row 6, but the image with its overscan before column 9, row 5\n\
                  help: --crop takes first column, first row, width and height\n";
    assert_eq!(refused(&["--overscan", "1", "--crop", "-1,-1,11,7"]), (Some(2), beyond.to_owned()));
    for wrong in ["-1", "1,2", "1.5", "wide", "99999999999", ""] {
        let (code, reported) = refused(&["--overscan", wrong]);
        let expected = "overscan is one or four whole numbers of pixels, such as 16 or 16,8,16,8";
        assert!(code == Some(2) && reported.contains(expected), "{wrong}: {reported}");
    }
    assert_eq!(folder.file_names(), ["scene.toml"]);
}

#[test]
fn an_impossible_crop_is_refused() {
    let folder = Folder::with("scene.toml", SCENE);
    let beyond = render(&folder, &["scene.toml", "--crop", "5,0,4,4"]);
    let reported = "error: this crop ends at column 9, row 4, but the image has 8 x 4 pixels\n\
                help: --crop takes first column, first row, width and height\n";
    assert_eq!((beyond.code, beyond.stderr.as_str()), (Some(2), reported));
    for wrong in ["1,2,3", "1,2,3,4,5", "a,b,c,d", "0,0,-1,2", "0.5,0,1,1"] {
        let answer = render(&folder, &["scene.toml", "--crop", wrong]);
        let reported = "a crop is four whole numbers of pixels, such as 100,50,320,180";
        assert!(answer.code == Some(2) && answer.stderr.contains(reported), "{wrong}: {}", answer.stderr);
    }
    assert_eq!(folder.file_names(), ["scene.toml"]);
}

#[test]
fn a_shift_moves_the_screen_window() {
    let folder = Folder::new();
    let image = read_output(&folder, &SCENE.replace("= 90", "= 90\nshift = [0.25, -0.5]"), &[]);
    // The shifts are a quarter and a half of the window's height, which is 2 at 90 degrees.
    let attributes = image.layer_data.attributes;
    let near = |a: f32, b: f32| (a - b).abs() <= 1e-6;
    let Vec2(x, y) = attributes.screen_window_center;
    assert!(near(x, 0.5) && near(y, -1.0) && near(attributes.screen_window_width, 4.0), "{x}, {y}");
}

#[test]
fn files_record_the_projection_of_the_world() {
    let folder = Folder::new();
    let text = |name: &str| Some(AttributeValue::Text(Text::from(name)));
    let image = read_output(&folder, SCENE, &[]);
    let attributes = &image.layer_data.attributes;
    assert_eq!(attributes.other.get(&Text::from("render/projection")).cloned(), text("perspective"));
    assert_eq!(attributes.environment_map, None);

    let full = SCENE.replace("vertical_fov = 90", "projection = \"equirectangular\"");
    let image = read_output(&folder, &full, &[]);
    let attributes = &image.layer_data.attributes;
    assert_eq!(attributes.other.get(&Text::from("render/projection")).cloned(), text("equirectangular"));
    assert_eq!(attributes.environment_map, Some(EnvironmentMap::LatitudeLongitude));
    assert_eq!((attributes.screen_window_width, attributes.screen_window_center), (1.0, Vec2(0.0, 0.0)));
    // Readers map the data window to the whole sphere, so an image with a crop or overscan is no environment map.
    for flags in [&["--crop", "0,0,2,2"][..], &["--overscan", "1"], &["--overscan", "1", "--crop", "-1,0,8,4"]] {
        assert_eq!(read_output(&folder, &full, flags).layer_data.attributes.environment_map, None);
    }

    let flat = SCENE.replace("vertical_fov = 90", "projection = \"orthographic\"\nheight = 3\nshift = [0, 1]");
    let attributes = read_output(&folder, &flat, &[]).layer_data.attributes;
    assert_eq!((attributes.screen_window_width, attributes.screen_window_center), (6.0, Vec2(0.0, 3.0)));
}

#[test]
fn files_record_the_filter_with_its_width() {
    let folder = Folder::new();
    for (written_as, recorded) in [
        ("\"center\"", "center"),
        ("\"tent\"", "tent radius 1"),
        ("\"blackman-harris\"", "blackman-harris radius 1.5"),
        ("{ gaussian = { sigma = 0.4 } }", "gaussian sigma 0.4"),
    ] {
        let image =
            read_output(&folder, &SCENE.replace("height = 4", &format!("height = 4\nfilter = {written_as}")), &[]);
        let found = image.layer_data.attributes.other.get(&Text::from("render/filter")).cloned();
        assert_eq!(found, Some(AttributeValue::Text(Text::from(recorded))));
    }
}

#[test]
fn files_record_the_lens_in_meters_and_millimeters() {
    let folder = Folder::new();
    let lens_attributes = |scene: &str| {
        let attributes = read_output(&folder, scene, &[]).layer_data.attributes;
        let other = |name: &str| attributes.other.get(&Text::from(name)).cloned();
        let number = |name: &str| match other(name) {
            Some(AttributeValue::F32(number)) => Some(number),
            None => None,
            Some(found) => panic!("{name} is {found:?}"),
        };
        let focal_lengths = [number("pinholeFocalLength"), number("effectiveFocalLength")];
        let sensor = other("sensorOverallDimensions");
        (sensor, focal_lengths, attributes.aperture, attributes.focus, attributes.near_clip_plane)
    };
    let near = |found: Option<f32>, expected: f64| {
        let found = f64::from(found.expect("it is said"));
        assert!((found / expected - 1.0).abs() < 1e-6, "{found} for {expected}");
    };
    assert_eq!(lens_attributes(SCENE), (None, [None; 2], None, None, None));

    // A view of 90 degrees: the focal length is half the height of the sensor, which is half as high as wide.
    let sensor = SCENE.replace("= 90", "= 90\nsensor_width = 36\nnear = 0.5");
    let millimeters = Some(AttributeValue::FloatVec2(Vec2(36.0, 18.0)));
    assert_eq!(lens_attributes(&sensor), (millimeters.clone(), [Some(9.0), None], None, None, Some(0.5)));

    // A lens 2 cm across, focused at 0.9 m: 1 / f = 1 / 9 mm + 1 / 900 mm.
    let lens = sensor.replace("near = 0.5", "lens = { radius = 1, focus_distance = 90 }");
    assert_eq!(lens_attributes(&lens), (millimeters.clone(), [Some(9.0), None], None, None, None));
    let (found, [pinhole, effective], aperture, focus, _) =
        lens_attributes(&lens.replace("[render]\n", "[render]\nmeters_per_unit = 0.01\n"));
    assert_eq!((found, pinhole), (millimeters, Some(9.0)));
    let focal_length = 1.0 / (1.0 / 9.0 + 1.0 / 900.0);
    near(effective, focal_length);
    near(aperture, focal_length / 20.0);
    near(focus, 0.9);

    let far = lens.replace("focus_distance = 90", "focus_distance = inf").replace("sensor_width = 36\n", "");
    let (found, lengths, aperture, focus, _) =
        lens_attributes(&far.replace("[render]\n", "[render]\nmeters_per_unit = 0.01\n"));
    assert_eq!((found, lengths, aperture, focus), (None, [None; 2], None, Some(f32::INFINITY)));
}
