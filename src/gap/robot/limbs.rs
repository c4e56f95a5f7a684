//! Limbs of a clamped robot do not feel each other: what is changed of one is simulated on that alone.

use super::case::RobotCase;
use super::cause::Change;
use super::place::Place;
use super::scatter::{Number, Scatter};

/// Joints that are compared, by limb; all are one limb where the trunk is free.
pub(super) struct Limbs {
    joints: Vec<Vec<usize>>,
    /// Of every joint and of every body of the robot; `None` where nothing on it is compared.
    of_joint: Vec<Option<usize>>,
    of_body: Vec<Option<usize>>,
}

impl Limbs {
    pub fn of(case: &RobotCase, moving: &[usize]) -> Self {
        let model = case.model();
        let count = model.joints().len();
        if !case.is_clamped() {
            let of_body = vec![Some(0); model.bodies().len()];
            return Self { joints: vec![moving.to_vec()], of_joint: vec![Some(0); count], of_body };
        }
        let above = |joint: usize| model.joint_ids().nth(joint).and_then(|id| model.carrier(id).joint());
        let first = |joint: usize| {
            let mut at = joint;
            while let Some(above) = above(at) {
                at = above.index();
            }
            at
        };
        // Limbs of which one follows another are one.
        let mut of_first: Vec<usize> = (0..count).map(first).collect();
        for one in model.following() {
            let (from, to) = (of_first[one.follower], of_first[one.leader]);
            of_first.iter_mut().filter(|first| **first == from).for_each(|first| *first = to);
        }
        let root = |joint: usize| of_first[joint];
        let mut roots: Vec<usize> = moving.iter().map(|joint| root(*joint)).collect();
        roots.sort_unstable();
        roots.dedup();
        let of_joint: Vec<Option<usize>> = (0..count).map(|joint| roots.binary_search(&root(joint)).ok()).collect();
        let on = |limb| moving.iter().copied().filter(|joint| of_joint[*joint] == Some(limb)).collect();
        let joints = (0..roots.len()).map(on).collect();
        let of_body = model.body_ids().map(|body| body.joint().and_then(|joint| of_joint[joint.index()])).collect();
        Self { joints, of_joint, of_body }
    }

    /// Joints that are compared, by limb.
    pub fn joints(&self) -> &[Vec<usize>] {
        &self.joints
    }

    pub fn all(&self) -> Vec<usize> {
        (0..self.joints.len()).collect()
    }

    pub fn of_body(&self, body: usize) -> Option<usize> {
        self.of_body[body]
    }

    fn of_number(&self, number: Number) -> Option<usize> {
        match number {
            Number::Mass(body) => self.of_body[body],
            Number::Coulomb(joint) | Number::Viscous(joint) => self.of_joint[joint],
        }
    }

    /// Whether a number is one of some limbs'.
    pub fn have(&self, limbs: &[usize], number: Number) -> bool {
        self.of_number(number).is_some_and(|limb| limbs.contains(&limb))
    }

    /// Limbs with joints of some places, rising; all where one is the whole robot.
    pub fn of_places<'p>(&self, places: impl IntoIterator<Item = &'p Place>) -> Vec<usize> {
        let mut limbs = Vec::new();
        for place in places {
            if place.joints.is_empty() {
                return self.all();
            }
            limbs.extend(place.joints.iter().filter_map(|joint| self.of_joint[*joint]));
        }
        limbs.sort_unstable();
        limbs.dedup();
        limbs
    }

    /// Limbs of which something else is true than the study states; where there is one, that.
    pub fn touched(&self, scatter: &Scatter, changes: &[Change]) -> Vec<usize> {
        if self.joints.len() == 1 {
            return self.all();
        }
        let changed = self.of_places(changes.iter().map(|change| &change.place));
        let is_off = |limb: &usize| {
            let mass = scatter.mass.iter().zip(&self.of_body).any(|(mass, of)| *of == Some(*limb) && *mass != 1.0);
            let friction = scatter.friction.iter().zip(&self.of_joint);
            changed.contains(limb)
                || mass
                || friction.into_iter().any(|(more, of)| *of == Some(*limb) && *more != [0.0; 2])
        };
        self.all().into_iter().filter(is_off).collect()
    }

    /// Compared joints of some limbs, rising.
    pub fn joints_of(&self, limbs: &[usize]) -> Vec<usize> {
        let mut joints: Vec<usize> = limbs.iter().flat_map(|limb| self.joints[*limb].iter().copied()).collect();
        joints.sort_unstable();
        joints
    }
}
