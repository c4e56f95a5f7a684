//! Logs in which something holds: a servo's setting on another day, a warm motor, something in the way of one motion.

use crate::identify::Experiment;
use serde::Serialize;

/// The logs of one session, one log, or all others.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LogSet {
    /// Files of the study's logs, as the user named them.
    pub files: Vec<String>,
    /// `in session feb only`
    #[serde(skip)]
    pub words: String,
}

impl LogSet {
    /// Whether an experiment is part of one of the logs.
    pub fn holds(&self, e: &Experiment) -> bool {
        self.files.contains(&e.file)
    }
}

/// Without sessions single logs are told apart, up to so many.
const MOST_LOGS: usize = 6;

/// By what logs are told apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum By {
    /// Logs that were taken in one go.
    Session,
    /// Each for itself.
    Log,
}

impl By {
    /// The word in reports and JSON.
    pub fn name(self) -> &'static str {
        match self {
            By::Session => "session",
            By::Log => "log",
        }
    }
}

/// Logs that belong together.
#[derive(Clone, Debug)]
pub(in crate::gap) struct Group {
    /// The session's name, or the file's.
    pub name: String,
    /// These logs.
    pub inside: LogSet,
    /// All others.
    pub outside: LogSet,
}

/// Groups of a study's logs.
#[derive(Clone, Debug)]
pub(in crate::gap) struct Groups {
    pub by: By,
    pub groups: Vec<Group>,
}

impl Groups {
    /// By session where the study names any, else by log where there are few; `None` where the fitted logs are all of one
    /// group.
    pub fn of(fit: &[Experiment], held: &[Experiment]) -> Option<Self> {
        let by_session = fit.iter().any(|e| e.session.is_some());
        let by = if by_session { By::Session } else { By::Log };
        let name = |e: &Experiment| match by {
            By::Session => e.session.clone(),
            By::Log => Some(e.file.clone()),
        };
        let mut names: Vec<String> = Vec::new();
        for name in fit.iter().filter_map(name) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        let stand_alone = fit.iter().any(|e| name(e).is_none());
        if names.len() + usize::from(stand_alone) < 2 || (by == By::Log && names.len() > MOST_LOGS) {
            return None;
        }
        let all = || fit.iter().chain(held);
        let files = |inside: &dyn Fn(&Experiment) -> bool| {
            let mut files: Vec<String> = Vec::new();
            for e in all().filter(|e| inside(e)) {
                if !files.contains(&e.file) {
                    files.push(e.file.clone());
                }
            }
            files
        };
        let group = |own: String| {
            let is_inside = |e: &Experiment| name(e).as_ref() == Some(&own);
            let words = match by {
                By::Session => [format!("in session {own} only"), format!("in all sessions but {own}")],
                By::Log => [format!("in {own} only"), format!("in all logs but {own}")],
            };
            let [inside, outside] = words;
            Group {
                inside: LogSet { files: files(&is_inside), words: inside },
                outside: LogSet { files: files(&|e| !is_inside(e)), words: outside },
                name: own.clone(),
            }
        };
        Some(Self { by, groups: names.into_iter().map(group).collect() })
    }
}
