//! The joint with effects, as a model to be fitted: the numbers that a study states, with what is believed of them, then
//! each effect's parameters.

use super::law_shape::LawShape;
use super::logs::LogSet;
use super::rotor::armature_kg_m2;
use crate::identify::{Belief, Deviations, Directives, Experiment, JointModel, Parameter, Search};
use crate::joint::{Chain, DrivenReach, EffectForm, EffectId, EffectParameter, Friction, Link, Reach, Real, Scan};
use crate::log::{Nominal, Uncertain};
use std::sync::Arc;

/// Where the numbers stand among the values.
pub(in crate::gap) const INERTIA: usize = 0;
pub(in crate::gap) const MOMENT: usize = 1;
pub(in crate::gap) const COULOMB: usize = 2;
pub(in crate::gap) const VISCOUS: usize = 3;
/// A size so near to none, in its own unit, is none.
const NO_SIZE: f64 = 1e-9;
/// Torque that arrives per torque that the drive is believed to give.
pub(in crate::gap) const GAIN: usize = 4;
/// The drive's derivative and integral gain per believed ones.
pub(in crate::gap) const DERIVATIVE: usize = 5;
pub(in crate::gap) const INTEGRAL: usize = 6;
pub(in crate::gap) const REST: usize = 7;
/// Number of values before those of the effects.
pub(in crate::gap) const BASELINE: usize = 8;

/// The joint as it is believed to be, with effects on its stages.
#[derive(Clone, Debug)]
pub(crate) struct GapModel {
    parameters: Vec<Parameter>,
    effects: Vec<EffectId>,
    /// The same in the forms that they have here.
    forms: Vec<EffectForm>,
    /// A cause without a name; its numbers stand last.
    law: Option<LawShape>,
    /// The logs in which each of them holds; `None`: all.
    only: Vec<Option<Arc<LogSet>>>,
    /// Numbers that are not the same in all logs.
    differing: Vec<Differing>,
    unit_rad2_s: f64,
    /// What the user demands of parameters.
    demands: Arc<Directives>,
}

/// A number with values of its own in some logs.
#[derive(Clone, Debug)]
struct Differing {
    number: usize,
    /// Logs, and where their value stands.
    own: Vec<(Arc<LogSet>, usize)>,
}

impl GapModel {
    /// The joint as given. Its numbers are searched from there, as far as they are believed to be off; its rest angle (0
    /// where none is given) is not.
    pub(crate) fn baseline(nominal: &Nominal, rest_rad: f64, reach: &Reach, uncertain: &Uncertain) -> Self {
        let damping = reach.torque_nm / reach.speed_rad_s;
        let n = nominal;
        let moment_unit = reach.torque_nm / crate::number::STANDARD_GRAVITY_M_S2;
        let largest_nm = reach.torque_nm.max(reach.driven.map_or(0.0, |driven| driven.command_nm));
        let sd = Deviations::of(n, uncertain, largest_nm, reach.speed_rad_s, moment_unit);
        let gain_sd = match reach.driven {
            Some(driven) if driven.by_setpoint => uncertain.gain.of("kp"),
            Some(_) => uncertain.torque.of("tau"),
            None => 0.0,
        };
        // What the control law does not have is no number of this study.
        let law_sd = |name: &str, is_there: fn(&DrivenReach) -> bool| {
            if reach.driven.as_ref().is_some_and(is_there) { uncertain.gain.of(name) } else { 0.0 }
        };
        let mut gain = Parameter::positive("gain", "c", "", Some(1.0), 1.0).believed(gain_sd);
        if reach.driven.as_ref().is_some_and(|driven| !driven.by_setpoint) {
            gain.belief = gain.belief.map(Belief::of_measured);
        }
        let parameters = vec![
            Parameter::positive("inertia", "I*", "kg m^2", Some(n.inertia_kg_m2), n.inertia_kg_m2).believed(sd.inertia),
            if n.moment_kg_m > 0.0 {
                Parameter::positive("moment", "M*", "kg m", Some(n.moment_kg_m), n.moment_kg_m).believed(sd.moment)
            } else {
                Parameter::friction("moment", "M*", "kg m", Some(0.0), 0.0, moment_unit).believed(sd.moment)
            },
            Parameter::friction("coulomb", "mu_c", "N m", Some(n.coulomb_nm), n.coulomb_nm, reach.torque_nm)
                .believed(sd.coulomb_nm),
            Parameter::friction("viscous", "mu_v", "N m s/rad", Some(n.viscous_nm_s_rad), n.viscous_nm_s_rad, damping)
                .believed(sd.viscous_nm_s_rad),
            gain,
            Parameter::positive("kd", "c_d", "", Some(1.0), 1.0).believed(law_sd("kd", |driven| driven.by_derivative)),
            Parameter::positive("ki", "c_i", "", Some(1.0), 1.0).believed(law_sd("ki", |driven| driven.by_integral)),
            Parameter::angle("rest", "q_rest", Some(rest_rad), rest_rad).fixed(),
        ];
        Self {
            parameters,
            effects: Vec::new(),
            forms: Vec::new(),
            law: None,
            only: Vec::new(),
            differing: Vec::new(),
            unit_rad2_s: 0.0,
            demands: Arc::default(),
        }
    }

