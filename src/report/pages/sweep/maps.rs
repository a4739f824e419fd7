//! Maps over two axes: where the answer is yes, why it is no elsewhere, and how large a metric is.

use plotters::style::RGBColor;

use super::figures::{shown, Labels};
use super::reasons::Reason;
use crate::base::number::label;
use crate::batch::sweep::outcome::PointOutcome;
use crate::batch::sweep::subject::Subject;
use crate::batch::variation::grid::Grid;
use crate::report::chart::hexadecimal;
use crate::report::plot::{Cell, Map};

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

/// Two axes of a grid and a choice of the others.
pub struct Slice {
    axes: [usize; 2],
    first: Vec<usize>,
    /// The values of the other axes as text; empty where there are none.
    pub others: String,
}

/// The slices through the two axes with the most values, and how many there would be.
pub fn slices(grid: &Grid, labels: &Labels) -> (Vec<Slice>, usize) {
    let sizes: Vec<usize> = grid.axes().map(|(_, values)| values.len()).collect();
    let mut order: Vec<usize> = (0..sizes.len()).filter(|&axis| sizes[axis] > 1).collect();
    order.sort_by_key(|&axis| (std::cmp::Reverse(sizes[axis]), axis));
    let &[a, b, ..] = order.as_slice() else {
        return (Vec::new(), 0);
    };
    let axes = [a.min(b), a.max(b)];
    let others: Vec<usize> = (0..sizes.len())
        .filter(|axis| !axes.contains(axis))
        .collect();
    let total: usize = others.iter().map(|&axis| sizes[axis]).product();
    let slice = |choice: usize| {
        let mut rest = choice;
        let mut first = vec![0; sizes.len()];
        for &axis in others.iter().rev() {
            first[axis] = rest % sizes[axis];
            rest /= sizes[axis];
        }
        let named = others.iter().map(|&axis| {
            let value = grid.axes().nth(axis).map(|(_, values)| values[first[axis]]);
            format!("{} {}", labels.axes[axis], label(value.unwrap_or(f64::NAN)))
        });
        Slice {
            axes,
            others: named.collect::<Vec<_>>().join(", "),
            first,
        }
    };
    ((0..total.min(CHOICES)).map(slice).collect(), total)
}

impl Slice {
    fn map(&self, title: &str, grid: &Grid, labels: &Labels, cell: impl Fn(usize) -> Cell) -> Map {
        let values: Vec<&[f64]> = grid.axes().map(|(_, values)| values).collect();
        let [across, up] = self.axes.map(|axis| Order::of(values[axis]));
        let number = |place: &[usize]| {
            let sizes = values.iter().map(|values| values.len());
            sizes
                .zip(place)
                .fold(0, |number, (size, &index)| number * size + index)
        };
        let mut cells = Vec::new();
        for &row in &up.0 {
            for &column in &across.0 {
                let mut place = self.first.clone();
                place[self.axes[0]] = column;
                place[self.axes[1]] = row;
                cells.push(cell(number(&place)));
            }
        }
        let axis = |axis: usize, order: &Order| {
            let sorted = order.0.iter().map(|&index| values[axis][index]);
            (labels.axes[axis].clone(), sorted.collect())
        };
        let title = match self.others.as_str() {
            "" => title.to_string(),
            others => format!("{title}, {others}"),
        };
        Map {
            title,
            horizontal: axis(self.axes[0], &across),
            vertical: axis(self.axes[1], &up),
            cells,
        }
    }

    /// Where the answer is yes, and a letter for the reason where it is no.
    pub fn answers(
        &self,
        grid: &Grid,
        labels: &Labels,
        outcomes: &[PointOutcome],
        reasons: &[Reason],
    ) -> Map {
        let mut letters = vec![""; outcomes.len()];
        for reason in reasons {
            for &point in &reason.points {
                letters[point] = &reason.letter;
            }
        }
        self.map("Feasibility", grid, labels, |point| Cell {
            colour: verdict_colour(&outcomes[point].verdict),
            mark: letters[point].to_string(),
        })
    }

    /// How large a metric is.
    pub fn shades(
        &self,
        grid: &Grid,
        labels: &Labels,
        (subject, outcomes): (&Subject, &[PointOutcome]),
        metric: &str,
        title: &str,
    ) -> Map {
        let range = Range::of(subject, outcomes, metric);
        self.map(title, grid, labels, |point| {
            let value = shown(subject, &outcomes[point], metric);
            let shade = value
                .zip(range.as_ref())
                .map(|(value, range)| range.shade(value));
            Cell {
                colour: shade.unwrap_or(EMPTY),
                mark: if shade.is_some() { "" } else { "x" }.to_string(),
            }
        })
    }
}

/// Indices of values in rising order.
struct Order(Vec<usize>);

impl Order {
    fn of(values: &[f64]) -> Self {
        let mut order: Vec<usize> = (0..values.len()).collect();
        order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
        Order(order)
    }
}

/// Range of a metric over the whole sweep.
pub struct Range {
    /// Smallest value.
    pub low: f64,
    /// Largest value.
    pub high: f64,
}

impl Range {
    /// Of a metric, where any point has it.
    pub fn of(subject: &Subject, outcomes: &[PointOutcome], metric: &str) -> Option<Self> {
        let values = outcomes
            .iter()
            .filter_map(|outcome| shown(subject, outcome, metric));
        values.fold(None, |range: Option<Range>, value| {
            let Range { low, high } = range.unwrap_or(Range {
                low: value,
                high: value,
            });
            Some(Range {
                low: low.min(value),
                high: high.max(value),
            })
        })
    }

    /// Whether the shades are at equal ratios.
    pub fn logarithmic(&self) -> bool {
        self.low > 0.0 && self.high / self.low > 30.0
    }

    fn shade(&self, value: f64) -> RGBColor {
        let fraction = match (self.logarithmic(), self.high > self.low) {
            (_, false) => 0.5,
            (true, _) => (value / self.low).ln() / (self.high / self.low).ln(),
            (false, _) => (value - self.low) / (self.high - self.low),
        };
        let place = fraction.clamp(0.0, 1.0) * (SHADES.len() - 1) as f64;
        let below = (place.floor() as usize).min(SHADES.len() - 2);
        let (a, b, part) = (SHADES[below], SHADES[below + 1], place - below as f64);
        let mix = |a: u8, b: u8| (f64::from(a) * (1.0 - part) + f64::from(b) * part).round() as u8;
        RGBColor(mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
    }
}

/// The shades as a gradient of CSS.
pub fn gradient() -> String {
    let colours = SHADES.map(hexadecimal);
    format!("linear-gradient(to right, {})", colours.join(", "))
}
