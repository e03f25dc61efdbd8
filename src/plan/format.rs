//! Numbers as people say them.

use crate::trace::{Effort, SmallHighlights};

/// Formats a share as people say it.
pub(super) fn percent(share: f64) -> String {
    match 100.0 * share {
        0.0 => "0 %".into(),
        p if p < 0.0095 => format!("{p:.0e} %"),
        p if p < 0.095 => format!("{p:.2} %"),
        p if p < 9.95 => format!("{p:.1} %"),
        p => format!("{p:.0} %"),
    }
}

/// Formats two shares, the second a limit, with enough digits to show on which side of it the first lies.
pub(super) fn percent_and_limit(share: f64, limit: f64) -> [String; 2] {
    let formatted = [share, limit].map(percent);
    let longer = (2..6).map(|digits| [share, limit].map(|x| format!("{:.digits$} %", 100.0 * x)));
    let is_clear = |formatted: &[String; 2]| formatted[0] != formatted[1];
    std::iter::once(formatted.clone()).chain(longer).find(is_clear).unwrap_or(formatted)
}

/// Formats the most by which something may be off; beyond all of it, the exact number tells nothing.
pub(super) fn percent_bound(bound: f64) -> String {
    if bound > 1.0 { "over 100 %".into() } else { percent(bound) }
}

/// Formats a count as people say it.
pub(super) fn format_count(count: u64) -> String {
    match count as f64 {
        n if n < 1e4 => format!("{count}"),
        n if n < 1e6 => format!("{:.0} thousand", n / 1e3),
        n => format!("{:.1} million", n / 1e6),
    }
}

/// Describes how many times as long the same error takes, that of the image and that of its pixels.
pub(super) fn describe_effort(times: Effort) -> String {
    let number = |times: f64| match times {
        less if less < 0.995 => format!("{less:.2}"),
        few if few < 9.95 => format!("{few:.1}"),
        many => format_count(many.round() as u64),
    };
    let of_pixels = number(times.of_pixels);
    match times.of_whole.map(number) {
        None => format!("the same error would take about {of_pixels} times as long"),
        Some(of_whole) => {
            format!("the same error would take about {of_whole} times as long, that of each pixel {of_pixels} times")
        }
    }
}

/// Describes the small lights and highlights at which samples are aimed, if there are any.
pub(super) fn highlights(found: &SmallHighlights) -> impl Iterator<Item = String> {
    let SmallHighlights { on_film, on_lens } = found;
    let on_film = counted(on_film.iter().map(|highlight| highlight.bounces)).map(|Counted { what, is_single }| {
        let (are, their) = if is_single { ("is", "its") } else { ("are", "their") };
        format!("{what} {are} smaller than a pixel: some samples of {their} pixels are aimed there")
    });
    let on_lens = counted(on_lens.iter().map(|light| light.bounces)).map(|Counted { what, is_single }| {
        let what_is_seen = if is_single {
            "it through the part of the lens that sees it"
        } else {
            "them through the parts of the lens that see them"
        };
        format!("{what} {} out of focus: some samples look at {what_is_seen}", if is_single { "is" } else { "are" })
    });
    on_film.into_iter().chain(on_lens)
}

/// Lights and highlights, counted.
struct Counted {
    what: String,
    is_single: bool,
}

/// Counts lights, which have no bounces, and highlights; `None` if there are neither.
fn counted(bounces: impl Iterator<Item = u32> + Clone) -> Option<Counted> {
    let all = bounces.clone().count();
    let lights = bounces.filter(|&bounces| bounces == 0).count();
    let with_count = |count: usize, thing: &str| match count {
        0 => None,
        1 => Some(format!("1 {thing}")),
        _ => Some(format!("{count} {thing}s")),
    };
    let things: Vec<String> =
        [with_count(lights, "light"), with_count(all - lights, "highlight")].into_iter().flatten().collect();
    (all > 0).then(|| Counted { what: things.join(" and "), is_single: all == 1 })
}

