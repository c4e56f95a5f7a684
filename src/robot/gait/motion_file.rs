//! Tekkotsu's motion files (section 4.2.1): text, `#MSq` first, `#END` last, other lines that begin with `#` being
//! comments.
//!
//! ```text
//! #MSq
//! radians
//! setTime 0
//! LFr:rotor -0.30000
//! delay 128
//! LFr:rotor -0.28000
//! #END
//! ```
//!
//! `delay` (or `advanceTime`) and `setTime` are in ms, a third word on an output's line is its weight. Names and senses
//! of the outputs are those of Tekkotsu's ERS-7, which hands the angles to OPEN-R as they are: its limits are those of
//! Table A.3 with their signs. Some versions fill names with `~`; the reader drops it. Later versions refuse `degrees`,
//! so `radians` is written; the reader takes both.

use super::motion::{Key, Motion};
use crate::log::{Document, LogError};
use crate::robot::{Model, RobotError};
use std::fmt::Write as _;
use std::ops::Range;
use std::path::Path;

/// Tekkotsu's outputs, and the joints of `data/ers7.toml` that they are.
const OUTPUTS: [(&str, &str); 18] = [
    ("LFr:rotor", "lf1"),
    ("LFr:elvtr", "lf2"),
    ("LFr:knee", "lf3"),
    ("RFr:rotor", "rf1"),
    ("RFr:elvtr", "rf2"),
    ("RFr:knee", "rf3"),
    ("LBk:rotor", "lr1"),
    ("LBk:elvtr", "lr2"),
    ("LBk:knee", "lr3"),
    ("RBk:rotor", "rr1"),
    ("RBk:elvtr", "rr2"),
    ("RBk:knee", "rr3"),
    ("NECK:tilt", "neck_tilt1"),
    ("NECK:pan", "neck_pan"),
    ("NECK:nod", "neck_tilt2"),
    ("TAIL:tilt", "tail_tilt"),
    ("TAIL:pan", "tail_pan"),
    ("MOUTH", "mouth"),
];
/// Outputs that are no joints: lamps, and ears that are up or down.
const OTHERS: [&str; 2] = ["LED:", "EAR:"];
/// A delay beyond this is a gap \[ms\].
const LONGEST_MS: i64 = 60_000;

impl Motion {
    /// Whether a robot has joints that such a file can move.
    pub fn has_outputs_of(model: &Model) -> bool {
        OUTPUTS.iter().any(|(_, name)| model.joint(name).is_ok())
    }

    /// The motion as a file's text. Joints that Tekkotsu does not know (the ears) are left out.
    pub fn to_text(&self, model: &Model) -> String {
        let joint = |name: &str| model.joint(name).ok().and_then(|joint| self.keys.get(joint.index()));
        let outputs: Vec<(&str, &[Key])> =
            OUTPUTS.iter().filter_map(|(output, name)| Some((*output, joint(name)?.as_slice()))).collect();
        let mut times: Vec<u32> = outputs.iter().flat_map(|(_, keys)| keys.iter().map(|key| key.0)).collect();
        times.sort_unstable();
        times.dedup();
        let mut text = "#MSq\nradians\nsetTime 0\n".to_owned();
        let mut before_ms = 0;
        for ms in times {
            if ms > before_ms {
                let _ = writeln!(text, "delay {}", ms - before_ms);
            }
            before_ms = ms;
            for (output, keys) in &outputs {
                if let Ok(k) = keys.binary_search_by_key(&ms, |key| key.0) {
                    let _ = writeln!(text, "{output} {:.5}", keys[k].1);
                }
            }
        }
        text + "#END\n"
    }

    /// Reads a motion file for a robot.
    ///
    /// # Errors
    /// [`RobotError::File`] with file and line: no header, no end (cut off), an output that is no joint of the robot, a
    /// time that runs back or leaves a gap, a jump beyond a joint's speed limit.
    pub fn read(file: &Path, model: &Model) -> Result<Self, RobotError> {
        Ok(read(&Document::open(file)?, model)?)
    }

    /// Reads a motion file that is at hand; `file` is its name in errors.
    ///
    /// # Errors
    /// As [`Motion::read`].
    pub fn from_text(file: &Path, text: &str, model: &Model) -> Result<Self, RobotError> {
        Ok(read(&Document::of_text(file, text), model)?)
    }
}

/// A line of the file, by words with their places.
struct Line<'a> {
    words: Vec<(&'a str, Range<usize>)>,
}

fn lines(text: &str) -> impl Iterator<Item = Line<'_>> {
    let words = |line: &'_ str| {
        let from = line.as_ptr() as usize - text.as_ptr() as usize;
        let place = move |word: &str| from + (word.as_ptr() as usize - line.as_ptr() as usize);
        line.split_whitespace().map(|word| (place(word), word.len())).collect::<Vec<_>>()
    };
    text.lines().map(words).map(|places| Line {
        words: places.into_iter().map(|(at, long)| (&text[at..at + long], at..at + long)).collect(),
    })
}

