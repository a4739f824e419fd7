//! Condition (18) as terms over named signals.
//!
//! The functional's derivative is bounded by a quadratic form in a few [`Signal`]s. [`terms`] states it once, term by
//! term; everything else is read off it: the published matrix (rows x, x', x(t_k^l), e, p, tau, s), the form in the
//! coordinates of the [reduction](crate::reduce), the pattern of that form, hence its cliques, and the place of a
//! dual matrix in them. A further signal of bounded norm is an entry of [`Task::further_signals`]; one of another kind is a
//! variant here, its terms, and its size.

use nalgebra::DMatrix;

use super::unknowns::{DesignUnknowns, SamplingEnd};
use crate::conditions::Task;
use sdp::lmi::Affine;

/// A quantity of which (18) is a quadratic form.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Signal {
    /// x(t), n rows.
    State,
    /// x'(t), n rows.
    Rate,
    /// The last sample x(t_k^l), n rows.
    Sample,
    /// The trigger error e = x(t_k^l) - x(t_k), n rows.
    Error,
    /// The state held by the controller, x(t_k), n rows.
    Held,
    /// The multiplied combination v = eps1 x + eps2 x' + eps3 x(t_k^l), n rows.
    Multiplied,
    /// The dead zone p of the command, m rows; none without sector unknowns.
    DeadZone,
    /// The actuators' gain errors z, one row for each uncertain entry.
    GainError,
    /// The disturbance tau, d rows.
    Disturbance,
    /// Another signal of bounded norm, by its name.
    Further(&'static str),
    /// The coordinate s of the integral's Schur complement, n rows; for r = 2 only.
    Integral,
}

use Signal::{
    DeadZone, Disturbance, Error, Further, GainError, Held, Integral, Multiplied, Rate, Sample,
    State,
};

impl Signal {
    /// The name of the clique in which the signal stands alone with its neighbours.
    pub fn clique(self) -> &'static str {
        match self {
            Disturbance => "disturbance",
            DeadZone => "dead zone",
            GainError => "gain error",
            Held => "held state",
            Further(name) => name,
            Integral => "integral",
            State | Rate | Sample | Error | Multiplied => "root",
        }
    }

    /// Number of rows.
    pub fn size(self, task: &Task, unknowns: &DesignUnknowns) -> usize {
        match self {
            DeadZone => match &unknowns.sector {
                Some(sector) => sector.weight.nrows(),
                None => 0,
            },
            Disturbance => task.system.disturbance.ncols(),
            GainError => unknowns.gain_error.as_ref().map_or(0, Affine::nrows),
            Further(name) => {
                let mut signals = task.further_signals.iter();
                let known = signals.find(|signal| signal.name == name);
                known.map_or(0, |signal| signal.coefficient.ncols())
            }
            _ => task.system.states(),
        }
    }
}

/// `weight` times `left' block right` plus its transpose; for one signal `weight` times `left' block left` with a
/// symmetric block.
#[derive(Debug, Clone)]
pub struct Term {
    weight: f64,
    left: Signal,
    right: Signal,
    block: Affine,
}

impl Term {
    fn cross(left: Signal, right: Signal, block: Affine) -> Self {
        Term {
            weight: 1.0,
            left,
            right,
            block,
        }
    }

    fn square(signal: Signal, weight: f64, block: &Affine) -> Self {
        Term {
            weight,
            ..Term::cross(signal, signal, block.clone())
        }
    }

    fn weighted(self, weight: f64) -> Self {
        Term { weight, ..self }
    }
}

/// (18) without its vertex terms: the quadratic form that bounds V' + phi V - xi |tau|^2 in (28), for E = I.
pub fn terms(task: &Task, end: SamplingEnd, unknowns: &DesignUnknowns) -> Vec<Term> {
    terms_with(task, end, unknowns, unknowns.multiplier.transposed())
}

/// (18) at one of the model's vertices, whole, with that vertex's own A_i and E_i.
pub fn terms_at(
    task: &Task,
    end: SamplingEnd,
    unknowns: &DesignUnknowns,
    index: usize,
) -> Vec<Term> {
    let transposed = unknowns.multiplier.transposed();
    let rate = match task.system.descriptors.get(index) {
        None => transposed,
        Some(descriptor) => descriptor * &transposed,
    };
    let mut out = terms_with(task, end, unknowns, rate);
    let vertex = &task.system.vertices[index];
    out.extend(vertex_terms((vertex, None), &unknowns.multiplier));
    out
}

