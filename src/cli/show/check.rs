//! A file that is valid.

use std::path::Path;

use serde::Serialize;
use serde_json::Value;
use synth::model::Kind;

use crate::base::condition::Condition;
use crate::controllers::DesignCheck;

/// What a file is.
#[derive(Debug, Serialize)]
pub struct CheckReport<'a> {
    /// Always true.
    valid: bool,
    /// Kind of file.
    kind: String,
    /// What it holds, in short.
    summary: String,
    /// The conditions of a paper on the parameters of its controller; left out where there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    design_check: Option<PaperConditions<'a>>,
}

/// The conditions of a paper.
#[derive(Debug, Serialize)]
struct PaperConditions<'a> {
    /// The paper in short.
    paper: &'a str,
    /// Its conditions.
    conditions: &'a [Condition],
    /// The constants that they are made of.
    constants: &'a Value,
}

impl<'a> CheckReport<'a> {
    /// Of a valid file.
    pub fn new(kind: Kind, summary: String, check: Option<&'a DesignCheck>) -> Self {
        CheckReport {
            valid: true,
            kind: kind.to_string(),
            summary,
            design_check: check.map(|check| PaperConditions {
                paper: check.paper,
                conditions: &check.conditions,
                constants: &check.constants,
            }),
        }
    }

    /// In words.
    pub fn lines(&self, path: &Path) -> Vec<String> {
        let (kind, summary) = (&self.kind, &self.summary);
        let title = format!("{}: valid {kind} file: {summary}", path.display());
        let check = self.design_check.as_ref();
        let check = check.map_or(Vec::new(), PaperConditions::lines);
        [title].into_iter().chain(check).collect()
    }
}

impl PaperConditions<'_> {
    /// The conditions in words, those that fail marked.
    fn lines(&self) -> Vec<String> {
        let held = self.conditions.iter().filter(|one| one.holds).count();
        let mut lines = vec![format!(
        "{held} of {} conditions of {} hold (sufficient for its proof; a run may meet its requirements without them):",
        self.conditions.len(),
        self.paper
    )];
        for condition in self.conditions {
            let verdict = if condition.holds { "holds" } else { "FAILS" };
            let side =
                |value: Option<f64>| value.map_or("undefined".to_string(), |v| format!("{v:.4e}"));
            lines.push(format!(
                "  {verdict}  {}: {}; {} {} {}  [{}]",
                condition.name,
                condition.statement,
                side(condition.left),
                condition.relation.sign(),
                side(condition.right),
                condition.place
            ));
            if !condition.note.is_empty() {
                lines.push(format!("         {}", condition.note));
            }
        }
        lines
    }
}
