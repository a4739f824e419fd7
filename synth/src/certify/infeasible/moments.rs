//! The moments of (18) at one end of the sampling interval.

use nalgebra::DMatrix;

use super::multipliers::{DeadZoneMoments, HeldMoments, Moments};
use verified::matrix::Matrix;
use verified::scalar::Scalar;

/// All moments of (18) that occur in it, at one end of the interval: `xv` is E[x v'] and so on.
/// k is the sample x(t_k^l), w the held state, p the dead zone.
pub(super) struct EndMoments<S> {
    pub xx: Matrix<S>,
    pub xv: Matrix<S>,
    pub vv: Matrix<S>,
    pub xk: Matrix<S>,
    pub vk: Matrix<S>,
    pub kk: Matrix<S>,
    pub vt: Matrix<S>,
    pub tt: Matrix<S>,
    /// E[v w'], E[k w'], E[w w'].
    pub held: Option<[Matrix<S>; 3]>,
    /// E[v p'], E[w p'], E[p p'].
    pub dead_zone: Option<[Matrix<S>; 3]>,
    /// sum over the vertices of E_i[x v'] A_i.
    pub driven: Matrix<S>,
}

impl<S: Scalar> EndMoments<S> {
    /// The numbers of the file; `vk` is 0 where they leave it out.
    pub fn new(vertices: &[Matrix<S>], moments: &Moments) -> Self {
        let n = moments.sample.nrows();
        let mut sum = Matrix::zeros(2 * n, 2 * n);
        let mut driven = Matrix::zeros(n, n);
        for weight in &moments.vertices {
            let matrix = Matrix::exactly(&weight.moments);
            sum = sum.plus(&matrix);
            let xv = matrix.block(0, n, n, n);
            driven = driven.plus(&xv.times(&vertices[weight.vertex - 1]));
        }
        let exactly = |matrix: &DMatrix<f64>| Matrix::<S>::exactly(matrix);
        EndMoments {
            xx: sum.block(0, 0, n, n),
            xv: sum.block(0, n, n, n),
            vv: sum.block(n, n, n, n),
            xk: exactly(&moments.state_sample),
            vk: moments
                .multiplied_sample
                .as_ref()
                .map_or_else(|| Matrix::zeros(n, n), exactly),
            kk: exactly(&moments.sample),
            vt: exactly(&moments.multiplied_disturbance),
            tt: exactly(&moments.disturbance),
            held: moments.held.as_ref().map(|held| {
                let HeldMoments {
                    multiplied_held,
                    sample_held,
                    held,
                } = held;
                [multiplied_held, sample_held, held].map(exactly)
            }),
            dead_zone: moments.dead_zone.as_ref().map(|zone| {
                let DeadZoneMoments {
                    multiplied,
                    held,
                    own,
                } = zone;
                [multiplied, held, own].map(exactly)
            }),
            driven,
        }
    }

    /// E[v w'].
    pub fn vw(&self) -> &Matrix<S> {
        self.held.as_ref().map_or(&self.vk, |[vw, _, _]| vw)
    }

    /// E[w v'] B + E[w p'], n x m: what multiplies F' on the right in the coefficient of Qh.
    pub fn command(&self, input: &Matrix<S>) -> Matrix<S> {
        let work = self.vw().transposed().times(input);
        match &self.dead_zone {
            Some([_, wp, _]) => work.plus(wp),
            None => work,
        }
    }

    /// E[x x''] with eps2 x' = v - eps1 x - eps3 x(t_k^l) (x' is the rate, '' its transpose).
    pub fn state_rate(&self, eps: &[S; 3]) -> Matrix<S> {
        let [e1, e2, e3] = eps;
        let rest = self.xx.scaled(e1).plus(&self.xk.scaled(e3));
        self.xv.minus(&rest).scaled(&(S::one() / e2.clone()))
    }

    /// E[x' v'] without the part of x(t_k^l).
    pub fn rate_multiplied_without_sample(&self, eps: &[S; 3]) -> Matrix<S> {
        let [e1, e2, _] = eps;
        let rest = self.vv.minus(&self.xv.scaled(e1));
        rest.scaled(&(S::one() / e2.clone()))
    }

    /// E[x' v'] (x' the rate).
    pub fn rate_multiplied(&self, eps: &[S; 3]) -> Matrix<S> {
        let [_, e2, e3] = eps;
        let sampled = self.vk.transposed().scaled(&(e3.clone() / e2.clone()));
        self.rate_multiplied_without_sample(eps).minus(&sampled)
    }

    /// E[x' x''] of the rate.
    pub fn rate_rate(&self, eps: &[S; 3]) -> Matrix<S> {
        let [e1, e2, e3] = eps;
        let square = |a: &S, b: &S| a.clone() * b.clone();
        let sum = self
            .vv
            .minus(&self.xv.symmetrised().scaled(e1))
            .minus(&self.vk.symmetrised().scaled(e3))
            .plus(&self.xx.scaled(&square(e1, e1)))
            .plus(&self.xk.symmetrised().scaled(&square(e1, e3)))
            .plus(&self.kk.scaled(&square(e3, e3)));
        sum.scaled(&(S::one() / square(e2, e2)))
    }

    /// nu E[w w'] - E[e e'] with e = x(t_k^l) - w.
    pub fn trigger(&self, nu: &S) -> Option<Matrix<S>> {
        let [_, kw, ww] = self.held.as_ref()?;
        let error = self.kk.minus(&kw.symmetrised()).plus(ww);
        Some(ww.scaled(nu).minus(&error))
    }

    /// The cliques that both ends have; `place` is `r=1` or `r=2` and the gain.
    pub fn emit(&self, place: &str, emit: &mut impl FnMut(String, Matrix<S>)) {
        let mut clique = |name: &str, upper: &[&[&Matrix<S>]]| {
            emit(format!("decrease {place} {name}"), Matrix::symmetric(upper));
        };
        let (vv, vk, kk) = (&self.vv, &self.vk, &self.kk);
        let root = [&self.xx, &self.xv, &self.xk];
        clique("root", &[&root, &[vv, vk], &[kk]]);
        clique("disturbance", &[&[vv, &self.vt], &[&self.tt]]);
        if let Some([vw, kw, ww]) = &self.held {
            clique("held state", &[&[vv, vk, vw], &[kk, kw], &[ww]]);
        }
        if let Some([vp, wp, pp]) = &self.dead_zone {
            let ww = self.held.as_ref().map_or(kk, |[_, _, ww]| ww);
            let zone = [pp, &vp.transposed(), &wp.transposed()];
            clique("dead zone", &[&zone, &[vv, self.vw()], &[ww]]);
        }
    }
}
