//! The explanation in sentences: every number comes from a run.

use super::ThesisReport;
use super::sections::Shown;
use crate::report::RefitSummary;
use crate::report::full::refit_words;
use crate::report::number::{as_given, extent, format_with_uncertainty, mrad, percent, significant};
use crate::thesis::{
    Approach, BARE_FACTOR, JointPuzzle, Knee, LOADED_FACTOR, NEAR, Printed, Puzzle, Shoulder, Tables, Weighed, Whole,
};

/// An answer to one of the thesis's puzzles.
pub(super) struct Answer {
    pub question: String,
    pub sentences: Vec<String>,
    pub table: Option<Shown>,
}

/// All answers, in the order of the thesis.
pub(super) fn explanations(report: &ThesisReport) -> Vec<Answer> {
    let tables = &report.tables;
    let mut answers = vec![ratios(&tables.puzzle)];
    answers.extend(tables.knee.as_ref().map(knee));
    answers.extend(tables.shoulder.as_ref().map(shoulder));
    answers.push(fits(tables));
    answers
}

fn ratios(puzzle: &Puzzle) -> Answer {
    let mut sentences: Vec<String> = puzzle.joints.iter().filter_map(with_load).collect();
    let ranges: Vec<String> = puzzle
        .candidates()
        .iter()
        .map(|c| {
            format!("{} ({} {} to {}{})", c.name, c.size, as_given(c.range[0]), as_given(c.range[1]), unit(c.unit))
        })
        .collect();
    sentences.push(format!(
        "Scanned, each alone, with larger Coulomb friction and with load friction: {}.",
        ranges.join(", ")
    ));
    for joint in &puzzle.joints {
        sentences.extend(of_joint(joint));
    }
    let everywhere = puzzle.near_everywhere();
    sentences.push(match everywhere.is_empty() {
        true => format!("No pair meets all six printed ratios within {}.", percent(NEAR)),
        false => format!(
            "Pairs that meet all six printed ratios within {}, each joint with sizes of its own: {}. Two ratios for \
             each joint cannot tell these apart.",
            percent(NEAR),
            everywhere.join("; ")
        ),
    });
    let printed = Printed::embedded().section_3_3_2;
    let q1 = puzzle.joints.first();
    let asked: Vec<&Approach> = q1.iter().flat_map(|j| &j.pairs).filter(|p| p.coulomb.is_some()).collect();
    let both: Vec<&&Approach> = asked.iter().filter(|pair| pair.shows_both_frictions()).collect();
    let bars = format!(
        "at most {} N m without, within a factor {} of {} N m with either extra mass",
        as_given(BARE_FACTOR * printed.coulomb_bare_nm),
        as_given(LOADED_FACTOR),
        as_given(printed.coulomb_loaded_nm)
    );
    sentences.push(if both.is_empty() {
        format!(
            "Of the {} pairs that meet q1's ratios, the extensive model sees the Coulomb frictions of 3.3.2 ({bars}) in \
             none: no friction that is the same law with and without the mass does both.",
            asked.len()
        )
    } else {
        let named: Vec<String> = both.iter().map(|pair| sizes(pair)).collect();
        format!(
            "Of the {} pairs that meet q1's ratios, the extensive model sees the Coulomb frictions of 3.3.2 ({bars}) \
             in {}: {}.",
            asked.len(),
            both.len(),
            named.join("; ")
        )
    });
    Answer {
        question:
            "1. Why are two masses of Table 3.1 negative, and Coulomb friction small without and large with extra \
                   mass?"
                .into(),
        sentences,
        table: (!asked.is_empty()).then(|| pairs_table(&asked)),
    }
}

