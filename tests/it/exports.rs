//! `steadfast export` to CSV, Parquet, MAT and C: other programs read back the same doubles.

mod basilisk;
mod c_abi;
mod flight;
mod flight_again;
mod fmu;
mod refused;

mod book;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use crate::support::tools::{compiled, python};
use crate::support::*;
use serde_json::{json, Value};
use tempfile::TempDir;

/// Numbers by name.
type Numbers = BTreeMap<String, Vec<f64>>;

fn export(file: &Path, format: &str, output: Option<&Path>) -> Run {
    let mut command = command();
    command.arg("export").arg(file).args(["--format", format]);
    if let Some(path) = output {
        command.arg("-o").arg(path);
    }
    Run::new(command.output().expect("the command runs"))
}

/// The numbers in a JSON value, last index fastest.
fn flat(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(entries) => entries.iter().flat_map(flat).collect(),
        number => vec![number.as_f64().expect("a number")],
    }
}

/// What every export of a design must hold, straight from the design file: the numbers of the law, and of a proved
/// design (status 0) those of the proof.
fn expected(design: &Path, status: i32) -> Numbers {
    let file = json(design);
    let mut out = Numbers::new();
    let (parts, specs): (&[&str], &[&str]) = match status {
        0 => (
            &["/controller", "/certificate"],
            &["phi_per_s", "hbar_s", "nu"],
        ),
        _ => (&["/controller"], &["hbar_s", "nu"]),
    };
    let parts = parts.iter().map(|part| file.pointer(part).expect("a part"));
    for (name, value) in parts.flat_map(|part| part.as_object().unwrap()) {
        match name.as_str() {
            "mismatch" => {}
            "final_bounds" => {
                out.insert("final_rate_rad_s".into(), flat(&value["rate_rad_s"]));
                out.insert("final_vector_part".into(), flat(&value["vector_part"]));
            }
            _ => {
                out.insert(name.clone(), flat(value));
            }
        }
    }
    for name in specs {
        out.insert(
            name.to_string(),
            vec![number(&file, &format!("/model/specs/{name}"))],
        );
    }
    let sides = file["certificate"]["mismatch"].as_array();
    let sides = sides.filter(|_| status == 0);
    for (index, side) in sides.into_iter().flatten().enumerate() {
        out.insert(
            format!("mismatch_bounds_{}", index + 1),
            flat(&side["bounds"]),
        );
        out.insert(
            format!("mismatch_common_{}", index + 1),
            flat(&side["common"]),
        );
    }
    out
}

#[track_caller]
fn assert_same_bits(found: &Numbers, expected: &Numbers) {
    for (name, values) in expected {
        let found = found
            .get(name)
            .unwrap_or_else(|| panic!("no '{name}' in {:?}", found.keys()));
        let bits = |values: &[f64]| values.iter().map(|v| v.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(found), bits(values), "{name}");
    }
}

/// A design whose gains are scheduled by seven local rules, made up of the numbers of another. It is not
/// proved.
fn scheduled_design() -> &'static Path {
    static DESIGN: OnceLock<(TempDir, PathBuf)> = OnceLock::new();
    let (_, path) = DESIGN.get_or_init(|| {
        let folder = folder();
        let mut file = json(xu2020_design());
        let gain = file["controller"]["gains"][0].clone();
        let scaled = |factor: f64| -> Value {
            let rows = gain.as_array().unwrap().iter();
            rows.map(|row| {
                let row = row.as_array().unwrap().iter();
                row.map(|v| json!(v.as_f64().unwrap() * factor)).collect()
            })
            .collect::<Vec<Value>>()
            .into()
        };
        let gains: Vec<Value> = (0..7)
            .map(|rule| scaled(1.0 + 0.01 * f64::from(rule)))
            .collect();
        let anti_windup = file["certificate"]["anti_windup"][0].clone();
        file["model"] = json(&shipped("xu2020-rules-scheduled.json"));
        set(&mut file, "/model/mismatch", json!({ "kappa": 0.0 }));
        set(&mut file, "/controller/gains", gains.into());
        set(
            &mut file,
            "/certificate/anti_windup",
            vec![anti_windup; 7].into(),
        );
        remove(&mut file, "/certificate/certified_vector_part");
        remove(&mut file, "/certificate/final_bounds");
        let path = write(folder.path(), "scheduled.json", file.to_string());
        (folder, path)
    });
    path
}

