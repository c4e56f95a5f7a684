//! The simple pendulum: a point mass on a massless rod, with linear friction (3.2).

use crate::joint::{Chain, Friction, Link, Motor, Real};

/// `theta'' + B/(M L^2) theta' + (g/L) sin(theta) = tau/(M L^2)` (3.2), theta being the angle from where it hangs.
///
/// A free swing shows the two ratios only; `ml2` matters where a motor acts, and may be anything otherwise.
#[derive(Clone, Copy, Debug)]
pub struct SimplePendulum<T> {
    /// `M L^2` \[kg m^2\]
    pub ml2_kg_m2: T,
    /// `B/(M L^2)` \[1/s\]; the thesis prints its unit as N s/(kg m^2).
    pub b_over_ml2_1_s: T,
    /// `g/L` \[1/s^2\]
    pub g_over_l_1_s2: T,
    /// Joint angle at which it hangs \[rad\].
    pub rest_rad: T,
}

impl<T: Real> SimplePendulum<T> {
    /// The pendulum as a joint chain.
    pub fn chain(&self, motor: Option<Motor<T>>) -> Chain<T> {
        Chain::new(
            // Any gravity will do: only g M L = (g/L) M L^2 enters.
            Link::new(self.ml2_kg_m2, self.g_over_l_1_s2 * self.ml2_kg_m2, self.rest_rad, 1.0),
            Friction::coulomb_viscous(T::nought(), self.b_over_ml2_1_s * self.ml2_kg_m2),
            motor,
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pendulum::{Input, Start, rollout};

    #[test]
    fn table_3_1_q1_decays_and_swings_as_its_ratios_say() {
        let pendulum = SimplePendulum { ml2_kg_m2: 1.0, b_over_ml2_1_s: 1.975, g_over_l_1_s2: 60.0, rest_rad: -0.1 };
        let t: Vec<f64> = (0..500).map(|k| k as f64 * 0.008).collect();
        let start = Start { angle_rad: -0.1 + 0.02, rate_rad_s: 0.0, release_s: None };
        let damped = (60.0f64 - (1.975f64 / 2.0).powi(2)).sqrt();
        rollout(&pendulum.chain(None), Input::Off, &t, start, |k, s| {
            let phase = damped * t[k];
            let envelope = 0.02 * (-0.5 * 1.975 * t[k]).exp();
            let exact = -0.1 + envelope * (phase.cos() + 0.5 * 1.975 / damped * phase.sin());
            // The sine of 0.02 rad is short of it by 1.3e-6 rad.
            assert!((s.angle_rad - exact).abs() < 2e-5, "{k}");
        })
        .expect("does not diverge");
    }
}
