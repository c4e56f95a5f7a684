//! The true robot: the believed one with everything that is true instead.

use super::error::{Blame, SynthError};
use super::joint;
use super::spec::{Believed, EffectSpec, FloorTruth, JointBench, JointChoice, MassScale, Spec, TruthSpec};
use crate::integrate::{self, Tolerance};
use crate::joint::{EffectForm, EffectId, Stage};
use crate::log::{FloorSpec, RobotStudy};
use crate::robot::simulate::{Joints, Method, standard_normal};
use crate::robot::study::floor_of;
use crate::robot::{BodyId, Floor, JointId, Model, Nominal, Touching};
use nalgebra::Vector3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use serde::Serialize;
use std::collections::BTreeMap;

/// What is true of the logs that were made.
#[derive(Clone, Debug, Serialize)]
pub struct Truth {
    /// 1
    pub schema: u32,
    /// The spec's.
    pub seed: u64,
    /// What the spec states.
    pub stated: TruthSpec,
    /// Effects with their joints.
    pub effects: Vec<TrueEffect>,
    /// Masses, payload included, by part \[kg\].
    pub mass_kg: BTreeMap<String, f64>,
    /// Friction by joint, effects not included.
    pub friction: BTreeMap<String, JointTruth>,
    /// The floor, where there is one.
    pub floor: Option<FloorTruth>,
    /// How it was integrated.
    pub method: String,
}

/// An effect on joints.
#[derive(Clone, Debug, Serialize)]
pub struct TrueEffect {
    /// Its id.
    pub id: EffectId,
    /// The stage on which it sits.
    pub stage: Stage,
    /// Joints by name.
    pub joints: Vec<String>,
    /// Its parameters.
    pub parameters: Vec<TrueParameter>,
}

/// A parameter of an effect.
#[derive(Clone, Debug, Serialize)]
pub struct TrueParameter {
    /// The catalogue's name.
    pub name: &'static str,
    /// Its unit.
    pub unit: &'static str,
    /// Its value.
    pub value: f64,
}

/// Friction of a joint.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct JointTruth {
    /// \[N m\]
    pub coulomb: f64,
    /// \[N m s/rad\]
    pub viscous: f64,
}

const LARGEST_SCATTER: f64 = 0.3;
/// Draws are cut off here, so that nothing gets a negative mass or friction.
const WIDEST: f64 = 3.0;

/// Factors `1 + scatter z`; all 1 without scatter.
pub(super) struct Scatter {
    pub rng: ChaCha8Rng,
    pub scatter: f64,
}

impl Scatter {
    pub fn factor(&mut self) -> f64 {
        // The draw is made in any case: the same seed gives the same pattern at every size.
        1.0 + self.scatter * standard_normal(&mut self.rng).clamp(-WIDEST, WIDEST)
    }
}

/// The true robot of a spec, with what there is to say of it.
pub(super) fn of(spec: &Spec, robot: &Model, study: &RobotStudy) -> Result<(Nominal, Method, Truth), SynthError> {
    let bench = match &spec.believed {
        Believed::Robot(_) => None,
        Believed::Joint(_, bench) => Some(bench),
    };
    let blame = Blame { file: &spec.file };
    let stated = &spec.truth;
    if let Some(joint) = stated.gain.keys().next() {
        let key = format!("[truth] gain.{joint}");
        return Err(blame.value(&key, "it", "it with scenario = \"fixed\" only"));
    }
    if stated.noise.is_some() {
        return Err(blame.value("[truth] noise", "it", "`noise` in [sensor] here"));
    }
    let [scatter, of_friction] = scatters(&blame, stated)?;
    let mut scatter = Scatter { rng: ChaCha8Rng::seed_from_u64(spec.seed), scatter };
    let model = masses(&blame, stated, robot, &mut scatter)?;
    let mut nominal = Nominal::on(&model, study).map_err(|error| blame.refused("[robot]", error))?;
    if let Some(bench) = bench {
        let believed = joint::believed(&blame, bench)?;
        let prepared = joint::prepare(&mut nominal, bench, &believed.nominal);
        prepared.map_err(|error| blame.refused("[joint] name", error))?;
    }
    let of_rest = std::mem::replace(&mut scatter.scatter, of_friction);
    friction(&blame, stated, &nominal.model, &mut nominal.joints, &mut scatter)?;
    scatter.scatter = of_rest;
    let floor = floor(&blame, stated, study, &mut nominal, &mut scatter)?;
    let effects = effects(&blame, &spec.effects, bench, &nominal.model, &mut nominal.joints)?;
    let method = method(&blame, stated)?;
    let friction_of = |id: JointId| {
        let law = &nominal.joints.drive(id).chain.friction;
        JointTruth { coulomb: law.coulomb_nm, viscous: law.viscous_nm_s_rad }
    };
    let truth = Truth {
        schema: 1,
        seed: spec.seed,
        stated: stated.clone(),
        effects,
        mass_kg: model.bodies().iter().map(|body| (body.name.clone(), body.mass_kg)).collect(),
        friction: model.joint_ids().map(|id| (model.joints()[id.index()].name.clone(), friction_of(id))).collect(),
        floor,
        method: format!("{method:?}"),
    };
    Ok((nominal, method, truth))
}

