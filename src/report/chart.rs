//! Figures as SVG: series, bands, limits and cells over two axes.
//!
//! Colours are classes in disguise: the page's style sheet gives each another value in the dark.

use plotters::coord::types::RangedCoordf64;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axis::{PlotAxis, Scale, Spacing};
use super::html::{captioned, escape, legend, section};
use super::series::{Mark, Series, COLOURS};

/// Text and axes.
pub const INK: RGBColor = RGBColor(0x33, 0x33, 0x33);
/// Lines of the grid.
const GRID: RGBColor = RGBColor(0xE1, 0xE1, 0xE1);
/// Limits, and points that are not on the front.
pub const FAINT: RGBColor = RGBColor(0x99, 0x99, 0x99);

/// Room for a cell's mark, in pixels.
const MARK_ROOM: u32 = 16;

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

/// A cell of a map.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// Its colour.
    pub colour: RGBColor,
    /// What stands in it, where there is room.
    pub mark: String,
}

/// A figure.
#[derive(Debug, Clone, Default)]
pub struct Figure {
    /// Title; it stands above the figure in the page.
    pub title: String,
    /// The horizontal and the vertical axis.
    pub axes: [PlotAxis; 2],
    /// Lines and points.
    pub series: Vec<Series>,
    /// Filled regions, behind the lines.
    pub bands: Vec<Band>,
    /// Dashed horizontal lines: limits and tolerances.
    pub limits: Vec<f64>,
    /// Dashed vertical lines.
    pub marks: Vec<f64>,
    /// Cells between two axes of cells, row by row from below.
    pub cells: Vec<Cell>,
    /// Narrow, to stand beside another.
    pub narrow: bool,
}

type Canvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Plane>;
type Plane = Cartesian2d<RangedCoordf64, RangedCoordf64>;

/// What the drawing library says.
fn reason(error: impl std::fmt::Display) -> String {
    error.to_string()
}

/// A colour as in HTML.
pub fn hexadecimal(RGBColor(red, green, blue): RGBColor) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

impl Figure {
    /// A figure over time, from 0 to an end (s).
    pub fn over_time(
        title: impl Into<String>,
        label: &str,
        end_s: f64,
        series: Vec<Series>,
    ) -> Self {
        let time = PlotAxis::between("time (s)", 0.0, end_s.max(f64::MIN_POSITIVE));
        Figure {
            title: title.into(),
            axes: [time, PlotAxis::new(label, Spacing::Linear)],
            series,
            ..Figure::default()
        }
    }

    /// With its values at equal ratios.
    pub fn logarithmic(mut self) -> Self {
        self.axes[1].spacing = Spacing::Logarithmic;
        self
    }

    /// With limits.
    pub fn limits(mut self, limits: impl IntoIterator<Item = f64>) -> Self {
        self.limits.extend(limits);
        self
    }

    /// The figure as an SVG element with a label for those who cannot see it.
    ///
    /// # Errors
    /// The drawing library's.
    pub fn to_svg(&self) -> Result<String, FigureError> {
        let mut out = String::new();
        let size = if self.narrow { (620, 360) } else { (960, 340) };
        let root = SVGBackend::with_string(&mut out, size).into_drawing_area();
        let drawn = self.draw(&root);
        let drawn = drawn.and_then(|()| root.present().map_err(reason));
        drop(root);
        drawn.map_err(|reason| FigureError {
            title: self.title.clone(),
            reason,
        })?;
        let start = out.find("<svg").unwrap_or(0);
        let open = format!("<svg role=\"img\" aria-label=\"{}\" ", escape(&self.title));
        Ok(out[start..].replacen("<svg ", &open, 1))
    }

    /// The legend and the drawing.
    ///
    /// # Errors
    /// The drawing library's.
    pub fn to_html(&self) -> Result<String, FigureError> {
        Ok(legend(self.legend()) + &self.to_svg()?)
    }

    /// The figure with its caption.
    ///
    /// # Errors
    /// The drawing library's.
    pub fn captioned(&self) -> Result<String, FigureError> {
        Ok(captioned(&self.title, &self.to_html()?))
    }

