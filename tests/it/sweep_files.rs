//! `steadfast sweep`: the table as Parquet, and the page.

use std::path::Path;
use std::process::Command;

use crate::support::sweeps::{scenario, sweep, Rows};
use crate::support::*;
use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, Int64Type};
use arrow_array::{Array, RecordBatch};
use arrow_schema::DataType;
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;

/// The only row group and the file's own texts.
fn parquet(folder: &Path) -> (RecordBatch, Vec<(String, String)>) {
    let file = std::fs::File::open(folder.join("sweep.parquet")).expect("a file");
    let builder = ParquetRecordBatchReaderBuilder::try_new(file).expect("Parquet");
    let about = builder.metadata().file_metadata().key_value_metadata();
    let about = about.expect("texts").iter();
    let about = about.map(|pair| (pair.key.clone(), pair.value.clone().unwrap_or_default()));
    let about = about.collect();
    let mut batches: Vec<_> = builder.build().expect("a reader").collect();
    assert_eq!(batches.len(), 1);
    (batches.remove(0).expect("rows"), about)
}

/// An entry as the comma-separated values have it.
fn entry(batch: &RecordBatch, column: usize, row: usize) -> String {
    let array = batch.column(column);
    if array.is_null(row) {
        return String::new();
    }
    match array.data_type() {
        DataType::Float64 => array.as_primitive::<Float64Type>().value(row).to_string(),
        DataType::Int64 => array.as_primitive::<Int64Type>().value(row).to_string(),
        DataType::Utf8 => array.as_string::<i32>().value(row).to_string(),
        other => panic!("{other}"),
    }
}

/// A sweep of a model with a point of each kind: proved, infeasible, not valid.
fn model_sweep(folder: &Path) -> std::path::PathBuf {
    let output = folder.join("model");
    let file = shipped("double-integrator.json");
    let vary = ["phi=0.1,0.2,50", "nu=0.05,1.5"];
    sweep(&file, &vary, &output, &[]).ends_with(0);
    output
}

#[test]
fn parquet_holds_the_numbers_of_the_table_with_types_units_and_provenance() {
    let folder = folder();
    let model = model_sweep(folder.path());
    let runs = folder.path().join("runs");
    let file = scenario(folder.path());
    sweep(&file, &["relative=0.4,1.5,0.6"], &runs, &[]).ends_with(0);
    for output in [&model, &runs] {
        let rows = Rows::read(output);
        let (batch, about) = parquet(output);
        assert_eq!(batch.num_rows(), rows.rows.len());
        let schema = batch.schema();
        let names: Vec<_> = schema.fields().iter().map(|field| field.name()).collect();
        assert_eq!(names, rows.columns.iter().collect::<Vec<_>>());
        for (row, cells) in rows.rows.iter().enumerate() {
            for (column, cell) in cells.iter().enumerate() {
                assert_eq!(&entry(&batch, column, row), cell, "{}", names[column]);
            }
        }
        let provenance = json(&output.join("sweep.json"));
        for key in ["generator", "file", "file_sha256", "kind"] {
            let text = provenance[key].as_str().expect("a text");
            assert!(
                about.contains(&(key.to_string(), text.to_string())),
                "{key}"
            );
        }
        let axes = about.iter().find(|(key, _)| key == "axes").expect("axes");
        assert_eq!(
            serde_json::from_str::<serde_json::Value>(&axes.1).unwrap(),
            provenance["axes"]
        );
    }
    let (batch, _) = parquet(&runs);
    let schema = batch.schema();
    let field = |name: &str| schema.field_with_name(name).expect("a column").clone();
    assert_eq!(field("triggers").data_type(), &DataType::Int64);
    assert_eq!(field("impulse").data_type(), &DataType::Float64);
    assert_eq!(field("impulse").metadata()["unit"], "N m s");
    assert_eq!(field("final_error_deg").metadata()["unit"], "deg");
}

