//! A controller as C99 text: its numbers as tables, its law from templates.

use crate::base::provenance::GENERATOR;
use crate::export::c_float::in_float;
use crate::export::c_text::{comment, constant as number, table};
use crate::export::quantity::Quantity;

/// What each file of a package says near its beginning, one word.
pub const MARK: &str = "steadfast-c99";

/// What a step takes beside the time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Measurement {
    /// The error quaternion, scalar part first, and the rate (rad/s).
    Attitude,
    /// The state.
    State,
}

impl Measurement {
    /// The parameters of `step`.
    fn parameters(self) -> &'static str {
        match self {
            Measurement::Attitude => {
                "const double error_quaternion[4],\n    const double rate_rad_s[3]"
            }
            Measurement::State => "const double state_measured[STATES_]",
        }
    }

    fn arguments(self) -> &'static str {
        match self {
            Measurement::Attitude => "error_quaternion, rate_rad_s",
            Measurement::State => "state_measured",
        }
    }

    fn null_check(self) -> &'static str {
        match self {
            Measurement::Attitude => "(error_quaternion == NULL) || (rate_rad_s == NULL)",
            Measurement::State => "(state_measured == NULL)",
        }
    }

    fn meaning(self) -> &'static str {
        match self {
            Measurement::Attitude => {
                " * error_quaternion: of the attitude against the desired one, scalar part first, norm 1; the laws of Wu and Lei follow its sign.\n \
                 * rate_rad_s: the rate error about the body axes (rad/s)."
            }
            Measurement::State => " * state_measured: the state.",
        }
    }

    /// A measurement for the example.
    fn example(self) -> &'static str {
        match self {
            Measurement::Attitude => {
                "        const double error_quaternion[4] = {0.99875026039496628, 0.0, 0.0, 0.049979169270678331};\n        \
                 const double rate_rad_s[3] = {0.0, 0.0, 0.0};"
            }
            Measurement::State => {
                "        double state_measured[STATES_] = {0.0};\n        state_measured[0] = 0.1;"
            }
        }
    }

    /// How many numbers it has, of so many states.
    pub(super) fn count(self, states: usize) -> usize {
        match self {
            Measurement::Attitude => 7,
            Measurement::State => states,
        }
    }

    /// The call of `step` with the numbers of a row.
    fn row(self) -> &'static str {
        match self {
            Measurement::Attitude => "&row[1], &row[5]",
            Measurement::State => "&row[1]",
        }
    }
}

/// What a command is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CommandField {
    /// Its name in the structures.
    pub name: &'static str,
    /// What it is.
    pub meaning: &'static str,
}

/// The torque about the body axes.
pub const TORQUE: CommandField = CommandField {
    name: "torque_nm",
    meaning: "torque about the body axes (N m)",
};

/// The input of another plant.
pub const INPUT: CommandField = CommandField {
    name: "input",
    meaning: "input of the plant",
};

/// The numbers that a controller computes in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// Doubles, as the reference.
    Double,
    /// Single precision, but for the time.
    Single,
}

impl Precision {
    /// Binary digits of its numbers.
    fn mantissa(self) -> &'static str {
        match self {
            Precision::Double => "53",
            Precision::Single => "24",
        }
    }
}

/// When a controller sends its command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sending {
    /// The first one that can be used, then when the trigger fires.
    AtTriggers,
    /// When the trigger switches the actuators on or off.
    AtSwitches,
    /// At every sample.
    AtEverySample,
}

impl Sending {
    /// Lines of the comment on `step`.
    fn as_comment(self) -> &'static str {
        match self {
            Sending::AtTriggers => {
                "The first usable one is always sent, later ones when the trigger fires; in between the\n * \
                 command is constant."
            }
            Sending::AtSwitches => {
                "A command is sent when the trigger switches the actuators on or off, off with a command\n * \
                 of zero, unless it switches them on again at the same sample; in between it is constant, and zero before the first switch."
            }
            Sending::AtEverySample => {
                "The command of every sample that is used is sent."
            }
        }
    }

    /// What `sent` means.
    fn of_flag(self) -> &'static str {
        match self {
            Sending::AtTriggers => "1 where the trigger fired: a message is due",
            Sending::AtSwitches => "1 where the actuators are switched on or off: a message is due",
            Sending::AtEverySample => "1 where the sample is used: a message is due",
        }
    }
}

/// A table of constants under its name in the source.
#[derive(Debug, Clone, PartialEq)]
pub struct Constant {
    /// Its name in the source.
    pub variable: &'static str,
    /// The numbers.
    pub numbers: Quantity,
}

