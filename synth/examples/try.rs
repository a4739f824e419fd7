//! x
use synth::model::Model;
use synth::synthesis::{synthesize, Outcome, Solvers};
fn main() {
    for path in std::env::args().skip(1) {
        let text = std::fs::read_to_string(&path).unwrap();
        let model = Model::from_json(&text).unwrap();
        let solvers = match std::env::var("SOLVER").as_deref() {
            Ok("s") => Solvers::only(
                synth::solve::Structured::default(),
                synth::synthesis::Form::VertexRelaxed,
            ),
            Ok("c") => Solvers::only(
                synth::solve::Clarabel::default(),
                synth::synthesis::Form::Chordal,
            ),
            _ => Solvers::suited_to(&model),
        };
        let start = std::time::Instant::now();
        let outcome = synthesize(&model, &text, &solvers, None);
        println!("== {path} {:.2} s", start.elapsed().as_secs_f64());
        match outcome {
            Ok(Outcome::Solved(d)) => {
                for r in &d.file.provenance.solver_runs {
                    println!(
                        "{} {} {:.6e} {} {}",
                        &r.solver[..8],
                        r.goal,
                        r.objective,
                        &r.status[..r.status.len().min(30)],
                        r.iterations
                    );
                }
                println!(
                    "{:?} gamma {:.6} gain {:.6} xi {:.6} opt {:?} {:?}",
                    d.report.verdict,
                    d.file.certificate.gamma,
                    d.file.certificate.guaranteed_gain,
                    d.file.certificate.xi,
                    d.optimality,
                    d.file.provenance.problem
                );
                if let Some(w) = d.report.worst() {
                    println!("{w:?}");
                }
            }
            other => println!(
                "{}",
                format!("{other:?}").chars().take(600).collect::<String>()
            ),
        }
    }
}
