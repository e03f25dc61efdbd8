//! Arithmetic with about 31 digits: the reference that 64-bit results are measured against.

use std::cmp::Ordering;
use std::ops::{Add, Div, Mul, Neg, Sub};

use abbe::math::DVec3;

/// An unevaluated sum of two f64. The second is at most half a unit in the last place of the first.
///
/// Hida, Li & Bailey 2001, *Algorithms for Quad-Double Precision Floating Point Arithmetic*, section 3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exact {
    high: f64,
    low: f64,
}

impl Exact {
    pub const ZERO: Self = Self { high: 0.0, low: 0.0 };

    /// Returns the nearest f64.
    pub fn rounded(self) -> f64 {
        self.high
    }

    pub fn abs(self) -> Self {
        if self.high < 0.0 { -self } else { self }
    }

    /// Returns the square root of a nonnegative number: one Newton step from the rounded root (Karp & Markstein 1997).
    pub fn sqrt(self) -> Self {
        if self.high <= 0.0 {
            return Self::ZERO;
        }
        let root = self.high.sqrt();
        let remainder = self - product(root, root);
        quick_sum(root, remainder.high / (2.0 * root))
    }
}

impl From<f64> for Exact {
    fn from(x: f64) -> Self {
        Self { high: x, low: 0.0 }
    }
}

/// Adds a and b without error (Knuth 1969, theorem B of section 4.2.2).
fn sum(a: f64, b: f64) -> Exact {
    let high = a + b;
    let b_rounded = high - a;
    Exact { high, low: (a - (high - b_rounded)) + (b - b_rounded) }
}

/// Adds a and b without error if |a| >= |b| (Dekker 1971).
fn quick_sum(a: f64, b: f64) -> Exact {
    let high = a + b;
    Exact { high, low: b - (high - a) }
}

/// Multiplies a and b without error.
fn product(a: f64, b: f64) -> Exact {
    let high = a * b;
    Exact { high, low: a.mul_add(b, -high) }
}

impl Add for Exact {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (high, low) = (sum(self.high, other.high), sum(self.low, other.low));
        let first = quick_sum(high.high, high.low + low.high);
        quick_sum(first.high, first.low + low.low)
    }
}

impl Neg for Exact {
    type Output = Self;

    fn neg(self) -> Self {
        Self { high: -self.high, low: -self.low }
    }
}

impl Sub for Exact {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Exact {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let p = product(self.high, other.high);
        quick_sum(p.high, p.low + (self.high * other.low + self.low * other.high))
    }
}

impl Div for Exact {
    type Output = Self;

    /// Long division with three digits of 53 bits each.
    fn div(self, other: Self) -> Self {
        let first = self.high / other.high;
        let remainder = self - other * first.into();
        let second = remainder.high / other.high;
        let third = (remainder - other * second.into()).high / other.high;
        quick_sum(first, second) + third.into()
    }
}

impl PartialOrd for Exact {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        (*self - *other).high.partial_cmp(&0.0)
    }
}

/// A vector of exact numbers.
#[derive(Clone, Copy, Debug)]
pub struct ExactVector([Exact; 3]);

impl ExactVector {
    pub fn dot(self, other: Self) -> Exact {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        a * x + b * y + c * z
    }

    pub fn cross(self, other: Self) -> Self {
        let ([a, b, c], [x, y, z]) = (self.0, other.0);
        Self([b * z - c * y, c * x - a * z, a * y - b * x])
    }

    pub fn length(self) -> Exact {
        self.dot(self).sqrt()
    }
}

impl From<DVec3> for ExactVector {
    fn from(v: DVec3) -> Self {
        Self(v.to_array().map(Exact::from))
    }
}

impl Add for ExactVector {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] + other.0[i]))
    }
}

impl Sub for ExactVector {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] - other.0[i]))
    }
}

impl Mul<Exact> for ExactVector {
    type Output = Self;

    fn mul(self, factor: Exact) -> Self {
        Self(self.0.map(|x| x * factor))
    }
}

#[test]
fn exact_arithmetic_carries_31_digits() {
    let number = |x: f64| Exact::from(x);
    let third = number(1.0) / number(3.0);
    // The digits of the square root of 2 beyond the 53 bits of its f64 (OEIS A002193).
    let root = Exact { high: std::f64::consts::SQRT_2, low: -9.667_293_313_452_913e-17 };
    let errors = [
        third * number(3.0) - number(1.0),
        number(2.0).sqrt() - root,
        number(1e16) + number(1.0) - number(1e16) - number(1.0),
        (number(1.0) + number(1e-20)) * (number(1.0) - number(1e-20)) - number(1.0),
    ];
    for error in errors {
        assert!(error.abs() < number(1e-31), "{error:?}");
    }
}
