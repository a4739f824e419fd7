//! The controller for MATLAB, Octave and Simulink.

use super::source::{Constant, Measurement, Source};
use crate::export::c_text::{comment, constant as number};

const MEX: &str = include_str!("templates/mex.c");
const BLOCK: &str = include_str!("templates/simulink.c");
const BLOCK_HEADER: &str = include_str!("templates/simulink.h");
const LEGACY_CODE: &str = include_str!("templates/legacy_code.m");
const TEST: &str = include_str!("templates/test_vectors.m");
/// The end of every law to read.
const COMMON: &str = include_str!("templates/reference_common.m");

/// What each measurement makes of the texts.
struct Places {
    mex_count: &'static str,
    mex_read: &'static str,
    legacy_inputs: &'static str,
    from_row: &'static str,
}

const OF_ATTITUDE: Places = Places {
    mex_count: "5",
    mex_read: "    const double *error_quaternion = numbers(argument[3], 4U, \"the error quaternion must be 4 doubles\");
    const double *rate_rad_s = numbers(argument[4], 3U, \"the rate must be 3 doubles (rad/s)\");",
    legacy_inputs: "double u2[4], double u3[3]",
    from_row: "[given{2:5}], [given{6:8}]",
};

const OF_STATE: Places = Places {
    mex_count: "4",
    mex_read: "    const double *state_measured = numbers(argument[3], @NAME@_STATES, \"the state must be @states@ doubles\");",
    legacy_inputs: "double u2[@states@]",
    from_row: "[given{2:end}]",
};

/// The files, by name.
pub fn files(source: &Source) -> Vec<(String, String)> {
    let name = &source.name;
    let in_c = |text: &str| comment(&[source.about_file()]) + &filled(source, text);
    let mut out = vec![
        (format!("{name}_mex.c"), in_c(MEX)),
        (format!("{name}_simulink.c"), in_c(BLOCK)),
        (format!("{name}_simulink.h"), in_c(BLOCK_HEADER)),
        (format!("{name}_legacy_code.m"), filled(source, LEGACY_CODE)),
        (format!("{name}_test_vectors.m"), filled(source, TEST)),
    ];
    let readable = source.in_matlab.map(|law| format!("{law}\n{COMMON}"));
    out.extend(readable.map(|text| (format!("{name}_reference.m"), filled(source, &text))));
    out
}

/// A text with what is MATLAB's filled in, then the rest.
fn filled(source: &Source, text: &str) -> String {
    let places = match source.measurement {
        Measurement::Attitude => OF_ATTITUDE,
        Measurement::State => OF_STATE,
    };
    let limits: Vec<String> = source.limits().iter().map(|&value| number(value)).collect();
    let (compared, compare) = match source.in_matlab {
        Some(_) => (
            "@name@_reference and, where it is built, @name@_mex",
            "    reference = @name@_reference();
    compare('@name@_reference', expected, limits, reference.init(), reference.step);
",
        ),
        None => ("@name@_mex, where it is built,", ""),
    };
    let text = text
        .replace("@mex_count@", places.mex_count)
        .replace("@mex_read@", places.mex_read)
        .replace("@legacy_inputs@", places.legacy_inputs)
        .replace("@m_from_row@", places.from_row)
        .replace("@limits@", &limits.join(", "))
        .replace("@compared@", compared)
        .replace("@compare_reference@", compare)
        .replace("@constants_m@", &constants(source));
    source.filled(&text)
}

/// The constants as fields of a structure.
fn constants(source: &Source) -> String {
    let numbers = source.constants.iter().map(one);
    let counts = source.counts.iter();
    let counts = counts.map(|(name, count)| format!("    c.{name} = {count};"));
    numbers.chain(counts).collect::<Vec<_>>().join("\n")
}

/// A constant; of several matrices the last index is that of the matrix.
fn one(constant: &Constant) -> String {
    let name = constant.variable;
    let values = &constant.numbers.values;
    let row = |row: &[f64]| {
        row.iter()
            .map(|&value| number(value))
            .collect::<Vec<_>>()
            .join(", ")
    };
    let matrix = |values: &[f64], columns: usize| {
        let rows: Vec<String> = values.chunks(columns.max(1)).map(row).collect();
        format!("[\n        {}]", rows.join(";\n        "))
    };
    match *constant.numbers.shape.as_slice() {
        [] => format!("    c.{name} = {};", row(values)),
        [_] => format!("    c.{name} = [{}];", row(values)),
        [_, columns] => format!("    c.{name} = {};", matrix(values, columns)),
        _ => {
            let [_, rows, columns] = constant.numbers.extent();
            let parts = values.chunks((rows * columns).max(1)).enumerate();
            let parts = parts.map(|(index, part)| {
                format!(
                    "    c.{name}(:, :, {}) = {};",
                    index + 1,
                    matrix(part, columns)
                )
            });
            parts.collect::<Vec<_>>().join("\n")
        }
    }
}
