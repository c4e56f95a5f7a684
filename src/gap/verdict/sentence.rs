//! The answer as a sentence that a colleague would say.

use super::decide::{Decision, leaves_something};
use super::numbers::includes_none;
use crate::gap::diagnosis::{CauseShare, Gap, LawFound, Number, Verdict};
use crate::gap::hypothesis::evidence::{Evidence, WholeLeft};
use crate::gap::hypothesis::model::{COULOMB, INERTIA};
use crate::gap::hypothesis::rotor::armature_kg_m2;
use crate::gap::hypothesis::trial::Trial;
use crate::identify::{BeliefFound, Estimate, JointModel};
use crate::joint::{EffectId, LawActs, LawTable};
use crate::number::{mrad, quantity, share, significant};

/// Words for an effect.
pub(in crate::gap) fn words(effect: EffectId) -> &'static str {
    match effect {
        EffectId::Stribeck => "static friction above Coulomb's (Stribeck)",
        EffectId::LoadFriction => "friction that grows with the load",
        EffectId::GearFriction => "friction that grows with the motor torque",
        EffectId::QuadraticDrag => "drag that grows with the square of the speed",
        EffectId::AsymmetricFriction => "Coulomb friction that differs with the direction",
        EffectId::PositionFriction => "Coulomb friction that varies with the angle",
        EffectId::FrictionDrift => "friction that changes along a log",
        EffectId::Backlash => "free play between motor and link",
        EffectId::JointSpring => "a spring in parallel to the joint",
        EffectId::EndStop => "a stop inside the range of motion",
        EffectId::AngleOffset => "a wrong zero of the angle",
        EffectId::SensorGain => "a wrong gain of the encoder",
        EffectId::Compliance => "a spring between motor and link",
        EffectId::SensorDelay => "a reading that is late",
        EffectId::SetpointProfile => "a servo that limits speed and acceleration of its setpoint",
        EffectId::DeadBand => "small motor torques that do not arrive",
        EffectId::Delay => "a delay of the setpoint",
        EffectId::SetpointHold => "setpoints that get through only every so often",
        EffectId::TorqueLimit => "a motor torque that saturates",
        EffectId::SpeedLimit => "a motor torque that falls with speed",
        EffectId::MotorGain => "a motor that delivers more or less than commanded",
    }
}

/// The logs in which an effect holds, where it does not hold in all.
fn only(decision: &Decision<'_>, effect: EffectId) -> String {
    let model = &decision.answer.model;
    let set = model.effects().iter().position(|e| *e == effect).and_then(|k| model.only()[k].as_ref());
    set.map_or(String::new(), |set| format!(" {}", set.words))
}

/// How so many causes are meant once they were named; a law that stands beside them is said, for it closes a part as well.
pub(in crate::gap) fn them(causes: usize, has_law: bool) -> String {
    let causes = match causes {
        0 if has_law => return "a law".to_owned(),
        0 | 1 => "it",
        2 => "both",
        _ => "all of them",
    };
    if has_law { format!("{causes} and a law") } else { causes.to_owned() }
}

/// The error as given, with refitted numbers and with the causes, and what these close of what the numbers leave.
///
/// All in rad, with the sensor's noise last; `refitted` is what the second one is with, `them` what the third is with.
pub(in crate::gap) fn closing(figures: [f64; 4], refitted: &str, them: &str) -> String {
    closing_in(figures, refitted, them, mrad)
}

/// The same of errors in any unit, each written by `with_unit`.
pub(in crate::gap) fn closing_in(
    [before, calibrated, after, floor]: [f64; 4],
    refitted: &str,
    them: &str,
    with_unit: fn(f64) -> String,
) -> String {
    let closed = closed_of_left([before, calibrated, after, floor], "what they leave");
    let [before, calibrated, after] = [before, calibrated, after].map(with_unit);
    match closed {
        None => format!("the error goes from {before} as given to {after} with {them}"),
        Some(closed) => format!(
            "the error goes from {before} as given to {calibrated} with {refitted} and to {after} with {them}, which closes \
             {closed}"
        ),
    }
}

