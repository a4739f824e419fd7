//! Tampered designs of problem files, against exact arithmetic.

use super::*;

/// Every answer of the check to a changed number, against exact arithmetic.
#[derive(Default, Debug)]
struct Tally {
    invalid: usize,
    proved: usize,
    refused: usize,
}

fn compare(change: &Change, file: &ProblemDesignFile, problem: &Problem, tally: &mut Tally) {
    let report = file.verify(problem).expect("checked when it was read");
    let found = file.feedback(problem).expect("checked when it was read");
    let mut truth = Vec::new();
    problem
        .task
        .for_each_condition::<Exact>(&problem.plant, &found, |name, matrix| {
            truth.push((name, exactly_positive_definite(&matrix)));
        });
    let mut rooms = Vec::new();
    problem
        .task
        .for_each_condition::<Interval>(&problem.plant, &found, |_, matrix| {
            rooms.push(scaled_smallest_eigenvalue(&matrix));
        });
    assert_eq!(truth.len(), report.conditions.len());
    for (condition, ((name, holds), room)) in report.conditions.iter().zip(truth.iter().zip(rooms))
    {
        assert_eq!(&condition.name, name);
        let what = format!("{:?} = {:e}: {name}", change.paths, change.value);
        let proved = condition.margin >= 0.0;
        assert!(*holds || !proved, "a false proof: {what}");
        assert!(
            !holds || proved || room < ROOM,
            "true with room {room:e}, yet refused: {what}"
        );
    }
    let all = truth.iter().all(|(_, holds)| *holds);
    match report.verdict {
        Verdict::Proved => {
            assert!(all);
            tally.proved += 1;
        }
        Verdict::NotProved => tally.refused += 1,
    }
}

#[test]
fn the_check_of_a_tampered_design_agrees_with_exact_arithmetic() {
    let names = [
        "oscillator-stability",
        "uncertain-coupling",
        "buffer-network",
        "saturated-pendulum",
    ];
    for name in names {
        let (design, _) = proved(&shipped(name));
        let design: Value = serde_json::from_str(&design.file.to_json()).expect("JSON");
        let by = [&TEN_PERCENT[..], &GROSS[..]].concat();
        let mut tally = Tally::default();
        for change in changes(&design, &by) {
            match ProblemDesignFile::from_json(&change.text(&design)) {
                Err(error) => {
                    assert!(error.to_string().contains("field"), "{error}");
                    tally.invalid += 1;
                }
                Ok((file, problem)) => compare(&change, &file, &problem, &mut tally),
            }
        }
        assert!(
            tally.proved > 0 && tally.refused > 20 && tally.invalid > 5,
            "{name}: {tally:?}"
        );
    }
}

#[test]
fn a_better_guarantee_than_the_proof_gives_is_not_proved() {
    for (name, factor, condition) in [
        ("oscillator-stability", 0.99, "overshoot"),
        ("buffer-network", 0.99, "bounded real vertex 1"),
        ("saturated-pendulum", 1.01, "contains reference ellipsoid"),
    ] {
        let (mut design, _) = proved(&shipped(name));
        design.file.certificate.guarantee *= factor;
        let problem = problem(&shipped(name));
        let report = design.file.verify(&problem).expect("a valid file");
        assert_eq!(report.verdict, Verdict::NotProved);
        let failed = report.conditions.iter().filter(|c| c.margin < 0.0);
        let failed: Vec<&str> = failed.map(|c| c.name.as_str()).collect();
        assert_eq!(failed, [condition], "{name}");
    }
}
