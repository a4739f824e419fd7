//! The module for Basilisk flies there as the controller flies here.

use super::flight::Flight;
use super::*;

const SCRIPT: &str = concat!(
    include_str!("basilisk_common.py"),
    include_str!("basilisk.py")
);
const WHEELS: &str = concat!(
    include_str!("basilisk_common.py"),
    include_str!("basilisk_wheels.py")
);

/// A scenario with a constant disturbance, sampled evenly, from an attitude that is far off.
fn scenario(name: &str, interval_s: f64) -> Value {
    let mut file = json(&shipped(name));
    let body = "/system/rigid_body";
    let at = |key: &str| format!("{body}/{key}");
    set(&mut file, "/duration_s", json!(100.0));
    set(
        &mut file,
        "/metrics",
        json!({ "settle_tolerance_deg": 0.1, "tail_s": 10 }),
    );
    set(
        &mut file,
        "/sampling",
        json!({ "instants": { "periodic": { "interval_s": interval_s } } }),
    );
    let precise = json!({ "dormand_prince853": { "tolerance": 1e-14 } });
    let root = file.as_object_mut().expect("an object");
    root.insert("integrator".to_string(), precise);
    for (place, keys) in [
        (
            body,
            &["reference", "faults", "actuators", "sensor", "wheels"][..],
        ),
        ("", &["requirements", "link", "network"]),
    ] {
        let object = file.pointer_mut(place).and_then(Value::as_object_mut);
        let object = object.expect("an object");
        object.retain(|key, _| !keys.contains(&key.as_str()));
    }
    set(
        &mut file,
        &at("disturbance"),
        json!({ "bias_nm": [1e-4, -2e-4, 1.5e-4] }),
    );
    if name.starts_with("yang") {
        // Near to its target it leaves its envelope.
        set(&mut file, "/duration_s", json!(30.0));
        return file;
    }
    set(
        &mut file,
        &at("initial_attitude"),
        json!({ "quaternion_scalar_first": [0.9995998799519872, 0.02, -0.015, 0.013] }),
    );
    set(
        &mut file,
        &at("initial_rate_rad_s"),
        json!([0.001, 0.002, -0.001]),
    );
    file
}

#[test]
fn in_basilisk_the_controllers_send_at_the_same_instants_and_command_the_same() {
    let modules = ["Basilisk", "numba"];
    if python(&modules, "pass", &[]).is_none() {
        return;
    }
    let design = xu2020_design();
    let mut yang = scenario("yang2025.json", 0.01);
    set(
        &mut yang,
        "/controller/yang2025/fault_estimation",
        json!({ "low_pass": { "time_constant_s": 1.0 } }),
    );
    let cases = [
        (
            Some(design),
            scenario("xu2020-closed-loop.json", 0.1),
            "Xu2020",
        ),
        (None, scenario("wu2018.json", 0.1), "Wu2018"),
        (None, scenario("lei2022.json", 0.02), "Lei2022"),
        (None, yang, "Yang2025"),
    ];
    for (design, scenario, class) in cases {
        let folder = folder();
        let file = write(folder.path(), "scenario.json", scenario.to_string());
        let run = folder.path().join("run");
        let mut simulate = command();
        simulate.arg("simulate").arg(&file).arg("-o").arg(&run);
        if let Some(design) = design {
            simulate.arg("--design").arg(design);
        }
        let run_of_it = Run::new(simulate.output().expect("the command runs"));
        assert!(matches!(run_of_it.status, Some(0 | 2)), "{run_of_it:?}");
        let source = design.unwrap_or(&file);
        let module = folder.path().join("controller.py");
        export(source, "basilisk", Some(&module));
        let flight = Flight::of(source, &[]);
        let trajectory = run.join("trajectory.csv");
        let vectors = flight.path("_vectors.h");
        let arguments = [
            module.as_path(),
            &file,
            &trajectory,
            &vectors,
            Path::new(class),
        ];
        let said = python(&modules, SCRIPT, &arguments).expect("Python is there");
        let last = said.lines().last().expect("a line");
        println!("{class}: {last}");
        let found: Value = serde_json::from_str(last).expect("JSON");
        let events = number(&found, "/events");
        assert!(events > 5.0, "{class}: {found}");
        assert!(number(&found, "/torque") < 1e-8, "{class}: {found}");
        assert!(number(&found, "/attitude") < 1e-9, "{class}: {found}");
        if !found["vectors"].is_null() {
            assert!(number(&found, "/vectors") < 1e-12, "{class}: {found}");
        }
    }
}

