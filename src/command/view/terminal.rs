//! Pictures as text for terminals.

use std::env::var_os;
use std::fmt::Write;
use std::io::IsTerminal;

use abbe::Result;
use abbe::look::Picture;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;

/// The number of columns of a terminal that does not tell it.
const DEFAULT_COLUMNS: usize = 80;
/// The approximate width of a column in pixels, on terminals that show pixels.
const COLUMN_WIDTH: usize = 8;
/// The maximum number of bytes of data in an escape sequence of the kitty graphics protocol.
const MAX_CHUNK_BYTES: usize = 4096;
/// The levels of red, green and blue in sixels. Terminals have 256 colors at once.
const LEVELS: usize = 6;

/// Returns the text that draws a picture on the terminal of stdout, and no wider than that.
pub fn draw(picture: &Picture, sixel: bool) -> Result<String> {
    let columns = columns();
    let pixels = fitted(picture, columns * COLUMN_WIDTH, 1);
    Ok(match () {
        () if sixel => sixels(&pixels),
        () if supports_kitty() => kitty(&pixels.png()?, columns.min(pixels.width().div_ceil(COLUMN_WIDTH))),
        () => blocks(&fitted(picture, columns, 2)),
    })
}

fn columns() -> usize {
    let measured = terminal_size::terminal_size_of(std::io::stdout()).map(|(width, _)| usize::from(width.0));
    let from_environment = || var_os("COLUMNS").and_then(|columns| columns.to_str()?.parse().ok());
    measured.or_else(from_environment).filter(|columns| (1..10_000).contains(columns)).unwrap_or(DEFAULT_COLUMNS)
}

/// Returns whether the terminal says that it supports the kitty graphics protocol. Inside tmux and screen, none does.
fn supports_kitty() -> bool {
    let env_contains = |name: &str, words: &[&str]| {
        let value = var_os(name).map(|value| value.to_string_lossy().to_lowercase()).unwrap_or_default();
        words.iter().any(|word| value.contains(word))
    };
    let in_multiplexer = var_os("TMUX").is_some() || env_contains("TERM", &["screen", "tmux"]);
    let is_known = var_os("KITTY_WINDOW_ID").is_some()
        || env_contains("TERM", &["kitty", "ghostty"])
        || env_contains("TERM_PROGRAM", &["kitty", "wezterm", "ghostty"]);
    std::io::stdout().is_terminal() && is_known && !in_multiplexer
}

/// Scales a picture down to at most `max_width` pixels in width. Its new height is a multiple of `rows`, unless it had
/// fewer.
fn fitted(picture: &Picture, max_width: usize, rows: usize) -> Picture {
    let [width, height] = [picture.width(), picture.height()];
    if width <= max_width {
        return picture.clone();
    }
    let lines = (height * max_width).div_ceil(width).next_multiple_of(rows);
    picture.scaled(max_width, lines.min(height))
}

/// Draws characters whose upper half is one pixel and whose lower half is another.
fn blocks(picture: &Picture) -> String {
    let bytes = picture.bytes();
    let rows: Vec<&[[u8; 3]]> = bytes.chunks_exact(picture.width()).collect();
    let mut text = String::new();
    for pair in rows.chunks(2) {
        let mut last_halves = None;
        for x in 0..picture.width() {
            let halves = (pair[0][x], pair.get(1).map(|row| row[x]));
            if last_halves != Some(halves) {
                let ([r, g, b], lower) = halves;
                let _ = write!(text, "\x1b[38;2;{r};{g};{b}");
                let _ = lower.map_or(Ok(()), |[r, g, b]| write!(text, ";48;2;{r};{g};{b}"));
                text.push('m');
            }
            last_halves = Some(halves);
            text.push('▀');
        }
        text.push_str("\x1b[0m\n");
    }
    text
}

/// Draws with the kitty graphics protocol: a PNG in base64, in chunks, of which all but the last say that more follows.
fn kitty(png: &[u8], columns: usize) -> String {
    let encoded = BASE64_STANDARD.encode(png);
    let last = encoded.len().div_ceil(MAX_CHUNK_BYTES) - 1;
    let mut text = String::new();
    for (number, start) in (0..encoded.len()).step_by(MAX_CHUNK_BYTES).enumerate() {
        let first = if number == 0 { format!("a=T,f=100,c={columns},") } else { String::new() };
        let more = u8::from(number < last);
        let chunk = &encoded[start..(start + MAX_CHUNK_BYTES).min(encoded.len())];
        let _ = write!(text, "\x1b_G{first}m={more};{chunk}\x1b\\");
    }
    text + "\n"
}

