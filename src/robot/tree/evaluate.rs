//! What is asked of a tree at a state.

use super::composite::mass_matrix;
use super::factor::Factors;
use super::motion::Motions;
use super::newton_euler::Loads;
use super::spatial::times;
use super::{Tree, TreeState};
use crate::robot::description::{LinkId, RigidInertia};
use nalgebra::{DMatrix, Isometry3, Vector3};

/// Why there are no accelerations: nothing resists a freedom.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum NoAcceleration {
    /// A joint moves something without mass, or moves just as the joints before it do.
    #[error("link {link} has no inertia about joint {joint}: the mass matrix is singular")]
    Joint {
        /// What it moves.
        link: String,
        /// The joint.
        joint: String,
    },
    /// The robot has no mass.
    #[error("the free base {link} carries no mass: the mass matrix is singular")]
    Base {
        /// What is free.
        link: String,
    },
}

/// Working memory for evaluations of one tree; after the first one only [`TreeDynamics::link_places_m`] allocates.
#[derive(Clone, Debug)]
pub struct TreeDynamics<'t> {
    tree: &'t Tree,
    motions: Motions,
    loads: Loads,
    composite: Vec<RigidInertia>,
    /// Base and every joint, before joints are coupled.
    all_matrix: DMatrix<f64>,
    all_forces: Vec<f64>,
    matrix: DMatrix<f64>,
    factors: Factors,
    nothing: Vec<f64>,
}

/// Energies.
#[derive(Clone, Copy, Debug)]
pub struct TreeEnergy {
    /// With that of the armatures \[J\].
    pub kinetic_j: f64,
    /// Of all links, zero at the world's origin \[J\].
    pub potential_j: f64,
}

/// Mass and its centre.
#[derive(Clone, Copy, Debug)]
pub struct TreeMomentum {
    /// \[kg\]
    pub mass_kg: f64,
    /// Centre of mass in the world \[m\].
    pub centre_m: Vector3<f64>,
    /// Its velocity \[m/s\].
    pub velocity_m_s: Vector3<f64>,
}

impl<'t> TreeDynamics<'t> {
    /// Memory for a tree.
    pub fn new(tree: &'t Tree) -> Self {
        let (all, n) = (tree.base_freedoms() + tree.names.len(), tree.freedoms());
        Self {
            tree,
            motions: Motions::default(),
            loads: Loads::default(),
            composite: Vec::new(),
            all_matrix: DMatrix::zeros(all, all),
            all_forces: vec![0.0; all],
            matrix: DMatrix::zeros(n, n),
            factors: Factors::new(n),
            nothing: vec![0.0; n],
        }
    }

