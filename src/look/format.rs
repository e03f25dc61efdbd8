//! Numbers formatted for people.

/// Formats a number with five digits, without a power of ten if that is as short.
pub fn number(value: f64) -> String {
    number_of_digits(value, 5)
}

/// Formats a number with the given count of significant digits, without a power of ten if that is as short.
fn number_of_digits(value: f64, digits: i32) -> String {
    let size = value.abs();
    let scientific = || format!("{value:.*e}", digits as usize - 1);
    if size < 5e-7 {
        return if value == 0.0 { "0".into() } else { scientific() };
    }
    if !(1e-3..1e6).contains(&size) {
        return scientific();
    }
    let digits = (digits - 1 - libm::floor(libm::log10(size)) as i32).clamp(0, 6) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// Formats a fraction as a percentage.
pub fn percent(share: f64) -> String {
    format!("{} %", number_of_digits(100.0 * share, 2))
}