/// What the scans say about one joint.
fn of_joint(joint: &JointPuzzle) -> Vec<String> {
    let mut sentences = Vec::new();
    let [p1, p2] = joint.printed_1_s;
    let printed_kg = Printed::embedded().ratios(joint.joint).map_or(f64::NAN, |row| row.mass_kg);
    if let Some(point) = &joint.as_printed {
        let [v1, v2] = point.ratios_1_s;
        sentences.push(format!(
            "{}: Table 3.3's friction, both tests let go at {} rad, gives B/ML^2 = {} and {} 1/s, their ratio {} and a mass \
             of {} kg; printed are {} and {} 1/s, {} and {} kg.",
            joint.joint,
            as_given(joint.release_rad),
            significant(v1, 3),
            significant(v2, 3),
            significant(v2 / v1, 3),
            significant(point.mass_kg, 2),
            as_given(p1),
            as_given(p2),
            significant(p2 / p1, 3),
            as_given(printed_kg)
        ));
    }
    let mut alone: Vec<&Approach> = joint.alone.iter().map(|scan| &scan.nearest).collect();
    alone.sort_by(|a, b| a.misfit.total_cmp(&b.misfit));
    let list = |points: &[&Approach]| {
        points
            .iter()
            .map(|p| format!("{} ({} off, {} kg)", sizes(p), off(p), significant(p.mass_kg, 2)))
            .collect::<Vec<_>>()
            .join("; ")
    };
    sentences.push(format!("{} alone, nearest first: {}.", joint.joint, list(&alone[..alone.len().min(4)])));
    if let Some(load) = joint.alone.iter().find(|scan| scan.candidate.name == "load_friction") {
        let masses: Vec<f64> = load.curve.iter().filter_map(|(_, [v1, v2])| mass(joint, *v1, *v2)).collect();
        let [low, high] = extent(masses.iter().copied());
        sentences.push(format!(
            "{}, load friction alone: the mass goes from {} to {} kg over its range; it pushes the masses up.",
            joint.joint,
            significant(low, 2),
            significant(high, 2)
        ));
    }
    let near: Vec<&Approach> = joint.pairs.iter().filter(|pair| pair.misfit < NEAR).collect();
    sentences.push(format!(
        "{}: {} of {} pairs come within {} of both ratios; the nearest are {}.",
        joint.joint,
        near.len(),
        joint.pairs.len(),
        percent(NEAR),
        list(&joint.pairs.iter().take(3).collect::<Vec<_>>())
    ));
    sentences
}

/// Candidates that a sentence names at the most.
const MOST_NAMED: usize = 3;

/// Whether the Coulomb friction that section 3.3.2 has with extra mass makes the printed ratios, too.
fn with_load(joint: &JointPuzzle) -> Option<String> {
    let printed = Printed::embedded().section_3_3_2;
    let (alone, others) = joint.with_load.split_first()?;
    let near: Vec<String> = others.iter().filter(|p| p.misfit < NEAR).take(MOST_NAMED).map(rest_of).collect();
    let better = match near.is_empty() {
        true => "nothing scanned with it brings both ratios within reach".to_owned(),
        false => {
            format!("with one thing more, for instance, both are met within {}: {}", percent(NEAR), near.join("; "))
        }
    };
    Some(format!(
        "{}: a Coulomb friction of {} N m that comes with the extra mass and is the same with both ({} N m without, as 3.3.2 \
         has it) gives both printed ratios to {} with {} and a mass of {} kg; {better}.",
        joint.joint,
        as_given(printed.coulomb_loaded_nm),
        as_given(printed.coulomb_bare_nm),
        off(alone),
        rest_of(alone),
        significant(alone.mass_kg, 2)
    ))
}

/// Candidates with their sizes, without the first.
fn rest_of(point: &Approach) -> String {
    sizes(&Approach { what: point.what.iter().skip(1).copied().collect(), ..point.clone() })
}

/// Mass by (3.5) with the thesis's extra masses.
fn mass(joint: &JointPuzzle, v1: f64, v2: f64) -> Option<f64> {
    let [m1, m2] = Printed::embedded().ratios(joint.joint)?.extra_mass_kg;
    let mass_kg = (m1 * v1 - v2 * m2) / (v2 - v1);
    mass_kg.is_finite().then_some(mass_kg)
}

