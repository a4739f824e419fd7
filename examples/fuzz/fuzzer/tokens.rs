//! Where the parts of a text stand: of JSON its values and members, of other text its words and lines.

use std::ops::Range;

/// What a part is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Part {
    /// A number.
    Number,
    /// A string of JSON with its quotes, or another word.
    Text,
    /// `true`, `false` or `null`.
    Literal,
    /// An object.
    Object,
    /// A list.
    List,
    /// A line of a text that is not JSON.
    Line,
}

/// A part of a text.
#[derive(Debug, Clone)]
pub struct Node {
    /// What it is.
    pub part: Part,
    /// Its bytes.
    pub span: Range<usize>,
    /// Its key with its quotes, where it is the value of a member.
    pub key: Option<Range<usize>>,
    /// The whole member, or the part itself.
    pub whole: Range<usize>,
    /// The whole with one neighbouring comma: what is left without it is valid.
    pub removed: Range<usize>,
    /// Whether it stands in a list or in an object.
    pub inside: bool,
}

/// The parts of a JSON text, which must be valid.
pub fn json(text: &str) -> Vec<Node> {
    let mut parser = Parser {
        bytes: text.as_bytes(),
        at: 0,
        nodes: Vec::new(),
    };
    parser.value(None);
    parser.nodes
}

/// The words and the lines of any other text.
pub fn words(text: &str) -> Vec<Node> {
    let mut nodes = Vec::new();
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        let span = start..start + line.len();
        nodes.push(plain(Part::Line, span.clone()));
        let mut word = None;
        for (offset, c) in line.char_indices().chain([(line.len(), ' ')]) {
            let separates = c.is_whitespace() || ",(){}".contains(c);
            match (word, separates) {
                (None, false) => word = Some(offset),
                (Some(begin), true) => {
                    let number = line[begin..offset].parse::<f64>().is_ok();
                    let part = if number { Part::Number } else { Part::Text };
                    nodes.push(plain(part, start + begin..start + offset));
                    word = None;
                }
                _ => {}
            }
        }
        start = span.end;
    }
    nodes
}

fn plain(part: Part, span: Range<usize>) -> Node {
    Node {
        part,
        key: None,
        whole: span.clone(),
        removed: span.clone(),
        inside: part == Part::Line,
        span,
    }
}

struct Parser<'a> {
    bytes: &'a [u8],
    at: usize,
    nodes: Vec<Node>,
}

impl Parser<'_> {
    fn peek(&self) -> u8 {
        self.bytes.get(self.at).copied().unwrap_or(0)
    }

    fn blanks(&mut self) {
        while self.peek().is_ascii_whitespace() {
            self.at += 1;
        }
    }

    fn string(&mut self) -> Range<usize> {
        let start = self.at;
        self.at += 1;
        while self.at < self.bytes.len() && self.peek() != b'"' {
            self.at += if self.peek() == b'\\' { 2 } else { 1 };
        }
        self.at += 1;
        start..self.at
    }

    /// A value; the index of its node.
    fn value(&mut self, key: Option<Range<usize>>) -> usize {
        self.blanks();
        let start = self.at;
        let index = self.nodes.len();
        self.nodes.push(plain(Part::Literal, start..start));
        let part = match self.peek() {
            b'{' | b'[' => self.container(),
            b'"' => {
                self.string();
                Part::Text
            }
            first => {
                while !matches!(self.peek(), b',' | b'}' | b']' | 0)
                    && !self.peek().is_ascii_whitespace()
                {
                    self.at += 1;
                }
                match first.is_ascii_alphabetic() {
                    true => Part::Literal,
                    false => Part::Number,
                }
            }
        };
        let span = start..self.at;
        let whole = key.as_ref().map_or(start, |key| key.start)..self.at;
        self.nodes[index] = Node {
            part,
            span,
            key,
            removed: whole.clone(),
            whole,
            inside: false,
        };
        index
    }

    fn container(&mut self) -> Part {
        let object = self.peek() == b'{';
        self.at += 1;
        let mut children: Vec<usize> = Vec::new();
        loop {
            self.blanks();
            match self.peek() {
                b'}' | b']' | 0 => break,
                b',' => self.at += 1,
                _ => {
                    let key = object.then(|| {
                        let key = self.string();
                        self.blanks();
                        self.at += 1;
                        key
                    });
                    children.push(self.value(key));
                }
            }
        }
        self.at += 1;
        for (place, &child) in children.iter().enumerate() {
            let whole = self.nodes[child].whole.clone();
            let next = children
                .get(place + 1)
                .map(|&next| self.nodes[next].whole.start);
            let before = place
                .checked_sub(1)
                .map(|before| self.nodes[children[before]].whole.end);
            let node = &mut self.nodes[child];
            node.inside = true;
            node.removed = match (next, before) {
                (Some(next), _) => whole.start..next,
                (None, Some(before)) => before..whole.end,
                (None, None) => whole,
            };
        }
        match object {
            true => Part::Object,
            false => Part::List,
        }
    }
}
