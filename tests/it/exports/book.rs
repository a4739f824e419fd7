//! The exports' page of the book: its Python runs, and its header is the one written.

use super::*;

/// The fenced blocks of the book's page, in order: (language, text).
fn blocks(page: &str) -> Vec<(String, String)> {
    let text = text(&repository().join("docs/src").join(page));
    let parts: Vec<&str> = text.split("```").collect();
    let fenced = parts.iter().skip(1).step_by(2);
    let split = fenced.filter_map(|block| block.split_once('\n'));
    split
        .map(|(language, text)| (language.to_string(), text.to_string()))
        .collect()
}

#[cfg(unix)]
#[test]
fn the_python_of_the_book_runs() {
    let modules = ["pandas", "pyarrow", "matplotlib", "scipy"];
    if python(&modules, "pass", &[]).is_none() {
        return;
    }
    let desk = folder();
    std::os::unix::fs::symlink(repository().join("models"), desk.path().join("models")).unwrap();
    let mut scripts = 0;
    for (language, text) in blocks("exports.md") {
        let commands = text
            .lines()
            .filter_map(|line| line.strip_prefix("$ steadfast "));
        for arguments in commands.filter(|_| language == "console") {
            let run = command()
                .args(arguments.split(' '))
                .current_dir(desk.path())
                .output()
                .expect("the command runs");
            Run::new(run).ends_with(0);
        }
        if language == "python" {
            let here = format!("import os, sys; os.chdir(sys.argv[1])\n{text}");
            python(&modules, &here, &[desk.path()]).expect("Python is there");
            scripts += 1;
        }
    }
    assert_eq!(scripts, 5);
    for figure in ["error.png", "bands.png"] {
        let bytes = std::fs::read(desk.path().join(figure)).expect("a figure");
        assert!(
            bytes.starts_with(b"\x89PNG") && bytes.len() > 2000,
            "{figure}"
        );
    }
}

#[cfg(unix)]
#[test]
fn the_header_of_the_book_is_the_one_that_is_written() {
    let written = export(double_integrator_design(), "c", None)
        .ends_with(0)
        .stdout;
    let blocks = blocks("exports.md");
    let shown = blocks
        .iter()
        .find(|(language, _)| language == "c")
        .expect("a block");
    assert!(written.contains(&shown.1), "{written}");
}
