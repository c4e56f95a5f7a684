//! Controller gains as OPEN-R takes them (2.7).

/// Shifts are those of a 16 bit word.
const WORD_BITS: i32 = 16;

/// `gain = g / 2^(16 - s)` (eq. 2.7), from the integer `g` and the shift `s`; exact in an `f64`.
///
/// ```
/// assert_eq!(aibo_fit::joint::gain(20, 14), 5.0); // Table B.2, P gain of q1
/// ```
pub fn gain(g: u16, shift: u8) -> f64 {
    f64::from(g) * 2f64.powi(i32::from(shift) - WORD_BITS)
}

/// A gain that the controller cannot have.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error(
    "gain {gain} is not g / 2^(16 - {shift}) for an integer g from 0 to 65535; the nearest that is, is {nearest} \
     (g = {nearest_g})"
)]
pub struct Unrepresentable {
    /// The gain that was asked for.
    pub gain: f64,
    /// The shift in force.
    pub shift: u8,
    /// The nearest gain that can be had.
    pub nearest: f64,
    /// Its integer.
    pub nearest_g: u16,
}

/// The integer `g` of a gain (eq. 2.7 the other way round).
///
/// # Errors
/// [`Unrepresentable`] where no integer gives exactly this gain at this shift.
pub fn gain_word(value: f64, shift: u8) -> Result<u16, Unrepresentable> {
    let g = value / gain(1, shift);
    // A cast saturates, and takes NaN to 0.
    let nearest_g = g.round() as u16;
    let nearest = gain(nearest_g, shift);
    if nearest == value { Ok(nearest_g) } else { Err(Unrepresentable { gain: value, shift, nearest, nearest_g }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_comes_back() {
        for shift in 0..=16 {
            for g in [0, 1, 4, 28, 255, 65535] {
                assert_eq!(gain_word(gain(g, shift), shift), Ok(g));
            }
        }
    }

    #[test]
    fn gains_between_the_steps_are_refused_with_the_nearest() {
        assert_eq!(gain_word(0.3, 15), Err(Unrepresentable { gain: 0.3, shift: 15, nearest: 0.5, nearest_g: 1 }));
        assert!(gain_word(5.1, 14).unwrap_err().to_string().contains("is 5 (g = 20)"));
        assert!(gain_word(-1.0, 14).is_err() && gain_word(f64::NAN, 14).is_err() && gain_word(1e9, 14).is_err());
    }
}
