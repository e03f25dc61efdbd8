/// Returns the median of some numbers, or the larger of the two middle ones if their count is even. Returns `None` if
/// there are no numbers.
pub fn median(mut numbers: Vec<f64>) -> Option<f64> {
    let middle = numbers.len() / 2;
    (!numbers.is_empty()).then(|| *numbers.select_nth_unstable_by(middle, f64::total_cmp).1)
}
