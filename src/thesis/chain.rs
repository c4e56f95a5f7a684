//! Tables 3.2 and 3.3: the extensive model about q3, then q2, then q1, each mass held from then on (3.3.1).
//!
//! The thesis took averages of four tests. Beside them stands one fit to all swings of a joint, whose intervals allow
//! for the interval of the masses that were held.

use super::swings::{JointSwings, Load};
use super::{Of, Printed, Row, TablesError};
use crate::geometry::{LegJoint, LinkBody, straight_leg};
use crate::identify::{Experiment, ExtensiveModel, Fitted, JointModel, Named, Status};
use crate::number::math;
use rayon::prelude::*;

/// Tables 3.2 and 3.3 of one joint.
#[derive(Clone, Debug)]
pub struct Weighed {
    /// The joint.
    pub joint: LegJoint,
    /// The body that is weighed about this joint.
    pub body: LinkBody,
    /// Table 3.2: its mass.
    pub mass: Row,
    /// Table 3.3: Coulomb and viscous friction.
    pub friction: Vec<Row>,
    /// Mass and friction with one load at a time.
    pub by_load: Vec<Row>,
    /// Table 3.4: friction of the swings that the thesis chose, all masses held.
    pub chosen: Vec<Row>,
    /// The same joint as a lumped pendulum on a straight line (3.8-3.10): what that simplification adds.
    pub straight: Vec<Row>,
    /// The fit to all swings.
    pub fit: Fitted<ExtensiveModel>,
    /// RMS of the fit to all swings \[rad\].
    pub rms_rad: f64,
    /// Noise of the readings as their own roughness shows it \[rad\].
    pub noise_rad: f64,
}

impl Weighed {
    /// Whether the model leaves more than noise.
    pub fn lacks_something(&self) -> bool {
        self.rms_rad > STRUCTURED * self.noise_rad
    }
}

/// An RMS this many times the noise is more than noise.
const STRUCTURED: f64 = 1.1;
/// With lengths and masses of the bench known to this share only, an interval may be this wide at the most for its
/// parameter to count as identifiable.
const WIDEST: f64 = 0.25;

/// Parameters that are held: masses \[kg\], the encoder's zero \[rad\].
type Held = Vec<(Named, f64)>;

/// Tables 3.2 and 3.3 of all joints, in the order q1, q2, q3.
pub(super) fn weigh(swings: &[JointSwings], progress: &(dyn Fn(&str) + Sync)) -> Result<Vec<Weighed>, TablesError> {
    let mut weighed = Vec::new();
    let (mut by_tests, mut by_all): (Held, Held) = (Vec::new(), Vec::new());
    // What is held, with one of the held masses at the end of its interval, and all that follows from that.
    let mut at_the_ends: Vec<Held> = Vec::new();
    for joint in swings.iter().rev() {
        progress(&format!("extensive model, {}", joint.joint));
        let (tests, (all, ends)) = rayon::join(
            || single_tests(joint, &by_tests),
            || {
                rayon::join(
                    || joint.extensive(&joint.moving(), &by_all),
                    || {
                        at_the_ends
                            .par_iter()
                            .map(|held| joint.extensive(&joint.moving(), held))
                            .collect::<Result<Vec<_>, _>>()
                    },
                )
            },
        );
        let (tests, all, ends) = (tests?, all?, ends?);
        let body = weighed_body(joint)?;
        let mass_of = Named::Mass(body);
        let one = Joined { swings: joint, tests: &tests, all: &all, ends: &ends };
        let mass = one.mass(body);
        for (held, end) in at_the_ends.iter_mut().zip(&ends) {
            held.push((mass_of, value(end, mass_of)));
        }
        by_tests.push((mass_of, mass.average().unwrap_or_else(|| value(&all, mass_of))));
        let mut end = by_all.clone();
        by_all.push((mass_of, value(&all, mass_of)));
        if let Some([_, high]) = mass.interval {
            end.push((mass_of, high));
            at_the_ends.push(end);
        }
        let ((by_load, chosen), straight) = rayon::join(
            || rayon::join(|| by_load(joint, body, &by_all), || chosen(joint, &by_all)),
            || straight(joint, body, &by_all, &all),
        );
        let experiments = joint.moving();
        weighed.push(Weighed {
            joint: joint.joint,
            friction: one.friction(),
            body,
            mass,
            by_load: by_load?,
            chosen: chosen?,
            straight: straight?,
            rms_rad: all.rms_rad(&experiments),
            noise_rad: noise_rad(&all, &experiments),
            fit: all,
        });
    }
    weighed.reverse();
    Ok(weighed)
}

