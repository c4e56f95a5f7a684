//! The drawing library's SVG, made smaller and made ready for the page's script.

use std::fmt::Write as _;

use minijinja::HtmlEscape;
use plotters::style::RGBColor;

use super::canvas::{DASHED, FAMILY, px};
use super::layout::width;

/// Dash and gap \[px\].
const DASH: [f64; 2] = [6.0, 4.0];
/// So many dots of one kind or more become one path.
const FEW: usize = 3;

/// Sets the shown size and the name, dashes what is to be dashed, draws dots of one kind as one path, and leaves out
/// attributes that say what is so anyway. `told` is what the page's script may say of the figure.
///
/// Quotes in texts are escaped by the backend, so nothing but attributes can match.
pub(super) fn shrunk(svg: &str, (title, height): (&str, f64), told: Option<String>) -> String {
    let wide = width();
    let size = format!("width=\"{}\" height=\"{}\"", px(wide), px(height));
    let legal = |c: char| !matches!(c, '\u{fffe}' | '\u{ffff}');
    let clean: String = title.chars().filter(|c| legal(*c)).map(|c| if c.is_control() { ' ' } else { c }).collect();
    let mut shown = format!(
        "role=\"img\" font-family=\"{FAMILY}\" aria-label=\"{}\" width=\"{wide}\" height=\"{height}\"",
        HtmlEscape(&clean)
    );
    if let Some(told) = told {
        let told: String = told.chars().filter(|c| legal(*c)).collect();
        _ = write!(shown, " data-readout=\"{}\"", HtmlEscape(&told));
    }
    let body = svg.replace(" opacity=\"1\"", "").replace(" stroke=\"none\"", "").replace(" fill=\"#000000\"", "");
    let body = body.replace(&format!(" font-family=\"{FAMILY}\""), "");
    dashed(&dots_joined(&body.replacen(&size, "\u{0}", 1))).replacen('\u{0}', &shown, 1)
}

/// Lines of [`DASHED`] colours with dashes.
fn dashed(svg: &str) -> String {
    let pattern = format!("stroke-dasharray=\"{} {}\"", px(DASH[0]), px(DASH[1]));
    DASHED.iter().fold(svg.to_owned(), |svg, RGBColor(red, green, blue)| {
        let stroke = format!("stroke=\"#{red:02X}{green:02X}{blue:02X}\"");
        svg.lines()
            .map(|line| match line.starts_with("<polyline") {
                true => line.replacen(&stroke, &format!("{stroke} {pattern}"), 1) + "\n",
                false => format!("{line}\n"),
            })
            .collect()
    })
}

/// A dot: its centre, its radius and all else that is said of it.
fn dot(line: &str) -> Option<(&str, &str, u32, &str)> {
    let rest = line.strip_prefix("<circle cx=\"")?.strip_suffix("/>")?;
    let (x, rest) = rest.split_once("\" cy=\"")?;
    let (y, rest) = rest.split_once("\" r=\"")?;
    let (radius, look) = rest.split_once('"')?;
    Some((x, y, radius.parse().ok()?, look))
}

/// Runs of dots that look alike as one path of points with round ends, a fifth as long.
fn dots_joined(svg: &str) -> String {
    let lines: Vec<&str> = svg.lines().collect();
    let kind = |line: &str| dot(line).map(|(_, _, radius, look)| (radius, look.to_owned()));
    let mut out = String::with_capacity(svg.len());
    for run in lines.chunk_by(|a, b| kind(a).is_some() && kind(a) == kind(b)) {
        let dots: Vec<_> = run.iter().filter_map(|line| dot(line)).collect();
        let Some((_, _, radius, look)) = dots.first().filter(|_| dots.len() >= FEW) else {
            run.iter().for_each(|line| _ = writeln!(out, "{line}"));
            continue;
        };
        let look = look.replace("fill=", "stroke=").replace(" stroke-width=\"1\"", "");
        _ = write!(
            out,
            "<path class=\"dots\" fill=\"none\" stroke-linecap=\"round\" stroke-width=\"{}\"{look} d=\"",
            2 * radius
        );
        dots.iter().for_each(|(x, y, ..)| _ = write!(out, "M{x},{y}h0"));
        out.push_str("\"/>\n");
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dots_that_look_alike_become_one_path_and_others_stay() {
        let dot = |x: u32, colour: &str| {
            format!("<circle cx=\"{x}\" cy=\"7\" r=\"9\" opacity=\"0.5\" fill=\"#{colour}\" stroke-width=\"1\"/>\n")
        };
        let svg: String = (1..=3).map(|x| dot(x, "5A5A5A")).chain([dot(4, "0072B2")]).collect();
        let joined = "<path class=\"dots\" fill=\"none\" stroke-linecap=\"round\" stroke-width=\"18\" opacity=\"0.5\" \
                      stroke=\"#5A5A5A\" d=\"M1,7h0M2,7h0M3,7h0\"/>\n";
        assert_eq!(dots_joined(&svg), format!("{joined}{}", dot(4, "0072B2")));
    }

    #[test]
    fn what_is_asked_is_dashed() {
        let line = |colour: &str| format!("<polyline fill=\"none\" stroke=\"{colour}\" points=\"1,2 3,4\"/>\n");
        assert!(dashed(&line("#000000")).contains("stroke=\"#000000\" stroke-dasharray=\"24 16\""));
        assert_eq!(dashed(&line("#0072B2")), line("#0072B2"));
    }
}