fn off(point: &Approach) -> String {
    let percent = 100.0 * point.misfit;
    // What a search leaves below that depends on where it stopped.
    if percent < 0.01 { "below 0.01 %".to_owned() } else { format!("{} %", significant(percent, 2)) }
}

/// Candidates with their sizes.
fn sizes(point: &Approach) -> String {
    let one =
        |(c, size): &(crate::thesis::Candidate, f64)| format!("{} {}{}", c.name, significant(*size, 2), unit(c.unit));
    point.what.iter().map(one).collect::<Vec<_>>().join(" + ")
}

fn unit(unit: &str) -> String {
    if unit.is_empty() { String::new() } else { format!(" {unit}") }
}

/// Pairs that meet q1's ratios, and the Coulomb frictions that the extensive model then sees.
fn pairs_table(pairs: &[&Approach]) -> Shown {
    let nm = |value: Option<f64>| value.map_or("does not move".to_owned(), |v| format!("{v:.4}"));
    let row = |pair: &&Approach| {
        let seen = pair.coulomb;
        vec![
            sizes(pair),
            format!("{:.3}", pair.mass_kg),
            off(pair),
            nm(seen.and_then(|s| s.bare_nm)),
            nm(seen.and_then(|s| s.loaded_nm[0])),
            nm(seen.and_then(|s| s.loaded_nm[1])),
        ]
    };
    Shown {
        columns: vec!["q1: pair", "mass\n[kg]", "off", "mu_c bare\n[N m]", "0.220 kg", "0.402 kg"],
        words: 1,
        rows: pairs.iter().map(row).collect(),
        remarks: Vec::new(),
    }
}

fn knee(knee: &Knee) -> Answer {
    let [estimated, chosen] = knee.coulomb_nm;
    let [by_estimated, by_chosen] = knee.moves_rad;
    let says = |moves: f64| {
        if moves < 1e-3 { "does not move".to_owned() } else { format!("falls {} rad", significant(moves, 3)) }
    };
    let agrees = match (by_estimated < 1e-3, by_chosen < 1e-3) {
        (true, false) => format!(
            "Table 3.3's {} N m agrees with the thesis's own observation, Table 3.4's {} N m does not",
            as_given(estimated),
            as_given(chosen)
        ),
        (false, true) => format!(
            "Table 3.4's {} N m agrees with the thesis's own observation, Table 3.3's {} N m does not",
            as_given(chosen),
            as_given(estimated)
        ),
        _ => "the observation does not tell the two apart".to_owned(),
    };
    let mut sentences = vec![format!(
        "Gravity pulls at the level bare lower leg with {} N m. Let go there, it {} with {} N m and {} with {} N m: {agrees}.",
        significant(knee.gravity_nm, 3),
        says(by_estimated),
        as_given(estimated),
        says(by_chosen),
        as_given(chosen)
    )];
    if let Some((value, interval)) = knee.found {
        let shown = format_with_uncertainty(value, interval);
        sentences.push(format!(
            "The swings with extra mass show {} N m [{}, {}]; of {} bare swings {} did not move.",
            shown.value, shown.low, shown.high, knee.still[1], knee.still[0]
        ));
    }
    Answer { question: "2. Which Coulomb friction about q3, 0.020 N m or 0.010 N m?".into(), sentences, table: None }
}

