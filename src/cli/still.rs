//! What a command says where the joint never moves: that is an answer, too.

use super::CliError;
use super::common::{CommonArgs, print, write_outputs};
use super::error::NO;
use crate::identify::{Case, resting_gravity_nm};
use crate::log::{Outputs, Role};
use crate::report::still;
use serde_json::json;

/// Says of each fitted log why nothing moves; `outcome` is what cannot be given therefore.
pub(super) fn never_moved(common: &CommonArgs, case: &Case, outcome: &str) -> Result<u8, CliError> {
    let fitted = case.items.iter().filter(|item| item.entry.role == Role::Fit);
    let sentences: Vec<String> = fitted.clone().map(|item| still(case, item)).collect();
    let logs: Vec<_> = fitted
        .map(|item| {
            json!({ "file": item.entry.file, "moved": false,
                "breakaway_at_least_nm": resting_gravity_nm(case, item) })
        })
        .collect();
    let mut outputs = Outputs::default();
    common.add_json(
        &mut outputs,
        &json!({ "schema": 1, "name": case.joint.name, "moved": false, "sentence": sentences.join(" "), "logs": logs }),
    )?;
    write_outputs(outputs, &case.inputs())?;
    if !common.quiet {
        print(&format!("{}: {outcome}.\n", case.joint.name));
        for sentence in sentences {
            print(&format!("{sentence}\n"));
        }
    }
    Ok(NO)
}