    /// A section of its own.
    ///
    /// # Errors
    /// The drawing library's.
    pub fn section(&self) -> Result<String, FigureError> {
        Ok(section(&self.title, &self.to_html()?))
    }

    /// Name and colour (as in HTML) of what has a name; nothing for a wide figure's only line.
    pub fn legend(&self) -> Vec<(&str, String)> {
        let lines = self.series.iter().enumerate().map(|(index, series)| {
            let colour = hexadecimal(series.colour(index));
            (series.name.as_str(), colour)
        });
        let bands = self.bands.iter().map(|band| {
            let opacity = (255.0 * band.strength).round() as u8;
            let colour = format!("{}{opacity:02x}", hexadecimal(COLOURS[0]));
            (band.name.as_str(), colour)
        });
        let several = self.narrow || self.series.len() + self.bands.len() > 1;
        let all = lines.chain(bands);
        all.filter(|(name, _)| several && !name.is_empty())
            .collect()
    }

    /// The axes as they are drawn.
    fn scales(&self) -> [Scale<'_>; 2] {
        let points = || self.series.iter().flat_map(|series| &series.points);
        let bands = || self.bands.iter().flat_map(|band| &band.points);
        let heights = self.series.iter().filter(|one| one.mark != Mark::Crosses);
        let heights = heights.flat_map(|series| &series.points);
        let heights = heights.map(|point| point.1);
        let heights = heights.chain(bands().flat_map(|&(_, low, high)| [low, high]));
        let heights = heights.chain(self.limits.iter().copied());
        let places = points().map(|point| point.0);
        let [across, up] = &self.axes;
        [across.scale(places), up.scale(heights)]
    }

    fn draw(&self, root: &Canvas) -> Result<(), String> {
        let [across, up] = self.scales();
        let ticks = match (self.narrow, self.cells.is_empty()) {
            (false, _) => (11, 7),
            (true, true) => (7, 6),
            (true, false) => (across.names.len().min(8), up.names.len().min(12)),
        };
        let mut chart = ChartBuilder::on(root)
            .margin(12)
            .x_label_area_size(50)
            .y_label_area_size(80)
            .build_cartesian_2d(across.range.clone(), up.range.clone())
            .map_err(reason)?;
        let grid = match self.cells.is_empty() {
            true => GRID.to_rgba(),
            false => TRANSPARENT,
        };
        chart
            .configure_mesh()
            .light_line_style(TRANSPARENT)
            .bold_line_style(grid)
            .axis_style(INK)
            .x_desc(self.axes[0].label.as_str())
            .y_desc(self.axes[1].label.as_str())
            .x_labels(ticks.0)
            .y_labels(ticks.1)
            .label_style(("sans-serif", 15, &INK))
            .x_label_formatter(&|place| across.tick(*place))
            .y_label_formatter(&|place| up.tick(*place))
            .draw()
            .map_err(reason)?;
        self.draw_bands(&mut chart, &up)?;
        self.draw_limits(&mut chart, [&across, &up])?;
        for (index, series) in self.series.iter().enumerate() {
            draw_series(&mut chart, series, series.colour(index), [&across, &up])?;
        }
        self.draw_cells(&mut chart, root, [across.names.len(), up.names.len()])
    }

    /// Regions; what a logarithm does not have is at the lower end.
    fn draw_bands(&self, chart: &mut Chart, up: &Scale) -> Result<(), String> {
        for band in &self.bands {
            let at = |x: f64, y: f64| (x, up.place(y).max(up.range.start));
            let upper = band.points.iter().map(|&(x, _, high)| at(x, high));
            let lower = band.points.iter().rev().map(|&(x, low, _)| at(x, low));
            let style = COLOURS[0].mix(band.strength).filled();
            let region = Polygon::new(upper.chain(lower).collect::<Vec<_>>(), style);
            chart.draw_series([region]).map_err(reason)?;
        }
        Ok(())
    }

