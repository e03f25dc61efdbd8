//! Frames: which ones to render, and their numbers in file names.

use std::path::{Path, PathBuf};
use std::str::FromStr;

use abbe::{Error, Result};

/// Frames that are rendered one after another, in the order of the list.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Frames(Vec<Run>);

/// Frames from a first to a last one in equal steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Run {
    first: u32,
    last: u32,
    step: u32,
}

impl Frames {
    /// Returns the number of each frame once.
    pub fn numbers(&self) -> impl Iterator<Item = u32> {
        let run_numbers = |(place, run): (usize, &Run)| {
            let earlier_runs = &self.0[..place];
            run.numbers().filter(move |&number| !earlier_runs.iter().any(|run| run.contains(number)))
        };
        self.0.iter().enumerate().flat_map(run_numbers)
    }

    /// Returns the lowest and the highest number.
    pub fn ends(&self) -> impl Iterator<Item = u32> {
        let lowest = self.0.iter().map(|run| run.first).min();
        let highest = self.0.iter().map(|run| run.last - (run.last - run.first) % run.step).max();
        lowest.into_iter().chain(highest)
    }

    /// Returns the number of frames.
    pub fn count(&self) -> u64 {
        match &self.0[..] {
            [run] => u64::from((run.last - run.first) / run.step) + 1,
            _ => self.numbers().count() as u64,
        }
    }
}

impl Run {
    fn numbers(self) -> impl Iterator<Item = u32> {
        (self.first..=self.last).step_by(self.step as usize)
    }

    fn contains(self, number: u32) -> bool {
        (self.first..=self.last).contains(&number) && (number - self.first).is_multiple_of(self.step)
    }
}

impl FromStr for Frames {
    type Err = String;

    /// Parses `7`, `1-24`, `1-24x2`, or several of these separated by commas.
    fn from_str(text: &str) -> std::result::Result<Self, String> {
        text.split(',').map(|run| run.trim().parse()).collect::<std::result::Result<_, _>>().map(Self)
    }
}

impl FromStr for Run {
    type Err = String;

    fn from_str(text: &str) -> std::result::Result<Self, String> {
        let number = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit()).then(|| text.parse().ok()).flatten();
        let (range, step) = text.split_once('x').map_or((text, Some(1)), |(range, step)| (range, number(step)));
        let (first, last) = range.split_once('-').unwrap_or((range, range));
        // Other programs write ranges with `..` or `:`.
        let dashed = text.replace("..", "-").replace(':', "-");
        match (number(first), number(last), step) {
            (Some(first), Some(last), Some(_)) if last < first => {
                Err(format!("{text} ends before it begins: write {last}-{first}"))
            }
            (Some(first), Some(last), Some(step)) if step > 0 => Ok(Self { first, last, step }),
            _ if dashed != text && dashed.parse::<Self>().is_ok() => Err(format!("write {dashed} for {text}")),
            _ => Err(format!("frames are whole numbers from 0 to {}, such as 7, 1-24, 1-24x2 or 3,17,40-50", u32::MAX)),
        }
    }
}

/// The maximum number of digits for a frame in a file name, more than any frame number has.
const MAX_DIGITS: usize = 20;

/// Replaces `%04d`, or another number of digits, by the number of the frame, and `%%` by a percent sign.
///
/// # Errors
/// If the path needs a number and no frame is given, or if a frame is given and the path has a place for it only in the
/// notation of other programs.
pub fn frame_path(path: &Path, frame: Option<u32>) -> Result<PathBuf> {
    let Some(text) = path.to_str() else { return Ok(path.to_owned()) };
    let (mut name, mut rest, mut is_numbered) = (String::new(), text, false);
    while let Some((before, after)) = rest.split_once('%') {
        name.push_str(before);
        rest = if let Some(after) = after.strip_prefix('%') {
            name.push('%');
            after
        } else if let Some((digits, after)) = digits(after) {
            let Some(frame) = frame else {
                let message = format!("{text} has a place for the frame number, but no frame is given");
                return Error::refuse(message, "give its number: --frame 1");
            };
            name.push_str(&format!("{frame:0digits$}"));
            is_numbered = true;
            after
        } else {
            name.push('%');
            after
        };
    }
    name.push_str(rest);
    match foreign_placeholder(text).filter(|_| frame.is_some() && !is_numbered) {
        Some(mark) => Error::refuse(overwritten_message(text), format!("write %04d in place of {mark}")),
        None => Ok(name.into()),
    }
}

