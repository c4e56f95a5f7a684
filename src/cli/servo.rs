//! Position servos by the command line: `--servo KP[,KD]`.

use super::CliError;

/// Numbers between commas.
pub(super) fn numbers(option: &str, text: &str) -> Result<Vec<f64>, CliError> {
    let number = |word: &str| {
        let value = word.trim().parse().ok().filter(|value: &f64| value.is_finite());
        value.ok_or_else(|| CliError::Usage(format!("{option}: `{word}` is no number")))
    };
    text.split(',').map(number).collect()
}

/// Gain and, where it is said, damping \[N m/rad, N m s/rad\].
pub(super) fn servo(text: &str) -> Result<(f64, Option<f64>), CliError> {
    let numbers = numbers("--servo", text)?;
    if let Some(below) = numbers.iter().find(|number| **number < 0.0) {
        return Err(CliError::Usage(format!("--servo {text}: {below}, expected numbers not below 0")));
    }
    match numbers[..] {
        [kp_nm_rad] => Ok((kp_nm_rad, None)),
        [kp_nm_rad, kd_nm_s_rad] => Ok((kp_nm_rad, Some(kd_nm_s_rad))),
        _ => Err(CliError::Usage(format!("--servo {text}: {} values, expected KP or KP,KD", numbers.len()))),
    }
}
