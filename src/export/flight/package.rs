//! The files that an exported controller consists of.

use std::fmt::Write;

use super::source::{Measurement, Precision, Source};
use super::vectors::{Sample, Vectors};
use super::{frameworks as templates, matlab};
use crate::base::provenance::sha256_of;
use crate::export::c_text::comment;

const TEST: &str = include_str!("templates/test.c");
const TEST_SINGLE: &str = include_str!("templates/test_single.c");
const EXAMPLE: &str = include_str!("templates/example_main.c");
const CMAKE: &str = include_str!("templates/CMakeLists.txt");
const CONFIG: &str = include_str!("templates/config.cmake.in");
const PKG_CONFIG: &str = include_str!("templates/package.pc.in");
const README: &str = include_str!("templates/README.txt");

/// Largest difference of a command to the reference over its limit, where functions of the C library take part whose last
/// bits are not prescribed.
const LIBRARY_TOLERANCE: f64 = 1e-9;

/// Name of the list of digests.
pub const DIGESTS: &str = "SHA256SUMS";

/// What the README says of single precision.
const SINGLE: &str = "The controller computes in float, but for the time, in the order in which the reference computes in doubles. The
  test prints the largest difference of a command and how many decisions of the trigger are other ones. It fails where a
  command is off by more than a thousandth of its limit, or two decisions in a hundred differ.";

/// What the README says of a fault that the controller is given.
const FAULT: &str = "
Fault
  This controller does not estimate the lumped fault. @name@_set_fault gives it the value to use (N m), zero until then. The
  templates for F Prime, cFS and Simulink, the MEX function and the functional mock-up unit do not call it.
";

/// A file of a package.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PackageFile {
    /// Its name.
    pub name: String,
    /// Its text.
    pub text: String,
}

/// Files that make a controller with its test.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Package {
    /// The files.
    pub files: Vec<PackageFile>,
}

impl Package {
    /// A controller with its reference vectors.
    pub fn new(source: &Source, vectors: &Vectors) -> Self {
        let name = &source.name;
        let marked = |text: &str| comment(&[source.about_file()]) + &source.filled(text);
        let hashed = |text: &str| format!("# {}\n{}", source.about_file(), source.filled(text));
        let is_double = source.precision == Precision::Double;
        let test = marked(if is_double { TEST } else { TEST_SINGLE });
        let files = [
            (format!("{name}.h"), source.header()),
            (format!("{name}.c"), source.source()),
            (format!("{name}_vectors.h"), vectors_header(source, vectors)),
            (format!("{name}_test.c"), test),
            (
                "example_main.c".to_string(),
                source.in_precision(&marked(EXAMPLE)),
            ),
            ("CMakeLists.txt".to_string(), hashed(CMAKE)),
            (format!("{name}-config.cmake.in"), hashed(CONFIG)),
            (format!("{name}.pc.in"), hashed(PKG_CONFIG)),
            ("README.txt".to_string(), readme(source)),
        ];
        // What other programs call takes doubles.
        let around = is_double.then(|| [matlab::files(source), templates::files(source)]);
        let around = around.into_iter().flatten().flatten();
        let mut files: Vec<_> = files
            .into_iter()
            .chain(around)
            .map(|(name, text)| PackageFile { name, text })
            .collect();
        files.push(digests(source, &files));
        Package { files }
    }

    /// The text of a file of this name.
    pub fn text_of(&self, name: &str) -> Option<&str> {
        let file = self.files.iter().find(|file| file.name == name);
        file.map(|file| file.text.as_str())
    }
}

/// The list of digests, as sha256sum reads it.
fn digests(source: &Source, files: &[PackageFile]) -> PackageFile {
    let line = |file: &PackageFile| format!("{}  {}\n", sha256_of(&file.text), file.name);
    let lines: String = files.iter().map(line).collect();
    PackageFile {
        name: DIGESTS.to_string(),
        text: format!("# {}\n{lines}", source.about_file()),
    }
}

/// What the README says of the templates for frameworks.
fn frameworks(source: &Source) -> &'static str {
    match source.measurement {
        Measurement::Attitude => {
            "  *.fpp, *Controller.hpp/.cpp, @name@_cfs_app.c
                           templates for F Prime and for the core Flight System
"
        }
        Measurement::State => "",
    }
}

