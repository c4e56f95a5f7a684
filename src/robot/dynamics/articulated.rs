//! Forward dynamics by the articulated-body algorithm (Featherstone 2008, table 7.1), several bodies at a time: two of one
//! robot, or one of each of several robots ([`Layout`]).
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

use super::base::{Carried, solve_base};
use super::layout::{Handed, Layout, Pairwise, Rows, rows};
use super::slot::{Slot, Spatial};
use super::{ContactDamping, Dynamics, Input};
use crate::geometry::robot_file::Base;
use crate::number::Lanes;
use crate::robot::State;
use crate::robot::model::{BASE_FREEDOMS, BasePlan, Group, Plan, Shape};
use crate::robot::spatial::{Articulated, Number, Two, add, cross, rotate, rotate_back, sin_cos, sub, three};
use nalgebra::Vector3;

/// Runs a pass for the axis and shape of a group.
macro_rules! by_kind {
    ($group:expr, $pass:ident, $layout:ident, $($argument:expr),*) => {
        match ($group.axis, $group.shape) {
            (0, Shape::Turn) => $pass::<$layout, 0, false, false>($($argument),*),
            (0, Shape::Shifted) => $pass::<$layout, 0, true, false>($($argument),*),
            (0, Shape::Rotated) => $pass::<$layout, 0, true, true>($($argument),*),
            (1, Shape::Turn) => $pass::<$layout, 1, false, false>($($argument),*),
            (1, Shape::Shifted) => $pass::<$layout, 1, true, false>($($argument),*),
            (1, Shape::Rotated) => $pass::<$layout, 1, true, true>($($argument),*),
            (_, Shape::Turn) => $pass::<$layout, 2, false, false>($($argument),*),
            (_, Shape::Shifted) => $pass::<$layout, 2, true, false>($($argument),*),
            (_, Shape::Rotated) => $pass::<$layout, 2, true, true>($($argument),*),
        }
    };
}

/// The bases' share of the recursion; inertia and bias apart by the bodies of the pairs that hang on them.
pub(super) struct BaseWork<L: Layout> {
    velocity: Spatial<L::Number>,
    pub inertia: [Articulated<L::Number>; 2],
    pub bias: [Spatial<L::Number>; 2],
    acceleration: Spatial<L::Number>,
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
        self.check_input(input);
        self.check("accelerations", acceleration.len(), BASE_FREEDOMS + joints);
        let (model, plan) = (self.model, self.model.plan());
        let of_joints = |values| rows(joints, |_| values);
        turn::<Pairwise>(plan, &mut self.slots, &of_joints(&state.angle_rad));
        let carried = Carried::of(model, |_| state);
        let mut base = BaseWork::<Pairwise>::new(&plan.base, &carried);
        let has_forces = !input.forces.is_empty();
        if has_forces {
            self.place_forces(state, input.forces, &mut base.bias[0]);
        }
        go_outward(plan, &mut self.slots, &base, &of_joints(&state.rate_rad_s), has_forces);
        if !contacts.is_empty() {
            let resting = -Vector3::from(carried.falling());
            self.place_contacts(state, &resting, step_s, contacts, (&mut base.inertia[0], &mut base.bias[0]));
        }
        let added = Added {
            torque_nm: of_joints(input.torque_nm),
            diagonal_kg_m2: (!input.diagonal_kg_m2.is_empty()).then(|| of_joints(input.diagonal_kg_m2)),
            rotors: &plan.armature_kg_m2,
        };
        go_inward(plan, &mut self.slots, &mut base, &added);
        base.accelerate(model.base(), &carried, acceleration, BASE_FREEDOMS + joints);
        go_onward(plan, &mut self.slots, &base, acceleration, BASE_FREEDOMS + joints);
    }
}

