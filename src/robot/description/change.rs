//! A description with one of its bodies changed: the one place where that is written.

use super::{Description, LinkId, RigidInertia};
use nalgebra::{Isometry3, Matrix3, Translation3, UnitQuaternion, Vector3};

/// What may be other than described about a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BodyChange {
    /// Something small hangs on it.
    Payload {
        /// \[kg\]
        mass_kg: f64,
        /// In the link's frame \[m\].
        place_m: Vector3<f64>,
    },
    /// It is so many times as heavy, its shape as described.
    Mass {
        /// Of what is described.
        factor: f64,
    },
    /// Its centre of mass lies elsewhere.
    Centre {
        /// By so much, in the link's frame \[m\].
        shift_m: Vector3<f64>,
    },
}

impl Description {
    /// The same robot with a link changed.
    #[must_use]
    pub fn with_change(&self, link: LinkId, change: &BodyChange) -> Self {
        let mut changed = self.clone();
        let inertia = &mut changed.links[link.0].inertia;
        let at = |place: Vector3<f64>| Isometry3::from_parts(Translation3::from(place), UnitQuaternion::identity());
        match *change {
            BodyChange::Payload { mass_kg, place_m } => {
                *inertia += RigidInertia::about_centre(mass_kg, &Matrix3::zeros(), &at(place_m));
            }
            BodyChange::Mass { factor } => *inertia = inertia.scaled(factor),
            BodyChange::Centre { shift_m } => {
                let centre = at(inertia.centre_m() + shift_m);
                *inertia = RigidInertia::about_centre(inertia.mass_kg, &inertia.central_kg_m2(), &centre);
            }
        }
        changed
    }

    /// Joints that carry a link, the nearest to the base first.
    pub fn carriers(&self, link: LinkId) -> Vec<super::MoverId> {
        let mut joints = Vec::new();
        let mut at = Some(link);
        while let Some(LinkId(k)) = at {
            joints.extend(self.links[k].joints.iter().rev());
            at = self.links[k].parent;
        }
        joints.reverse();
        joints
    }

    /// The heaviest link of each body that moves: links that no joint parts are one body.
    pub fn heaviest(&self) -> Vec<LinkId> {
        let mut heaviest: Vec<(Vec<super::MoverId>, LinkId)> = Vec::new();
        for (k, link) in self.links.iter().enumerate() {
            let carriers = self.carriers(LinkId(k));
            if carriers.is_empty() || link.inertia.mass_kg <= 0.0 {
                continue;
            }
            match heaviest.iter_mut().find(|(known, _)| *known == carriers) {
                Some((_, other)) if self.links[other.0].inertia.mass_kg < link.inertia.mass_kg => *other = LinkId(k),
                Some(_) => {}
                None => heaviest.push((carriers, LinkId(k))),
            }
        }
        heaviest.into_iter().map(|(_, link)| link).collect()
    }

    /// The link at the end of the longest chain of joints; of several the last.
    pub fn tip(&self) -> Option<LinkId> {
        let depth = |k: &usize| self.carriers(LinkId(*k)).len();
        let carried = (0..self.links.len()).filter(|k| depth(k) > 0);
        carried.max_by_key(depth).map(LinkId)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::RobotTables;
    use approx::assert_relative_eq;
    use std::path::Path;

    fn ers7() -> Description {
        let tables = RobotTables::from_toml(Path::new("ers7.toml"), include_str!("../../../data/ers7.toml")).unwrap();
        Description::of_tables(&tables, Path::new("ers7.toml"))
    }

    #[test]
    fn changes_are_those_of_mass_and_centre() {
        let robot = ers7();
        let link = robot.tip().unwrap();
        assert!(robot.carriers(link).len() >= 3);
        let was = robot.links[link.0].inertia;
        let of = |change| robot.with_change(link, &change).links[link.0].inertia;
        let heavy = of(BodyChange::Mass { factor: 1.2 });
        assert_relative_eq!(heavy.mass_kg, 1.2 * was.mass_kg, max_relative = 1e-12);
        assert_relative_eq!(heavy.centre_m(), was.centre_m(), epsilon = 1e-12);
        let shift_m = Vector3::new(0.01, -0.02, 0.005);
        let moved = of(BodyChange::Centre { shift_m });
        assert_relative_eq!(moved.centre_m(), was.centre_m() + shift_m, epsilon = 1e-12);
        assert_relative_eq!(moved.central_kg_m2(), was.central_kg_m2(), epsilon = 1e-12);
        let loaded = of(BodyChange::Payload { mass_kg: 0.1, place_m: was.centre_m() });
        assert_relative_eq!(loaded.central_kg_m2(), was.central_kg_m2(), epsilon = 1e-12);
    }
}
