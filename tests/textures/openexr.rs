//! Which numbers of an OpenEXR file are read, and what they mean.

use abbe::material::Material;
use exr::meta::attribute::Chromaticities;
use exr::prelude::{Compression, Vec2};

use super::files::{image_of, materials, refusal_of};
use super::*;
use crate::look::files::Exr;

/// Writes a file of 2 x 1 pixels whose channels hold the given numbers.
fn write(folder: &Path, name: &str, channels: &[(&'static str, [f32; 2])]) {
    let channels = channels.iter().map(|(name, values)| (*name, values.to_vec())).collect();
    Exr::new([2, 1], channels).write(&folder.join(name));
}

/// Returns red, green and blue of the second pixel.
fn second_pixel(folder: &Path, options: &str) -> [f32; 3] {
    image_of(&materials(folder, &[&format!("{{ image = \"a.exr\"{options} }}")]), 0).texel(1, 0)
}

#[test]
fn grays_layers_and_small_letters_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (gray, alpha) = ([0.5, 0.25], [1.0, 0.75]);
    for name in ["Y", "Z", "R", "matte", "light.Y", "A"] {
        write(folder, "a.exr", &[(name, gray)]);
        assert_eq!(second_pixel(folder, ""), [0.25; 3], "{name}");
        assert_eq!(second_pixel(folder, ", channel = \"green\""), [0.25; 3], "{name}");
        let alone = if name == "A" { 0.25 } else { 1.0 };
        assert_eq!(second_pixel(folder, ", channel = \"alpha\""), [alone; 3], "{name}");
    }
    for [color, beside] in [["Y", "A"], ["mask.Z", "mask.A"], ["y", "a"]] {
        write(folder, "a.exr", &[(beside, alpha), (color, gray)]);
        assert_eq!(second_pixel(folder, ""), [0.25; 3], "{color}");
        assert_eq!(second_pixel(folder, ", channel = \"alpha\""), [0.75; 3], "{color}");
    }
    // Luminance and a depth.
    write(folder, "a.exr", &[("Y", gray), ("Z", [1e9; 2])]);
    assert_eq!(second_pixel(folder, ""), [0.25; 3]);
    let colors = |names: [&'static str; 3]| [(names[0], [0.1; 2]), (names[1], [0.2; 2]), (names[2], [0.3; 2])];
    let beauty = colors(["beauty.R", "beauty.G", "beauty.B"]);
    write(folder, "a.exr", &[&beauty[..], &[("beauty.A", alpha), ("Z", gray)]].concat());
    assert_eq!(second_pixel(folder, ""), [0.1, 0.2, 0.3]);
    assert_eq!(second_pixel(folder, ", channel = \"alpha\""), [0.75; 3]);
    let small = colors(["r", "g", "b"]);
    write(folder, "a.exr", &small);
    assert_eq!(second_pixel(folder, ""), [0.1, 0.2, 0.3]);
    let albedo = [("albedo.R", [0.9; 2]), ("albedo.G", [0.9; 2]), ("albedo.B", [0.9; 2]), ("a", alpha)];
    write(folder, "a.exr", &[&albedo[..], &small[..]].concat());
    assert_eq!(second_pixel(folder, ""), [0.1, 0.2, 0.3], "what has no layer comes first");
    assert_eq!(second_pixel(folder, ", channel = \"alpha\""), [0.75; 3]);
    // Of several parts, the one with colors is read.
    let mut parts = Exr::new([2, 1], vec![("Z", vec![1e9; 2])]);
    parts.parts[0].0 = "depth";
    parts.parts.push(("color", colors(["R", "G", "B"]).map(|(name, values)| (name, values.to_vec())).to_vec()));
    parts.write(&folder.join("a.exr"));
    assert_eq!(second_pixel(folder, ""), [0.1, 0.2, 0.3]);
    write(folder, "sky.exr", &[("Y", gray)]);
    let text = format!("{}[[light]]\nenvironment.radiance.image = \"sky.exr\"\n", view([9.0; 3], [0.0; 3], 30.0, 4));
    scene_in(folder, &text);
}

#[test]
fn unknown_compressions_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    // The values are so alike that the file is not stored uncompressed.
    let plain = Exr::new([16, 2], vec![("Y", vec![0.5; 32])]);
    Exr { compression: Compression::ZIP16, ..plain }.write(&folder.join("a.exr"));
    let mut bytes = std::fs::read(folder.join("a.exr")).unwrap();
    let attribute = b"compression\0compression\0\x01\0\0\0";
    let at = bytes.windows(attribute.len()).position(|part| part == attribute).expect("every file has it");
    // High-throughput JPEG 2000 in blocks of 256 and of 32 rows, and a number that may come.
    for compression in [10, 11, 200] {
        bytes[at + attribute.len()] = compression;
        std::fs::write(folder.join("a.exr"), &bytes).unwrap();
        let found = refusal_of(folder, "diffuse = { reflectance = { image = \"a.exr\" } }");
        assert_eq!(found.message, "cannot read a.exr: Abbe does not support its compression", "{compression}");
        assert_eq!(found.help.as_deref(), Some("save it with ZIP compression"));
    }
}

#[test]
fn channels_that_form_no_image_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for (names, reported) in [
        (&["N.X", "N.Y", "N.Z"][..], "N.X, N.Y, N.Z"),
        (&["X", "Y", "Z"], "X, Y, Z"),
        (&["Y", "RY", "BY"], "BY, RY, Y"),
        (&["R", "G"], "G, R"),
    ] {
        let channels: Vec<_> = names.iter().map(|name| (*name, [0.5; 2])).collect();
        write(folder, "a.exr", &channels);
        let found = refusal_of(folder, "diffuse = { reflectance = { image = \"a.exr\" } }");
        assert_eq!(found.message, format!("a.exr has no channels R, G and B: it has the channels {reported}"));
        let help = match names.contains(&"RY") {
            true => "save it as red, green and blue",
            false => "save one of them alone to use it as a gray",
        };
        assert_eq!(found.help.as_deref(), Some(help));
    }
    write(folder, "a.exr", &[("Y", [0.5; 2])]);
    // The key belongs to the object, which directly follows the material.
    let bent = "[[object]]\nshape.sphere = { center = [3, 0, 0], radius = 1 }\nmaterial = \"a\"\n\
                normal_map = { image = \"a.exr\" }";
    let found = refusal_of(folder, &format!("diffuse = {{ reflectance = 1 }}\n{bent}"));
    assert_eq!(found.message, "a.exr is gray, but a normal map has red, green and blue");
}