impl<L: Layout> BaseWork<L> {
    /// The base before anything hangs on it.
    #[inline(always)]
    pub fn new(plan: &BasePlan, carried: &Carried<L::Single>) -> Self {
        let (rate, velocity) = (carried.rate_rad_s, carried.velocity_m_s);
        let splat = L::Single::splat;
        let centre = three(|i| splat(plan.centre_m[i]));
        let centre_velocity = add(velocity, cross(rate, centre));
        let force = cross(rate, centre_velocity).map(|x| x * splat(plan.mass_kg));
        let inertia = three(|i| three(|j| splat(plan.inertia_kg_m2[(i, j)])));
        let moment = add(cross(rate, rotate(&inertia, rate)), cross(centre, force));
        let bias = |part: usize| (three(|i| L::first(moment[i])[part]), three(|i| L::first(force[i])[part]));
        let zero = L::Number::zero();
        Self {
            velocity: (rate.map(L::of_robot), velocity.map(L::of_robot)),
            inertia: [L::inertia(&plan.rigid, 0), L::inertia(&plan.rigid, 1)],
            bias: [bias(0), bias(1)],
            acceleration: ([zero; 3], [zero; 3]),
        }
    }

    /// Answers the bases' accelerations, once all that hangs on them is known.
    #[inline(always)]
    pub fn accelerate(&mut self, base: Base, carried: &Carried<L::Single>, out: &mut [f64], freedoms: usize) {
        let (angular, linear) = match base {
            Base::Floating => solve_base(self),
            Base::Clamped => ([L::Single::zero(); 3], carried.gravity_m_s2.map(|x| x * L::Single::splat(-1.0))),
        };
        self.acceleration = (angular.map(L::of_robot), linear.map(L::of_robot));
        carried.write(base, (angular, linear), out, freedoms);
    }
}

/// Sines and cosines of the working angles.
#[inline(always)]
pub(super) fn turn<L: Layout>(plan: &Plan, slots: &mut [Slot<L::Number>], angle_rad: &Rows<'_>) {
    for (k, group) in plan.groups.iter().enumerate() {
        for part in 0..L::parts(group) {
            let slot = &mut slots[L::PARTS * k + part];
            let angle = L::of_joints(group, part, angle_rad) * L::constant(&group.sign, part);
            (slot.sin, slot.cos) = sin_cos(angle + L::constant(&group.phase_rad, part));
        }
    }
}

/// First pass, over all groups.
#[inline(always)]
pub(super) fn go_outward<L: Layout>(
    plan: &Plan,
    slots: &mut [Slot<L::Number>],
    base: &BaseWork<L>,
    rate_rad_s: &Rows<'_>,
    has_forces: bool,
) {
    for (k, group) in plan.groups.iter().enumerate() {
        by_kind!(group, outward, L, group, k, slots, base, rate_rad_s, has_forces);
    }
}

/// Second pass, over all groups.
#[inline(always)]
pub(super) fn go_inward<L: Layout>(
    plan: &Plan,
    slots: &mut [Slot<L::Number>],
    base: &mut BaseWork<L>,
    added: &Added<'_>,
) {
    let mut kept = Handed::zero();
    for (k, group) in plan.groups.iter().enumerate().rev() {
        by_kind!(group, inward, L, group, k, slots, base, added, &mut kept);
    }
}

/// Third pass, over all groups.
#[inline(always)]
pub(super) fn go_onward<L: Layout>(
    plan: &Plan,
    slots: &mut [Slot<L::Number>],
    base: &BaseWork<L>,
    out: &mut [f64],
    freedoms: usize,
) {
    for (k, group) in plan.groups.iter().enumerate() {
        by_kind!(group, onward, L, group, k, slots, base, out, freedoms);
    }
}

/// A motion of the parent, in the child's working frame.
#[inline(always)]
fn into_child<L: Layout, const K: usize, const SHIFTED: bool, const ROTATED: bool>(
    group: &Group,
    part: usize,
    slot: &Slot<L::Number>,
    (angular, linear): Spatial<L::Number>,
) -> Spatial<L::Number> {
    let (mut angular, mut linear) = (angular, linear);
    if SHIFTED {
        linear = add(linear, cross(angular, L::vector(&group.offset_m, part)));
    }
    if ROTATED {
        let fixed = L::matrix(&group.fixed, part);
        (angular, linear) = (rotate_back(&fixed, angular), rotate_back(&fixed, linear));
    }
    let turn = slot.turn();
    (turn.into_child::<K>(angular), turn.into_child::<K>(linear))
}

