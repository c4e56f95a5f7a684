//! Robots side by side against each on its own, bit for bit.

use super::*;
use crate::robot::description::Description;

fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|x| x.to_bits()).collect()
}

/// Many robots of one model with all that each of them was given.
struct Given {
    states: Vec<State>,
    torque_nm: Vec<Vec<f64>>,
    diagonal_kg_m2: Vec<Vec<f64>>,
    forces: Vec<Vec<Force>>,
}

impl Given {
    fn new(dice: &mut Dice, model: &Model, robots: usize) -> Self {
        let n = model.joints().len();
        let some = |dice: &mut Dice, share: f64| dice.next() < 2.0 * share - 1.0;
        Self {
            states: (0..robots).map(|_| dice.state(model)).collect(),
            torque_nm: (0..robots).map(|_| dice.many(n, 0.5)).collect(),
            diagonal_kg_m2: (0..robots)
                .map(
                    |_| if some(dice, 0.5) { dice.many(n, 1e-3).iter().map(|x| x.abs()).collect() } else { Vec::new() },
                )
                .collect(),
            forces: (0..robots).map(|_| if some(dice, 0.1) { dice.forces(model) } else { Vec::new() }).collect(),
        }
    }

    fn inputs(&self) -> Vec<Input<'_>> {
        let of = |k: usize| Input {
            torque_nm: &self.torque_nm[k],
            diagonal_kg_m2: &self.diagonal_kg_m2[k],
            forces: &self.forces[k],
        };
        (0..self.states.len()).map(of).collect()
    }

    /// Each robot's numbers, on its own.
    fn alone(&self, model: &Model) -> Vec<f64> {
        self.states.iter().zip(self.inputs()).flat_map(|(state, input)| solve(model, state, &input)).collect()
    }
}

fn compare(dynamics: &mut LanesDynamics<'_>, given: &Given) {
    let alone = given.alone(dynamics.model());
    let mut out = vec![f64::NAN; alone.len()];
    dynamics.forward(&given.states, &given.inputs(), &mut out);
    assert_eq!(bits(&out), bits(&alone), "{out:?} {alone:?}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]
    /// Any robot or tree, any number of robots, with diagonal terms on some and forces on few.
    #[test]
    fn each_robot_as_on_its_own(seed in any::<u64>(), which in 0_usize..18, robots in 0_usize..10) {
        let mut dice = Dice(seed);
        let model = &super::robots().get(which).cloned().unwrap_or_else(|| random_tree(&mut dice));
        let mut dynamics = LanesDynamics::new(model);
        compare(&mut dynamics, &Given::new(&mut dice, model, robots));
        // The memory remembers nothing.
        compare(&mut dynamics, &Given::new(&mut dice, model, robots));
    }
}

/// Zeros keep their sign: at rest and unturned, much of a robot's acceleration is zero.
#[test]
fn robots_at_rest_as_on_their_own() {
    for model in robots() {
        let states = vec![State::at_rest(&model); 4];
        let n = model.joints().len();
        for torque_nm in [0.0, -0.0, 0.1] {
            let given = Given {
                states: states.clone(),
                torque_nm: vec![vec![torque_nm; n]; 4],
                diagonal_kg_m2: vec![Vec::new(); 4],
                forces: vec![Vec::new(); 4],
            };
            compare(&mut LanesDynamics::new(&model), &given);
        }
    }
}

/// A described robot of which some joints have a rotor, beside the coordinate axes and on a free base.
#[test]
fn a_described_robot_as_on_its_own() {
    let text = r#"<mujoco model="arm"><compiler angle="radian"/><worldbody><body name="stand"><freejoint/><geom size=".05"/>
        <body name="upper" pos="0 .1 .3" euler=".3 1.5 .2"><joint name="a" axis="1 2 -1" armature=".02"/>
            <geom type="capsule" fromto="0 0 0 .2 .1 0" size=".03"/>
            <body name="left" pos=".2 .1 0"><joint name="b" axis="0 0 3"/><geom type="box" size=".1 .02 .03"/></body>
            <body name="right" pos="-.2 .1 0"><joint name="c" axis="0 0 3" armature=".01"/><geom type="box" size=".1 .02 .03"/></body>
        </body></body></worldbody></mujoco>"#;
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("arm.xml");
    std::fs::write(&file, text).unwrap();
    let model = Model::of_description(&Description::read(&file).unwrap()).unwrap();
    assert_eq!(model.armature_kg_m2(), [0.02, 0.0, 0.01]);
    let mut dice = Dice(6);
    for robots in 1..10 {
        compare(&mut LanesDynamics::new(&model), &Given::new(&mut dice, &model, robots));
    }
}

/// A robot that has gone astray, or turned a joint too often for the quick sine, is no matter of the others'.
#[test]
fn a_robot_that_diverged_leaves_the_others_alone() {
    let model = Model::ers7();
    let mut given = Given::new(&mut Dice(8), model, 8);
    given.forces = vec![Vec::new(); 8];
    given.states[1].angle_rad[3] = 1e7;
    given.states[2].rate_rad_s[2] = f64::NAN;
    given.states[6].angle_rad[0] = f64::INFINITY;
    let alone = given.alone(model);
    let mut out = vec![0.0; alone.len()];
    LanesDynamics::new(model).forward(&given.states, &given.inputs(), &mut out);
    for (robot, (found, expected)) in out.chunks(28).zip(alone.chunks(28)).enumerate() {
        if [2, 6].contains(&robot) {
            assert!(found.iter().zip(expected).all(|(a, b)| a.is_finite() == b.is_finite()), "{found:?} {expected:?}");
        } else {
            assert_eq!(bits(found), bits(expected), "robot {robot}");
        }
    }
}

#[test]
#[should_panic(expected = "torques: 3 numbers for ers7, expected 22")]
fn torques_of_another_robot_are_refused() {
    let model = Model::ers7();
    let states = vec![State::at_rest(model); 2];
    let inputs = [Input::torques(&[0.0; 22]), Input::torques(&[0.0; 3])];
    LanesDynamics::new(model).forward(&states, &inputs, &mut [0.0; 56]);
}

#[test]
#[should_panic(expected = "1 inputs for 2 states")]
fn as_many_inputs_as_states() {
    let model = Model::ers7();
    let states = vec![State::at_rest(model); 2];
    LanesDynamics::new(model).forward(&states, &[Input::torques(&[0.0; 22])], &mut [0.0; 56]);
}
