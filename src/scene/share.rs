/// Parses a share written in percent, such as `5 %`. Returns none if it is not one.
pub fn share(text: &str) -> Option<f64> {
    let percent: f64 = text.strip_suffix('%')?.trim().parse().ok()?;
    // A division by 100 would round a second time.
    format!("{percent}e-2").parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_share_has_as_many_digits_as_its_percent() {
        let written = ["0.05%", "7 %", "120%", "7", "%", "a %"];
        assert_eq!(written.map(share), [Some(0.0005), Some(0.07), Some(1.2), None, None, None]);
    }
}
