//! Forward dynamics by the articulated-body algorithm (Featherstone 2008, table 7.1), two bodies at a time.
//!
//! In working frames (origin on the joint's axis, `S = [e_K; 0]`) the column `U = I^A S` is read off, not computed:
//! `D = A_KK + d` with the implicit diagonal term d, `u = tau - n_K`. The rest is
//!
//! ```text
//! outward  v = X v_parent + S q',  c = v x S q',  p^A = v x* I v - f_ext
//! inward   I^a = I^A - U U^T / D,  p^a = p^A + I^a c + U u / D,  both shifted to the parent and added there
//! outward  a' = X a_parent + c,  q'' = (u - U^T a') / D,  a = a' + S q''
//! ```
//!
//! Gravity enters as an acceleration of the base. Three passes over the groups; which axis a group turns about and
//! whether it has an offset is known to the compiler in each.

use super::base::solve_base;
use super::slot::{Slot, Spatial};
use super::{ContactDamping, Dynamics, Input};
use crate::geometry::robot_file::Base;
use crate::robot::State;
use crate::robot::model::{BASE_FREEDOMS, BasePlan, Group, Parent, Shape};
use crate::robot::spatial::{Articulated, Pair, add, cross, rotate, rotate_back, sin_cos, sub};
use nalgebra::Vector3;

/// Runs a pass for the axis and shape of a group.
macro_rules! by_kind {
    ($group:expr, $pass:ident, $($argument:expr),*) => {
        match ($group.axis, $group.shape) {
            (0, Shape::Turn) => $pass::<0, false, false>($($argument),*),
            (0, Shape::Shifted) => $pass::<0, true, false>($($argument),*),
            (0, Shape::Rotated) => $pass::<0, true, true>($($argument),*),
            (1, Shape::Turn) => $pass::<1, false, false>($($argument),*),
            (1, Shape::Shifted) => $pass::<1, true, false>($($argument),*),
            (1, Shape::Rotated) => $pass::<1, true, true>($($argument),*),
            (_, Shape::Turn) => $pass::<2, false, false>($($argument),*),
            (_, Shape::Shifted) => $pass::<2, true, false>($($argument),*),
            (_, Shape::Rotated) => $pass::<2, true, true>($($argument),*),
        }
    };
}

/// The base's share of the recursion, in both lanes.
struct BaseWork {
    velocity: Spatial,
    inertia: Articulated,
    bias: Spatial,
    acceleration: Spatial,
}

impl Dynamics<'_> {
    /// Forward dynamics: the acceleration `dv/dt` that torques, forces and gravity give.
    ///
    /// `(M + diag(0, d)) dv/dt = [0; tau] + J^T f - bias`. A clamped base does not accelerate, whatever velocity its
    /// state has is ignored.
    ///
    /// # Panics
    /// Where a slice has not the model's length.
    pub fn forward(&mut self, state: &State, input: &Input<'_>, acceleration: &mut [f64]) {
        self.solve(state, input, 0.0, &[], acceleration);
    }

    /// Forward dynamics of a step of length h that takes contacts implicitly, each with its damping D, stiffness K and
    /// the velocity u of its point:
    ///
    /// `(M + diag(0, d) + h J^T (D + h K) J) dv/dt = [0; tau] + J^T (f - h K u) - bias`.
    ///
    /// The contact forces themselves, at the start of the step, stand in `input.forces`.
    ///
    /// # Panics
    /// Where a slice has not the model's length.
    pub fn forward_implicit(
        &mut self,
        state: &State,
        input: &Input<'_>,
        step_s: f64,
        contacts: &[ContactDamping],
        acceleration: &mut [f64],
    ) {
        self.solve(state, input, step_s, contacts, acceleration);
    }

    #[inline(always)]
    fn solve(
        &mut self,
        state: &State,
        input: &Input<'_>,
        step_s: f64,
        contacts: &[ContactDamping],
        acceleration: &mut [f64],
    ) {
        let joints = self.model.joints().len();
        self.check_state(state);
        self.check("torques", input.torque_nm.len(), joints);
        self.check("accelerations", acceleration.len(), BASE_FREEDOMS + joints);
        if !input.diagonal_kg_m2.is_empty() {
            self.check("diagonal terms", input.diagonal_kg_m2.len(), joints);
        }
        let groups = &self.model.plan().groups;
        for (group, slot) in groups.iter().zip(&mut self.slots) {
            let angle = of_joints(group, &state.angle_rad) * group.sign + group.phase_rad;
            (slot.sin, slot.cos) = sin_cos(angle);
        }
        let has_forces = !input.forces.is_empty();
        let rotation = state.base_orientation.to_rotation_matrix();
        let (velocity_m_s, rate_rad_s) = match self.model.base() {
            Base::Floating => (rotation.inverse() * state.base_velocity_m_s, state.base_rate_rad_s),
            Base::Clamped => (Vector3::zeros(), Vector3::zeros()),
        };
        let mut base = start_of_base(&self.model.plan().base, &rate_rad_s, &velocity_m_s);
        if has_forces {
            self.place_forces(state, input.forces, &mut base.bias);
        }
        for (k, group) in groups.iter().enumerate() {
            let rate = of_joints(group, &state.rate_rad_s) * group.sign;
            let above = parent_of(group, &self.slots, &base.velocity, |slot| slot.velocity);
            let slot = &mut self.slots[k];
            by_kind!(group, outward, group, slot, above, rate, has_forces);
        }
        let gravity = rotation.inverse() * self.model.gravity_m_s2();
        if !contacts.is_empty() {
            let resting = -(gravity + rate_rad_s.cross(&velocity_m_s));
            self.place_contacts(state, &resting, step_s, contacts, (&mut base.inertia, &mut base.bias));
        }
        let armature = self.model.plan().armature_kg_m2.as_slice();
        for (k, group) in groups.iter().enumerate().rev() {
            let torque = of_joints(group, input.torque_nm) * group.sign;
            let diagonal = match (input.diagonal_kg_m2, armature) {
                ([], []) => Pair::zero(),
                ([], armature) => armature[k],
                (diagonal, []) => of_joints(group, diagonal),
                (diagonal, armature) => of_joints(group, diagonal) + armature[k],
            };
            let (earlier, rest) = self.slots.split_at_mut(k);
            by_kind!(group, inward, group, &mut rest[0], torque, diagonal, earlier, &mut base);
        }
        let (angular, linear) = match self.model.base() {
            Base::Floating => solve_base(&base.inertia, &base.bias),
            Base::Clamped => (Vector3::zeros(), -gravity),
        };
        base.acceleration = (both(&angular), both(&linear));
        for (k, group) in groups.iter().enumerate() {
            let above = parent_of(group, &self.slots, &base.acceleration, |slot| slot.acceleration);
            let joint_acceleration = by_kind!(group, onward, group, &mut self.slots[k], above) * group.sign;
            let [first, second] = joint_acceleration.lanes();
            acceleration[BASE_FREEDOMS + group.joints[1]] = second;
            acceleration[BASE_FREEDOMS + group.joints[0]] = first;
        }
        // From the spatial acceleration with gravity in it to that of the base's centre, in world axes.
        let classical = match self.model.base() {
            Base::Floating => rotation * (linear + gravity + rate_rad_s.cross(&velocity_m_s)),
            Base::Clamped => Vector3::zeros(),
        };
        acceleration[..3].copy_from_slice(classical.as_slice());
        acceleration[3..6].copy_from_slice(angular.as_slice());
    }
}