/// A design of a spacecraft with sensors that err and wheels that turn.
fn with_wheels_and_noise(folder: &Path) -> PathBuf {
    let mut model = json(&shipped("xu2020.json"));
    let object = model.as_object_mut().expect("an object");
    object.insert(
        "imperfections".to_string(),
        json!({
            "measurement": { "rate_rad_s": 1e-5, "attitude_deg": 0.0028 },
            "wheel_momentum_nms": 5.0
        }),
    );
    set(&mut model, "/specs/trigger_floor", json!("auto"));
    let model = write(folder, "wheels.json", model.to_string());
    let design = folder.join("design.json");
    let run = command()
        .arg("synthesize")
        .arg(model)
        .arg("-o")
        .arg(&design)
        .output();
    Run::new(run.expect("the command runs")).ends_with(0);
    design
}

#[test]
fn in_basilisk_with_wheels_friction_and_noise_the_proved_bound_is_kept() {
    let modules = ["Basilisk", "numba"];
    if python(&modules, "pass", &[]).is_none() {
        return;
    }
    let folder = folder();
    let design = with_wheels_and_noise(folder.path());
    let module = folder.path().join("controller.py");
    export(&design, "basilisk", Some(&module)).ends_with(0);
    let proved = json(&design);
    let pointing = 2.0
        * number(&proved, "/certificate/final_bounds/vector_part")
            .asin()
            .to_degrees();
    // At rest, near the edge of the certified set; and near the target.
    for angle_deg in [9.6, 3.0] {
        let mut file = scenario("xu2020-closed-loop.json", 0.1);
        let attitude =
            json!({ "axis_angle": { "axis": [-0.3802, 0.2124, 0.5013], "angle_deg": angle_deg } });
        set(&mut file, "/system/rigid_body/initial_attitude", attitude);
        set(
            &mut file,
            "/system/rigid_body/initial_rate_rad_s",
            json!([0, 0, 0]),
        );
        set(&mut file, "/duration_s", json!(200.0));
        let file = write(folder.path(), "scenario.json", file.to_string());
        let run = folder.path().join("run");
        let mut simulate = command();
        simulate
            .arg("simulate")
            .arg(&file)
            .arg("-o")
            .arg(&run)
            .arg("--design")
            .arg(&design);
        let done = Run::new(simulate.output().expect("the command runs"));
        assert!(matches!(done.status, Some(0 | 2)), "{done:?}");
        let flown = |multiple: &str| -> Value {
            let trajectory = run.join("trajectory.csv");
            let arguments = [&module, &design, &trajectory].map(PathBuf::as_path);
            let arguments = arguments
                .into_iter()
                .chain(["Xu2020", multiple].map(Path::new));
            let said =
                python(&modules, WHEELS, &arguments.collect::<Vec<_>>()).expect("Python is there");
            println!("{angle_deg} deg, disturbance times {multiple}: {said}");
            serde_json::from_str(said.lines().last().expect("a line")).expect("JSON")
        };
        let found = flown("1");
        assert!(
            number(&found, "/disturbance") < 0.01 && number(&found, "/momentum") < 5.0,
            "{found}"
        );
        assert!(number(&found, "/ratio") <= 1.0, "{found}");
        assert!(number(&found, "/pointing_deg") <= pointing, "{found}");
        assert!(
            number(&found, "/messages") < 0.08 * number(&found, "/samples"),
            "{found}"
        );
        // A disturbance far beyond the proof breaks the bound: it can be broken.
        assert!(number(&flown("40"), "/ratio") > 1.0);
    }
}

#[test]
fn a_module_for_basilisk_says_what_it_is_and_what_cannot_be_one_is_refused() {
    let folder = folder();
    let out = folder.path().join("controller.py");
    export(xu2020_design(), "basilisk", Some(&out)).ends_with(0);
    let written = text(&out);
    for expected in [
        "# PROVED: ",
        "# The proof assumes:",
        "# design_sha256: ",
        "class Xu2020(NumbaModel)",
    ] {
        assert!(written.contains(expected), "{expected}");
    }
    let left = written.replace("@nb.njit", "").replace("@property", "");
    assert!(!left.replace("@staticmethod", "").contains('@'));
    // Its own it replaces, others' it does not.
    export(xu2020_design(), "basilisk", Some(&out)).ends_with(0);
    write(folder.path(), "controller.py", "print('mine')\n");
    export(xu2020_design(), "basilisk", Some(&out)).refusal();
    let other = folder.path().join("other.py");
    for (file, expected) in [
        (double_integrator_design(), "spacecraft"),
        (&shipped("xu2020.json"), "this is a model file"),
        (
            &shipped("xu2020-closed-loop.json"),
            "design file; export that file",
        ),
        (run_folder(), "this is a trajectory"),
    ] {
        let message = export(file, "basilisk", Some(&other)).refusal();
        assert!(message.contains(expected), "{message}");
        assert!(!other.exists());
    }
}
