use crate::trace::{Estimate, FIRST_LOOK, Noise, RareLight, Stopped};

/// The error of an image, measured by a render with a stop rule.
///
/// Errors are relative: the root mean square over all pixels and the three film channels, divided by that of the image.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct ImageError {
    /// The requested error, if any.
    pub requested: Option<f64>,
    /// The part that is due to chance.
    pub noise: Noise,
    /// The part that is due to gathered photons, which blur.
    pub blur: Estimate,
    /// The noise of alpha, relative to alpha, if shadow catchers cause any. The larger of this and the total error of
    /// the colors counts.
    pub alpha: Option<Estimate>,
    /// The light that makes an outlier of the noise, in a render that has ended.
    pub rare_light: Option<RareLight>,
    /// Whether some samples are aimed at small lights or highlights.
    pub has_highlights: bool,
    /// The error that the color model may cause, as the plan predicts: relative to the strongest channel of each color.
    pub model: f64,
    /// What ended the render, or none while it is running.
    pub stopped_by: Option<Stopped>,
}

impl ImageError {
    /// Returns a bound that the error stays below in 95 of 100 renders. It does not include light that no render of the
    /// plan finds, nor light so rare that none of it was found.
    ///
    /// The bound is at least the requested error if that was reached at a later look than the first: a render that ends
    /// as soon as the measured error is small enough tends to end when the measurement is too small. It is also at
    /// least the requested error if rare light was found, as there may be some that is rarer still, and if samples are
    /// aimed at highlights: of those, the few that just miss a light make most of the noise.
    pub fn at_most(&self) -> f64 {
        let alpha_bound = self.alpha.map_or(0.0, |alpha| alpha.at_most);
        let measured = self.noise.at_most.hypot(self.blur.at_most).hypot(self.model).max(alpha_bound);
        let is_doubtful = self.noise.samples > FIRST_LOOK || self.noise.outlier.is_some() || self.has_highlights;
        let is_chosen = self.stopped_by == Some(Stopped::Noise) && is_doubtful;
        self.requested.filter(|_| is_chosen).map_or(measured, |requested| measured.max(requested))
    }

    /// Returns whether the requested error was reached. True if none was requested.
    pub fn is_reached(&self) -> bool {
        self.requested.is_none_or(|requested| {
            self.stopped_by == Some(Stopped::Noise) && self.at_most() <= requested * (1.0 + 4.0 * f64::EPSILON)
        })
    }
}