/// A run of 20 seconds.
fn run_folder() -> &'static Path {
    static RUN: OnceLock<TempDir> = OnceLock::new();
    let folder = RUN.get_or_init(|| {
        let folder = folder();
        let mut scenario = json(&shipped("wu2018.json"));
        scenario["duration_s"] = json!(20.0);
        scenario["metrics"]["tail_s"] = json!(5.0);
        let path = write(folder.path(), "short.json", scenario.to_string());
        let out = folder.path().join("run");
        let run = steadfast([Path::new("simulate"), &path, Path::new("-o"), &out]);
        assert!(matches!(run.status, Some(0 | 2)), "{run:#?}");
        folder
    });
    static PATH: OnceLock<PathBuf> = OnceLock::new();
    PATH.get_or_init(|| folder.path().join("run"))
}

/// The columns of a run's trajectory, parsed here.
fn trajectory() -> Numbers {
    let text = text(&run_folder().join("trajectory.csv"));
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let mut out: Vec<Vec<f64>> = vec![Vec::new(); names.len()];
    for line in lines {
        for (column, value) in out.iter_mut().zip(line.split(',')) {
            column.push(value.parse().expect("a number"));
        }
    }
    assert!(out[0].len() > 100, "{} rows", out[0].len());
    names.into_iter().map(str::to_string).zip(out).collect()
}

fn read_numbers(printed: &str) -> Numbers {
    let value: Value = serde_json::from_str(printed).expect("one JSON object");
    let entries = value.as_object().expect("an object").iter();
    entries
        .map(|(name, value)| (name.clone(), flat(value)))
        .collect()
}

#[test]
fn a_design_as_csv_holds_every_number_and_its_place() {
    for (design, status) in [(xu2020_design(), 0), (scheduled_design(), 2)] {
        let run = export(design, "csv", None).ends_with(status);
        let mut found = Numbers::new();
        let mut gains = BTreeMap::new();
        let mut reader = csv::Reader::from_reader(run.stdout.as_bytes());
        for record in reader.records() {
            let record = record.expect("a row");
            let [name, matrix, row, column, value] = [0, 1, 2, 3, 4].map(|k| record[k].to_string());
            if value.is_empty() {
                continue;
            }
            let value: f64 = value.parse().expect("a number");
            if name == "gains" {
                let place = [matrix, row, column].map(|k| k.parse::<usize>().unwrap());
                gains.insert(place, value);
            }
            found.entry(name).or_default().push(value);
        }
        let expected = expected(design, status);
        assert_same_bits(&found, &expected);
        let file = json(design);
        for ([matrix, row, column], value) in gains {
            let pointer = format!(
                "/controller/gains/{}/{}/{}",
                matrix - 1,
                row - 1,
                column - 1
            );
            assert_eq!(number(&file, &pointer).to_bits(), value.to_bits());
        }
        let verdict = if status == 0 { "proved" } else { "not_proved" };
        assert!(run.stdout.contains(&format!("\nverdict,,,,,,{verdict}\n")));
        // What is not proved claims and assumes nothing.
        for claim in ["gamma", "guaranteed_gain", "lyapunov"] {
            assert_eq!(found.contains_key(claim), status == 0, "{claim}");
        }
        assert_eq!(run.stdout.contains("\nassumption_1,"), status == 0);
    }
}

/// Prints the bits of every table of the header; `cast` is how C and C++ both spell the copy.
fn bits_program(header: &Path, prefix: &str, names: &Numbers) -> String {
    let mut out = format!(
        "#include <stdio.h>\n#include <string.h>\n#include \"{}\"\n\
         static void show(const char *name, const double *values, unsigned long count) {{\n\
         unsigned long i; unsigned k; unsigned char bytes[sizeof(double)];\n\
         printf(\"%s\", name);\n\
         for (i = 0; i < count; i++) {{\n memcpy(bytes, values + i, sizeof bytes);\n printf(\" \");\n\
         for (k = 0; k < sizeof bytes; k++) printf(\"%02x\", (unsigned)bytes[k]);\n}}\n\
         printf(\"\\n\");\n}}\n\
         int main(void) {{\nprintf(\"PROVED %d\\n\", {}_PROVED);\n",
        header.file_name().unwrap().to_str().unwrap(),
        prefix.to_uppercase(),
    );
    for name in names.keys() {
        let table = format!("{prefix}_{name}");
        out += &format!(
            "show(\"{name}\", (const double *)&{table}, (unsigned long)(sizeof {table} / sizeof(double)));\n"
        );
    }
    out + "return 0;\n}\n"
}

