//! Figures are looked at by people; these tests hold what a machine can: sound XML, labels, same bytes, no panic.

use super::gap_figures;
use crate::gap::{Confusion, Next, ResidualTorque};
use crate::report::gap::{GapReport, render_gap_html, sample};
use crate::report::plot::tests::texts;

fn figure(report: &GapReport, start: &str) -> Vec<String> {
    let figures = gap_figures(report).expect("figures of any diagnosis");
    let figure = figures.iter().find(|figure| figure.file_name.starts_with(start)).expect("the figure is there");
    texts(&figure.svg)
}

#[test]
fn every_figure_is_sound_and_has_a_name_of_its_own() {
    for (name, report) in sample::all() {
        let [first, second] = [(); 2].map(|()| gap_figures(&report).expect("figures"));
        assert_eq!(first, second, "{name}");
        for figure in &first {
            assert!(!texts(&figure.svg).is_empty(), "{name}: {}", figure.file_name);
        }
        let mut names: Vec<_> = first.iter().map(|figure| figure.file_name.as_str()).collect();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), first.len(), "{name}");
    }
}

#[test]
fn figures_name_their_axes_with_units() {
    let report = sample::set_of_two();
    for (start, labels) in [
        (
            "waterfall",
            ["as given", "recalibrated", "stribeck (gaussian)", "floor", "closes", "alone", "last"].as_slice(),
        ),
        ("map", &["swing-03-220g.csv", "reversal", "all"]),
        ("variables", &["speed", "share of its variance that each variable alone explains [%]"]),
        ("profile", &["speed [rad/s]", "missing torque [N m]"]),
        ("ranking", &["as given", "stribeck", "load_friction", "RMS of the angle error, held-out logs [mrad]"]),
        ("twins", &["true cause ↓", "unexplained"]),
        ("how-far", &["all of them", "RMS of the angle error [mrad], logarithmic"]),
        ("log-01", &["angle [rad]", "residual [mrad]", "torque [N m]", "time [s]"]),
        ("intervals", &["inertia I*", "stribeck mu_st"]),
        ("next", &["setpoint [rad]", "time [s]"]),
        ("close-up", &["angle [rad]", "residual [mrad]", "time [s]"]),
    ] {
        let texts = figure(&report, start);
        for label in labels {
            assert!(texts.iter().any(|text| text == label), "{start} lacks `{label}`: {texts:?}");
        }
    }
    assert!(figure(&sample::unexplained(), "shape").iter().any(|text| text == "angle [rad]"));
}

#[test]
fn what_is_not_there_is_not_drawn() {
    let figures = gap_figures(&sample::empty()).expect("figures");
    assert!(figures.is_empty(), "{:?}", figures.iter().map(|figure| &figure.file_name).collect::<Vec<_>>());
}

#[test]
fn degenerate_data_is_drawn_without_panic() {
    let mut report = sample::unexplained();
    let diagnosis = &mut report.diagnosis;
    diagnosis.confusion = Some(Confusion {
        names: vec!["a".into(), "b".into()],
        counts: vec![vec![1], Vec::new()],
        command: String::new(),
    });
    diagnosis.next = Some(Next { what: String::new(), power: f64::NAN, motion: Some((vec![0.0], Vec::new())) });
    for number in [f64::NAN, f64::INFINITY, 0.0, -1.0, 1e300] {
        let diagnosis = &mut report.diagnosis;
        (diagnosis.gap.before, diagnosis.gap.floor) = (number, number);
        diagnosis.gap.per_log.iter_mut().for_each(|log| (log.before, log.after, log.floor) = (number, number, number));
        diagnosis.ranking.iter_mut().for_each(|candidate| candidate.after = number);
        diagnosis.causes.iter_mut().for_each(|cause| (cause.after, cause.last) = (number, Some(number)));
        diagnosis.location.cells.iter_mut().for_each(|cell| cell.share = number);
        diagnosis.location.variables.iter_mut().for_each(|(_, share)| *share = number);
        diagnosis.location.profile.iter_mut().for_each(|bin| (bin.torque_nm, bin.band_nm[1]) = (number, number));
        diagnosis.location.range = Some([number, -number]);
        let log = &mut diagnosis.traces[0];
        log.before_rad.fill(number);
        log.residual_torque.sigma_nm.fill(number);
        diagnosis.traces[1].residual_torque.torque_nm.fill(number);
        diagnosis.traces[2].residual_torque = ResidualTorque::default();
        diagnosis.traces[3].measured_rad.truncate(2);
        diagnosis.traces[4].t_s.clear();
        for figure in gap_figures(&report).expect("figures of any numbers") {
            texts(&figure.svg);
        }
        render_gap_html(&report).expect("a page for any numbers");
    }
}

/// Writes pages to look at: `AIBO_FIT_LOOK=folder cargo test --release -- --ignored gap_pages_to_look_at`.
#[test]
#[ignore = "writes pages for a person to look at"]
fn gap_pages_to_look_at() {
    let folder = std::env::var_os("AIBO_FIT_LOOK").map_or_else(std::env::temp_dir, std::path::PathBuf::from);
    for (name, report) in sample::all() {
        let page = render_gap_html(&report).expect("a page");
        std::fs::write(folder.join(format!("gap-{name}.html")), page).expect("the folder can be written");
    }
}
