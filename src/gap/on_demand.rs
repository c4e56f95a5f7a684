//! What of the causes was looked for on demand, as the first sentence of an answer says it.

/// So many causes are named; of more the number is told.
const NAMED: usize = 3;

/// An answer's sentence, which begins with a name and a colon, with what was all that was looked for, or was not, behind the
/// name. What a search that was ended by its time says first stays first.
pub(super) fn told_in(sentence: &str, name: &str, without: &[&str], only: &[&str]) -> String {
    let Some(asked) = words(without, only) else { return sentence.to_owned() };
    let (plain, told) = (format!("{name}: "), format!("{name} ({asked}): "));
    if let Some(rest) = sentence.strip_prefix(plain.as_str()) {
        return format!("{told}{rest}");
    }
    match sentence.split_once(format!("So far: {plain}").as_str()) {
        Some((ended, rest)) => format!("{ended}So far: {told}{rest}"),
        None => sentence.to_owned(),
    }
}

/// `only delay was looked for`; `None` where everything was.
fn words(without: &[&str], only: &[&str]) -> Option<String> {
    // Who names what alone is looked for has withheld the rest.
    if !only.is_empty() {
        return Some(format!("only {} looked for", those(only)));
    }
    (!without.is_empty()).then(|| format!("{} not looked for", those(without)))
}

/// Causes and their verb: `delay was`, `delay and backlash were`, `7 causes were`.
fn those(ids: &[&str]) -> String {
    match ids {
        [one] => format!("{one} was"),
        [others @ .., last] if ids.len() <= NAMED => format!("{} and {last} were", others.join(", ")),
        many => format!("{} causes were", many.len()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_sentence_says_what_alone_was_looked_for() {
        let told =
            |without: &[&str], only: &[&str]| told_in("arm/elbow: nothing is missing.", "arm/elbow", without, only);
        assert_eq!(told(&[], &[]), "arm/elbow: nothing is missing.");
        assert_eq!(told(&["delay"], &[]), "arm/elbow (delay was not looked for): nothing is missing.");
        assert_eq!(told(&["stribeck"], &["delay"]), "arm/elbow (only delay was looked for): nothing is missing.");
        assert!(
            told(&[], &["delay", "dead_band", "payload"])
                .contains("(only delay, dead_band and payload were looked for)")
        );
        assert!(told(&["a", "b", "c", "d"], &[]).contains("(4 causes were not looked for)"));
    }

    #[test]
    fn what_the_time_ended_is_still_said_first() {
        let ended = "The search was ended by its time of 1.0 s and is not finished. So far: r: nothing is missing.";
        let told = told_in(ended, "r", &[], &["delay"]);
        assert!(told.starts_with("The search was ended"), "{told}");
        assert!(told.ends_with("So far: r (only delay was looked for): nothing is missing."), "{told}");
    }
}
