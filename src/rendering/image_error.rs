use crate::trace::{Estimate, FIRST_LOOK, Noise, RareLight, Stopped};

/// How far an image is off, as a render with a stop rule has measured it.
///
/// Errors are relative: the root of the mean square, over all pixels and the three film channels, by that of the image.
#[derive(Clone, Debug, PartialEq)]
pub struct ImageError {
    /// The error that was asked for, if one was.
    pub asked: Option<f64>,
    /// What chance makes of it.
    pub noise: Noise,
    /// What photons that are gathered make of it, which blur.
    pub blur: Estimate,
    /// The noise of alpha, relative to alpha, where shadow catchers make some: the larger of it and of all that colors
    /// are off counts.
    pub alpha: Option<Estimate>,
    /// The light that makes an outlier of the noise, of a render that has ended.
    pub rare_light: Option<RareLight>,
    /// What the model of color may make of it, as the plan predicts: relative to the strongest channel of each color.
    pub model: f64,
    /// What ended the render; none as long as it goes on.
    pub stopped_by: Option<Stopped>,
}

impl ImageError {
    /// The error is smaller than this in 95 of 100 renders, but for what no render of the plan finds, and for
    /// light so rare that none of it was met. Where the error that was asked for is reached at a later look than the
    /// first, it is that: a render that ends as soon as it measures so little ends rather where it measures too little.
    /// So it is where rare light was met, as there may be some that is rarer still.
    pub fn at_most(&self) -> f64 {
        let of_alpha = self.alpha.map_or(0.0, |alpha| alpha.at_most);
        let measured = self.noise.at_most.hypot(self.blur.at_most).hypot(self.model).max(of_alpha);
        let is_doubtful = self.noise.samples > FIRST_LOOK || self.noise.outlier.is_some();
        let is_chosen = self.stopped_by == Some(Stopped::Noise) && is_doubtful;
        self.asked.filter(|_| is_chosen).map_or(measured, |asked| measured.max(asked))
    }

    /// Whether the error that was asked for is reached; so it is where none was.
    pub fn is_reached(&self) -> bool {
        self.asked.is_none_or(|asked| {
            self.stopped_by == Some(Stopped::Noise) && self.at_most() <= asked * (1.0 + 4.0 * f64::EPSILON)
        })
    }
}
