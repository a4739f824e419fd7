//! The figures of a report, as SVG.

use plotters::prelude::*;

use super::html::{escape, put};
use super::series::{Line, Mark};

/// Size of a figure, in pixels.
const SIZE: (u32, u32) = (960, 340);
/// Share of the value range left free above and below.
const HEADROOM: f64 = 0.06;

/// Colours that colour-blind readers can tell apart (P. Tol's bright scheme).
pub const COLOURS: [RGBColor; 6] = [
    RGBColor(68, 119, 170),
    RGBColor(238, 102, 119),
    RGBColor(34, 136, 51),
    RGBColor(204, 187, 68),
    RGBColor(102, 204, 238),
    RGBColor(170, 51, 119),
];
const LIMIT_COLOUR: RGBColor = RGBColor(120, 120, 120);

/// A figure could not be drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("figure '{title}': {reason}")]
pub struct FigureError {
    /// Its title.
    pub title: String,
    /// What the drawing library says.
    pub reason: String,
}

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
        let mut svg = String::new();
        self.draw(&mut svg).map_err(|reason| FigureError {
            title: self.title.clone(),
            reason,
        })?;
        let start = svg.find("<svg").unwrap_or(0);
        Ok(svg[start..].replacen(
            "<svg ",
            &format!(
                "<svg role=\"img\" aria-label=\"{}\" ",
                super::html::escape(&self.title)
            ),
            1,
        ))
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

    fn draw(&self, svg: &mut String) -> Result<(), String> {
        let root = SVGBackend::with_string(svg, SIZE).into_drawing_area();
        root.fill(&WHITE).map_err(text)?;
        let (low, high) = self.range();
        let across = self.across();
        let mut chart = ChartBuilder::on(&root)
            .margin(12)
            .x_label_area_size(44)
            .y_label_area_size(78)
            .build_cartesian_2d(across.start..across.end, low..high)
            .map_err(text)?;
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
            .x_label_formatter(&|value| plain(*value))
            .y_label_formatter(&|value| {
                if logarithmic {
                    power_of_ten(*value)
                } else {
                    plain(*value)
                }
            })
            .draw()
            .map_err(text)?;
        for (band, colour) in self.bands.iter().zip(COLOURS.iter().take(1).cycle()) {
            let outline = self.outline(band, low);
            let style = colour.mix(band.strength).filled();
            chart
                .draw_series(std::iter::once(Polygon::new(outline, style)))
                .map_err(text)?;
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
                .map_err(text)?;
        }
        for (line, colour) in self.lines.iter().zip(COLOURS.iter().cycle()) {
            let points = line.points.iter().map(|&(x, y)| (x, self.scaled(y)));
            let points: Vec<_> = points.filter(|(_, y)| y.is_finite()).collect();
            match line.mark {
                Mark::Line => {
                    let series = LineSeries::new(points, colour.stroke_width(2));
                    chart.draw_series(series).map_err(text)?;
                }
                Mark::Dot => {
                    let dots = points
                        .into_iter()
                        .map(|at| Circle::new(at, 2, colour.filled()));
                    chart.draw_series(dots).map_err(text)?;
                }
            }
        }
        root.present().map_err(text)
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

fn hexadecimal(RGBColor(red, green, blue): RGBColor) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

fn text(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// A tick's number without the rounding of its multiplication.
fn plain(value: f64) -> String {
    let magnitude = value.abs();
    if magnitude < 1e-12 {
        return "0".to_string();
    }
    if !(1e-3..1e6).contains(&magnitude) {
        return format!("{value:.1e}").replace(".0e", "e");
    }
    let rounded = format!("{value:.6}");
    rounded
        .trim_end_matches('0')
        .trim_end_matches('.')
        .to_string()
}

/// Two significant digits.
fn power_of_ten(exponent: f64) -> String {
    let value = 10f64.powf(exponent);
    if !(1e-3..1e4).contains(&value) {
        return format!("{value:.1e}").replace(".0e", "e");
    }
    let digits = (1 - (exponent + 1e-9).floor() as i32).clamp(0, 6) as usize;
    plain(format!("{value:.digits$}").parse().unwrap_or(value))
}

impl Figure {
    /// Writes the figure with its title and legend.
    ///
    /// # Errors
    /// The drawing library's.
    pub fn write_section(&self, body: &mut String) -> Result<(), FigureError> {
        let svg = self.to_svg()?;
        let title = escape(&self.title);
        put(body, format_args!("<section><h2>{title}</h2>\n"));
        legend(self, body);
        put(body, format_args!("{svg}</section>\n"));
        Ok(())
    }
}

fn legend(figure: &Figure, body: &mut String) {
    let lines = figure.legend();
    if lines.is_empty() {
        return;
    }
    body.push_str("<p class=\"legend\">");
    for (name, colour) in lines {
        put(
            body,
            format_args!(
                "<span style=\"border-color: {colour}\">{}</span>",
                escape(name)
            ),
        );
    }
    body.push_str("</p>\n");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_written_short() {
        assert_eq!(plain(0.30000000000000004), "0.3");
        assert_eq!(plain(-1.5e-4), "-1.5e-4");
        assert_eq!(plain(1e-17), "0");
        assert_eq!(plain(200.0), "200");
        assert_eq!(power_of_ten(-1.0), "0.1");
        assert_eq!(power_of_ten(-5.0), "1e-5");
        assert_eq!(power_of_ten(2.0), "100");
        assert_eq!(power_of_ten(0.5), "3.2");
    }

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
