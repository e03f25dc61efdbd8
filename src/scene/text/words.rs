//! Numbers and names in messages.

/// Six digits of a number.
pub(in crate::scene) fn shown(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    if rounded == 0.0 || (1e-4..1e15).contains(&rounded.abs()) { rounded.to_string() } else { format!("{rounded:e}") }
}

/// One of several things, of which so many more are not named.
pub(in crate::scene) fn and_more(named: &str, more: usize) -> String {
    if more > 0 { format!("{named} and {more} more") } else { named.to_owned() }
}
