//! The joint with effects, as a model to be fitted: baseline and rest angle first, then each effect's parameters.

use crate::identify::{Experiment, JointModel, Parameter, Search, Signal};
use crate::joint::{Chain, EffectForm, EffectId, Friction, Link, Motor, Reach, Real, Scan};
use crate::log::Nominal;

/// Where the baseline's numbers stand among the values.
pub(super) const INERTIA: usize = 0;
pub(super) const MOMENT: usize = 1;
pub(super) const COULOMB: usize = 2;
pub(super) const VISCOUS: usize = 3;
const REST: usize = 4;
/// Number of values before those of the effects.
pub(super) const BASELINE: usize = 5;

/// The baseline joint with effects on its stages.
#[derive(Clone, Debug)]
pub(crate) struct GapModel {
    parameters: Vec<Parameter>,
    effects: Vec<EffectId>,
    /// The same in the forms that they have here.
    forms: Vec<EffectForm>,
}

impl GapModel {
    /// The joint as given; its four numbers are searched from there, its rest angle (0 where none is given) is not.
    pub(crate) fn baseline(nominal: &Nominal, rest_rad: f64, reach: &Reach) -> Self {
        let damping = reach.torque_nm / reach.speed_rad_s;
        let n = nominal;
        let moment_unit = reach.torque_nm / 9.81;
        let parameters = vec![
            Parameter::positive("inertia", "I*", "kg m^2", Some(n.inertia_kg_m2), n.inertia_kg_m2),
            if n.moment_kg_m > 0.0 {
                Parameter::positive("moment", "M*", "kg m", Some(n.moment_kg_m), n.moment_kg_m)
            } else {
                Parameter::friction("moment", "M*", "kg m", Some(0.0), 0.0, moment_unit)
            },
            Parameter::friction("coulomb", "mu_c", "N m", Some(n.coulomb_nm), n.coulomb_nm, reach.torque_nm),
            Parameter::friction("viscous", "mu_v", "N m s/rad", Some(n.viscous_nm_s_rad), n.viscous_nm_s_rad, damping),
            Parameter::angle("rest", "q_rest", Some(rest_rad), rest_rad).fixed(),
        ];
        Self { parameters, effects: Vec::new(), forms: Vec::new() }
    }

    /// The same joint with one effect more.
    pub(crate) fn with(&self, effect: impl Into<EffectForm>, reach: &Reach) -> Self {
        let (mut more, form) = (self.clone(), effect.into());
        more.effects.push(form.id);
        more.forms.push(form);
        more.parameters.extend(form.parameters(reach).into_iter().map(|p| {
            let search = match p.scan {
                Scan::Logarithm => Search::Logarithm,
                Scan::Linear(scale) => Search::Linear { scale },
                Scan::Held => Search::Linear { scale: 1.0 },
            };
            Parameter {
                search,
                lower: p.lower,
                upper: p.upper,
                fixed: p.scan == Scan::Held,
                start: p.lower,
                ..Parameter::positive(p.name, p.name, p.unit, None, p.lower)
            }
        }));
        more
    }

    /// The same model with parameters held at the values given, by index.
    pub(super) fn holding(mut self, held: &[usize], values: &[f64]) -> Self {
        for &i in held {
            self.parameters[i].fixed = true;
            self.parameters[i].start = values[i];
        }
        self
    }

    /// The same model with everything that is not searched at the values given.
    pub(super) fn at(mut self, values: &[f64]) -> Self {
        for (parameter, value) in self.parameters.iter_mut().zip(values) {
            if parameter.fixed {
                parameter.start = *value;
            }
        }
        self
    }

    /// The effects, in the order in which they were added.
    pub(super) fn effects(&self) -> &[EffectId] {
        &self.effects
    }

    /// Where the values of the `k`-th effect stand.
    pub(super) fn place(&self, k: usize) -> std::ops::Range<usize> {
        let from = BASELINE + self.forms[..k].iter().map(|e| e.searched_count()).sum::<usize>();
        from..from + self.forms[k].searched_count()
    }

    /// Free parameters.
    pub(super) fn free(&self) -> usize {
        self.parameters.iter().filter(|p| !p.fixed).count()
    }
}

impl JointModel for GapModel {
    fn parameters(&self) -> &[Parameter] {
        &self.parameters
    }

    fn parameters_mut(&mut self) -> &mut [Parameter] {
        &mut self.parameters
    }

    fn chain<T: Real>(&self, values: &[T], experiment: &Experiment) -> Chain<T> {
        let rest = values[REST];
        let mut link = Link::new(values[INERTIA], values[MOMENT], rest, experiment.gravity_m_s2);
        if let Some(load) = &experiment.load {
            let (inertia, moment) = (T::constant(load.inertia_kg_m2), T::constant(load.moment_kg_m));
            link = link.joined(Link::new(inertia, moment, rest + load.angle_rad, experiment.gravity_m_s2));
        }
        let motor = match &experiment.signal {
            Signal::Off => None,
            Signal::Torque { .. } => Some(Motor::direct()),
            Signal::Position { .. } => experiment.motor.map(Motor::new),
        };
        let friction = Friction::coulomb_viscous(values[COULOMB], values[VISCOUS]);
        let mut chain = Chain::new(link, friction, motor).geared(experiment.motor.as_ref());
        let mut rest_of = &values[BASELINE.min(values.len())..];
        for &effect in &self.forms {
            let (own, later) = rest_of.split_at(effect.searched_count());
            effect.apply(own, values[INERTIA], &mut chain);
            rest_of = later;
        }
        chain
    }
}
