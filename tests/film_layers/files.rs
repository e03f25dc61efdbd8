//! Layers as they are stored in files.

use std::collections::BTreeMap;

use abbe::film::{Compression, Layer, Precision};
use abbe::{Options, Scene};
use exr::prelude::{AttributeValue, FlatSamples, ReadChannels, ReadLayers, read};

use super::ROOM;
use crate::support::scenes::render_text;

/// Each part's name, and its channels with their number of bits and their values.
type Parts = Vec<(Option<String>, BTreeMap<String, (u32, Vec<f32>)>)>;

fn written_parts(
    precision: Precision,
    compression: Compression,
    multipart: bool,
    layers: &[Layer],
) -> (Parts, Vec<u8>) {
    // Caustics would take most of the planning time, and planning most of the total time.
    let text = ROOM.replace("samples = 8", "samples = 2, caustics = \"off\"");
    let mut scene = Scene::parse(&text, "").expect("the scene is valid");
    (scene.format.precision, scene.format.compression) = (precision, compression);
    (scene.format.multipart, scene.format.owner) = (multipart, Some("Émilie".into()));
    let options = Options { layers: Some(layers.to_vec()), ..Options::default() };
    let image = abbe::render(&scene, &options).expect("it renders");
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("image.exr");
    image.write_exr(&path).expect("it can be written");
    let bytes = std::fs::read(&path).expect("it was written");
    let file = read().no_deep_data().largest_resolution_level().all_channels().all_layers().all_attributes();
    let file = file.from_file(&path).expect("it can be read");
    let part = |layer: &exr::prelude::Layer<exr::prelude::AnyChannels<FlatSamples>>| {
        let name = layer.attributes.layer_name.as_ref().map(ToString::to_string);
        let channels = layer.channel_data.list.iter().map(|channel| {
            let bits = if let FlatSamples::F16(_) = channel.sample_data { 16 } else { 32 };
            (channel.name.to_string(), (bits, channel.sample_data.values_as_f32().collect()))
        });
        (name, channels.collect())
    };
    for layer in &file.layer_data {
        let AttributeValue::Text(space) = &layer.attributes.other[&exr::prelude::Text::from("colorInteropID")] else {
            panic!("it is a text");
        };
        let name = layer.attributes.layer_name.as_ref().map_or("image".into(), ToString::to_string);
        let lights = ["emission", "background", "direct", "indirect", "caustics", "dispersed", "albedo"];
        let is_color = name == "image"
            || lights.contains(&&*name)
            || ["light_", "half_"].iter().any(|start| name.starts_with(start))
            || ["_direct", "_indirect"].iter().any(|end| name.ends_with(end));
        assert_eq!(space.to_string(), if is_color { "lin_rec709_scene" } else { "data" }, "{name}");
    }
    (file.layer_data.iter().map(part).collect(), bytes)
}

#[test]
fn a_plain_file_holds_the_image_alone() {
    let (parts, _) = written_parts(Precision::Float, Compression::Zip, false, &[]);
    let names: Vec<_> = parts[0].1.keys().map(String::as_str).collect();
    assert_eq!((parts.len(), names), (1, vec!["A", "B", "G", "R", "Z"]));
}

#[test]
fn every_lossless_compression_and_several_parts_hold_the_same_numbers() {
    let (parts, bytes) = written_parts(Precision::Float, Compression::Zip, false, &Layer::all());
    let all = &parts[0].1;
    assert!(all.values().all(|(bits, _)| *bits == 32) && all.contains_key("light_key_lamp.R"));
    assert!(bytes.windows("Émilie".len()).any(|window| window == "Émilie".as_bytes()));
    for compression in Compression::NAMES.into_iter().map(|(_, known)| known).filter(|known| !known.is_lossy()) {
        for multipart in [false, true] {
            let (parts, bytes) = written_parts(Precision::Float, compression, multipart, &Layer::all());
            let together: BTreeMap<_, _> = parts.iter().flat_map(|(_, channels)| channels.clone()).collect();
            assert!(&together == all, "{compression:?}, several parts: {multipart}");
            if !multipart {
                assert_eq!(parts.len(), 1);
                assert!(
                    bytes == written_parts(Precision::Float, compression, multipart, &Layer::all()).1,
                    "{compression:?}"
                );
                continue;
            }
            assert_eq!(parts[1].0.as_deref(), Some("depth"));
            assert!(parts[0].1.keys().eq(["A", "B", "G", "R"]) && parts[1].1.keys().eq(["Z"]));
            for (name, channels) in &parts[2..] {
                let name = name.as_ref().expect("each part has a name");
                assert!(
                    channels.keys().all(|channel| channel.rsplit_once('.').is_some_and(|(layer, _)| layer == name))
                );
            }
            assert_eq!(parts[0].0.as_deref(), Some("image"));
        }
    }
}

