//! What can be said of one swing of the reference robot, whose other joints were held rigidly.

use super::{Cause, Compared, Swings};
use crate::identify::Case;
use crate::robot::bench::Held;
use std::path::Path;

fn case() -> Case {
    let log = Path::new(env!("CARGO_MANIFEST_DIR")).join("data/thesis-robot/q3-402g-0.csv");
    Case::of_logs(&[log], None).unwrap()
}

#[test]
fn every_cause_but_the_held_joints_frees_one_parameter() {
    let case = case();
    let swings = Swings::of(&case, 1).unwrap().unwrap();
    for cause in Cause::ALL {
        let freed = swings.parameters.iter().filter(|p| cause.frees(&p.name)).count();
        assert_eq!(freed, usize::from(cause != Cause::HeldJoints), "{cause:?}");
    }
}

#[test]
fn a_log_is_fitted_until_a_little_after_it_has_come_to_rest() {
    let case = case();
    let swings = Swings::of(&case, 1).unwrap().unwrap();
    let (whole, swing) = (&case.items[0].experiments[0], &swings.fit[0]);
    assert!(swing.t_s.len() < whole.t_s.len() / 2);
    assert_eq!(swing.measured_rad[..], whole.measured_rad[..swing.t_s.len()]);
}

#[test]
fn one_swing_tells_rigid_neighbours_and_a_cause_never_leaves_more() {
    let case = case();
    let compared = Compared::of(&Swings::of(&case, 1).unwrap().unwrap(), true).unwrap();
    assert_eq!(compared.held(), Some(Held::Rigid), "{}", compared.gives_by);
    assert_eq!(compared.ranked.len(), Cause::ALL.len());
    // To the tolerance of a search.
    let no_more = |richer: f64, poorer: f64| richer < 1.01 * poorer;
    for ranked in compared.ranked.iter().filter(|ranked| ranked.cause != Cause::HeldJoints) {
        assert!(no_more(ranked.alone.rms_rad, compared.nominal.rms_rad), "{:?} alone", ranked.cause);
        assert!(no_more(compared.rigid.rms_rad, ranked.without.rms_rad), "without {:?}", ranked.cause);
    }
}
