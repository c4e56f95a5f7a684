//! What a study states of its numbers beside what the logs make of them.

use super::number::{quantity, significant, spoken};
use super::text::{cell, finish, number, table};
use crate::identify::BeliefFound;
use comfy_table::Cell;
use std::collections::BTreeMap;

/// A table of what is believed of each number and of what was found, with its 95 % interval where there is one.
pub(super) fn belief_table(
    width: usize,
    beliefs: &[BeliefFound],
    interval: impl Fn(&BeliefFound) -> Option<[f64; 2]>,
) -> String {
    let mut table = table(width, &["number", "believed", "with these logs [95 %]"], &["moved\n[sd]"]);
    for belief in beliefs {
        table.add_row([
            Cell::new(&belief.name),
            cell(believed(belief)),
            cell(quantity(belief.found, interval(belief), &belief.unit)),
            number(moved(belief)),
        ]);
    }
    finish(&mut table)
}

/// `0.0050 ± 0.00025 kg m`
pub(super) fn believed(belief: &BeliefFound) -> String {
    let (value, sd) = (significant(belief.believed, 3), significant(belief.sd, 2));
    format!("{value} ± {sd} {}", spoken(&belief.unit)).trim_end().to_owned()
}

/// By how many standard deviations, with its sign.
pub(super) fn moved(belief: &BeliefFound) -> String {
    let moved = format!("{:+.1}", belief.moved_sd);
    if matches!(&*moved, "+0.0" | "-0.0") { "0.0".to_owned() } else { moved }
}

/// Beliefs under the names of their numbers.
pub(super) fn by_number(beliefs: &[BeliefFound]) -> BTreeMap<&str, &BeliefFound> {
    beliefs.iter().map(|belief| (belief.name.as_str(), belief)).collect()
}
