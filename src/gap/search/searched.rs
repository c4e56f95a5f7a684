//! Which causes a search finds on fewer samples of the logs: grown, exchanged, and proven.

use super::chance;
use super::explore::{explore, explore_parting};
use super::grow::{Growth, Looked, Pruned};
use super::judged::{Judged, judged};
use super::refuted::refutes;
use crate::gap::hypothesis::calibrate::calibrate;
use crate::gap::hypothesis::evidence::{Evidence, counts};
use crate::gap::hypothesis::floor::noise_rad;
use crate::gap::hypothesis::score::{Measure, is_better};
use crate::gap::hypothesis::trial::{AGAIN, Trial};
use crate::joint::EffectId;
use crate::progress::{Cancelled, Progress, Step};

/// Sets that are carried over from short parts of the logs.
const CARRIED: usize = 2;
/// Motor side and link apart are tried on parts of the logs where other causes leave so many times what is enough.
const MUCH: f64 = 3.0;
/// A share above the noise from which on the search may have ended in a wrong place, and one from which on whole logs are
/// too long for it to begin with.
pub(in crate::gap) const FAR: f64 = 0.5;
const VERY_FAR: f64 = 4.0;
/// A hypothesis whose squared residuals exceed the noise by this share leaves something to explain.
pub(in crate::gap) const LEFT_OVER: f64 = 0.02;

/// What a search found.
pub(in crate::gap) struct Searched {
    /// The samples on which it searched.
    pub coarse: Evidence,
    /// The numbers as given.
    pub as_given: Vec<f64>,
    /// Squares sum to this there where nothing but noise is left \[rad^2\].
    pub enough: f64,
    /// The causes.
    pub judged: Judged,
    /// What else.
    pub known: Known,
}

/// What is known before causes are carried over to all samples.
#[derive(Clone)]
pub(in crate::gap) struct Known {
    pub given: Trial,
    pub calibrated: Trial,
    pub firsts: Vec<Trial>,
    pub noise_rad: f64,
    pub set_refuted: bool,
    /// Whether held-out logs have refuted a law, so that none is looked for.
    pub law_refuted: bool,
}

/// How many samples count.
pub(in crate::gap) fn counted(evidence: &Evidence) -> f64 {
    evidence.fit.iter().map(|e| counts(e).sum::<f64>()).sum()
}

impl Searched {
    /// Searches the catalogue `effects`, from the joint as given on or from a set of causes with which it has begun.
    pub fn of(
        evidence: &Evidence,
        effects: &[EffectId],
        begun: Option<&Trial>,
        progress: &dyn Progress,
    ) -> Result<Self, Cancelled> {
        let coarse = evidence.coarse();
        let search = Search::of(evidence, &coarse, effects, progress)?;
        let (grown, looked, set_refuted) = match begun {
            Some(set) => (search.carried_on(set), Looked::default(), false),
            None => search.grown()?,
        };
        let (judged, known) = search.judged(grown, looked, set_refuted)?;
        let enough = search.growth(known.noise_rad).enough;
        let as_given = search.given.found.values;
        Ok(Self { coarse, as_given, enough, judged, known })
    }
}

/// A search on fewer samples.
struct Search<'a> {
    /// All samples.
    whole: &'a Evidence,
    coarse: &'a Evidence,
    effects: &'a [EffectId],
    given: Trial,
    calibrated: Trial,
    progress: &'a dyn Progress,
}

impl<'a> Search<'a> {
    fn of(
        whole: &'a Evidence,
        coarse: &'a Evidence,
        effects: &'a [EffectId],
        progress: &'a dyn Progress,
    ) -> Result<Self, Cancelled> {
        let baseline = whole.baseline();
        progress.go_on(Step::stage("the joint as given"))?;
        let given = Trial::as_given(coarse, &baseline);
        progress.go_on(Step::stage("recalibrating"))?;
        let calibrated = calibrate(coarse, &baseline, &given);
        progress.go_on(Step::stage("trying causes"))?;
        Ok(Self { whole, coarse, effects, given, calibrated, progress })
    }

    fn stage(&self, stage: &'static str) -> Result<(), Cancelled> {
        self.progress.go_on(Step::stage(stage))
    }

    /// The noise as far as the best that is known shows it.
    fn noise_rad(&self, best: &Trial) -> f64 {
        noise_rad(self.coarse, &[&self.given, &self.calibrated, best])
    }

