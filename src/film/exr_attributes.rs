//! Attributes of OpenEXR files, converted to text.

use std::collections::HashMap;

use exr::meta::attribute::{AttributeValue, Chromaticities, EnvironmentMap};
use exr::prelude::{LayerAttributes, Text, Vec2};

use crate::spectrum::Primaries;

/// A world-to-camera matrix for row vectors, row by row.
pub type CameraMatrix = [f32; 16];

/// Decodes text. Files should hold UTF-8, but older ones hold Latin-1. Control characters are replaced, so that the
/// text cannot send commands to a terminal.
pub(crate) fn text(text: &Text) -> String {
    let text = std::str::from_utf8(text.bytes()).map_or_else(|_| text.to_string(), str::to_owned);
    text.chars().map(|c| if c.is_control() { char::REPLACEMENT_CHARACTER } else { c }).collect()
}

/// Converts chromaticities.
pub(crate) fn primaries(found: Chromaticities) -> Primaries {
    let pair = |v: Vec2<f32>| [v.x().into(), v.y().into()];
    Primaries { red: pair(found.red), green: pair(found.green), blue: pair(found.blue), white: pair(found.white) }
}

/// Lists the attributes of a part and those shared by all parts, sorted by their names in the file. Omits the
/// attributes that describe the pixel storage, and the camera matrix: these are reported separately.
pub(super) fn attributes(part: &LayerAttributes, shared: &HashMap<Text, AttributeValue>) -> Vec<(String, String)> {
    let mut found: Vec<(String, String)> =
        part.other.iter().chain(shared).map(|(key, value)| (text(key), value_text(value))).collect();
    let mut add = |key: &str, value: Option<String>| found.extend(value.map(|value| (key.to_owned(), value)));
    for (key, value) in [
        ("software", &part.software_name),
        ("owner", &part.owner),
        ("comments", &part.comments),
        ("capDate", &part.capture_date),
        ("view", &part.view_name),
        ("wrapmodes", &part.wrap_mode_name),
        ("renderingTransform", &part.rendering_transform_name),
        ("lookModTransform", &part.look_modification_transform_name),
    ] {
        add(key, value.as_ref().map(text));
    }
    for (key, value) in [
        ("whiteLuminance", part.white_luminance),
        ("xDensity", part.horizontal_density),
        ("utcOffset", part.utc_offset),
        ("longitude", part.longitude),
        ("latitude", part.latitude),
        ("altitude", part.altitude),
        ("focus", part.focus),
        ("expTime", part.exposure),
        ("aperture", part.aperture),
        ("isoSpeed", part.iso_speed),
        ("near", part.near_clip_plane),
        ("far", part.far_clip_plane),
        ("fieldOfViewHorizontal", part.horizontal_field_of_view),
        ("fieldOfViewVertical", part.vertical_field_of_view),
    ] {
        add(key, value.map(|value| value.to_string()));
    }
    add("adoptedNeutral", part.adopted_neutral.map(|white| numbers(&[white.x(), white.y()])));
    add("framesPerSecond", part.frames_per_second.map(|(numerator, denominator)| format!("{numerator}/{denominator}")));
    add("worldToNDC", part.world_to_normalized_device.map(|matrix| numbers(&matrix)));
    add("multiView", part.multi_view_names.as_ref().map(|names| join_texts(names)));
    add("preview", part.preview.as_ref().map(|_| "a small picture".into()));
    let sphere = part.environment_map.map(|map| match map {
        EnvironmentMap::LatitudeLongitude => "the full sphere, by longitude and latitude",
        EnvironmentMap::Cube => "the six faces of a cube",
    });
    add("envmap", sphere.map(str::to_owned));
    // A missing attribute is read as the default value, which is not worth reporting.
    if part.screen_window_width != 1.0 || part.world_to_camera.is_some() {
        add("screenWindowWidth", Some(part.screen_window_width.to_string()));
    }
    let center = [part.screen_window_center.x(), part.screen_window_center.y()];
    if center != [0.0; 2] {
        add("screenWindowCenter", Some(numbers(&center)));
    }
    found.sort();
    found
}

fn numbers(numbers: &[f32]) -> String {
    numbers.iter().map(f32::to_string).collect::<Vec<_>>().join(" ")
}

fn join_texts(texts: &[Text]) -> String {
    texts.iter().map(text).collect::<Vec<_>>().join(", ")
}

fn value_text(value: &AttributeValue) -> String {
    match value {
        AttributeValue::Text(value) => text(value),
        AttributeValue::TextVector(values) => join_texts(values),
        AttributeValue::F64(value) => value.to_string(),
        AttributeValue::F32(value) => value.to_string(),
        AttributeValue::I32(value) => value.to_string(),
        AttributeValue::Rational((numerator, denominator)) => format!("{numerator}/{denominator}"),
        AttributeValue::IntVec2(v) => format!("{} {}", v.x(), v.y()),
        AttributeValue::FloatVec2(v) => numbers(&[v.x(), v.y()]),
        AttributeValue::IntVec3((x, y, z)) => format!("{x} {y} {z}"),
        AttributeValue::FloatVec3((x, y, z)) => numbers(&[*x, *y, *z]),
        AttributeValue::Matrix3x3(matrix) => numbers(matrix),
        AttributeValue::Matrix4x4(matrix) => numbers(matrix),
        AttributeValue::FloatRect(rect) => numbers(&[rect.min.x(), rect.min.y(), rect.max.x(), rect.max.y()]),
        AttributeValue::IntegerBounds(bounds) => {
            let [corner, last] = [bounds.position, bounds.max()];
            format!("{} {} to {} {}", corner.x(), corner.y(), last.x(), last.y())
        }
        AttributeValue::TimeCode(time) => {
            format!("{:02}:{:02}:{:02}:{:02}", time.hours, time.minutes, time.seconds, time.frame)
        }
        AttributeValue::Bytes { type_hint, bytes } => format!("{} bytes of {}", bytes.len(), text(type_hint)),
        AttributeValue::Custom { kind, bytes } => format!("{} bytes of {}", bytes.len(), text(kind)),
        other => format!("{other:?}"),
    }
}
