//! The main job: the simple and the extensive model fitted to the swings of one joint.

use super::run::{Prediction, held_out_in_turn, predict};
use super::{
    BeliefFound, Case, DirectiveError, Directives, Experiment, ExtensiveModel, Fitted, JointModel, LinkBy, Problem,
    Scale, SimpleModel, conclude, undetermined,
};
use crate::fit::{Budget, Method, Rejected};
use crate::geometry::GeometryError;
use crate::log::{ExtraMass, Role};
use crate::pendulum::Diverged;
use crate::progress::{Cancelled, Progress, Step};
use serde::Serialize;

/// How to fit.
#[derive(Clone, Debug, Default)]
pub struct DropOptions {
    /// How to search.
    pub method: Method,
    /// What the user demands of parameters.
    pub directives: Directives,
    /// Friction by (3.11) with a Stribeck part instead of (3.14).
    pub stribeck: bool,
    /// Write the link by its lump even where its bodies are known.
    pub lump: bool,
    /// Evaluations that each solve may take.
    pub budget: Budget,
}

/// The simple model of the logs with one load.
#[derive(Clone, Debug, Serialize)]
pub struct SimpleFit {
    /// `bare`, or the extra mass, e.g. `0.220 kg`.
    pub load: String,
    /// Which of the fitted experiments.
    pub experiments: Vec<usize>,
    /// The fit.
    pub fitted: Fitted<SimpleModel>,
}

/// Both models of one joint. Written down it has no experiments, which are what was read.
#[derive(Clone, Debug, Serialize)]
pub struct DropFit {
    /// One for each load.
    pub simple: Vec<SimpleFit>,
    /// Of all logs together.
    pub extensive: Fitted<ExtensiveModel>,
    /// The experiments that were fitted, in the case's order.
    #[serde(skip)]
    pub fitted: Vec<Experiment>,
    /// The experiments that were held back.
    #[serde(skip)]
    pub validated: Vec<Experiment>,
    /// The extensive model on what was held back.
    pub predictions: Vec<Prediction>,
    /// The simple model on what was held back; `None` for a load that was not fitted.
    pub simple_predictions: Vec<Option<Prediction>>,
    /// RMS of each fitted experiment predicted by the extensive model from the others alone \[rad\]; empty where logs
    /// were held back by the study, or there is one log only.
    pub held_out_rms_rad: Vec<f64>,
    /// What the study states of the numbers, and where the extensive model has them; empty where nothing is stated.
    pub beliefs: Vec<BeliefFound>,
    /// What the fitted logs leave to what the study states, in sentences.
    pub undetermined: Vec<String>,
}

