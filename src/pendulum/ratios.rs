//! Which mass and friction follow from two fitted ratios of the simple pendulum (3.2-3.6)?
//!
//! The simple pendulum `q'' + B/(M L^2) q' + (g/L) sin(q) = 0` (3.2) shows only two ratios. Swinging twice with known
//! extra masses `M_1`, `M_2` at the same `L` gives `V_1 = B/((M + M_1) L^2)` (3.3) and `V_2 = B/((M + M_2) L^2)`
//! (3.4), hence `M` (3.5) and `B` (3.6).
//!
//! The mass is a small difference of large numbers: with Table 3.1's ratios for q1, 1 % in `V_2` moves it by 7 g of 55
//! g, which is why the thesis found negative masses and turned to the extensive model.
//!
//! Table 3.1 prints `B` in "Ns/m" and `B/(M L^2)` in "Ns/kgm^2"; with (3.2) they are N m s/rad and 1/s, as here.

/// Why two ratios give no mass.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RatioError {
    /// `V_1 = V_2`: the extra mass changed nothing, so (3.5) and (3.6) divide by zero.
    #[error("both tests have the damping ratio {ratio_per_s} 1/s; the mass (3.5) and friction (3.6) are undetermined")]
    EqualRatios {
        /// The common value of B/(M L^2).
        ratio_per_s: f64,
    },
    /// A number that no swing has.
    #[error("{what} = {value}, allowed: {allowed}")]
    Value {
        /// What it is, with its unit.
        what: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        allowed: &'static str,
    },
}

/// One test of Table 3.1: a known extra mass and the two fitted ratios of (3.2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RatioTest {
    /// Extra mass on the lower leg, `M_1` or `M_2`; 0 for a bare swing \[kg\].
    pub extra_mass_kg: f64,
    /// `V = B/((M + M_i) L^2)` \[1/s\].
    pub damping_per_s: f64,
    /// `g/L` \[1/s^2\].
    pub stiffness_per_s2: f64,
}

/// The last two columns of Table 3.1, and the length they rest on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SimpleEstimate {
    /// `M` by (3.5) \[kg\]; may be negative, see the module.
    pub mass_kg: f64,
    /// `B` by (3.6) \[N m s/rad\].
    pub friction_nm_s_rad: f64,
    /// `L` \[m\].
    pub length_m: f64,
}

impl SimpleEstimate {
    /// Mass, friction and length from two tests of the same joint (3.5, 3.6), `L` from the mean of the two `g/L`.
    ///
    /// Equations 3.3 and 3.4 assume the same `L` in both tests; where the two fitted `g/L` differ, so does the model
    /// from the joint.
    ///
    /// ```
    /// use aibo_fit::pendulum::{RatioTest, SimpleEstimate};
    /// let test = |extra_mass_kg, damping_per_s| RatioTest { extra_mass_kg, damping_per_s, stiffness_per_s2: 60.0 };
    /// let q1 = SimpleEstimate::from_tests(&test(0.220, 3.283), &test(0.402, 1.975), 9.81)?;
    /// assert!((q1.friction_nm_s_rad - 0.024).abs() < 0.0005); // Table 3.1
    /// # Ok::<(), aibo_fit::pendulum::RatioError>(())
    /// ```
    ///
    /// # Errors
    /// [`RatioError::EqualRatios`]; [`RatioError::Value`] for a ratio, mass or gravity that is not finite or, for
    /// `g/L` and gravity, not above zero.
    pub fn from_tests(first: &RatioTest, second: &RatioTest, gravity_m_s2: f64) -> Result<Self, RatioError> {
        let mean_per_s2 = 0.5 * (first.stiffness_per_s2 + second.stiffness_per_s2);
        let length_m = length_from_stiffness(gravity_m_s2, mean_per_s2)?;
        Ok(SimpleEstimate {
            mass_kg: mass_from_ratios(first, second)?,
            friction_nm_s_rad: friction_from_ratios(first, second, length_m)?,
            length_m,
        })
    }
}

/// Length of the simple pendulum from its fitted `g/L` (3.2) \[m\].
///
/// # Errors
/// [`RatioError::Value`] where either is not finite and above zero.
pub fn length_from_stiffness(gravity_m_s2: f64, stiffness_per_s2: f64) -> Result<f64, RatioError> {
    positive("gravity [m/s^2]", gravity_m_s2)?;
    positive("g/L [1/s^2]", stiffness_per_s2)?;
    Ok(gravity_m_s2 / stiffness_per_s2)
}

/// Mass of the pendulum itself (3.5): `M = (M_1 V_1 - M_2 V_2) / (V_2 - V_1)` \[kg\].
///
/// # Errors
/// [`RatioError::EqualRatios`], [`RatioError::Value`].
pub fn mass_from_ratios(first: &RatioTest, second: &RatioTest) -> Result<f64, RatioError> {
    let (m_1, v_1, m_2, v_2) = checked(first, second)?;
    Ok((m_1 * v_1 - v_2 * m_2) / (v_2 - v_1))
}

