use super::{Curve, CurveKind, Draw, Lanes, Table};

/// Factors on white that make red, green, blue, cyan, magenta and yellow of it.
///
/// From them any linear Rec.709 color becomes a filter that is linear between colors, smooth, and gray where the color is.
#[derive(Clone, Debug, PartialEq)]
pub struct Tints<S>([S; 6]);

impl Tints<Curve> {
    /// The six colors.
    pub fn new() -> Self {
        let colors = [[1., 0., 0.], [0., 1., 0.], [0., 0., 1.], [0., 1., 1.], [1., 0., 1.], [1., 1., 0.]];
        Self(colors.map(|rgb| CurveKind::Rgb(rgb).into()))
    }
}

impl Default for Tints<Curve> {
    fn default() -> Self {
        Self::new()
    }
}

impl<S> Tints<S> {
    /// The same with each color converted; all six are transmittances.
    pub fn map<T>(&self, convert: impl FnMut(&S) -> T) -> Tints<T> {
        Tints(self.0.each_ref().map(convert))
    }
}

impl Tints<Table> {
    /// The factor that makes a color of white; no number of it is negative.
    ///
    /// White as far as all three go, one of cyan, magenta and yellow as far as two go, the rest of one: Smits 1999,
    /// *An RGB-to-Spectrum Conversion for Reflectances*, with sigmoid spectra that have exactly these colors.
    pub fn filter<const N: usize>(&self, draw: &Draw<N>, [red, green, blue]: [f32; 3]) -> Lanes<N> {
        let tint = |number: usize, amount: f32| draw.read(&self.0[number]) * amount;
        let least = red.min(green).min(blue);
        let white = Lanes::ONE * least;
        let (two, one) = if least == red {
            if green < blue { ((3, green - red), (2, blue - green)) } else { ((3, blue - red), (1, green - blue)) }
        } else if least == green {
            if red < blue { ((4, red - green), (2, blue - red)) } else { ((4, blue - green), (0, red - blue)) }
        } else if red < green {
            ((5, red - blue), (1, green - red))
        } else {
            ((5, green - blue), (0, red - green))
        };
        let mut filter = white;
        for (number, amount) in [two, one] {
            if amount > 0.0 {
                filter += tint(number, amount);
            }
        }
        filter
    }
}