/// Each of the tests that the thesis took, alone, with the encoder's zero as the geometry has it.
fn single_tests(swings: &JointSwings, held: &Held) -> Result<Vec<Fitted<ExtensiveModel>>, TablesError> {
    let Some(load) = swings.thesis_choice() else { return Ok(Vec::new()) };
    let held: Held = held.iter().copied().chain([(Named::Zero, 0.0)]).collect();
    load.moving.par_iter().map(|test| swings.extensive(std::slice::from_ref(test), &held)).collect()
}

/// Everything that was fitted about one joint.
struct Joined<'a> {
    swings: &'a JointSwings,
    tests: &'a [Fitted<ExtensiveModel>],
    all: &'a Fitted<ExtensiveModel>,
    ends: &'a [Fitted<ExtensiveModel>],
}

impl Joined<'_> {
    fn mass(&self, body: LinkBody) -> Row {
        let (name, mass) = (body.to_string(), Named::Mass(body));
        let row = Row::new(Of::Body(name.clone()), "mass", "all", "kg", Printed::embedded().mass_kg(&name));
        let row = self.row(row, mass);
        let bench = self.all.model.parameters().iter().find(|p| p.named() == Some(mass)).map_or(0.0, |p| p.known_to);
        let half = row.relative_half_width().unwrap_or(f64::INFINITY);
        let with_bench = math::hypot(half, bench);
        if row.ours.is_some() && with_bench > WIDEST {
            let remark =
                format!("only as far as the bench is exact: 1 % in its lengths is {:.0} % here", 100.0 * bench);
            return Row { identifiable: false, remark, ..row };
        }
        row
    }

    fn friction(&self) -> Vec<Row> {
        let printed = Printed::embedded().estimated(self.swings.joint);
        let of = || Of::Joint(self.swings.joint.to_string());
        vec![
            self.row(Row::new(of(), "coulomb", "all", "N m", printed.map(|p| p.coulomb_nm)), Named::Coulomb),
            self.row(
                Row::new(of(), "viscous", "all", "N m s/rad", printed.map(|p| p.viscous_nm_s_rad)),
                Named::Viscous,
            ),
        ]
    }

    /// The estimate of all swings, its interval widened by what the held masses leave open.
    fn row(&self, row: Row, named: Named) -> Row {
        let determined =
            |fit: &&Fitted<ExtensiveModel>| fit.estimate(named).is_some_and(|e| e.status == Status::Determined);
        let tests = self.tests.iter().filter(determined).map(|fit| value(fit, named)).collect();
        let row = Row { tests, ..with_estimate(row, self.all, named) };
        let (Some(ours), Some([low, high])) = (row.ours, row.interval) else { return row };
        let shift: f64 = self.ends.iter().map(|end| (value(end, named) - ours).powi(2)).sum();
        let widened = [ours - math::hypot(ours - low, shift.sqrt()), ours + math::hypot(high - ours, shift.sqrt())];
        Row { interval: Some(widened), ..row }
    }
}

fn with_estimate(row: Row, fit: &Fitted<ExtensiveModel>, named: Named) -> Row {
    let Some(e) = fit.estimate(named) else { return row };
    match (e.status, e.interval) {
        (Status::Determined, Some(interval)) => row.estimated(e.value, interval),
        (Status::Held, _) => Row { ours: Some(e.value), remark: "held".into(), ..row },
        _ => Row { remark: "not determined".into(), ..row },
    }
}

fn value(fit: &Fitted<ExtensiveModel>, named: Named) -> f64 {
    fit.estimate(named).map_or(f64::NAN, |e| e.value)
}

/// The body that is weighed about a joint: the first of those that swing (3.3.1).
fn weighed_body(swings: &JointSwings) -> Result<LinkBody, TablesError> {
    let first = swings.leg()?.masses()?.into_iter().find(|m| m.free);
    first.map(|m| m.body).ok_or(TablesError::NoPose { joint: swings.joint })
}

