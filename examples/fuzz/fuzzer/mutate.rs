//! Changes of a text: of its parts, as a person or a program could get them wrong, and of its bytes.

use std::ops::Range;

use rand_chacha::rand_core::RngCore;
use rand_chacha::ChaCha8Rng;

use super::corpus::{Corpus, Seed};
use super::tokens::{Node, Part};

/// Numbers at the ends of what numbers can be, and what only looks like one.
const EXTREMES: [&str; 44] = [
    "0",
    "-0.0",
    "1",
    "-1",
    "2",
    "3",
    "0.5",
    "1e-3",
    "1e3",
    "1e-9",
    "1e9",
    "1e15",
    "1e-15",
    "1e-160",
    "1e160",
    "1e-300",
    "1e300",
    "1.7976931348623157e308",
    "-1.7976931348623157e308",
    "5e-324",
    "2.2250738585072014e-308",
    "1e309",
    "-1e309",
    "1e-400",
    "9007199254740993",
    "4294967295",
    "4294967296",
    "18446744073709551615",
    "18446744073709551616",
    "-9223372036854775809",
    "1.0",
    "0.1",
    "NaN",
    "Infinity",
    "-inf",
    "null",
    "true",
    "\"1\"",
    "\"NaN\"",
    "[]",
    "{}",
    "[0]",
    "01",
    "1e",
];

/// Strings that are easily forgotten.
const TEXTS: [&str; 10] = [
    "\"\"",
    "\" \"",
    "\"\\u0000\"",
    "\"\\ud800\"",
    "\"a\\nb\"",
    "\"../../x\"",
    "\"\u{202e}\u{e9}\"",
    "\"%s{}\\\\\"",
    "7",
    "null",
];

/// Random choices.
pub struct Dice(pub ChaCha8Rng);

impl Dice {
    /// A number below `count`, which is at least 1.
    pub fn below(&mut self, count: usize) -> usize {
        // The bias of the remainder is of no account.
        (self.0.next_u64() % count as u64) as usize
    }

    fn one<'a, T>(&mut self, of: &'a [T]) -> &'a T {
        &of[self.below(of.len())]
    }
}

/// A seed's text, changed. `small`: only numbers, by little, so that most files are read and have to be decided.
pub fn mutated(seed: &Seed, corpus: &Corpus, small: bool, dice: &mut Dice) -> Vec<u8> {
    if seed.nodes.is_empty() || (!small && dice.below(5) == 0) {
        return bytes(&seed.bytes, corpus, dice);
    }
    let mut edits: Vec<(Range<usize>, Vec<u8>)> = Vec::new();
    for _ in 0..[1, 1, 1, 2, 3][dice.below(5)] {
        let node = match small {
            true => &seed.nodes[*dice.one(&seed.numbers)],
            false => dice.one(&seed.nodes),
        };
        let (span, with) = match small {
            true => (
                node.span.clone(),
                little(&seed.text[node.span.clone()], seed, dice),
            ),
            false => part(node, seed, corpus, dice),
        };
        if edits
            .iter()
            .all(|(other, _)| other.end <= span.start || span.end <= other.start)
        {
            edits.push((span, with));
        }
    }
    edits.sort_by_key(|(span, _)| (span.start, span.end));
    let text = seed.text.as_bytes();
    let mut out = Vec::with_capacity(text.len() + 64);
    let mut at = 0;
    for (span, with) in edits {
        out.extend_from_slice(&text[at..span.start]);
        out.extend_from_slice(&with);
        at = span.end;
    }
    out.extend_from_slice(&text[at..]);
    out
}

