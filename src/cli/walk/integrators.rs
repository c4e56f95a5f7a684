//! Table 4.1 again: the walk by every method and step of the thesis, each row judged.

use super::super::CliError;
use super::super::progress::Progress;
use super::super::provenance::provenance;
use super::answer::in_words;
use super::setting::Setting;
use super::study::{Run, empty, joints, write};
use super::{IntegratorsArg, WalkArgs};
use crate::geometry::robot_file::FRAME_S;
use crate::integrate::{self, Tolerance};
use crate::report::{Comparison, Figure, StudyTable, comparison_figure, trunk_figure};
use crate::robot::simulate::{Method, Setpoints, TrunkCurves};
use crate::robot::{Floor, FloorParameters, Gait, Model, Touching};
use rayon::prelude::*;
use serde::Serialize;

/// A displacement this near to the printed one is the same \[m\]: what judges the reference walk.
const SAME_M: f64 = 0.005;

/// What Table 4.1 has for a row.
#[derive(Clone, Copy, Debug, Serialize)]
struct Printed {
    /// On an Athlon XP 1800+ \[s\].
    wall_s: f64,
    calculations: u64,
    displacement_m: f64,
}

/// A row to be run.
struct Asked {
    method: Method,
    printed: Option<Printed>,
    /// Why it may be different, if it is.
    reason: &'static str,
    /// Only where everything is asked for.
    is_long: bool,
}

/// A row as the JSON has it.
#[derive(Debug, Serialize)]
struct Row {
    method: String,
    printed: Option<Printed>,
    /// \[s\]
    wall_s: Option<f64>,
    evaluations: Option<u64>,
    integration_steps: Option<u64>,
    displacement_m: Option<f64>,
    drift_m: Option<f64>,
    /// `reproduced`, `different`, `diverged`, `left out` or `no printed row`.
    verdict: &'static str,
    why: String,
}

const COARSE: &str = "both overshoot, as coarse steps do, here by less: joint rates that the step cannot follow (up to \
                      1.5e6 1/s with the printed derivative gains) are slowed down to what it can. The thesis cannot \
                      have run these gains explicitly at this step";
const ITS_OWN: &str = "here the methods agree with each other from 1e-4 s on. The printed rows of Runge-Kutta move by \
                       9 mm from 1e-5 to 1e-6 s and by 18 mm from 5e-5 to 1e-5 s, so they had not converged; the floor \
                       they ran on is not known";
const ADAMS: &str = "here both tolerances agree with every other method. The printed ones are the farthest from 0.51 m \
                     although they cost the most";

fn asked() -> Vec<Asked> {
    use integrate::Method as Of;
    let row = |of: Of, wall_s, calculations, displacement_m, reason| Asked {
        method: Method::Smooth(of),
        printed: Some(Printed { wall_s, calculations, displacement_m }),
        reason,
        is_long: matches!(of, Of::Rk4 { step_s } if step_s < 5e-6),
    };
    let of = |tolerance| Tolerance::of(tolerance);
    let own = |method, is_long| Asked { method, printed: None, reason: "", is_long };
    vec![
        row(Of::Rk4 { step_s: 5e-4 }, 175.172, 80_459, 0.607, COARSE),
        row(Of::Rk4 { step_s: 1e-4 }, 837.813, 400_962, 0.513, ITS_OWN),
        row(Of::Rk4 { step_s: 1e-5 }, 7516.94, 4_000_831, 0.508, ITS_OWN),
        row(Of::Rk4 { step_s: 1e-6 }, 75493.9, 40_000_670, 0.517, ITS_OWN),
        row(Of::Bdf(of(1e-5)), 2802.91, 1_450_251, 0.511, ITS_OWN),
        row(Of::Bdf(of(1e-6)), 2239.44, 1_130_894, 0.508, ITS_OWN),
        row(Of::Adams(of(1e-6)), 18926.3, 9_789_172, 0.542, ADAMS),
        row(Of::Adams(of(1e-5)), 43585.1, 22_956_984, 0.608, ADAMS),
        row(Of::Rk2 { step_s: 5e-5 }, 767.0, 400_887, 0.535, ITS_OWN),
        row(Of::Rk2 { step_s: 1e-5 }, 3820.52, 2_000_926, 0.517, ITS_OWN),
        own(Method::Stiff { step_s: 1e-3 }, false),
        own(Method::Stiff { step_s: 5e-4 }, false),
        own(Method::Stiff { step_s: 1e-4 }, false),
        own(Method::Explicit(Of::Rk4 { step_s: 5e-4 }), false),
        own(Method::Explicit(Of::Rk4 { step_s: 1e-4 }), false),
        own(Method::Explicit(Of::Rk4 { step_s: 1e-5 }), false),
        own(Method::Explicit(Of::Rk4 { step_s: 1e-6 }), true),
    ]
}

