//! Lights that are not surfaces.

use std::ops::RangeInclusive;

use super::context::Context;
use super::curve::curve;
use super::curve_text::{CurveText, KindText};
use super::image::{BRIGHT_IMAGE, factor_on_image, read_file};
use super::image_file::read_image;
use super::object;
use super::radiometry;
use super::ranges::{direction, point, radians_hint};
use super::transform::{Step, compose_steps, steps};
use crate::light::{Environment, Light, Panorama, Point, Sky, SkyPolarization, Spot, Sun};
use crate::math::{DMat3, DVec3, Transform};
use crate::scene::Scene;
use crate::scene::text::{Fields, Spanned, Value, above_0_to, spanned};
use crate::spectrum::{Curve, Placement, Quantity};

/// A light of a scene.
pub(super) struct LightEntry {
    light: Light<Curve>,
    group: String,
    /// Whether the camera sees it, if it is infinite.
    is_visible: bool,
}

/// ```toml
/// [[light]]
/// environment = { radiance = 1 }     # or `point`, `spot` or `sun`
/// ```
pub(super) fn light<'d>(context: &mut Context, value: Value<'d>, has_environment: &mut bool) -> Option<LightEntry> {
    Fields::read(value, |entry| {
        let name = entry.maybe("name", object::name);
        let own_group = entry.maybe("group", object::group);
        let visible = entry.maybe("visible_to_camera", spanned(Value::yes_or_no));
        let kinds = ["environment", "point", "spot", "sun"].map(|kind| entry.get(kind));
        let given: Vec<Value> = kinds.into_iter().flatten().collect();
        let place = match given.as_slice() {
            [] if entry.has_unknown() => return None,
            [] => {
                let message = "a light needs a kind: `environment`, `point`, `spot` or `sun`";
                return value.advise(message, "such as environment = { radiance = 1 }");
            }
            [place] => *place,
            [first, others @ ..] => {
                let last = others.iter().fold(*first, |last, other| last.later(*other));
                return last.advise("a light has exactly one kind", "start another [[light]] for the second");
            }
        };
        let (group, visible) = (own_group?.or(name?), visible?);
        if let Some(visible) = visible.filter(|_| matches!(place.key(), "point" | "spot")) {
            let message = "point lights and spotlights are too small to be seen";
            return visible.place.advise(message, "leave `visible_to_camera` out");
        }
        let light = match place.key() {
            "point" => point_light(context, place),
            "spot" => spot_light(context, place),
            "sun" => sun_light(context, place),
            _ => {
                let help = "environment = { radiance = .., transform = [..] }".into();
                entry.refuse_misplaced("transform", "`transform` goes inside `environment`, beside `radiance`", help);
                if std::mem::replace(has_environment, true) {
                    return place.refuse("a scene has at most one environment");
                }
                environment_light(context, place).map(Light::Environment)
            }
        }?;
        let group = group.unwrap_or(light.kind_name()).to_owned();
        Some(LightEntry { light, group, is_visible: visible.is_none_or(|visible| visible.value) })
    })
}

/// Appends lights to those of a scene.
pub(super) fn add_lights(scene: &mut Scene<Curve>, entries: Vec<LightEntry>) {
    for LightEntry { light, group, is_visible } in entries {
        let id = scene.lights.len();
        scene.infinite_lights.extend(light.is_infinite().then_some(id));
        scene.hidden_lights.extend((!is_visible).then_some(id));
        scene.light_groups.push(group);
        scene.lights.push(light);
    }
}

/// Reads the spectrum of a light that is not a surface.
fn emission<'d>(context: &mut Context, value: Value<'d>) -> Option<Curve> {
    curve(context, &CurveText::read(value, Quantity::Emission)?, Quantity::Emission)
}

/// Reads the intensity of a point light or a spotlight.
fn intensity<'d>(context: &mut Context, value: Value<'d>) -> Option<Curve> {
    let emission = emission(context, value)?;
    radiometry::intensity(context, value, emission)
}

