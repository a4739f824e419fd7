//! Templates for flight software frameworks around the C files: a component of F Prime, an application of cFS.

use super::source::{Measurement, Source};
use crate::export::c_text::{comment, type_name};

const MODEL: &str = include_str!("templates/fprime.fpp");
const HEADER: &str = include_str!("templates/fprime.hpp");
const COMPONENT: &str = include_str!("templates/fprime.cpp");
const APPLICATION: &str = include_str!("templates/cfs_app.c");

/// The files, by name, of a controller of a spacecraft.
pub fn files(source: &Source) -> Vec<(String, String)> {
    if source.measurement != Measurement::Attitude {
        return Vec::new();
    }
    let (name, class) = (&source.name, type_name(&source.name));
    let filled = |text: &str| source.filled(&text.replace("@Class@", &class));
    let in_c = |text: &str| comment(&[source.about_file()]) + &filled(text);
    let about = format!("# {}", source.about_file());
    vec![
        (
            format!("{name}.fpp"),
            filled(&MODEL.replace("@about_file_fpp@", &about)),
        ),
        (format!("{class}Controller.hpp"), in_c(HEADER)),
        (format!("{class}Controller.cpp"), in_c(COMPONENT)),
        (format!("{name}_cfs_app.c"), in_c(APPLICATION)),
    ]
}
