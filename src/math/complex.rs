use std::ops::{Add, AddAssign, Div, Mul, Sub};

/// A complex number.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Complex {
    /// Real part.
    pub re: f64,
    /// Imaginary part.
    pub im: f64,
}

impl Complex {
    /// 1.
    pub const ONE: Self = Self::new(1.0, 0.0);

    /// Creates a number from its real and imaginary parts.
    pub const fn new(re: f64, im: f64) -> Self {
        Self { re, im }
    }

    /// Returns the square of the absolute value.
    pub fn norm_squared(self) -> f64 {
        self.re * self.re + self.im * self.im
    }

    /// Returns the conjugate.
    #[must_use]
    pub fn conjugate(self) -> Self {
        Self::new(self.re, -self.im)
    }

    /// Returns the number multiplied by i.
    #[must_use]
    pub fn times_i(self) -> Self {
        Self::new(-self.im, self.re)
    }

    /// Returns the square root whose imaginary part is not above 0, computed without cancellation (Kahan 1987, *Branch
    /// Cuts for Complex Elementary Functions*).
    #[must_use]
    pub fn decaying_root(self) -> Self {
        let modulus = self.norm_squared().sqrt();
        let (re, im) = if self.re >= 0.0 {
            let re = (0.5 * (modulus + self.re)).sqrt();
            (re, if re > 0.0 { 0.5 * self.im / re } else { 0.0 })
        } else {
            let im = (0.5 * (modulus - self.re)).sqrt();
            (0.5 * self.im / im, im)
        };
        if im > 0.0 { Self::new(-re, -im) } else { Self::new(re, im) }
    }
}

impl From<f64> for Complex {
    fn from(re: f64) -> Self {
        Self::new(re, 0.0)
    }
}

impl Add for Complex {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.re + other.re, self.im + other.im)
    }
}

impl AddAssign for Complex {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sub for Complex {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.re - other.re, self.im - other.im)
    }
}

impl Mul for Complex {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self::new(self.re * other.re - self.im * other.im, self.re * other.im + self.im * other.re)
    }
}

impl Mul<f64> for Complex {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self::new(self.re * factor, self.im * factor)
    }
}

impl Div for Complex {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        self * other.conjugate() * (1.0 / other.norm_squared())
    }
}
