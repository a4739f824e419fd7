//! Why points failed, in groups: sentences that differ in their numbers only are one reason.

use std::collections::HashMap;

use crate::batch::sweep::outcome::PointOutcome;

/// A reason and the points that have it.
#[derive(Debug, Clone, PartialEq)]
pub struct Reason {
    /// A letter for the maps.
    pub letter: String,
    /// The verdict of its points.
    pub verdict: String,
    /// The sentence of its first point.
    pub example: String,
    /// Numbers of its points.
    pub points: Vec<usize>,
}

/// The reasons in the order in which they first occur.
pub fn reasons(outcomes: &[PointOutcome]) -> Vec<Reason> {
    let mut found: Vec<Reason> = Vec::new();
    let mut places: HashMap<(&str, String), usize> = HashMap::new();
    for (index, outcome) in outcomes.iter().enumerate().filter(|(_, o)| !o.good()) {
        let sentence = outcome.reason.as_deref().unwrap_or_default();
        let key = (outcome.verdict.as_str(), pattern(sentence));
        let place = *places.entry(key).or_insert(found.len());
        match found.get_mut(place) {
            Some(reason) => reason.points.push(index),
            None => found.push(Reason {
                letter: letter(found.len()),
                verdict: outcome.verdict.clone(),
                example: sentence.to_string(),
                points: vec![index],
            }),
        }
    }
    found
}

/// A to Z, then AA and so on.
fn letter(index: usize) -> String {
    let last = char::from(b'A' + (index % 26) as u8);
    match index / 26 {
        0 => last.to_string(),
        rest => letter(rest - 1) + &last.to_string(),
    }
}

/// The sentence with `#` for its numbers.
fn pattern(sentence: &str) -> String {
    let number = |word: &str| {
        let bare = word.trim_matches(|c: char| ":;,()[]".contains(c));
        !bare.is_empty() && bare.parse::<f64>().is_ok()
    };
    let words = sentence.split(' ').map(|word| match number(word) {
        true => "#".to_string(),
        false => without_indices(word),
    });
    words.collect::<Vec<_>>().join(" ")
}

/// `vertex[12]` as `vertex[#]`.
fn without_indices(word: &str) -> String {
    let mut out = String::new();
    for c in word.chars() {
        match (c.is_ascii_digit(), out.ends_with('#')) {
            (true, true) => {}
            (true, false) => out.push('#'),
            (false, _) => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(verdict: &str, reason: &str) -> PointOutcome {
        PointOutcome {
            values: vec![0.0],
            ..PointOutcome::without_numbers(verdict, reason)
        }
    }

    #[test]
    fn sentences_that_differ_in_numbers_only_are_one_reason() {
        let outcomes = [
            point("requirements_missed", "triggers at most 25: 27"),
            point("requirements_missed", "triggers at most 25: 31.5e-3"),
            point("requirements_missed", "impulse at most 25: 31"),
            point("diverged", "triggers at most 25: 27"),
        ];
        let found = reasons(&outcomes);
        let points: Vec<_> = found.iter().map(|reason| reason.points.clone()).collect();
        assert_eq!(points, [vec![0, 1], vec![2], vec![3]]);
        assert_eq!(found[2].letter, "C");
        assert_eq!(found[0].example, "triggers at most 25: 27");
    }

    #[test]
    fn letters_go_on_after_z() {
        assert_eq!(
            [0, 25, 26, 27, 52].map(letter),
            ["A", "Z", "AA", "AB", "BA"]
        );
    }
}