    /// The same model under demands, which also hold for the effects that will be added.
    pub(in crate::gap) fn under(mut self, demands: &Arc<Directives>) -> Self {
        self.parameters.iter_mut().for_each(|p| demands.impose(p));
        self.demands = Arc::clone(demands);
        self
    }

    /// The same joint, of whose drive's gain the logs show something beside their motion.
    pub(in crate::gap) fn with_gain_seen(mut self, seen: Option<Belief>) -> Self {
        self.parameters[GAIN].seen = seen;
        self
    }

    /// The same joint, whose numbers are believed without heavy tails.
    pub(in crate::gap) fn believed_normally(mut self) -> Self {
        for p in &mut self.parameters {
            p.belief = p.belief.map(Belief::normal);
        }
        self
    }

    /// What the user demands of parameters.
    pub(in crate::gap) fn demands(&self) -> &Directives {
        &self.demands
    }

    /// The same model, in which one unit of deviance weighs so much in the criterion \[rad^2 s\].
    pub(in crate::gap) fn in_unit(mut self, unit_rad2_s: f64) -> Self {
        self.unit_rad2_s = unit_rad2_s;
        self
    }

    /// Deviance of values under the beliefs.
    pub(in crate::gap) fn strain(&self, values: &[f64]) -> f64 {
        let free = self.parameters.iter().zip(values).filter(|(p, _)| !p.fixed);
        let strain = |(p, v): (&Parameter, &f64)| {
            let x = p.to_coordinate(*v);
            p.known_of().map(|belief| belief.strain(x)[0].powi(2)).sum::<f64>()
        };
        free.map(strain).sum()
    }

    /// The same joint with one effect more; a joint with a law has all its effects.
    pub(crate) fn with(&self, effect: impl Into<EffectForm>, reach: &Reach) -> Self {
        let (mut more, form) = (self.clone(), effect.into());
        more.effects.push(form.id);
        more.forms.push(form);
        more.only.push(None);
        if form.id == EffectId::MotorGain {
            // The effect is the number without what is believed of it.
            let gain = &mut more.parameters[GAIN];
            (gain.fixed, gain.start) = (true, 1.0);
        }
        let seen = self.parameters[GAIN].seen.filter(|_| form.id == EffectId::MotorGain);
        more.parameters.extend(parameters_of(form, reach).into_iter().map(|mut p| {
            p.seen = seen;
            self.demands.impose(&mut p);
            p
        }));
        more
    }

