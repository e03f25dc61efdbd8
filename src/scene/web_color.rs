//! Colors as web pages and other programs write them, converted to linear light.

use crate::spectrum::decode_srgb;

/// Converts a color as paint programs and the web write it (`#ff8800`, `#f80`, `0xff8800`, `rgb(255, 136, 0)` or
/// `255, 136, 0`) to linear red, green and blue, as a text that can be pasted into a scene. Returns none if the text is
/// no such color.
pub fn web_color(text: &str) -> Option<String> {
    let text = text.trim().to_lowercase();
    match text.strip_prefix('#').or_else(|| text.strip_prefix("0x")) {
        Some(digits) => hex_to_linear(digits),
        None => {
            let list = text.strip_prefix("rgb(").and_then(|list| list.strip_suffix(')')).unwrap_or(&text);
            let parts = list.split([',', ' ']).filter(|part| !part.is_empty());
            let parts: Vec<f64> = parts.map(|part| part.parse().ok()).collect::<Option<_>>()?;
            bytes_to_linear(parts.try_into().ok()?)
        }
    }
}

/// Converts sRGB numbers from 0 to 255, at least one of them above 1, to linear light. Returns none for other numbers.
pub fn bytes_to_linear(bytes: [f64; 3]) -> Option<String> {
    let are_bytes = bytes.iter().all(|x| (0.0..=255.0).contains(x) && x.fract() == 0.0);
    (are_bytes && bytes.iter().any(|x| *x > 1.0)).then(|| srgb_to_linear(bytes.map(|x| x / 255.0)))
}

/// Converts sRGB numbers from 0 to 1 to linear light, rounded to three digits.
pub fn srgb_to_linear(color: [f64; 3]) -> String {
    let three_digits = |x: f64| format!("{:.2e}", decode_srgb(x)).parse().unwrap_or(x);
    let color: Vec<String> = color.map(three_digits).iter().map(f64::to_string).collect();
    format!("[{}]", color.join(", "))
}

/// Converts two hexadecimal digits each for red, green and blue, or one that counts twice. Digits for alpha may follow
/// and are ignored.
fn hex_to_linear(digits: &str) -> Option<String> {
    let width = match digits.len() {
        3 | 4 => 1,
        6 | 8 => 2,
        _ => return None,
    };
    let all: Vec<u8> = digits.chars().map(|digit| Some(digit.to_digit(16)? as u8)).collect::<Option<_>>()?;
    let byte = |part: &[u8]| f64::from(16 * part[0] + part[width - 1]);
    let mut bytes = all.chunks(width).map(byte);
    let color = [bytes.next()?, bytes.next()?, bytes.next()?];
    Some(srgb_to_linear(color.map(|x| x / 255.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// In linear light, 136 of 255 is 0.2462 and 51 is 0.03310 (IEC 61966-2-1).
    #[test]
    fn a_web_color_is_converted_to_linear_light() {
        for orange in ["#ff8800", "#FF8800", "#f80", "#ff8800cc", "0xff8800", "rgb(255, 136, 0)", "255 136 0"] {
            assert_eq!(web_color(orange).as_deref(), Some("[1, 0.246, 0]"), "{orange}");
        }
        assert_eq!(web_color("#330000").as_deref(), Some("[0.0331, 0, 0]"));
        for other in ["red", "#ff88", "#é", "#ffé", "1, 1, 0", "0.5 0.2 0.1", "300, 0, 0", "1, 2", "ff8800", ""] {
            let is_color = web_color(other).is_some();
            assert_eq!(is_color, other == "#ff88", "{other}");
        }
    }
}
