//! What is answered for a state of a described robot: by joint name, base rows only where the base is free.

use super::read::Asked;
use crate::cli::dynamics::answer::{Conventions, Timing};
use crate::number::math;
use crate::report::Provenance;
use crate::robot::description::{Description, Mover, MoverId};
use crate::robot::tree::{NoAcceleration, Tree, TreeBase, TreeDynamics, TreeState};
use nalgebra::{DMatrix, DVector};
use serde::Serialize;
use serde_json::{Map, Value, json};
use std::collections::BTreeMap;

/// The whole answer.
#[derive(Serialize)]
pub(super) struct Answers {
    pub conventions: Conventions,
    pub versions: BTreeMap<&'static str, String>,
    pub robot: String,
    pub base: &'static str,
    pub gravity: [f64; 3],
    pub total_mass: f64,
    pub moving_mass: f64,
    pub joints: Vec<Value>,
    pub warnings: Vec<String>,
    pub states: Vec<StateAnswer>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub timing: Option<Timing>,
    pub command: String,
    pub inputs: Value,
}

/// A state with its answer.
#[derive(Serialize)]
pub(super) struct StateAnswer {
    #[serde(flatten)]
    pub base: Map<String, Value>,
    pub q: BTreeMap<String, f64>,
    pub dq: BTreeMap<String, f64>,
    pub tau: BTreeMap<String, f64>,
    pub out: Out,
}

/// What was computed; without accelerations where the mass matrix is singular.
#[derive(Serialize)]
#[expect(non_snake_case, reason = "the keys of the format")]
pub(super) struct Out {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub qacc: Option<Vec<f64>>,
    pub bias: Vec<f64>,
    pub gravity: Vec<f64>,
    pub M_times_v: Vec<f64>,
    pub M_times_w: Vec<f64>,
    pub M_diag: Vec<f64>,
    pub M_trace: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub M_logdet: Option<f64>,
    pub com: [f64; 3],
    pub com_vel: [f64; 3],
    pub com_moving: [f64; 3],
    pub kinetic_energy: f64,
    pub potential_energy: f64,
    pub total_energy: f64,
    pub body_pos: BTreeMap<String, [f64; 3]>,
    pub rigid: Rigid,
    pub M: Vec<Vec<f64>>,
}

/// The same without armature.
#[derive(Serialize)]
#[expect(non_snake_case, reason = "the keys of the format")]
pub(super) struct Rigid {
    #[serde(skip_serializing_if = "Option::is_none")]
    pub qacc: Option<Vec<f64>>,
    pub M_trace: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub M_logdet: Option<f64>,
}

impl Answers {
    pub fn new(
        description: &Description,
        tree: &Tree,
        warnings: Vec<String>,
        states: Vec<StateAnswer>,
        timing: Option<Timing>,
        from: &Provenance,
    ) -> Self {
        let [all, moving] = TreeDynamics::new(tree).momentum(&TreeState::drawn(tree));
        let gravity: [f64; 3] = tree.gravity_m_s2().into();
        let is_free = tree.base() == TreeBase::Free;
        Self {
            conventions: Conventions {
                world: format!("the file's axes; gravity {gravity:?} m/s^2"),
                quaternion: "w,x,y,z; rotates base-frame vectors into the world",
                velocity: "v = [velocity of the base frame's origin, WORLD axes (3); base angular velocity, BODY axes (3); \
                           joint rates], the first six only where the base is free",
                acceleration: "qacc = time derivative of v; gravity acts",
                dynamics: "M qacc + bias = [0 (6 where the base is free); tau]; bias = Coriolis, centrifugal and gravity; M \
                           with armature; no friction, springs, limits, contacts, equalities, tendons; a joint that follows \
                           another is no freedom and acts through its leader",
                energy: "kinetic = v.M.v/2; potential = -sum m g.c over all links with zero at world origin",
                body_pos: "world position of each link's frame (m)",
                units: "SI",
                joint_order: tree.joint_names().map(str::to_owned).collect(),
            },
            versions: BTreeMap::from([("aibo-fit", from.version.clone())]),
            robot: description.name.clone(),
            base: if is_free { "free" } else { "fixed" },
            gravity,
            total_mass: all.mass_kg,
            moving_mass: moving.mass_kg,
            joints: (0..description.joints.len()).map(|joint| described(description, MoverId(joint))).collect(),
            warnings,
            states,
            timing,
            command: from.command.clone(),
            inputs: json!(from.hashed()),
        }
    }
}

/// A joint as the description has it.
fn described(description: &Description, id: MoverId) -> Value {
    let joint: &Mover = &description.joints[id.0];
    let link = &description.links[joint.link.0];
    let mut all = Map::new();
    let mut put = |key: &str, value: Value| drop(all.insert(key.to_owned(), value));
    put("name", json!(joint.name));
    put("type", json!(joint.kind.word()));
    put("parent", json!(link.parent.map(|parent| &description.links[parent.0].name)));
    put("child", json!(if link.is_named { link.name.as_str() } else { "" }));
    put("axis", json!(<[f64; 3]>::from(joint.axis.into_inner())));
    for (key, pair) in [("limit", joint.limit_rad), ("actuatorfrcrange", joint.actuator_range_nm)] {
        if let Some(pair) = pair {
            put(key, json!(pair));
        }
    }
    for (key, number) in [("effort", joint.effort_nm), ("velocity", joint.rate_limit_rad_s)] {
        if let Some(number) = number {
            put(key, json!(number));
        }
    }
    put("damping", json!(joint.damping[0]));
    put("frictionloss", json!(joint.friction_nm));
    put("armature", json!(joint.armature_kg_m2));
    put("stiffness", json!(joint.stiffness[0]));
    put("springref", json!(joint.spring_rest_rad));
    put("ref", json!(joint.drawn_rad));
    if let Some(coupling) = description.couplings.iter().find(|coupling| coupling.follower == id) {
        let leader = &description.joints[coupling.leader.0].name;
        put("mimic", json!({"joint": leader, "multiplier": coupling.multiplier, "offset": coupling.offset_rad}));
    }
    Value::Object(all)
}