fn read(document: &Document<'_>, model: &Model) -> Result<Motion, LogError> {
    let mut motion = Motion { keys: vec![Vec::new(); model.joints().len()] };
    let (mut ms, mut scale, mut started) = (0_i64, 1.0, false);
    for line in lines(document.text()) {
        let Some((command, span)) = line.words.first().cloned() else { continue };
        if !started {
            if command != "#MSq" {
                return Err(document.wrong(
                    "#MSq",
                    span,
                    format!("`{command}`"),
                    "`#MSq`, the header of a motion file",
                ));
            }
            started = true;
            continue;
        }
        let argument = |k: usize| line.words.get(k).cloned();
        match command.to_ascii_lowercase().as_str() {
            "#end" => return Ok(motion),
            _ if command.starts_with('#') => {}
            "radians" => scale = 1.0,
            "degrees" => scale = 1.0_f64.to_radians(),
            "delay" | "advancetime" => ms += milliseconds(document, command, span, argument(1))?,
            "settime" => {
                let (to, place) = (milliseconds(document, command, span.clone(), argument(1))?, argument(1));
                if to < ms {
                    let span = place.map_or(span, |(_, span)| span);
                    return Err(document.wrong(command, span, format!("{to} ms"), &format!("{ms} ms or later")));
                }
                ms = to;
            }
            _ => key(document, model, &mut motion, (ms, scale), &line)?,
        }
        if ms > i64::from(u32::MAX) {
            return Err(document.wrong(command, 0..0, format!("{ms} ms"), "an end within 49 days"));
        }
    }
    let end = document.text().len();
    Err(match started {
        true => document.wrong("#END", end..end, "the end of the file", "`#END` on the last line; was it cut off?"),
        false => document.wrong("#MSq", 0..0, "an empty file", "`#MSq`, the header of a motion file"),
    })
}

fn milliseconds(
    document: &Document<'_>,
    command: &str,
    line: Range<usize>,
    argument: Option<(&str, Range<usize>)>,
) -> Result<i64, LogError> {
    let expected = "a whole number of ms from 0 to 60000; a longer one leaves a gap";
    let Some((word, span)) = argument else { return Err(document.wrong(command, line, "nothing", expected)) };
    match word.parse::<i64>() {
        Ok(ms) if (0..=LONGEST_MS).contains(&ms) || command.eq_ignore_ascii_case("setTime") && ms >= 0 => Ok(ms),
        _ => Err(document.wrong(command, span, format!("`{word}`"), expected)),
    }
}

/// An output's line.
fn key(
    document: &Document<'_>,
    model: &Model,
    motion: &mut Motion,
    (ms, scale): (i64, f64),
    line: &Line<'_>,
) -> Result<(), LogError> {
    let (output, span) = line.words[0].clone();
    if OTHERS.iter().any(|other| output.starts_with(other)) {
        return Ok(());
    }
    let bare = output.trim_end_matches('~');
    let name = OUTPUTS.iter().find(|(other, _)| other.eq_ignore_ascii_case(bare)).map(|(_, name)| *name);
    let Some(joint) = name.and_then(|name| model.joint(name).ok()) else {
        let names: Vec<&str> = OUTPUTS.iter().map(|(output, _)| *output).collect();
        let expected = format!("delay, setTime, radians, degrees or an output: {}", names.join(", "));
        return Err(document.wrong(output, span, format!("`{output}`"), &expected));
    };
    let number = |k: usize, what: &str| match line.words.get(k) {
        Some((word, span)) => match word.parse::<f64>() {
            Ok(number) if number.is_finite() => Ok((number, span.clone())),
            _ => Err(document.wrong(output, span.clone(), format!("`{word}`"), what)),
        },
        None => Err(document.wrong(output, span.clone(), "nothing", what)),
    };
    let (value, place) = number(1, "an angle")?;
    if line.words.len() > 2 && number(2, "a weight")?.0 <= 0.0 {
        return Ok(()); // not commanded
    }
    let (angle, keys) = (value * scale, &mut motion.keys[joint.index()]);
    let now = u32::try_from(ms).unwrap_or(u32::MAX);
    if keys.last().is_some_and(|key| key.0 == now) {
        keys.pop();
    }
    if let (Some(&(before, from)), Some(most)) = (keys.last(), model.joints()[joint.index()].speed_rad_s) {
        let speed = (angle - from).abs() / (f64::from(now - before) * 1e-3);
        if speed > most {
            let found = format!("a jump of {:.3} rad in {} ms, {speed:.2} rad/s", angle - from, now - before);
            return Err(document.wrong(output, place, found, &format!("at most {most} rad/s (Table A.3)")));
        }
    }
    keys.push((now, angle));
    Ok(())
}
