//! Bad values in model files: one clear sentence, exit status 1, nothing written, never a panic.

use std::path::Path;

use crate::support::refusals::*;
use crate::support::*;
use serde_json::{json, Value};

/// Sets one value of a model and expects a refusal that says all parts.
#[track_caller]
fn assert_refused(mut model: Value, pointer: &str, value: Value, parts: &[&str]) {
    set(&mut model, pointer, value);
    assert_says(&synthesize_refusal(model.to_string()), parts);
}

/// Puts a text in the place of the number of phi, for what JSON cannot hold.
fn with_phi(literal: &str) -> String {
    let mut model = spacecraft();
    set(&mut model, "/specs/phi_per_s", json!("PHI"));
    model.to_string().replace("\"PHI\"", literal)
}

#[test]
fn a_missing_key_is_named() {
    let top = ["schema_version", "name", "plant", "specs"].map(|key| ("", key));
    let exact = [
        "inertia_kg_m2",
        "torque_limit_nm",
        "disturbance_bound_nm",
        "rate_rad_s",
        "q0_min",
    ];
    let exact = exact.map(|key| ("/plant/exact", key));
    let specs = ["phi_per_s", "hbar_s", "nu"].map(|key| ("/specs", key));
    for (parent, key) in top.into_iter().chain(exact).chain(specs) {
        let mut model = spacecraft();
        remove(&mut model, &format!("{parent}/{key}"));
        let place = parent.trim_start_matches('/').replace('/', ".");
        let message = synthesize_refusal(model.to_string());
        assert_says(&message, &["missing field", &format!("`{key}`"), &place]);
    }
}

#[test]
fn an_unknown_key_is_named_with_the_known_ones() {
    let cases = [
        ("/gain", "gains"),
        ("/specs/phi", "phi_per_s"),
        ("/plant/exact/inertia", "inertia_kg_m2"),
    ];
    for (pointer, known) in cases {
        let field = pointer[1..].replace('/', ".");
        let parts = ["unknown field", known, &format!("field '{field}'")];
        assert_refused(spacecraft(), pointer, json!(1), &parts);
    }
}

#[test]
fn a_wrong_type_is_named() {
    let cases = [
        ("/specs/phi_per_s", json!("0.05"), "expected a number"),
        ("/specs/nu", json!(null), "expected a number"),
        ("/specs/hbar_s", json!(true), "expected a number"),
        ("/specs/eps", json!(1), "expected a list of 3 entries"),
        ("/specs", json!(3), "expected an object"),
        ("/name", json!(3), "expected a string"),
        ("/schema_version", json!(1.5), "expected a whole number"),
        (
            "/plant/exact/inertia_kg_m2/1/1",
            json!([270]),
            "expected a number",
        ),
    ];
    for (pointer, value, expected) in cases {
        let field = pointer[1..].replace("/1/1", "[1][1]").replace('/', ".");
        let parts = [expected, &format!("field '{field}'")];
        assert_refused(spacecraft(), pointer, value, &parts);
    }
}

#[test]
fn a_list_in_the_place_of_an_object_is_refused() {
    let bounds = json!([[[1, 0], 1]]);
    let parts = [
        "plant.vertices.box[0]",
        "found a list",
        "expected an object",
    ];
    assert_refused(cart(), "/plant/vertices/box", bounds, &parts);
    assert_says(&synthesize_refusal("[1, 2]"), &["expected an object"]);
}

