//! Radiance pictures: the meaning of the four bytes, and the ways in which a row is packed.

use abbe::material::Material;

use super::*;

const HEADER: &str = "#?RADIANCE\n# made by hand\nEXPOSURE=1\nFORMAT=32-bit_rle_rgbe\n\n";

fn compile_image(bytes: &[u8]) -> abbe::Result<Scene<Curve>> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.hdr"), bytes).unwrap();
    // No number of a picture exceeds 2^127.
    let text = format!(
        "{}[material.a]\ndiffuse = {{ reflectance = {{ image = \"a.hdr\", scale = 1e-39 }} }}\n\
         [[object]]\nmaterial = \"a\"\nshape.sphere = {{ center = [0, 0, 0], radius = 1 }}\n\
         [[light]]\nenvironment.radiance = 1\n",
        view([0.0, 0.0, 9.0], [0.0; 3], 30.0, 4)
    );
    Source { path: folder.path().join("scene.toml"), text }.compile()
}

/// Returns the first texels of the first row of a picture.
fn row(size: &str, bytes: &[u8], count: usize) -> Vec<[f32; 3]> {
    texels(&[HEADER.as_bytes(), size.as_bytes(), b"\n", bytes].concat(), count)
}

fn texels(file: &[u8], count: usize) -> Vec<[f32; 3]> {
    let scene = compile_image(file).unwrap();
    let Material::Diffuse(diffuse) = &scene.materials[0].material else { panic!("it is diffuse") };
    let CurveKind::Texture(texture) = &diffuse.reflectance.kind else { panic!("it is an image") };
    (0..count).map(|x| texture.image.texel(x, 0)).collect()
}

#[test]
fn every_exponent_of_a_radiance_picture_is_a_power_of_two() {
    for exponent in 0..=u8::MAX {
        let found = row("-Y 1 +X 1", &[255, 128, 1, exponent], 1)[0];
        let unit = if exponent == 0 { 0.0 } else { (f64::from(exponent) - 136.0).exp2() };
        assert_eq!(found.map(f64::from), [255.0, 128.0, 1.0].map(|color| color * unit), "{exponent}");
    }
}

/// "Radiance File Formats": the light that a picture shows is its numbers divided by all exposures that were applied.
#[test]
fn exposures_of_a_radiance_picture_are_taken_out() {
    let picture = |lines: &str| {
        let text = HEADER.replace("EXPOSURE=1\n", lines) + "-Y 1 +X 1\n";
        texels(&[text.as_bytes(), &[128, 64, 32, 129]].concat(), 1)[0]
    };
    assert_eq!(picture(""), [1.0, 0.5, 0.25]);
    assert_eq!(picture("EXPOSURE=4\n"), [0.25, 0.125, 0.0625]);
    assert_eq!(picture("EXPOSURE= 4.0 \nEXPOSURE=2.5e-1\n"), [1.0, 0.5, 0.25]);
    assert_eq!(picture("COLORCORR=2 1 0.5\nEXPOSURE=2\n"), [0.25, 0.25, 0.25]);
    // The exposure of a picture from which this one was made does not count.
    assert_eq!(picture("\tEXPOSURE=4\n"), [1.0, 0.5, 0.25]);
}

/// Light with the primaries of Rec.2020 has other numbers in Rec.709. Light with those of Rec.709 keeps its numbers.
#[test]
fn primaries_of_a_radiance_picture_are_brought_to_rec709() {
    let lamp = |primaries: &str| {
        let text = HEADER.replace("EXPOSURE=1\n", &format!("PRIMARIES={primaries}\n")) + "-Y 2 +X 2\n";
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("a.hdr"), [text.as_bytes(), &[128, 64, 32, 129].repeat(4)].concat()).unwrap();
        let view = view([0.0, 0.0, 9.0], [0.0; 3], 30.0, 4);
        let text = view
            + "[material.a]\nemissive.radiance = { image = \"a.hdr\" }\n[[object]]\nmaterial = \"a\"\n\
               shape.sphere = { center = [0, 0, 0], radius = 1 }\n";
        let scene = scene_in(folder.path(), &text);
        let Material::Emissive(emissive) = &scene.materials[0].material else { panic!("it shines") };
        let CurveKind::Texture(texture) = &emissive.radiance.kind else { panic!("it is an image") };
        (texture.image.texel(0, 0), scene.warnings.clone())
    };
    let rec709 = "0.64 0.33 0.3 0.6 0.15 0.06 0.3127 0.329";
    assert_eq!(lamp(rec709), ([1.0, 0.5, 0.25], vec![]));
    let (found, warnings) = lamp("0.708 0.292 0.17 0.797 0.131 0.046 0.3127 0.329");
    // ITU-R BT.2087: from Rec.2020 to Rec.709.
    let expected = [[1.6605, -0.5876, -0.0728], [-0.1246, 1.1329, -0.0083], [-0.0182, -0.1006, 1.1187]]
        .map(|row| row[0] + 0.5 * row[1] + 0.25 * row[2]);
    let is_near = (0..3).all(|c| (f64::from(found[c]) - expected[c]).abs() < 2e-4);
    assert!(is_near, "{found:?} for {expected:?}");
    assert!(warnings.is_empty(), "{warnings:?}");
    for unknown in ["0.64 0.33", "a b c d e f g h"] {
        let (found, warnings) = lamp(unknown);
        assert_eq!(found, [1.0, 0.5, 0.25]);
        assert!(warnings.len() == 1 && warnings[0].contains("its primaries are not known"), "{warnings:?}");
    }
}

