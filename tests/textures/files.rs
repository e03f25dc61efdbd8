//! The kinds of image files, what is read of them, and damaged files.

use abbe::material::Material;

use super::*;
use crate::support::pictures::{L8, L16, LA8, LA16, RGB16, RGBA8, RGBA16, jpeg, radiance};

/// Compiles a scene with a material for every reflectance.
pub(super) fn materials(folder: &Path, reflectances: &[&str]) -> Scene<Curve> {
    let materials: String = (reflectances.iter().enumerate())
        .map(|(i, reflectance)| {
            format!(
                "[material.m{i}]\ndiffuse = {{ reflectance = {reflectance} }}\n\
                 [[object]]\nshape.sphere = {{ center = [{i}, 0, 0], radius = 0.4 }}\nmaterial = \"m{i}\"\n"
            )
        })
        .collect();
    let text = format!("{}{materials}", view([0.0, 0.0, 9.0], [0.0; 3], 30.0, 4));
    scene_in(folder, &format!("{text}[[light]]\nenvironment = {{ radiance = 1 }}\n"))
}

pub(super) fn image_of(scene: &Scene<Curve>, material: usize) -> Arc<Image> {
    let Material::Diffuse(diffuse) = &scene.materials[material].material else { panic!("all are diffuse") };
    let CurveKind::Texture(texture) = &diffuse.reflectance.kind else { panic!("all are images") };
    texture.image.clone()
}

/// Decodes sRGB by IEC 61966-2-1, written in another way than the renderer does.
fn from_srgb(x: f64) -> f64 {
    if x < 0.0405 { x / 12.92 } else { (2.4 * ((x + 0.055) / 1.055).ln()).exp() }
}

#[test]
fn every_kind_of_png_is_read_as_it_is_meant() {
    let folder = tempfile::tempdir().unwrap();
    let [red, green, blue, alpha] = [0.2, 0.5, 0.9, 0.6];
    let [bytes, words] = [255.0, 65535.0];
    let as_bytes = |list: &[f64]| -> Vec<u8> { list.iter().map(|x| (x * bytes).round() as u8).collect() };
    let as_words =
        |list: &[f64]| -> Vec<u8> { list.iter().flat_map(|x| ((x * words).round() as u16).to_be_bytes()).collect() };
    let color = [red, green, blue];
    let gray = [green; 3];
    let kinds: [(&str, _, Vec<u8>, [f64; 3], f64); 8] = [
        ("l8.png", L8, as_bytes(&[green]), gray, bytes),
        ("la8.png", LA8, as_bytes(&[green, alpha]), gray, bytes),
        ("rgb8.png", RGB8, as_bytes(&color), color, bytes),
        ("rgba8.png", RGBA8, as_bytes(&[red, green, blue, alpha]), color, bytes),
        ("l16.png", L16, as_words(&[green]), gray, words),
        ("la16.png", LA16, as_words(&[green, alpha]), gray, words),
        ("rgb16.png", RGB16, as_words(&color), color, words),
        ("rgba16.png", RGBA16, as_words(&[red, green, blue, alpha]), color, words),
    ];
    for (name, kind, numbers, color, steps) in kinds {
        write_png(folder.path(), name, 1, kind, &numbers);
        let has_alpha = name.contains('a');
        let image = |options: &str| format!("{{ image = \"{name}\"{options} }}");
        let mut options =
            vec![image(""), image(", encoding = \"linear\""), image(", channel = \"blue\", encoding = \"linear\"")];
        options.extend(has_alpha.then(|| image(", channel = \"alpha\"")));
        let scene = materials(folder.path(), &options.iter().map(String::as_str).collect::<Vec<_>>());
        // Half a step, which sRGB widens at most 2.3 times where it is steepest, and the rounding to f32.
        let tolerance = 0.5 / steps + 1e-7;
        assert_near(image_of(&scene, 0).texel(0, 0), color.map(from_srgb), 2.3 * tolerance, name);
        assert_near(image_of(&scene, 1).texel(0, 0), color, tolerance, name);
        assert_near(image_of(&scene, 2).texel(0, 0), [color[2]; 3], tolerance, name);
        if has_alpha {
            assert_near(image_of(&scene, 3).texel(0, 0), [alpha; 3], tolerance, name);
        }
        let reported = scene.warnings.iter().filter(|warning| warning.contains("alpha")).count();
        // Once for each way of reading the file that leaves alpha out, except for single channels.
        assert_eq!(reported, if has_alpha { 2 } else { 0 }, "{name}: {:?}", scene.warnings);
    }
}