    fn draw_limits(&self, chart: &mut Chart, [across, up]: [&Scale; 2]) -> Result<(), String> {
        let (start, end) = (across.range.start, across.range.end);
        let limits = self.limits.iter().map(|&limit| up.place(limit));
        let horizontal = limits.map(|limit| [(start, limit), (end, limit)]);
        let marks = self.marks.iter().map(|&mark| across.place(mark));
        let vertical = marks.map(|mark| [(mark, up.range.start), (mark, up.range.end)]);
        for line in horizontal.chain(vertical) {
            let line = DashedLineSeries::new(line, 6, 4, FAINT.stroke_width(1));
            chart.draw_series(line).map_err(reason)?;
        }
        Ok(())
    }

    /// Squares, each with its mark where there is room for all.
    fn draw_cells(
        &self,
        chart: &mut Chart,
        root: &Canvas,
        [columns, rows]: [usize; 2],
    ) -> Result<(), String> {
        let (width, height) = chart.plotting_area().dim_in_pixel();
        let room = width >= MARK_ROOM * columns as u32 && height >= MARK_ROOM * rows as u32;
        let style = ("sans-serif", 17, &WHITE).into_text_style(root);
        let style = style.pos(Pos::new(HPos::Center, VPos::Center));
        for (index, cell) in self.cells.iter().enumerate() {
            let (x, y) = ((index % columns) as f64, (index / columns) as f64);
            let corners = [(x - 0.5, y - 0.5), (x + 0.5, y + 0.5)];
            let square = Rectangle::new(corners, cell.colour.filled());
            chart.draw_series([square]).map_err(reason)?;
            if room && !cell.mark.is_empty() {
                let mark = Text::new(cell.mark.clone(), (x, y), style.clone());
                chart.draw_series([mark]).map_err(reason)?;
            }
        }
        Ok(())
    }
}

/// Points where both scales have a place for them, drawn as their mark says.
fn draw_series(
    chart: &mut Chart,
    series: &Series,
    colour: RGBColor,
    [across, up]: [&Scale; 2],
) -> Result<(), String> {
    let places = series.points.iter().map(|&(x, y)| match series.mark {
        Mark::Crosses => (across.place(x), up.range.start),
        _ => (across.place(x), up.place(y)),
    });
    let places: Vec<(f64, f64)> = places
        .filter(|(x, y)| x.is_finite() && y.is_finite())
        .collect();
    let path = match series.mark {
        Mark::Line | Mark::Joined => places.clone(),
        Mark::Steps => steps(&places),
        Mark::Dots | Mark::Points | Mark::Crosses => Vec::new(),
    };
    let line = LineSeries::new(path, colour.stroke_width(2));
    chart.draw_series(line).map_err(reason)?;
    let radius = match series.mark {
        Mark::Line => return Ok(()),
        Mark::Crosses => {
            let cross = |at| EmptyElement::at(at) + Cross::new((0, -6), 4, colour.stroke_width(2));
            let crosses = places.into_iter().map(cross);
            chart.draw_series(crosses).map_err(reason)?;
            return Ok(());
        }
        Mark::Dots => 2,
        Mark::Joined | Mark::Points => 3,
        Mark::Steps => 5,
    };
    let dots = places.into_iter();
    let dots = dots.map(|at| Circle::new(at, radius, colour.filled()));
    chart.draw_series(dots).map_err(reason)?;
    Ok(())
}

/// Corners between the points: up or down first, then across.
fn steps(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let corners = points.windows(2).map(|pair| (pair[0].0, pair[1].1));
    let after = corners.zip(points.iter().skip(1));
    let rest = after.flat_map(|(corner, &point)| [corner, point]);
    points.first().copied().into_iter().chain(rest).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_without_points_is_still_drawn() {
        let figure = Figure::over_time("no <points>", "", 1.0, Vec::new());
        let svg = figure.to_svg().unwrap();
        assert!(svg.starts_with("<svg role=\"img\" aria-label=\"no &lt;points&gt;\""));
        assert!(svg.trim_end().ends_with("</svg>"));
    }
}
