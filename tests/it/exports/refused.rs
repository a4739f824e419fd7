//! What does not go together is refused in one sentence.

use super::*;

#[test]
fn what_does_not_go_together_is_refused_in_one_sentence() {
    let run = run_folder();
    let trajectory = run.join("trajectory.csv");
    let design = xu2020_design();
    let (model, scenario) = (shipped("xu2020.json"), shipped("wu2018.json"));
    let folder = folder();
    let out = folder.path().join("out");
    let cases = [
        (run, "c", "c is for design files"),
        (trajectory.as_path(), "c", "c is for design files"),
        (run, "sdpa", "sdpa is for model, problem and design files"),
        (design, "parquet", "parquet is for trajectories"),
        (&model, "c", "this is a model file; c is for design files"),
        (
            &model,
            "parquet",
            "parquet is for design files and trajectories",
        ),
        (&scenario, "mat", "this is a scenario file"),
        (folder.path(), "csv", "holds no trajectory.csv"),
    ];
    for (file, format, expected) in cases {
        let message = export(file, format, Some(&out)).refusal();
        assert!(message.contains(expected), "{message}");
        assert!(!out.exists(), "{message}");
    }
    let message = export(design, "mat", None).refusal();
    assert!(message.starts_with("argument --output:"), "{message}");
    let form = ["--format", "c", "--form", "full"];
    let refused = command().arg("export").arg(design).args(form).output();
    let message = Run::new(refused.unwrap()).refusal();
    assert!(message.starts_with("argument --form:"), "{message}");
    // The input is never overwritten.
    let message = export(run, "csv", Some(&trajectory)).refusal();
    assert!(message.contains("would be overwritten"), "{message}");
    let bad = write(folder.path(), "bad.csv", "time_s,x\n0,one\n");
    let message = export(&bad, "mat", Some(&out)).refusal();
    assert!(
        message.contains("line 2: 'one' is not a number"),
        "{message}"
    );
    for (contents, expected) in [
        ("a,b\n1,2\n", "the first column is 'a'; it must be time_s"),
        ("time_s,sample,sent\n", "no row below the header"),
        (
            "time_s,sample,sent\n0,1,1\nnan,0,0\n",
            "line 3: the time is NaN s after 0 s",
        ),
        ("time_s,sample\n0,1\n", "no column sent"),
    ] {
        let foreign = write(folder.path(), "foreign.csv", contents);
        for format in ["mat", "parquet", "csv"] {
            let message = export(&foreign, format, Some(&out)).refusal();
            assert!(message.contains(expected), "{message}");
        }
    }
    let odd = write(
        folder.path(),
        "odd.csv",
        "time_s,2 x,sample,sent\n0,1,1,1\n",
    );
    let message = export(&odd, "mat", Some(&out)).refusal();
    assert!(
        message.contains("no name of a MATLAB variable"),
        "{message}"
    );
}
