//! One gain, two certificates.

use synth::model::Model;
use synth::solve::Clarabel;
use synth::synthesis::{synthesize_both, BothOutcome, Form};

#[test]
#[ignore]
fn explore() {
    let path = std::env::var("BOTH_MODEL").unwrap_or("../models/xu2020-both.json".into());
    let text = std::fs::read_to_string(path).unwrap();
    let model = Model::from_json(&text).unwrap();
    let structured = std::env::var("BOTH_STRUCTURED").is_ok();
    let start = std::time::Instant::now();
    let outcome = match structured {
        true => synthesize_both(
            &model,
            &text,
            Form::Slack,
            &synth::solve::Structured::default(),
            None,
        ),
        false => synthesize_both(&model, &text, Form::Reduced, &Clarabel::default(), None),
    };
    match outcome.unwrap() {
        BothOutcome::Solved(design, _) => {
            for run in &design.file.provenance.solver_runs {
                println!(
                    "{} {} {} {} {:.2}",
                    run.goal, run.status, run.objective, run.iterations, run.seconds
                );
            }
            let c = &design.file.certificate;
            let o = design.file.outer.as_ref().unwrap();
            println!(
                "{:?} gamma {} gg {} xi {}",
                design.report.verdict, c.gamma, c.guaranteed_gain, c.xi
            );
            println!(
                "outer gamma {} gg {} xi {} N {:?}",
                o.certificate.gamma,
                o.certificate.guaranteed_gain,
                o.certificate.xi,
                o.certificate.anti_windup
            );
            println!(
                "F {:?}\nN {:?}",
                design.file.controller.gains, c.anti_windup
            );
            println!("worst {:?}", design.report.worst());
            for k in design.report.conditions.iter().filter(|k| k.margin < 0.0) {
                println!("{} {}", k.name, k.margin);
            }
            if let Ok(path) = std::env::var("BOTH_OUT") {
                std::fs::write(path, design.file.to_json()).unwrap();
            }
        }
        BothOutcome::None {
            infeasible,
            blocking,
            runs,
            ..
        } => {
            for run in &runs {
                println!(
                    "{} {} {} {} {:.2}",
                    run.goal, run.status, run.objective, run.iterations, run.seconds
                );
            }
            println!("none, infeasible {infeasible} {blocking:?}");
        }
    }
    println!("{:?}", start.elapsed());
}