/// Relative deviations of everything, and of friction.
pub(super) fn scatters(blame: &Blame<'_>, stated: &TruthSpec) -> Result<[f64; 2], SynthError> {
    let in_range = |x: f64| (0.0..=LARGEST_SCATTER).contains(&x);
    let scatter = blame.number("[truth] scatter", stated.scatter, in_range, "a relative deviation from 0 to 0.3")?;
    let of_friction = stated.friction_scatter.unwrap_or(scatter);
    let key = "[truth] friction_scatter";
    Ok([scatter, blame.number(key, of_friction, in_range, "a relative deviation from 0 to 0.3")?])
}

fn masses(blame: &Blame<'_>, stated: &TruthSpec, robot: &Model, scatter: &mut Scatter) -> Result<Model, SynthError> {
    let (expected, right) = ("a factor from 0.01 to 100", |x: f64| (0.01..=100.0).contains(&x));
    match &stated.mass_scale {
        MassScale::All(scale) => {
            blame.number("[truth] mass_scale", *scale, right, expected)?;
        }
        MassScale::ByPart(by_part) => {
            for (part, scale) in by_part {
                let key = format!("[truth] mass_scale.{part}");
                robot.body(part).map_err(|error| blame.refused(&key, error))?;
                blame.number(&key, *scale, right, expected)?;
            }
        }
    }
    let mut model = robot.clone();
    for id in robot.body_ids() {
        let body = &robot.bodies()[id.index()];
        let scale = match &stated.mass_scale {
            MassScale::All(scale) => *scale,
            MassScale::ByPart(by_part) => by_part.get(&body.name).copied().unwrap_or(1.0),
        };
        let factor = scale * scatter.factor();
        if factor != 1.0 && body.mass_kg > 0.0 {
            let scaled = model.with_mass(id, factor * body.mass_kg);
            model = scaled.map_err(|error| blame.refused("[truth] mass_scale", error))?;
        }
    }
    for (k, payload) in stated.payload.iter().enumerate() {
        let key = format!("[[truth.payload]] {}", k + 1);
        let refused = |error| blame.refused(&key, error);
        let body = match &payload.body {
            Some(name) => model.body(name).map_err(refused)?,
            None => BodyId::BASE,
        };
        blame.number(
            &format!("{key} mass"),
            payload.mass,
            |x| x > 0.0 && x <= 100.0,
            "a mass above 0, at most 100 kg",
        )?;
        for x in payload.at {
            blame.number(&format!("{key} at"), x, |x| x.abs() <= 1.0, "lengths within 1 m of the part's centre")?;
        }
        model = model.with_point_mass(body, payload.mass, Vector3::from(payload.at)).map_err(refused)?;
    }
    Ok(model)
}

