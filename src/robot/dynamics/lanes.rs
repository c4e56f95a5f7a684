//! Forward dynamics of many robots, several in the lanes of each register.

use super::articulated::{Added, BaseWork, go_inward, go_onward, go_outward, turn};
use super::base::Carried;
use super::layout::{Abreast, Layout, rows};
use super::slot::Slot;
use super::{Dynamics, Input};
use crate::robot::model::BASE_FREEDOMS;
use crate::robot::spatial::Number;
use crate::robot::{Model, State};

/// Working memory for forward dynamics of many robots of one model at once; no evaluation allocates.
///
/// A register of the processor holds a number of several robots, [`LanesDynamics::ROBOTS`], and one operation works on all
/// of them: four in a build for AVX2 (`RUSTFLAGS="-C target-cpu=x86-64-v3"`), two elsewhere. Each robot's accelerations are
/// bit for bit those of [`Dynamics::forward`] (where they are numbers at all), in any build and whatever the other robots do.
///
/// ```
/// use aibo_fit::robot::{Dynamics, Input, LanesDynamics, Model, State};
/// let robot = Model::ers7();
/// let mut states = vec![State::at_rest(robot); 5];
/// states[3].angle_rad[0] = 0.5;
/// let inputs = vec![Input::torques(&[0.01; 22]); 5];
/// let mut accelerations = vec![0.0; 5 * 28];
/// LanesDynamics::new(robot).forward(&states, &inputs, &mut accelerations);
///
/// let mut alone = [0.0; 28];
/// Dynamics::new(robot).forward(&states[3], &inputs[3], &mut alone);
/// assert_eq!(accelerations[3 * 28..4 * 28], alone);
/// ```
#[derive(Clone, Debug)]
pub struct LanesDynamics<'m> {
    slots: Vec<Slot<<Abreast as Layout>::Number>>,
    /// For inputs without diagonal terms beside those with.
    zeros: Vec<f64>,
    /// For robots that are left over, and for those that forces push.
    alone: Dynamics<'m>,
}

impl<'m> LanesDynamics<'m> {
    /// How many robots go side by side; any number of them can be asked for.
    pub const ROBOTS: usize = <<Abreast as Layout>::Single as Number>::LANES;

    /// Memory for a model.
    pub fn new(model: &'m Model) -> Self {
        Self {
            slots: vec![Slot::new(); Abreast::PARTS * model.plan().groups.len()],
            zeros: vec![0.0; model.joints().len()],
            alone: Dynamics::new(model),
        }
    }

    /// The model.
    pub fn model(&self) -> &'m Model {
        self.alone.model()
    }

    /// Forward dynamics of each robot: the accelerations `dv/dt` \[m/s^2, rad/s^2\] that torques, forces and gravity give,
    /// those of one robot (6 + joints) after those of another, as [`Dynamics::forward`] has them.
    ///
    /// Fastest where the number of robots is a multiple of [`LanesDynamics::ROBOTS`] and no input has forces on bodies: of
    /// robots side by side, forces on one make that each is worked on alone.
    ///
    /// # Panics
    /// Where there are not as many inputs as states, or a slice has not the model's length.
    pub fn forward(&mut self, states: &[State], inputs: &[Input<'_>], accelerations: &mut [f64]) {
        let freedoms = self.alone.freedoms();
        assert!(inputs.len() == states.len(), "{} inputs for {} states", inputs.len(), states.len());
        self.alone.check("accelerations", accelerations.len(), freedoms * states.len());
        let several = states.chunks(Self::ROBOTS).zip(inputs.chunks(Self::ROBOTS));
        for ((states, inputs), out) in several.zip(accelerations.chunks_mut(Self::ROBOTS * freedoms)) {
            if states.len() == 1 || inputs.iter().any(|input| !input.forces.is_empty()) {
                for ((state, input), out) in states.iter().zip(inputs).zip(out.chunks_exact_mut(freedoms)) {
                    self.alone.forward(state, input, out);
                }
            } else {
                self.abreast(states, inputs, out);
            }
        }
    }

    /// As many robots as go side by side, or fewer.
    fn abreast(&mut self, states: &[State], inputs: &[Input<'_>], out: &mut [f64]) {
        let (model, freedoms) = (self.alone.model(), self.alone.freedoms());
        for (state, input) in states.iter().zip(inputs) {
            self.alone.check_state(state);
            self.alone.check_input(input);
        }
        let (plan, joints) = (model.plan(), freedoms - BASE_FREEDOMS);
        // Lanes that are left over repeat the last robot.
        let last = states.len() - 1;
        let state = |robot: usize| &states[robot.min(last)];
        let input = |robot: usize| &inputs[robot.min(last)];
        turn::<Abreast>(plan, &mut self.slots, &rows(joints, |robot| &state(robot).angle_rad));
        let carried = Carried::of(model, state);
        let mut base = BaseWork::<Abreast>::new(&plan.base, &carried);
        go_outward(plan, &mut self.slots, &base, &rows(joints, |robot| &state(robot).rate_rad_s), false);
        let zeros = self.zeros.as_slice();
        let diagonal = |robot| Some(input(robot).diagonal_kg_m2).filter(|terms| !terms.is_empty()).unwrap_or(zeros);
        let has_diagonal = inputs.iter().any(|input| !input.diagonal_kg_m2.is_empty());
        let added = Added {
            torque_nm: rows(joints, |robot| input(robot).torque_nm),
            diagonal_kg_m2: has_diagonal.then(|| rows(joints, diagonal)),
            rotors: &plan.armature_kg_m2,
        };
        go_inward(plan, &mut self.slots, &mut base, &added);
        base.accelerate(model.base(), &carried, out, freedoms);
        go_onward(plan, &mut self.slots, &base, out, freedoms);
    }
}
