//! Bytes of a file as text.

use super::named_file::Fault;

/// Decodes text in UTF-8, and removes a byte order mark, which would count as a column. `shown` is the name of the
/// bytes in messages. `help` says what is expected in place of something that is no text at all.
pub(in crate::scene) fn utf8(bytes: Vec<u8>, shown: &str, help: &str) -> Result<String, Fault> {
    let bytes = match String::from_utf8(bytes) {
        Ok(text) if text.starts_with('\u{feff}') => return Ok(text['\u{feff}'.len_utf8()..].to_owned()),
        Ok(text) => return Ok(text),
        Err(error) => error,
    };
    let at = bytes.utf8_error().valid_up_to();
    let (bytes, before) = (bytes.as_bytes(), String::from_utf8_lossy(&bytes.as_bytes()[..at]));
    let (line, start) = (before.matches('\n').count() + 1, before.rfind('\n').map_or(0, |newline| newline + 1));
    let column = before[start..].chars().count() + 1;
    let byte = format!("line {line} has the byte 0x{:02X} in column {column}", bytes[at]);
    let help = match bytes {
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] => "it begins like UTF-16: save it as UTF-8".into(),
        _ if bytes.contains(&0) => help.to_owned(),
        _ => "save it as UTF-8".into(),
    };
    Err(Fault::new(format!("{shown} is not text in UTF-8: {byte}"), help))
}
