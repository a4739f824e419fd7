//! `steadfast report` of a campaign's folder: the numbers on the page are those of the tables.

use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use crate::support::*;
use serde_json::{json, Value};
use tempfile::TempDir;

/// Runs of the campaign.
const RUNS: u64 = 40;

/// A short campaign of which some runs fail, with one limit that is never and one that is often missed.
fn campaign() -> &'static Path {
    static FOLDER: OnceLock<(TempDir, PathBuf)> = OnceLock::new();
    let (_, path) = FOLDER.get_or_init(|| {
        let folder = folder();
        let mut scenario = json(&shipped("wu2018-campaign.json"));
        scenario["duration_s"] = json!(150.0);
        scenario["metrics"]["tail_s"] = json!(50.0);
        scenario["requirements"] = json!([
            { "metric": "settle_seconds", "at_most": 60.0 },
            { "metric": "max_torque", "at_most": 1e9 }
        ]);
        let file = write(folder.path(), "short.json", scenario.to_string());
        let out = folder.path().join("a campaign & more");
        let runs = RUNS.to_string();
        let run = command()
            .arg("campaign")
            .arg(&file)
            .args(["--runs", &runs, "--seed", "3", "--keep", "2", "-o"])
            .arg(&out)
            .output();
        Run::new(run.expect("the command runs")).ends_with(2);
        (folder, out)
    });
    path
}

fn report(folder: &Path, output: Option<&Path>) -> Run {
    let mut command = command();
    command.arg("report").arg(folder);
    if let Some(path) = output {
        command.arg("-o").arg(path);
    }
    Run::new(command.output().expect("the command runs"))
}

fn results() -> Value {
    json(&campaign().join("campaign.json"))["results"].clone()
}

fn page() -> &'static str {
    static PAGE: OnceLock<String> = OnceLock::new();
    PAGE.get_or_init(|| {
        report(campaign(), None).ends_with(0);
        text(&campaign().join("report.html"))
    })
}

/// The rows of the table that follows a text: each the texts of its cells.
fn table_after(page: &str, start: &str) -> Vec<Vec<String>> {
    let rest = page
        .split(start)
        .nth(1)
        .unwrap_or_else(|| panic!("no '{start}'"));
    let table = rest.split("</table>").next().expect("a table");
    let rows = table.split("<tr>").skip(1);
    rows.map(|row| {
        let cells = row.split("<td").skip(1);
        cells
            .map(|cell| {
                let text = cell.split_once('>').expect("a tag").1;
                text.split("</td>").next().expect("an end").to_string()
            })
            .collect()
    })
    .collect()
}

#[test]
fn the_verdict_counts_the_runs_and_says_how_well_the_rate_is_known() {
    let results = results();
    let failures = number(&results, "/failures") as u64;
    assert!(failures > 2 && failures < RUNS, "{failures} failures");
    let sentence = format!(
        "<strong>{} of {RUNS} runs met every requirement.</strong>",
        RUNS - failures
    );
    assert!(page().contains(&sentence), "no '{sentence}'");
    assert!(page().contains("95 % confidence interval") && page().contains("Clopper-Pearson"));
}

#[test]
fn the_requirements_are_those_of_the_record() {
    let rows = table_after(page(), "<h2>Requirements</h2>");
    let results = results();
    let missed = number(&results, "/requirements/0/missed");
    assert_eq!(
        rows[1][..3],
        ["settle_seconds at most", "60", &missed.to_string()]
    );
    assert_eq!(rows[2][0], "max_torque at most");
    assert_eq!(rows[2][2], "0");
}

#[test]
fn the_worst_runs_come_first_and_their_links_lead_to_files() {
    let rows = table_after(page(), "worst runs</h2>");
    assert_eq!(rows.len(), 21);
    let kept = results()["kept"].as_array().expect("a list").clone();
    assert_eq!(kept.len(), 2);
    for (row, run) in rows[1..].iter().zip(&kept) {
        assert_eq!(row[0], run.to_string());
        assert!(row[1] == "missed" || row[1] == "diverged");
        let links: Vec<&str> = row.last().unwrap().split("href=\"").skip(1).collect();
        assert_eq!(links.len(), 3);
        for link in links {
            let target = link.split('"').next().unwrap();
            assert!(campaign().join(target).is_file(), "{target}");
        }
    }
    assert_eq!(rows[3].last().unwrap(), "not kept");
}

