//! What a hypothesis leaves with the uncertain numbers adapted; clamped, the robot is simulated with them.
//!
//! To first order many a motion can be imitated by numbers that are off; in a drop, which amplifies them, no robot with
//! such numbers does it.

/// What a hypothesis leaves with its numbers.
#[derive(Clone, Debug)]
pub(super) struct Attained {
    /// The weighed sum of squares over the samples that fits see, the price of the numbers included.
    pub price: f64,
    /// Measured less simulated, what the sensors have in common taken out \[rad\].
    pub residual: Vec<f64>,
    /// How far the uncertain numbers are off, in their standard deviations.
    pub sizes: Vec<f64>,
    /// What the sensors have in common, in units of its standard deviation.
    pub offset: f64,
}

impl Attained {
    /// The weighed sum of squares without the price of the numbers.
    pub fn misfit(&self) -> f64 {
        self.price - self.sizes.iter().map(|size| size.powi(2)).sum::<f64>()
    }
}

/// A number that had to move by more of its standard deviations is not as the study believes.
pub(super) const BELIEVED_SD: f64 = 3.0;
/// One that moved by so many of them may be another where its joint's gap shows it.
pub(super) const MOVED_SD: f64 = 1.5;

/// From how many of its standard deviations on a number counts as another than believed, where the farthest one moved so
/// many: beside a number that is not as believed those that may be are not told.
pub(super) fn counts_from_sd(farthest_sd: f64) -> f64 {
    if farthest_sd.abs() > BELIEVED_SD { BELIEVED_SD } else { MOVED_SD }
}
