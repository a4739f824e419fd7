//! No command takes away or replaces what it did not make.

use std::path::Path;

use serde_json::{json, Value};

use crate::support::refusals::assert_says;
use crate::support::*;

/// A campaign of 3 runs, with further arguments.
fn campaign(scenario: &Path, out: &Path, further: &[&str]) -> Run {
    let own = ["campaign", word(scenario), "--runs", "3", "-o", word(out)];
    steadfast([&own[..], further].concat())
}

/// Wu's scenario of 3 seconds, and a folder for a campaign of it in which the folder `inside` has a file of the user's.
fn prepared(folder: &Path, inside: &str, name: &str) -> [std::path::PathBuf; 3] {
    let scenario = cut("wu2018.json", 3.0, folder);
    let out = folder.join("out");
    let inside = out.join(inside);
    std::fs::create_dir_all(&inside).expect("a folder");
    let mine = write(&inside, name, "thesis");
    [scenario, out, mine]
}

#[test]
fn a_campaign_leaves_a_folder_of_the_users_that_is_called_like_one_of_its_own() {
    for (inside, name) in [
        ("parts", "chapter1.tex"),
        ("parts/sub/deep", "x.txt"),
        ("parts", "part-000000.parquet"),
        ("failed/run-000001", "scenario.json"),
    ] {
        let folder = folder();
        let [scenario, out, mine] = prepared(folder.path(), inside, name);
        let message = campaign(&scenario, &out, &[]).refusal();
        assert_says(&message, &["which is not of this work", "--force"]);
        assert_eq!(text(&mine), "thesis");
    }
    // Only its own parts go away, even by force.
    let folder = folder();
    let [scenario, out, mine] = prepared(folder.path(), "parts/sub", "x.txt");
    let beside = write(&out.join("parts"), "chapter1.tex", "thesis");
    let run = campaign(&scenario, &out, &["--force"]);
    assert_ne!(run.status, Some(1), "{run:?}");
    assert_eq!([text(&mine), text(&beside)], ["thesis", "thesis"]);
    assert_eq!(names_in(&out.join("parts")), ["chapter1.tex", "sub"]);
    assert!(out.join("runs.parquet").exists());
}

#[test]
fn a_campaign_removes_a_kept_run_without_what_the_user_has_put_beside_it() {
    let folder = folder();
    let scenario = cut("wu2018.json", 3.0, folder.path());
    let mut file = json(&scenario);
    file["requirements"] = json!([{ "metric": "triggers", "at_most": 0 }]);
    let scenario = write(folder.path(), "missed.json", file.to_string());
    let out = folder.path().join("out");
    campaign(&scenario, &out, &["--keep", "3"]).ends_with(2);
    let failed = out.join("failed");
    let notes = write(&failed.join("run-000001"), "notes.txt", "thesis");
    let other = write(&failed, "run-mine", "thesis");
    campaign(&scenario, &out, &["--keep", "0"]).ends_with(2);
    assert_eq!([text(&notes), text(&other)], ["thesis", "thesis"]);
    assert_eq!(names_in(&failed), ["run-000001", "run-mine"]);
    assert_eq!(names_in(&failed.join("run-000001")), ["notes.txt"]);
}

#[test]
#[cfg(unix)]
fn a_campaign_follows_no_link_in_the_place_of_a_folder_of_its_own() {
    for name in ["parts", "failed"] {
        let folder = folder();
        let scenario = cut("wu2018.json", 3.0, folder.path());
        let (target, out) = (folder.path().join("target"), folder.path().join("out"));
        std::fs::create_dir(&target).expect("a folder");
        std::fs::create_dir(&out).expect("a folder");
        let mine = write(&target, "part-000000.parquet", "thesis");
        let link = out.join(name);
        std::os::unix::fs::symlink(&target, &link).expect("a link");
        let message = campaign(&scenario, &out, &["--force"]).refusal();
        assert_says(&message, &[name, "this is a link"]);
        assert!(link.symlink_metadata().expect("it is there").is_symlink());
        assert_eq!(text(&mine), "thesis");
    }
}