pub(super) fn friction(
    blame: &Blame<'_>,
    stated: &TruthSpec,
    model: &Model,
    joints: &mut Joints,
    scatter: &mut Scatter,
) -> Result<(), SynthError> {
    let is_known = |row: &str| model.joints().iter().any(|joint| joint.name == row || joint.kind == row);
    for (row, friction) in &stated.friction {
        let key = format!("[truth] friction.{row}");
        if !is_known(row) {
            return Err(blame.value(&key, "no such joint or kind", joint_names(model)));
        }
        for (name, value) in [("coulomb", friction.coulomb), ("viscous", friction.viscous)] {
            let Some(value) = value else { continue };
            let expected = "a number from 0 to 10";
            blame.number(&format!("{key}.{name}"), value, |x| (0.0..=10.0).contains(&x), expected)?;
        }
    }
    for id in model.joint_ids() {
        let joint = &model.joints()[id.index()];
        let row = stated.friction.get(&joint.name).or_else(|| stated.friction.get(&joint.kind));
        let row = row.copied().unwrap_or_default();
        let law = &mut joints.drive_mut(id).chain.friction;
        law.coulomb_nm = row.coulomb.unwrap_or(law.coulomb_nm) * scatter.factor();
        law.viscous_nm_s_rad = row.viscous.unwrap_or(law.viscous_nm_s_rad) * scatter.factor();
    }
    Ok(())
}

fn floor(
    blame: &Blame<'_>,
    stated: &TruthSpec,
    study: &RobotStudy,
    nominal: &mut Nominal,
    scatter: &mut Scatter,
) -> Result<Option<FloorTruth>, SynthError> {
    let t = &stated.floor;
    if nominal.floor.is_none() {
        let numbers = [t.stiffness, t.damping, t.exponent, t.static_friction, t.coulomb, t.viscous, t.steepness];
        let others = [t.stribeck_speed, t.torsion_radius, (stated.slope != 0.0).then_some(stated.slope)];
        return match numbers.into_iter().chain(others).flatten().next() {
            Some(_) => Err(blame.value("[truth] floor", "a floor or slope", "it with scenario = \"floor\" only")),
            None => Ok(None),
        };
    }
    let b = &study.floor;
    let mut true_floor = floor_of(&FloorSpec {
        stiffness_n_m: t.stiffness.or(b.stiffness_n_m),
        damping_n_s_m2: t.damping.or(b.damping_n_s_m2),
        exponent: t.exponent.or(b.exponent),
        static_friction: t.static_friction.or(b.static_friction),
        coulomb: t.coulomb.or(b.coulomb),
        viscous_s_m: t.viscous.or(b.viscous_s_m),
        steepness_s_m: t.steepness.or(b.steepness_s_m),
        stribeck_speed_m_s: t.stribeck_speed.or(b.stribeck_speed_m_s),
        torsion_radius_m: t.torsion_radius.or(b.torsion_radius_m),
    });
    true_floor.stiffness_n_m *= scatter.factor();
    true_floor.damping_n_s_m2 *= scatter.factor();
    let friction = scatter.factor();
    true_floor.static_friction *= friction;
    true_floor.coulomb *= friction;
    let floor = Floor::new(true_floor.sloped(stated.slope, 0.0), &nominal.model, Touching::Marked);
    nominal.floor = Some(floor.map_err(|error| blame.refused("[truth] floor", error))?);
    Ok(Some(FloorTruth {
        stiffness: Some(true_floor.stiffness_n_m),
        damping: Some(true_floor.damping_n_s_m2),
        exponent: Some(true_floor.exponent),
        static_friction: Some(true_floor.static_friction),
        coulomb: Some(true_floor.coulomb),
        viscous: Some(true_floor.viscous_s_m),
        steepness: Some(true_floor.steepness_s_m),
        stribeck_speed: Some(true_floor.stribeck_speed_m_s),
        torsion_radius: Some(true_floor.torsion_radius_m),
    }))
}