/// A number of each of a group's joints.
#[inline(always)]
fn of_joints(group: &Group, values: &[f64]) -> Pair {
    Pair::new(values[group.joints[0]], values[group.joints[1]])
}

#[inline(always)]
fn both(v: &Vector3<f64>) -> [Pair; 3] {
    [Pair::splat(v.x), Pair::splat(v.y), Pair::splat(v.z)]
}

/// What the group's parents have of something.
#[inline(always)]
fn parent_of(group: &Group, slots: &[Slot], base: &Spatial, of: impl Fn(&Slot) -> Spatial) -> Spatial {
    match group.parent {
        Parent::Base => *base,
        Parent::Lanes(above) => of(&slots[above]),
        Parent::Shared { group, lane, .. } => {
            let (angular, linear) = of(&slots[group]);
            let one = |x: Pair| Pair::splat(x.lanes()[lane]);
            (angular.map(one), linear.map(one))
        }
    }
}

/// The base before anything hangs on it.
fn start_of_base(plan: &BasePlan, rate_rad_s: &Vector3<f64>, velocity_m_s: &Vector3<f64>) -> BaseWork {
    let centre_velocity = velocity_m_s + rate_rad_s.cross(&plan.centre_m);
    let force = rate_rad_s.cross(&centre_velocity) * plan.mass_kg;
    let moment = rate_rad_s.cross(&(plan.inertia_kg_m2 * rate_rad_s)) + plan.centre_m.cross(&force);
    let first = |v: Vector3<f64>| [Pair::new(v.x, 0.0), Pair::new(v.y, 0.0), Pair::new(v.z, 0.0)];
    BaseWork {
        velocity: (both(rate_rad_s), both(velocity_m_s)),
        inertia: plan.rigid,
        bias: (first(moment), first(force)),
        acceleration: ([Pair::zero(); 3], [Pair::zero(); 3]),
    }
}

/// A motion of the parent, in the child's working frame.
#[inline(always)]
fn into_child<const K: usize, const SHIFTED: bool, const ROTATED: bool>(
    group: &Group,
    slot: &Slot,
    (angular, linear): Spatial,
) -> Spatial {
    let (mut angular, mut linear) = (angular, linear);
    if SHIFTED {
        linear = add(linear, cross(angular, group.offset_m));
    }
    if ROTATED {
        (angular, linear) = (rotate_back(&group.fixed, angular), rotate_back(&group.fixed, linear));
    }
    let turn = slot.turn();
    (turn.into_child::<K>(angular), turn.into_child::<K>(linear))
}

