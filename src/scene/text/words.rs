//! Numbers and names in messages.

/// Formats a number with six digits.
pub(in crate::scene) fn six_digits(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    if rounded == 0.0 || (1e-4..1e15).contains(&rounded.abs()) { rounded.to_string() } else { format!("{rounded:e}") }
}

/// Names one of several things, and says how many more there are.
pub(in crate::scene) fn and_more(named: &str, more: usize) -> String {
    if more > 0 { format!("{named} and {more} more") } else { named.to_owned() }
}