/// The data window lies in the display window wherever a crop, an overscan or another program put it.
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
    // A display window that would fill the memory is refused beforehand.
    let huge = Exr { full: [16384, 8192], ..Exr::new([1, 1], vec![("Y", vec![0.5])]) };
    huge.write(&folder.join("a.exr"));
    let found = refusal_of(folder, "diffuse = { reflectance = { image = \"a.exr\" } }").message;
    assert!(found.ends_with("bytes cannot hold 16384 x 8192 pixels)"), "{found}");
}

fn pair([x, y]: [f32; 2]) -> Vec2<f32> {
    Vec2(x, y)
}

const ACESCG: [[f32; 2]; 4] = [[0.713, 0.293], [0.165, 0.830], [0.128, 0.044], [0.32168, 0.33767]];

/// Writes 2 x 1 pixels with the given primaries and white.
fn write_colors(folder: &Path, [red, green, blue, white]: [[f32; 2]; 4], colors: [[f32; 3]; 2]) {
    let channels = ["R", "G", "B"].into_iter().enumerate().map(|(c, name)| (name, colors.map(|rgb| rgb[c]).to_vec()));
    let [red, green, blue, white] = [red, green, blue, white].map(pair);
    let chromaticities = Some(Chromaticities { red, green, blue, white });
    Exr { chromaticities, ..Exr::new([2, 1], channels.collect()) }.write(&folder.join("a.exr"));
}

#[test]
fn colors_of_another_space_are_converted_and_numbers_are_not() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let read = |options: &str| {
        let scene = materials(folder, &[&format!("{{ image = \"a.exr\"{options} }}")]);
        (image_of(&scene, 0).texel(1, 0), scene.warnings)
    };
    let color = [0.5, 0.25, 0.125];
    write_colors(folder, ACESCG, [[0.5; 3], color]);
    // ACEScg to linear Rec.709 with the Bradford adaptation, to the digits of the ACES 1.3 transform.
    let matrix = [[1.70505, -0.62179, -0.08326], [-0.13026, 1.14080, -0.01055], [-0.02400, -0.12897, 1.15297]];
    let expected = matrix.map(|row: [f32; 3]| row[0] * color[0] + row[1] * color[1] + row[2] * color[2]);
    let (found, warnings) = read("");
    for c in 0..3 {
        assert!((found[c] - expected[c]).abs() < 2e-5, "{found:?} for {expected:?}");
    }
    assert_eq!(warnings, Vec::<String>::new());
    assert_eq!(read(", channel = \"green\"").0, [0.25; 3]);
    let mask =
        "mask = { material = \"m0\", opacity = { image = \"a.exr\" } }\n[material.m0]\ndiffuse.reflectance = 0.5";
    let text = format!(
        "{}[material.a]\n{mask}\n[[object]]\nmaterial = \"a\"\nshape.sphere = {{ center = [0, 0, 0], radius = 1 }}\n",
        view([0.0, 0.0, 9.0], [0.0; 3], 30.0, 4)
    );
    let masked = scene_in(folder, &text);
    let opacity = masked.materials.iter().find_map(|named| match &named.material {
        Material::Mask(mask) => Some(mask.opacity.kind.clone()),
        _ => None,
    });
    let Some(CurveKind::Texture(texture)) = opacity else { panic!("the opacity is an image") };
    assert_eq!(texture.image.texel(1, 0), color);
    // The same color space by its name, and Rec.709 as other programs write it.
    let channels = ["R", "G", "B"].into_iter().zip(color).map(|(name, value)| (name, vec![value; 2])).collect();
    let id = |id: &str| vec![("colorInteropID", id.to_owned())];
    Exr { texts: id("lin_ap1_scene"), ..Exr::new([2, 1], channels) }.write(&folder.join("a.exr"));
    assert_eq!(read("").0, found);
    write_colors(folder, [[0.64, 0.33], [0.3, 0.6], [0.15, 0.06], [0.31271, 0.32902]], [[0.5; 3], color]);
    assert_eq!(read(""), (color, vec![]));
}

