//! Which numbers of an OpenEXR file are read, and what they stand for.

use super::files::{image_of, materials, refusal_of};
use super::*;
use crate::look::files::Exr;

/// A file of 2 x 1 pixels, whose channels hold these numbers.
fn write(folder: &Path, name: &str, channels: &[(&'static str, [f32; 2])]) {
    let channels = channels.iter().map(|(name, values)| (*name, values.to_vec())).collect();
    Exr::new([2, 1], channels).write(&folder.join(name));
}

/// Red, green and blue of the second pixel.
fn second(folder: &Path, options: &str) -> [f32; 3] {
    image_of(&materials(folder, &[&format!("{{ image = \"a.exr\"{options} }}")]), 0).texel(1, 0)
}

#[test]
fn grays_layers_and_small_letters_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (gray, alpha) = ([0.5, 0.25], [1.0, 0.75]);
    for name in ["Y", "Z", "R", "matte", "light.Y", "A"] {
        write(folder, "a.exr", &[(name, gray)]);
        assert_eq!(second(folder, ""), [0.25; 3], "{name}");
        assert_eq!(second(folder, ", channel = \"green\""), [0.25; 3], "{name}");
        let alone = if name == "A" { 0.25 } else { 1.0 };
        assert_eq!(second(folder, ", channel = \"alpha\""), [alone; 3], "{name}");
    }
    for [color, beside] in [["Y", "A"], ["mask.Z", "mask.A"], ["y", "a"]] {
        write(folder, "a.exr", &[(beside, alpha), (color, gray)]);
        assert_eq!(second(folder, ""), [0.25; 3], "{color}");
        assert_eq!(second(folder, ", channel = \"alpha\""), [0.75; 3], "{color}");
    }
    // Luminance and a depth.
    write(folder, "a.exr", &[("Y", gray), ("Z", [1e9; 2])]);
    assert_eq!(second(folder, ""), [0.25; 3]);
    let colors = |names: [&'static str; 3]| [(names[0], [0.1; 2]), (names[1], [0.2; 2]), (names[2], [0.3; 2])];
    let beauty = colors(["beauty.R", "beauty.G", "beauty.B"]);
    write(folder, "a.exr", &[&beauty[..], &[("beauty.A", alpha), ("Z", gray)]].concat());
    assert_eq!(second(folder, ""), [0.1, 0.2, 0.3]);
    assert_eq!(second(folder, ", channel = \"alpha\""), [0.75; 3]);
    let small = colors(["r", "g", "b"]);
    write(folder, "a.exr", &small);
    assert_eq!(second(folder, ""), [0.1, 0.2, 0.3]);
    let albedo = [("albedo.R", [0.9; 2]), ("albedo.G", [0.9; 2]), ("albedo.B", [0.9; 2]), ("a", alpha)];
    write(folder, "a.exr", &[&albedo[..], &small[..]].concat());
    assert_eq!(second(folder, ""), [0.1, 0.2, 0.3], "what has no layer comes first");
    assert_eq!(second(folder, ", channel = \"alpha\""), [0.75; 3]);
    // Of several parts the one that has colors.
    let mut parts = Exr::new([2, 1], vec![("Z", vec![1e9; 2])]);
    parts.parts[0].0 = "depth";
    parts.parts.push(("color", colors(["R", "G", "B"]).map(|(name, values)| (name, values.to_vec())).to_vec()));
    parts.write(&folder.join("a.exr"));
    assert_eq!(second(folder, ""), [0.1, 0.2, 0.3]);
    write(folder, "sky.exr", &[("Y", gray)]);
    let text = format!("{}[[light]]\nenvironment.radiance.image = \"sky.exr\"\n", view([9.0; 3], [0.0; 3], 30.0, 4));
    scene(folder, &text);
}

#[test]
fn channels_that_are_no_image_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (names, told) in [
        (&["N.X", "N.Y", "N.Z"][..], "N.X, N.Y, N.Z"),
        (&["X", "Y", "Z"], "X, Y, Z"),
        (&["Y", "RY", "BY"], "BY, RY, Y"),
        (&["R", "G"], "G, R"),
    ] {
        let channels: Vec<_> = names.iter().map(|name| (*name, [0.5; 2])).collect();
        write(folder, "a.exr", &channels);
        let found = refusal_of(folder, "diffuse = { reflectance = { image = \"a.exr\" } }");
        assert_eq!(found.message, format!("a.exr has no channels R, G and B: it has the channels {told}"));
        assert_eq!(found.help.as_deref(), Some("save one of them alone, and it is a gray"));
    }
    write(folder, "a.exr", &[("Y", [0.5; 2])]);
    // The key stands in the object, which follows the material at once.
    let bent = "[[object]]\nshape.sphere = { center = [3, 0, 0], radius = 1 }\nmaterial = \"a\"\n\
                normal_map = { image = \"a.exr\" }";
    let found = refusal_of(folder, &format!("diffuse = {{ reflectance = 1 }}\n{bent}"));
    assert_eq!(found.message, "a.exr is gray, and a normal map has red, green and blue");
}

/// The data window lies in the display window, where a crop, an overscan or another program put it.
#[test]
fn an_image_is_its_display_window() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let value = |x: i32, y: i32| 0.1 + 0.1 * x as f32 + 0.01 * y as f32;
    for (corner, size, full) in [
        ([1, 1], [2, 1], [4, 3]),
        ([-2, -1], [7, 5], [4, 3]),
        ([0, 0], [4, 3], [4, 3]),
        ([3, -1], [3, 3], [4, 3]),
        ([-3, 2], [4, 4], [4, 3]),
        ([9, 9], [2, 2], [4, 3]),
    ] {
        let [right, below] = [0, 1].map(|axis| corner[axis] + size[axis] as i32);
        let inside = |x: i32, y: i32| (corner[0]..right).contains(&x) && (corner[1]..below).contains(&y);
        let rows = (corner[1]..below).flat_map(|y| (corner[0]..right).map(move |x| value(x, y).max(0.0)));
        let values: Vec<f32> = rows.collect();
        let channels = ["R", "G", "B"].map(|name| (name, values.clone())).to_vec();
        Exr { corner, full, ..Exr::new(size, channels) }.write(&folder.join("a.exr"));
        let scene = materials(folder, &["{ image = \"a.exr\" }", "{ image = \"a.exr\", channel = \"alpha\" }"]);
        let [color, alpha] = [0, 1].map(|material| image_of(&scene, material));
        assert_eq!([color.width(), color.height()], full);
        for (x, y) in (0..4).flat_map(|x| (0..3).map(move |y| (x, y))) {
            let expected = if inside(x, y) { [value(x, y), 1.0] } else { [0.0; 2] };
            let found = [&color, &alpha].map(|image| image.texel(x as usize, y as usize)[0]);
            assert_eq!(found, expected, "({x}, {y}) of {size:?} at {corner:?}");
        }
    }
    // A display window that would fill the memory is refused before.
    let huge = Exr { full: [16384, 8192], ..Exr::new([1, 1], vec![("Y", vec![0.5])]) };
    huge.write(&folder.join("a.exr"));
    let found = refusal_of(folder, "diffuse = { reflectance = { image = \"a.exr\" } }").message;
    assert!(found.ends_with("bytes cannot hold 16384 x 8192 pixels)"), "{found}");
}