/// Friction of the joint (3.6): `B = V_1 V_2 L^2 (M_2 - M_1) / (V_1 - V_2)` \[N m s/rad\].
///
/// # Errors
/// [`RatioError::EqualRatios`], [`RatioError::Value`].
pub fn friction_from_ratios(first: &RatioTest, second: &RatioTest, length_m: f64) -> Result<f64, RatioError> {
    let (m_1, v_1, m_2, v_2) = checked(first, second)?;
    positive("L [m]", length_m)?;
    Ok(v_1 * length_m * length_m * v_2 * (m_2 - m_1) / (v_1 - v_2))
}

fn checked(first: &RatioTest, second: &RatioTest) -> Result<(f64, f64, f64, f64), RatioError> {
    for test in [first, second] {
        finite("extra mass [kg]", test.extra_mass_kg)?;
        finite("B/(M L^2) [1/s]", test.damping_per_s)?;
    }
    if first.damping_per_s == second.damping_per_s {
        return Err(RatioError::EqualRatios { ratio_per_s: first.damping_per_s });
    }
    Ok((first.extra_mass_kg, first.damping_per_s, second.extra_mass_kg, second.damping_per_s))
}

fn positive(what: &'static str, value: f64) -> Result<(), RatioError> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(RatioError::Value { what, value, allowed: "a finite number above 0" })
}

