//! The parts of a page.

/// The style of every page.
const STYLE: &str = include_str!("page.css");

/// A page: what came of it, sections, and where it comes from.
#[derive(Debug, Clone)]
pub struct Page {
    /// Title of the window.
    pub title: String,
    /// Further lines of style.
    pub style: &'static str,
    /// What came of it.
    pub header: Header,
    /// The sections.
    pub sections: Vec<Section>,
    /// Paragraphs, each of lines, about where it comes from.
    pub footer: Vec<Vec<String>>,
}

/// The top of a page: the verdict first.
#[derive(Debug, Clone)]
pub struct Header {
    /// How the verdict is shown: `good`, `bad` or `alarm`.
    pub class: &'static str,
    /// The verdict in a sentence.
    pub verdict: String,
    /// What stands after it; may be empty.
    pub remark: String,
    /// The heading.
    pub title: String,
    /// What stands below the heading, as HTML.
    pub body: String,
}

/// A section with its heading.
#[derive(Debug, Clone)]
pub struct Section {
    id: &'static str,
    title: String,
    body: String,
}

/// A table.
#[derive(Debug, Clone)]
pub struct HtmlTable {
    class: &'static str,
    within: &'static str,
    body: String,
}

/// A cell of a table.
#[derive(Debug, Clone)]
pub struct HtmlCell {
    class: &'static str,
    html: String,
}

impl Page {
    /// The page as one HTML file.
    pub fn to_html(&self) -> String {
        let sections: String = self.sections.iter().map(Section::to_html).collect();
        format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
             <title>{}</title>\n<style>\n{STYLE}{}</style>\n</head>\n<body>\n{}{sections}{}</body>\n</html>\n",
            escape(&self.title),
            self.style,
            self.header.to_html(),
            self.footer_html()
        )
    }

    fn footer_html(&self) -> String {
        let paragraphs = self.footer.iter().map(|lines| {
            let lines: Vec<String> = lines.iter().map(|line| escape(line)).collect();
            format!("<p>{}</p>\n", lines.join("<br>"))
        });
        format!("<footer>\n{}</footer>\n", paragraphs.collect::<String>())
    }
}

impl Header {
    fn to_html(&self) -> String {
        let remark = match self.remark.as_str() {
            "" => String::new(),
            remark => format!(" {}", escape(remark)),
        };
        format!(
            "<header>\n<p class=\"verdict {}\"><strong>{}</strong>{remark}</p>\n<h1>{}</h1>\n{}</header>\n",
            self.class,
            escape(&self.verdict),
            escape(&self.title),
            self.body
        )
    }
}

impl Section {
    /// A section without anything in it.
    pub fn new(title: &str) -> Self {
        Self {
            id: "",
            title: title.to_string(),
            body: String::new(),
        }
    }

    /// With a name that links lead to.
    pub fn id(mut self, id: &'static str) -> Self {
        self.id = id;
        self
    }

    /// With HTML at its end.
    pub fn with(mut self, html: &str) -> Self {
        self.body.push_str(html);
        self
    }

    /// With a table at its end.
    pub fn with_table(self, table: &HtmlTable) -> Self {
        self.with(&table.to_html())
    }

    fn to_html(&self) -> String {
        let id = match self.id {
            "" => String::new(),
            id => format!(" id=\"{id}\""),
        };
        let title = escape(&self.title);
        format!("<section{id}><h2>{title}</h2>\n{}</section>\n", self.body)
    }
}

impl HtmlTable {
    /// A table without rows, of a class of the style; empty for none.
    pub fn new(class: &'static str) -> Self {
        Self {
            class,
            within: "",
            body: String::new(),
        }
    }

    /// A table of names and values.
    pub fn numbers<N: AsRef<str>>(rows: &[(N, String)]) -> Self {
        let mut table = Self::new("numbers");
        for (name, value) in rows {
            table.named_row(name.as_ref(), [cell(value)]);
        }
        table
    }

    /// Inside of a division of a class.
    pub fn within(mut self, class: &'static str) -> Self {
        self.within = class;
        self
    }

    /// With a row of headings.
    pub fn head<T: AsRef<str>>(mut self, names: impl IntoIterator<Item = T>) -> Self {
        let names = names.into_iter();
        let names = names.map(|name| format!("<th>{}</th>", escape(name.as_ref())));
        self.body += &format!("<tr>{}</tr>\n", names.collect::<String>());
        self
    }

    /// Adds a row.
    pub fn row(&mut self, cells: impl IntoIterator<Item = HtmlCell>) {
        self.row_of("", String::new(), cells);
    }

    /// Adds a row of a class.
    pub fn row_of_class(&mut self, class: &'static str, cells: impl IntoIterator<Item = HtmlCell>) {
        self.row_of(class, String::new(), cells);
    }

    /// Adds a row with a heading of its own.
    pub fn named_row(&mut self, name: &str, cells: impl IntoIterator<Item = HtmlCell>) {
        self.row_of("", format!("<th>{}</th>", escape(name)), cells);
    }

    fn row_of(
        &mut self,
        class: &'static str,
        first: String,
        cells: impl IntoIterator<Item = HtmlCell>,
    ) {
        let cells = cells.into_iter();
        let cells = cells.map(|cell| format!("<td{}>{}</td>", attribute(cell.class), cell.html));
        let cells: String = cells.collect();
        self.body += &format!("<tr{}>{first}{cells}</tr>\n", attribute(class));
    }

    /// The table as HTML.
    pub fn to_html(&self) -> String {
        let table = format!("<table{}>\n{}</table>", attribute(self.class), self.body);
        match self.within {
            "" => table + "\n",
            class => format!("<div class=\"{class}\">{table}</div>\n"),
        }
    }
}

fn attribute(class: &str) -> String {
    match class {
        "" => String::new(),
        class => format!(" class=\"{class}\""),
    }
}

/// A cell of a text.
pub fn cell(text: impl AsRef<str>) -> HtmlCell {
    cell_of_class("", text)
}

/// A cell of a text, of a class.
pub fn cell_of_class(class: &'static str, text: impl AsRef<str>) -> HtmlCell {
    let html = escape(text.as_ref());
    HtmlCell { class, html }
}

/// A cell of HTML.
pub fn html_cell(html: String) -> HtmlCell {
    HtmlCell { class: "", html }
}

/// A paragraph.
pub fn paragraph(text: &str) -> String {
    format!("<p>{}</p>\n", escape(text))
}

/// A paragraph about where something comes from.
pub fn source(text: &str) -> String {
    format!("<p class=\"source\">{}</p>\n", escape(text))
}

/// A list of texts.
pub fn list(items: &[String]) -> String {
    let items = items.iter().map(|item| escape(item));
    html_list(items)
}

/// A list of HTML.
pub fn html_list(items: impl Iterator<Item = String>) -> String {
    let items: String = items.map(|item| format!("<li>{item}</li>\n")).collect();
    format!("<ul>\n{items}</ul>\n")
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

/// A drawing with its caption; `body` is HTML.
pub fn figure(class: &str, title: &str, body: &str) -> String {
    let (class, title) = (attribute(class), escape(title));
    format!("<figure{class}><figcaption>{title}</figcaption>\n{body}</figure>\n")
}

/// A division of a class around HTML.
pub fn division(class: &str, body: &str) -> String {
    format!("<div class=\"{class}\">\n{body}</div>\n")
}

/// Text for HTML.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}