/// Refitted numbers that predict so many times the error as given are no help.
const WORSE: f64 = 1.05;

/// Share that causes close of what refitted numbers leave, where these leave anything, called so; of the error as given where
/// numbers without them predict clearly worse than that. Errors are as [`closing`] has them.
fn closed_of_left([before, calibrated, after, floor]: [f64; 4], whose: &str) -> Option<String> {
    let (from, whose) = if calibrated > WORSE * before { (before, "the error as given") } else { (calibrated, whose) };
    let left = from - floor;
    (left > 0.0).then(|| format!("{} of {whose}", share(((from - after) / left).clamp(0.0, 1.0))))
}

/// What causes make of the error, once it was said what refitted numbers make of it; errors as [`closing`] has them.
fn closing_rest(figures: [f64; 4], them: &str) -> String {
    let closed = closed_of_left(figures, "what the numbers leave");
    let closed = closed.map_or(String::new(), |closed| format!(", which closes {closed}"));
    format!("with {them} the error is {}{closed}", mrad(figures[2]))
}

/// Numbers that are said.
const SAID: usize = 3;

/// `lf3.coulomb 0.030 N m instead of 0.010 N m (4.0 standard deviations of its belief)`
pub(in crate::gap) fn moved(beliefs: &[&BeliefFound]) -> String {
    let of = |belief: &&BeliefFound| {
        let [found, believed] = [belief.found, belief.believed].map(|value| quantity(value, None, &belief.unit));
        format!(
            "{} {found} instead of {believed} ({:.1} standard deviations of its belief)",
            number_words(&belief.name),
            belief.moved_sd.abs()
        )
    };
    let more = beliefs.len().saturating_sub(SAID);
    let said = beliefs.iter().take(SAID).map(of).collect::<Vec<_>>().join(", ");
    if more > 0 { format!("{said} and {more} more") } else { said }
}

/// That numbers are far from what was believed of them, where any are.
pub(in crate::gap) fn far(broken: &[&BeliefFound]) -> Option<String> {
    (!broken.is_empty()).then(|| format!(" To fit, numbers had to move far from what was stated: {}.", moved(broken)))
}

/// What would do the same as a drive that delivers `gain` times what it is asked for, where logs show ratios of torques alone.
pub(in crate::gap) fn link_instead(gain: f64) -> String {
    format!(
        " These logs show torques only against one another: a joint whose inertia, moment and friction are {} times what is stated \
         would do the same.",
        significant(gain.recip(), 3)
    )
}

/// A number of a joint in a sentence, by the name of its key.
pub(crate) fn number_words(name: &str) -> &str {
    match name {
        "coulomb" => "Coulomb friction",
        "viscous" => "viscous friction",
        "kd" => "ratio of kd to kp",
        other => other,
    }
}

/// What became of the armature, as a sentence to follow that of the inertia; `None` where the study states none.
pub(in crate::gap) fn armature_words(evidence: &Evidence, answer: &Trial) -> Option<String> {
    let stated_kg_m2 = evidence.fit.iter().find_map(|e| e.motor)?.armature_kg_m2;
    let share = answer.found.values[INERTIA] / answer.model.parameters()[INERTIA].nominal?;
    let told = |value: f64| quantity(value, None, "kg m^2");
    (stated_kg_m2 > 0.0).then(|| {
        let [found, stated] = [armature_kg_m2(stated_kg_m2, share), stated_kg_m2].map(told);
        format!(" The armature goes with the inertia: {found} instead of {stated}.")
    })
}

/// A law that closes less than this share has told next to nothing.
const NEXT_TO_NOTHING: f64 = 0.05;

/// What a law without a name is, and what it looks like.
pub(in crate::gap) fn law_words(table: &LawTable) -> String {
    let what = match table.acts {
        LawActs::Torque => "a torque",
        LawActs::Friction => "a friction",
        LawActs::Reading => "a shift of the reading",
        LawActs::Gain => "a share of the motor's torque",
    };
    let of: Vec<&str> = table.variables.iter().map(|variable| variable.words()).collect();
    format!("{what} that depends on the {} ({})", of.join(" and the "), table.looks_like)
}

