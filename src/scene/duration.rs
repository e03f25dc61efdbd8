use std::time::Duration;

/// Parses a time with its unit, such as `90s`, `10m`, `1.5h` or `20ms`. Returns none if it is not one, or not above 0.
pub fn duration(text: &str) -> Option<Duration> {
    let units = [("ms", 1e-3), ("s", 1.0), ("m", 60.0), ("min", 60.0), ("h", 3600.0)];
    let (number, unit) = text.split_at(text.find(|letter: char| letter.is_ascii_alphabetic()).unwrap_or(text.len()));
    let (_, scale) = units.into_iter().find(|(name, _)| *name == unit)?;
    let seconds = scale * number.trim().parse::<f64>().ok()?;
    Duration::try_from_secs_f64(seconds).ok().filter(|time| !time.is_zero())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_time_has_a_unit() {
        for (text, seconds) in [("60s", 60.0), ("0.5s", 0.5), ("5m", 300.0), ("1.5h", 5400.0), ("20ms", 0.02)] {
            assert_eq!(duration(text), Some(Duration::from_secs_f64(seconds)), "{text}");
        }
        for text in ["", "60", "s", "-1s", "0s", "1e400s", "nans", "1 day", "60 s s"] {
            assert_eq!(duration(text), None, "{text}");
        }
    }
}