#[test]
fn a_compression_that_loses_changes_colors_alone() {
    let float = &written_parts(Precision::Float, Compression::Zip, true, &Layer::all()).0;
    let half = &written_parts(Precision::Half, Compression::Zip, true, &Layer::all()).0;
    let is_color = |part: &str| {
        let data = ["depth", "albedo", "N", "Nd", "P", "UV", "variance", "samples", "half_a", "half_b"];
        !data.contains(&part) && !part.starts_with("Crypto")
    };
    for (precision, compression, exact) in [
        (Precision::Float, Compression::Pxr24, float),
        (Precision::Half, Compression::Dwaa, half),
        (Precision::Half, Compression::Dwab, half),
    ] {
        let (parts, bytes) = written_parts(precision, compression, true, &Layer::all());
        assert!(
            bytes == written_parts(precision, compression, true, &Layer::all()).1,
            "{compression:?} has other bytes"
        );
        for ((name, channels), (_, exact)) in parts.iter().zip(exact) {
            let name = name.as_ref().expect("each part has a name");
            assert!(is_color(name) || channels == exact, "{compression:?}: {name}");
        }
        let (red, exact) = (&parts[0].1["R"].1, &exact[0].1["R"].1);
        assert!(red != exact, "{compression:?} loses nothing");
        if compression == Compression::Pxr24 {
            // Pxr24 keeps 15 bits of the mantissa, rounded.
            assert!(red.iter().zip(exact).all(|(red, exact)| (red - exact).abs() <= exact.abs() / 65536.0));
        } else {
            assert!(parts[0].1["A"] == half[0].1["A"], "{compression:?} changes alpha");
        }
    }
}

#[test]
fn a_lossy_file_of_one_part_holds_no_data() {
    let refusal = |compression, precision, multipart, layers: &[Layer]| {
        // Caustics would take most of the planning time, and planning most of the total time.
        let text = ROOM.replace("samples = 8", "samples = 2, caustics = \"off\"");
        let mut scene = Scene::parse(&text, "").expect("the scene is valid");
        (scene.format.compression, scene.format.precision, scene.format.multipart) =
            (compression, precision, multipart);
        let options = Options { layers: Some(layers.to_vec()), ..Options::default() };
        options.apply(&mut scene).err().map(|error| error.to_string())
    };
    let (half, float) = (Precision::Half, Precision::Float);
    let light = [Layer::Lights, Layer::Direct];
    assert_eq!(refusal(Compression::Dwaa, half, false, &light), None);
    let lossless_layers = [Layer::Uv, Layer::Samples, Layer::CryptoObject];
    assert_eq!(refusal(Compression::Dwab, half, false, &lossless_layers), None);
    let channels = |compression| written_parts(half, compression, false, &lossless_layers).0.remove(0).1;
    let (lossy, exact) = (channels(Compression::Dwab), channels(Compression::Zip));
    let is_exact = |name: &&String| name.contains('.') || ["A", "Z"].contains(&name.as_str());
    assert!(exact.keys().filter(is_exact).count() >= 6);
    assert!(exact.keys().filter(is_exact).all(|name| lossy[name] == exact[name]));
    assert!(lossy["R"] != exact["R"]);
    assert_eq!(refusal(Compression::Pxr24, float, true, &Layer::all()), None);
    for (compression, precision, layers, message) in [
        (Compression::Dwab, half, &[Layer::Albedo, Layer::Direct][..], "dwab alters data that must stay exact: albedo"),
        (Compression::Dwaa, half, &[Layer::Normal, Layer::HalfA], "dwaa alters data that must stay exact: N, half_a"),
        (Compression::Pxr24, half, &[Layer::Direct], "pxr24 alters data that must stay exact: Z"),
        (Compression::Dwaa, float, &[], "dwaa holds colors in 16 bits, not in 32"),
    ] {
        assert_eq!(refusal(compression, precision, false, layers), Some(format!("the compression {message}")));
    }
}

#[test]
fn half_precision_keeps_places_and_statistics_whole() {
    let (float, _) = written_parts(Precision::Float, Compression::Zip, false, &Layer::all());
    let (half, _) = written_parts(Precision::Half, Compression::Zip, false, &Layer::all());
    for (name, (bits, values)) in &half[0].1 {
        let exact = &float[0].1[name].1;
        let layer = name.rsplit_once('.').map_or(name.as_str(), |(layer, _)| layer);
        let is_whole =
            ["Z", "P", "UV", "variance", "samples", "residual"].contains(&layer) || layer.starts_with("Crypto");
        assert_eq!(*bits, if is_whole { 32 } else { 16 }, "{name}");
        for (value, exact) in values.iter().zip(exact) {
            let near = if is_whole { 0.0 } else { exact.abs() / 2048.0 + 3e-8 };
            assert!((value - exact).abs() <= near, "{name}: {value} for {exact}");
        }
    }
}

/// Row O1 of the stability catalog.
#[test]
fn o1_what_is_too_bright_for_half_precision_is_its_largest_number_and_is_counted() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("image.exr");
    // The largest half is 65504. From 65520 on, numbers would be rounded to infinity.
    for (radiance, clamped) in [("65503", 0), ("65519.99", 0), ("65520", 4 * 4 * 3), ("1e6", 4 * 4 * 3)] {
        let text = format!(
            "camera = {{ position = [0, 0, 4], look_at = [0, 0, 0], vertical_fov = 40 }}\n\
             film = {{ width = 4, height = 4, precision = \"half\" }}\nrender.samples = 1\n\
             light = [{{ environment = {{ radiance = {radiance} }} }}]\n"
        );
        let image = render_text(&text);
        assert_eq!(image.write_exr(&path).expect("it can be written"), clamped, "{radiance}");
        let file = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer().all_attributes();
        let file = file.from_file(&path).expect("it can be read");
        for channel in
            file.layer_data.channel_data.list.iter().filter(|channel| "RGB".contains(&*channel.name.to_string()))
        {
            assert!(channel.sample_data.values_as_f32().all(|value| value == 65504.0), "{radiance}: {}", channel.name);
        }
    }
}