#[test]
fn a_wrong_shape_is_named() {
    let inertia = "/plant/exact/inertia_kg_m2";
    let field = "field 'plant.exact.inertia_kg_m2";
    let two_by_three = json!([[350, 3, 4], [3, 270, 10]]);
    assert_refused(
        spacecraft(),
        inertia,
        two_by_three,
        &[field, "2 entries", "3 entries"],
    );
    let ragged = json!([[350, 3, 4], [3, 270], [4, 10, 190]]);
    assert_refused(
        spacecraft(),
        inertia,
        ragged,
        &[field, "[1]", "2 entries", "3 entries"],
    );
    let four_rows = json!([[350, 3, 4], [3, 270, 10], [4, 10, 190], [0, 0, 0]]);
    assert_refused(
        spacecraft(),
        inertia,
        four_rows,
        &[field, "too many entries"],
    );
    let four_columns = json!([[350, 3, 4, 0], [3, 270, 10], [4, 10, 190]]);
    assert_refused(
        spacecraft(),
        inertia,
        four_columns,
        &[field, "[0]", "too many entries"],
    );
    let torques = ["field 'plant.exact.torque_limit_nm'", "2 entries"];
    assert_refused(
        spacecraft(),
        "/plant/exact/torque_limit_nm",
        json!([2, 2]),
        &torques,
    );
    let state = ["field 'specs.must_contain[0]'", "1 x 6"];
    assert_refused(
        spacecraft(),
        "/specs/must_contain",
        json!([[0.1, 0]]),
        &state,
    );
}

#[test]
fn matrices_of_a_vertex_model_must_fit_each_other() {
    let vertices = "/plant/vertices";
    let cases = [
        ("state_matrices", json!([]), "1 to 4096 matrices"),
        ("state_matrices", json!([[]]), "1 to 24 states"),
        ("state_matrices", json!([[[0, 1], [0]]]), "2 x 2"),
        (
            "state_matrices",
            json!([[[0, 1], [0, 0]], [[0, 1]]]),
            "2 x 2",
        ),
        ("state_matrices", json!([[[0, 1, 2], [0, 0, 1]]]), "2 x 2"),
        ("input_matrix", json!([]), "2 x at least 1"),
        ("input_matrix", json!([[], []]), "2 x at least 1"),
        ("input_matrix", json!([[0]]), "2 x at least 1"),
        ("input_matrix", json!([[0], [1], [2]]), "2 x at least 1"),
        ("disturbance_matrix", json!([[1]]), "2 x at least 1"),
        ("output_matrix", json!([[1]]), "at least 1 x 2"),
        ("input_limit", json!([]), "expected 1 entry"),
        ("input_limit", json!([1, 2]), "expected 1 entry"),
        ("box", json!([{ "row": [1], "bound": 1 }]), "1 x 2"),
    ];
    for (key, value, expected) in cases {
        let parts = [&format!("field 'plant.vertices.{key}"), expected];
        assert_refused(cart(), &format!("{vertices}/{key}"), value, &parts);
    }
}

#[test]
fn sizes_beyond_any_use_are_refused() {
    let matrix = json!([[0, 1], [0, 0]]);
    let many = Value::from(vec![matrix; 4097]);
    let states = json!([vec![vec![0; 25]; 25]]);
    let inputs = json!(vec![vec![1; 25]; 2]);
    let bounds = Value::from(vec![json!({ "row": [1, 0], "bound": 1 }); 257]);
    let contained = Value::from(vec![json!([0, 0]); 257]);
    let cases = [
        (
            "/plant/vertices/state_matrices",
            many,
            "4097 matrices, expected 1 to 4096 matrices",
        ),
        (
            "/plant/vertices/state_matrices",
            states,
            "25 rows, expected 1 to 24 states",
        ),
        (
            "/plant/vertices/input_matrix",
            inputs,
            "25 columns, expected at most 24",
        ),
        (
            "/plant/vertices/box",
            bounds,
            "257 bounds, expected at most 256",
        ),
        (
            "/specs/must_contain",
            contained,
            "257 states, expected at most 256",
        ),
    ];
    for (pointer, value, expected) in cases {
        assert_refused(cart(), pointer, value, &[expected]);
    }
}

#[test]
fn numbers_that_are_not_finite_are_refused() {
    for literal in [
        "NaN",
        "nan",
        "Infinity",
        "-Infinity",
        "inf",
        "1e999",
        "-1e999",
        "+1",
        ".5",
    ] {
        let message = synthesize_refusal(with_phi(literal));
        let parts = [
            "field 'specs.phi_per_s'",
            &format!("the value {literal} is not allowed"),
        ];
        assert_says(&message, &parts);
        assert_says(&message, &["finite"]);
    }
}

