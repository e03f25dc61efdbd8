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