pub(super) fn effects(
    blame: &Blame<'_>,
    stated: &[EffectSpec],
    bench: Option<&JointBench>,
    model: &Model,
    joints: &mut Joints,
) -> Result<Vec<TrueEffect>, SynthError> {
    let mut found = Vec::with_capacity(stated.len());
    for (k, spec) in stated.iter().enumerate() {
        let key = |name: &str| format!("[[effect]] {} {name}", k + 1);
        let form: EffectForm = spec.id.parse().map_err(|unknown| blame.value(&key("id"), &spec.id, unknown))?;
        let id = form.id;
        let known = form.named_parameters();
        if let Some(other) = spec.parameters.keys().find(|name| known.iter().all(|p| p.name != name.as_str())) {
            let names: Vec<&str> = known.iter().map(|p| p.name).collect();
            return Err(blame.value(&key(other), "a parameter that the effect does not have", names.join(", ")));
        }
        let value = |p: &crate::joint::Named| {
            let missing = || blame.value(&key(p.name), "nothing", format!("{} {}", p.bounds, p.unit));
            spec.parameters.get(p.name).copied().ok_or_else(missing)
        };
        let named: Vec<f64> = known.iter().map(value).collect::<Result<_, SynthError>>()?;
        let the_joint = bench.map(|bench| JointChoice::One(bench.name.clone()));
        if the_joint.is_some() && id.is_driven_only() {
            return Err(blame.value(&key("id"), id, "an effect that a joint without drive can have"));
        }
        let choice = the_joint.as_ref().filter(|_| spec.joints == JointChoice::default()).unwrap_or(&spec.joints);
        let on = chosen(blame, &key("joints"), choice, model, joints)?;
        for joint in &on {
            if id.is_driven_only() && joints.drive(*joint).chain.motor.is_none() {
                let name = &model.joints()[joint.index()].name;
                return Err(blame.value(&key("joints"), name, "joints with a controller: the effect is its motor's"));
            }
            joints.add_effect(model, *joint, form, &named).map_err(|error| blame.refused(&key(id.id()), error))?;
        }
        found.push(TrueEffect {
            id,
            stage: id.stage(),
            joints: on.iter().map(|joint| model.joints()[joint.index()].name.clone()).collect(),
            parameters: known
                .iter()
                .zip(&named)
                .map(|(p, value)| TrueParameter { name: p.name, unit: p.unit, value: *value })
                .collect(),
        });
    }
    Ok(found)
}

/// The joints of a choice, in the model's order.
fn chosen(
    blame: &Blame<'_>,
    key: &str,
    choice: &JointChoice,
    model: &Model,
    joints: &Joints,
) -> Result<Vec<JointId>, SynthError> {
    let words = match choice {
        JointChoice::One(word) => std::slice::from_ref(word),
        JointChoice::Many(words) => words.as_slice(),
    };
    let matches = |word: &str, id: JointId| {
        let joint = &model.joints()[id.index()];
        joint.name == word || joint.kind == word || word == "all" && joints.drive(id).chain.motor.is_some()
    };
    if let Some(word) = words.iter().find(|word| !model.joint_ids().any(|id| matches(word, id))) {
        return Err(blame.value(
            key,
            format!("\"{word}\""),
            format!("\"all\", a kind of joint, or {}", joint_names(model)),
        ));
    }
    let found: Vec<JointId> = model.joint_ids().filter(|id| words.iter().any(|word| matches(word, *id))).collect();
    if found.is_empty() { Err(blame.value(key, "no joint", "at least one")) } else { Ok(found) }
}

pub(super) fn joint_names(model: &Model) -> String {
    let names: Vec<&str> = model.joints().iter().map(|joint| joint.name.as_str()).collect();
    names.join(", ")
}

pub(super) fn method(blame: &Blame<'_>, stated: &TruthSpec) -> Result<Method, SynthError> {
    let step = |default: f64| {
        let step_s = stated.step.unwrap_or(default);
        blame.number("[truth] step", step_s, |x| (1e-8..=0.1).contains(&x), "a step from 1e-8 to 0.1 s")
    };
    let tolerance = || {
        let value = stated.tolerance.unwrap_or(1e-7);
        let right = |x: f64| (1e-12..=0.1).contains(&x);
        blame.number("[truth] tolerance", value, right, "a number from 1e-12 to 0.1").map(Tolerance::of)
    };
    Ok(match stated.method.as_deref().unwrap_or("stiff") {
        "stiff" => Method::Stiff { step_s: step(1e-4)? },
        "rk2" => Method::Smooth(integrate::Method::Rk2 { step_s: step(1e-5)? }),
        "rk4" => Method::Smooth(integrate::Method::Rk4 { step_s: step(1e-5)? }),
        "dormand_prince" => Method::Smooth(integrate::Method::DormandPrince(tolerance()?)),
        "adams" => Method::Smooth(integrate::Method::Adams(tolerance()?)),
        "bdf" => Method::Smooth(integrate::Method::Bdf(tolerance()?)),
        other => {
            let expected = "stiff, rk2, rk4, dormand_prince, adams or bdf";
            return Err(blame.value("[truth] method", format!("\"{other}\""), expected));
        }
    })
}