#[test]
fn numbers_so_large_or_small_that_squares_overflow_are_refused() {
    for value in [1e200, 1e31, -1e31, 1e-200] {
        let parts = [
            &format!("the value {value:e} is not allowed"),
            "1e-30 to 1e30",
        ];
        assert_refused(
            spacecraft(),
            "/plant/exact/inertia_kg_m2/0/0",
            json!(value),
            &parts,
        );
    }
}

#[test]
fn an_impossible_inertia_is_refused() {
    let inertia = "/plant/exact/inertia_kg_m2";
    let field = "field 'plant.exact.inertia_kg_m2'";
    let asymmetric = json!([[350, 3.5, 4], [3, 270, 10], [4, 10, 190]]);
    let parts = [field, "(1, 2) is 3.5", "(2, 1) is 3;", "must be symmetric"];
    assert_refused(spacecraft(), inertia, asymmetric, &parts);
    let negative = json!([[-350, 3, 4], [3, 270, 10], [4, 10, 190]]);
    let parts = [field, "smallest eigenvalue is -350.0", "positive definite"];
    assert_refused(spacecraft(), inertia, negative, &parts);
    for singular in [
        json!([[1, 1, 0], [1, 1, 0], [0, 0, 1]]),
        json!([[0, 0, 0], [0, 0, 0], [0, 0, 0]]),
    ] {
        let parts = [field, "smallest eigenvalue is", "above 0"];
        assert_refused(spacecraft(), inertia, singular, &parts);
    }
}

#[test]
fn a_value_outside_its_range_is_named_with_the_range() {
    let cases = [
        ("/plant/exact/torque_limit_nm/0", 0.0, "above 0"),
        ("/plant/exact/torque_limit_nm/1", -2.0, "above 0"),
        ("/plant/exact/rate_rad_s/2", 0.0, "above 0"),
        ("/plant/exact/disturbance_bound_nm", -0.01, "0 or above"),
        ("/plant/exact/q0_min", 0.0, "in (0, 1]"),
        ("/plant/exact/q0_min", -0.5, "in (0, 1]"),
        ("/plant/exact/q0_min", 1.5, "in (0, 1]"),
        ("/specs/phi_per_s", 0.0, "above 0"),
        ("/specs/phi_per_s", -0.05, "above 0"),
        ("/specs/hbar_s", 0.0, "above 0"),
        ("/specs/hbar_s", -0.1, "above 0"),
        ("/specs/hmin_s", 0.0, "above 0 and at most hbar_s"),
        ("/specs/hmin_s", 0.2, "above 0 and at most hbar_s"),
        ("/specs/nu", 1.0, "in [0, 1)"),
        ("/specs/nu", -0.1, "in [0, 1)"),
        ("/specs/nu", 1.5, "in [0, 1)"),
        ("/specs/nu_min", 0.3, "in [0, nu]"),
        ("/specs/eps/1", 0.0, "above 0"),
        ("/specs/eps/1", -1.0, "above 0"),
        ("/specs/xi_max", 0.0, "above 0"),
        ("/specs/xi_max", -1.0, "above 0"),
        ("/specs/margin", 0.0, "in (0, 0.01]"),
        ("/specs/margin", 1.0, "in (0, 0.01]"),
    ];
    for (pointer, value, allowed) in cases {
        let mut field = pointer[1..].replace('/', ".");
        if let Some((list, index)) = field.clone().rsplit_once('.') {
            if index.parse::<usize>().is_ok() {
                field = format!("{list}[{index}]");
            }
        }
        let sentence = format!("field '{field}': the value {value} is not allowed; it must be");
        assert_refused(spacecraft(), pointer, json!(value), &[&sentence, allowed]);
    }
    let limits = [
        "field 'plant.vertices.input_limit[0]': the value 0",
        "above 0",
    ];
    assert_refused(cart(), "/plant/vertices/input_limit/0", json!(0.0), &limits);
    let bound = [
        "field 'plant.vertices.box[1].bound': the value -1",
        "above 0",
    ];
    assert_refused(cart(), "/plant/vertices/box/1/bound", json!(-1.0), &bound);
}

