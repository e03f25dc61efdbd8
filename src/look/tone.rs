/// A tone curve, which maps light to what a screen can show. It is applied to red, green and blue separately.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Tone {
    /// Clips light beyond 1, and leaves darker light unchanged.
    #[default]
    Srgb,
    /// A filmic curve: a soft toe, and a shoulder that reaches white at 5.6. Hable 2010, *Uncharted 2: HDR Lighting*,
    /// Game Developers Conference, with the constants and the exposure bias of 2 that he gives in *Filmic Tonemapping
    /// Operators*, filmicworlds.com 2010.
    Hable,
}

impl Tone {
    /// All curves.
    pub const ALL: [Self; 2] = [Self::Srgb, Self::Hable];

    /// Returns the name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Srgb => "srgb",
            Self::Hable => "hable",
        }
    }

    /// Returns the linear value that a screen shows, 0 to 1. NaN becomes black.
    pub fn shown(self, light: f64) -> f64 {
        shown(match self {
            Self::Srgb => light,
            Self::Hable => hable(2.0 * light.clamp(0.0, MAX_LIGHT)) / hable(WHITE),
        })
    }
}

/// Clamps a value to 0 to 1. NaN becomes 0.
pub(super) fn shown(value: f64) -> f64 {
    if value.is_nan() { 0.0 } else { value.clamp(0.0, 1.0) }
}

/// The argument of the curve, with the bias included, that is shown as white.
const WHITE: f64 = 11.2;
/// Light that is white whatever the curve. Anything beyond it is clamped, as the curve of infinity would be NaN.
const MAX_LIGHT: f64 = 1e6;

/// Evaluates the curve with its six constants: shoulder strength, linear strength, linear angle, toe strength, toe
/// numerator and toe denominator.
fn hable(x: f64) -> f64 {
    const A: f64 = 0.15;
    const B: f64 = 0.50;
    const C: f64 = 0.10;
    const D: f64 = 0.20;
    const E: f64 = 0.02;
    const F: f64 = 0.30;
    (x * (A * x + C * B) + D * E) / (x * (A * x + B) + D * F) - E / F
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From the listing, with x = 2 light: (0.15 x^2 + 0.05 x + 0.004) / (0.15 x^2 + 0.5 x + 0.06) - 1/15, divided by
    /// its value at 11.2.
    #[test]
    fn the_curve_of_hable_has_its_published_values() {
        let white = 19.38 / 24.476 - 1.0 / 15.0;
        for (light, over, under) in [(0.18, 0.04144, 0.25944), (0.5, 0.204, 0.71), (1.0, 0.704, 1.66)] {
            let expected = (over / under - 1.0 / 15.0) / white;
            assert!((Tone::Hable.shown(light) - expected).abs() < 1e-12, "{light}");
        }
        assert_eq!(Tone::Hable.shown(0.0), 0.0);
        assert!((Tone::Hable.shown(5.6) - 1.0).abs() < 1e-12);
        assert!(Tone::Hable.shown(5.5) < 1.0);
    }

    #[test]
    fn every_curve_stays_within_what_a_screen_can_show() {
        for tone in Tone::ALL {
            for light in [f64::NEG_INFINITY, -1.0, -1e-9, f64::NAN] {
                assert_eq!(tone.shown(light), 0.0, "{tone:?} of {light}");
            }
            for light in [6.0, 1e9, f64::MAX, f64::INFINITY] {
                assert_eq!(tone.shown(light), 1.0, "{tone:?} of {light}");
            }
            let rises = (0..100).all(|i| tone.shown(f64::from(i) / 50.0) <= tone.shown(f64::from(i + 1) / 50.0));
            assert!(rises, "{tone:?}");
        }
        assert_eq!(Tone::Srgb.shown(0.25), 0.25);
    }
}