/// First pass: velocity, velocity product, bias force and rigid inertia.
#[inline(always)]
fn outward<L: Layout, const K: usize, const SHIFTED: bool, const ROTATED: bool>(
    group: &Group,
    k: usize,
    slots: &mut [Slot<L::Number>],
    base: &BaseWork<L>,
    rate_rad_s: &Rows<'_>,
    has_forces: bool,
) {
    for part in 0..L::parts(group) {
        outward_part::<L, K, SHIFTED, ROTATED>(group, (k, part), slots, base, rate_rad_s, has_forces);
    }
}

#[inline(always)]
fn outward_part<L: Layout, const K: usize, const SHIFTED: bool, const ROTATED: bool>(
    group: &Group,
    (k, part): (usize, usize),
    slots: &mut [Slot<L::Number>],
    base: &BaseWork<L>,
    rate_rad_s: &Rows<'_>,
    has_forces: bool,
) {
    let (i, j) = ((K + 1) % 3, (K + 2) % 3);
    let constant = |two: &Two| L::constant(two, part);
    let rate = L::of_joints(group, part, rate_rad_s) * constant(&group.sign);
    let above = L::above(group, part, slots, &base.velocity, |slot| slot.motion);
    let slot = &mut slots[L::PARTS * k + part];
    let (mut omega, velocity) = into_child::<L, K, SHIFTED, ROTATED>(group, part, slot, above);
    // v x S q': the axis's own motion adds nothing, so the parent's will do.
    let zero = L::Number::zero();
    let mut product = ([zero; 3], [zero; 3]);
    product.0[i] = omega[j] * rate;
    product.0[j] = -(omega[i] * rate);
    product.1[i] = velocity[j] * rate;
    product.1[j] = -(velocity[i] * rate);
    omega[K] += rate;
    // v x* I v, about the centre of mass: m w x v_c, and w x I w.
    let centre = L::vector(&group.centre_m, part);
    let centre_velocity = add(velocity, cross(omega, centre));
    let mass = constant(&group.mass_kg);
    let force = cross(omega, centre_velocity).map(|x| x * mass);
    let inertia = L::symmetric(&group.inertia_kg_m2, part);
    let spin = [
        inertia[0] * omega[0] + inertia[5] * omega[1] + inertia[4] * omega[2],
        inertia[5] * omega[0] + inertia[1] * omega[1] + inertia[3] * omega[2],
        inertia[4] * omega[0] + inertia[3] * omega[1] + inertia[2] * omega[2],
    ];
    let moment = add(cross(omega, spin), cross(centre, force));
    slot.motion = (omega, velocity);
    slot.product = product;
    slot.inertia = L::inertia(&group.rigid, part);
    slot.bias = if has_forces { (sub(moment, slot.external.0), sub(force, slot.external.1)) } else { (moment, force) };
}

/// Second pass: what the joint leaves of inertia and bias, handed to the parent.
#[inline(always)]
fn inward<L: Layout, const K: usize, const SHIFTED: bool, const ROTATED: bool>(
    group: &Group,
    k: usize,
    slots: &mut [Slot<L::Number>],
    base: &mut BaseWork<L>,
    added: &Added<'_>,
    kept: &mut Handed<L::Number>,
) {
    let (earlier, own) = slots.split_at_mut(L::PARTS * k);
    let rotor = added.rotors.get(k);
    for (part, slot) in own.iter_mut().enumerate().take(L::parts(group)) {
        let handed = inward_part::<L, K, SHIFTED, ROTATED>(group, part, slot, added, rotor);
        L::give(group, part, handed, kept, earlier, base);
    }
}

/// What acts on joints.
pub(super) struct Added<'a> {
    /// \[N m\]
    pub torque_nm: Rows<'a>,
    /// Implicit terms \[kg m^2\].
    pub diagonal_kg_m2: Option<Rows<'a>>,
    /// Of the groups; empty where no joint has one \[kg m^2\].
    pub rotors: &'a [Two],
}