/// Returns a color profile with nothing but the XYZ of red, green and blue, adapted to D50.
fn profile(primaries: [[f64; 3]; 3]) -> Vec<u8> {
    let mut bytes = vec![0; 128];
    bytes.extend(3u32.to_be_bytes());
    for (i, tag) in (0u32..).zip([b"rXYZ", b"gXYZ", b"bXYZ"]) {
        bytes.extend(tag);
        bytes.extend([168 + 20 * i, 20].map(u32::to_be_bytes).as_flattened());
    }
    for primary in primaries {
        bytes.extend(b"XYZ \0\0\0\0");
        bytes.extend(primary.map(|x| ((x * 65536.0) as i32).to_be_bytes()).as_flattened());
    }
    bytes
}

/// Primaries from Apple's profile.
const DISPLAY_P3: [[f64; 3]; 3] = [[0.5151, 0.2412, -0.0011], [0.2920, 0.6922, 0.0419], [0.1571, 0.0666, 0.7841]];
/// Primaries from the profile of the International Color Consortium.
const SRGB: [[f64; 3]; 3] = [[0.4361, 0.2225, 0.0139], [0.3851, 0.7169, 0.0971], [0.1431, 0.0606, 0.7141]];

#[test]
fn an_ignored_color_profile_of_a_jpeg_is_reported() {
    let p3 = profile(DISPLAY_P3);
    let damaged = (0..p3.len()).step_by(7).map(|end| (p3[..end].to_vec(), false));
    for (profile, is_reported) in [(p3.clone(), true), (profile(SRGB), false)].into_iter().chain(damaged) {
        let folder = tempfile::tempdir().unwrap();
        let mut encoder = jpeg_encoder::Encoder::new_file(folder.path().join("a.jpg"), 90).unwrap();
        encoder.add_icc_profile(&profile).unwrap();
        encoder.encode(&[9, 8, 7], 1, 1, jpeg_encoder::ColorType::Rgb).unwrap();
        let reported = materials(folder.path(), &["{ image = \"a.jpg\" }"]).warnings.clone();
        let said =
            |reported: &String| reported.contains("a color profile (ICC) with other primaries, which is ignored");
        assert!(
            reported.len() == usize::from(is_reported) && reported.iter().all(said),
            "{} bytes: {reported:?}",
            profile.len()
        );
    }
}

#[test]
fn a_photo_of_a_turned_camera_is_reported() {
    // A directory of two entries of 12 bytes. The second one is the orientation, 6 for a quarter turn.
    let exif = |orientation: u8, is_big: bool| -> Vec<u8> {
        let short = |x: u16| if is_big { x.to_be_bytes() } else { x.to_le_bytes() };
        let long = |x: u32| if is_big { x.to_be_bytes() } else { x.to_le_bytes() };
        let entry =
            |tag: u16, value: u8| [&short(tag)[..], &short(3), &long(1), &short(value.into()), &[0; 2]].concat();
        let head = if is_big { b"MM\0*" } else { b"II*\0" };
        [&head[..], &long(8), &short(2), &entry(0x100, 8), &entry(0x112, orientation), &[0; 4]].concat()
    };
    let whole = jpeg([8, 8], 75, false, &[100; 8 * 8 * 3]);
    let damaged = (0..38).map(|end| (exif(6, false)[..end].to_vec(), end > 31));
    let good = [(exif(6, true), true), (exif(8, false), true), (exif(1, true), false), (exif(0, false), false)];
    for (exif, is_reported) in good.into_iter().chain(damaged) {
        let folder = tempfile::tempdir().unwrap();
        let length = (exif.len() as u16 + 8).to_be_bytes();
        let bytes = [&whole[..2], &[0xff, 0xe1], &length, b"Exif\0\0", &exif, &whole[2..]].concat();
        std::fs::write(folder.path().join("a.jpg"), bytes).unwrap();
        let reported = materials(folder.path(), &["{ image = \"a.jpg\" }"]).warnings.clone();
        let said = |reported: &String| {
            reported.contains("the EXIF orientation of a.jpg is ignored: save it upright if it looks")
        };
        assert!(reported.len() == usize::from(is_reported) && reported.iter().all(said), "{exif:?}: {reported:?}");
    }
}

