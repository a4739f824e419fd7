//! The link between torque command and actuators, in the closed loop.

use std::path::Path;

use crate::support::*;
use nalgebra::Vector3;
use serde_json::{json, Value};
use steadfast::scenario::Scenario;
use steadfast::sim::link::{Link, MAX_LEVELS};

const LIMIT: [f64; 3] = [0.2; 3];

/// Steps from 1e-4 N m at rest to 0.04 N m near the limit, in words of three bits.
fn compressed() -> Value {
    let steps = json!([1e-4, 1e-3, 1e-2, 4e-2]);
    let table = json!({ "from_nm": [0, 1e-3, 1e-2, 0.1], "threshold_nm": [steps, steps, steps] });
    json!({ "z_ary": { "radix": 2, "digits": 3, "levels": { "table": table } } })
}

fn encodings() -> [Value; 4] {
    let format = json!({ "quantised": { "bits": 12 } });
    [
        json!({ "every_change": {} }),
        json!({ "fixed_threshold": { "threshold_nm": [1e-3, 1e-3, 1e-3], "format": format } }),
        json!({ "relative_threshold": { "relative": 0.1, "absolute_nm": [1e-3, 1e-3, 1e-3] } }),
        compressed(),
    ]
}

/// Wu's scenario with a link and without requirements.
fn scenario(link: Value) -> Value {
    let mut file = json(&shipped("wu2018.json"));
    set(&mut file, "/requirements", json!([]));
    set(&mut file, "/duration_s", json!(300));
    set(&mut file, "/link", link);
    file
}

fn link(encoding: Value, more: Value) -> Value {
    let mut link = json!({ "encoding": encoding, "torque_limit_nm": LIMIT });
    let keys = more.as_object().expect("an object");
    for (key, value) in keys {
        set(&mut link, &format!("/{key}"), value.clone());
    }
    link
}

fn run(file: &Value) -> Value {
    let folder = folder();
    let path = write(folder.path(), "scenario.json", file.to_string());
    parsed(&steadfast([Path::new("simulate"), &path, Path::new("--json")]).ends_with(0))
}

