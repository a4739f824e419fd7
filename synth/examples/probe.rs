use nalgebra::{Matrix3, Vector3};
use std::time::Instant;
use synth::conditions::{Specification, Task};
use synth::fuzzy::ExactSpacecraft;
use synth::scaling::Scaling;
use synth::solve::{Backend, Clarabel, Padding};
use synth::synthesis::{assemble, Form, Goal};
fn main() {
    let args: Vec<String> = std::env::args().collect();
    let full = args.contains(&"full".to_string());
    let nopad = args.contains(&"nopad".to_string());
    let craft = ExactSpacecraft {
        inertia: Matrix3::new(350., 3., 4., 3., 270., 10., 4., 10., 190.),
        torque_limit: Vector3::new(2., 2., 2.),
        disturbance_bound: 0.01,
        rate_bound: Vector3::new(0.1, 0.1, 0.1),
        scalar_part_min: 0.75,
    };
    let task = Task::new(
        craft.takagi_sugeno(),
        Specification {
            decay_rate: 0.05,
            sampling_interval_max: 0.1,
            trigger_threshold: 0.2,
            multiplier_weights: [1., 1., 1.],
            disturbance_weight_max: 1.0,
            must_contain: vec![],
            containment_weight: 1.0,
            margin: std::env::var("MARG").map_or(1e-6, |v| v.parse().unwrap()),
        },
    );
    let scaling = Scaling::automatic(&task.system, std::env::var("FRAC").map_or(0.5, |v| v.parse().unwrap()));
    println!("{scaling:?}");
    let scaled = scaling.apply(&task);
    let form = if full { Form::Full } else { Form::Reduced };
    let backend = Clarabel { padding: if nopad { Padding::None } else { Padding::default() } };
    let mut goal = Goal::SmallestGain;
    for _i in 0..2 {
        let t = Instant::now();
        let a = assemble(&scaled, form, goal);
        let mut low = a.problem.lower(); let k: f64 = std::env::var("OBJ").map_or(1.0, |v| v.parse().unwrap()); if _i==0 { for c in &mut low.cost { *c *= k; } }
        println!("unknowns {} cones {} assemble {:?}", low.cost.len(), low.cones.len(), t.elapsed());
        if let Some(i)=args.iter().position(|a| a=="sdpa"){ std::fs::write(&args[i+1], low.to_sdpa("probe")).unwrap(); return; }
        let t = Instant::now();
        let mut s = backend.solve(&low, goal.accuracy(&scaled), None).unwrap(); if _i==0 { s.objective /= k; }
        println!("{} obj {} it {} {:?}", s.status_text, s.objective, s.iterations, t.elapsed());
        goal = Goal::LargestMargin { gain_bound: s.objective * 1.001 };
        let q = a.design.multiplier.value(&s.values);
        let f = a.design.gain.value(&s.values) * q.transpose().try_inverse().unwrap();
        let f = nalgebra::DMatrix::from_diagonal(&scaling.input) * f / scaling.state[0];
        println!("{f:.2}");
        println!("xi {}", a.design.disturbance_weight.value(&s.values)[(0,0)] * scaled.disturbance_weight_unit);
    }
}
