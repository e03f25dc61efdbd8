//! Maxima that do not swallow NaN.

/// Returns the larger of two numbers and panics if one of them is NaN. `f64::max` would drop a NaN, and a test of the
/// largest error would pass.
#[track_caller]
pub fn larger<T: PartialOrd + std::fmt::Debug>(a: T, b: T) -> T {
    assert!(a.partial_cmp(&b).is_some(), "one of {a:?} and {b:?} is no number");
    if b > a { b } else { a }
}
