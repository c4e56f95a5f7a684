//! Figures are looked at by people; these tests hold what a machine can: sound XML, labels, same bytes, no panic.

use proptest::prelude::*;

use super::*;
use crate::report::{Correlation, FrictionPoint, ModelSummary, render_html, sample};

/// All texts of a figure, after checking that it is sound XML with whole numbers only.
pub(in crate::report) fn texts(svg: &str) -> Vec<String> {
    let document = roxmltree::Document::parse(svg).unwrap_or_else(|error| panic!("{error}:\n{svg}"));
    assert!(!svg.contains("NaN") && !svg.contains("inf\""), "a number that is none");
    let written = document.descendants().filter(|node| node.has_tag_name("text"));
    written.filter_map(|node| node.text()).map(|text| text.trim().to_owned()).collect()
}

fn figure(report: &DropReport, start: &str) -> Vec<String> {
    let figures = figures(report).expect("figures of any report");
    let figure = figures.iter().find(|figure| figure.file_name.starts_with(start)).expect("the figure is there");
    texts(&figure.svg)
}

#[test]
fn every_figure_names_its_axes_with_units() {
    let report = sample::single();
    for (start, labels) in [
        ("swing-01-q1", ["angle [rad]", "residual [mrad]", "time [s]"].as_slice()),
        ("phase-portrait", &["angle [rad]", "speed [rad/s]"]),
        ("friction", &["speed [rad/s]", "friction torque [N m]"]),
        ("intervals", &["inertia I*", "difference from the nominal value [%]"]),
        ("correlation", &["rest angle", "+1.00"]),
        ("optimiser", &["best J so far above its end, share of it", "10⁻⁴"]),
    ] {
        let texts = figure(&report, start);
        for label in labels {
            assert!(texts.iter().any(|text| text == label), "{start} lacks `{label}`: {texts:?}");
        }
    }
}

#[test]
fn same_report_same_figures_with_names_of_their_own() {
    let report = sample::many(3);
    let [first, second] = [(); 2].map(|()| figures(&report).expect("figures"));
    assert_eq!(first, second);
    let mut names: Vec<_> = first.iter().map(|figure| figure.file_name.as_str()).collect();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), first.len());
}

#[test]
fn undetermined_parameter_is_named_in_words() {
    let texts = figure(&sample::troubled(), "intervals");
    assert!(texts.iter().any(|text| text == "these logs do not determine it"));
    assert!(texts.iter().any(|text| text == "held at 9.81 m/s²"));
    assert!(!texts.iter().any(|text| text.contains(sample::SECRET)), "{texts:?}");
}

#[test]
fn a_long_log_is_thinned() {
    let report = sample::driven();
    let svg = swing("q1", &report.logs[0]).expect("a figure");
    assert!(svg.len() < 700_000, "{} bytes", svg.len());
}

#[test]
fn degenerate_data_is_drawn_without_panic() {
    let mut log = sample::single().logs.remove(0);
    log.t_s[20] = 2.5e307;
    log.first_fitted = 20;
    log.half_step_rad = -1.6e240;
    texts(&swing("q1", &log).expect("a time beyond all axes"));
    log.first_fitted = 10_000;
    texts(&swing("q1", &log).expect("nothing fitted"));
    texts(&phase_portrait("q1", &log).expect("nothing fitted"));
    for length in [0, 1, 2] {
        for column in [&mut log.t_s, &mut log.measured_rad, &mut log.simple_rad, &mut log.extensive_rad] {
            column.truncate(length);
        }
        log.first_fitted = 0;
        texts(&swing("q1", &log).expect("few samples"));
        texts(&phase_portrait("q1", &log).expect("few samples"));
    }
    texts(&friction_curve("q1", &[]).expect("no friction"));
    texts(&correlation_matrix("q1", &Correlation::default()).expect("no parameters"));
    let ragged = Correlation { names: vec!["a".into(), "b".into()], matrix: vec![vec![1.0]] };
    texts(&correlation_matrix("q1", &ragged).expect("a matrix with holes"));
    let many = Correlation { names: vec!["a long parameter name".into(); 60], matrix: Vec::new() };
    texts(&correlation_matrix("q1", &many).expect("many parameters"));
    texts(&parameter_intervals("q1", &[]).expect("no models"));
    let mut models = sample::single().models;
    for trace in [vec![], vec![1.0], vec![1.0; 4], vec![f64::NAN, f64::INFINITY], vec![1e300, 1e-300]] {
        models[0].trace_rad2_s.clone_from(&trace);
        models[1].trace_rad2_s = trace;
        texts(&optimiser_trace("q1", &models).expect("a poor trace"));
    }
    for report in [sample::empty(), sample::troubled()] {
        for figure in figures(&report).expect("figures") {
            texts(&figure.svg);
        }
    }
}

#[test]
fn control_characters_in_names_leave_the_xml_sound() {
    let mut log = sample::single().logs.remove(0);
    log.file = "a\u{1}\tb\u{ffff}<&>\"'.csv".into();
    texts(&swing("q\u{0}1", &log).expect("a figure"));
}

fn any_curve() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(prop::num::f64::ANY, 0..40)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn any_curves_are_drawn(t in any_curve(), a in any_curve(), b in any_curve(), first in 0usize..50, half: f64) {
        let log = LogCurves {
            file: "any.csv".into(),
            role: "fit".into(),
            t_s: t.clone(),
            measured_rad: a.clone(),
            first_fitted: first,
            release_s: None,
            simple_rad: b.clone(),
            extensive_rad: a.clone(),
            extensive_rate_rad_s: b.clone(),
            setpoint_rad: Some(b.clone()),
            half_step_rad: half,
            simple_rms_rad: half,
            extensive_rms_rad: -half,
        };
        texts(&swing("q1", &log).expect("a figure"));
        texts(&phase_portrait("q1", &log).expect("a figure"));
        let points: Vec<_> = t.iter().zip(&a).zip(&b)
            .map(|((t, a), b)| FrictionPoint { rate_rad_s: *t, torque_nm: *a, low_nm: *b, high_nm: half })
            .collect();
        texts(&friction_curve("q1", &points).expect("a figure"));
        let mut models: Vec<ModelSummary> = sample::single().models;
        models[0].trace_rad2_s = t;
        models[1].trace_rad2_s = a;
        for (row, value) in models[0].parameters.iter_mut().zip(b) {
            row.value = value;
            row.interval = Some([half, value]);
            row.nominal = Some(half);
        }
        texts(&optimiser_trace("q1", &models).expect("a figure"));
        texts(&parameter_intervals("q1", &models).expect("a figure"));
    }
}

/// Writes pages to look at: `AIBO_FIT_LOOK=folder cargo test --release -- --ignored pages_to_look_at`.
#[test]
#[ignore = "writes pages for a person to look at"]
fn pages_to_look_at() {
    let folder = std::env::var_os("AIBO_FIT_LOOK").map_or_else(std::env::temp_dir, std::path::PathBuf::from);
    for (name, report) in [
        ("single", sample::single()),
        ("many", sample::many(12)),
        ("driven", sample::driven()),
        ("troubled", sample::troubled()),
        ("empty", sample::empty()),
    ] {
        let page = render_html(&report).expect("a page");
        std::fs::write(folder.join(format!("{name}.html")), page).expect("the folder can be written");
        for figure in figures(&report).expect("figures") {
            let file = folder.join(format!("{name}-{}", figure.file_name));
            std::fs::write(file, figure.svg).expect("the folder can be written");
        }
    }
}