    /// The same joint with a law beside its effects.
    pub(in crate::gap) fn with_law(&self, law: LawShape) -> Self {
        let mut more = self.without_law();
        more.parameters.extend(law.parameters());
        Self { law: Some(law), ..more }
    }

    /// The same joint without its law.
    pub(in crate::gap) fn without_law(&self) -> Self {
        let mut less = self.clone();
        less.parameters.truncate(self.law_place().start);
        less.law = None;
        less
    }

    /// The law.
    pub(in crate::gap) fn law(&self) -> Option<&LawShape> {
        self.law.as_ref()
    }

    /// Where the law's numbers stand, behind all others.
    pub(in crate::gap) fn law_place(&self) -> std::ops::Range<usize> {
        let end = self.parameters.len();
        end - self.law.as_ref().map_or(0, LawShape::count)..end
    }

    /// The same joint, whose effect number `k` holds in some logs only.
    pub(crate) fn only_in(mut self, k: usize, logs: Arc<LogSet>) -> Self {
        self.only[k] = Some(logs);
        self
    }

    /// The logs in which each effect holds; `None`: all.
    pub(in crate::gap) fn only(&self) -> &[Option<Arc<LogSet>>] {
        &self.only
    }

    /// Whether a number, by index, may be tried with values of its own in some logs.
    pub(in crate::gap) fn may_differ(&self, number: usize) -> bool {
        let is_known = self.is_held_by_demand(number) || (self.parameters[number].fixed && number != REST);
        !is_known && self.differing.iter().all(|d| d.number != number)
    }

    /// The same joint, of which a number has a value of its own in each of these sets of logs; the values stand last, and
    /// nothing is added to such a joint.
    pub(in crate::gap) fn differing(mut self, number: usize, sets: Vec<Arc<LogSet>>) -> Self {
        let first = self.parameters.len();
        let own = Parameter { fixed: false, ..self.parameters[number].clone() };
        self.parameters.extend(sets.iter().map(|_| own.clone()));
        let own = sets.into_iter().enumerate().map(|(i, set)| (set, first + i)).collect();
        self.differing.push(Differing { number, own });
        self
    }

    /// Where the value of a number stands that holds in an experiment.
    fn at_experiment(&self, number: usize, experiment: &Experiment) -> usize {
        let own = self.differing.iter().filter(|d| d.number == number).flat_map(|d| &d.own);
        own.into_iter().find(|(set, _)| set.holds(experiment)).map_or(number, |(_, at)| *at)
    }

    /// Choices that were made about logs: effects that hold in some only, and values of numbers beyond one for all.
    pub(in crate::gap) fn choices_of_logs(&self) -> (usize, usize) {
        let restricted = self.only.iter().flatten().count();
        (restricted + self.differing.len(), self.differing.iter().map(|d| d.own.len() - 1).sum())
    }

    /// The same model with parameters held at the values given, by index.
    pub(in crate::gap) fn holding(mut self, held: &[usize], values: &[f64]) -> Self {
        for &i in held {
            self.parameters[i].fixed = true;
            self.parameters[i].start = values[i];
        }
        self
    }

    /// The same model with everything that is not searched at the values given.
    pub(in crate::gap) fn at(mut self, values: &[f64]) -> Self {
        for (parameter, value) in self.parameters.iter_mut().zip(values) {
            if parameter.fixed && self.demands.held(parameter).is_none() {
                parameter.start = *value;
            }
        }
        self.share_gain_seen();
        self
    }

    /// What logged torques show of the drive is of all that arrives: of a gain that is an effect beside the number only the rest.
    fn share_gain_seen(&mut self) {
        let Some(k) = self.effects.iter().position(|e| *e == EffectId::MotorGain) else { return };
        let gain = &self.parameters[GAIN];
        let known = gain.to_coordinate(gain.start) - gain.to_coordinate(1.0);
        let seen = gain.seen.map(|seen| Belief { at: seen.at - known, ..seen });
        let place = self.place(k).start;
        self.parameters[place].seen = seen;
    }