/// (18) without its vertex terms, with E Qh' given.
fn terms_with(task: &Task, end: SamplingEnd, unknowns: &DesignUnknowns, rate: Affine) -> Vec<Term> {
    let specification = &task.specification;
    let (phi, nu) = (specification.decay_rate, task.trigger_threshold());
    let bw = &task.system.disturbance;
    let centred;
    let b = match &task.imperfections.gain_error {
        None => &task.system.input,
        Some(error) => {
            centred = &task.system.input * DMatrix::from_diagonal(&error.centre);
            &centred
        }
    };
    let DesignUnknowns {
        lyapunov: uh,
        integral_weight: yh,
        trigger_weight: wh,
        free_state: l1h,
        free_sample: l2h,
        disturbance_weight: xi,
        ..
    } = unknowns;
    // (24): 2 v' (B F w + B_w tau - E x' - B p)
    let mut out = vec![
        Term::cross(Multiplied, Held, b * &unknowns.gain),
        Term::cross(Multiplied, Disturbance, Affine::constant(bw)),
        Term::cross(Multiplied, Rate, -rate),
    ];
    if let Some(sector) = &unknowns.sector {
        out.push(Term::cross(Multiplied, DeadZone, -(b * &sector.weight)));
    }
    out.extend([
        Term::square(State, phi, uh),
        Term::cross(State, Rate, uh.clone()),
        // (23): 2 (x' L1 + xk' L2) (x - xk)
        Term::square(State, 1.0, &l1h.symmetrised()),
        Term::cross(State, Sample, -l1h.clone()),
        Term::cross(Sample, State, l2h.clone()),
        Term::square(Sample, -1.0, &l2h.symmetrised()),
        // The trigger: e' W e < nu w' W w, with Wp on the error where the sample is not the state
        Term::square(Held, nu, wh),
        Term::square(Error, -1.0, unknowns.error_weight()),
        Term::square(Disturbance, -1.0, &xi.times_matrix(&identity(bw.ncols()))),
    ]);
    if let Some(sector) = &unknowns.sector {
        // (17), with S = M^-1
        out.push(Term::square(DeadZone, -2.0, &sector.weight));
        out.push(Term::cross(DeadZone, Held, sector.anti_windup.clone()));
    }
    for (signal, weight) in task.further_signals.iter().zip(&unknowns.further_weights) {
        let (own, block) = (Further(signal.name), Affine::constant(&signal.coefficient));
        let unit = identity(signal.coefficient.ncols());
        out.push(Term::cross(Multiplied, own, block));
        out.push(Term::square(own, -1.0, &weight.times_matrix(&unit)));
    }
    out.extend(gain_error_terms(task, unknowns));
    if end != SamplingEnd::End {
        out.push(Term::square(Rate, task.oldest_sample(), yh));
    }
    if end != SamplingEnd::Start {
        let c = integral_factor(task);
        out.push(Term::cross(State, Integral, l1h.clone()).weighted(c));
        out.push(Term::cross(Sample, Integral, l2h.clone()).weighted(c));
        out.push(Term::square(Integral, -1.0, yh));
    }
    out
}

/// What the actuators' gain error adds: for D > 0 and b_k = B e_i a_k,
/// `2 v' sum_k b_k delta_k (F w - p)_j <= sum_k D_k (b_k'v)^2 + (F w - p)_j^2 / D_k`, the last term as a row z.
fn gain_error_terms(task: &Task, unknowns: &DesignUnknowns) -> Vec<Term> {
    let (Some(error), Some(weight)) = (&task.imperfections.gain_error, &unknowns.gain_error) else {
        return Vec::new();
    };
    let columns = error.columns(&task.system.input);
    let selection = error.selection();
    let mut out = vec![
        Term::square(Multiplied, 1.0, &weight.congruence(&columns.transpose())),
        Term::square(GainError, -1.0, weight),
        Term::cross(GainError, Held, &selection * &unknowns.gain),
    ];
    if let Some(sector) = &unknowns.sector {
        let zone = -(&selection * &sector.weight);
        out.push(Term::cross(GainError, DeadZone, zone));
    }
    out
}

/// The vertex term of (18), `2 v' A Qh' x` for A x + ..., and `- 2 v' (E - I) Qh' x'` for E x' = A x + ....
pub fn vertex_terms(
    (vertex, descriptor): (&DMatrix<f64>, Option<&DMatrix<f64>>),
    multiplier: &Affine,
) -> Vec<Term> {
    let mut out = vec![Term::cross(
        Multiplied,
        State,
        vertex * &multiplier.transposed(),
    )];
    if let Some(descriptor) = descriptor {
        let change = descriptor - identity(descriptor.nrows());
        let block = -(&change * &multiplier.transposed());
        out.push(Term::cross(Multiplied, Rate, block));
    }
    out
}