#[inline(always)]
fn inward_part<L: Layout, const K: usize, const SHIFTED: bool, const ROTATED: bool>(
    group: &Group,
    part: usize,
    slot: &mut Slot<L::Number>,
    added: &Added<'_>,
    rotor: Option<&Two>,
) -> Handed<L::Number> {
    let constant = |two: &Two| L::constant(two, part);
    let torque = L::of_joints(group, part, &added.torque_nm) * constant(&group.sign);
    let diagonal = match (&added.diagonal_kg_m2, rotor) {
        (None, None) => L::Number::zero(),
        (None, Some(rotor)) => constant(rotor),
        (Some(diagonal), None) => L::of_joints(group, part, diagonal),
        (Some(diagonal), Some(rotor)) => L::of_joints(group, part, diagonal) + constant(rotor),
    };
    let column = slot.inertia.column::<K>();
    let inverse = (column.0[K] + diagonal).inverse();
    let gain = (column.0.map(|x| x * inverse), column.1.map(|x| x * inverse));
    let effort = torque - slot.bias.0[K];
    slot.drive = effort * inverse;
    let left = slot.inertia.minus_outer(column, gain);
    let along = left.times_across::<K>(slot.product);
    let bias =
        |k: usize| (slot.bias.0[k] + along.0[k] + gain.0[k] * effort, slot.bias.1[k] + along.1[k] + gain.1[k] * effort);
    let (b0, b1, b2) = (bias(0), bias(1), bias(2));
    slot.bias = gain;
    let turn = slot.turn();
    let mut inertia = left.seen_from_parent::<K>(&turn);
    let mut moment = turn.into_parent::<K>([b0.0, b1.0, b2.0]);
    let mut force = turn.into_parent::<K>([b0.1, b1.1, b2.1]);
    if ROTATED {
        let fixed = L::matrix(&group.fixed, part);
        inertia = inertia.rotated(&fixed);
        (moment, force) = (rotate(&fixed, moment), rotate(&fixed, force));
    }
    if SHIFTED {
        let offset = L::vector(&group.offset_m, part);
        inertia = inertia.shifted(offset);
        moment = add(moment, cross(offset, force));
    }
    Handed { inertia, moment, force }
}

/// Third pass: the joints' accelerations.
#[inline(always)]
fn onward<L: Layout, const K: usize, const SHIFTED: bool, const ROTATED: bool>(
    group: &Group,
    k: usize,
    slots: &mut [Slot<L::Number>],
    base: &BaseWork<L>,
    out: &mut [f64],
    freedoms: usize,
) {
    for part in 0..L::parts(group) {
        onward_part::<L, K, SHIFTED, ROTATED>(group, (k, part), slots, base, out, freedoms);
    }
}

#[inline(always)]
fn onward_part<L: Layout, const K: usize, const SHIFTED: bool, const ROTATED: bool>(
    group: &Group,
    (k, part): (usize, usize),
    slots: &mut [Slot<L::Number>],
    base: &BaseWork<L>,
    out: &mut [f64],
    freedoms: usize,
) {
    let above = L::above(group, part, slots, &base.acceleration, |slot| slot.motion);
    let slot = &mut slots[L::PARTS * k + part];
    let (angular, linear) = into_child::<L, K, SHIFTED, ROTATED>(group, part, slot, above);
    let (mut angular, linear) = (add(angular, slot.product.0), add(linear, slot.product.1));
    let (g, f) = (&slot.bias.0, &slot.bias.1);
    let against = (g[0] * angular[0] + g[1] * angular[1] + g[2] * angular[2])
        + (f[0] * linear[0] + f[1] * linear[1] + f[2] * linear[2]);
    let acceleration = slot.drive - against;
    angular[K] += acceleration;
    slot.motion = (angular, linear);
    L::write(group, part, acceleration * L::constant(&group.sign, part), out, freedoms);
}
