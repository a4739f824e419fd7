//! The parts of a page.

use std::fmt::Write;

const STYLE: &str = include_str!("page.css");

/// A page around its body.
pub fn document(title: &str, body: &str) -> String {
    document_with_style(title, "", body)
}

/// A page around its body, with further lines of style.
pub fn document_with_style(title: &str, style: &str, body: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{}</title>\n<style>\n{STYLE}{style}</style>\n</head>\n<body>\n{body}</body>\n</html>\n",
        escape(title)
    )
}

/// Text for HTML.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('>', "&gt;")
        .replace('"', "&quot;")
}

/// Writing to a string cannot fail.
pub(crate) fn put(body: &mut String, text: std::fmt::Arguments) {
    let _ = body.write_fmt(text);
}

/// The head of a section and a table of names and values; the section stays open.
pub(crate) fn numbers<N: AsRef<str>>(title: &str, rows: &[(N, String)], body: &mut String) {
    put(
        body,
        format_args!("<section><h2>{title}</h2>\n<table class=\"numbers\">\n"),
    );
    for (name, value) in rows {
        put(
            body,
            format_args!(
                "<tr><th>{}</th><td>{}</td></tr>\n",
                escape(name.as_ref()),
                escape(value)
            ),
        );
    }
    body.push_str("</table>\n");
}