fn read_bits(printed: &str) -> (String, Numbers) {
    let mut lines = printed.lines();
    let proved = lines.next().expect("a line").to_string();
    let number = |word: &str| {
        let byte = |k: usize| u8::from_str_radix(&word[2 * k..2 * k + 2], 16).unwrap();
        f64::from_ne_bytes(std::array::from_fn(byte))
    };
    let numbers = lines.map(|line| {
        let mut words = line.split(' ');
        let name = words.next().unwrap().to_string();
        (name, words.map(number).collect())
    });
    (proved, numbers.collect())
}

#[test]
fn a_c_header_compiles_without_warnings_and_holds_the_same_bits() {
    let ways: [(&str, &[&str], &str); 5] = [
        ("gcc", &["-std=c99"], "c"),
        ("gcc", &["-std=c90"], "c"),
        ("g++", &["-std=c++98", "-Wno-long-long"], "cpp"),
        ("g++", &["-std=c++17"], "cpp"),
        ("clang", &["-std=c99"], "c"),
    ];
    let designs = [
        (xu2020_design(), "xu2020", 0),
        (scheduled_design(), "xu2020", 2),
        (double_integrator_design(), "double_integrator", 0),
    ];
    for (design, prefix, status) in designs {
        let folder = folder();
        let header = folder.path().join("gains.h");
        let run = export(design, "c", Some(&header)).ends_with(status);
        assert_eq!(run.stdout, "");
        let expected = expected(design, status);
        let program = bits_program(&header, prefix, &expected);
        for (compiler, options, ending) in ways {
            let source = write(folder.path(), &format!("main.{ending}"), &program);
            let Some(printed) = compiled(compiler, options, &source) else {
                continue;
            };
            let (proved, found) = read_bits(&printed);
            assert_eq!(proved, format!("PROVED {}", u8::from(status == 0)));
            assert_same_bits(&found, &expected);
        }
    }
}

#[test]
fn a_header_says_proved_only_of_a_design_that_is_proved_when_it_is_written() {
    let proved = export(xu2020_design(), "c", None).ends_with(0).stdout;
    assert!(proved.contains("PROVED: every condition") && !proved.contains("NOT PROVED"));
    assert!(proved.contains("#define XU2020_PROVED 1\n"));
    // The file's own verdict is not trusted.
    let folder = folder();
    let mut file = json(xu2020_design());
    assert_eq!(file["verdict"]["verdict"], "proved");
    let gain = number(&file, "/controller/gains/0/0/0");
    set(&mut file, "/controller/gains/0/0/0", json!(-gain));
    let path = write(folder.path(), "broken.json", file.to_string());
    for format in ["c", "csv"] {
        let run = export(&path, format, None).ends_with(2);
        assert!(run.stderr.contains("NOT PROVED"), "{run:#?}");
        assert!(run.stdout.contains(if format == "c" {
            "NOT PROVED"
        } else {
            "not_proved"
        }));
        assert!(!run.stdout.contains("PROVED: every"));
        assert!(!run.stdout.contains("_PROVED 1"));
    }
}

#[test]
fn a_hostile_name_stays_inside_its_comment() {
    let folder = folder();
    let mut file = json(double_integrator_design());
    let evil = "*/ #error no /* ??/ \\ naïve // \u{202e}";
    set(&mut file, "/name", json!(evil));
    set(&mut file, "/model/source", json!(evil));
    let path = write(folder.path(), "evil.json", file.to_string());
    let header = folder.path().join("evil.h");
    export(&path, "c", Some(&header)).ends_with(0);
    let program = bits_program(&header, "error_no_na_ve", &expected(&path, 0));
    let source = write(folder.path(), "main.c", &program);
    if let Some(printed) = compiled("gcc", &["-std=c99"], &source) {
        assert_same_bits(&read_bits(&printed).1, &expected(&path, 0));
    }
}

const MAT_SCRIPT: &str = "
import json, sys
import numpy as np, scipy.io
data = scipy.io.loadmat(sys.argv[1], chars_as_strings=True)
out, shapes = {}, {}
for name, value in data.items():
    if name.startswith('__') or value.dtype.kind != 'f':
        continue
    # First index of several matrices last, as in MATLAB; the file's own order for the comparison.
    shapes[name] = list(value.shape)
    out[name] = (value.transpose(2, 0, 1) if value.ndim == 3 else value).ravel().tolist()
about = {key: str(data['provenance'][key][0, 0][0]) for key in data['provenance'].dtype.names}
units = {key: str(data['units'][key][0, 0][0]) for key in data['units'].dtype.names}
print(json.dumps([out, shapes, about, units]))
";

