//! The kinds of files, and how a text shows which one it is.

use std::collections::BTreeMap;
use std::fmt;

use serde::de::{Deserialize, Deserializer, IgnoredAny, MapAccess, SeqAccess, Visitor};

/// The kinds of files.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A model file.
    Model,
    /// A model file with `requirements`: what is not given is found.
    Facts,
    /// A design file.
    Design,
    /// A scenario file.
    Scenario,
    /// An infeasibility certificate.
    Infeasibility,
    /// A problem file: a model file with a `problem` in place of `specs`.
    Problem,
    /// The design file of a problem.
    ProblemDesign,
    /// The design file of a law with a trigger on the command.
    HeldCommandDesign,
    /// A gains file.
    Gains,
    /// A requirements file of the parameter search.
    Requirements,
    /// The summary of a run.
    Summary,
}

impl Kind {
    /// Its name with the article, such as `an infeasibility`.
    pub fn with_article(self) -> String {
        let article = match self {
            Kind::Infeasibility => "an",
            _ => "a",
        };
        format!("{article} {self}")
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Kind::Model => "model",
            Kind::Facts => "facts",
            Kind::Design => "design",
            Kind::Scenario => "scenario",
            Kind::Infeasibility => "infeasibility",
            Kind::Problem => "problem",
            Kind::ProblemDesign => "problem design",
            Kind::HeldCommandDesign => "held-command design",
            Kind::Gains => "gains",
            Kind::Requirements => "requirements",
            Kind::Summary => "summary",
        })
    }
}

/// The kind of a file, from keys that only this kind has; `None` when it is none of them, or not JSON.
pub fn kind_of(text: &str) -> Option<Kind> {
    let keys: BTreeMap<String, Outline> = serde_json::from_str(text).ok()?;
    let has = |key: &str| keys.contains_key(key);
    if ["scenario", "verdict", "scales"].iter().all(|key| has(key)) {
        // A summary has a certificate, too.
        Some(Kind::Summary)
    } else if has("infeasibility") {
        Some(Kind::Infeasibility)
    } else if has("certificate") {
        match keys.get("model") {
            Some(Outline::Object { problem: true, .. }) => Some(Kind::ProblemDesign),
            _ if matches!(
                keys.get("controller"),
                Some(Outline::Object { trigger: true, .. })
            ) =>
            {
                Some(Kind::HeldCommandDesign)
            }
            _ => Some(Kind::Design),
        }
    } else if has("duration_s") {
        Some(Kind::Scenario)
    } else if has("problem") && !(has("specs") && is_empty(&keys["problem"])) {
        Some(Kind::Problem)
    } else if has("manoeuvre") {
        Some(Kind::Requirements)
    } else if has("specs") && has("requirements") {
        Some(Kind::Facts)
    } else if has("specs") {
        Some(Kind::Model)
    } else if matches!(keys.get("gains"), Some(Outline::List)) {
        Some(Kind::Gains)
    } else {
        None
    }
}

/// Whether a value holds nothing under names.
fn is_empty(value: &Outline) -> bool {
    !matches!(value, Outline::Object { empty: false, .. })
}

/// What a file's kind depends on of a value; the rest is read over, and never held.
enum Outline {
    /// An object, with whether it has a `problem` and a `trigger`, and whether it has nothing.
    Object {
        problem: bool,
        trigger: bool,
        empty: bool,
    },
    List,
    Other,
}

impl<'de> Deserialize<'de> for Outline {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(OutlineVisitor)
    }
}

struct OutlineVisitor;

impl<'de> Visitor<'de> for OutlineVisitor {
    type Value = Outline;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("any value")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Outline, A::Error> {
        let (mut problem, mut trigger, mut empty) = (false, false, true);
        while let Some((key, _)) = map.next_entry::<String, IgnoredAny>()? {
            problem |= key == "problem";
            trigger |= key == "trigger";
            empty = false;
        }
        Ok(Outline::Object {
            problem,
            trigger,
            empty,
        })
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Outline, A::Error> {
        while list.next_element::<IgnoredAny>()?.is_some() {}
        Ok(Outline::List)
    }

    fn visit_bool<E>(self, _: bool) -> Result<Outline, E> {
        Ok(Outline::Other)
    }

    fn visit_i64<E>(self, _: i64) -> Result<Outline, E> {
        Ok(Outline::Other)
    }

    fn visit_u64<E>(self, _: u64) -> Result<Outline, E> {
        Ok(Outline::Other)
    }

    fn visit_f64<E>(self, _: f64) -> Result<Outline, E> {
        Ok(Outline::Other)
    }

    fn visit_str<E>(self, _: &str) -> Result<Outline, E> {
        Ok(Outline::Other)
    }

    fn visit_unit<E>(self) -> Result<Outline, E> {
        Ok(Outline::Other)
    }
}