    /// The model with these of its effects only, and what is left of a set of its values.
    ///
    /// `bare` is the joint without effects, `reach` that of its logs.
    pub(in crate::gap) fn keeping(
        &self,
        values: &[f64],
        kept: &[usize],
        bare: Self,
        reach: &Reach,
    ) -> (Self, Vec<f64>) {
        let mut model = bare.in_unit(self.unit_rad2_s);
        let mut left = values[..BASELINE].to_vec();
        for (i, &k) in kept.iter().enumerate() {
            model = model.with(self.forms[k], reach);
            model.only[i].clone_from(&self.only[k]);
            left.extend(&values[self.place(k)]);
        }
        if let Some(law) = &self.law {
            model = model.with_law(law.clone());
            left.extend(&values[self.law_place()]);
        }
        (model, left)
    }

    /// The model with effect number `k` in another form, and values from which to fit it.
    ///
    /// `bare` is the joint without effects, `reach` that of its logs.
    pub(in crate::gap) fn reformed(
        &self,
        values: &[f64],
        (k, form): (usize, EffectForm),
        bare: Self,
        reach: &Reach,
    ) -> (Self, Vec<f64>) {
        let mut model = bare.in_unit(self.unit_rad2_s);
        let mut there = values[..BASELINE].to_vec();
        for (i, &own) in self.forms.iter().enumerate() {
            let as_it_was = &values[self.place(i)];
            if i == k {
                model = model.with(form, reach);
                there.extend(form.from_other(as_it_was, reach));
            } else {
                model = model.with(own, reach);
                there.extend(as_it_was);
            }
            model.only[i].clone_from(&self.only[i]);
        }
        (model, there)
    }

    /// The effects, in the order in which they were added.
    pub(in crate::gap) fn effects(&self) -> &[EffectId] {
        &self.effects
    }

    /// Whether motor side and link move apart: such a motion takes many short steps.
    pub(in crate::gap) fn has_two_bodies(&self) -> bool {
        self.effects.iter().any(|e| e.parts_two_bodies())
    }

    /// The forms in which they are there.
    pub(in crate::gap) fn forms(&self) -> &[EffectForm] {
        &self.forms
    }

    /// Where the values of the `k`-th effect stand.
    pub(in crate::gap) fn place(&self, k: usize) -> std::ops::Range<usize> {
        let from = BASELINE + self.forms[..k].iter().map(|e| e.searched_count()).sum::<usize>();
        from..from + self.forms[k].searched_count()
    }

    /// Whether effect number `k` has come to where it is none: what is then better is how its motion is computed.
    pub(in crate::gap) fn has_no_size(&self, values: &[f64], k: usize) -> bool {
        let form = self.forms()[k];
        match (&form.named(&values[self.place(k)], values[COULOMB])[..], form.named_parameters()) {
            ([size], [named]) => (size - named.zero).abs() < NO_SIZE,
            // One of several may be none without the others being so.
            _ => false,
        }
    }

    /// Free parameters.
    pub(in crate::gap) fn free(&self) -> usize {
        self.parameters.iter().filter(|p| !p.fixed).count()
    }
}

/// Parameters of an effect as they are searched, with what is believed of them before a log is seen; each with the
/// effect's id before its name, e.g. `delay.T`.
pub(in crate::gap) fn parameters_of(form: EffectForm, reach: &Reach) -> Vec<Parameter> {
    let searched = |p: EffectParameter| {
        let search = match p.scan {
            Scan::Logarithm => Search::Logarithm,
            Scan::Linear(scale) => Search::Linear { scale },
            Scan::Held => Search::Linear { scale: 1.0 },
        };
        let parameter = Parameter {
            search,
            lower: p.lower,
            upper: p.upper,
            fixed: p.scan == Scan::Held,
            start: p.lower,
            ..Parameter::positive(format!("{}.{}", form.id, p.name), p.name, p.unit, None, p.lower)
        };
        let belief = p.likely.map(|[middle, sd]| Belief::new(parameter.to_coordinate(middle), sd));
        Parameter { belief, ..parameter }
    };
    let mut parameters: Vec<Parameter> = form.parameters(reach).into_iter().map(searched).collect();
    if let Some(first) = parameters.first_mut() {
        first.belief = first.belief.or(plausible(form.id));
    }
    parameters
}