#[test]
fn a_radiance_picture_of_another_program_is_read() {
    let expected = row("-Y 1 +X 1", &[9, 8, 7, 128], 1);
    for from in [("#?RADIANCE", "#?RGBE"), ("\n", "\r\n")] {
        let header = format!("{HEADER}-Y 1 +X 1\n").replace(from.0, from.1);
        assert_eq!(texels(&[header.as_bytes(), &[9, 8, 7, 128]].concat(), 1), expected, "{header:?}");
    }
}

#[test]
fn a_row_is_the_same_in_whatever_way_it_is_packed() {
    const COUNT: usize = 600;
    let texel = |x: usize| if x < 2 { [9, 8, x as u8, 128] } else { [200, 100, 50, 129] };
    let flat: Vec<u8> = (0..COUNT).flat_map(texel).collect();
    let size = format!("-Y 1 +X {COUNT}");
    let expected = row(&size, &flat, COUNT);
    assert_eq!(expected[1], [9.0, 8.0, 1.0].map(|color: f32| color / 256.0));
    // 3 texels, then 597 = 85 + 2 * 256 more.
    let older = [&flat[..12], &[1, 1, 1, 85, 1, 1, 1, 2]].concat();
    assert_eq!(row(&size, &older, COUNT), expected);
    let mut newer = vec![2, 2, (COUNT >> 8) as u8, COUNT as u8];
    for channel in 0..4 {
        newer.extend([2, texel(0)[channel], texel(1)[channel]]);
        // 598 = 4 * 127 + 90
        newer.extend([255, texel(2)[channel]].repeat(4));
        newer.extend([128 + 90, texel(2)[channel]]);
    }
    assert_eq!(row(&size, &newer, COUNT), expected);
    // A row of fewer than 8 texels is never packed in the newer way, even if it begins as if it were.
    assert_eq!(row("-Y 1 +X 1", &[2, 2, 0, 136], 1), [[2.0, 2.0, 0.0]]);
}

#[test]
fn mistakes_in_a_radiance_picture_are_reported() {
    let header = |from: &str, to: &str| HEADER.replace(from, to);
    let file_with = |size: &str, bytes: &[u8]| [HEADER.as_bytes(), size.as_bytes(), b"\n", bytes].concat();
    let packed = |bytes: &[u8]| file_with("-Y 1 +X 8", &[&[2, 2, 0, 8], bytes].concat());
    let cases = [
        (b"#?RGB".to_vec(), "it does not begin like one"),
        (HEADER.as_bytes().to_vec(), "it ends too early"),
        (
            header("rgbe", "xyze").into_bytes(),
            "its format is \"32-bit_rle_xyze\", but only 32-bit_rle_rgbe is supported",
        ),
        (header("=1", "=0").into_bytes(), "its EXPOSURE is \"0\", which it cannot be divided by"),
        (header("=1", "= dark").into_bytes(), "its EXPOSURE is \"dark\", which it cannot be divided by"),
        (
            header("=1", "=1e-300\nEXPOSURE=1e-300").into_bytes(),
            "its EXPOSURE is \"1e-300\", which it cannot be divided by",
        ),
        (header("EXPOSURE=1", "COLORCORR=1 2").into_bytes(), "its COLORCORR is \"1 2\", which it cannot be divided by"),
        (file_with("+Y 1 +X 1", &[9; 4]), "its size is \"+Y 1 +X 1\", but only -Y height +X width is supported"),
        (file_with("-Y 1 +X few", &[9; 4]), "its size is \"-Y 1 +X few\", but only -Y height +X width is supported"),
        (file_with("-Y 0 +X 1", &[]), "it has no pixels"),
        (file_with("-Y 2 +X 1", &[9; 7]), "it ends too early"),
        (
            file_with("-Y 2 +X 1", &[9, 9, 9, 9, 1, 1, 1, 1]),
            "row 1 (counted from 0) is not as long as the image is wide",
        ),
        (
            file_with("-Y 1 +X 3", &[9, 9, 9, 9, 1, 1, 1, 3]),
            "row 0 (counted from 0) is not as long as the image is wide",
        ),
        (
            file_with("-Y 1 +X 3", &[&[9; 4][..], &[1, 1, 1, 0].repeat(9)].concat()),
            "row 0 (counted from 0) is not as long as the image is wide",
        ),
        (file_with("-Y 1 +X 9", &[2, 2, 0, 8]), "row 0 (counted from 0) is not as long as the image is wide"),
        (packed(&[128 + 9, 5]), "row 0 (counted from 0) is not as long as the image is wide"),
        (packed(&[128 + 8, 5, 9, 1, 2, 3]), "row 0 (counted from 0) is not as long as the image is wide"),
        (packed(&[128 + 8, 5, 8, 1, 2, 3]), "it ends too early"),
    ];
    for (bytes, problem) in cases {
        let Err(abbe::Error::Scene(mistakes)) = compile_image(&bytes) else { panic!("{problem}: it is read") };
        let message = match problem.contains("supported") {
            true => format!("cannot read a.hdr: {problem}"),
            false => format!("a.hdr is not a valid Radiance image ({problem})"),
        };
        assert_eq!(mistakes[0].message, message);
    }
}
