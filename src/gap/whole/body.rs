//! A body that torques along the measured motion ask for, with the mass and the place at which the whole robot follows its
//! logs best: torques of servos that are only stated tell these roughly.

use super::common::explains;
use super::numbers::{found_robot, of_body};
use super::robot::PlacedCause;
use super::settled::{Settled, settled};
use super::unknown::is_body;
use crate::deadline::Deadline;
use crate::gap::Number;
use crate::gap::clamped::{BodyCause, BodyKind, ClampedDiagnosis, ClampedSetup};
use crate::number::chance::HALF_95;
use crate::number::math;
use crate::robot::description::{BodyChange, FoundNumber};
use nalgebra::Vector3;

/// A body as the whole robot has it.
pub(in crate::gap) struct BodyAtBest {
    pub body: BodyCause,
    /// Numbers of the robot beside it; where it hangs on a link it is the last of them.
    pub numbers: Vec<FoundNumber>,
    /// What is left of the joints that move, as a geometric mean \[rad\].
    pub left_rad: f64,
    /// Whether it leaves only noise of every joint.
    pub explains: bool,
}

/// A body where the whole robot is at its best with it beside causes; `None` where that cannot be simulated. `diagnosis`
/// knows the joints' noise.
pub(in crate::gap) fn body_at_best(
    setup: &ClampedSetup,
    body: &BodyCause,
    causes: &[PlacedCause],
    diagnosis: &ClampedDiagnosis,
    deadline: &Deadline,
) -> Option<BodyAtBest> {
    let mut numbers = found_robot(setup, None).ok()?.numbers;
    let of_torques = of_body(body, &setup.description);
    numbers.push(of_torques.clone());
    let whole = settled(setup, &numbers, causes, deadline)?;
    let is_own = |number: &&FoundNumber| number.key == of_torques.key && number.name == of_torques.name;
    let own = whole.numbers.iter().find(is_own)?;
    if whole.left_rad.is_empty() {
        return None;
    }
    let logs: f64 = whole.left_rad.iter().map(|(_, left)| math::ln(*left)).sum();
    let mut numbers = whole.numbers_but_causes();
    numbers.retain(|number| !is_own(&number));
    // What hangs on a link comes after the link's own mass.
    numbers.extend(is_body(own).then(|| own.clone()));
    Some(BodyAtBest {
        body: moved(setup, body, own, &whole),
        numbers,
        left_rad: math::exp(logs / whole.left_rad.len() as f64),
        explains: explains(&whole, diagnosis),
    })
}

/// A body as the whole robot has it.
fn moved(setup: &ClampedSetup, body: &BodyCause, own: &FoundNumber, whole: &Settled) -> BodyCause {
    let inertia = &setup.description.links[body.link.0].inertia;
    let place_m = Vector3::from(own.place_m.unwrap_or_default());
    let change = match body.kind {
        BodyKind::Payload => BodyChange::Payload { mass_kg: own.value, place_m },
        BodyKind::BodyMass => BodyChange::Mass { factor: own.value / inertia.mass_kg },
        BodyKind::BodyCom => BodyChange::Centre { shift_m: place_m - inertia.centre_m() },
    };
    let around = |at: f64, sd: Option<f64>| sd.map(|sd| [-HALF_95, HALF_95].map(|side| at + side * sd));
    let not_negative = |range: [f64; 2]| range.map(|end| end.max(0.0));
    let places = |sd: &[Option<f64>]| -> Vec<(f64, Option<[f64; 2]>)> {
        place_m.iter().zip(sd).map(|(at, sd)| (*at, around(*at, *sd))).collect()
    };
    let told: Vec<(f64, Option<[f64; 2]>)> = match (body.kind, &whole.body_sd[..]) {
        (BodyKind::Payload, [of_mass, of_place @ ..]) => {
            let mass = (own.value, around(own.value, *of_mass).map(not_negative));
            [vec![mass], places(of_place)].concat()
        }
        (BodyKind::BodyCom, of_place) => places(of_place),
        _ => vec![(own.value, own.interval)],
    };
    let parameters = body.parameters.iter().zip(told).map(|(number, (value, interval))| Number {
        value,
        interval,
        interval_naive: interval,
        ..number.clone()
    });
    BodyCause { change, parameters: parameters.collect(), ..body.clone() }
}
