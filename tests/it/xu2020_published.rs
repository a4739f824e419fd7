//! Xu and Huang 2020 as published: the gains of Appendix A from the paper's start.

use steadfast::controllers::ControllerChoice;
use steadfast::report;
use steadfast::run::outcome::RunOutcome;
use steadfast::run::simulate;
use steadfast::scenario::Scenario;

fn clamped() -> Scenario {
    Scenario::from_json(include_str!("../../models/xu2020-published.json")).unwrap()
}

fn unclamped() -> Scenario {
    Scenario::from_json(include_str!("../../models/xu2020-published-unclamped.json")).unwrap()
}

fn run(scenario: &Scenario) -> RunOutcome {
    simulate(scenario, None, true).unwrap()
}

/// Only the first gain, so that no membership function is assumed.
fn with_first_gain(mut scenario: Scenario) -> Scenario {
    match &mut scenario.controller {
        ControllerChoice::Xu(choice) => choice.rules.truncate(1),
        _ => panic!("given gains are expected"),
    }
    scenario
}

#[test]
fn with_the_threshold_clamped_the_papers_slew_settles_within_its_torque_limit() {
    for scenario in [clamped(), with_first_gain(clamped())] {
        let summary = run(&scenario).summary;
        println!(
            "{} messages in {} samples, settled {:?}, rms {:?}",
            summary.triggers, summary.samples, summary.settle_seconds, summary.rms_error_deg
        );
        assert!(
            (55..=67).contains(&summary.triggers),
            "{}",
            summary.triggers
        );
        assert!((3900..=4060).contains(&summary.samples));
        let settled = summary.settle_seconds.unwrap();
        assert!((38.0..48.0).contains(&settled), "{settled}");
        let rms = summary.rms_error_deg.unwrap();
        assert!((0.008..0.025).contains(&rms), "{rms}");
        assert_eq!(summary.max_torque, 2.0);
        assert_eq!(summary.held_samples, 0);
    }
}

#[test]
fn with_the_threshold_as_printed_the_error_does_not_settle() {
    for scenario in [unclamped(), with_first_gain(unclamped())] {
        let summary = run(&scenario).summary;
        println!(
            "{} messages, final error {:?}, rms {:?}",
            summary.triggers, summary.final_error_deg, summary.rms_error_deg
        );
        assert_eq!(summary.settle_seconds, None);
        assert!(summary.rms_error_deg.unwrap() > 0.3);
        assert!(
            (45..=60).contains(&summary.triggers),
            "{}",
            summary.triggers
        );
    }
}

#[test]
fn the_report_shows_the_papers_figures_and_what_is_not_confirmed() {
    let outcome = run(&clamped());
    let page = report::page(&outcome.summary, outcome.trajectory.as_ref().unwrap()).unwrap();
    for title in [
        "Error quaternion",
        "Body rate",
        "Torque",
        "Inter-event times",
    ] {
        assert!(page.contains(&format!("<h2>{title}</h2>")), "{title}");
    }
    assert!(page.matches("<svg").count() >= 5);
    assert!(page.contains("Nothing is proved for this controller."));
    let start = "The start is not in the certified set: |x| is 0.6640, and (20) with the claimed \
                 gamma = 0.1616 and phi = 0.05 /s confines the set to |x| &lt;= 0.0899.";
    assert!(page.contains(start));
    assert!(page.contains("The claimed gamma = 0.1616 is not confirmed"));
    // Readable offline: nothing is fetched.
    assert!(
        !page.contains("http://")
            || page.matches("http://").count() == page.matches("http://www.w3.org").count()
    );
    assert!(!page.contains("https://") && !page.contains("<script") && !page.contains("<link"));
}

#[test]
fn the_unclamped_update_is_marked_uncertified() {
    let notes = run(&unclamped()).summary.notes.join(" ");
    assert!(notes.contains("no certificate can cover it"));
    assert!(!run(&clamped())
        .summary
        .notes
        .join(" ")
        .contains("no certificate can cover it"));
}