/// Runs the study.
pub(super) fn run(args: &WalkArgs, model: &Model, which: IntegratorsArg) -> Result<u8, CliError> {
    let gait = Gait::built_in("trot", model)?;
    let end_s = args.duration.unwrap_or(gait.stand_s() + gait.walk_s());
    let from_s = gait.stand_s().min(0.5 * end_s);
    // The thesis's methods know no memory: friction is (2.4) alone, here too.
    let parameters = FloorParameters { dwell_s: f64::INFINITY, ..FloorParameters::default() };
    let floor = Floor::new(parameters, model, Touching::Marked)?;
    let setpoints = Setpoints::sampled(&gait, model, end_s, FRAME_S)?;
    let setting = Setting::new(model.clone(), joints(args, model)?, &setpoints, Some(floor));
    let asked = asked();
    let progress = Progress::new(args.common.quiet);
    let (threads, runs) = args.common.on_threads(|| {
        let one = |row: &Asked| {
            if row.is_long && which == IntegratorsArg::Quick {
                return Ok(None);
            }
            progress.say(&format!("running {}", in_words(row.method)));
            Run::of(&setting, row.method, from_s).map(Some)
        };
        let runs: Vec<Result<Option<Run>, CliError>> = asked.par_iter().with_max_len(1).map(one).collect();
        (rayon::current_num_threads(), runs)
    })?;
    let runs: Vec<Option<Run>> = runs.into_iter().collect::<Result<_, _>>()?;
    drop(progress);
    let rows: Vec<Row> = asked.iter().zip(&runs).map(|(asked, run)| row(asked, run.as_ref())).collect();
    let mut report = empty("integrators", "Table 4.1: the walk by several methods", provenance(args.robot.clone())?);
    report.sentence = sentence(&rows);
    report.notes = notes(&rows, threads);
    report.table = table(&rows);
    report.figures = figures(&rows, &asked, &runs)?;
    report.rows = rows;
    write(args, &report, args.robot.as_slice())?;
    Ok(0)
}

fn row(asked: &Asked, run: Option<&Run>) -> Row {
    let displacement_m = run.and_then(|run| run.ground.as_ref()).map(|ground| ground.displacement_m);
    let (verdict, why) = match (run, asked.printed, displacement_m) {
        (None, ..) => ("left out", "4e7 evaluations; --integrators=all runs it".to_owned()),
        (Some(run), _, None) => {
            let at_s = run.recording.diverged.as_ref().map_or(f64::NAN, |diverged| diverged.at_s);
            let why = "the printed derivative gains make joints as fast as 1.5e6 1/s, which no explicit step of this \
                       length follows";
            ("diverged", format!("at t = {at_s:.4} s: {why}"))
        }
        (Some(_), None, Some(_)) => ("no printed row", String::new()),
        (Some(_), Some(printed), Some(ours)) => {
            let apart_m = ours - printed.displacement_m;
            match apart_m.abs() <= SAME_M {
                true => ("reproduced", format!("{:+.0} mm", 1e3 * apart_m)),
                false => ("different", format!("{:+.0} mm: {}", 1e3 * apart_m, asked.reason)),
            }
        }
    };
    Row {
        method: in_words(asked.method),
        printed: asked.printed,
        wall_s: run.map(|run| run.wall_s),
        evaluations: run.map(|run| run.recording.counts.evaluations),
        integration_steps: run.map(|run| run.recording.counts.steps),
        displacement_m,
        drift_m: run.and_then(|run| run.ground.as_ref()).map(|ground| ground.drift_m),
        verdict,
        why,
    }
}

fn sentence(rows: &[Row]) -> String {
    let count = |verdict: &str| rows.iter().filter(|row| row.printed.is_some() && row.verdict == verdict).count();
    let (same, different, diverged, out) =
        (count("reproduced"), count("different"), count("diverged"), count("left out"));
    let fine = rows.iter().filter(|row| !row.method.contains("5e-4") && !row.method.contains("1e-3"));
    let found: Vec<f64> = fine.filter_map(|row| row.displacement_m).collect();
    let (low, high) = found.iter().fold((f64::INFINITY, 0.0f64), |(low, high), x| (low.min(*x), high.max(*x)));
    let mut words = format!("Of the thesis's ten rows {same} come out within 5 mm and {different} differ");
    for (count, what) in [(diverged, "diverge"), (out, "left out")] {
        if count > 0 {
            words.push_str(&format!(", {count} {what}"));
        }
    }
    format!(
        "{words}. Here every method with steps of 1e-4 s or less, or with a tolerance, goes between {low:.4} and {high:.4} m."
    )
}

