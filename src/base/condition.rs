//! A paper's own conditions on the parameters of its controller, evaluated with a file's numbers.
//!
//! These conditions are what a paper's proof uses. A file whose controller misses some of them is
//! still valid, and its runs may meet every requirement: the conditions are sufficient, not necessary.

use serde::Serialize;

/// Where a condition comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Origin {
    /// The paper, as printed.
    Paper,
    /// The paper, with a misprint corrected; the note says which.
    PaperCorrected,
    /// Not in the paper: found necessary in runs.
    Found,
}

/// How the two sides of a condition must compare.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub enum Relation {
    /// Left above right.
    #[serde(rename = ">")]
    Above,
    /// Left not below right.
    #[serde(rename = ">=")]
    AtLeast,
}

impl Relation {
    /// Its sign.
    pub fn sign(self) -> &'static str {
        match self {
            Relation::Above => ">",
            Relation::AtLeast => ">=",
        }
    }

    fn holds(self, left: f64, right: f64) -> bool {
        match self {
            Relation::Above => left > right,
            Relation::AtLeast => left >= right,
        }
    }
}

/// A condition with both of its sides.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Condition {
    /// What it is about.
    pub name: &'static str,
    /// The inequality in the paper's symbols.
    pub statement: &'static str,
    /// Where it stands in the paper.
    pub place: &'static str,
    /// Where it comes from.
    pub origin: Origin,
    /// Value of the left side; `None` when it is not defined for these parameters.
    pub left: Option<f64>,
    /// How the sides must compare.
    pub relation: Relation,
    /// Value of the right side; `None` when it is not defined for these parameters.
    pub right: Option<f64>,
    /// Whether it holds. A condition with a side that is not defined does not.
    pub holds: bool,
    /// What else is to be said; may be empty.
    pub note: String,
}

impl Condition {
    /// The condition with both sides evaluated.
    pub fn new(
        (name, statement): (&'static str, &'static str),
        (place, origin): (&'static str, Origin),
        (left, relation, right): (f64, Relation, f64),
        note: String,
    ) -> Self {
        let defined = |value: f64| Some(value).filter(|value| value.is_finite());
        let (left, right) = (defined(left), defined(right));
        let sides = left.zip(right);
        Condition {
            name,
            statement,
            place,
            origin,
            left,
            relation,
            right,
            holds: sides.is_some_and(|(left, right)| relation.holds(left, right)),
            note,
        }
    }
}