fn finite(what: &'static str, value: f64) -> Result<(), RatioError> {
    if value.is_finite() { Ok(()) } else { Err(RatioError::Value { what, value, allowed: "a finite number" }) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    /// A row of Table 3.1: `V_1`, `V_2`, `g/L`, printed mass and friction. Extra masses are 0.220 and 0.402 kg in all.
    struct Row {
        joint: &'static str,
        v_1: f64,
        v_2: f64,
        g_over_l: f64,
        mass_kg: f64,
        friction: f64,
    }

    const TABLE_3_1: [Row; 3] = [
        Row { joint: "q1", v_1: 3.283, v_2: 1.975, g_over_l: 60.0, mass_kg: 0.056, friction: 0.024 },
        Row { joint: "q2", v_1: 4.005, v_2: 2.135, g_over_l: 60.0, mass_kg: -0.012, friction: 0.022 },
        Row { joint: "q3", v_1: 8.387, v_2: 4.058, g_over_l: 75.0, mass_kg: -0.049, friction: 0.025 },
    ];

    /// Half a unit of the last printed digit of V, of the masses and frictions, and of g/L.
    const HALF_V: f64 = 0.0005;
    const HALF_PRINT: f64 = 0.0005;
    const HALF_G_OVER_L: f64 = 0.5;
    /// Half a gram, if the extra masses were themselves rounded to grams.
    const HALF_GRAM: f64 = 0.0005;

    /// How far the inputs of a row may be from their print, each on its own.
    #[derive(Clone, Copy, Default)]
    struct Slack {
        v: f64,
        g_over_l: f64,
        mass_kg: f64,
    }

    /// Mass and friction at every corner of the printed inputs' rounding; both are monotonic in every input.
    fn intervals(row: &Row, slack: Slack) -> [(f64, f64); 2] {
        let mut all = [(f64::MAX, f64::MIN); 2];
        for corner in 0..32 {
            let side = |bit: u32| if corner >> bit & 1 == 1 { 1.0 } else { -1.0 };
            let test = |mass: f64, v: f64, bit: u32| RatioTest {
                extra_mass_kg: mass + slack.mass_kg * side(bit + 1),
                damping_per_s: v + slack.v * side(bit),
                stiffness_per_s2: row.g_over_l + slack.g_over_l * side(4),
            };
            let e = SimpleEstimate::from_tests(&test(0.220, row.v_1, 0), &test(0.402, row.v_2, 2), 9.81).unwrap();
            for (interval, value) in all.iter_mut().zip([e.mass_kg, e.friction_nm_s_rad]) {
                *interval = (interval.0.min(value), interval.1.max(value));
            }
        }
        all
    }

    /// Does some value of the interval round to the printed one?
    fn reaches((low, high): (f64, f64), printed: f64) -> bool {
        low <= printed + HALF_PRINT && high >= printed - HALF_PRINT
    }

    #[test]
    fn table_3_1_mass_within_rounding_except_q1() {
        for row in &TABLE_3_1 {
            let [mass, _] = intervals(row, Slack { v: HALF_V, ..Slack::default() });
            assert_eq!(reaches(mass, row.mass_kg), row.joint != "q1", "{}: {mass:?}", row.joint);
        }
    }

    #[test]
    fn table_3_1_q1_mass_is_0_0548_by_its_own_ratios() {
        let row = &TABLE_3_1[0];
        let [exact, _] = intervals(row, Slack::default());
        assert_relative_eq!(exact.0, 0.0548, epsilon = 0.5e-4);
        let [mass, _] = intervals(row, Slack { v: HALF_V, ..Slack::default() });
        assert_relative_eq!(mass.0, 0.0545, epsilon = 0.5e-4);
        assert_relative_eq!(mass.1, 0.0551, epsilon = 0.5e-4);
        // With extra masses that are themselves only good to half a gram the printed 0.056 would be within reach.
        let [mass, _] = intervals(row, Slack { v: HALF_V, mass_kg: HALF_GRAM, ..Slack::default() });
        assert!(reaches(mass, row.mass_kg), "{mass:?}");
    }

    #[test]
    fn table_3_1_friction_within_rounding() {
        for row in &TABLE_3_1 {
            let [_, friction] = intervals(row, Slack { v: HALF_V, g_over_l: HALF_G_OVER_L, ..Slack::default() });
            assert!(reaches(friction, row.friction), "{}: {friction:?}", row.joint);
        }
    }

    #[test]
    fn table_3_1_q3_friction_needs_a_rounded_g_over_l() {
        for row in &TABLE_3_1 {
            let [_, friction] = intervals(row, Slack { v: HALF_V, ..Slack::default() });
            assert_eq!(reaches(friction, row.friction), row.joint != "q3", "{}: {friction:?}", row.joint);
        }
        let [_, exact] = intervals(&TABLE_3_1[2], Slack::default());
        assert_relative_eq!(exact.0, 0.0245, epsilon = 0.5e-4);
    }

    #[test]
    fn figure_3_3_mass_is_positive_in_a_narrow_region_only() {
        // With M_1 < M_2 and V_1 > V_2, (3.5) is positive just where V_2 / V_1 > M_1 / M_2 = 0.547; the rows of Table
        // 3.1 lie at 0.602 (q1), 0.533 (q2) and 0.484 (q3).
        let mass = |v_1: f64, v_2: f64| {
            let test =
                |extra_mass_kg, damping_per_s| RatioTest { extra_mass_kg, damping_per_s, stiffness_per_s2: 60.0 };
            mass_from_ratios(&test(0.220, v_1), &test(0.402, v_2)).unwrap()
        };
        for v_1 in [2.0, 4.0, 8.0] {
            for percent in (5..100).step_by(5) {
                let share = f64::from(percent) / 100.0;
                assert_eq!(mass(v_1, share * v_1) > 0.0, share > 0.220 / 0.402, "V_1 {v_1}, V_2/V_1 {share}");
            }
        }
        // Sensitive: 1 % in V_2 of q1 is 7 g, 1 % in V_1 the same the other way.
        assert_relative_eq!(mass(3.283, 1.975 * 1.01) - mass(3.283, 1.975), 0.007, epsilon = 0.5e-3);
    }

    #[test]
    fn equal_or_unusable_numbers_are_refused() {
        let test = |extra_mass_kg, damping_per_s, stiffness_per_s2| RatioTest {
            extra_mass_kg,
            damping_per_s,
            stiffness_per_s2,
        };
        let e = SimpleEstimate::from_tests(&test(0.2, 3.0, 60.0), &test(0.4, 3.0, 60.0), 9.81);
        assert_eq!(e, Err(RatioError::EqualRatios { ratio_per_s: 3.0 }));
        assert!(SimpleEstimate::from_tests(&test(0.2, f64::NAN, 60.0), &test(0.4, 3.0, 60.0), 9.81).is_err());
        assert!(SimpleEstimate::from_tests(&test(0.2, 2.0, -60.0), &test(0.4, 3.0, 20.0), 9.81).is_err());
        assert!(length_from_stiffness(9.81, 0.0).is_err());
        assert!(friction_from_ratios(&test(0.2, 2.0, 1.0), &test(0.4, 3.0, 1.0), -1.0).is_err());
    }

    proptest! {
        /// (3.5) and (3.6) invert (3.3) and (3.4).
        #[test]
        fn mass_and_friction_come_back(
            m in 0.01..1.0f64, b in 0.001..0.1f64, l in 0.05..0.5f64, m_1 in 0.0..0.3f64, more in 0.05..0.5f64,
        ) {
            let test = |extra: f64| RatioTest {
                extra_mass_kg: extra, damping_per_s: b / ((m + extra) * l * l), stiffness_per_s2: 9.81 / l,
            };
            let e = SimpleEstimate::from_tests(&test(m_1), &test(m_1 + more), 9.81).unwrap();
            prop_assert!((e.mass_kg - m).abs() < 1e-9 && (e.friction_nm_s_rad - b).abs() < 1e-9
                && (e.length_m - l).abs() < 1e-12);
        }
    }
}
