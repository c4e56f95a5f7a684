//! What a user demands of the numbers of a study and of parameters of effects: `--fix`, `--free`, `--bound`, `--start`.

use super::evidence::Evidence;
use super::model::{DERIVATIVE, GAIN, GapModel, INTEGRAL, parameters_of};
use crate::identify::{DirectiveError, Directives, JointModel, Parameter};
use crate::joint::{EffectForm, EffectId, Scan};
use std::collections::BTreeSet;

/// The demands with the effect's id before each of its parameters, or why they cannot be met.
///
/// # Errors
/// [`DirectiveError`] where a name means nothing or several things, or a value is impossible.
pub(in crate::gap) fn resolved(asked: &Directives, evidence: &Evidence) -> Result<Directives, DirectiveError> {
    let baseline = evidence.baseline();
    let forms = || EffectId::ALL.iter().flat_map(|effect| effect.forms());
    // What no drive shows is no number of this study.
    let driven = evidence.reach.driven;
    let is_there = |(i, _): &(usize, &Parameter)| match *i {
        GAIN => driven.is_some(),
        DERIVATIVE => driven.is_some_and(|driven| driven.by_derivative),
        INTEGRAL => driven.is_some_and(|driven| driven.by_integral),
        _ => true,
    };
    let numbers = baseline.parameters().iter().enumerate().filter(is_there).map(|(_, p)| p.clone());
    let effects = forms().flat_map(|form| parameters_of(form, &evidence.reach));
    let mut known: Vec<Parameter> = numbers.chain(effects).collect();
    let with_effect = |name: &str| -> BTreeSet<&str> {
        let named = known.iter().filter(|p| p.name.split_once('.').is_some_and(|(_, own)| own == name));
        named.map(|p| p.name.as_str()).collect()
    };
    for name in asked.names() {
        let several = with_effect(name);
        if several.len() > 1 {
            let known = several.into_iter().collect::<Vec<_>>().join(" or ");
            return Err(DirectiveError::Ambiguous { name: name.to_owned(), known });
        }
    }
    if let Some(error) = asked.names().find_map(|name| printed(name, evidence)) {
        return Err(error);
    }
    let full = |name: &str| with_effect(name).first().map_or(name, |full| full).to_owned();
    let demands = asked.renamed(full);
    demands.check_names(&[&known])?;
    demands.apply(&mut known)?;
    forms().try_for_each(|form| possible(&demands, form, evidence))?;
    Ok(demands)
}

/// Why nothing can be demanded of a number that outputs print, where it stands for others that are searched.
fn printed(name: &str, evidence: &Evidence) -> Option<DirectiveError> {
    let own = name.split_once('.').map_or(name, |(_, own)| own);
    let of = |effect: &EffectId| {
        let (printed, searched) = (effect.named_parameters(), effect.forms().next()?.parameters(&evidence.reach));
        let is_asked = name == own || name.split_once('.').is_some_and(|(id, _)| id == effect.id());
        let is_printed = printed.iter().any(|p| p.name == own) && searched.iter().all(|p| p.name != own);
        let others = searched.iter().filter(|p| printed.iter().all(|named| named.name != p.name));
        let known: Vec<String> = others.map(|p| format!("{}.{}", effect.id(), p.name)).collect();
        (is_asked && is_printed).then(|| DirectiveError::Printed { name: name.to_owned(), known: known.join(" and ") })
    };
    EffectId::ALL.iter().find_map(of)
}

/// Whether the values demanded of an effect's parameters are some that a joint may have.
fn possible(demands: &Directives, form: EffectForm, evidence: &Evidence) -> Result<(), DirectiveError> {
    let searched = form.parameters(&evidence.reach);
    for ((p, own), named) in parameters_of(form, &evidence.reach).iter().zip(&searched).zip(form.named_parameters()) {
        let allowed = || named.bounds.to_string();
        let is_searched = demands.free.contains(&p.name) || demands.bound.iter().any(|(name, _)| *name == p.name);
        if own.scan == Scan::Held && is_searched {
            return Err(DirectiveError::NotSearched { name: p.name.clone(), allowed: allowed() });
        }
        // Where the two have different names they are different quantities.
        let values = demands.held(p).into_iter().chain(demands.begun(p));
        if let Some(value) = values.into_iter().find(|value| own.name == named.name && !named.bounds.admit(*value)) {
            let (name, unit) = (p.name.clone(), p.unit.clone());
            return Err(DirectiveError::Impossible { name, value, unit, allowed: allowed() });
        }
    }
    Ok(())
}

impl GapModel {
    /// Whether the user holds a parameter, by index.
    pub(in crate::gap) fn is_held_by_demand(&self, i: usize) -> bool {
        self.demands().held(&self.parameters()[i]).is_some()
    }

    /// Values brought to where the demands allow them.
    pub(in crate::gap) fn allowed(&self, values: &[f64]) -> Vec<f64> {
        let mut values = values.to_vec();
        let demands = self.demands();
        if !demands.is_empty() {
            for (value, p) in values.iter_mut().zip(self.parameters()) {
                let bounds = demands.bound.iter().find(|(name, _)| *name == p.name);
                *value = bounds.map_or(*value, |(_, [low, high])| value.clamp(*low, *high));
                *value = demands.held(p).unwrap_or(*value);
            }
        }
        values
    }

    /// Starting points of the effect that was added last, as the demands allow them.
    pub(in crate::gap) fn allowed_starts(&self, starts: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        let Some(k) = self.forms().len().checked_sub(1).filter(|_| !self.demands().is_empty()) else { return starts };
        let place = self.place(k);
        let mut allowed: Vec<Vec<f64>> = Vec::new();
        for start in starts {
            let begun = self.parameters()[place.clone()].iter().zip(&start);
            let begun = begun.map(|(p, own)| self.demands().begun(p).unwrap_or(*own));
            let before = self.parameters()[..place.start].iter().map(|p| p.start);
            let start = self.allowed(&before.chain(begun).collect::<Vec<f64>>()).split_off(place.start);
            if !allowed.contains(&start) {
                allowed.push(start);
            }
        }
        allowed
    }
}

/// Demands in a sentence; `None` where there are none.
pub(in crate::gap) fn in_words(demands: &Directives) -> Option<String> {
    let value = |name: &String, value: &Option<f64>| match value {
        Some(value) => format!("{name} held at {value}"),
        None => format!("{name} held as given"),
    };
    let fixed = demands.fix.iter().map(|(name, at)| value(name, at));
    let freed = demands.free.iter().map(|name| format!("{name} searched whatever is believed of it"));
    let bounded = demands.bound.iter().map(|(name, [low, high])| format!("{name} searched between {low} and {high}"));
    let started = demands.start.iter().map(|(name, at)| format!("{name} searched from {at}"));
    let all: Vec<String> = fixed.chain(freed).chain(bounded).chain(started).collect();
    (!all.is_empty()).then(|| format!("As demanded: {}.", all.join("; ")))
}
