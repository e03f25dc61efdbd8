//! The number of a frame in the names of its files.

use std::ops::Range;
use std::path::{Path, PathBuf};

use abbe::Result;

use super::outputs::refuse;

/// More digits than any number of a frame has.
const MOST_DIGITS: usize = 20;

/// The path with the number of the frame where it says `%04d`, or another number of digits.
///
/// # Errors
/// If the path asks for a number and there is none.
pub fn numbered(path: &Path, frame: Option<u32>) -> Result<PathBuf> {
    let Some(text) = path.to_str() else { return Ok(path.to_owned()) };
    let Some((place, digits)) = pattern(text) else {
        if frame.is_some() && text.contains("##") {
            let message = format!("{text} would be the name of every frame");
            return refuse(&message, Some("write %04d in place of ####"));
        }
        return Ok(path.to_owned());
    };
    let Some(frame) = frame else {
        let message = format!("{text} is named after a frame, and no frame is given");
        return refuse(&message, Some("give its number: --frame 1"));
    };
    let number = format!("{frame:0digits$}");
    Ok([&text[..place.start], &number, &text[place.end..]].concat().into())
}

/// Where `%04d`, `%4d` or `%d` stands first, and its least number of digits.
fn pattern(text: &str) -> Option<(Range<usize>, usize)> {
    text.match_indices('%').find_map(|(start, _)| {
        let rest = &text[start + 1..];
        let digits = rest.len() - rest.trim_start_matches(|letter: char| letter.is_ascii_digit()).len();
        let width = if digits == 0 { Some(0) } else { rest[..digits].parse().ok() };
        let width = width.filter(|&width: &usize| width <= MOST_DIGITS && rest[digits..].starts_with('d'))?;
        Some((start..start + digits + 2, width))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_takes_at_least_so_many_digits_where_the_name_asks_for_it() {
        let name = |path: &str, frame| numbered(Path::new(path), frame).map(|path| path.display().to_string()).ok();
        assert_eq!(name("out/turn.%04d.exr", Some(7)).as_deref(), Some("out/turn.0007.exr"));
        assert_eq!(name("turn.%04d.exr", Some(12345)).as_deref(), Some("turn.12345.exr"));
        assert_eq!(name("%d.exr", Some(7)).as_deref(), Some("7.exr"));
        assert_eq!(name("100%.exr", Some(7)).as_deref(), Some("100%.exr"));
        assert_eq!(name("100%x %02d.exr", Some(7)).as_deref(), Some("100%x 07.exr"));
        assert_eq!(name("%99999999999999999999d.exr", Some(7)).as_deref(), Some("%99999999999999999999d.exr"));
        assert_eq!(name("plain.exr", None).as_deref(), Some("plain.exr"));
        assert_eq!(name("turn.%04d.exr", None), None);
    }
}