/// The vertex terms at one of the model's vertices, with that vertex's own E_i.
pub fn vertex_terms_at(task: &Task, index: usize, multiplier: &Affine) -> Vec<Term> {
    let descriptor = task.system.descriptors.get(index);
    vertex_terms((&task.system.vertices[index], descriptor), multiplier)
}

/// c = sqrt(hbar e^(phi hbar)), with h_m in the place of hbar in a network with delay or loss.
fn integral_factor(task: &Task) -> f64 {
    let oldest = task.oldest_sample();
    (oldest * (task.specification.decay_rate * oldest).exp()).sqrt()
}

fn identity(side: usize) -> DMatrix<f64> {
    DMatrix::identity(side, side)
}

/// Coordinates of (18): independent signals, block after block, in terms of which all others are known.
#[derive(Debug, Clone)]
pub struct Basis {
    signals: Vec<Signal>,
    sizes: Vec<usize>,
    weights: [f64; 3],
    dead_zone_unit: f64,
    states: usize,
    /// e = 0: see [`Task::held_is_sample`].
    held_is_sample: bool,
}

impl Basis {
    /// The rows of the published matrix: x, x', x(t_k^l), e, p in units of its own, tau and, for r = 2, s.
    pub fn published(task: &Task, end: SamplingEnd, unknowns: &DesignUnknowns) -> Self {
        let signals = [State, Rate, Sample, Error, DeadZone, GainError, Disturbance];
        Basis::new(task, end, unknowns, &signals)
    }

    /// The coordinates of the reduction: x, v, x(t_k^l), x(t_k), p in units of its own, tau and, for r = 2, s;
    /// x' = (v - eps1 x - eps3 x(t_k^l)) / eps2.
    pub fn reduced(task: &Task, end: SamplingEnd, unknowns: &DesignUnknowns) -> Self {
        let signals = [
            State,
            Multiplied,
            Sample,
            Held,
            DeadZone,
            GainError,
            Disturbance,
        ];
        Basis::new(task, end, unknowns, &signals)
    }

    /// x, x' and x(t_k^l) alone: all that the vertex terms need.
    fn path(task: &Task) -> Self {
        let states = task.system.states();
        Basis {
            signals: vec![State, Rate, Sample],
            sizes: vec![states; 3],
            weights: task.specification.multiplier_weights,
            dead_zone_unit: 1.0,
            states,
            held_is_sample: task.held_is_sample,
        }
    }

    fn new(task: &Task, end: SamplingEnd, unknowns: &DesignUnknowns, signals: &[Signal]) -> Self {
        let further = task
            .further_signals
            .iter()
            .map(|signal| Further(signal.name));
        let integral = (end != SamplingEnd::Start).then_some(Integral);
        let held = task.held_is_sample;
        let own = signals.iter().copied();
        let own = own.filter(|signal| match signal {
            Held | Error => !held,
            GainError => unknowns.gain_error.is_some(),
            _ => true,
        });
        let signals = own.chain(further);
        let signals: Vec<Signal> = signals.chain(integral).collect();
        let sizes = signals.iter().map(|signal| signal.size(task, unknowns));
        Basis {
            sizes: sizes.collect(),
            signals,
            weights: task.specification.multiplier_weights,
            dead_zone_unit: unknowns.dead_zone_unit(),
            states: task.system.states(),
            held_is_sample: task.held_is_sample,
        }
    }

    /// The independent signals.
    pub fn signals(&self) -> &[Signal] {
        &self.signals
    }

    /// Rows of each block.
    pub fn sizes(&self) -> &[usize] {
        &self.sizes
    }

    /// The block of an independent signal.
    pub fn block(&self, signal: Signal) -> Option<usize> {
        self.signals.iter().position(|own| *own == signal)
    }

    /// The matrix that maps the coordinates to a signal: its rows x all rows.
    pub fn map(&self, signal: Signal) -> DMatrix<f64> {
        if let Some(block) = self.block(signal) {
            let unit = match signal {
                DeadZone => self.dead_zone_unit,
                _ => 1.0,
            };
            return unit * self.select(block);
        }
        let [e1, e2, e3] = self.weights;
        let (state, sample) = (self.map(State), self.map(Sample));
        match signal {
            Rate => (self.map(Multiplied) - e1 * state - e3 * sample) / e2,
            Multiplied => e1 * state + e2 * self.map(Rate) + e3 * sample,
            Held | Error if self.held_is_sample => match signal {
                Held => sample,
                _ => DMatrix::zeros(self.states, self.side()),
            },
            Held => sample - self.map(Error),
            Error => sample - self.map(Held),
            // Absent for this end of the interval.
            _ => DMatrix::zeros(self.states, self.side()),
        }
    }

    /// Rows of all blocks.
    pub fn side(&self) -> usize {
        self.sizes.iter().sum()
    }