/// Mass and friction with one load at a time; the other masses are held.
fn by_load(swings: &JointSwings, weighed: LinkBody, held: &Held) -> Result<Vec<Row>, TablesError> {
    let others: Held = held.iter().filter(|(named, _)| *named != Named::Mass(weighed)).copied().collect();
    let loads: Vec<&Load> = swings.loads.iter().filter(|load| !load.moving.is_empty()).collect();
    let fits = loads
        .par_iter()
        .map(|load| swings.extensive(&load.moving, &others))
        .collect::<Result<Vec<_>, TablesError>>()?;
    let printed = Printed::embedded();
    let friction = printed.estimated(swings.joint);
    let body = weighed.to_string();
    let rows = loads.iter().zip(&fits).flat_map(|(load, fit)| {
        let joint = || Of::Joint(swings.joint.to_string());
        let row = |of, quantity, unit, thesis, named: Named| {
            with_estimate(Row::new(of, quantity, &load.name, unit, thesis), fit, named)
        };
        [
            row(Of::Body(body.clone()), "mass", "kg", printed.mass_kg(&body), Named::Mass(weighed)),
            row(joint(), "coulomb", "N m", friction.map(|f| f.coulomb_nm), Named::Coulomb),
            row(joint(), "viscous", "N m s/rad", friction.map(|f| f.viscous_nm_s_rad), Named::Viscous),
        ]
    });
    Ok(rows.collect())
}

/// Table 3.4: friction of the swings that the thesis chose, with all masses held.
fn chosen(swings: &JointSwings, held: &Held) -> Result<Vec<Row>, TablesError> {
    let Some(load) = swings.thesis_choice() else { return Ok(Vec::new()) };
    let fit = swings.extensive(&load.moving, held)?;
    let printed = Printed::embedded().chosen(swings.joint);
    let of = || Of::Joint(swings.joint.to_string());
    let rows = [
        (Named::Coulomb, "N m", printed.map(|p| p.coulomb_nm)),
        (Named::Viscous, "N m s/rad", printed.map(|p| p.viscous_nm_s_rad)),
    ];
    let row = |(named, unit, thesis): (Named, _, _)| {
        with_estimate(Row::new(of(), named.name(), &load.name, unit, thesis), &fit, named)
    };
    Ok(rows.into_iter().map(row).collect())
}

/// The same swings fitted by the thesis's own lump, bodies and extra mass on one line that hangs straight down; the
/// difference to the exact leg stands where the tables have the thesis.
fn straight(
    swings: &JointSwings,
    weighed: LinkBody,
    held: &Held,
    exact: &Fitted<ExtensiveModel>,
) -> Result<Vec<Row>, TablesError> {
    let leg = swings.leg()?;
    let robot = crate::geometry::Ers7Tables::embedded();
    let lump = straight_leg(robot, leg.leg, leg.joint, swings.case.joint.gravity_m_s2, None)?;
    let hanging_rad = leg.bare()?.rest_rad;
    let straighten = |mut e: Experiment| {
        for (body, line) in e.bodies.iter_mut().zip(&lump.bodies) {
            body.inertia_per_kg_m2 = line.inertia_per_kg_m2;
            body.lever_m = line.distance_m();
            body.hanging_rad = hanging_rad;
        }
        if let Some(load) = &mut e.load {
            load.hanging_rad = hanging_rad;
        }
        e
    };
    let experiments: Vec<Experiment> = swings.moving().into_iter().map(straighten).collect();
    let others: Held = held.iter().filter(|(named, _)| *named != Named::Mass(weighed)).copied().collect();
    let fit = swings.extensive(&experiments, &others)?;
    let of = |quantity: &str| match quantity {
        "mass" => Of::Body(weighed.to_string()),
        _ => Of::Joint(swings.joint.to_string()),
    };
    let rows = [
        ("mass", "kg", Named::Mass(weighed)),
        ("coulomb", "N m", Named::Coulomb),
        ("viscous", "N m s/rad", Named::Viscous),
    ];
    let row = |(quantity, unit, named): (&str, &str, Named)| {
        let beside = exact.estimate(named).filter(|e| e.status == Status::Determined).map(|e| e.value);
        with_estimate(Row::new(of(quantity), quantity, "all", unit, beside), &fit, named)
    };
    Ok(rows.into_iter().map(row).collect())
}

/// Noise of the readings from the second differences of the residuals: of white noise they have six times its variance,
/// of a smooth misfit hardly any.
fn noise_rad(fit: &Fitted<ExtensiveModel>, experiments: &[Experiment]) -> f64 {
    let (mut squares, mut count) = (0.0, 0usize);
    for (prediction, e) in fit.predictions.iter().zip(experiments) {
        let residual = |k: usize| e.measured_rad[k] - prediction.angle_rad[k];
        for k in e.uncompared + 2..e.t_s.len() {
            squares += (residual(k) - 2.0 * residual(k - 1) + residual(k - 2)).powi(2);
            count += 1;
        }
    }
    (squares / (6 * count.max(1)) as f64).sqrt()
}