/// Refuses the name of a file for several frames if it contains no number.
///
/// # Errors
/// If it contains none, or one in the notation of other programs.
pub fn check_has_number(path: &Path) -> Result<()> {
    if frame_path(path, Some(0))? != frame_path(path, Some(1))? {
        return Ok(());
    }
    let example = match (path.file_stem().and_then(|stem| stem.to_str()), path.extension().and_then(|end| end.to_str()))
    {
        (Some(stem), Some(end)) => path.with_file_name(format!("{stem}.%04d.{end}")),
        _ => "turn.%04d.exr".into(),
    };
    Error::refuse(
        overwritten_message(&path.display().to_string()),
        format!("put the frame number into the name: {}", example.display()),
    )
}

fn overwritten_message(path: &str) -> String {
    format!("{path} would be written by every frame")
}

/// Parses what follows a percent sign, as in `%04d`, `%4d` or `%d`: returns the minimum number of digits, and the rest
/// of the text. A `%d` before a letter is part of a word, as in `50%dark`.
fn digits(text: &str) -> Option<(usize, &str)> {
    let rest = text.trim_start_matches(|letter: char| letter.is_ascii_digit());
    let (number, rest) = (&text[..text.len() - rest.len()], rest.strip_prefix('d')?);
    if number.is_empty() {
        return Some((0, rest)).filter(|_| !rest.starts_with(char::is_alphabetic));
    }
    let digits = number.parse().ok().filter(|&digits| digits <= MAX_DIGITS)?;
    Some((digits, rest))
}