/// Answers a state, with the freedom that nothing resists if there is one; `None` where a number is not finite.
pub(super) fn answer(
    dynamics: &mut TreeDynamics<'_>,
    description: &Description,
    asked: &Asked,
) -> Option<(StateAnswer, Option<NoAcceleration>)> {
    let (state, tree) = (&asked.state, dynamics.tree());
    let n = tree.freedoms();
    let (mut force, mut bias, mut gravity) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    dynamics.forces_of(&asked.torque, &mut force);
    dynamics.bias(state, &mut bias);
    let still = TreeState {
        base_velocity_m_s: Default::default(),
        base_rate_rad_s: Default::default(),
        rate: vec![0.0; state.rate.len()],
        ..state.clone()
    };
    dynamics.bias(&still, &mut gravity);
    let mut matrix = DMatrix::zeros(n, n);
    dynamics.rigid_mass_matrix(state, &mut matrix);
    let rigid_trace = matrix.trace();
    dynamics.mass_matrix(state, &mut matrix);
    let mut accelerations = |is_rigid: bool| {
        let mut qacc = vec![0.0; n];
        let found = match is_rigid {
            true => dynamics.rigid_forward(state, &force, &mut qacc),
            false => dynamics.forward(state, &force, &mut qacc),
        };
        found.map(|()| (qacc, dynamics.log_determinant()))
    };
    let (rigid, (full, singular)) = (
        accelerations(true).ok(),
        match accelerations(false) {
            Ok(found) => (Some(found), None),
            Err(singular) => (None, Some(singular)),
        },
    );
    let velocity = DVector::from_iterator(n, state.velocity(tree.base()));
    let [all, moving] = dynamics.momentum(state);
    let energy = dynamics.energy(state);
    let places = dynamics.link_places_m(state);
    let body_pos = description.links.iter().zip(places).map(|(link, place)| (link.name.clone(), place.into()));
    let out = Out {
        bias,
        gravity,
        M_times_v: (&matrix * velocity).iter().copied().collect(),
        M_times_w: (&matrix * DVector::from_fn(n, |row, _| math::cos((row + 1) as f64))).iter().copied().collect(),
        M_diag: matrix.diagonal().iter().copied().collect(),
        M_trace: matrix.trace(),
        M_logdet: full.as_ref().map(|(_, logdet)| *logdet),
        qacc: full.map(|(qacc, _)| qacc),
        com: all.centre_m.into(),
        com_vel: all.velocity_m_s.into(),
        com_moving: moving.centre_m.into(),
        kinetic_energy: energy.kinetic_j,
        potential_energy: energy.potential_j,
        total_energy: energy.kinetic_j + energy.potential_j,
        body_pos: body_pos.collect(),
        rigid: Rigid {
            M_trace: rigid_trace,
            M_logdet: rigid.as_ref().map(|(_, logdet)| *logdet),
            qacc: rigid.map(|(qacc, _)| qacc),
        },
        M: matrix.row_iter().map(|row| row.iter().copied().collect()).collect(),
    };
    out.is_finite().then(|| (echoed(tree, description, asked, out), singular))
}

/// The state that was asked, followers included, with its answer.
fn echoed(tree: &Tree, description: &Description, asked: &Asked, out: Out) -> StateAnswer {
    let state = &asked.state;
    let mut base = Map::new();
    if tree.base() == TreeBase::Free {
        let q = &state.base_orientation;
        let triple = |v: nalgebra::Vector3<f64>| json!(<[f64; 3]>::from(v));
        base.insert("base_pos".into(), triple(state.base_position_m));
        base.insert("base_quat_wxyz".into(), json!([q.w, q.i, q.j, q.k]));
        base.insert("base_vel_world".into(), triple(state.base_velocity_m_s));
        base.insert("base_omega_body".into(), triple(state.base_rate_rad_s));
    }
    let by_name = |number: &dyn Fn(usize) -> f64| {
        description.joints.iter().enumerate().map(|(joint, of)| (of.name.clone(), number(joint))).collect()
    };
    StateAnswer {
        base,
        q: by_name(&|joint| tree.position_of(MoverId(joint), &state.position)),
        dq: by_name(&|joint| tree.rate_of(MoverId(joint), &state.rate)),
        tau: by_name(&|joint| asked.torque[joint]),
        out,
    }
}

impl Out {
    fn is_finite(&self) -> bool {
        let scalars = [self.kinetic_energy, self.potential_energy, self.M_trace];
        let vectors = self.bias.iter().chain(self.qacc.iter().flatten()).chain(&self.M_times_v).chain(&self.com);
        vectors.chain(self.M.iter().flatten()).chain(&scalars).all(|number| number.is_finite())
    }
}
