//! Maps over two axes: where the answer is yes, why it is no elsewhere, and how large a metric is.

use std::cmp::Reverse;

use plotters::style::RGBColor;

use super::figures::{claim_text, View};
use super::reasons::Reason;
use crate::base::number::label;
use crate::report::axis::{ends, PlotAxis, Spacing};
use crate::report::chart::{hexadecimal, Cell, Figure};

/// Most choices of the axes beyond two that are drawn.
pub const CHOICES: usize = 4;

/// Colours of the verdicts. Colour alone tells nothing that the letters do not.
const VERDICTS: [(&str, RGBColor); 10] = [
    ("proved", RGBColor(0x22, 0x77, 0x6f)),
    ("requirements_met", RGBColor(0x22, 0x77, 0x6f)),
    ("not_proved", RGBColor(0xb5, 0x8a, 0x1d)),
    ("infeasible", RGBColor(0xa8, 0x32, 0x46)),
    ("undecided", RGBColor(0xc7, 0x6b, 0x54)),
    ("solver_failed", RGBColor(0x6b, 0x6f, 0x76)),
    ("requirements_missed", RGBColor(0xa8, 0x32, 0x46)),
    ("diverged", RGBColor(0x6f, 0x3f, 0x8f)),
    ("proof_broken", RGBColor(0xe0, 0x00, 0x30)),
    ("invalid", RGBColor(0x8a, 0x8d, 0x93)),
];
const OTHER: RGBColor = RGBColor(0x50, 0x50, 0x50);
/// Shades from the smallest to the largest value; readable without colours (after viridis).
const SHADES: [RGBColor; 5] = [
    RGBColor(0x46, 0x1a, 0x6b),
    RGBColor(0x3b, 0x4f, 0x8a),
    RGBColor(0x21, 0x8f, 0x8c),
    RGBColor(0x5b, 0xb8, 0x5f),
    RGBColor(0xe3, 0xd0, 0x3a),
];
/// A cell without a value.
const EMPTY: RGBColor = RGBColor(0x8a, 0x8d, 0x93);

/// The colour of a verdict.
pub fn verdict_colour(verdict: &str) -> RGBColor {
    let found = VERDICTS.iter().find(|(name, _)| *name == verdict);
    found.map_or(OTHER, |(_, colour)| *colour)
}

/// Two axes of a grid, and a point with the first value of both and a choice of the others.
pub struct Slice<'a> {
    view: &'a View<'a>,
    axes: [usize; 2],
    start: usize,
}

/// The slices through the two axes with the most values, and how many there would be.
pub fn slices<'a>(view: &'a View) -> (Vec<Slice<'a>>, usize) {
    let mut order = view.varied();
    order.sort_by_key(|&axis| (Reverse(view.values[axis].len()), axis));
    let &[a, b, ..] = order.as_slice() else {
        return (Vec::new(), 0);
    };
    let axes = [a.min(b), a.max(b)];
    let starts = view.starts(&axes);
    let slices = starts.iter().take(CHOICES);
    let slices = slices.map(|&start| Slice { view, axes, start });
    (slices.collect(), starts.len())
}

impl Slice<'_> {
    /// A cell for each pair of values, given the index of its point.
    fn map(&self, title: &str, cell: impl Fn(usize) -> Cell) -> Figure {
        let view = self.view;
        let [across, up] = self.axes.map(|axis| {
            let stride = view.stride(axis);
            let order = view.order(axis).into_iter();
            order.map(move |index| index * stride).collect::<Vec<_>>()
        });
        let steps = up
            .iter()
            .flat_map(|up| across.iter().map(move |across| up + across));
        let cells = steps.map(|step| cell(self.start + step)).collect();
        let others = view.place(&view.sweep.grid.point(self.start), &self.axes);
        let title = match others.as_str() {
            "" => title.to_string(),
            others => format!("{title}, {others}"),
        };
        Figure {
            title,
            axes: self.axes.map(|axis| {
                let sorted = view.order(axis).into_iter();
                let names = sorted.map(|index| label(view.values[axis][index]));
                PlotAxis::new(&view.labels[axis], Spacing::Cells(names.collect()))
            }),
            cells,
            narrow: true,
            ..Figure::default()
        }
    }

    /// Where the answer is yes, and a letter for the reason where it is no.
    pub fn answers(&self, reasons: &[Reason]) -> Figure {
        let outcomes = self.view.sweep.outcomes;
        let mut letters = vec![""; outcomes.len()];
        for reason in reasons {
            for &point in &reason.points {
                letters[point] = &reason.letter;
            }
        }
        self.map("Feasibility", |point| Cell {
            colour: verdict_colour(&outcomes[point].verdict),
            mark: match outcomes[point].uncovered() {
                true => format!("{}~", letters[point]),
                false => letters[point].to_string(),
            },
        })
    }

    /// How large a metric is, with a key to the shades; `None` where no point has it.
    pub fn shades(&self, metric: &str) -> Option<(Figure, String)> {
        let range = ends(self.view.all(metric))?;
        let map = self.map(&self.view.named(metric), |point| {
            let value = self.view.shown(&self.view.sweep.outcomes[point], metric);
            Cell {
                colour: value.map_or(EMPTY, |value| shade(range, value)),
                mark: if value.is_some() { "" } else { "x" }.to_string(),
            }
        });
        let scale = match logarithmic(range) {
            true => ", at equal ratios",
            false => "",
        };
        let [low, high] = [range.0, range.1].map(|value| claim_text(metric, value));
        let gradient = SHADES.map(hexadecimal).join(", ");
        let key = format!(
            "<p class=\"legend\">{low}<i class=\"shades\" style=\"background: linear-gradient(to right, \
             {gradient})\"></i>{high}{scale}; x: no proved value</p>\n"
        );
        Some((map, key))
    }
}

/// Whether the shades are at equal ratios.
fn logarithmic((low, high): (f64, f64)) -> bool {
    low > 0.0 && high / low > 30.0
}

/// The shade of a value within the range of its metric over the whole sweep.
fn shade((low, high): (f64, f64), value: f64) -> RGBColor {
    let fraction = match (logarithmic((low, high)), high > low) {
        (_, false) => 0.5,
        (true, _) => (value / low).ln() / (high / low).ln(),
        (false, _) => (value - low) / (high - low),
    };
    let place = fraction.clamp(0.0, 1.0) * (SHADES.len() - 1) as f64;
    let below = (place.floor() as usize).min(SHADES.len() - 2);
    let (a, b, part) = (SHADES[below], SHADES[below + 1], place - below as f64);
    let mix = |a: u8, b: u8| (f64::from(a) * (1.0 - part) + f64::from(b) * part).round() as u8;
    RGBColor(mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
}