/// What any engineer believes of an effect's size before a log is seen, where that says something: encoders are not wrong
/// by halves, and drives do not wait for tenths of seconds.
fn plausible(effect: EffectId) -> Option<Belief> {
    let sd = match effect {
        EffectId::SensorGain => 0.05,
        EffectId::MotorGain => 0.4,
        EffectId::AngleOffset => 0.15,
        EffectId::Delay | EffectId::SensorDelay => 0.05,
        _ => return None,
    };
    Some(Belief::new(0.0, sd))
}

impl JointModel for GapModel {
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
        let rest = values[self.at_experiment(REST, experiment)];
        let mut link = Link::new(values[INERTIA], values[MOMENT], rest, experiment.gravity_m_s2);
        if let Some(load) = &experiment.load {
            let (inertia, moment) = (T::constant(load.inertia_kg_m2), T::constant(load.moment_kg_m));
            link = link.joined(Link::new(inertia, moment, rest + load.angle_rad, experiment.gravity_m_s2));
        }
        let mut motor = experiment.driven_by();
        if let Some(motor) = &mut motor {
            motor.gain = values[self.at_experiment(GAIN, experiment)];
            motor.derivative_share = values[DERIVATIVE];
            motor.integral_share = values[INTEGRAL];
        }
        let coulomb_nm = values[self.at_experiment(COULOMB, experiment)];
        let friction = Friction::coulomb_viscous(coulomb_nm, values[VISCOUS]);
        let mut chain = Chain::new(link, friction, motor).geared(experiment.motor.as_ref());
        if let (Some(believed_kg_m2), Some(spec)) = (self.parameters[INERTIA].nominal, &experiment.motor) {
            chain.armature_kg_m2 = armature_kg_m2(spec.armature_kg_m2, values[INERTIA] / believed_kg_m2);
        }
        chain.carriage.clone_from(&experiment.carriage);
        let mut rest_of = &values[BASELINE.min(values.len())..];
        for (effect, only) in self.forms.iter().zip(&self.only) {
            let (own, later) = rest_of.split_at(effect.searched_count());
            if only.as_ref().is_none_or(|logs| logs.holds(experiment)) {
                effect.apply(own, values[INERTIA], &mut chain);
            }
            rest_of = later;
        }
        if let Some(law) = &self.law {
            law.apply(rest_of, &mut chain);
        }
        chain
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gap::hypothesis::evidence::Evidence;
    use crate::identify::Case;

    #[test]
    fn of_a_gain_that_is_seen_an_effect_beside_the_number_has_the_rest() {
        let case = Case::of_study("data/examples/delay/study.toml".as_ref()).unwrap();
        let evidence = Evidence::of(&case, case.joint.nominal.unwrap()).unwrap();
        let seen = Belief::new(0.7_f64.ln(), 0.05);
        let numbers = evidence.baseline().with_gain_seen(Some(seen));
        let mut values: Vec<f64> = numbers.parameters().iter().map(|p| p.start).collect();
        values[GAIN] = 0.8;
        let model = numbers.with(EffectId::MotorGain, &evidence.reach).at(&values);
        let of_effect = model.parameters().last().unwrap().seen.unwrap();
        approx::assert_relative_eq!(of_effect.at, (0.7_f64 / 0.8).ln(), max_relative = 1e-12);
        let again = model.at(&values).parameters().last().unwrap().seen.unwrap();
        assert_eq!(again.at, of_effect.at);
    }
}
