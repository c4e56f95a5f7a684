//! Which explanations the drops need: table, words and figure.

use super::super::plot::bare;
use super::super::plot::canvas::{EXTENSIVE, POSITIVE};
use super::super::plot::heat::{Heat, HeatCell, heat, tint};
use crate::gap::neighbours::{Cause, Compared, EQUAL_DEVIANCE, Hypothesis, leaves_something};
use crate::identify::Named;
use crate::joint::EffectId;
use crate::report::ReportError;
use crate::report::grid::Grid;
use crate::report::number::{format_with_uncertainty, mrad, percent, significant};
use crate::robot::bench::Held;
use serde::{Deserialize, Serialize};

/// The whole robot refitted to the drops of a joint.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct RefitSummary {
    /// `held joints give`, `rigid` or `cannot tell`.
    pub verdict: String,
    /// Deviance with rigid neighbours less that with giving ones, charges included.
    pub gives_by: f64,
    /// Noise of the readings \[rad\].
    pub noise: f64,
    /// Share of what rigid neighbours leave above the noise that giving ones close.
    pub share: f64,
    /// Logs that were fitted, in the order of `rest`.
    pub files: Vec<String>,
    /// The nominal robot; everything with rigid, with giving neighbours; then by cause, the most needed first, it alone and
    /// all but it.
    pub fits: Vec<RefitFit>,
}

/// One fit.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct RefitFit {
    /// `nominal`, `all, rigid`, `all, by PID`, `only` or `without`.
    pub what: String,
    /// The cause, where it is about one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cause: Option<String>,
    /// How much the cause is needed: deviance without it less that with it, charges included.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub needed: Option<f64>,
    /// \[rad\]
    pub rms: f64,
    /// RMS of the distances at rest \[rad\].
    pub rest_rms: f64,
    /// Model less measurement at rest, by log \[rad\].
    pub rest: Vec<f64>,
    /// What was searched, with values and 95 % intervals.
    pub values: Vec<Found>,
}

/// A number that was searched.
#[derive(Clone, Debug, Default, Deserialize, PartialEq, Serialize)]
pub struct Found {
    /// e.g. `zero`.
    pub name: String,
    /// e.g. `rad`.
    pub unit: String,
    /// In that unit.
    pub value: f64,
    /// 95 % interval; null where it is open.
    pub interval: Option<[f64; 2]>,
}

impl RefitFit {
    fn of(what: &str, cause: Option<(Cause, f64)>, hypothesis: &Hypothesis) -> Self {
        let values = hypothesis.found.iter().map(|estimate| Found {
            name: estimate.name.clone(),
            unit: estimate.unit.clone(),
            value: estimate.value,
            interval: estimate.interval,
        });
        Self {
            what: what.into(),
            cause: cause.map(|(cause, _)| words(cause).into()),
            needed: cause.map(|(_, needed)| needed),
            rms: hypothesis.rms_rad,
            rest_rms: hypothesis.rest_rms_rad(),
            rest: hypothesis.rest_rad.clone(),
            values: values.collect(),
        }
    }
}

/// A cause in a few words.
fn words(cause: Cause) -> &'static str {
    match cause {
        Cause::HeldJoints => "held joints give",
        Cause::Number(Named::Zero) => "encoder's zero",
        Cause::Number(Named::Mass(_)) => "lower leg's mass",
        Cause::Number(Named::Coulomb) => "Coulomb friction",
        Cause::Number(named) => named.name(),
        Cause::Effect(EffectId::LoadFriction) => "load friction",
        Cause::Effect(EffectId::AsymmetricFriction) => "friction by direction",
        Cause::Effect(effect) => effect.id(),
    }
}

impl RefitSummary {
    /// What was fitted.
    pub fn of(compared: &Compared) -> Self {
        let mut fits = vec![
            RefitFit::of("nominal", None, &compared.nominal),
            RefitFit::of("all, rigid", None, &compared.rigid),
            RefitFit::of("all, by PID", None, &compared.controlled),
        ];
        for row in &compared.ranked {
            fits.push(RefitFit::of("only", Some((row.cause, row.needed)), &row.alone));
            fits.push(RefitFit::of("without", Some((row.cause, row.needed)), &row.without));
        }
        let verdict = match compared.held() {
            Some(Held::ByController) => "held joints give",
            Some(Held::Rigid) => "rigid",
            None => "cannot tell",
        };
        Self {
            verdict: verdict.into(),
            gives_by: compared.gives_by,
            noise: compared.noise_rad,
            share: compared.share(),
            files: compared.files.clone(),
            fits,
        }
    }

    /// Whether single causes were ranked.
    pub(in crate::report) fn ranked(&self) -> bool {
        self.fits.iter().any(|fit| fit.cause.is_some())
    }

    fn fit(&self, what: &str) -> Option<&RefitFit> {
        self.fits.iter().find(|fit| fit.what == what)
    }

    fn best(&self) -> Option<&RefitFit> {
        self.fit(if self.gives_by < 0.0 { "all, rigid" } else { "all, by PID" })
    }
}

/// Causes, the most needed first.
pub(in crate::report) fn causes_table(refit: &RefitSummary) -> Grid {
    let both = |fit: &RefitFit| format!("{}, {}", significant(1e3 * fit.rms, 3), significant(1e3 * fit.rest_rms, 3));
    let only = refit.fits.iter().filter(|fit| fit.what == "only");
    let row = |(only, without): (&RefitFit, &RefitFit)| {
        let cause = only.cause.as_deref().unwrap_or_default();
        let frees = |found: &&Found| Cause::ALL.into_iter().any(|c| words(c) == cause && c.frees(&found.name));
        let found = refit.best().and_then(|best| best.values.iter().find(frees));
        let numbers = vec![
            both(only),
            both(without),
            significant(only.needed.unwrap_or(f64::NAN), 3),
            found.map_or_else(String::new, value),
            found.map_or_else(String::new, |found| found.unit.clone()),
        ];
        (cause.to_owned(), numbers)
    };
    Grid {
        name: "explanation",
        numbers: vec![
            "alone: RMS,\nat rest [mrad]",
            "without: RMS,\nat rest [mrad]",
            "needed\nby",
            "with all others: value",
            "unit",
        ],
        rows: only.zip(refit.fits.iter().filter(|fit| fit.what == "without")).map(row).collect(),
    }
}