/// A change of one part: what it replaces, and with what.
fn part(node: &Node, seed: &Seed, corpus: &Corpus, dice: &mut Dice) -> (Range<usize>, Vec<u8>) {
    let text = |span: &Range<usize>| seed.text[span.clone()].to_string();
    let span = node.span.clone();
    let separator = if node.part == Part::Line { "" } else { "," };
    let with = match (dice.below(12), node.part) {
        // Members and elements: away, twice, often, in the other's place.
        (0 | 1, _) if node.inside => return (node.removed.clone(), Vec::new()),
        (2, _) if node.inside => {
            let whole = text(&node.whole);
            return (
                node.whole.clone(),
                format!("{whole}{separator}{whole}").into(),
            );
        }
        (3, _) if node.inside => {
            let again = format!("{}{separator}", text(&node.whole)).repeat(1 + dice.below(40));
            return (node.whole.start..node.whole.start, again.into());
        }
        (4, _) => match &node.key {
            Some(key) => return (key.clone(), dice.one(&corpus.keys).clone().into()),
            None => other(corpus, dice),
        },
        (5 | 6, _) => other(corpus, dice),
        (7, _) => format!("[{}]", text(&span)),
        (8, Part::List | Part::Object) => "[]".to_string(),
        (8, _) => "[".repeat(1 + dice.below(200)),
        (_, Part::Number) => match dice.below(3) {
            0 => return (span.clone(), little(&seed.text[span], seed, dice)),
            _ => dice.one(&EXTREMES).to_string(),
        },
        (_, Part::Text) => match dice.below(3) {
            0 => dice.one(&corpus.keys).clone(),
            1 => format!("\"{}\"", "x".repeat(1 + dice.below(300))),
            _ => dice.one(&TEXTS).to_string(),
        },
        (_, Part::Literal) => dice.one(&EXTREMES).to_string(),
        (_, Part::Line) => text(&seed.nodes[dice.below(seed.nodes.len())].span),
        (_, Part::List | Part::Object) => text(&seed.nodes[dice.below(seed.nodes.len())].span),
    };
    (span, with.into_bytes())
}

/// A part of any file.
fn other(corpus: &Corpus, dice: &mut Dice) -> String {
    let seed = dice.one(&corpus.seeds);
    match seed.nodes.is_empty() {
        true => String::new(),
        false => seed.text[dice.one(&seed.nodes).span.clone()].to_string(),
    }
}

/// A number changed by little, or a number of the same file.
fn little(text: &str, seed: &Seed, dice: &mut Dice) -> Vec<u8> {
    let Ok(value) = text.parse::<f64>() else {
        return dice.one(&EXTREMES).as_bytes().to_vec();
    };
    let power = 2f64.powi(-(dice.below(53) as i32));
    // The bits next to a number's are those of the next number.
    let changed = match dice.below(10) {
        0 => f64::from_bits(value.to_bits().wrapping_add(1)),
        1 => f64::from_bits(value.to_bits().wrapping_sub(1)),
        2 => -value,
        3 => 0.0,
        4 => value * (1.0 + power),
        5 => value * (1.0 - power),
        6 => value + power,
        7 => value - power,
        8 => value * 2f64.powi(dice.below(21) as i32 - 10),
        _ => {
            let node = &seed.nodes[*dice.one(&seed.numbers)];
            return seed.text[node.span.clone()].as_bytes().to_vec();
        }
    };
    if !changed.is_finite() {
        return b"1e999".to_vec();
    }
    // Whole numbers stay whole numbers, as counts are written.
    match text.contains(['.', 'e', 'E']) || changed.fract() != 0.0 {
        true => format!("{changed:e}").into_bytes(),
        false => format!("{changed}").into_bytes(),
    }
}

/// Changes of bytes, whatever they mean.
fn bytes(text: &[u8], corpus: &Corpus, dice: &mut Dice) -> Vec<u8> {
    let mut out = text.to_vec();
    for _ in 0..1 + dice.below(3) {
        let at = dice.below(out.len() + 1);
        let end = (at + dice.below(20)).min(out.len());
        match dice.below(6) {
            0 if at < out.len() => out[at] ^= 1 << dice.below(8),
            1 => out.insert(at, dice.below(256) as u8),
            2 => drop(out.drain(at..end)),
            3 => out.truncate(at),
            4 => {
                let again = out[at..end].to_vec();
                drop(out.splice(at..at, again));
            }
            _ => {
                let word = dice.one(&corpus.keys).clone();
                drop(out.splice(at..at, word.into_bytes()));
            }
        }
    }
    out
}