fn shoulder(shoulder: &Shoulder) -> Answer {
    let shares: Vec<String> = shoulder
        .share_of_inertia
        .iter()
        .map(|(extra, share)| {
            let load = if *extra > 0.0 { format!("with {extra:.3} kg") } else { "bare".to_owned() };
            format!("{} % {load}", significant(100.0 * share, 2))
        })
        .collect();
    let mut sentences = vec![format!(
        "The shoulder's centre lies on q1's axis: its share in the gravity torque is {}, in the inertia {}. A bench good to \
         1 % leaves its mass open by 1 % over that share.",
        percent(shoulder.share_of_moment),
        shares.join(", ")
    )];
    if let Some(best) = shoulder.experiments.last() {
        sentences.push(format!(
            "What would find it: turn the leg outward (q2 {} rad, q3 {} rad), where the shoulder is {} % of what \
             turns about q1, and drive q1 with a known torque; {} % from the encoder's noise in 6 s, {} % with the bench's \
             1 %.",
            significant(best.pose_rad[0], 3),
            significant(best.pose_rad[1], 3),
            significant(100.0 * best.share, 2),
            significant(100.0 * best.by_noise, 2),
            significant(100.0 * best.with_bench, 2)
        ));
    }
    let rows = shoulder.experiments.iter().map(|e| {
        let wide =
            |half: f64| if half < 10.0 { format!("{} %", significant(100.0 * half, 2)) } else { "open".to_owned() };
        vec![e.what.clone(), format!("{} %", significant(100.0 * e.share, 2)), wide(e.by_noise), wide(e.with_bench)]
    });
    Answer {
        question: "3. Why can the shoulder mass not be found, and which experiment would find it?".into(),
        sentences,
        table: Some(Shown {
            columns: vec!["bare leg about q1, 6 s", "share of I*", "interval +-\nby noise", "with 1 %\nof bench"],
            words: 1,
            rows: rows.collect(),
            remarks: Vec::new(),
        }),
    }
}

/// Whether the model explains the swings, and what stands in the way where it does not.
fn fits(tables: &Tables) -> Answer {
    let mut sentences: Vec<String> = tables
        .weighed
        .iter()
        .map(|w| {
            let verdict = if w.lacks_something() { "the model lacks something" } else { "nothing is left to explain" };
            format!(
                "{}: all swings together to {} RMS, noise of the readings {}: {verdict}.",
                w.joint,
                mrad(w.rms_rad),
                mrad(w.noise_rad)
            )
        })
        .collect();
    sentences.extend(tables.weighed.iter().filter(|w| w.lacks_something()).filter_map(by_load));
    let in_the_robot =
        |whole: &Whole| format!("{}, whole robot: {}", whole.joint, refit_words(&RefitSummary::of(&whole.compared)));
    sentences.extend(tables.whole.iter().map(in_the_robot));
    if let Some(drop) = &tables.drop {
        sentences.push(format!(
            "Figure 3.6: the whole robot with the values of Tables 3.2 and 3.4 meets the drop of {} to {} with the other joints \
             rigid, to {} with them held by PID; the log ends at {} rad, the robot at {} and {} rad.",
            drop.file,
            mrad(drop.rigid.rms_rad),
            mrad(drop.controlled.rms_rad),
            significant(drop.end_rad, 4),
            significant(drop.rigid.end_rad, 4),
            significant(drop.controlled.end_rad, 4)
        ));
    }
    Answer { question: "Do the models explain these swings?".into(), sentences, table: None }
}

/// How Coulomb friction goes with the load, where one friction does not fit all loads.
fn by_load(weighed: &Weighed) -> Option<String> {
    let rows: Vec<_> = weighed
        .by_load
        .iter()
        .filter(|row| row.quantity == "coulomb")
        .filter_map(|row| Some((row.swings.as_str(), row.ours?, row.interval?)))
        .collect();
    let (first, last) = (rows.first()?, rows.last()?);
    let list: Vec<String> = rows
        .iter()
        .map(|(swings, value, interval)| {
            let shown = format_with_uncertainty(*value, *interval);
            format!("{} [{}, {}] {swings}", shown.value, shown.low, shown.high)
        })
        .collect();
    let grows = last.2[0] > first.2[1];
    let falls = last.2[1] < first.2[0];
    let verdict = if grows {
        "it grows with the load: load_friction stands in the way of one friction for all loads"
    } else if falls {
        "it falls with the load"
    } else {
        "the load does not explain it"
    };
    Some(format!("{}, Coulomb friction [N m] by load: {}; {verdict}.", weighed.joint, list.join(", ")))
}
