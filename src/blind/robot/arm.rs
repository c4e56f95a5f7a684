//! Arms made at random: a tree of three to six joints with servos, as a description, and motions of all joints.

use crate::blind::dice::{Dice, significant};
use crate::number::STANDARD_GRAVITY_M_S2;
use std::fmt::Write as _;

/// File of the description.
pub(super) const FILE: &str = "arm.urdf";
/// Fewest and most joints.
const JOINTS: [usize; 2] = [3, 6];
/// How often a link hangs on the one before it, and not on any earlier one.
const IN_A_ROW: f64 = 0.8;
/// Lengths \[m\] and mass \[kg\] of the first link; the others are lighter by this factor each.
const LENGTH_M: [f64; 2] = [0.08, 0.3];
const MASS_KG: [f64; 2] = [0.3, 2.5];
const LIGHTER: f64 = 0.7;
/// A link is so thick, as a share of its length.
const THICK: f64 = 0.15;
/// What drives a joint has this inertia, as a share of what it carries.
const ARMATURE: [f64; 2] = [0.1, 0.6];
/// A servo sags so far under the greatest load \[rad\], and is damped so well.
const SAG_RAD: [f64; 2] = [0.03, 0.12];
const DAMPING: [f64; 2] = [0.4, 1.0];
/// Friction as a share of that load, and viscous friction as one of the servo's damping.
const COULOMB: [f64; 2] = [0.02, 0.12];
const VISCOUS: [f64; 2] = [0.05, 0.3];
/// What a motor can do beyond that load.
const EFFORT: f64 = 4.0;

/// A joint with the link that it moves.
struct Link {
    /// The link before it; `None`: the base.
    on: Option<usize>,
    length_m: f64,
    mass_kg: f64,
    axis: &'static str,
    side_m: f64,
    /// Load that it bears at the most \[N m\], and the inertia that goes with it \[kg m^2\].
    load_nm: f64,
    inertia_kg_m2: f64,
    armature_kg_m2: f64,
    kp_nm_rad: f64,
    kd_nm_s_rad: f64,
    /// Coulomb \[N m\] and viscous friction \[N m s/rad\].
    friction: [f64; 2],
    range_rad: f64,
    speed_rad_s: f64,
}

/// An arm with servos.
pub(super) struct Arm {
    links: Vec<Link>,
}

impl Arm {
    pub fn draw(dice: &mut Dice) -> Self {
        let count = dice.whole(JOINTS[0], JOINTS[1]);
        let first_kg = dice.log_uniform(MASS_KG[0], MASS_KG[1]);
        let one = |k: usize| {
            let on = if k == 0 || dice.chance(IN_A_ROW) { k.checked_sub(1) } else { Some(dice.whole(0, k - 1)) };
            Link {
                on,
                length_m: significant(dice.log_uniform(LENGTH_M[0], LENGTH_M[1]), 3),
                mass_kg: significant(first_kg * LIGHTER.powi(k as i32) * dice.log_uniform(0.8, 1.25), 3),
                axis: dice.pick(&["1 0 0", "0 1 0", "0 1 0", "0 0 1"]),
                side_m: significant(dice.uniform(-0.02, 0.02), 2),
                load_nm: 0.0,
                inertia_kg_m2: 0.0,
                armature_kg_m2: 0.0,
                kp_nm_rad: 0.0,
                kd_nm_s_rad: 0.0,
                friction: [0.0; 2],
                range_rad: significant(dice.uniform(1.2, 2.6), 3),
                speed_rad_s: significant(dice.uniform(3.0, 8.0), 2),
            }
        };
        let mut links: Vec<Link> = (0..count).map(one).collect();
        for k in (0..count).rev() {
            // As far from the joint as a link can be.
            let mut at = Some(k);
            let mut out_m = 0.5 * links[k].length_m;
            while let Some(joint) = at {
                let mass_kg = links[k].mass_kg;
                links[joint].load_nm += STANDARD_GRAVITY_M_S2 * mass_kg * out_m;
                links[joint].inertia_kg_m2 += mass_kg * out_m * out_m;
                at = links[joint].on;
                out_m += at.map_or(0.0, |before| links[before].length_m);
            }
        }
        for link in &mut links {
            let mut within = |[low, high]: [f64; 2]| dice.log_uniform(low, high);
            link.armature_kg_m2 = significant(within(ARMATURE) * link.inertia_kg_m2, 2);
            link.kp_nm_rad = significant(link.load_nm / within(SAG_RAD), 3);
            let moved_kg_m2 = link.inertia_kg_m2 + link.armature_kg_m2;
            link.kd_nm_s_rad = significant(2.0 * within(DAMPING) * (link.kp_nm_rad * moved_kg_m2).sqrt(), 2);
            link.friction = [within(COULOMB) * link.load_nm, within(VISCOUS) * link.kd_nm_s_rad];
            link.friction = link.friction.map(|number| significant(number, 2));
        }
        Self { links }
    }