/// Formats a time as people say it.
pub(super) fn format_duration(seconds: f64) -> String {
    match seconds {
        s if s < 1.0 => "a second or less".into(),
        s if s < 1.5 => "1 second".into(),
        s if s < 120.0 => format!("{s:.0} seconds"),
        s if s < 7200.0 => format!("{:.0} minutes", s / 60.0),
        s => format!("{:.1} hours", s / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use super::{describe_effort, format_duration, highlights, percent, percent_and_limit, percent_bound};
    use crate::trace::{Effort, Highlight, LensLight, SmallHighlights};

    #[test]
    fn an_effort_is_that_of_pixels_unless_the_whole_is_asked_for() {
        let formatted = |of_pixels, of_whole| describe_effort(Effort { of_pixels, of_whole });
        assert_eq!(formatted(0.902, None), "the same error would take about 0.90 times as long");
        assert_eq!(
            formatted(19_600.0, Some(1.02)),
            "the same error would take about 1.0 times as long, that of each pixel 20 thousand times"
        );
    }

    #[test]
    fn lights_and_highlights_are_counted_apart() {
        let highlight =
            |bounces| Highlight { light: 0, bounces, center: [0.0; 2], radii: [[1.0, 0.0], [0.0, 1.0]], peak: 0.0 };
        let on_lens = |bounces| {
            let (center, [per_pixel, radii]) = ([0.0; 2], [[[1.0, 0.0], [0.0, 1.0]]; 2]);
            LensLight { light: 0, bounces, center, per_pixel, radii }
        };
        let lines = |sharp: &[u32], blurred: &[u32]| -> Vec<String> {
            let on_film = sharp.iter().map(|&bounces| highlight(bounces)).collect();
            let on_lens = blurred.iter().map(|&bounces| on_lens(bounces)).collect();
            let found = SmallHighlights { on_film, on_lens };
            highlights(&found).map(|line| line.split_once(':').expect("it has two parts").0.to_owned()).collect()
        };
        let described = |bounces: &[u32]| lines(bounces, &[]).pop();
        assert_eq!(described(&[]), None);
        assert_eq!(described(&[0]).as_deref(), Some("1 light is smaller than a pixel"));
        assert_eq!(described(&[1, 2]).as_deref(), Some("2 highlights are smaller than a pixel"));
        assert_eq!(described(&[0, 0, 1]).as_deref(), Some("2 lights and 1 highlight are smaller than a pixel"));
        assert_eq!(lines(&[], &[0]), ["1 light is out of focus"]);
        assert_eq!(
            lines(&[0], &[0, 0, 2]),
            ["1 light is smaller than a pixel", "2 lights and 1 highlight are out of focus"]
        );
    }

    #[test]
    fn little_is_not_nothing() {
        let shares = [0.0, 1e-9, 4.9e-5, 5.1e-5, 9.4e-4, 0.0123, 0.5].map(percent);
        assert_eq!(shares, ["0 %", "1e-7 %", "5e-3 %", "5e-3 %", "0.09 %", "1.2 %", "50 %"]);
    }

    #[test]
    fn what_is_above_a_limit_is_seen_to_be() {
        assert_eq!(percent_and_limit(0.037, 0.005), ["3.7 %", "0.5 %"]);
        assert_eq!(percent_and_limit(0.00523, 0.005), ["0.52 %", "0.50 %"]);
        assert_eq!(percent_and_limit(0.005, 0.005), ["0.5 %", "0.5 %"]);
    }

    #[test]
    fn a_bound_beyond_everything_is_no_number() {
        assert_eq!([0.16, 1.0, 1.79].map(percent_bound), ["16 %", "100 %", "over 100 %"]);
    }

    #[test]
    fn one_second_is_written_in_the_singular() {
        let times = [0.4, 1.0, 1.49, 1.5, 119.0, 125.0, 7300.0].map(format_duration);
        let formatted =
            ["a second or less", "1 second", "1 second", "2 seconds", "119 seconds", "2 minutes", "2.0 hours"];
        assert_eq!(times, formatted);
    }
}
