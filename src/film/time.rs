//! The time of day as files record it.

use std::time::{SystemTime, UNIX_EPOCH};

/// Seconds of a day.
const DAY_SECONDS: u64 = 86_400;

/// Formats a time in UTC as `YYYY:MM:DD hh:mm:ss` (OpenEXR, *Standard Attributes*, `capDate`). A time before 1970
/// becomes the first second of that year.
///
/// The algorithm is `civil_from_days` of H. Hinnant, *chrono-Compatible Low-Level Date Algorithms* (2013). Years begin
/// in March, so that a leap day is the last day of its year.
pub(super) fn cap_date(time: SystemTime) -> String {
    let seconds = time.duration_since(UNIX_EPOCH).map_or(0, |elapsed| elapsed.as_secs());
    let (hour, minute, second) = (seconds / 3600 % 24, seconds / 60 % 60, seconds % 60);
    // Days since 0000-03-01. An era has 400 years.
    let days = seconds / DAY_SECONDS + 719_468;
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let year = 400 * era + year + u64::from(month >= 10);
    let month = if month < 10 { month + 3 } else { month - 9 };
    format!("{year:04}:{month:02}:{day:02} {hour:02}:{minute:02}:{second:02}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    #[test]
    fn days_are_those_of_the_calendar() {
        let date = |seconds: u64| cap_date(UNIX_EPOCH + Duration::from_secs(seconds));
        assert_eq!(date(0), "1970:01:01 00:00:00");
        assert_eq!(date(951_782_399), "2000:02:28 23:59:59");
        assert_eq!(date(951_782_400), "2000:02:29 00:00:00");
        assert_eq!(date(951_868_800), "2000:03:01 00:00:00");
        assert_eq!(date(1_795_420_284), "2026:11:23 07:51:24");
        assert_eq!(date(4_107_542_399), "2100:02:28 23:59:59");
        assert_eq!(date(4_107_542_400), "2100:03:01 00:00:00");
        assert_eq!(cap_date(UNIX_EPOCH - Duration::from_secs(1)), "1970:01:01 00:00:00");
    }

    #[test]
    fn every_day_follows_the_one_before() {
        let mut last = String::new();
        for day in 0..200 * 366 {
            let date = cap_date(UNIX_EPOCH + Duration::from_secs(day * DAY_SECONDS));
            assert!(date > last, "{last} and then {date}");
            last = date;
        }
    }
}
