//! Maxima in which nothing is lost.

/// The larger of two numbers. One that is none fails here: `f64::max` would drop it, and a test of the largest error
/// would pass.
#[track_caller]
pub fn larger<T: PartialOrd + std::fmt::Debug>(a: T, b: T) -> T {
    assert!(a.partial_cmp(&b).is_some(), "one of {a:?} and {b:?} is no number");
    if b > a { b } else { a }
}
