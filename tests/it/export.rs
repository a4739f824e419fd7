//! `steadfast export --format sdpa`: independent solvers find the same optimum.

use std::path::{Path, PathBuf};

use crate::support::solvers::{csdp, sdpa, Optimum};
use crate::support::*;
use tempfile::TempDir;

struct Exported {
    _folder: TempDir,
    path: PathBuf,
    text: String,
}

fn export(file: &Path, form: &str) -> Exported {
    let folder = folder();
    let path = folder.path().join("problem.dat-s");
    let run = command()
        .arg("export")
        .arg(file)
        .args(["--format", "sdpa", "--form", form, "-o"])
        .arg(&path)
        .output();
    Run::new(run.expect("the command runs")).ends_with(0);
    assert_eq!(names_in(folder.path()), ["problem.dat-s"]);
    Exported {
        text: text(&path),
        path,
        _folder: folder,
    }
}

impl Exported {
    /// What must be added to a solver's objective value.
    fn offset(&self) -> f64 {
        let offset = self
            .text
            .split("objective offset ")
            .nth(1)
            .expect("the offset");
        offset
            .lines()
            .next()
            .expect("a line")
            .parse()
            .expect("a number")
    }

    fn csdp(&self) -> Option<Optimum> {
        csdp(&self.path).map(|optimum| self.shifted(optimum))
    }

    fn sdpa(&self) -> Option<Optimum> {
        sdpa(&self.path).map(|optimum| self.shifted(optimum))
    }

    fn shifted(&self, optimum: Optimum) -> Optimum {
        Optimum {
            primal: optimum.primal + self.offset(),
            dual: optimum.dual + self.offset(),
        }
    }
}

/// The optimum that synthesis itself found, before it stepped back from the boundary.
fn own_optimum(design: &Path) -> f64 {
    let design = json(design);
    assert_eq!(
        design["provenance"]["solver_runs"][0]["goal"],
        "smallest gain"
    );
    number(&design, "/provenance/solver_runs/0/objective")
}

fn assert_csdp_agrees(model: &str, design: &Path) {
    let own = own_optimum(design);
    let mut found = Vec::new();
    for form in ["reduced", "full"] {
        let Some(optimum) = export(&shipped(model), form).csdp() else {
            return;
        };
        assert_relative(optimum.primal, own, 1e-4);
        assert_relative(optimum.dual, own, 1e-4);
        found.push(0.5 * (optimum.primal + optimum.dual));
    }
    assert_relative(found[0], found[1], 1e-5);
}

#[test]
fn csdp_finds_the_gain_of_xu2020_in_both_forms() {
    assert_csdp_agrees("xu2020.json", xu2020_design());
}

#[test]
fn csdp_finds_the_gain_of_the_double_integrator_in_both_forms() {
    assert_csdp_agrees("double-integrator.json", double_integrator_design());
}

#[test]
fn sdpa_finds_the_same_gains() {
    let files = [
        ("xu2020.json", xu2020_design()),
        ("double-integrator.json", double_integrator_design()),
    ];
    for (model, design) in files {
        let own = own_optimum(design);
        let Some(optimum) = export(&shipped(model), "reduced").sdpa() else {
            return;
        };
        assert_relative(optimum.primal, own, 1e-4);
        assert_relative(optimum.dual, own, 1e-4);
    }
}

#[test]
fn a_design_exports_the_problem_of_its_model() {
    let from_model = export(&shipped("xu2020.json"), "reduced");
    let from_design = export(xu2020_design(), "reduced");
    assert!(from_model.text == from_design.text);
}

#[test]
fn the_text_is_printed_without_an_output_path() {
    let model = shipped("double-integrator.json");
    let arguments = [
        Path::new("export"),
        &model,
        "--format".as_ref(),
        "sdpa".as_ref(),
    ];
    let run = steadfast(arguments).ends_with(0);
    assert_eq!(run.stdout, export(&model, "reduced").text);
}

#[test]
fn the_blocks_are_named_and_fit_the_header() {
    let exported = export(&shipped("double-integrator.json"), "full");
    let (comments, rest): (Vec<&str>, Vec<&str>) = exported
        .text
        .lines()
        .partition(|line| line.starts_with('"'));
    let named = comments
        .iter()
        .filter(|line| line.starts_with("\"block "))
        .count();
    let unknowns: usize = rest[0].parse().expect("the number of unknowns");
    let blocks: usize = rest[1].parse().expect("the number of blocks");
    assert_eq!(named, blocks);
    let sides: Vec<usize> = rest[2]
        .split(' ')
        .map(|side| side.parse().unwrap())
        .collect();
    assert_eq!(sides.len(), blocks);
    assert_eq!(rest[3].split(' ').count(), unknowns);
    for line in &rest[4..] {
        let entry: Vec<&str> = line.split(' ').collect();
        let [matrix, block, row, column] = [0, 1, 2, 3].map(|k| entry[k].parse::<usize>().unwrap());
        assert!(
            matrix <= unknowns && (1..=blocks).contains(&block),
            "{line}"
        );
        assert!(
            1 <= row && row <= column && column <= sides[block - 1],
            "{line}"
        );
        assert!(entry[4].parse::<f64>().unwrap().is_finite(), "{line}");
    }
}