#[test]
fn scipy_reads_a_designs_mat_file() {
    for (design, status, gains) in [
        (xu2020_design(), 0, json!([3, 6])),
        (scheduled_design(), 2, json!([3, 6, 7])),
    ] {
        let folder = folder();
        let path = folder.path().join("design.mat");
        export(design, "mat", Some(&path)).ends_with(status);
        let Some(printed) = python(&["scipy.io"], MAT_SCRIPT, &[&path]) else {
            return;
        };
        let read: Value = serde_json::from_str(&printed).expect("JSON");
        assert_same_bits(
            &read_numbers(&read[0].to_string()),
            &expected(design, status),
        );
        assert_eq!(read[1]["gains"], gains);
        assert_eq!(read[1]["torque_limit_nm"], json!([3, 1]));
        assert_eq!(read[0]["proved"], json!([f64::from(u8::from(status == 0))]));
        let verdict = if status == 0 { "proved" } else { "not_proved" };
        assert_eq!(read[2]["verdict"], verdict);
        assert_eq!(
            read[2]["model_sha256"],
            json(design)["provenance"]["model_sha256"]
        );
        assert_eq!(read[3]["torque_limit_nm"], "N m");
    }
}

#[test]
fn scipy_reads_a_trajectorys_mat_file() {
    let folder = folder();
    let path = folder.path().join("run.mat");
    export(run_folder(), "mat", Some(&path)).ends_with(0);
    let Some(printed) = python(&["scipy.io"], MAT_SCRIPT, &[&path]) else {
        return;
    };
    let read: Value = serde_json::from_str(&printed).expect("JSON");
    let expected = trajectory();
    assert_same_bits(&read_numbers(&read[0].to_string()), &expected);
    assert_eq!(read[1]["time_s"], json!([expected["time_s"].len(), 1]));
    let summary = json(&run_folder().join("summary.json"));
    assert_eq!(read[2]["scenario"], summary["scenario"]);
    assert_eq!(read[2]["source"], summary["source"]);
    assert_eq!(
        read[2]["scenario_sha256"],
        summary["provenance"]["scenario_sha256"]
    );
    assert_eq!(read[3]["rate_1_rad_s"], "rad/s");
}

#[test]
fn pandas_reads_a_trajectory_as_parquet() {
    let folder = folder();
    let path = folder.path().join("run.parquet");
    export(run_folder(), "parquet", Some(&path)).ends_with(0);
    let script = "
import json, sys
import pandas as pd, pyarrow.parquet as pq
frame = pd.read_parquet(sys.argv[1])
schema = pq.read_schema(sys.argv[1])
about = {k.decode(): v.decode() for k, v in pq.read_metadata(sys.argv[1]).metadata.items() if k != b'ARROW:schema'}
units = {f.name: (f.metadata or {}).get(b'unit', b'').decode() for f in schema}
print(json.dumps([{c: frame[c].tolist() for c in frame}, about, units]))
";
    let Some(printed) = python(&["pandas", "pyarrow"], script, &[&path]) else {
        return;
    };
    let read: Value = serde_json::from_str(&printed).expect("JSON");
    assert_same_bits(&read_numbers(&read[0].to_string()), &trajectory());
    let summary = json(&run_folder().join("summary.json"));
    assert_eq!(read[1]["controller"], summary["controller"]);
    assert_eq!(read[1]["generator"], summary["provenance"]["generator"]);
    assert_eq!(read[2]["torque_1_nm"], "N m");
    assert_eq!(read[2]["time_s"], "s");
}

#[test]
fn pandas_reads_csv_exactly() {
    let folder = folder();
    let path = folder.path().join("run.csv");
    export(run_folder(), "csv", Some(&path)).ends_with(0);
    assert_eq!(text(&path), text(&run_folder().join("trajectory.csv")));
    let script = "
import json, sys
import warnings
import pandas as pd
warnings.simplefilter('ignore')
try:
    frame = pd.read_csv(sys.argv[1], float_precision='round_trip')
except TypeError:
    frame = pd.read_csv(sys.argv[1])
print(json.dumps({c: frame[c].tolist() for c in frame}))
";
    if let Some(printed) = python(&["pandas"], script, &[&path]) {
        assert_same_bits(&read_numbers(&printed), &trajectory());
    }
}

#[test]
fn the_same_file_gives_the_same_bytes() {
    let folder = folder();
    for (file, format) in [
        (xu2020_design(), "mat"),
        (run_folder(), "mat"),
        (run_folder(), "parquet"),
    ] {
        let bytes = ["a", "b"].map(|name| {
            let path = folder.path().join(format!("{name}.{format}"));
            export(file, format, Some(&path)).ends_with(0);
            std::fs::read(path).expect("a file")
        });
        assert!(bytes[0] == bytes[1], "{format}");
    }
}