fn point_light<'d>(context: &mut Context, value: Value<'d>) -> Option<Light<Curve>> {
    Fields::read(value, |light| {
        let position = light.need("position", point);
        let intensity = light.need("intensity", |value| intensity(context, value));
        refuse_entry_keys(light, "point", &POINT_LIGHT_KEYS);
        Some(Light::Point(Point { position: position?.to_array(), intensity: intensity? }))
    })
}

/// Keys that belong beside the kind of a light that is too small to be seen.
const POINT_LIGHT_KEYS: [&str; 2] = ["name", "group"];
/// Keys that belong beside the kind of a light that can be seen.
const INFINITE_LIGHT_KEYS: [&str; 3] = ["name", "group", "visible_to_camera"];
/// Names of `visible_to_camera` in other programs.
const VISIBILITY_ALIASES: [&str; 2] = ["visible", "camera_visible"];

/// Reports keys that stand within the kind of a light but belong beside it.
fn refuse_entry_keys(light: &mut Fields, kind: &str, keys: &[&'static str]) {
    for &key in keys {
        light.refuse_misplaced(
            key,
            format!("`{key}` is a key of the light"),
            format!("write it beside `{kind}`, in its [[light]]"),
        );
    }
}

/// Reports keys that stand within an infinite light but belong beside it.
fn refuse_infinite_light_keys(light: &mut Fields, kind: &str) {
    refuse_entry_keys(light, kind, &INFINITE_LIGHT_KEYS);
    for key in VISIBILITY_ALIASES {
        let help = format!("write `visible_to_camera` beside `{kind}`, in its [[light]]");
        light.refuse_misplaced(key, format!("unknown key `{key}`"), help);
    }
}

/// The apparent diameter of the sun in radians, approximately.
const SUN_RADIANS: RangeInclusive<f64> = 0.009..=0.0096;

fn sun_light<'d>(context: &mut Context, value: Value<'d>) -> Option<Light<Curve>> {
    Fields::read(value, |light| {
        let toward = light.need("toward", direction);
        // The apparent diameter of the sun.
        let angular_diameter = light.or("angular_diameter", 0.533, |value| {
            let degrees = value.number_within(0.0..=180.0, "a sun is 0 to 180 degrees across", None)?;
            if SUN_RADIANS.contains(&degrees) {
                let meant = degrees.to_degrees();
                let warning = format!(
                    "a sun of {degrees} degrees is hardly wider than a point; if radians are meant, write {meant:.3}"
                );
                context.warn_at(value, warning);
            }
            Some(degrees)
        });
        let irradiance = light.need("irradiance", |value| emission(context, value));
        let help = "toward = [1, 2, 1] is the direction from the scene to the sun";
        light.refuse_misplaced("look_at", "a sun is infinitely far away and looks at no point", help.into());
        refuse_infinite_light_keys(light, "sun");
        Some(Light::Sun(Sun::new(toward?.to_array(), angular_diameter?, irradiance?)))
    })
}

fn spot_light<'d>(context: &mut Context, value: Value<'d>) -> Option<Light<Curve>> {
    Fields::read(value, |light| {
        let position = light.need("position", point);
        let toward = light.maybe("toward", spanned(direction));
        let target = light.maybe("look_at", spanned(point));
        let cone_angle = light.need("cone_angle", |value| {
            let cone_angle =
                value.number_within(above_0_to(180.0), "a cone angle is above 0 and at most 180 degrees", None)?;
            if let Some(radians) = radians_hint(cone_angle) {
                context.warn_at(value, format!("a cone of {cone_angle} degrees lights very little{radians}"));
            }
            Some(cone_angle)
        });
        let blend = light
            .or("blend", 0.15, |value| value.number_within(0.0..=1.0, "blend is a fraction of the cone, 0 to 1", None));
        let intensity = light.need("intensity", |value| intensity(context, value));
        refuse_entry_keys(light, "spot", &POINT_LIGHT_KEYS);
        let position = position?;
        let toward = match (toward?, target?) {
            (Some(toward), None) => toward.value,
            (None, Some(Spanned { place, value: target })) => match (target - position).try_normalize() {
                Some(toward) => toward,
                None => return place.advise("the spot looks at its own position", "choose another point"),
            },
            (None, None) if light.has_unknown() => return None,
            (None, None) => {
                let help = "toward = [0, -1, 0] is a direction, look_at = [0, 0, 0] a point";
                return value.advise("`toward` or `look_at` is missing", help);
            }
            (Some(toward), Some(target)) => {
                let help = "`toward` is a direction, `look_at` a point: leave one of them out";
                let later = toward.place.later(target.place);
                return later.advise("a spot has `toward` or `look_at`, not both", help);
            }
        };
        let (cone_angle, blend, intensity) = (cone_angle?, blend?, intensity?);
        let (position, toward) = (position.to_array(), toward.to_array());
        Some(Light::Spot(Spot { position, toward, cone_angle, blend, intensity }))
    })
}