    /// `arm of 4 joints, 2.1 kg`
    pub fn words(&self) -> String {
        format!("arm of {} joints, {:.1} kg", self.links.len(), self.mass_kg())
    }

    pub fn mass_kg(&self) -> f64 {
        self.links.iter().map(|link| link.mass_kg).sum()
    }

    /// Load of the joint in the middle of all \[N m\].
    pub fn load_nm(&self) -> f64 {
        let mut loads: Vec<f64> = self.links.iter().map(|link| link.load_nm).collect();
        loads.sort_by(f64::total_cmp);
        loads[loads.len() / 2]
    }

    /// Coulomb \[N m\] and viscous friction \[N m s/rad\] by joint.
    pub fn friction(&self) -> impl Iterator<Item = (String, [f64; 2])> {
        self.links.iter().enumerate().map(|(k, link)| (joint(k), link.friction))
    }

    /// The description.
    pub fn urdf(&self) -> String {
        let mut text = "<robot name=\"arm\"><link name=\"base\"/>\n".to_owned();
        for (k, link) in self.links.iter().enumerate() {
            let (mass, length, half) = (link.mass_kg, link.length_m, 0.5 * link.length_m);
            let thick = THICK * length;
            let [across, along] = [mass * (3.0 * thick * thick + length * length) / 12.0, 0.5 * mass * thick * thick];
            let parent = link.on.map_or_else(|| "base".to_owned(), |on| format!("link{}", on + 1));
            let at = link.on.map_or(0.0, |on| self.links[on].length_m);
            let [coulomb, viscous] = link.friction;
            let (name, range, effort, speed) = (joint(k), link.range_rad, EFFORT * link.load_nm, link.speed_rad_s);
            let _ = write!(
                text,
                "<link name=\"link{n}\"><inertial><origin xyz=\"{side} 0 {half}\"/><mass value=\"{mass}\"/>\n  \
                 <inertia ixx=\"{across}\" iyy=\"{across}\" izz=\"{along}\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>\n\
                 <joint name=\"{name}\" type=\"revolute\"><parent link=\"{parent}\"/><child link=\"link{n}\"/>\n  \
                 <origin xyz=\"0 0 {at}\"/><axis xyz=\"{axis}\"/><dynamics damping=\"{viscous}\" friction=\"{coulomb}\"/>\n  \
                 <limit lower=\"-{range}\" upper=\"{range}\" effort=\"{effort}\" velocity=\"{speed}\"/></joint>\n",
                n = k + 1,
                side = link.side_m,
                axis = link.axis,
            );
        }
        text + "</robot>\n"
    }

    /// The servos, as a study has them.
    pub fn servos(&self) -> String {
        let servo = |(k, link): (usize, &Link)| {
            let Link { kp_nm_rad, kd_nm_s_rad, armature_kg_m2, .. } = link;
            format!("[joints.{}]\nkp = {kp_nm_rad}\nkd = {kd_nm_s_rad}\narmature = {armature_kg_m2}\n", joint(k))
        };
        self.links.iter().enumerate().map(servo).collect()
    }
}

fn joint(k: usize) -> String {
    format!("joint{}", k + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::description::Description;

    #[test]
    fn arms_are_descriptions_whose_servos_hold_them() {
        let folder = tempfile::tempdir().unwrap();
        for trial in 0..20 {
            let arm = Arm::draw(&mut Dice::new(5, trial));
            assert!((3..=6).contains(&arm.links.len()));
            let file = folder.path().join(FILE);
            std::fs::write(&file, arm.urdf()).unwrap();
            let read = Description::read(&file).unwrap();
            assert_eq!((read.joints.len(), read.warnings.len()), (arm.links.len(), 0), "{:?}", read.warnings);
            assert!(arm.links.iter().all(|link| link.load_nm > 0.0 && link.load_nm < 0.2 * link.kp_nm_rad));
        }
    }
}
