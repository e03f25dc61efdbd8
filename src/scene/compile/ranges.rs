//! Range checks of points, directions and lengths, and guesses of the units that numbers were meant in.

use std::f64::consts::PI;
use std::ops::RangeInclusive;

use crate::math::DVec3;
use crate::scene::text::{Value, six_digits};

/// Largest length and coordinate. It is far within f32, and products of a few of them are far within f64.
pub(super) const MAX_LENGTH: f64 = 1e30;
/// Smallest size. It is far within f32, and products of a few of them are far within f64.
pub(super) const MIN_LENGTH: f64 = 1e-30;
/// Angle in degrees below which radians may be meant.
const NARROW_DEGREES: f64 = 1.0;
/// The name of the numbers of a point in messages.
pub(super) const COORDINATE: &str = "a coordinate";

/// Reads a point that is not too far away.
pub(super) fn point(value: Value) -> Option<DVec3> {
    in_range(value, COORDINATE, value.numbers()?).map(DVec3::from)
}

/// Checks that coordinates or similar numbers are finite and not too large. `name` is the name of each in messages.
pub(super) fn in_range<const N: usize>(value: Value, name: &str, numbers: [f64; N]) -> Option<[f64; N]> {
    match numbers.iter().position(|x| !is_coordinate(*x)) {
        Some(axis) => value.entry(axis).refuse(range_error(name, numbers[axis])),
        None => Some(numbers),
    }
}

/// Returns whether a number can be a coordinate: finite and not too large.
pub(super) fn is_coordinate(number: f64) -> bool {
    number.is_finite() && number.abs() <= MAX_LENGTH
}

/// Returns what is wrong with a number that cannot be a coordinate. `name` is its name in the message.
pub(super) fn range_error(name: &str, number: f64) -> String {
    match number.is_finite() {
        true => format!("{name} lies between -{MAX_LENGTH:e} and {MAX_LENGTH:e}"),
        false => format!("{name} is a finite number, not {number}"),
    }
}

/// Reads a vector of finite length above 0.
pub(super) fn direction(value: Value) -> Option<DVec3> {
    let vector = point(value)?;
    match vector.try_normalize() {
        Some(_) => Some(vector),
        None => value.refuse("a direction needs a length above 0"),
    }
}

/// Reads a length above 0. `name` is its name in messages.
pub(super) fn length(value: Value, name: &str) -> Option<f64> {
    positive_length(value, name, value.number()?)
}

/// Checks that a number is a length above 0.
pub(super) fn positive_length(value: Value, name: &str, length: f64) -> Option<f64> {
    if (MIN_LENGTH..=MAX_LENGTH).contains(&length) {
        Some(length)
    } else if length > 0.0 && length.is_finite() {
        value.refuse(format!("{name} is a length from {MIN_LENGTH:e} to {MAX_LENGTH:e}"))
    } else {
        value.refuse(format!("{name} is a length above 0, not {length}"))
    }
}

/// Returns what to add to a warning about an angle so narrow that radians may be meant; none for a wider angle.
pub(super) fn radians_hint(degrees: f64) -> Option<String> {
    // Somebody who meant radians did not mean less than a degree.
    (degrees < NARROW_DEGREES).then(|| match degrees.to_degrees() {
        meant if meant < NARROW_DEGREES => String::new(),
        meant => format!("; if radians are meant, write {meant:.1}"),
    })
}

/// Returns the unit that a wavelength or a width seems to be in: one in which it would lie within `plausible_nm`.
pub(super) fn wavelength_unit_hint(given: f64, plausible_nm: RangeInclusive<f64>) -> Option<String> {
    let units = [("um", 1e3), ("Angstrom", 0.1), ("m", 1e9)].map(|(unit, nm)| (unit, given * nm));
    let (unit, nm) = units.into_iter().find(|(_, nm)| plausible_nm.contains(nm))?;
    Some(format!("wavelengths are in nm: if this is in {unit}, write {}", six_digits(nm)))
}

/// Returns a warning about a retardance in degrees that seems to be in waves or in radians.
pub(super) fn small_retardance(degrees: f64) -> Option<String> {
    let is_part = |eighths: f64| (degrees.abs() - eighths * PI / 4.0).abs() < 2e-3 * degrees.abs();
    // Any fraction of a wave is plausible; radians are recognized only by being fractions of pi.
    let (unit, meant) = match degrees.abs() {
        _ if [1.0, 2.0, 4.0, 6.0, 8.0].into_iter().any(is_part) => ("radians", degrees.to_degrees().round()),
        0.01..1.0 => ("waves", 360.0 * degrees),
        _ => return None,
    };
    Some(too_small("retardance", &format!("{} degrees", six_digits(degrees)), unit, meant))
}

/// Returns a warning about a retardation in nm that seems to be in um.
pub(super) fn small_retardation(nm: f64) -> Option<String> {
    (0.05..2.0).contains(&nm.abs()).then(|| too_small("retardation", &format!("{} nm", six_digits(nm)), "um", 1e3 * nm))
}

fn too_small(name: &str, written: &str, unit: &str, meant: f64) -> String {
    format!("a {name} of {written} hardly changes light; if {unit} are meant, write {}", six_digits(meant))
}