/// First pass: velocity, velocity product, bias force and rigid inertia.
#[inline(always)]
fn outward<const K: usize, const SHIFTED: bool, const ROTATED: bool>(
    group: &Group,
    slot: &mut Slot,
    above: Spatial,
    rate: Pair,
    has_forces: bool,
) {
    let (i, j) = ((K + 1) % 3, (K + 2) % 3);
    let (mut omega, velocity) = into_child::<K, SHIFTED, ROTATED>(group, slot, above);
    // v x S q': the axis's own motion adds nothing, so the parent's will do.
    let zero = Pair::zero();
    let mut product = ([zero; 3], [zero; 3]);
    product.0[i] = omega[j] * rate;
    product.0[j] = -(omega[i] * rate);
    product.1[i] = velocity[j] * rate;
    product.1[j] = -(velocity[i] * rate);
    omega[K] += rate;
    // v x* I v, about the centre of mass: m w x v_c, and w x I w.
    let centre_velocity = add(velocity, cross(omega, group.centre_m));
    let force = cross(omega, centre_velocity).map(|x| x * group.mass_kg);
    let inertia = &group.inertia_kg_m2;
    let spin = [
        inertia[0] * omega[0] + inertia[5] * omega[1] + inertia[4] * omega[2],
        inertia[5] * omega[0] + inertia[1] * omega[1] + inertia[3] * omega[2],
        inertia[4] * omega[0] + inertia[3] * omega[1] + inertia[2] * omega[2],
    ];
    let moment = add(cross(omega, spin), cross(group.centre_m, force));
    slot.velocity = (omega, velocity);
    slot.product = product;
    slot.inertia = group.rigid;
    slot.bias = if has_forces { (sub(moment, slot.external.0), sub(force, slot.external.1)) } else { (moment, force) };
}

/// Second pass: what the joint leaves of inertia and bias, handed to the parent.
#[inline(always)]
fn inward<const K: usize, const SHIFTED: bool, const ROTATED: bool>(
    group: &Group,
    slot: &mut Slot,
    torque: Pair,
    diagonal: Pair,
    earlier: &mut [Slot],
    base: &mut BaseWork,
) {
    let column = slot.inertia.column::<K>();
    let inverse = (column.0[K] + diagonal).inverse();
    let gain = (column.0.map(|x| x * inverse), column.1.map(|x| x * inverse));
    let effort = torque - slot.bias.0[K];
    slot.gain = gain;
    slot.drive = effort * inverse;
    let left = slot.inertia.minus_outer(column, gain);
    let along = left.times_across::<K>(slot.product);
    let bias =
        |k: usize| (slot.bias.0[k] + along.0[k] + gain.0[k] * effort, slot.bias.1[k] + along.1[k] + gain.1[k] * effort);
    let (b0, b1, b2) = (bias(0), bias(1), bias(2));
    let turn = slot.turn();
    let mut inertia = left.seen_from_parent::<K>(&turn);
    let mut moment = turn.into_parent::<K>([b0.0, b1.0, b2.0]);
    let mut force = turn.into_parent::<K>([b0.1, b1.1, b2.1]);
    if ROTATED {
        inertia = inertia.rotated(&group.fixed);
        (moment, force) = (rotate(&group.fixed, moment), rotate(&group.fixed, force));
    }
    if SHIFTED {
        inertia = inertia.shifted(group.offset_m);
        moment = add(moment, cross(group.offset_m, force));
    }
    match group.parent {
        Parent::Lanes(above) => give(&mut earlier[above], &inertia, moment, force, |x| x),
        Parent::Base => {
            let counted = |x: Pair| x * group.counts;
            base.inertia.zip(&inertia, |x, y| x + counted(y));
            base.bias.0 = add(base.bias.0, moment.map(counted));
            base.bias.1 = add(base.bias.1, force.map(counted));
        }
        Parent::Shared { group: above, mask, .. } => {
            let summed = |x: Pair| mask * Pair::splat((x * group.counts).sum());
            give(&mut earlier[above], &inertia, moment, force, summed);
        }
    }
}

/// Adds inertia and bias to a parent.
#[inline(always)]
fn give(above: &mut Slot, inertia: &Articulated, moment: [Pair; 3], force: [Pair; 3], share: impl Fn(Pair) -> Pair) {
    above.inertia.zip(inertia, |x, y| x + share(y));
    above.bias.0 = add(above.bias.0, moment.map(&share));
    above.bias.1 = add(above.bias.1, force.map(&share));
}

/// Third pass: the joints' accelerations, working sense.
#[inline(always)]
fn onward<const K: usize, const SHIFTED: bool, const ROTATED: bool>(
    group: &Group,
    slot: &mut Slot,
    above: Spatial,
) -> Pair {
    let (angular, linear) = into_child::<K, SHIFTED, ROTATED>(group, slot, above);
    let (mut angular, linear) = (add(angular, slot.product.0), add(linear, slot.product.1));
    let (g, f) = (&slot.gain.0, &slot.gain.1);
    let against = (g[0] * angular[0] + g[1] * angular[1] + g[2] * angular[2])
        + (f[0] * linear[0] + f[1] * linear[1] + f[2] * linear[2]);
    let acceleration = slot.drive - against;
    angular[K] += acceleration;
    slot.acceleration = (angular, linear);
    acceleration
}