#[test]
fn a_name_that_is_not_known_is_named_with_the_known_ones() {
    let cases = [
        (
            "/specs/objective",
            "unknown name `area`",
            "`gain`",
            json!("area"),
        ),
        (
            "/gains",
            "unknown name `adaptive`",
            "`constant` or `scheduled`",
            json!("adaptive"),
        ),
        (
            "/mismatch",
            "unknown name `some`",
            "`none` or `kappa`",
            json!("some"),
        ),
        (
            "/plant",
            "unknown name `cube`",
            "`exact`, `vertices`, `rules`",
            json!({ "cube": 1 }),
        ),
    ];
    for (pointer, found, known, value) in cases {
        assert_refused(spacecraft(), pointer, value, &[found, known]);
    }
}

#[test]
fn a_model_of_two_kinds_is_refused() {
    let mut model = spacecraft();
    let vertices = cart()["plant"]["vertices"].clone();
    set(&mut model, "/plant/vertices", vertices);
    assert_says(
        &synthesize_refusal(model.to_string()),
        &["field 'plant'", "found the names exact, vertices"],
    );
}

#[test]
fn an_unknown_version_is_refused() {
    for version in [0, 2] {
        let sentence =
            format!("'schema_version': the value {version} is not allowed; it must be 1");
        assert_refused(
            spacecraft(),
            "/schema_version",
            json!(version),
            &[&sentence],
        );
    }
    let folder = folder();
    let mut design = json(double_integrator_design());
    set(&mut design, "/schema_version", json!(2));
    let path = write(folder.path(), "design.json", design.to_string());
    let message = steadfast([Path::new("verify"), &path]).refusal();
    assert_says(
        &message,
        &["'schema_version': the value 2 is not allowed; it must be 1"],
    );
}

#[test]
fn a_key_that_stands_twice_is_refused() {
    let text = text(&shipped("xu2020.json"));
    let twice = text.replace("\"nu\": 0.2", "\"nu\": 0.2, \"nu\": 0.3");
    assert_says(
        &synthesize_refusal(twice),
        &["field 'specs'", "duplicate field `nu`"],
    );
    let twice = text.replace("\"name\":", "\"name\": \"other\", \"name\":");
    assert_says(&synthesize_refusal(twice), &["duplicate field `name`"]);
}

#[test]
fn what_is_not_json_is_refused() {
    let good = text(&shipped("xu2020.json"));
    let cases: [(&str, String); 8] = [
        ("empty", String::new()),
        ("blank", "  \n".to_string()),
        ("words", "no JSON at all".to_string()),
        ("comment", format!("// a comment\n{good}")),
        ("single quotes", good.replace('"', "'")),
        ("trailing comma", good.replace("0.2,", "0.2,,")),
        ("two objects", format!("{good}{good}")),
        ("zeros", "\0".repeat(100)),
    ];
    for (what, contents) in cases {
        let message = synthesize_refusal(contents);
        assert!(message.starts_with("not JSON: "), "{what}: {message}");
        assert_says(&message, &["line", "column"]);
    }
}

#[test]
fn what_is_not_text_is_refused() {
    let bytes: Vec<u8> = (0..=255).collect();
    assert_says(&synthesize_refusal(bytes), &["not UTF-8 text (byte 128)"]);
    let marked = format!("\u{feff}{}", text(&shipped("xu2020.json")));
    assert_says(&synthesize_refusal(marked), &["byte order mark"]);
}

#[test]
fn deep_nesting_is_refused() {
    let deep = [
        "[".repeat(100_000),
        "{\"a\":".repeat(100_000),
        with_phi(&format!("{}{}", "[".repeat(100_000), "]".repeat(100_000))),
        with_phi(&"[".repeat(100_000)),
    ];
    for contents in deep {
        let message = synthesize_refusal(contents);
        assert!(message.len() < 400, "{message}");
    }
}

#[test]
fn control_characters_cannot_break_the_error_line() {
    let mut model = spacecraft();
    set(&mut model, "/a\nb\u{1b}[31m", json!(1));
    assert_says(
        &synthesize_refusal(model.to_string()),
        &["a\\nb\\u{1b}[31m"],
    );
    let parts = ["field 'name'", "character 2", "on one line"];
    assert_refused(spacecraft(), "/name", json!("a\nb"), &parts);
}