    /// The tree.
    pub fn tree(&self) -> &'t Tree {
        self.tree
    }

    /// The mass matrix with armature; one without it is [`TreeDynamics::rigid_mass_matrix`].
    pub fn mass_matrix(&mut self, state: &TreeState, matrix: &mut DMatrix<f64>) {
        self.rigid_mass_matrix(state, matrix);
        self.add_armature(matrix);
    }

    /// The mass matrix of the rigid bodies alone.
    pub fn rigid_mass_matrix(&mut self, state: &TreeState, matrix: &mut DMatrix<f64>) {
        self.motions.set(self.tree, state);
        mass_matrix(self.tree, &self.motions, &mut self.composite, &mut self.all_matrix);
        let base = self.tree.base_freedoms();
        let row = |all: usize| match all.checked_sub(base) {
            Some(joint) => {
                let follows = self.tree.coordinates.follows[joint];
                (base + follows.freedom, follows.multiplier)
            }
            None => (all, 1.0),
        };
        matrix.fill(0.0);
        for j in 0..self.all_matrix.ncols() {
            let (column, along) = row(j);
            for i in 0..self.all_matrix.nrows() {
                let (row, across) = row(i);
                matrix[(row, column)] += across * along * self.all_matrix[(i, j)];
            }
        }
    }

    fn add_armature(&self, matrix: &mut DMatrix<f64>) {
        let base = self.tree.base_freedoms();
        for k in 0..base {
            matrix[(k, k)] += self.tree.base.map_or(0.0, |base| base.armature);
        }
        for (armature, follows) in self.tree.armature.iter().zip(&self.tree.coordinates.follows) {
            let at = base + follows.freedom;
            matrix[(at, at)] += armature * follows.multiplier * follows.multiplier;
        }
    }

    /// Coriolis, centrifugal and gravity forces.
    pub fn bias(&mut self, state: &TreeState, bias: &mut [f64]) {
        self.motions.set(self.tree, state);
        self.loads.set(self.tree, state, &self.motions, &self.nothing, &mut self.all_forces);
        self.couple(bias);
    }

    /// The forces that accelerations need: `M v' + bias`.
    pub fn inverse(&mut self, state: &TreeState, v_dot: &[f64], force: &mut [f64]) {
        self.motions.set(self.tree, state);
        self.loads.set(self.tree, state, &self.motions, v_dot, &mut self.all_forces);
        self.couple(force);
        let (base, tree) = (self.tree.base_freedoms(), self.tree);
        for k in 0..base {
            force[k] += tree.base.map_or(0.0, |base| base.armature) * v_dot[k];
        }
        for (armature, follows) in tree.armature.iter().zip(&tree.coordinates.follows) {
            let at = base + follows.freedom;
            force[at] += armature * follows.multiplier * follows.multiplier * v_dot[at];
        }
    }

    /// `G^T` times the forces on base and every joint.
    fn couple(&self, force: &mut [f64]) {
        let base = self.tree.base_freedoms();
        force.fill(0.0);
        force[..base].copy_from_slice(&self.all_forces[..base]);
        for (one, follows) in self.all_forces[base..].iter().zip(&self.tree.coordinates.follows) {
            force[base + follows.freedom] += follows.multiplier * one;
        }
    }

    /// Accelerations under forces on the freedoms (base first where it is free).
    ///
    /// # Errors
    /// [`NoAcceleration`] where nothing resists a freedom.
    pub fn forward(&mut self, state: &TreeState, force: &[f64], v_dot: &mut [f64]) -> Result<(), NoAcceleration> {
        self.forward_with(state, force, v_dot, true)
    }

    /// As [`TreeDynamics::forward`], of the rigid bodies alone.
    ///
    /// # Errors
    /// As [`TreeDynamics::forward`].
    pub fn rigid_forward(&mut self, state: &TreeState, force: &[f64], v_dot: &mut [f64]) -> Result<(), NoAcceleration> {
        self.forward_with(state, force, v_dot, false)
    }

    fn forward_with(
        &mut self,
        state: &TreeState,
        force: &[f64],
        v_dot: &mut [f64],
        has_armature: bool,
    ) -> Result<(), NoAcceleration> {
        self.bias(state, v_dot);
        for (entry, force) in v_dot.iter_mut().zip(force) {
            *entry = force - *entry;
        }
        let mut matrix = std::mem::replace(&mut self.matrix, DMatrix::zeros(0, 0));
        self.rigid_mass_matrix(state, &mut matrix);
        if has_armature {
            self.add_armature(&mut matrix);
        }
        let found = self.factors.set(&matrix);
        self.matrix = matrix;
        found.map_err(|place| self.singular(place))?;
        self.factors.solve(v_dot);
        Ok(())
    }

    /// Logarithm of the determinant of the mass matrix that [`TreeDynamics::forward`] factorised last.
    pub fn log_determinant(&self) -> f64 {
        self.factors.log_determinant()
    }

    fn singular(&self, place: usize) -> NoAcceleration {
        let tree = self.tree;
        let link = |link: LinkId| tree.link_names[link.0].clone();
        match place.checked_sub(tree.base_freedoms()) {
            Some(place) => {
                let joint = tree.joints()[place];
                NoAcceleration::Joint { link: link(tree.moved[joint.0]), joint: tree.names[joint.0].clone() }
            }
            None => NoAcceleration::Base { link: tree.base.map_or_else(String::new, |base| link(base.link)) },
        }
    }

    /// Forces on the freedoms of forces on every joint: `G^T tau`, zeros on the base.
    pub fn forces_of(&self, joint_force: &[f64], force: &mut [f64]) {
        force.fill(0.0);
        for (one, follows) in joint_force.iter().zip(&self.tree.coordinates.follows) {
            force[self.tree.base_freedoms() + follows.freedom] += follows.multiplier * one;
        }
    }

    /// Places of all links' frames in the world \[m\].
    pub fn link_places_m(&mut self, state: &TreeState) -> Vec<Vector3<f64>> {
        self.motions.set(self.tree, state);
        let place = |(body, pose): &(Option<usize>, Isometry3<f64>)| {
            let in_body = pose.translation.vector;
            body.map_or(in_body, |body| self.motions.in_world[body].point(&in_body))
        };
        self.tree.links.iter().map(place).collect()
    }

    /// Mass and centre of all links, and of those that can move.
    pub fn momentum(&mut self, state: &TreeState) -> [TreeMomentum; 2] {
        self.motions.set(self.tree, state);
        let (mut moment, mut momentum, mut mass) = (Vector3::zeros(), Vector3::zeros(), 0.0);
        for ((body, frame), twist) in self.tree.bodies.iter().zip(&self.motions.in_world).zip(&self.motions.twist) {
            mass += body.inertia.mass_kg;
            moment += frame.rotation * body.inertia.first_moment_kg_m + frame.origin * body.inertia.mass_kg;
            momentum += frame.rotation * times(&body.inertia, twist).force;
        }
        let of = |mass_kg: f64, moment: Vector3<f64>| {
            let per = if mass_kg == 0.0 { 0.0 } else { 1.0 / mass_kg };
            TreeMomentum { mass_kg, centre_m: moment * per, velocity_m_s: momentum * per }
        };
        let still = &self.tree.still;
        [of(mass + still.mass_kg, moment + still.first_moment_kg_m), of(mass, moment)]
    }

    /// Kinetic and potential energy.
    pub fn energy(&mut self, state: &TreeState) -> TreeEnergy {
        let [all, _] = self.momentum(state);
        let bodies = self.tree.bodies.iter().zip(&self.motions.twist);
        let rigid: f64 = bodies.map(|(body, twist)| twist.dot(&times(&body.inertia, twist))).sum();
        let joints = self.tree.armature.iter().enumerate();
        let rotors: f64 = joints.map(|(k, a)| a * self.tree.coordinates.rate(k, &state.rate).powi(2)).sum();
        let base = self.tree.base.map_or(0.0, |base| {
            base.armature * (state.base_velocity_m_s.norm_squared() + state.base_rate_rad_s.norm_squared())
        });
        TreeEnergy {
            kinetic_j: 0.5 * (rigid + rotors + base),
            potential_j: -all.mass_kg * self.tree.gravity_m_s2.dot(&all.centre_m),
        }
    }
}