/// Only colors are concerned, and only if the file does not also say that they are sRGB.
#[test]
fn colors_of_a_png_that_are_not_srgb_are_reported() {
    type Marks = fn(&mut png::Info);
    let p3 = png::SourceChromaticities::new((0.3127, 0.329), (0.68, 0.32), (0.265, 0.69), (0.15, 0.06));
    let marks: [(Marks, Option<&str>); 7] = [
        (|_| (), None),
        (|info| info.source_gamma = Some(png::ScaledFloat::new(1.0)), Some("a gamma of 1 (gAMA)")),
        (|info| info.source_gamma = Some(png::ScaledFloat::new(0.45455)), None),
        (|info| info.srgb = Some(png::SrgbRenderingIntent::Perceptual), None),
        (|_| (), Some("other primaries (cHRM)")),
        (
            |info| info.icc_profile = Some(profile(DISPLAY_P3).into()),
            Some("a color profile (ICC) with other primaries"),
        ),
        (|info| info.icc_profile = Some(profile(SRGB).into()), None),
    ];
    for (number, (mark, expected)) in marks.into_iter().enumerate() {
        let folder = tempfile::tempdir().unwrap();
        let mut info = png::Info::with_size(1, 1);
        (info.color_type, info.bit_depth) = (png::ColorType::Rgb, png::BitDepth::Eight);
        mark(&mut info);
        info.source_chromaticities = (number == 4).then_some(p3);
        let file = std::fs::File::create(folder.path().join("a.png")).unwrap();
        let mut writer = png::Encoder::with_info(file, info).unwrap().write_header().unwrap();
        writer.write_image_data(&[9, 8, 7]).unwrap();
        writer.finish().unwrap();
        let reported = materials(folder.path(), &["{ image = \"a.png\" }"]).warnings.clone();
        match expected {
            None => assert!(reported.is_empty(), "{reported:?}"),
            Some(said) => assert!(reported.len() == 1 && reported[0].contains(said), "{reported:?}"),
        }
        let data_reflectance = ["{ image = \"a.png\", encoding = \"linear\" }"];
        assert!(materials(folder.path(), &data_reflectance).warnings.is_empty());
    }
}

