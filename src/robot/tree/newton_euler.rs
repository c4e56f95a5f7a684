//! Which forces a motion needs: the recursion of Newton and Euler (Featherstone 2008, table 5.1).

use super::motion::Motions;
use super::spatial::{Twist, Wrench, times};
use super::{Moves, Tree, TreeState};
use nalgebra::Vector3;

/// Memory of the recursion.
#[derive(Clone, Debug, Default)]
pub(super) struct Loads {
    acceleration: Vec<Twist>,
    wrench: Vec<Wrench>,
}

impl Loads {
    /// The generalised forces for accelerations `v'` of the freedoms (as long as them), gravity and velocities included,
    /// armature not; `all` of them in the coordinates before joints are coupled: base, then every joint.
    pub fn set(&mut self, tree: &Tree, state: &TreeState, motions: &Motions, v_dot: &[f64], all: &mut [f64]) {
        let (of_base, of_joints) = v_dot.split_at(tree.base_freedoms());
        self.acceleration.clear();
        self.wrench.clear();
        for (index, body) in tree.bodies.iter().enumerate() {
            let (frame, twist) = (&motions.in_parent[index], motions.twist[index]);
            let from_parent = match body.parent {
                Some(parent) => frame.into_inner(&self.acceleration[parent]),
                // Gravity is an acceleration of the world the other way.
                None => Twist { angular: Vector3::zeros(), linear: frame.rotation.tr_mul(&-tree.gravity_m_s2) },
            };
            let own = match body.moves {
                Moves::Freely => {
                    // The origin's classical acceleration, as the rate of change of the twist's components.
                    let linear = Vector3::from_column_slice(&of_base[..3]);
                    let apparent = frame.rotation.tr_mul(&linear) - twist.angular.cross(&twist.linear);
                    Twist { angular: Vector3::from_column_slice(&of_base[3..]), linear: apparent }
                }
                Moves::By { joint, .. } => {
                    let axis = body.axis();
                    let rate = axis * tree.coordinates.rate(joint.0, &state.rate);
                    axis * tree.coordinates.rate(joint.0, of_joints) + twist.cross(&rate)
                }
            };
            let acceleration = from_parent + own;
            let mut wrench = times(&body.inertia, &acceleration);
            wrench += twist.cross_wrench(&times(&body.inertia, &twist));
            self.acceleration.push(acceleration);
            self.wrench.push(wrench);
        }
        for (index, body) in tree.bodies.iter().enumerate().rev() {
            let wrench = self.wrench[index];
            match body.moves {
                Moves::Freely => {
                    let force = motions.in_parent[index].rotation * wrench.force;
                    all[..3].copy_from_slice(force.as_slice());
                    all[3..6].copy_from_slice(wrench.moment.as_slice());
                }
                Moves::By { joint, .. } => all[tree.base_freedoms() + joint.0] = body.axis().dot(&wrench),
            }
            if let Some(parent) = body.parent {
                self.wrench[parent] += motions.in_parent[index].into_outer(&wrench);
            }
        }
    }
}