/// What a law is, and what it closes.
fn unnamed(law: &LawFound) -> String {
    let table = &law.table;
    let closed = |closed: f64| match closed < NEXT_TO_NOTHING {
        true => "; it closes next to nothing of what refitted numbers leave".to_owned(),
        false => format!("; it closes {} of what refitted numbers leave", share(closed)),
    };
    let closed = table.closed.map_or(String::new(), closed);
    format!("there is {}{closed}.", law_words(table))
}

/// Where refitted numbers leave less than this share of the error, that is said first.
const MOST_BY_NUMBERS: f64 = 0.7;

/// With what the error is told that causes close.
pub(in crate::gap) const REFITTED: &str = "refitted numbers";
/// The same of a joint that carries bodies which are other than described.
const WITH_BODIES: &str = "refitted numbers and masses";

/// Where causes leave more than so many times the sensor's noise they are a part of the gap, not all of it.
pub(in crate::gap) const MUCH_LEFT: f64 = 3.0;
/// What closes less than this share of the whole gap above the noise is not most of it: refitted numbers may have closed more.
const MOST: f64 = 0.5;

/// How much of the gap causes are, and what they leave where that is much; errors as [`closing`] has them. `of_parts`: of
/// the only log, parts were predicted from others; how many times the noise is left of it where all was fitted.
fn of_the_gap([before, calibrated, after, floor]: [f64; 4], of_parts: Option<f64>) -> (&'static str, String) {
    if !(after > MUCH_LEFT * floor) {
        return ("the gap is", String::new());
    }
    if of_parts.is_some_and(|fitted| !leaves_something(fitted, 1.0)) {
        let rest =
            " Where all was fitted only noise is left: the rest is left where parts were predicted from the others.";
        return ("the gap is", rest.to_owned());
    }
    let closes_most = before.min(calibrated) - after >= MOST * (before - floor);
    let [after, floor] = [after, floor].map(mrad);
    let left = format!(" Something else is left: the sensor itself makes no more than {floor} of these {after}.");
    (if closes_most { "most of the gap is" } else { "a part of the gap is" }, left)
}

/// How far a joint that lacks nothing is explained.
fn to_the_noise(gap: &Gap) -> String {
    let [after, floor] = [gap.after, gap.floor].map(mrad);
    match leaves_something(gap.after, gap.floor) {
        true => format!("but for {after}, which is no alarm (noise {floor})"),
        false => format!("to the sensor's noise ({after} against {floor})"),
    }
}

/// Where joints that lack nothing are off along the measured motion of the others, and not where all are simulated at once.
pub(in crate::gap) fn followed(verdict: Verdict, gap: &Gap, whole: Option<WholeLeft>) -> Option<String> {
    let found_rad = whole?.found_rad;
    let is_off = matches!(verdict, Verdict::None | Verdict::Calibration) && leaves_something(gap.after, gap.floor);
    (is_off && !leaves_something(found_rad, gap.floor)).then(|| {
        format!(
            " With all joints simulated at once {} are left: the rest is how well the logs show what the others do.",
            mrad(found_rad)
        )
    })
}

/// What the logs cannot tell the first cause from, and each of the others.
fn apart_from(first: EffectId, equivalent: &[EffectId], causes: &[CauseShare]) -> String {
    let others = |own: EffectId, all: &[EffectId]| -> Option<String> {
        let others: Vec<&str> = all.iter().filter(|e| **e != own).map(|e| words(*e)).collect();
        (!others.is_empty()).then(|| others.join(", nor from "))
    };
    let name = if causes.len() > 1 { words(first) } else { "it" };
    let of_first = others(first, equivalent).map(|others| format!("{name} apart from {others}"));
    let further = causes.iter().filter(|cause| cause.effect != first);
    let further = further.filter_map(|cause| {
        Some(format!("{} apart from {}", words(cause.effect), others(cause.effect, &cause.equivalent)?))
    });
    let all: Vec<String> = of_first.into_iter().chain(further).collect();
    if all.is_empty() { String::new() } else { format!(" These logs cannot tell {}.", all.join(", nor ")) }
}

