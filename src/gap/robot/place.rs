//! Where on a robot a cause may sit: on a joint, on a pair, on all joints of a kind, on all joints.

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

/// All places over joints that are given with their names: singles, left-right and front-rear pairs by names like `lf2`
/// (side, end, number), all joints of a number, all joints; fewest joints first.
pub(super) fn places(joints: &[(usize, &str)]) -> Vec<Place> {
    let mut places: Vec<Place> = joints.iter().map(|(joint, _)| Place::joint(*joint)).collect();
    let legs: Vec<(usize, OfLeg<'_>)> =
        joints.iter().filter_map(|(joint, name)| Some((*joint, of_leg(name)?))).collect();
    for (k, (a, of_a)) in legs.iter().enumerate() {
        for (b, of_b) in &legs[k + 1..] {
            if of_a.number == of_b.number && (of_a.side == of_b.side) != (of_a.end == of_b.end) {
                places.push(Place { joints: vec![*a, *b] });
            }
        }
    }
    let mut numbers: Vec<&str> = legs.iter().map(|(_, of)| of.number).collect();
    numbers.sort_unstable();
    numbers.dedup();
    let of_number = |number: &str| legs.iter().filter(|(_, of)| of.number == number).map(|(joint, _)| *joint).collect();
    places.extend(numbers.into_iter().map(|number| Place { joints: of_number(number) }));
    places.push(Place { joints: joints.iter().map(|(joint, _)| *joint).collect() });
    for place in &mut places {
        place.joints.sort_unstable();
    }
    places.retain(|place| !place.joints.is_empty());
    places.sort_by(|a, b| a.joints.len().cmp(&b.joints.len()).then_with(|| a.joints.cmp(&b.joints)));
    places.dedup();
    places
}

/// A leg's joint by its name.
struct OfLeg<'a> {
    side: char,
    end: char,
    number: &'a str,
}

fn of_leg(name: &str) -> Option<OfLeg<'_>> {
    let mut letters = name.chars();
    let (side, end, number) = (letters.next()?, letters.next()?, letters.as_str());
    let is_leg = "lr".contains(side) && "fr".contains(end) && !number.is_empty();
    (is_leg && number.bytes().all(|byte| byte.is_ascii_digit())).then_some(OfLeg { side, end, number })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn twelve_joints_of_four_legs_have_twenty_eight_places() {
        let names: Vec<String> =
            ["lf", "rf", "lr", "rr"].iter().flat_map(|leg| (1..=3).map(move |k| format!("{leg}{k}"))).collect();
        let joints: Vec<(usize, &str)> = names.iter().enumerate().map(|(k, name)| (k, name.as_str())).collect();
        let places = places(&joints);
        let count = |n| places.iter().filter(|place| place.joints.len() == n).count();
        assert_eq!([count(1), count(2), count(4), count(12)], [12, 12, 3, 1]);
        assert!(places.contains(&Place { joints: vec![1, 4] }), "lf2 and rf2");
        assert!(!places.contains(&Place { joints: vec![1, 10] }), "lf2 and rr2 are across");
    }

    #[test]
    fn other_names_have_singles_and_all() {
        assert_eq!(places(&[(0, "hip"), (1, "knee")]).len(), 3);
        assert_eq!(places(&[(4, "neck_tilt1")]), [Place::joint(4)]);
    }
}
