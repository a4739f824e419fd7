use synth::requirements::{candidate, Facts, Recipe};
use synth::solve::{Clarabel, Structured};
use synth::synthesis::Solvers;
fn main() {
    let args: Vec<String> = std::env::args().collect();
    for path in &args[1..] {
        let text = std::fs::read_to_string(path).unwrap();
        let facts = match Facts::from_json(&text) {
            Ok(f) => f,
            Err(e) => {
                println!("{path}: {e:?}");
                continue;
            }
        };
        for recipe in Recipe::ALL {
            let start = std::time::Instant::now();
            let order = [
                synth::solve::Solver::Structured,
                synth::solve::Solver::Clarabel,
            ];
            let solvers = Solvers::both_with_form(order, synth::synthesis::Form::VertexRelaxed);
            let found = candidate(&facts, recipe, &text, &solvers, None);
            match found {
                Ok(Some(c)) => println!(
                    "{path} {recipe:?} {:?} fraction {:.3} {:.1} s",
                    c.achieved,
                    c.fraction(),
                    start.elapsed().as_secs_f64()
                ),
                Ok(None) => println!(
                    "{path} {recipe:?} none {:.1} s",
                    start.elapsed().as_secs_f64()
                ),
                Err(e) => println!("{path} {recipe:?} {e:?}"),
            }
        }
    }
}
