//! The models that are fitted: which parameters they have, and the joint chain that a set of values makes.

use super::{Deviations, Experiment, Named, Parameter, Scale};
use crate::geometry::LinkBody;
use crate::joint::{Chain, Link, Real, Stribeck};
use crate::log::{Nominal, Uncertain};
use crate::pendulum::{ExtensivePendulum, SimplePendulum};

/// A model of a joint with parameters.
pub trait JointModel: Sync {
    /// The parameters, in the order of `values` below.
    fn parameters(&self) -> &[Parameter];

    /// The parameters, to fix, bound or start them otherwise.
    fn parameters_mut(&mut self) -> &mut [Parameter];

    /// The joint of one experiment.
    fn chain<T: Real>(&self, values: &[T], experiment: &Experiment) -> Chain<T>;

    /// What one unit of deviance weighs in the criterion (3.7) \[rad^2 s\]: the mean squared residual times the time
    /// that its correlation lasts. Beliefs count in this unit; 0: they do not count.
    fn unit_rad2_s(&self) -> f64 {
        0.0
    }

    /// Sets that; of no consequence in a model that is not believed in anything.
    fn weigh_beliefs(&mut self, _unit_rad2_s: f64) {}
}

/// The simple pendulum (3.2); the extra mass is part of the point mass.
#[derive(Clone, Debug)]
pub struct SimpleModel {
    /// In the order of the values.
    pub parameters: Vec<Parameter>,
}

/// Damping beyond which a pendulum only creeps and `B/ML^2` and `g/L` show in their ratio alone, in natural frequencies.
const MOST_DAMPED: f64 = 15.0;

impl SimpleModel {
    /// `scale` tells what is known beforehand; `driven` frees `M L^2`, which a free swing does not show.
    pub fn new(scale: &Scale, driven: bool) -> Self {
        let inertia = if driven { scale.inertia_kg_m2 } else { 1.0 };
        let ml2 = Parameter::positive(Named::Ml2, "M L^2", "kg m^2", None, inertia);
        let g_over_l = scale.frequency_rad_s.powi(2);
        Self {
            parameters: vec![
                if driven { ml2 } else { ml2.fixed() },
                Parameter {
                    upper: MOST_DAMPED * scale.frequency_rad_s,
                    ..Parameter::friction(Named::BOverMl2, "B/ML^2", "1/s", None, 1.0, scale.frequency_rad_s)
                },
                Parameter::positive(Named::GOverL, "g/L", "1/s^2", None, g_over_l),
                scale.rest(),
            ],
        }
    }
}

impl JointModel for SimpleModel {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn parameters_mut(&mut self) -> &mut [Parameter] {
        &mut self.parameters
    }

    fn chain<T: Real>(&self, values: &[T], experiment: &Experiment) -> Chain<T> {
        SimplePendulum {
            ml2_kg_m2: values[0],
            b_over_ml2_1_s: values[1],
            g_over_l_1_s2: values[2],
            rest_rad: values[3],
        }
        .chain(experiment.driven_by())
    }
}

/// How the extensive model's inertia and moment are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkBy {
    /// As `I*` and `M*` of the bare link.
    Lump,
    /// As the masses of its bodies, whose places are known (3.8-3.10).
    Bodies,
}

/// The extensive pendulum (3.12, 3.13).
#[derive(Clone, Debug)]
pub struct ExtensiveModel {
    /// In the order of the values.
    pub parameters: Vec<Parameter>,
    /// How inertia and moment are written.
    pub link_by: LinkBy,
    /// Number of parameters that describe the link; friction follows, then the rest angle.
    link: usize,
    stribeck: bool,
    unit_rad2_s: f64,
}

impl ExtensiveModel {
    /// `I*` and `M*` of the bare link, with friction (3.14), or (3.11) where `stribeck` is set.
    pub fn lumped(scale: &Scale, nominal: Option<&Nominal>, stribeck: bool) -> Self {
        let inertia = nominal.map_or(scale.inertia_kg_m2, |n| n.inertia_kg_m2);
        let moment = nominal.map_or(scale.moment_kg_m(), |n| n.moment_kg_m);
        let mut parameters = vec![
            Parameter::positive(Named::Inertia, "I*", "kg m^2", nominal.map(|n| n.inertia_kg_m2), inertia),
            if moment > 0.0 {
                Parameter::positive(Named::Moment, "M*", "kg m", nominal.map(|n| n.moment_kg_m), moment)
            } else {
                let unit = scale.torque_nm / scale.gravity_m_s2;
                Parameter::friction(Named::Moment, "M*", "kg m", nominal.map(|n| n.moment_kg_m), 0.0, unit)
            },
        ];
        parameters.extend(scale.friction(nominal, stribeck));
        parameters.push(scale.rest());
        Self { parameters, link_by: LinkBy::Lump, link: 2, stribeck, unit_rad2_s: 0.0 }
    }

    /// The same, its numbers believed to lie about the nominal ones as the study says.
    pub fn believed(mut self, scale: &Scale, nominal: &Nominal, uncertain: &Uncertain) -> Self {
        let moment_kg_m = scale.torque_nm / scale.gravity_m_s2;
        let sd = Deviations::of(nominal, uncertain, scale.torque_nm, scale.frequency_rad_s, moment_kg_m);
        for p in &mut self.parameters {
            let sd = match p.named() {
                Some(Named::Inertia) => sd.inertia,
                Some(Named::Moment) => sd.moment,
                Some(Named::Coulomb) => sd.coulomb_nm,
                Some(Named::Viscous) => sd.viscous_nm_s_rad,
                _ => continue,
            };
            *p = p.clone().believed(sd);
        }
        self
    }

