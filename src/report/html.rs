//! The report as one page that opens without a network.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use minijinja::{Environment, HtmlEscape, Value, context};

use super::grid::Grid;
use super::number::{UNKNOWN, quantity, significant};
use super::plot::layout::narrow;
use super::plot::{FONT_BOLD, FONT_REGULAR, Figure, log_figures, model_figures};
use super::rows::{ParameterCells, is_shown, typeset_unit};
use super::{DropReport, LogHealthRow, ModelSummary, ParameterRow, ReportError, beliefs, full, table};
use crate::identify::BeliefFound;

/// Logs whose figures stand open on the page; the others can be unfolded.
const OPEN_LOGS: usize = 8;
/// Frame and parts of all pages. The ending makes the template engine escape every text.
const SHARED: [(&str, &str); 2] =
    [("page.html", include_str!("templates/page.html")), ("parts.html", include_str!("templates/parts.html"))];

/// Zooms figures and reads values off them; the page can be read without it.
const SCRIPT: &str = include_str!("templates/figures.js");

/// Renders a page from its template; the fonts are given to every page, the script to those with figures that it can read.
pub(super) fn render(name: &str, template: &str, values: Value) -> Result<String, ReportError> {
    let mut environment = Environment::new();
    for (name, template) in SHARED.into_iter().chain([(name, template)]) {
        environment.add_template(name, template)?;
    }
    environment.add_filter("file", file_name);
    // A style sheet knows no escapes: a font that is escaped is no font.
    let font = |font: &[u8]| Value::from_safe_string(STANDARD.encode(font));
    let fonts = context! { font_regular => font(FONT_REGULAR), font_bold => font(FONT_BOLD) };
    let page = environment.get_template(name)?.render(context! { ..values, ..fonts })?;
    if !page.contains(" data-readout=\"") {
        return Ok(page);
    }
    Ok(page.replacen("</body>", &format!("<script>\n{SCRIPT}</script>\n</body>"), 1))
}

/// A file's name that may be broken where its parts end, and nowhere else.
fn file_name(name: &str) -> Value {
    let mut safe = String::new();
    for c in name.chars() {
        safe += &HtmlEscape(&c.to_string()).to_string();
        if matches!(c, '/' | '\\' | '_' | '-') {
            safe += "<wbr>";
        }
    }
    Value::from_safe_string(safe)
}

/// Puts a drop report into one HTML page: verdict, notes, models, parameters, data health, figures, provenance.
///
/// The page holds its figures, its font and its script, and loads nothing; it can be read without the script. Same report,
/// same bytes.
///
/// # Errors
/// [`ReportError::Draw`] or [`ReportError::Font`] from the figures, [`ReportError::Page`] from the template; none depends
/// on the data.
pub fn render_html(report: &DropReport) -> Result<String, ReportError> {
    let (logs, folded) = open_and_folded(both(|| log_figures(report))?.each_ref());
    let (full_logs, full_folded) = match &report.full {
        Some(full) => open_and_folded(both(|| full::full_figures(&report.joint, full))?.each_ref()),
        None => (Vec::new(), Vec::new()),
    };
    let provenance = report.provenance.clone();
    let values = context! {
        joint => report.joint.as_str(),
        sentence => report.sentence.as_str(),
        notes => report.notes.clone(),
        models => report.models.iter().map(model_view).collect::<Vec<_>>(),
        beliefs => report.beliefs.iter().map(|belief| belief_view(report, belief)).collect::<Vec<_>>(),
        health => report.health.iter().map(health_view).collect::<Vec<_>>(),
        logs,
        folded,
        figures => figure_views(both(|| model_figures(report))?.each_ref()),
        swings => (!report.logs.is_empty()).then(|| table::logs(report).view()),
        full => report.full.as_ref().map(full::summary),
        full_tables => report.full.as_ref().map(|full| {
            full::full_tables(full).iter().map(Grid::view).collect::<Vec<_>>()
        }),
        full_logs,
        full_folded,
        has_friction => !report.friction.is_empty(),
        version => provenance.version,
        command => provenance.command,
        inputs => provenance.inputs,
    };
    render("drop.html", include_str!("templates/drop.html"), values)
}

fn belief_view(report: &DropReport, belief: &BeliefFound) -> Value {
    context! {
        name => belief.name.as_str(),
        believed => typeset_unit(&beliefs::believed(belief)),
        found => typeset_unit(&quantity(belief.found, report.interval(&belief.name), &belief.unit)),
        moved => beliefs::moved(belief),
    }
}

/// Draws figures for a wide and for a narrow screen.
pub(super) fn both<T>(draw: impl Fn() -> Result<T, ReportError>) -> Result<[T; 2], ReportError> {
    Ok([draw()?, narrow(&draw)?])
}

/// Figures of the logs that stand open, and those that can be unfolded; each wide and narrow.
pub(super) fn open_and_folded(figures: [&Vec<Figure>; 2]) -> (Vec<Value>, Vec<Value>) {
    let mut open = figure_views(figures);
    let folded = open.split_off(OPEN_LOGS.min(open.len()));
    (open, folded)
}