    /// The rows of one block.
    fn select(&self, block: usize) -> DMatrix<f64> {
        let offset: usize = self.sizes[..block].iter().sum();
        let side = self.sizes[block];
        let mut out = DMatrix::zeros(side, self.side());
        out.view_mut((0, offset), (side, side)).fill_with_identity();
        out
    }

    /// The sum of terms as a symmetric matrix on the coordinates.
    pub fn form(&self, terms: &[Term]) -> Affine {
        let mut out = Affine::zeros(self.side(), self.side());
        for term in terms {
            let (left, right) = (self.map(term.left), self.map(term.right));
            let form = match term.left == term.right {
                true => term.block.congruence(&left),
                false => (left.transpose() * &term.block * &right).symmetrised(),
            };
            out += &(term.weight * &form);
        }
        out
    }

    /// The rows (B'v, dead zone in its own units, x(t_k)) that the slack of a mismatch acts on.
    pub fn mismatch_rows(&self, task: &Task) -> DMatrix<f64> {
        let command = task.system.input.transpose() * self.map(Multiplied);
        let zone = self.map(DeadZone) / self.dead_zone_unit;
        let held = self.map(Held);
        self.stacked(&[command, zone, held])
    }

    /// The coordinates of those of some signals that are independent, block after block.
    pub fn selected(&self, signals: &[Signal]) -> DMatrix<f64> {
        let blocks = signals.iter().filter_map(|signal| self.block(*signal));
        let parts: Vec<_> = blocks.map(|block| self.select(block)).collect();
        self.stacked(&parts)
    }

    fn stacked(&self, parts: &[DMatrix<f64>]) -> DMatrix<f64> {
        let height = parts.iter().map(DMatrix::nrows).sum();
        let mut out = DMatrix::zeros(height, self.side());
        let mut row = 0;
        for part in parts {
            out.rows_mut(row, part.nrows()).copy_from(part);
            row += part.nrows();
        }
        out
    }

    /// The weight of a margin that is the identity on the rows of the published matrix.
    pub fn margin_weight(&self) -> DMatrix<f64> {
        let rows = [
            State,
            Rate,
            Sample,
            Error,
            DeadZone,
            GainError,
            Disturbance,
            Integral,
        ];
        let zero = DMatrix::zeros(self.side(), self.side());
        let further = self.signals.iter().filter(|own| matches!(own, Further(_)));
        rows.iter().chain(further).fold(zero, |sum, &signal| {
            let map = match signal {
                DeadZone => self.map(signal) / self.dead_zone_unit,
                _ => self.map(signal),
            };
            sum + map.transpose() * map
        })
    }

    /// Blocks that meet in the terms or in the margin, one row for each block.
    pub fn pattern(&self, terms: &[Term]) -> Vec<Vec<bool>> {
        let count = self.signals.len();
        let mut out = vec![vec![false; count]; count];
        let own = self.signals.iter().map(|signal| (*signal, *signal));
        let margin = [Rate, Error].map(|signal| (signal, signal));
        let pairs = terms.iter().map(|term| (term.left, term.right));
        for (left, right) in pairs.chain(own).chain(margin) {
            let (left, right) = (self.support(left), self.support(right));
            for (&a, &b) in left.iter().flat_map(|a| right.iter().map(move |b| (a, b))) {
                out[a][b] = true;
                out[b][a] = true;
            }
        }
        out
    }

    /// The blocks on which a signal depends.
    fn support(&self, signal: Signal) -> Vec<usize> {
        if let Some(block) = self.block(signal) {
            return vec![block];
        }
        let parts: &[Signal] = match signal {
            Rate => &[Multiplied, State, Sample],
            Multiplied => &[State, Rate, Sample],
            Held if self.held_is_sample => &[Sample],
            Error if self.held_is_sample => &[],
            Held => &[Sample, Error],
            Error => &[Sample, Held],
            _ => &[],
        };
        parts.iter().filter_map(|part| self.block(*part)).collect()
    }
}

/// The vertex term as a matrix on the rows x, x', x(t_k^l), for a numeric Qh: 3n x 3n.
pub fn vertex_term(task: &Task, vertex: &DMatrix<f64>, multiplier: &DMatrix<f64>) -> DMatrix<f64> {
    let terms = vertex_terms((vertex, None), &Affine::constant(multiplier));
    Basis::path(task).form(&terms).value(&[])
}

/// The vertex terms at one of the model's vertices, likewise.
pub fn vertex_term_at(task: &Task, index: usize, multiplier: &DMatrix<f64>) -> DMatrix<f64> {
    let terms = vertex_terms_at(task, index, &Affine::constant(multiplier));
    Basis::path(task).form(&terms).value(&[])
}