/// ```toml
/// [[light]]
/// environment = { radiance = { image = "sky.exr" }, transform = [{ rotate = { axis = [0, 1, 0], degrees = 90 } }] }
/// ```
fn environment_light<'d>(context: &mut Context, value: Value<'d>) -> Option<Environment<Curve>> {
    Fields::read(value, |light| {
        let radiance = light.need("radiance", |value| CurveText::read(value, Quantity::Emission));
        let turn = light.maybe("transform", spanned(steps));
        let polarization = light.maybe("polarization", sky_polarization);
        refuse_infinite_light_keys(light, "environment");
        let (radiance, polarization) = (radiance?, polarization?);
        let KindText::Image(file) = radiance.kind else {
            if let Some(turn) = turn?.filter(|turn| !turn.value.is_empty()) {
                return turn.place.advise("a uniform environment looks the same after any rotation", "leave it out");
            }
            let radiance = curve(context, &radiance, Quantity::Emission)?;
            return Some(Environment { radiance, image: None, polarization });
        };
        let is_plain = radiance.encoding.is_none() && radiance.channel.is_none();
        if !is_plain || radiance.placement()? != Placement::default() {
            let message =
                "an environment image covers all directions once, in linear light: only its `scale` can be set";
            return radiance.value.refuse(message);
        }
        let factor = factor_on_image(&radiance);
        let turn = turn.and_then(|turn| turn.map_or(Some(Transform::IDENTITY), |turn| rotation(&turn.value)));
        let panorama = panorama(context, &Spanned { place: radiance.place, value: file });
        let (factor, turn, panorama) =
            (radiometry::scale_to_film(context, &radiance, factor?.into())?, turn?, panorama?);
        let rotation = DMat3::from_cols(turn.vector(DVec3::X), turn.vector(DVec3::Y), turn.vector(DVec3::Z));
        Some(Environment { radiance: factor, image: Some(Sky::new(panorama, rotation)), polarization })
    })
}

/// Reads `polarization = { sun = [0, 1, 1], degree = 0.7 }`: the direction of the sun in a clear sky, and how far the
/// sky's light is polarized a quarter turn from there.
fn sky_polarization(value: Value) -> Option<SkyPolarization> {
    Fields::read(value, |sky| {
        let sun = sky.need("sun", direction);
        let degree = sky.need("degree", |value| {
            let help = "a clear sky is polarized by 0.7 to 0.8 at 90 degrees from the sun";
            value.number_within(0.0..=1.0, "a degree of polarization lies between 0 and 1", Some(help))
        });
        Some(SkyPolarization { sun: sun?.normalize(), degree: degree? })
    })
}

/// Returns the map of a list of steps that must all be rotations.
fn rotation(steps: &[Spanned<Step>]) -> Option<Transform> {
    match steps.iter().find(|step| !matches!(step.value, Step::Rotate(_))) {
        Some(step) => {
            let message = "an environment has no position and no size: it can only be rotated";
            step.place.advise(message, "write { rotate = { axis = [0, 1, 0], degrees = 90 } }")
        }
        None => compose_steps(steps, Transform::IDENTITY),
    }
}

fn panorama(context: &mut Context, file: &Spanned<&str>) -> Option<Panorama> {
    let image = read_file(context, file, &BRIGHT_IMAGE, read_image)?;
    let (width, height) = (image.width(), image.height());
    if width != 2 * height {
        let message = "an image of all directions is twice as wide as high";
        context.warn_at(file.place, format!("{} is {width} x {height}; {message}", file.value));
    }
    Some(Panorama::new(image, context.few_bounces))
}