fn value(found: &Found) -> String {
    match found.interval {
        Some(interval) => {
            let shown = format_with_uncertainty(found.value, interval);
            format!("{} [{}, {}]", shown.value, shown.low, shown.high)
        }
        None => "open".to_owned(),
    }
}

/// What the refits say, as sentences, the first of which begins in small letters.
pub(in crate::report) fn refit_words(refit: &RefitSummary) -> String {
    let (Some(nominal), Some(rigid), Some(controlled), Some(best)) =
        (refit.fit("nominal"), refit.fit("all, rigid"), refit.fit("all, by PID"), refit.best())
    else {
        return String::new();
    };
    let verdict = match refit.verdict.as_str() {
        "held joints give" => {
            format!(
                "the held joints give, which closes {} of what rigid ones leave above the noise",
                percent(refit.share)
            )
        }
        "rigid" => "the other joints were held rigidly".to_owned(),
        _ => "these drops do not tell whether the held joints give".to_owned(),
    };
    let is_needed = |fit: &&RefitFit| fit.what == "without" && fit.needed.is_some_and(|by| by > EQUAL_DEVIANCE);
    let needed: Vec<&str> = refit.fits.iter().filter(is_needed).filter_map(|fit| fit.cause.as_deref()).collect();
    let rest = if refit.ranked() {
        let needed = match needed.is_empty() {
            true => "The drops need none of the explanations.".to_owned(),
            false => format!("The drops need, the most first: {}.", needed.join(", ")),
        };
        let [nominal, best] = [nominal.rest_rms, best.rest_rms].map(mrad);
        format!(" {needed} At rest the nominal robot is off by {nominal}, the best by {best}.")
    } else {
        String::new()
    };
    let remains = if leaves_something(best.rms, refit.noise) {
        format!(
            " {} remain against {} of noise: something else is in these drops, and the intervals do not allow for its bias.",
            mrad(best.rms),
            mrad(refit.noise)
        )
    } else {
        format!(" Nothing but noise ({}) remains.", mrad(refit.noise))
    };
    let logs = if refit.files.len() == 1 { "one log".to_owned() } else { format!("{} logs", refit.files.len()) };
    format!(
        "{verdict}: refitted to {logs} (zero, lower leg's mass, all friction, load friction, friction by direction) the whole robot is \
         off by {} with them rigid, by {} with them held by their PID (Table B.2); {} apart in deviance, where {EQUAL_DEVIANCE} \
         decide.{rest}{remains}",
        mrad(rigid.rms),
        mrad(controlled.rms),
        significant(refit.gives_by.abs(), 3)
    )
}

/// A distance with its sign and as many digits as the largest has; one that rounds to nothing is 0.
fn signed_mrad(rest_rad: f64, most_rad: f64) -> String {
    let decimals = if most_rad < 0.02 { 1 } else { 0 };
    let words = format!("{:+.decimals$}", 1e3 * rest_rad).replace('-', "\u{2212}");
    if words.chars().all(|c| matches!(c, '+' | '\u{2212}' | '0' | '.')) { "0".to_owned() } else { words }
}

/// Distances at rest by fit and log.
///
/// # Errors
/// [`ReportError::Font`] and [`ReportError::Draw`], neither of which depends on the data.
pub(in crate::report) fn causes_figure(joint: &str, refit: &RefitSummary) -> Result<String, ReportError> {
    let name = |fit: &RefitFit| match &fit.cause {
        Some(cause) => format!("{} {cause}", fit.what),
        None => fit.what.clone(),
    };
    let group = |what: &'static str| refit.fits.iter().filter(move |fit| fit.what == what);
    let fits: Vec<&RefitFit> =
        ["nominal", "only", "without", "all, rigid", "all, by PID"].into_iter().flat_map(group).collect();
    let rows: Vec<String> = fits.iter().map(|fit| name(fit)).collect();
    let columns: Vec<String> = refit.files.iter().map(|file| bare(file)).collect();
    let most = fits.iter().flat_map(|fit| &fit.rest).fold(1e-3f64, |most, rest| most.max(rest.abs()));
    let ends = [format!("+{} mrad", significant(1e3 * most, 2)), format!("-{} mrad", significant(1e3 * most, 2))];
    let colour = |share: f64| if share < 0.0 { tint(EXTENSIVE, -share) } else { tint(POSITIVE, share) };
    let map = Heat {
        title: &format!("{joint}: angle at rest, model less measurement [mrad]"),
        rows: &rows,
        columns: &columns,
        axes: ["", ""],
        names_above: true,
        name_room: 150.0,
        cell: [84.0, 24.0],
        colour: |of| if of < 0.0 { tint(EXTENSIVE, -of) } else { tint(POSITIVE, of) },
        scale: &[(1.0, &ends[0]), (0.0, "0"), (-1.0, &ends[1])],
        nothing: "no drops",
    };
    heat(&map, |row, column| {
        let rest = fits.get(row).and_then(|fit| fit.rest.get(column)).copied().unwrap_or(f64::NAN);
        HeatCell { ground: colour(rest / most), words: signed_mrad(rest, most), framed: false }
    })
}
