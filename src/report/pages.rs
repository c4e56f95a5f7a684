//! Every page, whatever it is of: figures that can be read, wide and narrow, each once, with their data beside them.

use std::collections::BTreeSet;

use super::html::tests::is_alone;
use super::plot::canvas::Look;
use super::plot::layout::narrow;
use super::*;

/// Drawing units in a pixel.
const UNITS: f64 = 4.0;
/// Smallest text \[px\], with some room for rounding.
const LEAST_TEXT: f64 = 9.9;

/// Every page of the samples, by its name.
fn all() -> Vec<(String, String)> {
    let drops = [("single", sample::single()), ("many", sample::many(3)), ("driven", sample::driven())];
    let drops = drops.into_iter().chain([("troubled", sample::troubled())]);
    let mut pages: Vec<(String, String)> =
        drops.map(|(name, report)| (format!("drop {name}"), render_html(&report).expect("a page"))).collect();
    let joints = gap::sample::all().into_iter();
    pages.extend(joints.map(|(name, report)| (format!("gap {name}"), render_gap_html(&report).expect("a page"))));
    let robots = robot_gap::sample::all().into_iter();
    pages.extend(robots.map(|(name, report)| (format!("robot {name}"), robot_gap_html(&report).expect("a page"))));
    pages
}

/// The figures of a page: class of their box and SVG.
fn figures(page: &str) -> Vec<(&str, &str)> {
    let boxes = page.split("<div class=\"").skip(1).filter_map(|rest| rest.split_once("\">"));
    let figures = boxes.filter(|(class, _)| ["on-wide", "on-narrow", "as-it-is"].contains(class));
    figures.filter_map(|(class, rest)| Some((class, rest.split_once("</div>")?.0))).collect()
}

#[test]
fn every_figure_has_its_data_and_stands_once() {
    for (name, page) in all() {
        is_alone(&page);
        let figures = figures(&page);
        assert_eq!(figures.len() % 2, 0, "{name}: each is drawn wide and narrow");
        let distinct: BTreeSet<&str> = figures.iter().map(|(_, svg)| *svg).collect();
        assert_eq!(distinct.len(), figures.len(), "{name}: a figure stands there twice");
        for (class, svg) in figures {
            let document = roxmltree::Document::parse(svg.trim()).unwrap_or_else(|error| panic!("{name}: {error}"));
            let told = document.root_element().attribute("data-readout");
            let of = || document.root_element().attribute("aria-label").unwrap_or_default();
            let told: serde_json::Value =
                serde_json::from_str(told.unwrap_or_else(|| panic!("{name}: {class}: {} has no data", of())))
                    .expect("JSON");
            let count = |key: &str| told[key].as_array().map_or(0, Vec::len);
            assert!(count("panels") + count("spots") > 0, "{name}: {}", of());
            for panel in told["panels"].as_array().into_iter().flatten() {
                let labels = panel[4].as_array().expect("labels of both axes");
                assert!(
                    labels.iter().all(|label| label.as_str().is_some_and(|label| !label.is_empty())),
                    "{name}: {panel}"
                );
            }
        }
    }
}

#[test]
fn words_stay_on_their_figure_and_can_be_read_on_a_narrow_screen() {
    for (name, page) in all() {
        for (class, svg) in figures(&page) {
            let document = roxmltree::Document::parse(svg.trim()).expect("sound XML");
            let wide: f64 = document.root_element().attribute("width").and_then(|w| w.parse().ok()).expect("a width");
            assert_eq!(wide, if class == "on-narrow" { 460.0 } else { 920.0 }, "{name}");
            for text in document.descendants().filter(|node| node.has_tag_name("text")) {
                let number = |key: &str| text.attribute(key).and_then(|value| value.parse::<f64>().ok());
                let words = text.text().unwrap_or_default().trim();
                let size = number("font-size").expect("a size") / UNITS;
                assert!(size >= LEAST_TEXT, "{name}: `{words}` is {size} px large");
                if text.attribute("transform").is_some() {
                    continue;
                }
                let bold = text.attribute("font-weight") == Some("bold");
                let long = Look { size, bold, ..Look::default() }.width(words);
                let x = number("x").expect("a place") / UNITS;
                let from = match text.attribute("text-anchor") {
                    Some("middle") => x - 0.5 * long,
                    Some("end") => x - long,
                    _ => x,
                };
                assert!(from > -1.0 && from + long < wide + 1.0, "{name}: `{words}` from {from} to {} px", from + long);
            }
        }
    }
}

#[test]
fn a_narrow_figure_has_the_same_title_and_data_as_the_wide_one() {
    let report = sample::single();
    let [wide, slim] = [figures_of(&report), narrow(|| figures_of(&report))];
    assert_eq!(wide.len(), slim.len());
    for (wide, slim) in wide.iter().zip(&slim) {
        assert_eq!((&wide.file_name, &wide.title, &wide.caption), (&slim.file_name, &slim.title, &slim.caption));
        assert_ne!(wide.svg, slim.svg, "{}", wide.file_name);
    }
}

fn figures_of(report: &DropReport) -> Vec<Figure> {
    super::figures(report).expect("figures")
}

#[test]
fn a_drop_page_has_every_table_of_the_text() {
    let mut report = sample::single();
    let row = FullRow { file: "q1.csv".into(), pendulum_rms: 0.00244, give: 0.0123, ..FullRow::default() };
    report.full = Some(FullDrop { rows: vec![row], ..FullDrop::default() });
    let (page, text) = (render_html(&report).expect("a page"), drop_text(&report));
    let heads = ["fitted", "RMS extensive", "evaluations", "95 % interval", "whole robot", "others give", "12.3"];
    for words in heads {
        assert!(text.contains(words), "the text lacks `{words}`:\n{text}");
        assert!(page.contains(words), "the page lacks `{words}`");
    }
    let first = page.find("<figure").expect("a figure");
    assert!(
        page.find("class=\"verdict\"").expect("a verdict") < first && first < page.find("Data health").expect("health")
    );
}