    /// One mass per body with its nominal value, all fixed but `free`; the rest angle becomes the encoder's zero, which
    /// is nominally 0 where the pose is known.
    pub fn bodies(
        scale: &Scale,
        experiments: &[Experiment],
        masses: &[BodyMass],
        pose_known: bool,
        friction: Option<&Nominal>,
        stribeck: bool,
    ) -> Self {
        let mut parameters: Vec<Parameter> = masses
            .iter()
            .map(|m| {
                let p = Parameter::positive(Named::Mass(m.body), &m.symbol, "kg", Some(m.nominal_kg), m.nominal_kg);
                let known_to = BENCH_PRECISION / share(experiments, masses, m.body);
                Parameter { known_to, fixed: !m.free, ..p }
            })
            .collect();
        let link = parameters.len();
        parameters.extend(scale.friction(friction, stribeck));
        parameters.push(Parameter::angle(Named::Zero, "q_0", pose_known.then_some(0.0), 0.0));
        Self { parameters, link_by: LinkBy::Bodies, link, stribeck, unit_rad2_s: 0.0 }
    }

    /// The bare link of an experiment.
    pub fn bare_link<T: Real>(&self, values: &[T], experiment: &Experiment) -> Link<T> {
        let rest = values[self.parameters.len() - 1];
        match self.link_by {
            LinkBy::Lump => Link::new(values[0], values[1], rest, experiment.gravity_m_s2),
            LinkBy::Bodies => {
                let mut bodies = experiment.bodies.iter().zip(values).map(|(body, &mass)| {
                    let moment = mass * body.lever_m;
                    Link::new(mass * body.inertia_per_kg_m2, moment, rest + body.hanging_rad, experiment.gravity_m_s2)
                });
                let first = bodies.next().unwrap_or_else(|| Link::new(T::nought(), T::nought(), rest, 0.0));
                bodies.fold(first, Link::joined)
            }
        }
    }

    /// Static friction and Stribeck speed of the values; `None` where the law has no such part.
    pub fn stribeck_of<T: Real>(&self, values: &[T]) -> Option<Stribeck<T>> {
        let [c, v] = self.friction_at();
        // Held above the Coulomb friction: mu_st = mu_c + an excess.
        self.stribeck.then(|| Stribeck {
            static_nm: values[c] + values[v + 1],
            speed_rad_s: values[v + 2],
            curve: Default::default(),
        })
    }

    /// Friction parameters among the values: Coulomb, viscous.
    pub fn friction_at(&self) -> [usize; 2] {
        [self.link, self.link + 1]
    }
}

impl JointModel for ExtensiveModel {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn parameters_mut(&mut self) -> &mut [Parameter] {
        &mut self.parameters
    }

    fn unit_rad2_s(&self) -> f64 {
        self.unit_rad2_s
    }

    fn weigh_beliefs(&mut self, unit_rad2_s: f64) {
        self.unit_rad2_s = unit_rad2_s;
    }

    fn chain<T: Real>(&self, values: &[T], experiment: &Experiment) -> Chain<T> {
        let mut link = self.bare_link(values, experiment);
        if let Some(load) = &experiment.load {
            // The last parameter is where the bare link hangs, or the encoder's zero.
            let hanging = values[self.parameters.len() - 1]
                + match self.link_by {
                    LinkBy::Lump => load.angle_rad,
                    LinkBy::Bodies => load.hanging_rad,
                };
            let (inertia, moment) = (T::constant(load.inertia_kg_m2), T::constant(load.moment_kg_m));
            link = link.joined(Link::new(inertia, moment, hanging, experiment.gravity_m_s2));
        }
        let [c, v] = self.friction_at();
        ExtensivePendulum {
            link,
            coulomb_nm: values[c],
            viscous_nm_s_rad: values[v],
            stribeck: self.stribeck_of(values),
        }
        .chain(experiment.driven_by())
        .geared(experiment.motor.as_ref())
    }
}

/// How well the lengths and masses of a set-up are usually known, as a share.
const BENCH_PRECISION: f64 = 0.01;

/// The largest share that a body has in the inertia or in the moment of all that turns, over the experiments.
fn share(experiments: &[Experiment], masses: &[BodyMass], of: LinkBody) -> f64 {
    let share_in = |e: &Experiment| {
        let (mut inertia, mut moment) = e.load.map_or((0.0, 0.0), |l| (l.inertia_kg_m2, l.moment_kg_m));
        let mut own = (0.0, 0.0);
        for (body, mass) in e.bodies.iter().zip(masses) {
            let part = (mass.nominal_kg * body.inertia_per_kg_m2, mass.nominal_kg * body.lever_m);
            (inertia, moment) = (inertia + part.0, moment + part.1);
            if mass.body == of {
                own = part;
            }
        }
        (own.0 / inertia).max(own.1 / moment)
    };
    experiments.iter().map(share_in).fold(0.0, f64::max)
}

/// A body's mass as a parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyMass {
    /// The body.
    pub body: LinkBody,
    /// e.g. `M_L`.
    pub symbol: String,
    /// By the table \[kg\].
    pub nominal_kg: f64,
    /// Whether it is searched.
    pub free: bool,
}