/// `, the Coulomb friction most of all (0.92 [0.90, 0.94] N m instead of 0.155 N m)`; nothing where the number that moved most
/// may be as believed. What it is instead is told elsewhere of one that is `far` from that.
fn most_of_all(most: Option<&Estimate>, far: &[BeliefFound]) -> String {
    let told = |most: &Estimate| {
        let (instead, is_far) = (most.instead()?, far.iter().any(|own| own.is_finding() && own.name == most.name));
        let instead = if is_far { String::new() } else { format!(" ({instead})") };
        Some(format!(", the {} most of all{instead}", number_words(&most.name)))
    };
    most.and_then(told).unwrap_or_default()
}

/// The sentence of a decision; `most` is the number that moved most, `has_bodies` whether the joint carries bodies that are
/// other than described: as given it is told without them.
pub(in crate::gap) fn sentence(
    joint: &str,
    decision: &Decision<'_>,
    gap: &Gap,
    most: Option<&Estimate>,
    (effects, causes): (&[(EffectId, Vec<Number>)], &[CauseShare]),
    law: Option<&LawFound>,
    has_bodies: bool,
) -> String {
    let refitted = if has_bodies { WITH_BODIES } else { REFITTED };
    let size = |effect: EffectId| {
        let number = effects.iter().find(|(e, _)| *e == effect).and_then(|(_, numbers)| numbers.first());
        number.map_or(String::new(), |n| format!(" ({} = {})", n.name, quantity(n.value, n.interval, &n.unit)))
    };
    let figures = [gap.before, gap.calibrated, gap.after, gap.floor];
    let together = |causes: &[EffectId]| {
        let each: Vec<String> =
            causes.iter().map(|&e| format!("{}{}{}", words(e), size(e), only(decision, e))).collect();
        each.join(", together with ")
    };
    let all = || together(&decision.effects);
    let them = them(decision.effects.len(), law.is_some());
    let coulomb_nm = decision.answer.found.values[COULOMB];
    let includes_none = |(e, numbers): &(EffectId, Vec<Number>)| includes_none(*e, numbers, coulomb_nm);
    let may_be_none = |effect: &EffectId| effects.iter().any(|own| own.0 == *effect && includes_none(own));
    let beliefs = decision.answer.beliefs();
    let is_far = beliefs.iter().any(BeliefFound::is_finding);
    let logs = if gap.is_held_out() { "held-out logs" } else { "logs" };
    match (decision.verdict, decision.effect()) {
        (Verdict::None, _) if has_bodies => format!(
            "{joint}: nothing is missing beside the bodies that it carries. With them as found the {logs} are explained \
             {}; as described it was {} off.",
            to_the_noise(gap),
            mrad(gap.before)
        ),
        (Verdict::None, _) => {
            format!("{joint}: nothing is missing. The model as given explains the {logs} {}.", to_the_noise(gap))
        }
        (Verdict::Calibration, _) => {
            let most = most_of_all(most, &beliefs);
            let within = if is_far { "" } else { " within what is believed of them" };
            let [before, after, floor] = [gap.before, gap.after, gap.floor].map(mrad);
            match has_bodies {
                true => format!(
                    "{joint}: what it carries is other than described. With the bodies as found, and numbers refitted{within}{most}, \
                     the error goes from {before} to {after} (noise {floor})."
                ),
                false => format!(
                    "{joint}: the structure is right and the numbers are off{most}; refitting them{within} takes the error from \
                     {before} to {after} (noise {floor})."
                ),
            }
        }
        (Verdict::Effect, Some(effect)) => {
            let fitted = (1.0 + decision.excess).max(0.0).sqrt();
            let (how_much, left) = of_the_gap(figures, Some(fitted).filter(|_| gap.is_of_parts()));
            // A gain of the drive that is the answer as a number closed what it closes among these.
            let goes = match decision.answer.effects() {
                [] => {
                    let [before, after] = [gap.before, gap.after].map(mrad);
                    format!("the error goes from {before} as given to {after} with {refitted}, that gain among them")
                }
                _ => closing(figures, refitted, &them),
            };
            let mut text = format!("{joint}: {how_much} {}; {goes}.{left}", all());
            let open =
                decision.effects.iter().copied().filter(may_be_none).map(words).collect::<Vec<_>>().join(" and of ");
            if !open.is_empty() {
                text += &format!(" The interval of {open} includes none: these logs do not agree on its size.");
            }
            text += &apart_from(effect, &decision.equivalent, causes);
            text.extend(law.map(|law| format!(" Beside it {}", unnamed(law))));
            text
        }
        (_, partial) => {
            let (open, sure): (Vec<EffectId>, Vec<EffectId>) = decision.effects.iter().partition(|e| may_be_none(e));
            let known = match (&sure[..], &open[..]) {
                (sure, []) => format!("What is known so far is {}", together(sure)),
                ([], open) => format!("Perhaps there is {}, whose interval includes none", together(open)),
                (sure, open) => format!(
                    "What is known so far is {}; perhaps there is also {}, whose interval includes none",
                    together(sure),
                    together(open)
                ),
            };
            let unnamed = law.map_or(String::new(), |law| format!(" Without a name {}", unnamed(law)));
            let apart = partial.map_or(String::new(), |first| apart_from(first, &decision.equivalent, causes));
            let [before, calibrated, after, floor] = figures.map(mrad);
            let stays = format!("{after} are left, and the sensor itself makes {floor}");
            if gap.calibrated < MOST_BY_NUMBERS * gap.before {
                let most = most_of_all(most, &beliefs);
                let comma = if most.is_empty() { "" } else { "," };
                let beside = if has_bodies { " and the masses" } else { "" };
                let numbers =
                    format!("refitting the numbers{beside}{most}{comma} takes the error from {before} to {calibrated}");
                return match partial {
                    Some(_) => format!(
                        "{joint}: {numbers}. {known}; {}.{apart} The effects I know do not explain the rest: the sensor \
                         itself makes {floor}.{unnamed}",
                        closing_rest(figures, &them)
                    ),
                    None => {
                        format!("{joint}: {numbers}; the effects I know do not explain the rest: {stays}.{unnamed}")
                    }
                };
            }
            let nearest =
                partial.map_or(String::new(), |_| format!(" {known}; {}.{apart}", closing(figures, refitted, &them)));
            format!("{joint}: the effects I know do not explain this gap; {stays}.{unnamed}{nearest}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn gap(after_mrad: f64, floor_mrad: f64) -> Gap {
        let [after, floor] = [after_mrad, floor_mrad].map(|mrad| 1e-3 * mrad);
        Gap {
            unit: "rad",
            before: after,
            calibrated: after,
            after_first: after,
            after,
            floor,
            closed: None,
            closed_interval: None,
            outer: true,
            held_out: String::new(),
            per_log: Vec::new(),
        }
    }

    #[test]
    fn a_joint_that_lacks_nothing_is_not_said_to_leave_noise_where_it_leaves_more() {
        let whole = |mrad: f64| Some(WholeLeft { bare_rad: 1e-3 * mrad, found_rad: 1e-3 * mrad });
        let (near, far) = (gap(0.52, 0.5), gap(1.68, 0.508));
        assert_eq!(to_the_noise(&near), "to the sensor's noise (0.520 mrad against 0.500 mrad)");
        assert_eq!(to_the_noise(&far), "but for 1.68 mrad, which is no alarm (noise 0.508 mrad)");
        assert!(followed(Verdict::None, &far, whole(0.51)).is_some_and(|words| words.contains("0.510 mrad are left")));
        // Where nothing is off, the whole is off too, or a cause answers for it, there is nothing to add.
        assert_eq!(followed(Verdict::Calibration, &near, whole(0.51)), None);
        assert_eq!(followed(Verdict::Calibration, &far, whole(1.5)), None);
        assert_eq!(followed(Verdict::Effect, &far, whole(0.51)), None);
    }

    #[test]
    fn causes_that_leave_much_are_not_the_whole_gap() {
        let of = |mrad: [f64; 4]| of_the_gap(mrad.map(|mrad| 1e-3 * mrad), None).0;
        assert_eq!(of([75.3, 13.5, 2.91, 2.46]), "the gap is");
        // A servo's single log, of which parts are predicted from the others.
        let left = |of_parts| of_the_gap([0.0303, 0.0234, 0.00233, 0.000433], of_parts).1;
        assert!(left(Some(0.98)).contains("only noise is left"), "{}", left(Some(0.98)));
        // Where logs of their own were held out, or the fit leaves more as well, something else is there.
        assert!([None, Some(3.0)].into_iter().all(|of_parts| left(of_parts).contains("Something else")));
        // The lift of an SO-101, an XL330 that swings freely, an AK80-6 whose numbers are most of its gap.
        assert_eq!(of([29.6, 26.4, 3.56, 0.519]), "most of the gap is");
        assert_eq!(of([29.9, 24.6, 12.7, 0.682]), "a part of the gap is");
        assert_eq!(of([194.0, 28.4, 3.45, 0.146]), "a part of the gap is");
    }

    #[test]
    fn what_a_law_closes_is_not_put_down_to_the_causes_beside_it() {
        let of = |causes, has_law| closing([0.194, 0.0284, 0.0016, 0.0001], REFITTED, &them(causes, has_law));
        assert!(of(2, true).contains("1.60 mrad with both and a law, which closes"), "{}", of(2, true));
        assert!(of(1, false).contains("1.60 mrad with it, which closes"), "{}", of(1, false));
        assert_eq!([them(0, true), them(3, true), them(3, false)], ["a law", "all of them and a law", "all of them"]);
    }

    #[test]
    fn what_refitted_numbers_make_of_the_error_is_not_said_again() {
        let of = |mrad: [f64; 4]| closing_rest(mrad.map(|mrad| 1e-3 * mrad), "it");
        assert_eq!(
            of([65.6, 41.2, 16.8, 1.01]),
            "with it the error is 16.8 mrad, which closes 61 % of what the numbers leave"
        );
        assert_eq!(of([65.6, 1.01, 1.68, 1.01]), "with it the error is 1.68 mrad");
    }

    #[test]
    fn each_cause_says_what_it_cannot_be_told_from() {
        use EffectId::{AsymmetricFriction, Backlash, Compliance, Delay, JointSpring, SpeedLimit, TorqueLimit};
        let cause = |effect, others: &[EffectId]| CauseShare {
            effect,
            form: "",
            only: None,
            equivalent: others.to_vec(),
            parameters: Vec::new(),
            alone: None,
            last: None,
            after: 0.0,
        };
        let causes = [
            cause(TorqueLimit, &[TorqueLimit, SpeedLimit]),
            cause(Delay, &[Delay]),
            cause(Backlash, &[Backlash, Compliance, JointSpring]),
        ];
        assert_eq!(
            apart_from(TorqueLimit, &causes[0].equivalent, &causes),
            " These logs cannot tell a motor torque that saturates apart from a motor torque that falls with speed, nor free play \
             between motor and link apart from a spring between motor and link, nor from a spring in parallel to the joint."
        );
        assert_eq!(
            apart_from(TorqueLimit, &causes[0].equivalent, &causes[..1]),
            " These logs cannot tell it apart from a motor torque that falls with speed."
        );
        let second = [cause(Delay, &[Delay]), cause(AsymmetricFriction, &[AsymmetricFriction, JointSpring])];
        assert_eq!(
            apart_from(Delay, &[Delay], &second),
            " These logs cannot tell Coulomb friction that differs with the direction apart from a spring in parallel to the joint."
        );
        assert_eq!(apart_from(Delay, &[Delay], &second[..1]), "");
    }
}
