//! A small, independent calculus of Stokes and Mueller: light with its frame, surfaces by their complex amplitudes.

use abbe::math::DVec3;

type Complex = [f64; 2];

fn product(a: Complex, b: Complex) -> Complex {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

fn quotient(a: Complex, b: Complex) -> Complex {
    let square = b[0] * b[0] + b[1] * b[1];
    product(a, [b[0] / square, -b[1] / square])
}

/// Returns the square root whose imaginary part is not positive.
fn root(a: Complex) -> Complex {
    let modulus = a[0].hypot(a[1]);
    [((modulus + a[0]) / 2.0).max(0.0).sqrt(), -((modulus - a[0]) / 2.0).max(0.0).sqrt()]
}

/// The effect of a surface on the intensities of s and p, and on the product of the amplitude of s and the conjugate of
/// that of p. The second axis of its frames is the direction of travel x s.
#[derive(Clone, Copy)]
pub struct Event {
    s: f64,
    p: f64,
    both: Complex,
}

impl Event {
    /// Returns the share that is left of unpolarized light.
    pub fn mean(&self) -> f64 {
        0.5 * (self.s + self.p)
    }
}

/// Returns the amplitudes of light reflected by a medium of index n - ik (Born & Wolf 1999, sections 1.5.2 and 14.2).
fn amplitudes(n: f64, k: f64, cos: f64) -> [Complex; 2] {
    let square = product([n, -k], [n, -k]);
    let beyond = root([square[0] - (1.0 - cos * cos), square[1]]);
    let s = quotient([cos - beyond[0], -beyond[1]], [cos + beyond[0], beyond[1]]);
    let inside = [square[0] * cos, square[1] * cos];
    let p = quotient([inside[0] - beyond[0], inside[1] - beyond[1]], [inside[0] + beyond[0], inside[1] + beyond[1]]);
    [s, p]
}

fn reflected([s, p]: [Complex; 2]) -> Event {
    let square = |a: Complex| a[0] * a[0] + a[1] * a[1];
    Event { s: square(s), p: square(p), both: product(s, [p[0], -p[1]]) }
}

/// Returns the reflection by a metal.
pub fn metal(n: f64, k: f64, cos: f64) -> Event {
    reflected(amplitudes(n, k, cos))
}

/// Returns the reflection by the surface of a transparent body.
pub fn surface(n: f64, cos: f64) -> Event {
    reflected(amplitudes(n, 0.0, cos))
}

/// Returns a reflection that shifts the phase of one polarization by half a wave.
pub fn mirror() -> Event {
    Event { s: 1.0, p: 1.0, both: [-1.0, 0.0] }
}

/// Returns the transmission and the reflection of a pane, with all reflections inside it and without interference.
pub fn pane(n: f64, cos: f64) -> [Event; 2] {
    let [s, p] = amplitudes(n, 0.0, cos).map(|amplitude| amplitude[0]);
    let series = |a: f64, b: f64| (1.0 - a * a) * (1.0 - b * b) / (1.0 - a * a * b * b);
    let through = Event { s: series(s, s), p: series(p, p), both: [series(s, p), 0.0] };
    let back = |a: f64, b: f64| a * b * (1.0 + series(a, b));
    [through, Event { s: back(s, s), p: back(p, p), both: [back(s, p), 0.0] }]
}

/// Light, with the axis that its Stokes vector refers to.
pub struct Stokes {
    vector: [f64; 4],
    axis: Option<DVec3>,
}

impl Stokes {
    pub fn unpolarized() -> Self {
        Self { vector: [1.0, 0.0, 0.0, 0.0], axis: None }
    }

    pub fn intensity(&self) -> f64 {
        self.vector[0]
    }

    /// Returns the light after an event at a surface with the given normal, which it reaches in the direction `from`.
    pub fn after(self, event: &Event, from: DVec3, normal: DVec3) -> Self {
        let Some(s) = from.cross(normal).try_normalize() else {
            unreachable!("no link is met straight on");
        };
        let [i, q, u, v] = self.vector;
        let axis = self.axis.unwrap_or(s);
        let (cos, sin) = (axis.dot(s), from.cross(axis).dot(s));
        let (twice_cos, twice_sin) = (cos * cos - sin * sin, 2.0 * cos * sin);
        let (q, u) = (twice_cos * q + twice_sin * u, twice_cos * u - twice_sin * q);
        let (s_light, p_light) = (0.5 * (i + q) * event.s, 0.5 * (i - q) * event.p);
        let [u, v] = product(event.both, [u, v]);
        Self { vector: [s_light + p_light, s_light - p_light, u, v], axis: Some(s) }
    }
}