#[test]
fn a_jpeg_and_images_of_floats_are_read() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: Vec<u8>| std::fs::write(folder.path().join(name), bytes).unwrap();
    write("gray.jpg", jpeg([8, 8], 75, false, &[100; 64]));
    write("color.jpeg", jpeg([20, 9], 95, true, &[100, 50, 200].repeat(20 * 9)));
    exr::prelude::write_rgba_file(folder.path().join("a.exr"), 2, 1, |x, _| (0.1 + x as f32, 0.5, 0.25, 0.75)).unwrap();
    write("b.hdr", radiance(2, &[[0.5, 0.25, 0.125]; 4]));
    let reflectances = [
        "{ image = \"gray.jpg\" }",
        "{ image = \"a.exr\", scale = 0.9 }",
        "{ image = \"a.exr\", channel = \"alpha\" }",
        "{ image = \"b.hdr\" }",
        "{ image = \"b.hdr\", encoding = \"srgb\" }",
        "{ image = \"color.jpeg\" }",
    ];
    let scene = materials(folder.path(), &reflectances);
    // A JPEG may be one step off.
    assert_near(image_of(&scene, 0).texel(5, 3), [from_srgb(100.0 / 255.0); 3], 4e-3, "jpeg");
    assert_near(image_of(&scene, 1).texel(1, 0), [1.1, 0.5, 0.25], 1e-6, "exr");
    assert_near(image_of(&scene, 2).texel(1, 0), [0.75; 3], 0.0, "alpha of exr");
    assert_near(image_of(&scene, 3).texel(1, 1), [0.5, 0.25, 0.125], 0.0, "hdr");
    assert_near(image_of(&scene, 4).texel(0, 0), [0.5, 0.25, 0.125].map(from_srgb), 1e-7, "encoded hdr");
    // Two steps of sRGB, which are at most 2.3 times as wide where it is steepest.
    let color = [100.0, 50.0, 200.0].map(|x| from_srgb(x / 255.0));
    assert_near(image_of(&scene, 5).texel(19, 8), color, 2.3 * 2.0 / 255.0, "progressive jpeg");
}

#[test]
fn an_image_of_many_materials_is_read_once_and_belongs_to_the_hash() {
    let folder = tempfile::tempdir().unwrap();
    let write = |number| write_png(folder.path(), "a.png", 1, RGB8, &[number; 6]);
    write(9);
    let image = "{ image = \"a.png\", repeat = 3 }";
    let first =
        materials(folder.path(), &["{ image = \"a.png\" }", image, "{ checker = [0.2, { image = \"a.png\" }] }"]);
    assert!(Arc::ptr_eq(&image_of(&first, 0), &image_of(&first, 1)));
    let hash = || materials(folder.path(), &[image]).hash;
    let before = hash();
    assert_eq!(before, hash());
    write(10);
    assert_ne!(before, hash());
}

/// Returns the message that refuses a scene whose only reflectance is an image.
fn refusal(folder: &Path, reflectance: &str) -> String {
    refusal_of(folder, &format!("diffuse = {{ reflectance = {reflectance} }}")).message
}

/// Returns the diagnostic that refuses a scene of a material.
pub(super) fn refusal_of(folder: &Path, material: &str) -> abbe::Diagnostic {
    let text = format!(
        "{}[material.a]\n{material}\n[[object]]\nmaterial = \"a\"\n\
         shape.sphere = {{ center = [0, 0, 0], radius = 1 }}\n",
        view([0.0, 0.0, 9.0], [0.0; 3], 30.0, 4)
    );
    first_mistake(folder, &text)
}

#[test]
fn impossible_thicknesses_are_refused_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    for (name, bad, reported) in
        [("hole.exr", f32::NAN, "NaN"), ("dark.exr", -0.25, "-0.25"), ("far.exr", f32::INFINITY, "inf")]
    {
        let at = |x: usize, y: usize| if (x, y) == (2, 1) { (bad, bad, bad) } else { (0.5, 0.5, 0.5) };
        exr::prelude::write_rgb_file(folder.path().join(name), 4, 3, at).unwrap();
        let image = format!("{{ image = \"{name}\", scale = 600 }}");
        for material in [
            format!("thin = {{ index = 1.33, thickness_nm = {image} }}"),
            format!("conductor = {{ metal = \"Ti\", coating = [{{ index = 2.4, thickness_nm = {image} }}] }}"),
        ] {
            let found = refusal_of(folder.path(), &material);
            assert_eq!(
                found.message,
                format!("{name}: pixel (2, 1) is [{reported}, {reported}, {reported}]"),
                "{material}"
            );
            let save = if bad < 0.0 { ": save the image with its negative values set to 0" } else { "" };
            let help = format!("thicknesses are finite and not negative{save}");
            assert_eq!(found.help.as_deref(), Some(help.as_str()), "{material}");
        }
    }
}

