//! What every joint carries along the measured motion of all of them, by inverse dynamics.

use super::followed::{Followed, SimulatedMotion};
use crate::joint::{Carriage, Carried};
use crate::log::{Nominal, RobotLog};
use crate::number::math;
use crate::robot::description::{Description, JointKind, Mover};
use crate::robot::tree::{Tree, TreeDynamics, TreeState};
use nalgebra::DMatrix;
use std::f64::consts::{FRAC_PI_2, PI};

/// A largest gravity torque below this counts as none \[N m\].
const NO_GRAVITY_NM: f64 = 1e-6;

/// What acts on one joint at one instant beside its motor and friction.
#[derive(Clone, Copy, Debug)]
struct Instant {
    /// `M_jj` of the links \[kg m^2\].
    inertia_kg_m2: f64,
    /// Largest gravity torque over a turn of the joint \[N m\], and the angle at which it would hang \[rad\].
    gravity_nm: f64,
    hanging_rad: f64,
    /// Torque of the other joints' motion \[N m\], of gravity too on a joint that slides.
    pushed_nm: f64,
}

/// What acts on each joint of a tree along a log.
struct AlongLog {
    /// From the log's beginning \[s\].
    t_s: Vec<f64>,
    /// At every instant, not as smoothed readings tell.
    is_known_throughout: bool,
    joints: Vec<Vec<Instant>>,
}

/// The joints of a robot along its logs.
pub(super) struct Along<'t> {
    tree: &'t Tree,
    /// Each of the tree's joints as described.
    movers: Vec<&'t Mover>,
}

impl<'t> Along<'t> {
    pub fn new(description: &'t Description, tree: &'t Tree) -> Self {
        Self { tree, movers: tree.joints().iter().map(|joint| &description.joints[joint.0]).collect() }
    }

    /// The nominal link of each joint of the tree, and what it carries along each log: means of its inertia, and the
    /// largest load, over all of them. `None` where a number is not finite. Each log has a place in `simulated`.
    pub fn links(
        &self,
        logs: &[RobotLog],
        simulated: &[Option<SimulatedMotion>],
    ) -> Vec<Option<(Nominal, Vec<Carriage>)>> {
        let followed = logs.iter().zip(simulated).map(|(log, simulated)| Followed::new(log, simulated.as_ref()));
        let along: Vec<AlongLog> = followed.map(|followed| self.of_log(&followed)).collect();
        (0..self.movers.len()).map(|joint| self.link(joint, &along)).collect()
    }

    fn link(&self, joint: usize, along: &[AlongLog]) -> Option<(Nominal, Vec<Carriage>)> {
        let all = || along.iter().flat_map(|log| &log.joints[joint]);
        let inertia_kg_m2 = all().map(|now| now.inertia_kg_m2).sum::<f64>() / all().count() as f64;
        let most_nm = all().map(|now| now.gravity_nm).fold(0.0, f64::max);
        let most_nm = if most_nm > NO_GRAVITY_NM { most_nm } else { 0.0 };
        let carried = |now: &Instant| {
            let share = if most_nm > 0.0 { now.gravity_nm / most_nm } else { 0.0 };
            Carried {
                inertia: now.inertia_kg_m2 / inertia_kg_m2,
                gravity: [share * math::cos(now.hanging_rad), share * math::sin(now.hanging_rad)],
                pushed_rad_s2: now.pushed_nm / inertia_kg_m2,
            }
        };
        let mover = self.movers[joint];
        let carriage = |along: &AlongLog| {
            let carriage = Carriage::new(&along.t_s, &along.joints[joint].iter().map(carried).collect::<Vec<_>>())?;
            let carriage = carriage.with_spring(mover.stiffness[0], mover.spring_rest_rad);
            Some(if along.is_known_throughout { carriage.known_throughout() } else { carriage })
        };
        let carriages = along.iter().map(carriage).collect::<Option<_>>()?;
        let moment_kg_m = most_nm / self.gravity_m_s2();
        Some((Nominal { inertia_kg_m2, moment_kg_m, coulomb_nm: 0.0, viscous_nm_s_rad: 0.0 }, carriages))
    }

    /// Gravity by which moments are told \[m/s^2\].
    pub fn gravity_m_s2(&self) -> f64 {
        let gravity_m_s2 = self.tree.gravity_m_s2().norm();
        if gravity_m_s2 > 0.0 { gravity_m_s2 } else { crate::number::STANDARD_GRAVITY_M_S2 }
    }

    /// Each joint of the tree along a log. Joints without readings stand as drawn.
    fn of_log(&self, log: &Followed<'_>) -> AlongLog {
        let joints = self.movers.len();
        let mut state = TreeState::drawn(self.tree);
        let motions: Vec<Option<Vec<[f64; 3]>>> = self.tree.joint_names().map(|name| log.joint(name)).collect();
        let t_s: Vec<f64> = log.t_s().iter().map(|t| t - log.t_s()[0]).collect();
        let mut dynamics = TreeDynamics::new(self.tree);
        let mut matrix = DMatrix::zeros(joints, joints);
        let mut acceleration = vec![0.0; joints];
        let (mut needed, mut level, mut turned) = (vec![0.0; joints], vec![0.0; joints], vec![0.0; joints]);
        let mut all: Vec<Vec<Instant>> = vec![Vec::with_capacity(t_s.len()); joints];
        for k in 0..t_s.len() {
            for (j, motion) in motions.iter().enumerate() {
                if let Some(motion) = motion {
                    [state.position[j], state.rate[j], acceleration[j]] = motion[k];
                }
            }
            // `needed` holds the armature of the joint's own acceleration too; `mass_matrix` has it on the diagonal.
            dynamics.inverse(&state, &acceleration, &mut needed);
            dynamics.mass_matrix(&state, &mut matrix);
            for j in 0..joints {
                needed[j] -= matrix[(j, j)] * acceleration[j];
            }
            dynamics.rigid_mass_matrix(&state, &mut matrix);
            let rate = std::mem::replace(&mut state.rate, vec![0.0; joints]);
            dynamics.bias(&state, &mut level);
            for j in 0..joints {
                let now =
                    Instant { inertia_kg_m2: matrix[(j, j)], gravity_nm: 0.0, hanging_rad: 0.0, pushed_nm: -needed[j] };
                let now = if self.movers[j].kind != JointKind::Prismatic {
                    let angle_rad = state.position[j];
                    state.position[j] = angle_rad + FRAC_PI_2;
                    dynamics.bias(&state, &mut turned);
                    state.position[j] = angle_rad;
                    // The torque that holds it up is `P sin(q - hanging)`, a quarter turn on `P cos(q - hanging)`.
                    let hanging_rad = angle_rad - math::atan2(level[j], turned[j]);
                    Instant {
                        gravity_nm: math::hypot(level[j], turned[j]),
                        hanging_rad: (hanging_rad + PI).rem_euclid(2.0 * PI) - PI,
                        pushed_nm: level[j] - needed[j],
                        ..now
                    }
                } else {
                    now
                };
                all[j].push(now);
            }
            state.rate = rate;
        }
        AlongLog { t_s, is_known_throughout: log.is_simulated(), joints: all }
    }
}