#[test]
fn pandas_reads_the_parquet_file() {
    let folder = folder();
    let model = model_sweep(folder.path());
    let script = "import sys, pandas, pyarrow.parquet\n\
        t = pandas.read_parquet(sys.argv[1])\n\
        m = pyarrow.parquet.read_schema(sys.argv[1])\n\
        print(len(t), t['gamma'].dtype, t['gamma'].count(), m.metadata[b'kind'].decode(), \
        m.field('specs.phi_per_s').metadata[b'unit'].decode())\n";
    let run = Command::new("python3")
        .args(["-c", script])
        .arg(model.join("sweep.parquet"))
        .output();
    match run {
        Ok(run) if run.status.success() => {
            let text = String::from_utf8_lossy(&run.stdout).into_owned();
            assert_eq!(text.trim(), "6 float64 2 model 1/s");
        }
        Ok(run) if !String::from_utf8_lossy(&run.stderr).contains("ModuleNotFoundError") => {
            panic!("{}", String::from_utf8_lossy(&run.stderr));
        }
        _ => eprintln!("SKIPPED: python3 with pandas and pyarrow is not installed"),
    }
}

/// What makes a page ask for something else.
fn assert_self_contained(page: &str) {
    let free = page.replace("http://www.w3.org/2000/svg", "");
    for part in [
        "http:", "https:", "<link", "<script", "<img", "@import", "url(",
    ] {
        assert!(!free.contains(part), "{part}");
    }
    assert_eq!(page.matches("<svg").count(), page.matches("</svg>").count());
    assert!(page.contains("prefers-color-scheme: dark"));
    assert!(page.contains("@media print"));
}

#[test]
fn the_page_of_a_model_has_maps_curves_and_every_reason() {
    let folder = folder();
    let output = model_sweep(folder.path());
    let page = text(&output.join("sweep.html"));
    assert_self_contained(&page);
    assert!(page.contains("2 of 6 points are proved."));
    let rows = Rows::read(&output);
    let reasons = (0..6).map(|row| rows.text(row, "reason"));
    let reasons: Vec<_> = reasons.filter(|reason| !reason.is_empty()).collect();
    assert_eq!(reasons.len(), 4);
    for reason in reasons {
        let reason = reason.replace('<', "&lt;").replace('>', "&gt;");
        assert!(page.contains(&reason.replace('"', "&quot;")), "{reason}");
    }
    for part in [
        "<figcaption>Feasibility</figcaption>",
        "<figcaption>gamma</figcaption>",
        "<figcaption>gamma against phi (1/s)</figcaption>",
    ] {
        assert!(page.contains(part), "{part}");
    }
    // A model given by vertices has no certified angle.
    assert!(!page.contains("Trade-off"));
}

#[test]
fn the_page_of_a_spacecraft_marks_the_front() {
    let folder = folder();
    let output = folder.path().join("out");
    let file = shipped("small-spacecraft.json");
    let more = ["--solver", "structured"];
    sweep(&file, &["phi=0.02,0.05"], &output, &more).ends_with(0);
    let page = text(&output.join("sweep.html"));
    assert_self_contained(&page);
    assert!(page.contains("gamma against certified angle"));
    let rows = Rows::read(&output);
    let at = |row| {
        assert_eq!(rows.text(row, "verdict"), "proved");
        let name = "certified_angle_deg";
        (rows.number(row, name), rows.number(row, "gamma"))
    };
    let (a, b) = (at(0), at(1));
    let beaten = (a.0 <= b.0 && a.1 >= b.1) || (b.0 <= a.0 && b.1 >= a.1);
    let expected = if beaten { 1 } else { 2 };
    assert_eq!(page.matches("<tr class=\"front\">").count(), expected);
}

#[test]
fn the_page_of_a_scenario_has_each_metric_that_changes_against_the_axis() {
    let folder = folder();
    let output = folder.path().join("out");
    let file = scenario(folder.path());
    sweep(&file, &["relative=0.3:0.7:4"], &output, &[]).ends_with(0);
    let page = text(&output.join("sweep.html"));
    assert_self_contained(&page);
    assert!(page.contains("<figcaption>triggers against relative</figcaption>"));
    assert!(page.contains("The same at every point: "));
    assert!(!page.contains("<h2>Feasibility</h2>"));
}