#[test]
fn impossible_texels_are_refused_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bad: f32| {
        let at = |x: usize, y: usize| if (x, y) == (2, 1) { (0.5, bad, 0.1) } else { (0.5, 0.5, 0.5) };
        exr::prelude::write_rgb_file(folder.path().join(name), 4, 3, at).unwrap();
    };
    write("hole.exr", f32::NAN);
    write("dark.exr", -0.25);
    write("bright.exr", 1.5);
    let refused = |reflectance| refusal(folder.path(), reflectance);
    assert_eq!(refused("{ image = \"hole.exr\" }"), "hole.exr: pixel (2, 1) is [0.5, NaN, 0.1]");
    assert_eq!(refused("{ image = \"dark.exr\", channel = \"green\" }"), "dark.exr: pixel (2, 1) is [-0.25]");
    let more = "and no surface returns more than 1";
    assert_eq!(refused("{ image = \"bright.exr\" }"), format!("bright.exr: pixel (2, 1) is 1.5, {more}"));
    let scaled = refused("{ image = \"bright.exr\", scale = 0.7 }");
    assert_eq!(scaled, format!("bright.exr: pixel (2, 1) is 1.5 times its scale of 0.7, {more}"));
    let mask = "[material.b]\nmask = { material = \"a\", opacity = { image = \"bright.exr\" } }";
    let reported = refusal_of(folder.path(), &format!("diffuse = {{ reflectance = 1 }}\n{mask}")).message;
    assert_eq!(reported, "bright.exr: pixel (2, 1) is 1.5, and a share is at most 1");
    // A number that is not used may be anything.
    materials(
        folder.path(),
        &["{ image = \"hole.exr\", channel = \"red\" }", "{ image = \"bright.exr\", scale = 0.6 }"],
    );
    // A picture that would fill the memory, as its header alone says.
    write_png(folder.path(), "huge.png", 1, L8, &[7]);
    let mut huge = std::fs::read(folder.path().join("huge.png")).unwrap();
    huge[16..24].copy_from_slice(&[0, 1, 0, 0, 0, 1, 0, 0]);
    let sum = crc32fast::hash(&huge[12..29]);
    huge[29..33].copy_from_slice(&sum.to_be_bytes());
    std::fs::write(folder.path().join("huge.png"), huge).unwrap();
    let reported = refused("{ image = \"huge.png\" }");
    assert_eq!(reported, "cannot read huge.png: its 65536 x 65536 pixels are more than 134217728");
}

#[test]
fn an_image_of_another_kind_than_its_name_says_is_reported() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    exr::prelude::write_rgb_file(folder.join("exr"), 1, 1, |_, _| (0.5, 0.5, 0.5)).unwrap();
    let open_exr = std::fs::read(folder.join("exr")).unwrap();
    write_png(folder, "png", 1, L8, &[7]);
    let png = std::fs::read(folder.join("png")).unwrap();
    let joint = jpeg([8, 8], 75, false, &[100; 64]);
    for (name, bytes, reported, help) in [
        ("a.b.jpg", &png[..], "JPEG format: it is a PNG image", "rename it to a.b.png"),
        ("a.png", &joint, "PNG format: it is a JPEG image", "rename it to a.jpg"),
        ("a.hdr", &open_exr, "Radiance format: it is an OpenEXR image", "rename it to a.exr"),
        ("a.exr", b"#?RADIANCE\n", "OpenEXR format: it is a Radiance image", "rename it to a.hdr"),
        ("a.jpeg", b"II*\0", "JPEG format: it is a TIFF image", "save it as JPEG"),
    ] {
        std::fs::write(folder.join(name), bytes).unwrap();
        let found = refusal_of(folder, &format!("diffuse = {{ reflectance = {{ image = \"{name}\" }} }}"));
        assert_eq!(found.message, format!("{name} is not in {reported}"));
        assert_eq!(found.help.as_deref(), Some(help));
    }
    write_png(folder, "a.png", 1, L8, &[7]);
    let found = refusal_of(folder, "diffuse = { reflectance = { image = \"a.png\", channel = \"alpha\" } }");
    assert_eq!(found.message, "a.png has no alpha");
    assert_eq!(found.help.as_deref(), Some("leave `channel` out, or save the image with alpha"));
}

