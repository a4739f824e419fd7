use super::climb::*;
use super::inner::*;
use super::parameters::*;
use crate::model::*;
use crate::scaling::Scaling;
use crate::solve::Structured;
use nalgebra::DMatrix;

#[test]
#[ignore]
fn explore() {
    let text = std::fs::read_to_string("../models/xu2020.json").unwrap();
    let mut file = Model::from_json(&text).unwrap().file;
    let var = |name: &str, default: f64| std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default);
    if let PlantFile::Exact(e) = &mut file.plant { e.rate_rad_s = [var("W", 0.1); 3]; e.q0_min = var("Q0", 0.6); }
    file.specs.phi_per_s = var("PHI", 0.01); file.specs.nu = var("NU", 0.05);
    file.specs.xi_max = var("XI", 1.0);
    let r = |parameter, limits| Range { parameter, limits };
    let space = Space { base: file.clone(), ranges: vec![
        r(Parameter::DecayRate, [var("PHILO", 0.0005), 0.2]), r(Parameter::Rate(0), [1e-3, 1.0]), r(Parameter::Rate(1), [1e-3, 1.0]), r(Parameter::Rate(2), [1e-3, 1.0]),
        r(Parameter::ScalarPart, [0.05, 0.999]), r(Parameter::FirstWeight, [1e-2, 1e2]), r(Parameter::ThirdWeight, [1e-2, 1e2]), r(Parameter::DisturbanceWeight, [1e-3, 1e3]) ] };
    let ball = var("BALL", 0.0) > 0.0;
    let gain = var("GAIN", 0.0) > 0.0;
    let mut x0 = DMatrix::zeros(6, 1);
    x0[(3,0)] = -0.3802; x0[(4,0)] = 0.2124; x0[(5,0)] = 0.5013;
    x0 /= 0.6641;
    if ball { x0 = DMatrix::from_fn(6, 3, |r, c| if r == c + 3 { 1.0 } else { 0.0 }); }
    let min = var("MIN", 0.0);
    let cover = if min > 0.0 { vec![DMatrix::from_fn(6, 3, |r, c| if r == c + 3 { (min.to_radians()/2.0).sin() } else { 0.0 })] } else { vec![] };
    let gm = var("GMAX", 0.0);
    let aim = if gain { Aim::Gain } else { Aim::Reach { grown: vec![x0], gamma_max: None, gain_max: (gm > 0.0).then_some(gm) } };
    let mut backend = Structured::default();
    backend.threads = 1;
    let start = space.start();
    let system = Model::new(file.clone()).unwrap().task().system;
    let scaling = Scaling::automatic(&system, var("SIGMA", 2.0));
    let inner = Inner { space: &space, aim: &aim, covered: &cover, scaling: &scaling, backend: &backend, observer: None };
    let show = |p: &Point| {
        let f = space.at(&p.coordinates);
        let PlantFile::Exact(e) = &f.plant else { panic!() };
        let h = p.value.height.exp();
        println!("{:.4} angle {:.2} gain {:.5} phi {:.4} w {:.4?} q0 {:.3} eps {:.3?} xi {:.3} slope {:.3?} {:?}", h, 2.0*h.min(1.0).asin().to_degrees(), 1.0/h, f.specs.phi_per_s, e.rate_rad_s, e.q0_min, f.specs.eps, f.specs.xi_max, p.value.slope, p.value.blocking.iter().filter(|b| !b.0.starts_with("decrease")).take(4).collect::<Vec<_>>());
    };
    let t = std::time::Instant::now();
    for rho in [0.25, 0.5, 0.125] {
    let Some(v) = inner.solve(&start, &(DMatrix::identity(6,6)*rho)).unwrap() else { println!("no start {rho}"); continue };
    let p = Point { coordinates: start.clone(), value: v };
    show(&p);
    let end = climb(&inner, p, Effort { rounds: var("ROUNDS", 30.0) as usize, rise: 1e-3 }, &mut |p| { print!("{:?} ", t.elapsed()); show(p); true }).unwrap();
    println!("end"); show(&end);
    break; }
}