/// Figures with their captions, wide and narrow; where both are the same there is one.
pub(super) fn figure_views([wide, narrow]: [&Vec<Figure>; 2]) -> Vec<Value> {
    let view = |figure: &Figure| {
        let slim = narrow.iter().find(|other| other.file_name == figure.file_name && other.svg != figure.svg);
        context! {
            title => figure.title.as_str(),
            caption => figure.caption.as_str(),
            svg => Value::from_safe_string(figure.svg.clone()),
            narrow => slim.map(|slim| Value::from_safe_string(slim.svg.clone())),
        }
    };
    wide.iter().map(view).collect()
}

fn model_view(model: &ModelSummary) -> Value {
    context! {
        name => model.name.as_str(),
        rms_mrad => significant(1e3 * model.rms_rad, 3),
        criterion => significant(model.criterion_rad2_s, 3),
        method => model.method.as_str(),
        stop => model.stop.as_str(),
        evaluations => model.evaluations,
        parameters => model.parameters.iter().map(parameter_view).collect::<Vec<_>>(),
    }
}

pub(super) fn parameter_view(row: &ParameterRow) -> Value {
    let cells = ParameterCells::from(row);
    context! {
        label => cells.label,
        unit => typeset_unit(&cells.unit),
        estimate => cells.estimate,
        is_words => !is_shown(row),
        interval => cells.interval,
        naive => cells.naive,
        nominal => cells.nominal,
    }
}

pub(super) fn health_view(row: &LogHealthRow) -> Value {
    let milli = |value: f64| significant(1e3 * value, 3);
    let seconds = |value: f64| if value.is_finite() { format!("{value:.3}") } else { UNKNOWN.to_owned() };
    let dash = || "–".to_owned();
    context! {
        file => row.file.as_str(),
        role => row.role.as_str(),
        samples => row.samples,
        duration_s => seconds(row.duration_s),
        period_ms => milli(row.period_s),
        // Less than a nanosecond is the rounding of `t`.
        jitter_ms => if row.jitter_s < 1e-9 { "0".to_owned() } else { milli(row.jitter_s) },
        lost => row.lost,
        resolution_mrad => if row.resolution_rad == 0.0 { "none found".to_owned() } else { milli(row.resolution_rad) },
        noise_mrad => row.noise_rad.map_or_else(dash, milli),
        release_s => row.release_s.map_or_else(dash, seconds),
        rest_from_s => row.rest_from_s.map_or_else(dash, seconds),
        remarks => row.remarks.clone(),
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::report::sample;

    fn page(report: &DropReport) -> String {
        render_html(report).expect("a page for any report")
    }

    /// A page loads nothing, and runs nothing but the script of its figures.
    pub(in crate::report) fn is_alone(page: &str) {
        let own = format!("<script>\n{SCRIPT}</script>");
        assert_eq!(page.matches("<script").count(), page.matches(&own).count());
        let rest = page.replace(&own, "");
        assert!(!rest.contains("src=") && !rest.contains("javascript:"));
        let addresses = page.matches("http").count();
        assert_eq!(addresses, page.matches("xmlns=\"http://www.w3.org/2000/svg\"").count());
    }

    #[test]
    fn page_needs_no_network() {
        let page = page(&sample::troubled());
        is_alone(&page);
        assert!(!page.contains("href="));
    }

    #[test]
    fn fonts_are_read_by_browsers() {
        let page = page(&sample::single());
        let fonts = page.split("base64,").skip(1).map(|rest| rest.split_once(')').expect("an end").0);
        let fonts: Vec<_> = fonts.map(|font| STANDARD.decode(font).expect("base64")).collect();
        assert_eq!(fonts, [FONT_REGULAR, FONT_BOLD]);
    }

    #[test]
    fn script_is_short_and_of_its_own() {
        assert!(SCRIPT.lines().count() < 190, "{}", SCRIPT.lines().count());
        assert!(!["http", "import", "fetch(", "eval("].iter().any(|word| SCRIPT.contains(word)));
    }

    #[test]
    fn sections_stand_in_the_order_in_which_one_reads() {
        let page = page(&sample::single());
        let headings = [
            "class=\"verdict\"",
            ">Swings<",
            ">Models<",
            ">Parameters<",
            ">Data health<",
            ">About the fit<",
            ">Provenance<",
        ];
        let places: Vec<_> = headings.iter().map(|heading| page.find(heading)).collect();
        assert!(places.iter().all(Option::is_some) && places.is_sorted(), "{places:?}");
    }

    #[test]
    fn texts_are_escaped() {
        let page = page(&sample::troubled());
        assert!(page.contains("&lt;b&gt;") && !page.contains("<b>"));
    }

    #[test]
    fn undetermined_value_is_nowhere_on_the_page() {
        let page = page(&sample::troubled());
        assert!(page.contains("not determined") && page.contains("held at 9.81") && !page.contains(sample::SECRET));
    }

    #[test]
    fn more_than_eight_logs_are_folded() {
        let page = page(&sample::many(12));
        let fold = page.find("<details").expect("a fold");
        assert_eq!(page[..fold].matches("<figure").count(), OPEN_LOGS);
        assert!(page.contains("4 more swings"));
    }

    #[test]
    fn same_report_same_bytes_and_empty_report_makes_a_page() {
        assert_eq!(page(&sample::single()), page(&sample::single()));
        assert!(page(&sample::empty()).contains("</html>"));
    }
}
