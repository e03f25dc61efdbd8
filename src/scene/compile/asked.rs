//! The spectra that the keys of a material give.

use crate::scene::text::{Fields, Value};

/// The spectrum that a key gives.
#[derive(Clone, Copy)]
pub(super) enum Asked<'d> {
    There(Value<'d>),
    Default(f64),
    /// The key is missing or wrong, and a mistake has been recorded.
    Lacking,
}

pub(super) fn spectrum<'d>(fields: &mut Fields<'d>, key: &'static str) -> Asked<'d> {
    fields.need(key, Some).map_or(Asked::Lacking, Asked::There)
}

pub(super) fn spectrum_or<'d>(fields: &mut Fields<'d>, key: &'static str, default: f64) -> Asked<'d> {
    fields.get(key).map_or(Asked::Default(default), Asked::There)
}
