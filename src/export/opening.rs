//! What is said of a design or of a scenario's controller at the top of what is exported.

use super::design::DesignData;
use crate::base::provenance::{sha256_of, GENERATOR};
use crate::controllers::law::AttitudeLaw;
use crate::scenario::Scenario;

/// Verdict, law, assumptions and provenance of a design that is exported as something, in lines.
pub fn opening(data: &DesignData, what: &str) -> Vec<String> {
    let mut out = vec![format!("Controller '{}', {what}.", data.name)];
    match data.proved {
        true => out.push(
            "PROVED: every condition was proved from these very numbers when this was written."
                .to_string(),
        ),
        false => {
            out.push(format!(
                "NOT PROVED: nothing is guaranteed for this controller. Conditions that are not \
                 proved ({}): {}.",
                data.failed.len(),
                data.failed.join("; ")
            ));
        }
    }
    out.push(String::new());
    out.extend(data.law.iter().cloned());
    out.push(
        "Matrices are stored row by row; of several, the first index is the rule's.".to_string(),
    );
    out.push(String::new());
    if data.proved {
        out.push("The proof assumes:".to_string());
        out.extend(data.assumptions.iter().map(|text| format!("- {text}")));
        out.push(String::new());
    }
    let provenance = data.provenance.iter();
    out.extend(provenance.map(|(key, text)| format!("{key}: {text}")));
    out
}

/// The same of a scenario's controller, of which nothing is proved; `text` is the scenario's.
pub fn opening_of_scenario(
    scenario: &Scenario,
    law: &dyn AttitudeLaw,
    text: &str,
    what: &str,
) -> Vec<String> {
    let mut out = vec![
        format!("Controller of the scenario '{}', {what}.", scenario.name),
        format!("{}.", law.name()),
        "NOT PROVED: nothing is guaranteed for this controller.".to_string(),
    ];
    if scenario.link.is_some() {
        out.push(
            "The encoder of the scenario's link is not part of it: the command changes at every sample."
                .to_string(),
        );
    }
    out.extend([
        String::new(),
        format!("exported_by: {GENERATOR}"),
        format!("scenario_sha256: {}", sha256_of(text)),
        format!("source: {}", scenario.source),
    ]);
    out
}