    fn growth(&self, noise_rad: f64) -> Growth<'_> {
        Growth {
            evidence: self.coarse,
            effects: self.effects,
            as_given: &self.given.found.values,
            enough: counted(self.coarse) * noise_rad.powi(2) * (1.0 + LEFT_OVER),
            progress: self.progress,
        }
    }

    fn exceeds(&self, t: &Trial, share: f64, noise_rad: f64) -> bool {
        t.fit_loss(self.coarse) > counted(self.coarse) * noise_rad.powi(2) * (1.0 + share)
    }

    /// What is less than a step of the encoder may be noise of any colour.
    fn leaves_much(&self, t: &Trial, noise_rad: f64) -> bool {
        let step_rad = self.coarse.reach.resolution_rad;
        self.exceeds(t, FAR, noise_rad) && t.fit_loss(self.coarse) > counted(self.coarse) * step_rad.powi(2)
    }

    /// A set of causes with what it grows to where it leaves something.
    fn carried_on(&self, set: &Trial) -> Trial {
        self.grown_from(set.carried(self.whole, self.coarse, AGAIN))
    }

    fn grown_from(&self, set: Trial) -> Trial {
        let noise_rad = self.noise_rad(&set);
        match !set.effects().is_empty() && self.exceeds(&set, FAR, noise_rad) {
            true => self.growth(noise_rad).from(&set).0,
            false => set,
        }
    }

    /// The best set that grows from the joint as given, what was seen from there, and whether held-out logs refuted another.
    fn grown(&self) -> Result<(Trial, Looked, bool), Cancelled> {
        let (mut best, mut looked, mut set_refuted) = (self.calibrated.clone(), Looked::default(), false);
        let rough_rad = noise_rad(self.coarse, &[&self.given, &self.calibrated]);
        if self.exceeds(&best, VERY_FAR, rough_rad) {
            self.stage("looking at short parts of the logs")?;
            let carried = in_short_parts(self.coarse, &self.growth(rough_rad), &self.calibrated);
            best = carried.into_iter().next().unwrap_or(best);
        }
        let noise_rad = self.noise_rad(&best);
        best = self.grown_from(best);
        if best.effects().is_empty() || self.exceeds(&best, FAR, noise_rad) {
            self.stage("looking at whole logs")?;
            let (other, here) = self.growth(noise_rad).from(&self.calibrated);
            looked = here;
            if is_better(self.coarse, &other, &best) {
                best = other;
            }
        }
        let noise_rad = self.noise_rad(&best);
        if self.leaves_much(&best, noise_rad) {
            self.stage("beginning with other causes")?;
            let suffices = |t: &Trial| !self.leaves_much(t, noise_rad);
            (best, set_refuted) =
                self.growth(noise_rad).begun_elsewhere(self.whole, (&self.calibrated, &looked), best, &suffices);
        }
        Ok((best, looked, set_refuted))
    }

    /// What stays of a grown set, and what is known beside it.
    fn judged(&self, grown: Trial, looked: Looked, mut set_refuted: bool) -> Result<(Judged, Known), Cancelled> {
        let noise_rad = self.noise_rad(&grown);
        let growth = self.growth(noise_rad);
        let Looked { singles: mut firsts, mut sights } = looked;
        // A baseline that has been in the wrong place shows when the effects that found the right one are dropped.
        let mut calibrated = self.calibrated.clone();
        if !grown.effects().is_empty() {
            let bare = grown.keeping(self.coarse, &[], AGAIN);
            if bare.criterion() < 0.999 * calibrated.criterion() {
                calibrated = bare;
                sights.clear();
            }
        }
        self.stage("exchanging causes")?;
        let members = grown.effects().to_vec();
        let pruned = growth.pruned(grown);
        if sights.is_empty() {
            sights = growth.sights(&calibrated, self.effects);
        }
        let chance = chance::threshold(self.coarse, &sights, &pruned.best);
        if firsts.is_empty() {
            firsts = explore(self.coarse, &calibrated, &sights);
        }
        let judge = |pruned: Pruned| judged(&growth, self.whole, pruned, chance, &firsts);
        let mut stays = judge(pruned);
        // What others had stood in for shows once they are gone.
        let went = members.iter().any(|e| !stays.best.effects().contains(e));
        let looks_again = went && !stays.best.effects().is_empty() && self.leaves_much(&stays.best, noise_rad);
        if looks_again && !self.whole.deadline.leaves_out("further causes") {
            self.stage("looking again")?;
            let (again, _) = growth.from(&stays.best);
            if again.effects().len() > stays.best.effects().len() {
                let mut again = judge(growth.pruned(again));
                let score = |t: &Trial| Measure::by(self.coarse, &again.best).score(self.coarse, t);
                if score(&again.best) < score(&stays.best) {
                    if refutes(self.coarse, self.whole, &again.best, &stays.best) {
                        set_refuted = true;
                    } else {
                        again.refuted.extend(stays.refuted);
                        stays = again;
                    }
                }
            }
        }
        let given = self.given.clone();
        Ok((stays, Known { given, calibrated, firsts, noise_rad, set_refuted, law_refuted: false }))
    }
}

/// Sets of effects found on short parts of the logs, on which no hypothesis runs far from its log, carried over.
fn in_short_parts(coarse: &Evidence, growth: &Growth<'_>, calibrated: &Trial) -> Vec<Trial> {
    let short = coarse.in_parts();
    let baseline = coarse.baseline();
    let given = Trial::as_given(&short, &baseline);
    let mut base = calibrate(&short, &baseline, &given);
    // Fitted starts hide what is missing; those that the readings show do not.
    base.found.starts = short.fit.iter().map(|e| e.start_coordinates(&e.start)).collect();
    let inside = Growth { evidence: &short, ..*growth };
    let (best, Looked { singles: mut found, sights }) = inside.from(&base);
    found.truncate(CARRIED - 1);
    // Along whole logs a joint that rings runs away from what is nearly right, and in parts it is cheap to try.
    if !best.model.has_two_bodies() && best.fit_loss(&short) > MUCH * growth.enough {
        found.extend(explore_parting(&short, &base, &sights));
    }
    found.insert(0, best);
    found.retain(|t| !t.effects().is_empty());
    growth.carried(calibrated, &found)
}
