//! The smallest gamma from both solvers.

use synth::synthesis::CrossCheck;

/// In words.
pub fn lines(check: &CrossCheck) -> Vec<String> {
    let found = check.found.iter().map(|found| {
        let gamma = found.gamma;
        let gamma = gamma.map_or("none".to_string(), |gamma| format!("{gamma:.9}"));
        format!(
            "cross-check: {}: smallest gamma {gamma}, {} in {:.2} s",
            found.solver, found.status, found.seconds
        )
    });
    let difference = match check.relative_difference {
        Some(difference) => format!("cross-check: relative difference {difference:.1e}"),
        None => "cross-check: one of the solvers found no gamma".to_string(),
    };
    found.chain([difference]).collect()
}
