//! The parts of a page, as HTML. What is called text is escaped here; what is called HTML is not.

use crate::base::provenance::GENERATOR;

/// The style of every page.
const STYLE: &str = include_str!("page.css");

/// What a page is about.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum PageKind {
    /// A run.
    #[default]
    Run,
    /// A campaign.
    Campaign,
    /// A comparison.
    Comparison,
    /// A sweep.
    Sweep,
}

impl PageKind {
    /// The page by name, such as `page of a run`.
    pub fn name(self) -> &'static str {
        match self {
            PageKind::Run => "page of a run",
            PageKind::Campaign => "page of a campaign",
            PageKind::Comparison => "page of a comparison",
            PageKind::Sweep => "page of a sweep",
        }
    }

    /// The line in a page's head that says so, up to its end.
    pub fn mark(self) -> String {
        format!("<meta name=\"description\" content=\"{}", self.name())
    }
}

/// A page: what came of it, sections, and where it comes from.
#[derive(Debug, Clone, Default)]
pub struct Page {
    /// What it is about.
    pub kind: PageKind,
    /// Title of the window.
    pub title: String,
    /// How the verdict is shown: `good`, `bad` or `alarm`.
    pub class: &'static str,
    /// The verdict in a sentence.
    pub verdict: String,
    /// What stands after it; may be empty.
    pub remark: String,
    /// The heading.
    pub heading: String,
    /// What stands below the heading, as HTML.
    pub introduction: String,
    /// The sections, as HTML.
    pub sections: Vec<String>,
    /// Paragraphs, each of lines, about where it comes from.
    pub footer: Vec<Vec<String>>,
}

impl Page {
    /// The page as one HTML file.
    pub fn to_html(&self) -> String {
        let remark = match self.remark.as_str() {
            "" => String::new(),
            remark => format!(" {}", escape(remark)),
        };
        let footer = self.footer.iter().map(|lines| {
            let lines: Vec<String> = lines.iter().map(|line| escape(line)).collect();
            format!("<p>{}</p>\n", lines.join("<br>"))
        });
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             {} by {GENERATOR}\">\n<title>{}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<header>\n\
             <p class=\"verdict {}\"><strong>{}</strong>{remark}</p>\n<h1>{}</h1>\n{}</header>\n\
             {}<footer>\n{}</footer>\n</body>\n</html>\n",
            self.kind.mark(),
            escape(&self.title),
            self.class,
            escape(&self.verdict),
            escape(&self.heading),
            self.introduction,
            self.sections.concat(),
            footer.collect::<String>()
        )
    }
}

/// A section with a heading around HTML.
pub fn section(title: &str, html: &str) -> String {
    let title = escape(title);
    format!("<section><h2>{title}</h2>\n{html}</section>\n")
}

/// A table of a class, of rows below a row of headings, if any.
pub fn table<T: AsRef<str>>(
    class: &str,
    headings: impl IntoIterator<Item = T>,
    rows: impl IntoIterator<Item = String>,
) -> String {
    let head = match headings.into_iter().map(heading).collect::<String>() {
        cells if cells.is_empty() => cells,
        cells => row([cells]),
    };
    let rows: String = rows.into_iter().collect();
    format!("<table{}>\n{head}{rows}</table>\n", attribute(class))
}

/// A table of names and values.
pub fn numbers<N: AsRef<str>, V: AsRef<str>>(rows: impl IntoIterator<Item = (N, V)>) -> String {
    let rows = rows.into_iter();
    let rows = rows.map(|(name, value)| row([heading(name), cell(value)]));
    table("numbers", [""; 0], rows)
}

/// A row of cells.
pub fn row(cells: impl IntoIterator<Item = String>) -> String {
    row_of_class("", cells)
}

/// A row of a class.
pub fn row_of_class(class: &str, cells: impl IntoIterator<Item = String>) -> String {
    let cells: String = cells.into_iter().collect();
    format!("<tr{}>{cells}</tr>\n", attribute(class))
}

/// A cell that is a heading.
pub fn heading(text: impl AsRef<str>) -> String {
    format!("<th>{}</th>", escape(text.as_ref()))
}

/// A cell of a text.
pub fn cell(text: impl AsRef<str>) -> String {
    cell_of_class("", text)
}

/// A cell of a text, of a class.
pub fn cell_of_class(class: &str, text: impl AsRef<str>) -> String {
    format!("<td{}>{}</td>", attribute(class), escape(text.as_ref()))
}

/// A cell that tells good from bad.
pub fn judged(good: bool, text: impl AsRef<str>) -> String {
    cell_of_class(if good { "good" } else { "bad" }, text)
}

/// A cell of HTML.
pub fn html_cell(html: &str) -> String {
    format!("<td>{html}</td>")
}

/// A paragraph.
pub fn paragraph(text: &str) -> String {
    format!("<p>{}</p>\n", escape(text))
}

/// A paragraph about where something comes from.
pub fn source(text: &str) -> String {
    format!("<p class=\"source\">{}</p>\n", escape(text))
}

/// A list of HTML.
pub fn list(items: impl IntoIterator<Item = String>) -> String {
    let items = items.into_iter().map(|item| format!("<li>{item}</li>\n"));
    format!("<ul>\n{}</ul>\n", items.collect::<String>())
}

/// Names with their colours; empty without names.
pub fn legend<T: AsRef<str>>(names: impl IntoIterator<Item = (T, String)>) -> String {
    let names = names.into_iter().map(|(name, colour)| {
        let name = escape(name.as_ref());
        format!("<span style=\"border-color: {colour}\">{name}</span>")
    });
    match names.collect::<String>() {
        names if names.is_empty() => names,
        names => format!("<p class=\"legend\">{names}</p>\n"),
    }
}

/// HTML, such as a drawing, with its caption.
pub fn captioned(title: &str, html: &str) -> String {
    let title = escape(title);
    format!("<figure><figcaption>{title}</figcaption>\n{html}</figure>\n")
}

/// A division of a class around HTML.
pub fn division(class: &str, html: &str) -> String {
    format!("<div class=\"{class}\">\n{html}</div>\n")
}

fn attribute(class: &str) -> String {
    match class {
        "" => String::new(),
        class => format!(" class=\"{class}\""),
    }
}

/// Text for HTML.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