/// Rec.709 has no colors with negative numbers, and wide spaces hold colors outside of it.
#[test]
fn colors_outside_of_rec709_are_reported() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let place = format!("{}:", folder.join("scene.toml").display());
    let behind_its_place = |warning: String| {
        let rest = warning.strip_prefix(&place).and_then(|rest| rest.split_once(": "));
        rest.expect("a warning has its place in the scene").1.to_owned()
    };
    let warnings = || -> Vec<String> {
        let warnings = materials(folder, &["{ image = \"a.exr\" }"]).warnings;
        warnings.into_iter().map(behind_its_place).collect()
    };
    let reported = |others: &str| {
        vec![format!("a.exr: pixel (0, 0) lies outside Rec.709{others}: negative values there count as 0")]
    };
    write_colors(folder, ACESCG, [[0.0, 0.5, 0.0], [0.5; 3]]);
    assert_eq!(warnings(), reported(""));
    assert_eq!(second_pixel(folder, ""), [0.5; 3]);
    write_colors(folder, ACESCG, [[0.0, 0.5, 0.0]; 2]);
    assert_eq!(warnings(), reported(", as does 1 other"));
    // Rec.709's own green in ACEScg, with the rounding of halves, lies on the edge.
    let green = [0.169_799_8, 0.458_251_95, 0.054_779_053];
    write_colors(folder, ACESCG, [green; 2]);
    assert_eq!(warnings(), Vec::<String>::new());
    write_colors(folder, [[0.2, 0.2], [0.3, 0.3], [0.4, 0.4], [0.3, 0.3]], [[0.5; 3]; 2]);
    let none = "a.exr: its chromaticities define no color space: it is read as linear Rec.709";
    assert_eq!(warnings(), [none]);
    // An image of the sky warns as well.
    write_colors(folder, ACESCG, [[0.0, 9.0, 0.0], [0.5; 3]]);
    let text = format!("{}[[light]]\nenvironment.radiance.image = \"a.exr\"\n", view([9.0; 3], [0.0; 3], 30.0, 4));
    let sky = scene_in(folder, &text).warnings;
    assert!(sky.iter().any(|reported| reported.contains("a.exr: pixel (0, 0) lies outside Rec.709")), "{sky:?}");
}

/// Lossy compression leaves numbers below 0 where the image is black.
#[test]
fn noise_below_0_is_black_and_all_else_there_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let write = |compression: Compression, half: bool, dark: f32| {
        let values: Vec<f32> = (0..64).map(|i| if i == 9 { dark } else { 0.01 * (i % 8) as f32 }).collect();
        let channels = ["R", "G", "B"].map(|name| (name, values.clone())).to_vec();
        Exr { half, compression, ..Exr::new([8, 8], channels) }.write(&folder.join("a.exr"));
    };
    let darkest = || {
        let image = image_of(&materials(folder, &["{ image = \"a.exr\" }"]), 0);
        (0..64).map(|i| image.texel(i % 8, i / 8)[0]).fold(f32::MAX, f32::min)
    };
    for (compression, half) in [
        (Compression::DWAA(None), false),
        (Compression::DWAB(None), true),
        (Compression::B44, true),
        (Compression::B44A, true),
    ] {
        write(compression, half, -0.01);
        assert_eq!(darkest(), 0.0, "{compression}");
    }
    // The limit is the rounding of halves at the mean, which is 0.0348.
    write(Compression::ZIP16, false, -0.034 / 2048.0);
    assert_eq!(darkest(), 0.0);
    let light = "light is finite and not negative: save the image with its negative values set to 0";
    for (compression, half, dark) in [
        (Compression::ZIP16, false, -0.036 / 2048.0),
        (Compression::PIZ, true, -0.5),
        // This compression loses something only for halves.
        (Compression::B44, false, -0.5),
    ] {
        write(compression, half, dark);
        let found = refusal_of(folder, "diffuse = { reflectance = { image = \"a.exr\" } }");
        assert_eq!(found.message, format!("a.exr: pixel (1, 1) is [{dark:?}, {dark:?}, {dark:?}]"));
        assert_eq!(found.help.as_deref(), Some(light));
    }
}