/// Finds the placeholder that other programs use for the number of a frame.
fn foreign_placeholder(text: &str) -> Option<&str> {
    let run = |letter: char| {
        let tail = &text[text.find([letter, letter].iter().collect::<String>().as_str())?..];
        Some(&tail[..tail.len() - tail.trim_start_matches(letter).len()])
    };
    let whole_word = |mark: &str| {
        let ends = |start: usize| start + mark.len();
        let (start, _) =
            text.match_indices(mark).find(|(start, _)| !text[ends(*start)..].starts_with(char::is_alphabetic))?;
        let rest = text[ends(start)..].trim_start_matches(|letter: char| letter.is_ascii_digit());
        Some(&text[start..text.len() - rest.len()])
    };
    let python = || {
        let tail = &text[text.find("{frame}").or_else(|| text.find("{frame:"))?..];
        Some(&tail[..=tail.find('}')?])
    };
    run('#')
        .or_else(|| run('@'))
        .or_else(|| whole_word("$frame"))
        .or_else(|| whole_word("$F"))
        .or_else(python)
        .or_else(|| whole_word("%s"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn name(path: &str, frame: Option<u32>) -> Option<String> {
        frame_path(Path::new(path), frame).map(|path| path.display().to_string()).ok()
    }

    #[test]
    fn frames_are_one_or_a_range_with_a_step_or_several_of_these() {
        let numbers = |text: &str| text.parse::<Frames>().map(|frames| frames.numbers().collect::<Vec<_>>());
        for (text, count) in [("7", 1), ("1-10x4", 3), ("1-9x4", 3), ("1-8x4", 2), ("0-4294967295", 1 << 32)] {
            assert_eq!(text.parse::<Frames>().map(|frames| frames.count()), Ok(count));
        }
        let ends = |text: &str| text.parse::<Frames>().map(|frames| frames.ends().collect::<Vec<_>>());
        assert_eq!([ends("7"), ends("17, 1-8x4, 4-6")], [Ok(vec![7, 7]), Ok(vec![1, 17])]);
        assert_eq!(ends("1-8x4"), Ok(vec![1, 5]));
        assert_eq!(numbers("7"), Ok(vec![7]));
        assert_eq!(numbers("0-3"), Ok(vec![0, 1, 2, 3]));
        assert_eq!(numbers("4-4"), Ok(vec![4]));
        assert_eq!(numbers("1-10x4"), Ok(vec![1, 5, 9]));
        assert_eq!(numbers("4294967295"), Ok(vec![u32::MAX]));
        assert_eq!(numbers("17,3,80"), Ok(vec![17, 3, 80]));
        assert_eq!(numbers("8, 1-10x4, 4-6, 8"), Ok(vec![8, 1, 5, 9, 4, 6]), "each once");
        assert_eq!("8,1-10x4,4-6,8".parse::<Frames>().map(|frames| frames.count()), Ok(6));
        assert_eq!(numbers("24-1"), Err("24-1 ends before it begins: write 1-24".into()));
        let wrong = "|-3|1.5|1-|-|1-24x0|1-24x|+1|1-+2|a|1-2-3|4294967296|1 - 2|1,|,|1,,2";
        for wrong in wrong.split('|') {
            let error = numbers(wrong).expect_err(wrong);
            assert!(error.contains("such as 7, 1-24"), "{error}");
        }
    }

    #[test]
    fn a_name_without_a_number_is_refused_for_several_frames() {
        let help = |path: &str| match check_has_number(Path::new(path)) {
            Err(abbe::Error::Arguments { message, help: Some(help) }) => Some([message, help]),
            _ => None,
        };
        assert_eq!(help("out/turn.%04d.exr"), None);
        let [message, advice] = help("out/turn.exr").expect("it is refused");
        assert_eq!(message, "out/turn.exr would be written by every frame");
        assert_eq!(advice, "put the frame number into the name: out/turn.%04d.exr");
        assert!(help("-").is_some() && help("100%%d.exr").is_some());
    }

    #[test]
    fn numbers_are_padded_to_the_digits_that_the_name_asks_for() {
        assert_eq!(name("out/turn.%04d.exr", Some(7)).as_deref(), Some("out/turn.0007.exr"));
        assert_eq!(name("turn.%04d.exr", Some(12345)).as_deref(), Some("turn.12345.exr"));
        assert_eq!(name("%d.exr", Some(7)).as_deref(), Some("7.exr"));
        assert_eq!(name("d%04d/f_%d_%02d.exr", Some(7)).as_deref(), Some("d0007/f_7_07.exr"));
        assert_eq!(name("plain.exr", None).as_deref(), Some("plain.exr"));
        assert_eq!(name("turn.%04d.exr", None), None);
    }

    #[test]
    fn a_percent_that_asks_for_no_number_stays() {
        for frame in [None, Some(7)] {
            for plain in ["100%.exr", "50%dark.exr", "%99999999999999999999d.exr", "100%x.exr", "50%small.exr"] {
                assert_eq!(name(plain, frame).as_deref(), Some(plain));
            }
            assert_eq!(name("100%%d.exr", frame).as_deref(), Some("100%d.exr"));
        }
        assert_eq!(name("100%x %02d.exr", Some(7)).as_deref(), Some("100%x 07.exr"));
    }

    #[test]
    fn placeholders_of_other_programs_are_refused() {
        for (plain, mark) in [
            ("f.####.exr", "####"),
            ("f.@@@.exr", "@@@"),
            ("f.$F4.exr", "$F4"),
            ("$F.exr", "$F"),
            ("f.$frame.exr", "$frame"),
            ("f.{frame}.exr", "{frame}"),
            ("f.{frame:04}.exr", "{frame:04}"),
            ("f.%s.exr", "%s"),
        ] {
            assert_eq!(foreign_placeholder(plain), Some(mark));
            assert_eq!(name(plain, Some(7)), None);
            assert_eq!(name(plain, None).as_deref(), Some(plain));
        }
        assert_eq!(name("#1 @home $Final {frames}.exr", Some(7)).as_deref(), Some("#1 @home $Final {frames}.exr"));
        assert_eq!(name("####.%d.exr", Some(7)).as_deref(), Some("####.7.exr"));
    }
}
