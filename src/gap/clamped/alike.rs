//! Joints that are of one kind, as the legs of a dog are.

use crate::robot::description::{Description, LinkId, MoverId};
use std::collections::BTreeMap;

/// Masses that differ by less than this share are those of joints of one kind.
const ALIKE: f64 = 0.02;

/// Joints that the tree's symmetry makes alike: as far from the base, moving as much, and carrying as much.
pub(super) fn alike(description: &Description) -> BTreeMap<String, Vec<String>> {
    let carried = |joint: MoverId| -> f64 {
        let carries = |k: &usize| description.carriers(LinkId(*k)).contains(&joint);
        (0..description.links.len()).filter(carries).map(|k| description.links[k].inertia.mass_kg).sum()
    };
    let near = |a: f64, b: f64| (a - b).abs() <= ALIKE * a.abs().max(b.abs());
    let mut kinds: Vec<(usize, f64, f64, Vec<String>)> = Vec::new();
    for (k, joint) in description.joints.iter().enumerate() {
        let depth = description.carriers(joint.link).iter().position(|own| own.0 == k).unwrap_or(0);
        let (own, all) = (description.links[joint.link.0].inertia.mass_kg, carried(MoverId(k)));
        let kind = kinds.iter_mut().find(|kind| kind.0 == depth && near(kind.1, own) && near(kind.2, all));
        match kind {
            Some(kind) if all > 0.0 => kind.3.push(joint.name.clone()),
            _ => kinds.push((depth, own, all, vec![joint.name.clone()])),
        }
    }
    let several = kinds.into_iter().map(|kind| kind.3).filter(|joints| joints.len() > 1);
    several.map(|joints| (joints.join(", "), joints)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::RobotTables;
    use std::path::Path;

    #[test]
    fn legs_of_one_make_are_found_from_the_tree() {
        let tables = RobotTables::from_toml(Path::new("e.toml"), include_str!("../../../data/ers7.toml")).unwrap();
        let groups = alike(&Description::of_tables(&tables, Path::new("e.toml")));
        let knees: Vec<&Vec<String>> = groups.values().filter(|joints| joints.iter().any(|j| j == "lf3")).collect();
        assert_eq!(knees.len(), 1, "{groups:?}");
        assert!(["lf3", "rf3"].iter().all(|name| knees[0].iter().any(|own| own == name)), "{groups:?}");
    }
}
