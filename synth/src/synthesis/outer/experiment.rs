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
    if let PlantFile::Exact(e) = &mut file.plant { e.rate_rad_s = [0.085; 3]; e.q0_min = 0.7; }
    file.specs.phi_per_s = 0.01; file.specs.nu = 0.05;
    let r = |parameter, limits| Range { parameter, limits };
    let space = Space { base: file.clone(), ranges: vec![
        r(Parameter::DecayRate, [0.0005, 0.1]), r(Parameter::Rate(0), [1e-3, 1.0]), r(Parameter::Rate(1), [1e-3, 1.0]), r(Parameter::Rate(2), [1e-3, 1.0]),
        r(Parameter::ScalarPart, [0.05, 0.999]), r(Parameter::FirstWeight, [1e-3, 1e3]), r(Parameter::ThirdWeight, [1e-3, 1e3]), r(Parameter::DisturbanceWeight, [1e-3, 1e3]) ] };
    let mut x0 = DMatrix::zeros(6, 1);
    x0[(3,0)] = -0.3802; x0[(4,0)] = 0.2124; x0[(5,0)] = 0.5013;
    let aim = Aim::Reach { grown: vec![x0], gamma_max: None, gain_max: None };
    let mut backend = Structured::default();
    backend.threads = 1;
    let start = space.start();
    for sigma in [0.5, 4.0] {
        let system = Model::new(file.clone()).unwrap().task().system;
        let scaling = Scaling::automatic(&system, sigma);
        println!("scaling {:?} {:?} {}", scaling.state[0], scaling.input, scaling.disturbance);
        let inner = Inner { space: &space, aim: &aim, covered: &[], scaling: &scaling, backend: &backend, observer: None };
        for rho in [0.25, 0.5, 1.0] {
            let t = std::time::Instant::now();
            let v = inner.solve(&start, &(DMatrix::identity(6,6)*rho)).unwrap();
            let el = t.elapsed();
            match v {
                None => println!("sigma {sigma} rho {rho}: none {el:?}"),
                Some(v) => println!("sigma {sigma} rho {rho}: scale {} angle {:.1} slope {:.3?} {el:?} {:?}", v.height.exp(), 2.0*(v.height.exp()*0.664f64).min(1.0).asin().to_degrees(), v.slope, v.blocking.iter().take(5).collect::<Vec<_>>()),
            }
        }
        let mut p = DMatrix::identity(6,6)*0.5;
        for k in 0..8 {
            if let Some(v) = inner.solve(&start, &p).unwrap() {
                println!("  alternation {k}: scale {:.4}", v.height.exp());
                p = v.linearisation;
            } else { println!("none"); break; }
        }
        // derivative check
        let v = inner.solve(&start, &p).unwrap().unwrap();
        for k in 0..start.len() {
            let mut a = start.clone(); a[k] += 0.01;
            let mut b = start.clone(); b[k] -= 0.01;
            let d = inner.solve(&a,&p).unwrap().zip(inner.solve(&b,&p).unwrap()).map(|(a,b)| (a.height-b.height)/0.02);
            println!("  d{k}: {:.4} fd {:?}", v.slope[k], d);
        }
    }
}
