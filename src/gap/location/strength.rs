//! How rough a torque the readings of a log ask for.

use super::smoother::Likelihood;

/// Sizes of the unknown torque that are tried, as shares of the torques that act on the joint.
const SIZES: [f64; 12] = [0.0025, 0.0063, 0.016, 0.04, 0.1, 0.25, 0.63, 1.6, 4.0, 10.0, 25.0, 63.0];
/// Where the search among them begins.
const MIDDLE: usize = 3;
/// A rougher torque is taken if its likelihood is worse by no more than a factor exp(3): bands err on the wide side.
const INDIFFERENT: f64 = 3.0;

/// The roughest size, up to `largest`, that is about as likely as the most likely one, and its likelihood.
pub(in crate::gap) fn roughest_that_readings_allow(ask: impl Fn(f64) -> Likelihood, largest: f64) -> (f64, Likelihood) {
    let roughest = SIZES.partition_point(|size| *size <= largest).saturating_sub(1);
    let mut known = [None; SIZES.len()];
    let mut ask = |i: usize| *known[i].get_or_insert_with(|| ask(SIZES[i]));
    let mut best = MIDDLE.min(roughest);
    for direction in [-1, 1] {
        while let Some(next) = best.checked_add_signed(direction).filter(|i| *i <= roughest) {
            if ask(next).log <= ask(best).log {
                break;
            }
            best = next;
        }
    }
    let least = ask(best).log - INDIFFERENT;
    while best < roughest && ask(best + 1).log >= least {
        best += 1;
    }
    (SIZES[best], ask(best))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A likelihood with its top at a size; `steep` is what a factor e off costs.
    fn top_at(size: f64, steep: f64) -> impl Fn(f64) -> Likelihood {
        move |s: f64| Likelihood { log: -steep * (s / size).ln().powi(2), scale: 1.0 }
    }

    #[test]
    fn a_sharp_top_is_found_and_of_a_flat_one_the_rough_side() {
        for size in SIZES {
            assert_eq!(roughest_that_readings_allow(top_at(size, 50.0), f64::INFINITY).0, size);
        }
        assert_eq!(roughest_that_readings_allow(top_at(0.04, 1.0), f64::INFINITY).0, 0.1);
    }

    #[test]
    fn nothing_rougher_than_what_is_resolved() {
        assert_eq!(roughest_that_readings_allow(top_at(10.0, 50.0), 0.7).0, 0.63);
        assert_eq!(roughest_that_readings_allow(top_at(10.0, 50.0), 0.0).0, SIZES[0]);
        assert_eq!(roughest_that_readings_allow(|_| Likelihood { log: f64::NAN, scale: 1.0 }, 1e9).0, SIZES[11]);
    }
}