fn parsed(run: &Run) -> Value {
    serde_json::from_str(&run.stdout).expect("one JSON object")
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

#[test]
fn sending_every_change_alters_nothing_but_the_summary_of_the_link() {
    let mut plain = scenario(Value::Null);
    plain.as_object_mut().expect("an object").remove("link");
    let mut without = run(&plain);
    let mut with = run(&scenario(link(json!({ "every_change": {} }), json!({}))));
    assert_eq!(without["link"], Value::Null);
    assert_eq!(with["link"]["messages"], with["triggers"]);
    assert_eq!(with["link"]["longest_disagreement_s"], 0.0);
    for summary in [&mut without, &mut with] {
        set(summary, "/link", Value::Null);
        set(summary, "/provenance", Value::Null);
    }
    assert_eq!(with, without);
}

#[test]
fn every_word_costs_its_bits() {
    let more = json!({ "resynchronisation_period_s": 7 });
    for (encoding, bits) in encodings().into_iter().zip([64, 12, 64, 3]) {
        let long = if bits == 3 { 32 } else { bits };
        let carried = &run(&scenario(link(encoding.clone(), more.clone())))["link"];
        let words = carried["words"].as_u64().expect("a count");
        let resynchronisations = carried["resynchronisation_words"]
            .as_u64()
            .expect("a count");
        // Every 7 s of 300 s, three axes.
        assert_eq!(resynchronisations, 3 * 42, "{encoding}");
        let expected = bits * (words - resynchronisations) + long * resynchronisations;
        assert_eq!(carried["bits"], expected, "{encoding}");
        let bytes = number(&carried["bytes"]);
        let messages = number(&carried["messages"]);
        let exact = expected as f64 / 8.0;
        assert!(bytes >= exact && bytes < exact + messages, "{encoding}");
        assert_eq!(carried["longest_disagreement_s"], 0.0, "{encoding}");
    }
}

#[test]
fn the_loop_settles_over_a_compressed_link_with_losses_and_stays_within_the_limit() {
    let more = json!({
        "word_loss_probability": 0.02, "bit_error_probability": 0.001, "resynchronisation_period_s": 5
    });
    let summary = run(&scenario(link(compressed(), more)));
    let carried = &summary["link"];
    assert!(number(&carried["lost_words"]) > 0.0, "{carried}");
    assert!(number(&carried["corrupted_words"]) > 0.0, "{carried}");
    assert!(number(&summary["settle_seconds"]) < 150.0, "{summary}");
    assert!(number(&summary["max_torque"]) <= LIMIT[0]);
}

#[test]
fn a_disagreement_lasts_at_most_one_period_while_no_resynchronisation_word_is_lost() {
    let mut seen = 0;
    for seed in 1..=6 {
        for encoding in encodings() {
            let more = json!({ "word_loss_probability": 0.02, "resynchronisation_period_s": 20 });
            let mut file = scenario(link(encoding, more));
            set(&mut file, "/random/seed", json!(seed));
            let carried = run(&file)["link"].clone();
            let periods = 1.0 + number(&carried["lost_resynchronisation_words"]);
            let longest = number(&carried["longest_disagreement_s"]);
            assert!(longest <= 20.0 * periods + 1e-9, "{carried}");
            let lost = number(&carried["lost_words"]) > 0.0;
            seen += usize::from(lost && longest > 0.0 && periods == 1.0);
        }
    }
    assert!(
        seen >= 3,
        "{seen} runs with losses, none of them of a resynchronisation word"
    );
}

#[test]
fn losses_come_from_the_seed_and_move_neither_noise_nor_sampling() {
    let file = |loss: f64, seed: u64| {
        let more = json!({ "word_loss_probability": loss, "resynchronisation_period_s": 5 });
        let mut file = scenario(link(compressed(), more));
        set(&mut file, "/random/seed", json!(seed));
        let instants = json!({ "aperiodic": { "shortest_s": 0.02, "longest_s": 0.04 } });
        set(&mut file, "/sampling/instants", instants);
        file
    };
    let (first, again) = (run(&file(0.1, 1)), run(&file(0.1, 1)));
    assert_eq!(first, again);
    let other = run(&file(0.1, 2));
    assert_ne!(first["link"], other["link"]);
    let perfect = run(&file(0.0, 1));
    assert_eq!(perfect["link"]["lost_words"], 0);
    assert_eq!(first["samples"], perfect["samples"]);
}

#[test]
fn what_a_link_may_cost_can_be_required() {
    let mut file = scenario(link(compressed(), json!({})));
    let requirements = json!([
        { "metric": "link_messages", "at_least": 1 },
        { "metric": "link_bits", "at_most": 1 },
        { "metric": "link_longest_disagreement_s", "at_most": 0 },
    ]);
    set(&mut file, "/requirements", requirements);
    let folder = folder();
    let path = write(folder.path(), "scenario.json", file.to_string());
    let summary =
        parsed(&steadfast([Path::new("simulate"), &path, Path::new("--json")]).ends_with(2));
    let met = |index: usize| summary["requirements"][index]["met"].clone();
    assert_eq!([met(0), met(1), met(2)], [true, false, true]);
}

#[test]
fn the_report_and_the_words_tell_of_the_link() {
    let folder = folder();
    let more = json!({ "word_loss_probability": 0.1, "resynchronisation_period_s": 5 });
    let file = scenario(link(compressed(), more));
    let path = write(folder.path(), "scenario.json", file.to_string());
    let out = folder.path().join("run");
    let printed = steadfast([Path::new("simulate"), &path, Path::new("-o"), &out]).ends_with(0);
    let words = "link: z-ary compression, z = 2, m = 3, 4 levels, 3 bits a word";
    assert!(printed.stdout.contains(words), "{}", printed.stdout);
    assert!(printed.stdout.contains("longest disagreement"));
    let page = text(&out.join("report.html"));
    assert!(page.contains("<h2>Link to the actuators</h2>"));
    assert!(page.contains("Longest disagreement of the two ends (s)"));
}

#[test]
fn no_proof_covers_a_run_over_a_link() {
    let folder = folder();
    let mut file = json(&shipped("xu2020-closed-loop.json"));
    set(&mut file, "/duration_s", json!(20));
    set(&mut file, "/metrics/tail_s", json!(5));
    set(&mut file, "/requirements", json!([]));
    let mut over = link(json!({ "every_change": {} }), json!({}));
    set(&mut over, "/torque_limit_nm", json!([2, 2, 2]));
    let covers = |file: &Value| {
        let path = write(folder.path(), "scenario.json", file.to_string());
        let arguments = [Path::new("simulate"), &path, Path::new("--design")];
        let arguments = arguments
            .into_iter()
            .chain([xu2020_design(), Path::new("--json")]);
        parsed(&steadfast(arguments).ends_with(0))["certificate"].clone()
    };
    assert_eq!(covers(&file)["covers_run"], true);
    set(&mut file, "/link", over);
    let certificate = covers(&file);
    assert_eq!(certificate["covers_run"], false);
    let reason = "the actuators get the torque over a link, not as commanded";
    assert_eq!(certificate["not_covered"], json!([reason]));
}

#[test]
fn a_bad_link_is_refused_with_its_field() {
    let refusal = |pointer: &str, value: Value| {
        let mut file = scenario(link(compressed(), json!({})));
        set(&mut file, pointer, value);
        let folder = folder();
        let path = write(folder.path(), "scenario.json", file.to_string());
        steadfast([Path::new("simulate"), path.as_path()]).refusal()
    };
    let fields = [
        ("/link/word_loss_probability", json!(1), "link.word_loss_probability': the value 1 "),
        ("/link/bit_error_probability", json!(-0.1), "link.bit_error_probability"),
        ("/link/resynchronisation_period_s", json!(0), "link.resynchronisation_period_s"),
        ("/link/torque_limit_nm/1", json!(0), "link.torque_limit_nm[1]"),
        ("/link/encoding/z_ary/radix", json!(3), "link.encoding.z_ary.radix': the value 3 is not allowed; it must be even"),
        ("/link/encoding/z_ary/digits", json!(2), "link.encoding.z_ary.levels.table.from_nm': the value 4 is not allowed; it must be in [1, 2]"),
        ("/link/encoding/z_ary/digits", json!(30), "link.encoding.z_ary.digits': the value 30 is not allowed; it must be in [1, 24]"),
        ("/link/encoding/z_ary/levels/table/from_nm/2", json!(1e-3), "link.encoding.z_ary.levels.table.from_nm[2]"),
        ("/link/encoding/z_ary/levels/table/threshold_nm/2/1", json!(0.5), "link.encoding.z_ary.levels.table.threshold_nm[2][1]"),
        ("/link/encoding/z_ary/levels/table/threshold_nm/0", json!([1]), "link.encoding.z_ary.levels.table.threshold_nm[0]"),
        ("/link/encoding", json!({ "fixed_threshold": { "threshold_nm": [1e-3, 0, 1e-3] } }), "link.encoding.fixed_threshold.threshold_nm[1]"),
        ("/link/encoding", json!({ "relative_threshold": { "relative": 1, "absolute_nm": LIMIT } }), "link.encoding.relative_threshold.relative"),
        ("/link/encoding", json!({ "every_change": { "format": { "quantised": { "bits": 40 } } } }), "link.encoding.every_change.format.quantised.bits"),
        ("/sampling/instants", json!({ "continuous": { "resolution_s": 1e-6 } }), "sampling.instants.continuous.resolution_s"),
        ("/link/loss", json!(0), "link"),
    ];
    for (pointer, value, expected) in fields {
        let message = refusal(pointer, value);
        assert!(
            message.contains(&format!("'{expected}")),
            "{expected}: {message}"
        );
    }
}

/// What happens to each word of an axis, followed from outside of the codec.
#[test]
fn heavy_losses_on_a_compressed_axis_are_made_good_by_the_next_word_of_resynchronisation() {
    let more = json!({ "word_loss_probability": 0.4, "resynchronisation_period_s": 1 });
    let file = scenario(link(compressed(), more));
    let data = Scenario::from_json(&file.to_string())
        .expect("a scenario")
        .link;
    let data = data.expect("a link");
    let mut ideal = data;
    ideal.word_loss_probability = 0.0;
    assert_eq!(MAX_LEVELS, 64);
    let (mut lossy, mut perfect) = (Link::new(&data, 5).unwrap(), Link::new(&ideal, 5).unwrap());
    let (mut differed, mut agreed) = (0, 0);
    let mut last = lossy.outcome();
    for index in 0..20_000 {
        let time = 0.01 * f64::from(index);
        let command =
            Vector3::new((0.9 * time).sin(), (1.7 * time).cos(), (0.3 * time).sin()) * 0.15;
        let (held, sent) = (
            lossy.transmit(time, &command),
            perfect.transmit(time, &command),
        );
        let now = lossy.outcome();
        let resynchronised = now.resynchronisation_words > last.resynchronisation_words;
        let all_arrived = now.lost_words == last.lost_words;
        if resynchronised && all_arrived {
            assert_eq!(held, sent, "at {time} s");
            agreed += 1;
        }
        differed += usize::from(held != sent);
        last = now;
    }
    assert!(agreed > 20 && differed > 1000, "{agreed} {differed}");
}

#[test]
fn a_huge_limit_stands_for_no_limit() {
    let folder = folder();
    let limit = json!([1e40, 1e40, 1e40]);
    for (file, pointer) in [
        ("wu2018-link.json", "/link/torque_limit_nm"),
        ("yang2025.json", "/controller/yang2025/torque_limit_nm"),
    ] {
        let mut scenario = json(&shipped(file));
        set(&mut scenario, pointer, limit.clone());
        let path = write(folder.path(), file, scenario.to_string());
        steadfast([Path::new("check"), &path]).ends_with(0);
    }
}
