//! What chapter 3 prints: Tables 3.1 to 3.4 and the two Coulomb frictions of section 3.3.2.

use crate::geometry::LegJoint;
use serde::{Deserialize, Deserializer};
use std::sync::OnceLock;

/// The printed numbers, embedded from `data/thesis-tables.toml`.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Printed {
    /// Half of the last printed digit of Table 3.1's columns.
    pub rounding: Rounding,
    /// One row for each joint.
    pub table_3_1: Vec<RatioRow>,
    /// One row for each body.
    pub table_3_2: Vec<MassRow>,
    /// One row for each joint.
    pub table_3_3: Vec<FrictionRow>,
    /// One row for each joint.
    pub table_3_4: Vec<FrictionRow>,
    /// What the text says of Coulomb friction with and without extra mass.
    pub section_3_3_2: CoulombByLoad,
}

/// Half of the last printed digit.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct Rounding {
    /// Of `B/ML^2` \[1/s\].
    pub b_over_ml2_1_s: f64,
    /// Of `g/L` \[1/s^2\].
    pub g_over_l_1_s2: f64,
    /// Of the mass \[kg\].
    pub mass_kg: f64,
    /// Of the friction \[N m s/rad\].
    pub friction_nm_s_rad: f64,
}

/// One row of Table 3.1.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct RatioRow {
    /// The joint.
    #[serde(deserialize_with = "joint")]
    pub joint: LegJoint,
    /// Extra masses of the two tests \[kg\].
    pub extra_mass_kg: [f64; 2],
    /// `B/ML^2` of the two tests \[1/s\].
    pub b_over_ml2_1_s: [f64; 2],
    /// `g/L` of the two tests \[1/s^2\].
    pub g_over_l_1_s2: [f64; 2],
    /// By (3.5) \[kg\].
    pub mass_kg: f64,
    /// By (3.6) \[N m s/rad\].
    pub friction_nm_s_rad: f64,
}

/// One row of Table 3.2.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct MassRow {
    /// `shoulder`, `upper leg` or `lower leg`.
    pub body: String,
    /// \[kg\]
    pub mass_kg: f64,
}

/// One row of Table 3.3 or 3.4.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct FrictionRow {
    /// The joint.
    #[serde(deserialize_with = "joint")]
    pub joint: LegJoint,
    /// `mu_c` \[N m\]
    pub coulomb_nm: f64,
    /// `mu_v` \[N m s/rad\]
    pub viscous_nm_s_rad: f64,
}

/// Coulomb friction about the shoulder by section 3.3.2.
#[derive(Clone, Copy, Debug, Deserialize, PartialEq)]
#[serde(deny_unknown_fields)]
pub struct CoulombByLoad {
    /// Without extra mass \[N m\].
    pub coulomb_bare_nm: f64,
    /// With extra mass \[N m\].
    pub coulomb_loaded_nm: f64,
}

fn joint<'de, D: Deserializer<'de>>(deserializer: D) -> Result<LegJoint, D::Error> {
    String::deserialize(deserializer)?.parse().map_err(serde::de::Error::custom)
}

impl Printed {
    /// The printed numbers.
    pub fn embedded() -> &'static Printed {
        static PRINTED: OnceLock<Printed> = OnceLock::new();
        PRINTED.get_or_init(|| {
            toml::from_str(include_str!("../../data/thesis-tables.toml"))
                .expect("data/thesis-tables.toml is compiled in and tested")
        })
    }

    /// Row of Table 3.1.
    pub fn ratios(&self, joint: LegJoint) -> Option<&RatioRow> {
        self.table_3_1.iter().find(|row| row.joint == joint)
    }

    /// Mass of Table 3.2 \[kg\].
    pub fn mass_kg(&self, body: &str) -> Option<f64> {
        self.table_3_2.iter().find(|row| row.body == body).map(|row| row.mass_kg)
    }

    /// Row of Table 3.3.
    pub fn estimated(&self, joint: LegJoint) -> Option<&FrictionRow> {
        self.table_3_3.iter().find(|row| row.joint == joint)
    }

    /// Row of Table 3.4.
    pub fn chosen(&self, joint: LegJoint) -> Option<&FrictionRow> {
        self.table_3_4.iter().find(|row| row.joint == joint)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Ers7Tables;

    #[test]
    fn printed_tables_are_those_of_the_robot_file() {
        let (printed, robot) = (Printed::embedded(), Ers7Tables::embedded());
        for joint in LegJoint::ALL {
            for (row, set) in
                [(printed.estimated(joint), &robot.friction.estimated), (printed.chosen(joint), &robot.friction.chosen)]
            {
                let row = row.expect("every joint has a row");
                assert_eq!((row.coulomb_nm, row.viscous_nm_s_rad), set.of(joint));
            }
            assert!(printed.ratios(joint).is_some());
        }
        let masses = ["rf_shoulder", "rf_upper", "rf_lower"].map(|part| robot.part(part).expect("a part").mass_kg);
        assert_eq!(["shoulder", "upper leg", "lower leg"].map(|b| printed.mass_kg(b).expect("a row")), masses);
    }
}