#[test]
fn a_file_is_of_the_same_kind_only_where_it_reads_as_one() {
    let folder = folder();
    let cart = shipped("double-integrator.json");
    let cart = word(&cart);
    let requirements = shipped("requirements-large.json");
    let mut cut_design = json(double_integrator_design());
    remove(&mut cut_design, "/certificate/lyapunov");
    let cases: [(&[&str], Value, &str); 4] = [
        (
            &["tune", word(&requirements)],
            json!({ "duration_s": 3, "film": "Alien" }),
            "scenario",
        ),
        (
            &["synthesize", cart],
            json!({ "certificate": "my TLS notes", "controller": 1 }),
            "design",
        ),
        (&["synthesize", cart], cut_design, "design"),
        (
            &["feasibility", cart],
            json!({ "infeasibility": "notes" }),
            "infeasibility",
        ),
    ];
    for (command, contents, kind) in cases {
        let contents = contents.to_string();
        let target = write(folder.path(), "mine.json", &contents);
        let arguments = [command, &["-o", word(&target)]].concat();
        let message = steadfast(arguments).refusal();
        assert_says(
            &message,
            &[
                &format!("something that is no valid {kind} file"),
                "--force",
            ],
        );
        assert_eq!(text(&target), contents);
    }
    // A design of an older version of the format is a design.
    let mut older = json(double_integrator_design());
    set(&mut older, "/schema_version", json!(0));
    let target = write(folder.path(), "older.json", older.to_string());
    steadfast(["synthesize", cart, "-o", word(&target)]).ends_with(0);
}

#[test]
fn the_summary_of_a_run_is_no_design_though_it_tells_of_one() {
    let folder = folder();
    let scenario = cut("double-integrator-closed-loop.json", 3.0, folder.path());
    let design = double_integrator_design();
    let out = folder.path().join("run");
    simulated(&scenario, Some(design), &out);
    let summary = out.join("summary.json");
    let before = text(&summary);
    let cart = shipped("double-integrator.json");
    let message = steadfast(["synthesize", word(&cart), "-o", word(&summary)]).refusal();
    assert_says(
        &message,
        &["holds a summary file, where a design file would be written"],
    );
    let message = steadfast(["verify", word(&summary)]).refusal();
    assert_says(
        &message,
        &["this is a summary file; a design file is expected here"],
    );
    let run = steadfast(["check", word(&summary)]).ends_with(0);
    assert!(run.stdout.contains("valid summary file"), "{run:?}");
    // An export takes its provenance from the summary: it is an input.
    let trajectory = out.join("trajectory.csv");
    let export = [
        "export",
        word(&trajectory),
        "--format",
        "mat",
        "-o",
        word(&summary),
        "--force",
    ];
    let message = steadfast(export).refusal();
    assert_says(&message, &["this is the input; it would be overwritten"]);
    assert_eq!(text(&summary), before);
}

#[test]
fn a_run_and_a_campaign_do_not_share_a_folder_and_their_pages_do_not_replace_each_other() {
    let folder = folder();
    let scenario = cut("wu2018.json", 3.0, folder.path());
    let [runs, run] = ["campaign", "run"].map(|name| folder.path().join(name));
    assert_ne!(campaign(&scenario, &runs, &[]).status, Some(1));
    steadfast(["report", word(&runs)]).ends_with(0);
    let page = text(&runs.join("report.html"));
    let simulate = ["simulate", word(&scenario), "-o"];
    let message = steadfast([&simulate[..], &[word(&runs)]].concat()).refusal();
    assert_says(&message, &["report.html", "holds the page of a campaign"]);
    std::fs::remove_file(runs.join("report.html")).expect("it is there");
    let message = steadfast([&simulate[..], &[word(&runs)]].concat()).refusal();
    assert_says(&message, &["holds a campaign; choose another folder"]);
    steadfast(["report", word(&runs)]).ends_with(0);
    assert_eq!(text(&runs.join("report.html")), page);

    simulated(&scenario, None, &run);
    let message = campaign(&scenario, &run, &[]).refusal();
    assert_says(&message, &["holds a run; choose another folder"]);
    let target = runs.join("report.html");
    let message = steadfast(["report", word(&run), "-o", word(&target)]).refusal();
    assert_says(&message, &["where the page of a run"]);
    assert_eq!(text(&target), page);
}
