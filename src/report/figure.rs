//! The figures of a report, as SVG.

use plotters::prelude::*;

use super::chart::{hexadecimal, reason, svg, Canvas, FigureError, COLOURS};
use super::html::{legend, Section};
use super::series::{Line, Mark};
use crate::base::number::{tick, tick_of_logarithm};

/// Size of a figure, in pixels.
const SIZE: (u32, u32) = (960, 340);
/// Fraction of the value range left free above and below.
const HEADROOM: f64 = 0.06;

/// Colour of limits.
const LIMIT_COLOUR: RGBColor = RGBColor(120, 120, 120);

/// A filled region between two curves.
#[derive(Debug, Clone, PartialEq)]
pub struct Band {
    /// Name in the legend.
    pub name: String,
    /// Place, lower and upper value, in order of the places.
    pub points: Vec<(f64, f64, f64)>,
    /// How much of the first line's colour it has, between 0 and 1.
    pub strength: f64,
}

/// A horizontal axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Horizontal {
    /// Name and unit.
    pub label: String,
    /// Where it begins.
    pub start: f64,
    /// Where it ends.
    pub end: f64,
}

/// A figure, over time when nothing else is said.
#[derive(Debug, Clone, Default)]
pub struct Figure {
    /// Title; it stands above the figure in the page.
    pub title: String,
    /// Name and unit of the values.
    pub label: String,
    /// What is drawn.
    pub lines: Vec<Line>,
    /// Horizontal lines: limits and tolerances.
    pub limits: Vec<f64>,
    /// Whether the values are on a logarithmic scale.
    pub logarithmic: bool,
    /// End of the time axis, s.
    pub end_s: f64,
    /// The horizontal axis where it is not time from 0 to `end_s`.
    pub horizontal: Option<Horizontal>,
    /// Vertical lines.
    pub marks: Vec<f64>,
    /// Filled regions, behind the lines.
    pub bands: Vec<Band>,
}

impl Figure {
    /// The figure as an SVG element.
    ///
    /// # Errors
    /// The drawing library's.
    pub fn to_svg(&self) -> Result<String, FigureError> {
        svg(&self.title, "", SIZE, |root| self.draw(root))
    }

    /// The figure with its title and legend.
    ///
    /// # Errors
    /// The drawing library's.
    pub fn section(&self) -> Result<Section, FigureError> {
        let svg = self.to_svg()?;
        Ok(Section::new(&self.title)
            .with(&legend(self.legend()))
            .with(&svg))
    }

    /// Name and colour (as in HTML) of each line, when there are several.
    pub fn legend(&self) -> Vec<(&str, String)> {
        if self.lines.len() + self.bands.len() < 2 {
            return Vec::new();
        }
        let pairs = self.lines.iter().zip(COLOURS.iter().cycle());
        let lines = pairs.map(|(line, colour)| (line.name.as_str(), hexadecimal(*colour)));
        let bands = self.bands.iter().map(|band| {
            let opacity = (255.0 * band.strength).round() as u8;
            let colour = format!("{}{opacity:02x}", hexadecimal(COLOURS[0]));
            (band.name.as_str(), colour)
        });
        lines.chain(bands).collect()
    }