fn notes(rows: &[Row], threads: usize) -> Vec<String> {
    let of = |name: &str| rows.iter().find(|row| row.method == name);
    let cost = |name: &str| of(name).and_then(|row| row.evaluations).unwrap_or(0) as f64;
    let tighter =
        |family: &str| cost(&format!("{family}, tolerance 1e-6")) / cost(&format!("{family}, tolerance 1e-5"));
    let went = |name: &str| of(name).and_then(|row| row.displacement_m).unwrap_or(f64::NAN);
    vec![
        format!(
            "Pattern: coarse steps overshoot, in the thesis (Runge-Kutta 4: 0.607 m at 5e-4 s, 0.513 m at 1e-4 s; \
             Runge-Kutta 2: 0.535 m at 5e-5 s, 0.517 m at 1e-5 s) and here (Runge-Kutta 4: {:.3} m at 5e-4 s, {:.3} m at \
             1e-4 s; stiff method: {:.3} m at 1e-3 s, {:.3} m at 5e-4 s).",
            went("Runge-Kutta 4, steps of 5e-4 s"),
            went("Runge-Kutta 4, steps of 1e-4 s"),
            went("Stiff method, steps of 1e-3 s"),
            went("Stiff method, steps of 5e-4 s"),
        ),
        format!(
            "Swapped rows: printed, the tolerance of 1e-6 costs {:.2} times the evaluations of 1e-5 with Vode Adams and \
             {:.2} times with MBDF; a tighter tolerance should cost more, and here it costs {:.2} and {:.2} times as many. \
             With the labels exchanged the costs make sense; the displacement of Adams would then be the farther off the \
             tighter the tolerance.",
            9_789_172.0 / 22_956_984.0,
            1_130_894.0 / 1_450_251.0,
            tighter("Adams"),
            tighter("Backward differentiation"),
        ),
        "Text and table: the text calls Runge-Kutta 4 with 1e-5 s the fastest to 0.51 m; the table has Runge-Kutta 4 with \
         1e-4 s at 0.513 m in 838 s, nine times faster. Figure C.4 gives MBDF 1e-5 0.517 m, the table 0.511 m."
            .to_owned(),
        format!(
            "Rows without \"explicit throughout\" slow down joint rates that their step cannot follow (backward \
             differentiation needs none of that). Friction is (2.4) alone, without resting feet. Wall times were taken \
             with {threads} {} at once; the thesis's on an Athlon XP 1800+.",
            if threads == 1 { "row" } else { "rows" }
        ),
    ]
}

fn table(rows: &[Row]) -> StudyTable {
    let or_dash = |text: Option<String>| text.unwrap_or_else(|| "-".to_owned());
    let count = |n: u64| if n < 100_000 { n.to_string() } else { format!("{:.2e}", n as f64) };
    let cells = |row: &Row| {
        let printed = row.printed.as_ref();
        vec![
            row.method.clone(),
            row.verdict.to_owned(),
            or_dash(printed.map(|p| format!("{:.0}", p.wall_s))),
            or_dash(printed.map(|p| count(p.calculations))),
            or_dash(printed.map(|p| format!("{:.3}", p.displacement_m))),
            or_dash(row.wall_s.map(|s| format!("{s:.2}"))),
            or_dash(row.evaluations.map(count)),
            or_dash(row.displacement_m.map(|m| format!("{m:.4}"))),
        ]
    };
    StudyTable {
        words: vec!["method", "verdict"],
        numbers: vec!["thesis [s]", "calculations", "[m]", "here [s]", "evaluations", "[m]"],
        rows: rows.iter().map(cells).collect(),
        remarks: rows.iter().map(|row| row.why.clone()).collect(),
    }
}

fn figures(rows: &[Row], asked: &[Asked], runs: &[Option<Run>]) -> Result<Vec<Figure>, CliError> {
    let shown = rows.iter().filter(|row| row.printed.is_some() || row.displacement_m.is_some());
    let compared: Vec<Comparison> = shown
        .map(|row| Comparison {
            name: row.method.clone(),
            printed: row.printed.map(|p| p.displacement_m),
            ours: row.displacement_m,
        })
        .collect();
    let title = "Table 4.1, displacement after ten seconds";
    let mut figures = vec![Figure {
        file_name: "integrators.svg".to_owned(),
        title: title.to_owned(),
        caption: "Table 4.1. The displacement [m] by every method, as printed and here: coarse steps overshoot."
            .to_owned(),
        svg: comparison_figure(title, "displacement [m]", &compared)?,
    }];
    let trunk_of = |of: integrate::Method| -> Option<&TrunkCurves> {
        let k = asked.iter().position(|row| row.method == Method::Smooth(of))?;
        runs[k].as_ref()?.trunk.as_ref()
    };
    let named = [
        ("C.4", integrate::Method::Bdf(Tolerance::of(1e-5)), "backward differentiation, tolerance 1e-5", 0.517),
        ("C.5", integrate::Method::Adams(Tolerance::of(1e-6)), "Adams, tolerance 1e-6", 0.542),
    ];
    for (number, method, words, printed_m) in named {
        let Some(trunk) = trunk_of(method) else { continue };
        let caption = format!(
            "Figure {number}. The walk by {words}: the same movement as by every other method. The thesis's went \
             {printed_m} m."
        );
        let file = format!("figure-{}", number.to_lowercase().replace('.', "-"));
        figures.push(trunk_figure(&file, &format!("Figure {number}, {words}"), caption, trunk)?);
    }
    Ok(figures)
}
