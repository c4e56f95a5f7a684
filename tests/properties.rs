//! What holds for any robot: trees that are drawn, with friction, from any start.

use aibo_fit::log::Hold;
use aibo_fit::robot::simulate::{Joints, Method, Recording, Scenario, Setpoints, run};
use aibo_fit::robot::{Dynamics, Model, State};
use proptest::prelude::*;
use std::fmt::Write;
use std::path::Path;

/// One part of a tree and the joint that it hangs on.
#[derive(Clone, Debug)]
struct Limb {
    /// Which of the parts before it carries it, as a share of them.
    parent: f64,
    axis: [f64; 3],
    length_m: f64,
    mass_kg: f64,
    coulomb_nm: f64,
    viscous_nm_s_rad: f64,
    angle_rad: f64,
    rate_rad_s: f64,
}

fn limb() -> impl Strategy<Value = Limb> {
    let axis =
        [-1.0..1.0f64, -1.0..1.0, -1.0..1.0].prop_filter("an axis", |a| a.iter().map(|x| x * x).sum::<f64>() > 0.1);
    let body = (0.05..0.3f64, 0.05..1.0f64);
    (0.0..1.0f64, axis, body, (0.0..0.05f64, 0.002..0.05f64), (-2.0..2.0f64, -3.0..3.0f64)).prop_map(
        |(parent, axis, (length_m, mass_kg), (coulomb_nm, viscous_nm_s_rad), (angle_rad, rate_rad_s))| Limb {
            parent,
            axis,
            length_m,
            mass_kg,
            coulomb_nm,
            viscous_nm_s_rad,
            angle_rad,
            rate_rad_s,
        },
    )
}

/// A robot file of a tree on a clamped foot.
fn model(limbs: &[Limb]) -> Model {
    let mut text = "schema = 1\nname = \"tree\"\nroot = \"p0\"\nbase = \"clamped\"\n\
        [[part]]\nname = \"p0\"\ndiameter_m = [0.1, 0.1, 0.1]\nmass_kg = 1.0\n"
        .to_owned();
    let number = |part: usize| format!("p{part}");
    for (k, limb) in limbs.iter().enumerate() {
        let (half_mm, d) = (500.0 * limb.length_m, 0.3 * limb.length_m);
        let parent = (limb.parent * (k + 1) as f64) as usize;
        let end_mm = if parent == 0 { 50.0 } else { 500.0 * limbs[parent - 1].length_m };
        let norm = limb.axis.iter().map(|x| x * x).sum::<f64>().sqrt();
        let axis = limb.axis.map(|x| x / norm);
        write!(
            text,
            "[[part]]\nname = \"{0}\"\ndiameter_m = [{d}, {1}, {d}]\nmass_kg = {2}\n[[joint]]\nname = \"j{3}\"\nparent = \"{4}\"\n\
            child = \"{0}\"\naxis = {axis:?}\nparent_mm = [0.0, {end_mm:?}, 0.0]\nchild_mm = [0.0, -{half_mm:?}, 0.0]\n",
            number(k + 1),
            limb.length_m,
            limb.mass_kg,
            k + 1,
            number(parent),
        )
        .expect("a text grows");
    }
    let list = |of: &dyn Fn(&Limb) -> f64| limbs.iter().map(of).collect::<Vec<_>>();
    let names: Vec<String> = (1..=limbs.len()).map(|k| format!("j{k}")).collect();
    write!(
        text,
        "[friction.drawn]\njoints = {names:?}\ncoulomb_nm = {:?}\nviscous_nm_s_rad = {:?}\n",
        list(&|limb| limb.coulomb_nm),
        list(&|limb| limb.viscous_nm_s_rad)
    )
    .expect("a text grows");
    Model::from_toml(Path::new("tree.toml"), &text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Lets the tree go for so long; what came of it.
fn let_go(model: &Model, limbs: &[Limb], step_s: f64, lasts_s: f64) -> Recording {
    let mut joints = Joints::passive(model);
    joints.set_friction(model, "drawn").expect("it is in the file");
    let mut start = State::at_rest(model);
    for (k, limb) in limbs.iter().enumerate() {
        (start.angle_rad[k], start.rate_rad_s[k]) = (limb.angle_rad, limb.rate_rad_s);
    }
    let setpoints = Setpoints { t_s: vec![0.0, lasts_s], columns: vec![None; limbs.len()], hold: Hold::Step };
    let scenario =
        Scenario { model, joints: &joints, setpoints: &setpoints, start: &start, surroundings: None, period_s: 0.01 };
    run(&scenario, Method::Stiff { step_s }).expect("a scenario")
}

/// Energy at each sample, and the unit that errors are measured in: what moves at the start and what could fall.
fn energies(model: &Model, limbs: &[Limb], recording: &Recording) -> (Vec<f64>, f64) {
    let mut dynamics = Dynamics::new(model);
    let mut state = State::at_rest(model);
    let mut at = |k: usize| {
        for j in 0..limbs.len() {
            (state.angle_rad[j], state.rate_rad_s[j]) = (recording.angle_rad[j][k], recording.rate_rad_s[j][k]);
        }
        dynamics.energy(&state)
    };
    let first = at(0);
    let falls_j: f64 = limbs.iter().map(|limb| 9.81 * limb.mass_kg * limb.length_m).sum::<f64>() * limbs.len() as f64;
    ((0..recording.t_s.len()).map(|k| at(k).total_j()).collect(), first.kinetic_j + falls_j)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 40, ..ProptestConfig::default() })]

    /// The stiff method is of second order: what a step of 5e-4 s adds stays below a thousandth of what is there.
    #[test]
    fn energy_never_grows_without_drive(limbs in prop::collection::vec(limb(), 1..6)) {
        let model = model(&limbs);
        let recording = let_go(&model, &limbs, 5e-4, 1.5);
        prop_assert!(recording.diverged.is_none(), "{:?}", recording.diverged);
        let (energy_j, unit_j) = energies(&model, &limbs, &recording);
        let mut least = f64::INFINITY;
        for (k, energy) in energy_j.iter().enumerate() {
            prop_assert!(*energy <= least + 1e-3 * unit_j, "t = {}: {energy} after {least} of {unit_j} J", recording.t_s[k]);
            least = least.min(*energy);
        }
    }

    /// Half the step, a quarter of the change: within two milliradians for a fifth of a second, before chaos has its say.
    #[test]
    fn half_the_step_changes_nothing_beyond_the_tolerance(limbs in prop::collection::vec(limb(), 1..5)) {
        let model = model(&limbs);
        let [coarse, fine] = [5e-4, 2.5e-4].map(|step_s| let_go(&model, &limbs, step_s, 0.2));
        for j in 0..limbs.len() {
            for (k, (a, b)) in coarse.angle_rad[j].iter().zip(&fine.angle_rad[j]).enumerate() {
                prop_assert!((a - b).abs() < 2e-3, "joint {j}, t = {}: {a} and {b} rad", coarse.t_s[k]);
            }
        }
    }
}