/// A controller as C99 text, before the names are filled in.
#[derive(Debug, Clone, PartialEq)]
pub struct Source {
    /// The name of the design or scenario.
    pub title: String,
    /// What every name begins with.
    pub name: String,
    /// Whether everything is proved.
    pub proved: bool,
    /// What is to be said of it: the law, assumptions, provenance.
    pub about: Vec<String>,
    /// Numbers of states and inputs.
    pub sizes: [usize; 2],
    /// How often each message is sent again.
    pub repeats: u32,
    /// The longest sampling interval (s).
    pub interval_s: f64,
    /// The numbers that it computes in.
    pub precision: Precision,
    /// What is to be known of the sampling interval.
    pub sampling: String,
    /// When a command is sent.
    pub sending: Sending,
    /// What a step takes.
    pub measurement: Measurement,
    /// What it commands.
    pub command: CommandField,
    /// The fields of the controller's structure.
    pub fields: &'static str,
    /// Further types of the header, and functions.
    pub further: [&'static str; 2],
    /// Its numbers.
    pub constants: Vec<Constant>,
    /// Its whole numbers.
    pub counts: Vec<(&'static str, usize)>,
    /// Macros.
    pub macros: Vec<(&'static str, &'static str)>,
    /// The parts of its text, in order.
    pub parts: Vec<&'static str>,
    /// Functions of the C library whose last bits are not prescribed.
    pub library: Vec<&'static str>,
    /// Doubles that the controller's structure fits into.
    pub words: usize,
    /// Whether it is given the fault that acts, which it does not estimate.
    pub given_fault: bool,
    /// The same law in the language of MATLAB, to read.
    pub in_matlab: Option<&'static str>,
}

const HEADER: &str = include_str!("templates/controller.h");
const OPENING: &str = include_str!("templates/opening.c");
pub(super) const COMMON: &str = include_str!("templates/common.c");
pub(super) const ATTITUDE: &str = include_str!("templates/attitude.c");
pub(super) const VECTORS: &str = include_str!("templates/vectors3.c");
pub(super) const STEP: &str = include_str!("templates/step.c");
pub(super) const CLOSING: &str = include_str!("templates/closing.c");

impl Source {
    /// A text with the names filled in.
    pub fn filled(&self, text: &str) -> String {
        let [states, inputs] = self.sizes;
        let upper = self.name.to_ascii_uppercase();
        let sizes = format!("#define @NAME@_STATES {states}\n#define @NAME@_INPUTS {inputs}");
        let pairs = [
            ("@sizes@", sizes.as_str()),
            ("@interval_s@", &number(self.interval_s)),
            ("@sending@", self.sending.as_comment()),
            ("@sent_meaning@", self.sending.of_flag()),
            ("@types@", self.further[0]),
            ("@functions@", self.further[1]),
            ("@fields@", self.fields),
            ("@measurement_meaning@", self.measurement.meaning()),
            ("@measurement@", self.measurement.parameters()),
            ("@arguments@", self.measurement.arguments()),
            ("@from_row@", self.measurement.row()),
            ("@null_check@", self.measurement.null_check()),
            ("@input_meaning@", self.command.meaning),
            ("@input@", self.command.name),
            ("@example@", self.measurement.example()),
            ("@about_file@", &self.about_file()),
            ("@states@", &states.to_string()),
            ("@inputs@", &inputs.to_string()),
            ("@words@", &self.words.to_string()),
            ("STATES_", "@NAME@_STATES"),
            ("@proved@", if self.proved { "1" } else { "0" }),
            ("@mantissa@", self.precision.mantissa()),
            ("@proved_text@", self.proved_text()),
            ("@repeats@", &self.repeats.to_string()),
            ("@name@", &self.name),
            ("@NAME@", &upper),
        ];
        pairs
            .into_iter()
            .fold(text.to_string(), |text, (from, to)| text.replace(from, to))
    }

    /// What a file says of itself.
    pub fn about_file(&self) -> String {
        let title = self.title.chars().filter(char::is_ascii_graphic);
        let title: String = title.collect();
        let proved = self.proved_text();
        format!("Part of the flight code of the controller '{title}', {proved}. format: {MARK}, exported_by: {GENERATOR}")
    }

    /// In words, whether everything is proved.
    pub(super) fn proved_text(&self) -> &'static str {
        match self.proved {
            true => "PROVED",
            false => "NOT PROVED",
        }
    }

    /// The largest magnitude of each input.
    pub(super) fn limits(&self) -> &[f64] {
        let limits = self.constants.iter().find(|one| one.variable == "LIMITS");
        limits.map_or(&[], |limits| &limits.numbers.values)
    }

    /// A C text in the controller's precision.
    pub(super) fn in_precision(&self, text: &str) -> String {
        match self.precision {
            Precision::Double => text.to_string(),
            Precision::Single => in_float(text),
        }
    }

    /// The header.
    pub fn header(&self) -> String {
        self.in_precision(&(comment(&self.about) + &self.filled(HEADER)))
    }

    /// The source.
    pub fn source(&self) -> String {
        let mut out = comment(&self.about) + &self.filled(OPENING);
        for (name, count) in &self.counts {
            out += &format!("#define {name} {count}\n");
        }
        for (name, text) in &self.macros {
            out += &format!("#define {name} {text}\n");
        }
        for constant in &self.constants {
            out.push('\n');
            out += &table(constant.variable, &constant.numbers);
        }
        for part in &self.parts {
            out.push('\n');
            out += &self.filled(part);
        }
        self.in_precision(&out)
    }
}
