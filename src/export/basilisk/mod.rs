//! A controller as one Python file with a module for the Basilisk simulator.

mod constants;
mod laws;

use runtime::trigger::ThresholdUpdate;
use synth::model::Plant;

use self::constants::{flag, number, numbers, rows, Constant};
use super::c_text::type_name;
use super::design::DesignData;
use super::flight::NoSource;
use super::opening::{opening, opening_of_scenario};
use crate::run::design::{threshold_update, Design};
use crate::scenario::Scenario;

const COMMON: &str = include_str!("templates/common.py");
const XU: &str = include_str!("templates/xu2020.py");
const MODEL: &str = include_str!("templates/model.py");

/// What every file says near its beginning, one word.
pub const MARK: &str = "steadfast-basilisk";

/// The file of a design's controller.
///
/// # Errors
/// Gains that are no law; a design that is not for the exact model of a spacecraft.
pub fn of_design(design: &Design) -> Result<String, NoSource> {
    let gains = design.law_gains()?;
    let Plant::Spacecraft(craft) = &design.model.plant else {
        return Err(NoSource::NotASpacecraft);
    };
    let controller = &design.file.controller;
    let update = threshold_update(&design.model.file.specs);
    let [w1, w2, w3] = craft.rate_bound.into();
    let least = craft.scalar_part_min;
    let mut constants = vec![
        number("LONGEST_INTERVAL_S", design.model.file.specs.hbar_s),
        numbers("TORQUE_LIMIT_NM", &design.law().1),
        Constant::new("GAINS", constants::matrices(&controller.gains[..gains])),
        rows("TRIGGER_WEIGHT", &controller.trigger_weight),
        number("TRIGGER_FLOOR", controller.trigger_floor),
        flag("HAS_BOX", true),
        numbers("BOX_LOWER", &[-w1, -w2, -w3, least]),
        numbers("BOX_UPPER", &[w1, w2, w3, 1.0]),
    ];
    constants.extend(threshold(&update));
    let data = DesignData::of_design(design);
    let about = opening(&data, "a module for Basilisk");
    Ok(file(&data.name, about, &constants, XU))
}

/// The file of a scenario's controller. `text` is the scenario's.
///
/// # Errors
/// A scenario that flies a design; a law without such a file.
pub fn of_scenario(scenario: &Scenario, text: &str) -> Result<String, NoSource> {
    let law = scenario.controller.law().ok_or(NoSource::OfDesign)?;
    let own = laws::of(&scenario.controller);
    let (constants, template) = own.ok_or_else(|| NoSource::Law { law: law.name() })?;
    let about = opening_of_scenario(scenario, law, text, "a module for Basilisk");
    Ok(file(&scenario.name, about, &constants, template))
}

/// How the threshold of the trigger moves.
fn threshold(update: &ThresholdUpdate) -> Vec<Constant> {
    let (adaptation, least, largest) = match *update {
        ThresholdUpdate::Fixed { threshold } => (None, threshold, threshold),
        ThresholdUpdate::Clamped {
            adaptation,
            minimum,
            maximum,
        } => (Some(adaptation), minimum, maximum),
        ThresholdUpdate::UnclampedAsPublished {
            adaptation,
            minimum,
        } => (Some(adaptation), minimum, f64::MAX),
    };
    let [amplitude, slope, dead_band] =
        adaptation.map_or([0.0; 3], |own| [own.amplitude, own.slope, own.dead_band]);
    vec![
        flag("ADAPTIVE", adaptation.is_some()),
        number("ADAPTATION_AMPLITUDE", amplitude),
        number("ADAPTATION_SLOPE", slope),
        number("ADAPTATION_DEAD_BAND", dead_band),
        number("THRESHOLD_MINIMUM", least),
        number("THRESHOLD_MAXIMUM", largest),
    ]
}

/// The whole text.
fn file(title: &str, mut about: Vec<String>, constants: &[Constant], law: &str) -> String {
    about.push(format!("format: {MARK}"));
    let lines = about.iter().map(|line| {
        let plain = line.chars().map(|c| if c.is_control() { ' ' } else { c });
        format!("# {}", plain.collect::<String>())
            .trim_end()
            .to_string()
    });
    let about: Vec<String> = lines.collect();
    let tables: Vec<String> = constants.iter().map(Constant::line).collect();
    let common = COMMON.replace("@about@", &about.join("\n"));
    let common = common.replace("@tables@", &tables.join("\n"));
    common + law + &MODEL.replace("@name@", &type_name(title))
}
