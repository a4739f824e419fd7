//! Starts on the boundary of the certified set, and a disk that is full.

use super::*;

#[test]
fn starts_on_the_certified_boundary_are_on_it_and_the_proof_covers_them() {
    let folder = folder();
    let mut file = json(&shipped("xu2020-campaign.json"));
    set(&mut file, "/duration_s", json!(10));
    set(&mut file, "/metrics/tail_s", json!(5));
    let file = write(folder.path(), "xu.json", file.to_string());
    let out = folder.path().join("out");
    let design = xu2020_design().display().to_string();
    let run = campaign(&file, 40, &out, &["--design", &design, "--json"]).ends_with(0);
    let report = run.json();
    assert_eq!(
        (&report["failures"], &report["covered_runs"]),
        (&json!(0), &json!(40))
    );
    let runs = out.join("runs.parquet");
    let levels = column_f64(&runs, "start_level").expect("a column");
    assert!(levels
        .iter()
        .flatten()
        .all(|level| (level - 1.0).abs() < 1e-12));
    let ratios = column_f64(&runs, "lyapunov_ratio").expect("a column");
    assert!(ratios
        .iter()
        .flatten()
        .all(|ratio| *ratio > 0.5 && *ratio <= 1.0));
    assert!(out.join("design.json").exists());

    let mut model = json(&shipped("double-integrator-closed-loop.json"));
    set(
        &mut model,
        "/dispersions",
        json!({ "certified_boundary": { "level": 0.5 } }),
    );
    let file = write(folder.path(), "model.json", model.to_string());
    let design = double_integrator_design().display().to_string();
    let out = folder.path().join("states");
    let run = campaign(&file, 5, &out, &["--design", &design, "--json"]);
    assert_eq!(run.json()["profile"]["quantities"], json!(["state_norm"]));
    let levels = column_f64(&out.join("runs.parquet"), "start_level").expect("a column");
    assert!(levels
        .iter()
        .flatten()
        .all(|level| (level - 0.5).abs() < 1e-12));
}

/// A small file system in memory, which is full soon.
#[cfg(target_os = "linux")]
struct SmallDisk(tempfile::TempDir);

#[cfg(target_os = "linux")]
impl SmallDisk {
    fn new(size: &str) -> Option<Self> {
        let folder = folder();
        let mounted = std::process::Command::new("mount")
            .args(["-t", "tmpfs", "-o", size, "tmpfs"])
            .arg(folder.path())
            .stderr(Stdio::null())
            .status();
        mounted
            .is_ok_and(|status| status.success())
            .then_some(SmallDisk(folder))
    }
}

#[cfg(target_os = "linux")]
impl Drop for SmallDisk {
    fn drop(&mut self) {
        let _ = std::process::Command::new("umount")
            .arg(self.0.path())
            .status();
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_said_and_what_was_done_can_be_read() {
    let Some(disk) = SmallDisk::new("size=1m") else {
        eprintln!("SKIPPED: a small file system cannot be mounted here");
        return;
    };
    let folder = folder();
    let file = short(folder.path(), "independent");
    let out = disk.0.path().join("out");
    let refusal = campaign(&file, 600, &out, &["--jobs", "1"]).refusal();
    assert!(
        refusal.contains("cannot be written: No space left"),
        "{refusal}"
    );
    assert!(
        refusal.contains("of 600 runs are done and kept"),
        "{refusal}"
    );
    assert!(CampaignFile::read(&out).is_ok());
    let parts = names_in(&out.join("parts"));
    let parts = parts.iter().filter(|name| name.starts_with("part-"));
    let rows: usize = parts
        .map(|name| {
            column_f64(&out.join("parts").join(name), "triggers")
                .expect("a part")
                .len()
        })
        .sum();
    assert!(rows > 0);
}
