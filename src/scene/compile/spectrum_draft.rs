//! The spectra that the keys of a material give.

use crate::scene::text::{Fields, Value};

/// The spectrum that a key gives.
#[derive(Clone, Copy)]
pub(super) enum SpectrumDraft<'d> {
    Given(Value<'d>),
    Default(f64),
    /// The key is missing or wrong, and a mistake has been recorded.
    Missing,
}

pub(super) fn spectrum<'d>(fields: &mut Fields<'d>, key: &'static str) -> SpectrumDraft<'d> {
    fields.need(key, Some).map_or(SpectrumDraft::Missing, SpectrumDraft::Given)
}

pub(super) fn spectrum_or<'d>(fields: &mut Fields<'d>, key: &'static str, default: f64) -> SpectrumDraft<'d> {
    fields.get(key).map_or(SpectrumDraft::Default(default), SpectrumDraft::Given)
}
