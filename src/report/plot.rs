//! A plot as SVG. Its colours are classes in disguise: the page's style sheet gives each another value in
//! the dark.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::chart::{reason, svg, Canvas, FigureError};
use super::scale::Scale;
use crate::base::number::label;

/// Text and axes.
pub const INK: RGBColor = RGBColor(0x33, 0x33, 0x33);
/// Lines of the grid.
const GRID: RGBColor = RGBColor(0xE1, 0xE1, 0xE1);
/// What stands back: points that are not on the front.
pub const FAINT: RGBColor = RGBColor(0x99, 0x99, 0x99);
/// The page's style sheet finds plots by this class.
const CLASS: &str = "class=\"plot\" ";
/// Size of a plot, in pixels.
pub const SIZE: (u32, u32) = (620, 360);

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    /// Dots joined by lines.
    Joined,
    /// Dots.
    Dots,
    /// Larger dots, joined by steps: first along the vertical, then along the horizontal.
    Steps,
    /// Crosses at the lower end of the plot; the vertical value does not count.
    Crosses,
}

/// Points of one kind.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Its name in the legend.
    pub name: String,
    /// Its colour.
    pub colour: RGBColor,
    /// How it is drawn.
    pub mark: Marker,
    /// Its points.
    pub points: Vec<(f64, f64)>,
}

/// A plot of values against values.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Plot {
    /// Title; it stands above the plot in the page.
    pub title: String,
    /// Name and unit of the horizontal axis.
    pub horizontal: String,
    /// Name and unit of the vertical axis.
    pub vertical: String,
    /// What is drawn.
    pub series: Vec<Series>,
}

/// A cell of a map.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    /// Its colour.
    pub colour: RGBColor,
    /// What stands in it, where there is room.
    pub mark: String,
}

/// A map: a cell for each pair of values of two axes.
#[derive(Debug, Clone, PartialEq)]
pub struct Map {
    /// Title.
    pub title: String,
    /// Name of the horizontal axis, and its values.
    pub horizontal: (String, Vec<f64>),
    /// Name of the vertical axis, and its values.
    pub vertical: (String, Vec<f64>),
    /// The cells, row by row from below.
    pub cells: Vec<Cell>,
}

impl Plot {
    /// The plot as an SVG element.
    ///
    /// # Errors
    /// The drawing library's.
    pub fn to_svg(&self) -> Result<String, FigureError> {
        svg(&self.title, CLASS, SIZE, |root| self.draw(root))
    }

    fn draw(&self, root: &Canvas) -> Result<(), String> {
        let points = || self.series.iter().flat_map(|series| &series.points);
        let heights = self.series.iter().filter(|s| s.mark != Marker::Crosses);
        let heights = heights.flat_map(|series| &series.points);
        let horizontal = Scale::of(points().map(|point| point.0), 7);
        let vertical = Scale::of(heights.map(|point| point.1), 6);
        let floor = vertical.low();
        let mut chart = ChartBuilder::on(root)
            .margin(12)
            .x_label_area_size(50)
            .y_label_area_size(80)
            .build_cartesian_2d(horizontal, vertical)
            .map_err(reason)?;
        mesh(&mut chart, [&self.horizontal, &self.vertical], GRID)?;
        for series in &self.series {
            let (colour, finite) = (series.colour, finite(&series.points));
            if series.mark == Marker::Joined || series.mark == Marker::Steps {
                let path = match series.mark {
                    Marker::Steps => steps(&finite),
                    _ => finite.clone(),
                };
                let line = LineSeries::new(path, colour.stroke_width(2));
                chart.draw_series(line).map_err(reason)?;
            }
            match series.mark {
                Marker::Crosses => {
                    let at = series.points.iter().map(|point| (point.0, floor));
                    let crosses = at.map(|at| {
                        EmptyElement::at(at) + Cross::new((0, -6), 4, colour.stroke_width(2))
                    });
                    chart.draw_series(crosses).map_err(reason)?;
                }
                mark => {
                    let radius = if mark == Marker::Steps { 5 } else { 3 };
                    let dots = finite.into_iter();
                    let dots = dots.map(|at| Circle::new(at, radius, colour.filled()));
                    chart.draw_series(dots).map_err(reason)?;
                }
            }
        }
        Ok(())
    }
}

fn finite(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let points = points.iter().copied();
    points
        .filter(|(x, y)| x.is_finite() && y.is_finite())
        .collect()
}

/// Corners between the points: up or down first, then across.
fn steps(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let mut out: Vec<(f64, f64)> = Vec::new();
    for &(x, y) in points {
        if let Some(&(before, _)) = out.last() {
            out.push((before, y));
        }
        out.push((x, y));
    }
    out
}

type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Scale, Scale>>;

fn mesh(
    chart: &mut Chart,
    [horizontal, vertical]: [&String; 2],
    lines: impl Into<ShapeStyle>,
) -> Result<(), String> {
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(lines)
        .axis_style(INK)
        .x_desc(horizontal.as_str())
        .y_desc(vertical.as_str())
        .label_style(("sans-serif", 16, &INK))
        .draw()
        .map_err(reason)
}

/// Room for a cell's mark, in pixels.
const MARK_ROOM: u32 = 16;

impl Map {
    /// The map as an SVG element.
    ///
    /// # Errors
    /// The drawing library's.
    pub fn to_svg(&self) -> Result<String, FigureError> {
        svg(&self.title, CLASS, SIZE, |root| self.draw(root))
    }

    fn draw(&self, root: &Canvas) -> Result<(), String> {
        let names =
            |values: &[f64]| -> Vec<String> { values.iter().map(|&value| label(value)).collect() };
        let (columns, rows) = (self.horizontal.1.len(), self.vertical.1.len());
        let mut chart = ChartBuilder::on(root)
            .margin(12)
            .x_label_area_size(50)
            .y_label_area_size(80)
            .build_cartesian_2d(
                Scale::cells(&names(&self.horizontal.1), 8),
                Scale::cells(&names(&self.vertical.1), 12),
            )
            .map_err(reason)?;
        mesh(
            &mut chart,
            [&self.horizontal.0, &self.vertical.0],
            TRANSPARENT,
        )?;
        let (width, height) = chart.plotting_area().dim_in_pixel();
        let room = width >= MARK_ROOM * columns as u32 && height >= MARK_ROOM * rows as u32;
        let style = ("sans-serif", 17, &WHITE)
            .into_text_style(root)
            .pos(Pos::new(HPos::Center, VPos::Center));
        for (index, cell) in self.cells.iter().enumerate() {
            let (x, y) = ((index % columns) as f64, (index / columns) as f64);
            let corners = [(x, y), (x + 1.0, y + 1.0)];
            let square = Rectangle::new(corners, cell.colour.filled());
            chart.draw_series([square]).map_err(reason)?;
            if room && !cell.mark.is_empty() {
                let mark = Text::new(cell.mark.clone(), (x + 0.5, y + 0.5), style.clone());
                chart.draw_series([mark]).map_err(reason)?;
            }
        }
        Ok(())
    }
}
