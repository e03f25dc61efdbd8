//! The cubic filters of Mitchell & Netravali 1988, *Reconstruction Filters in Computer Graphics*.
//!
//! Their equation 8 (page 223) on one axis, x in pixels from the middle:
//!
//! | | 6 k(x) |
//! |---|---|
//! | \|x\| < 1 | (12 - 9 B - 6 C) \|x\|^3 + (-18 + 12 B + 6 C) \|x\|^2 + 6 - 2 B |
//! | \|x\| < 2 | (-B - 6 C) \|x\|^3 + (6 B + 30 C) \|x\|^2 + (-12 B - 48 C) \|x\| + 8 B + 24 C |
//! | else | 0 |
//!
//! The integral is 1 for any B and C. If both are between 0 and 1, the inner piece falls from (6 - 2 B) / 6 to B / 6,
//! and so is not negative. With t = 2 - |x| the outer piece is t^2 ((B + 6 C) t - 6 C) / 6. It is negative where t is
//! less than t0 = 6 C / (B + 6 C), and its integral there is -M on each side, with M = C t0^3 / 12. Hence the integral
//! of |k| is 1 + 4 M.

/// The largest distance from the center where a filter is not 0.
pub(super) const RADIUS: f64 = 2.0;

/// A cubic filter with two parameters, each from 0 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mitchell {
    /// The blur: with 1 the filter is the cubic B-spline, if c is 0.
    pub b: f64,
    /// The ringing: with 0.5 the filter is the Catmull-Rom spline, if b is 0.
    pub c: f64,
}

impl Mitchell {
    /// The parameters that the authors recommend.
    pub const PLAIN: Self = Self { b: 1.0 / 3.0, c: 1.0 / 3.0 };

    /// Returns the value at a distance from the center on one axis.
    pub(super) fn value(self, x: f64) -> f64 {
        let (Self { b, c }, x) = (self, x.abs());
        if x < 1.0 {
            (((12.0 - 9.0 * b - 6.0 * c) * x + (-18.0 + 12.0 * b + 6.0 * c)) * x * x + (6.0 - 2.0 * b)) / 6.0
        } else if x < RADIUS {
            let t = RADIUS - x;
            t * t * ((b + 6.0 * c) * t - 6.0 * c) / 6.0
        } else {
            0.0
        }
    }

    /// Returns the integral of the absolute value on one axis.
    pub(super) fn absolute_integral(self) -> f64 {
        1.0 + 4.0 * self.negative_integral()
    }

    /// Samples an offset from the center with a density proportional to the absolute value. Inverts its integral by
    /// Newton's method, safeguarded by bisection.
    pub(super) fn place(self, u: f64) -> f64 {
        let target = 0.5 * self.absolute_integral() * (2.0 * u - 1.0).abs();
        let (mut low, mut high, mut x) = (0.0, RADIUS, target);
        for _ in 0..60 {
            let error = self.integral_to(x) - target;
            if error == 0.0 {
                break;
            }
            if error > 0.0 {
                high = x
            } else {
                low = x
            }
            let next = x - error / self.value(x).abs();
            let next = if next > low && next < high { next } else { 0.5 * (low + high) };
            let step = (next - x).abs();
            x = next;
            if step <= 1e-12 {
                break;
            }
        }
        if u < 0.5 { -x } else { x }
    }

    /// Returns the distance from the end of the filter at which the outer piece changes its sign.
    fn sign_change(self) -> f64 {
        if self.c > 0.0 { 6.0 * self.c / (self.b + 6.0 * self.c) } else { 0.0 }
    }

    /// Returns the integral of the negative part on one side, without its sign.
    fn negative_integral(self) -> f64 {
        let sign_change = self.sign_change();
        self.c * sign_change * sign_change * sign_change / 12.0
    }

    /// Returns the integral of the absolute value from the center to x.
    fn integral_to(self, x: f64) -> f64 {
        let Self { b, c } = self;
        if x < 1.0 {
            let squared = x * x;
            let (cubic, square) = (12.0 - 9.0 * b - 6.0 * c, -18.0 + 12.0 * b + 6.0 * c);
            return x * ((cubic / 4.0 * x + square / 3.0) * squared + (6.0 - 2.0 * b)) / 6.0;
        }
        let t = RADIUS - x;
        let tail = t * t * t * (2.0 * c - (b + 6.0 * c) * t / 4.0) / 6.0;
        let tail = if t < self.sign_change() { tail } else { 2.0 * self.negative_integral() - tail };
        0.5 * self.absolute_integral() - tail
    }
}
