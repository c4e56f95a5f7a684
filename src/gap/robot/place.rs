//! Where on a robot a cause may sit: on a joint, on a pair, on all joints of a kind, on all joints.

use crate::robot::{BodyId, Dynamics, JointId, Model, State};

/// Joints that share a cause, by place in the model's order and rising; none: the whole robot.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Place {
    /// Places in the model's joint order.
    pub joints: Vec<usize>,
}

impl Place {
    /// The whole robot: its trunk, or the floor.
    pub fn robot() -> Self {
        Self { joints: Vec::new() }
    }

    /// One joint.
    pub fn joint(joint: usize) -> Self {
        Self { joints: vec![joint] }
    }

    /// Names of its joints.
    pub fn names(&self, all: &[String]) -> Vec<String> {
        self.joints.iter().map(|joint| all[*joint].clone()).collect()
    }
}

/// All places over joints of a robot: singles, left-right and front-rear pairs of legs, all joints that are as far down a leg,
/// all joints; fewest joints first.
pub(super) fn places(model: &Model, joints: &[usize]) -> Vec<Place> {
    let mut places: Vec<Place> = joints.iter().map(|joint| Place::joint(*joint)).collect();
    let of = of_legs(model);
    let legs: Vec<(usize, OfLeg)> = joints.iter().filter_map(|joint| Some((*joint, of[*joint]?))).collect();
    for (k, (a, of_a)) in legs.iter().enumerate() {
        for (b, of_b) in &legs[k + 1..] {
            let is_one_side = of_a.is_left == of_b.is_left;
            if of_a.depth == of_b.depth && is_one_side != (of_a.is_front == of_b.is_front) {
                places.push(Place { joints: vec![*a, *b] });
            }
        }
    }
    let deepest = legs.iter().map(|(_, of)| of.depth).max().unwrap_or(0);
    let at_depth = |depth: usize| legs.iter().filter(|(_, of)| of.depth == depth).map(|(joint, _)| *joint).collect();
    places.extend((0..=deepest).map(|depth| Place { joints: at_depth(depth) }));
    places.push(Place { joints: joints.to_vec() });
    for place in &mut places {
        place.joints.sort_unstable();
    }
    places.retain(|place| !place.joints.is_empty());
    places.sort_by(|a, b| a.joints.len().cmp(&b.joints.len()).then_with(|| a.joints.cmp(&b.joints)));
    places.dedup();
    places
}

/// Where on a robot's legs a joint is.
#[derive(Clone, Copy)]
struct OfLeg {
    is_left: bool,
    is_front: bool,
    /// Joints of the leg above it.
    depth: usize,
}

/// Feet that differ by less in how far to the front they are stand abreast \[m\].
const ABREAST_M: f64 = 1e-3;

/// Of each joint where it is on a leg, by where the foot is that it carries in the pose of rest; what carries several feet is
/// of no leg.
fn of_legs(model: &Model) -> Vec<Option<OfLeg>> {
    let mut dynamics = Dynamics::new(model);
    let motions = dynamics.motions(&State::at_rest(model));
    let up_from = |joint: JointId| std::iter::successors(Some(joint), |id| model.carrier(*id).joint());
    let stands = |body: &BodyId| model.bodies()[body.index()].touches_floor();
    let foot = |body: BodyId| {
        let at_m = motions[body.index()].point_m(&model.bodies()[body.index()].foot_m());
        Some((body.joint()?, at_m))
    };
    let feet: Vec<_> = model.body_ids().filter(stands).filter_map(foot).collect();
    let middle_m = feet.iter().map(|(_, at)| at.z).sum::<f64>() / feet.len().max(1) as f64;
    let carried = |joint: JointId| -> Vec<usize> {
        (0..feet.len()).filter(|foot| up_from(feet[*foot].0).any(|above| above == joint)).collect()
    };
    let of = |joint: JointId| {
        let own = carried(joint);
        let [foot] = own[..] else { return None };
        let depth = up_from(joint).skip(1).filter(|above| carried(*above) == own).count();
        let at = feet[foot].1;
        Some(OfLeg { is_left: at.x < 0.0, is_front: at.z < middle_m - ABREAST_M, depth })
    };
    model.joint_ids().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twelve_joints_of_four_legs_have_twenty_eight_places() {
        let model = Model::ers7();
        let at = |name: &str| model.joint(name).unwrap().index();
        let legs = ["lf", "rf", "lr", "rr"].iter().flat_map(|leg| (1..=3).map(move |k| at(&format!("{leg}{k}"))));
        let places = places(model, &legs.collect::<Vec<_>>());
        let count = |n| places.iter().filter(|place| place.joints.len() == n).count();
        assert_eq!([count(1), count(2), count(4), count(12)], [12, 12, 3, 1]);
        let pair = |a: &str, b: &str| {
            let mut joints = vec![at(a), at(b)];
            joints.sort_unstable();
            places.contains(&Place { joints })
        };
        assert!(pair("lf2", "rf2") && pair("lf2", "lr2"));
        assert!(!pair("lf2", "rr2"), "they are across");
    }

    #[test]
    fn joints_of_no_leg_have_singles_and_all() {
        let model = Model::ers7();
        let at = |name: &str| model.joint(name).unwrap().index();
        assert_eq!(places(model, &[at("neck_tilt1"), at("mouth")]).len(), 3);
        assert_eq!(places(model, &[at("mouth")]), [Place::joint(at("mouth"))]);
    }
}