/// Draws sixels: bands of six rows, one color after another. The colors are a cube of 216, between which pixels are
/// dithered with an ordered pattern (Bayer 1973).
fn sixels(picture: &Picture) -> String {
    const PATTERN: [[usize; 4]; 4] = [[0, 8, 2, 10], [12, 4, 14, 6], [3, 11, 1, 9], [15, 7, 13, 5]];
    let width = picture.width();
    let color = |index: usize, pixel: &[u8; 3]| {
        let threshold = (2 * PATTERN[index / width % 4][index % width % 4] + 1) * 255 / 32;
        let level = |byte: u8| (usize::from(byte) * (LEVELS - 1) + threshold) / 255;
        pixel.iter().fold(0, |color, byte| LEVELS * color + level(*byte))
    };
    let colors: Vec<usize> = picture.bytes().iter().enumerate().map(|(index, pixel)| color(index, pixel)).collect();
    let mut text = format!("\x1bP0;1q\"1;1;{width};{}", picture.height());
    for color in 0..LEVELS.pow(3) {
        let [r, g, b] = [color / (LEVELS * LEVELS), color / LEVELS % LEVELS, color % LEVELS].map(|level| level * 20);
        let _ = write!(text, "#{color};2;{r};{g};{b}");
    }
    for band in colors.chunks(6 * width) {
        let mut used_colors: Vec<usize> = band.to_vec();
        used_colors.sort_unstable();
        used_colors.dedup();
        for color in used_colors {
            let _ = write!(text, "#{color}");
            let bit = |x: usize, y: usize| u8::from(band.get(y * width + x) == Some(&color)) << y;
            let columns: Vec<u8> = (0..width).map(|x| 63 + (0..6).map(|y| bit(x, y)).sum::<u8>()).collect();
            for run in columns.chunk_by(|a, b| a == b) {
                let _ = write!(text, "!{}{}", run.len(), char::from(run[0]));
            }
            text.push('$');
        }
        text.push('-');
    }
    text + "\x1b\\\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_rows_of_pixels_are_one_row_of_characters() {
        let picture = Picture::of_grays(2, [0.0, 1.0, 1.0, 1.0, 0.0, 0.0]);
        let first = "\x1b[38;2;0;0;0;48;2;255;255;255m▀\x1b[38;2;255;255;255;48;2;255;255;255m▀\x1b[0m\n";
        // The last row has no lower half, and colors that stay the same are not repeated.
        assert_eq!(blocks(&picture), format!("{first}\x1b[38;2;0;0;0m▀▀\x1b[0m\n"));
    }

    #[test]
    fn a_wide_picture_is_fitted_and_a_narrow_one_stays() {
        let picture = Picture::of_grays(100, vec![0.5; 100 * 50]);
        let fitted_to = |max_width| (fitted(&picture, max_width, 2).width(), fitted(&picture, max_width, 2).height());
        assert_eq!(fitted_to(40), (40, 20));
        assert_eq!(fitted_to(33), (33, 18));
        assert_eq!(fitted_to(200), (100, 50));
        let line = Picture::of_grays(100, vec![0.5; 100]);
        assert_eq!((fitted(&line, 10, 2).width(), fitted(&line, 10, 2).height()), (10, 1));
    }

    #[test]
    fn chunks_of_the_kitty_protocol_hold_the_whole_png() {
        let png: Vec<u8> = (0..10_000_u32).map(|i| (i * i) as u8).collect();
        let text = kitty(&png, 7);
        let mut data = String::new();
        let sequences: Vec<&str> = text.trim_end().split("\x1b\\").filter(|part| !part.is_empty()).collect();
        for (number, sequence) in sequences.iter().enumerate() {
            let (keys, chunk) =
                sequence.strip_prefix("\x1b_G").and_then(|rest| rest.split_once(';')).expect("a sequence");
            let first = if number == 0 { "a=T,f=100,c=7," } else { "" };
            let more = u8::from(number + 1 < sequences.len());
            assert_eq!(keys, format!("{first}m={more}"));
            assert!(chunk.len() <= MAX_CHUNK_BYTES && (more == 0 || chunk.len().is_multiple_of(4)));
            data += chunk;
        }
        assert_eq!(sequences.len(), 4);
        assert_eq!(BASE64_STANDARD.decode(data).expect("base64"), png);
    }

    #[test]
    fn sixels_draw_every_pixel_once() {
        let picture = Picture::of_grays(5, (0..35).map(|i| f64::from(i) / 34.0));
        let text = sixels(&picture);
        let body =
            text.strip_prefix("\x1bP0;1q\"1;1;5;7").and_then(|rest| rest.strip_suffix("-\x1b\\\n")).expect("sixels");
        let bands: Vec<&str> = body.split('-').collect();
        assert_eq!(bands.len(), 2);
        for (band, rows) in bands.iter().zip([6, 1]) {
            let mut drawn = 0;
            for color in band.split('$') {
                for run in color.split('!').skip(1) {
                    let count: u32 = run[..run.len() - 1].parse().expect("a count");
                    drawn += count * (run.as_bytes()[run.len() - 1] - 63).count_ones();
                }
            }
            assert_eq!(drawn, 5 * rows);
        }
    }
}
