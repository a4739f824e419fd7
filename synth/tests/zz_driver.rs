//! temporary
use synth::model::{Gains, Model};
use synth::synthesis::{analyse, Form, Outcome};
use synth::solve::Structured;
#[test]
#[ignore]
fn drive() {
    let model_path = std::env::var("MODEL").unwrap();
    let text = std::fs::read_to_string(&model_path).unwrap();
    let model = Model::from_json(&text).unwrap();
    let g = std::fs::read_to_string(std::env::var("GAINS").unwrap()).unwrap();
    let gains = Gains::from_json(&g).unwrap();
    let start = std::time::Instant::now();
    let out = analyse(&model, &text, &gains.gains, &g, Form::Slack, &Structured::default(), Some(std::sync::Arc::new(move |_| start.elapsed().as_secs() < 200))).unwrap();
    match out {
        Outcome::Infeasible(d) => eprintln!("infeasible {:?} slack {:?} blocking {:?} s {}", matches!(d.answer, synth::feasibility::Answer::Infeasible(_)), d.slack, d.blocking, d.solve_seconds),
        Outcome::Solved(s) => eprintln!("solved {:?} gamma {}", s.report.verdict, s.file.certificate.gamma),
        Outcome::SolverFailed(d) => eprintln!("failed {:?}", d.slack),
    }
}