    fn draw(&self, root: &Canvas) -> Result<(), String> {
        root.fill(&WHITE).map_err(reason)?;
        let (low, high) = self.range();
        let across = self.across();
        let mut chart = ChartBuilder::on(root)
            .margin(12)
            .x_label_area_size(44)
            .y_label_area_size(78)
            .build_cartesian_2d(across.start..across.end, low..high)
            .map_err(reason)?;
        let logarithmic = self.logarithmic;
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(RGBColor(225, 225, 225))
            .axis_style(RGBColor(90, 90, 90))
            .x_desc(across.label.as_str())
            .y_desc(self.label.as_str())
            .x_labels(11)
            .y_labels(7)
            .label_style(("sans-serif", 14))
            .x_label_formatter(&|value| tick(*value))
            .y_label_formatter(&|value| {
                if logarithmic {
                    tick_of_logarithm(*value)
                } else {
                    tick(*value)
                }
            })
            .draw()
            .map_err(reason)?;
        for (band, colour) in self.bands.iter().zip(COLOURS.iter().take(1).cycle()) {
            let outline = self.outline(band, low);
            let style = colour.mix(band.strength).filled();
            chart
                .draw_series(std::iter::once(Polygon::new(outline, style)))
                .map_err(reason)?;
        }
        let horizontal = self.limits.iter().map(|&limit| {
            let value = self.scaled(limit);
            [(across.start, value), (across.end, value)]
        });
        let vertical = self.marks.iter().map(|&at| [(at, low), (at, high)]);
        for ends in horizontal.chain(vertical) {
            let style = LIMIT_COLOUR.stroke_width(1);
            chart
                .draw_series(DashedLineSeries::new(ends, 6, 4, style))
                .map_err(reason)?;
        }
        for (line, colour) in self.lines.iter().zip(COLOURS.iter().cycle()) {
            let points = line.points.iter().map(|&(x, y)| (x, self.scaled(y)));
            let points: Vec<_> = points.filter(|(_, y)| y.is_finite()).collect();
            match line.mark {
                Mark::Line => {
                    let series = LineSeries::new(points, colour.stroke_width(2));
                    chart.draw_series(series).map_err(reason)?;
                }
                Mark::Dot => {
                    let dots = points
                        .into_iter()
                        .map(|at| Circle::new(at, 2, colour.filled()));
                    chart.draw_series(dots).map_err(reason)?;
                }
            }
        }
        Ok(())
    }

    fn across(&self) -> Horizontal {
        let time = || Horizontal {
            label: "time (s)".to_string(),
            start: 0.0,
            end: self.end_s.max(f64::MIN_POSITIVE),
        };
        self.horizontal.clone().unwrap_or_else(time)
    }

    /// The outline of a band; what a logarithm does not have is at the lower end.
    fn outline(&self, band: &Band, low: f64) -> Vec<(f64, f64)> {
        let shown =
            |value: f64| Some(self.scaled(value).max(low)).filter(|value| value.is_finite());
        let upper = band
            .points
            .iter()
            .filter_map(|&(x, _, y)| Some((x, shown(y)?)));
        let lower = band.points.iter().rev();
        upper
            .chain(lower.filter_map(|&(x, y, _)| Some((x, shown(y)?))))
            .collect()
    }

    fn scaled(&self, value: f64) -> f64 {
        if self.logarithmic {
            value.log10()
        } else {
            value
        }
    }

    /// Range of the values with headroom; never empty.
    fn range(&self) -> (f64, f64) {
        let values = self
            .lines
            .iter()
            .flat_map(|line| line.points.iter().map(|point| point.1));
        let ends = self.bands.iter().flat_map(|band| &band.points);
        let values = values
            .chain(ends.flat_map(|&(_, lower, upper)| [lower, upper]))
            .chain(self.limits.iter().copied());
        let scaled = values
            .map(|value| self.scaled(value))
            .filter(|value| value.is_finite());
        let (low, high) = scaled.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        });
        if low > high {
            return (0.0, 1.0);
        }
        let width = high - low;
        let least = if width > 0.0 {
            width
        } else {
            high.abs().max(1e-12)
        };
        (low - HEADROOM * least, high + HEADROOM * least)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_without_points_is_still_drawn() {
        let figure = Figure {
            title: "no <points>".to_string(),
            end_s: 1.0,
            ..Figure::default()
        };
        let svg = figure.to_svg().unwrap();
        assert!(svg.starts_with("<svg role=\"img\" aria-label=\"no &lt;points&gt;\""));
        assert!(svg.trim_end().ends_with("</svg>"));
    }
}