/// What the README says of the other programs.
fn other_programs(source: &Source) -> String {
    match source.precision {
        Precision::Double => {
            "  @name@_mex.c, @name@_simulink.c, @name@_simulink.h, *.m
                           for MATLAB, Octave and Simulink: begin with @name@_test_vectors.m
"
            .to_string()
                + frameworks(source)
        }
        Precision::Single => String::new(),
    }
}

fn readme(source: &Source) -> String {
    let library = match source.precision {
        Precision::Single => SINGLE.to_string(),
        Precision::Double => library(source),
    };
    let contraction = match (source.precision, source.library.is_empty()) {
        (Precision::Double, true) => "the test then fails, and says why.",
        _ => "the test says so only where they differ by more than it allows.",
    };
    let fault = match source.given_fault {
        true => FAULT,
        false => "",
    };
    let about: Vec<&str> = source.about.iter().map(String::as_str).collect();
    let text = README
        .replace("@contraction@", contraction)
        .replace("@sampling@", &source.sampling)
        .replace("@fault@", fault)
        .replace("@about@", &about.join("\n"))
        .replace("@library@", &library)
        .replace("@other_programs@", &other_programs(source));
    source.filled(&text)
}

/// What the README says of the bits of the commands.
fn library(source: &Source) -> String {
    match source.library.as_slice() {
        [] => "The controller calls no function of the C library but sqrt and fabs, whose results are prescribed to the last \
               bit. The test compares every bit."
            .to_string(),
        names => format!(
            "The controller calls {} of the C library, whose last bits are not prescribed. The test allows commands that \
             differ by {LIBRARY_TOLERANCE:e} of their limit.",
            names.join(", ")
        ),
    }
}

/// The vectors as bits, so that no conversion of decimals takes part.
fn vectors_header(source: &Source, Vectors(samples): &Vectors) -> String {
    let given = samples.first().map_or(0, |sample| sample.given.len());
    let tolerance = match source.library.is_empty() {
        true => 0.0,
        false => LIBRARY_TOLERANCE,
    };
    let mut out = comment(&[
        source.about_file(),
        "Samples and the answers of the reference, as the bits of doubles: time (s), measurement; command.".to_string(),
    ]);
    // Writing to a string cannot fail.
    let _ = write!(
        out,
        "#ifndef STEADFAST_@NAME@_VECTORS_H\n#define STEADFAST_@NAME@_VECTORS_H\n\n#include \"@name@.h\"\n\n#include <stdint.h>\n\n\
         #define @NAME@_SAMPLES {}\n#define @NAME@_GIVEN {given}\n#define @NAME@_TOLERANCE {tolerance:e}\n",
        samples.len()
    );
    let numbers = |row: fn(&Sample) -> &[f64]| {
        let rows = samples.iter().map(move |sample| bits(row(sample)));
        rows.collect::<Vec<_>>().join(",\n    ")
    };
    let tables = [
        ("given", "@NAME@_GIVEN", numbers(|sample| &sample.given)),
        (
            "commands",
            "@NAME@_INPUTS",
            numbers(|sample| &sample.command),
        ),
        (
            "received",
            "@NAME@_INPUTS",
            numbers(|sample| &sample.received),
        ),
    ];
    for (name, width, rows) in tables {
        let _ = write!(
            out,
            "\nstatic const uint64_t @name@_{name}[@NAME@_SAMPLES][{width}] = {{\n    {rows}\n}};\n"
        );
    }
    let flags: Vec<String> = samples
        .iter()
        .map(|one| {
            let bit = |flag: bool| u8::from(flag);
            format!(
                "{{{}U, {}U, {}U}}",
                bit(one.sent),
                one.status,
                bit(one.arrives)
            )
        })
        .collect();
    let _ = write!(
        out,
        "\n/* Whether it is sent; the status; whether a transmission at this sample arrives. */\n\
         static const uint8_t @name@_flags[@NAME@_SAMPLES][3] = {{\n    {}\n}};\n\n#endif\n",
        flags.join(",\n    ")
    );
    source.filled(&out)
}

fn bits(row: &[f64]) -> String {
    let words = row
        .iter()
        .map(|value| format!("UINT64_C(0x{:016x})", value.to_bits()));
    format!("{{{}}}", words.collect::<Vec<_>>().join(", "))
}
