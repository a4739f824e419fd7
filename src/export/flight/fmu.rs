//! The controller as a functional mock-up unit: FMI 2.0 for co-simulation, as sources.

use std::io::{Cursor, Write};

use zip::result::ZipResult;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use super::source::{Measurement, Source};
use crate::base::provenance::{sha256_of, GENERATOR};
use crate::export::c_text::comment;

const GLUE: [&str; 2] = [
    include_str!("templates/fmu.c"),
    include_str!("templates/fmu_rest.c"),
];
const DESCRIPTION: &str = include_str!("templates/modelDescription.xml");

const UNITS: &str = "
  <UnitDefinitions>
    <Unit name=\"rad/s\"><BaseUnit s=\"-1\" rad=\"1\"/></Unit>
    <Unit name=\"N.m\"><BaseUnit kg=\"1\" m=\"2\" s=\"-2\"/></Unit>
  </UnitDefinitions>
";

/// Value reference of the first command; those of the measurement begin with 0.
const FIRST_COMMAND: usize = 1000;

/// Place of the first command among the variables, counted from 1: after whether, status and count.
const FIRST_INDEX: usize = 4;

/// The bytes of the unit: a zip file that is the same for the same controller.
///
/// # Errors
/// A file above the size that the format allows.
pub fn unit(source: &Source) -> ZipResult<Vec<u8>> {
    let name = &source.name;
    let (header, text) = (source.header(), source.source());
    let glue = comment(&[source.about_file()]) + &of_source(source, &GLUE.join("\n"));
    let description = of_source(source, DESCRIPTION);
    // The same text in both files: one of the other's is refused.
    let guid = guid(
        &[&description, &glue, &header, &text]
            .map(String::as_str)
            .concat(),
    );
    let named = |text: &str| text.replace("@guid@", &guid);
    let files = [
        ("modelDescription.xml".to_string(), named(&description)),
        (format!("sources/{name}.h"), header),
        (format!("sources/{name}.c"), text),
        (format!("sources/{name}_fmu.c"), named(&glue)),
    ];
    let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
    let stored = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    for (name, text) in files {
        zip.start_file(name, stored)?;
        zip.write_all(text.as_bytes())?;
    }
    Ok(zip.finish()?.into_inner())
}

/// 128 bits of a text's digest, as a unique identifier is written.
fn guid(text: &str) -> String {
    let digest = sha256_of(text);
    let parts: Vec<&str> = [(0, 8), (8, 12), (12, 16), (16, 20), (20, 32)]
        .iter()
        .filter_map(|&(from, to)| digest.get(from..to))
        .collect();
    format!("{{{}}}", parts.join("-"))
}

/// A text of the unit with everything but its identifier.
fn of_source(source: &Source, text: &str) -> String {
    let [states, inputs] = source.sizes;
    let is_attitude = source.measurement == Measurement::Attitude;
    let unknowns =
        (0..inputs).map(|index| format!("      <Unknown index=\"{}\"/>\n", FIRST_INDEX + index));
    let text = text
        .replace("@given@", &source.measurement.count(states).to_string())
        .replace("@first_input@", if is_attitude { "1.0" } else { "0.0" })
        .replace("@unit_definitions@", if is_attitude { UNITS } else { "" })
        .replace("@command_variables@", &commands(source))
        .replace("@measurement_variables@", &measurements(source))
        .replace("@command_unknowns@", &unknowns.collect::<String>())
        .replace("@title@", &escaped(&source.title))
        .replace("@description@", source.proved_text())
        .replace("@generator@", GENERATOR)
        // Two hyphens end a comment of XML.
        .replace(
            "<!-- @about_file@ -->",
            &format!("<!-- {} -->", source.about_file().replace("--", "- -")),
        );
    source.filled(&text)
}

/// Text inside of an attribute.
fn escaped(text: &str) -> String {
    let plain = text.chars().filter(|c| !c.is_control());
    let escaped = plain.map(|c| match c {
        '&' => "&amp;".to_string(),
        '<' => "&lt;".to_string(),
        '>' => "&gt;".to_string(),
        '"' => "&quot;".to_string(),
        c => c.to_string(),
    });
    escaped.collect()
}

/// The commands as outputs.
fn commands(source: &Source) -> String {
    let (unit, meaning) = match source.measurement {
        Measurement::Attitude => (" unit=\"N.m\"", "torque about a body axis"),
        Measurement::State => ("", "input of the plant"),
    };
    let name = source.command.name;
    let one = |(index, limit): (usize, &f64)| {
        format!(
            "    <ScalarVariable name=\"{name}[{index}]\" valueReference=\"{}\" causality=\"output\" variability=\"discrete\" \
             initial=\"calculated\"\n      description=\"{meaning}\">\n      <Real{unit} min=\"-{limit}\" max=\"{limit}\"/>\n    \
             </ScalarVariable>\n",
            FIRST_COMMAND + index
        )
    };
    source.limits().iter().enumerate().map(one).collect()
}

/// The measurement as inputs.
fn measurements(source: &Source) -> String {
    let [states, _] = source.sizes;
    let quaternion = "attitude against the desired one, scalar part first, norm 1; the laws of Wu and Lei follow its sign";
    let groups = match source.measurement {
        Measurement::Attitude => vec![
            ("error_quaternion", 4, "", quaternion),
            (
                "rate_rad_s",
                3,
                " unit=\"rad/s\"",
                "rate error about a body axis",
            ),
        ],
        Measurement::State => vec![("state", states, "", "state of the plant")],
    };
    let variables = groups.iter().flat_map(|&(name, count, unit, meaning)| {
        (0..count).map(move |index| (name, index, unit, meaning))
    });
    let one = |(reference, (name, index, unit, meaning)): (usize, (&str, usize, &str, &str))| {
        let start = u8::from(name == "error_quaternion" && index == 0);
        format!(
            "    <ScalarVariable name=\"{name}[{index}]\" valueReference=\"{reference}\" causality=\"input\" \
             variability=\"continuous\"\n      description=\"{meaning}\">\n      <Real{unit} start=\"{start}\"/>\n    \
             </ScalarVariable>\n"
        )
    };
    variables.enumerate().map(one).collect()
}