/// Why a drop cannot be fitted.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum DropError {
    /// No fitted log moves: this is an answer.
    #[error("the joint never moves in the logs to be fitted")]
    NeverMoved,
    /// A demand on a parameter cannot be met.
    #[error(transparent)]
    Directive(#[from] DirectiveError),
    /// No motion can be computed.
    #[error("no fit: {0}")]
    Rejected(#[from] Rejected),
    /// The fitted model runs away on a held-back log.
    #[error("prediction of a held-back log: {0}")]
    Diverged(#[from] Diverged),
    /// The leg's geometry is impossible.
    #[error(transparent)]
    Geometry(#[from] GeometryError),
    /// The fit was no longer wanted.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Fits both models to a case.
///
/// `progress` is told what is being done, and asked whether that is still wanted.
///
/// # Errors
/// [`DropError::NeverMoved`] where there is nothing to fit; the others where a fit cannot be made.
pub fn fit_drop(case: &Case, options: &DropOptions, progress: &dyn Progress) -> Result<DropFit, DropError> {
    let (fitted, validated) = (case.experiments(Role::Fit), case.experiments(Role::Validate));
    if fitted.is_empty() {
        return Err(DropError::NeverMoved);
    }
    let model = extensive_model(case, &fitted, options)?;
    let driven = fitted.iter().any(Experiment::is_driven);
    let simple_names = SimpleModel::new(&Scale::of(&fitted, None, None), driven);
    options.directives.check_names(&[simple_names.parameters(), model.parameters()])?;
    let mut groups: Vec<(String, Vec<usize>)> = Vec::new();
    for (k, e) in fitted.iter().enumerate() {
        let label = load_label(case, e);
        match groups.iter_mut().find(|(l, _)| *l == label) {
            Some((_, members)) => members.push(k),
            None => groups.push((label, vec![k])),
        }
    }
    let mut simple = Vec::with_capacity(groups.len());
    let of = groups.len();
    for (done, (load, members)) in groups.into_iter().enumerate() {
        progress.go_on(Step { stage: "simple model", done, of })?;
        let experiments: Vec<Experiment> = members.iter().map(|&k| fitted[k].clone()).collect();
        let scale = Scale::of(&experiments, case.joint.nominal.as_ref(), case.joint.rest_rad);
        let mut model = SimpleModel::new(&scale, experiments.iter().any(Experiment::is_driven));
        options.directives.apply(model.parameters_mut())?;
        let fitted = conclude(&model, &experiments, options.method, options.budget)?;
        simple.push(SimpleFit { load, experiments: members, fitted });
    }
    progress.go_on(Step::stage("extensive model"))?;
    let extensive = conclude(&model, &fitted, options.method, options.budget)?;
    progress.go_on(Step::stage("held-back logs"))?;
    let predictions = predict(&extensive.model, &validated, &extensive.found.values)?;
    let simple_predictions = validated
        .iter()
        .map(|e| {
            let Some(group) = simple.iter().find(|g| g.load == load_label(case, e)) else { return Ok(None) };
            let one = predict(&group.fitted.model, std::slice::from_ref(e), &group.fitted.found.values)?;
            Ok(one.into_iter().next())
        })
        .collect::<Result<_, Diverged>>()?;
    let held_out_rms_rad = if validated.is_empty() {
        let Fitted { model, found, .. } = &extensive;
        held_out_in_turn(model, &fitted, found, options.method, options.budget)
    } else {
        Vec::new()
    };
    let beliefs = BeliefFound::of(extensive.model.parameters(), &extensive.found.values);
    let undetermined = left_to_beliefs(&extensive, &fitted);
    Ok(DropFit {
        simple,
        extensive,
        fitted,
        validated,
        predictions,
        simple_predictions,
        held_out_rms_rad,
        beliefs,
        undetermined,
    })
}

/// What the logs leave to what is believed of the numbers, where anything is.
fn left_to_beliefs(extensive: &Fitted<ExtensiveModel>, fitted: &[Experiment]) -> Vec<String> {
    let model = &extensive.model;
    let is_number = |i: usize| model.parameters()[i].belief.is_some();
    undetermined(&Problem::new(model, fitted), &extensive.found.solution.x, is_number, model.unit_rad2_s())
}

/// The extensive model of a case, with the user's demands.
fn extensive_model(case: &Case, fitted: &[Experiment], options: &DropOptions) -> Result<ExtensiveModel, DropError> {
    let nominal = case.joint.nominal.as_ref();
    let scale = Scale::of(fitted, nominal, case.joint.rest_rad);
    let mut model = match &case.leg {
        Some(leg) if case.by_bodies && !options.lump => {
            ExtensiveModel::bodies(&scale, fitted, &leg.masses()?, leg.pose_known, nominal, options.stribeck)
        }
        _ => ExtensiveModel::lumped(&scale, nominal, options.stribeck),
    };
    // The numbers of a leg that is known by its bodies are tables, not what somebody at the bench states.
    if let Some(nominal) = nominal.filter(|_| !case.by_bodies) {
        model = model.believed(&scale, nominal, &case.uncertain);
    }
    options.directives.apply(model.parameters_mut())?;
    Ok(model)
}

/// `bare`, or the extra mass.
fn load_label(case: &Case, e: &Experiment) -> String {
    let extra = case.items.iter().find(|i| i.entry.file == e.file).and_then(|i| i.entry.extra);
    extra.map_or("bare".to_owned(), |x: ExtraMass| format!("{:.3} kg", x.mass_kg))
}

impl DropFit {
    /// Inertia, moment and hanging angle of the bare link as a function of the extensive model's values.
    pub fn bare_link(&self, values: &[f64]) -> [f64; 3] {
        let Some(e) = self.fitted.first() else { return [f64::NAN; 3] };
        let link = self.extensive.model.bare_link(values, e);
        [link.inertia_kg_m2, link.peak_gravity_nm() / e.gravity_m_s2, link.hanging_rad()]
    }

    /// RMS over what was fitted by the simple models, each of its own load \[rad\].
    pub fn simple_rms_rad(&self) -> f64 {
        let (mut squares, mut samples) = (0.0, 0);
        for group in &self.simple {
            for (p, &k) in group.fitted.predictions.iter().zip(&group.experiments) {
                squares += p.rms_rad.powi(2) * self.fitted[k].compared() as f64;
                samples += self.fitted[k].compared();
            }
        }
        (squares / samples.max(1) as f64).sqrt()
    }

    /// True where the link is written by its bodies.
    pub fn by_bodies(&self) -> bool {
        self.extensive.model.link_by == LinkBy::Bodies
    }
}