#[test]
fn the_command_on_the_page_makes_a_run_again() {
    let command_line = page().split("<code>steadfast ").nth(1).expect("a command");
    let command_line = command_line.split("</code>").next().unwrap();
    let run = results()["kept"][0].to_string();
    let folder = folder();
    let out = folder.path().join("again");
    let arguments = command_line.replace("run-K", out.to_str().unwrap());
    let arguments = arguments.replace(" K ", &format!(" {run} "));
    let made = command()
        .args(arguments.split(' '))
        .current_dir(campaign())
        .output();
    Run::new(made.expect("the command runs")).ends_with(2);
    let kept = campaign().join("failed").join(format!("run-{run:0>6}"));
    assert_eq!(
        text(&out.join("trajectory.csv")),
        text(&kept.join("trajectory.csv"))
    );
}

#[test]
fn the_page_is_one_file_with_its_figures() {
    assert_eq!(
        page().matches("<svg ").count(),
        page().matches("</svg>").count()
    );
    assert!(page().matches("<svg ").count() >= 4);
    for elsewhere in ["http://", "https://", "<script", "<link", "<img", "src="] {
        let found = page().replace("http://www.w3.org/2000/svg", "");
        assert!(!found.contains(elsewhere), "{elsewhere}");
    }
    for heading in [
        "Attitude error of all runs",
        "Settling time: share",
        "Messages: share",
    ] {
        assert!(page().contains(heading), "{heading}");
    }
    assert!(page().contains("prefers-color-scheme: dark") && page().contains("@media print"));
}

#[test]
fn links_of_a_page_elsewhere_lead_to_the_same_files() {
    let elsewhere = folder();
    let path = elsewhere.path().join("page.html");
    report(campaign(), Some(&path)).ends_with(0);
    let page = text(&path);
    let link = page.split("href=\"").nth(1).expect("a link");
    let link = link
        .split('"')
        .next()
        .unwrap()
        .replace("%20", " ")
        .replace("%26", "&");
    assert!(
        elsewhere
            .path()
            .canonicalize()
            .unwrap()
            .join(&link)
            .is_file(),
        "{link}"
    );
}

#[test]
fn a_campaign_that_is_not_complete_or_not_one_is_refused_in_a_sentence() {
    let folder = folder();
    let mut record = json(&campaign().join("campaign.json"));
    record["state"] = json!("running");
    record["results"] = Value::Null;
    write(folder.path(), "campaign.json", record.to_string());
    let message = report(folder.path(), None).refusal();
    assert!(
        message.contains("the campaign is not complete"),
        "{message}"
    );
    write(folder.path(), "campaign.json", "{}");
    let message = report(folder.path(), None).refusal();
    assert!(
        message.contains("not the record of a campaign"),
        "{message}"
    );
    write(
        folder.path(),
        "campaign.json",
        text(&campaign().join("campaign.json")),
    );
    let message = report(folder.path(), None).refusal();
    assert!(message.contains("runs.parquet"), "{message}");
    write(folder.path(), "runs.parquet", "no table");
    let message = report(folder.path(), None).refusal();
    assert!(
        message.contains("is not a table that can be read"),
        "{message}"
    );
    assert!(!folder.path().join("report.html").exists());
}

#[test]
fn a_page_never_takes_the_place_of_what_it_is_made_of() {
    for name in [
        "campaign.json",
        "runs.parquet",
        "profiles.parquet",
        "scenario.json",
    ] {
        let file = campaign().join(name);
        let before = std::fs::read(&file).expect("a file of the campaign");
        let message = report(campaign(), Some(&file)).refusal();
        assert!(message.ends_with("it would be overwritten"), "{message}");
        assert_eq!(std::fs::read(&file).expect("it is still there"), before);
    }
    let file = campaign().join("scenario.json");
    let message = report(&file, None).refusal();
    assert!(
        message.contains("the folder of a run or of a campaign is expected"),
        "{message}"
    );
}