/// The decoder replaces what is missing by gray and reports nothing.
#[test]
fn a_jpeg_that_ends_too_early_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let image = "{ image = \"a.jpg\" }";
    let write = |bytes: &[u8]| std::fs::write(folder.path().join("a.jpg"), bytes).unwrap();
    let numbers: Vec<u8> = (0..64 * 64 * 3).map(|i: u32| (i * 37 % 251) as u8).collect();
    for progressive in [false, true] {
        let whole = jpeg([64, 64], 90, progressive, &numbers);
        // A thumbnail, as cameras put it before the picture. It has an end of its own.
        let small = jpeg([8, 8], 75, false, &numbers[..8 * 8 * 3]);
        let length = (small.len() as u16 + 2).to_be_bytes();
        let pictured = [&whole[..2], &[0xff, 0xe1], &length, &small, &whole[2..]].concat();
        // Bytes between segments and after the end are ignored.
        let stray = [&whole[..2], &[0, 1, 2, 3, 4], &whole[2..], &small[..9]].concat();
        for bytes in [&whole, &pictured, &stray] {
            write(bytes);
            materials(folder.path(), &[image]);
        }
        for (bytes, ends) in [(&whole, [0.5, 0.8]), (&pictured, [0.6, 0.9])] {
            let ends = ends.map(|share| (share * bytes.len() as f64) as usize);
            for end in [ends[0], ends[1], bytes.len() - 1] {
                write(&bytes[..end]);
                assert_eq!(refusal(folder.path(), image), "a.jpg is not a valid JPEG image (it ends too early)");
            }
        }
    }
}

/// Truncated or damaged files are refused with a message, whatever byte is hit.
#[test]
fn a_damaged_image_never_stops_the_program() {
    let folder = tempfile::tempdir().unwrap();
    let numbers: Vec<u8> = (0..8 * 8 * 3).map(|i| (i * 37 % 251) as u8).collect();
    write_png(folder.path(), "a.png", 8, RGB8, &numbers);
    std::fs::write(folder.path().join("a.jpg"), jpeg([8, 8], 75, false, &numbers)).unwrap();
    let at = |x: usize, y: usize| (x as f32 / 8.0, y as f32 / 8.0, 0.5, 1.0);
    exr::prelude::write_rgba_file(folder.path().join("a.exr"), 8, 8, at).unwrap();
    let mut random = Random::new(5);
    for name in ["a.png", "a.jpg", "a.exr"] {
        let whole = std::fs::read(folder.path().join(name)).unwrap();
        let text = format!(
            "{}[material.a]\ndiffuse = {{ reflectance = {{ image = \"{name}\" }} }}\n[[object]]\nmaterial = \"a\"\n\
             shape.sphere = {{ center = [0, 0, 0], radius = 1 }}\n",
            view([0.0, 0.0, 9.0], [0.0; 3], 30.0, 4)
        );
        let source = Source { path: folder.path().join("scene.toml"), text };
        let (mut readable, mut refused) = (0, 0);
        for round in 0..900 {
            std::fs::write(folder.path().join(name), random.damaged(&whole, round)).unwrap();
            match source.compile() {
                Ok(_) => readable += 1,
                Err(abbe::Error::Scene(mistakes)) => {
                    let mistake = &mistakes[0];
                    assert!(!mistake.message.contains('\n'), "{mistake:?}");
                    refused += 1;
                }
                Err(other) => panic!("{name}, round {round}: {other:?}"),
            }
        }
        // Some damage goes unnoticed, most does not.
        assert!(readable > 0 && refused > 200, "{name}: {readable} read, {refused} refused");
    }
}
