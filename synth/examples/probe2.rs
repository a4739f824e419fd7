use synth::synthesis::*;
use synth::solve::*;
fn main(){
    let a: Vec<String> = std::env::args().collect();
    let text = std::fs::read_to_string(&a[1]).unwrap();
    let model = synth::model::Model::from_json(&text).unwrap();
    let form = if a.len()>2 { Form::Full } else { Form::Reduced };
    let t = std::time::Instant::now();
    let out = synthesize(&model, &text, form, &Clarabel::default(), None).unwrap();
    println!("{:?}", t.elapsed());
    match out {
        Outcome::Solved(d) => { println!("{:?} {:#?}", d.report.verdict, d.file.provenance.solver_runs);
          for c in &d.report.conditions { println!("{:40} {:e}", c.name, c.margin); }
          println!("gamma {} g {} rad {:?} F {:?}", d.file.certificate.gamma, d.file.certificate.guaranteed_gain, d.file.certificate.certified_vector_part, d.file.controller.gains);
          std::fs::write("/tmp/w/design.json", d.file.to_json()).unwrap();
          let (f,m) = synth::design::DesignFile::from_json(&d.file.to_json()).unwrap();
          let t = std::time::Instant::now();
          println!("{:?} {:?}", f.verify(&m).unwrap().verdict, t.elapsed());
        }
        o => println!("{o:#?}"),
    }
}
