//! Conditions for a given law u = F x(t_k), held and saturated, with a trigger on the command.
//!
//! The law is known, so the functional's derivative is linear in the unknowns without any congruence. With
//! delta = (x - x(t_k)) / hbar in the place of the sample x(t_k), the integral's weight hbar Y and the free matrices
//! hbar (L1 + L2) and -hbar^2 L2 as unknowns, all blocks have about the same size however short the sampling interval is.
//! The certified set is x'Ux <= 1.

use nalgebra::DMatrix;

use super::state_feedback::Inequality;
use crate::fuzzy::TakagiSugeno;
use sdp::lmi::{Affine, SymmetricBlocks, Unknowns};

/// Split c of the trigger's two parts where one of them is 0 and the other takes all: 1 + c, or 1 + 1/c.
const ONE_SIDED: f64 = 1e-6;

/// A law with a trigger on the command, and what one certificate is to show. In any units.
#[derive(Debug, Clone)]
pub struct HeldCommandTask {
    /// The plant x' = A_i x + B sat(u) + B_w tau; every E_i is the identity.
    pub system: TakagiSugeno,
    /// W_i, k x n, affine in the vertex as A_i is, with W x = 0 along every motion: [omega^x, 0] for a spacecraft.
    pub annihilators: Vec<DMatrix<f64>>,
    /// F, m x n.
    pub gain: DMatrix<f64>,
    /// al of the trigger |e| < al |F x(t_k)| + ga, in [0, 1).
    pub relative: f64,
    /// ga, not negative.
    pub absolute: f64,
    /// phi, above 0.
    pub decay_rate: f64,
    /// hbar, above 0.
    pub sampling_interval_max: f64,
    /// theta, in (0, 1].
    pub within_limit: f64,
    /// Largest r / phi, in (0, 1].
    pub final_level: f64,
}

/// The unknowns of one certificate.
#[derive(Debug, Clone)]
pub struct HeldCommandUnknowns {
    /// U, n x n, symmetric.
    pub lyapunov: Affine,
    /// hbar Y, n x n, symmetric.
    pub integral_weight: Affine,
    /// Q1, n x n.
    pub state_multiplier: Affine,
    /// Q2, n x n.
    pub rate_multiplier: Affine,
    /// G1 = hbar (L1 + L2), n x n.
    pub free_state: Affine,
    /// G2 = -hbar^2 L2, n x n.
    pub free_change: Affine,
    /// R1, n x k.
    pub annihilator_state: Affine,
    /// R2, n x k.
    pub annihilator_rate: Affine,
    /// M, m x m, diagonal; none where theta is 1.
    pub sector_weight: Option<Affine>,
    /// m, 1 x 1.
    pub command_weight: Affine,
    /// a = c m, 1 x 1.
    pub relative_weight: Affine,
    /// (m / c) ga^2 / (phi final_level), 1 x 1: the part of the supply that it takes.
    pub absolute_share: Affine,
    /// xi, 1 x 1.
    pub disturbance_weight: Affine,
}

/// The two ends of the sampling interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum End {
    First,
    Last,
}

/// Places of the signals among the blocks of the decrease condition.
#[derive(Debug, Clone, Copy)]
enum Signal {
    State,
    Rate,
    /// delta = (x - x(t_k)) / hbar.
    Change,
    Error,
    Disturbance,
    DeadZone,
    Integral,
}

impl HeldCommandTask {
    fn saturates(&self) -> bool {
        self.within_limit < 1.0
    }

    /// phi final_level: the largest supply.
    fn supply(&self) -> f64 {
        self.decay_rate * self.final_level
    }

    /// New unknowns.
    pub fn unknowns(&self, unknowns: &mut Unknowns) -> HeldCommandUnknowns {
        let (n, m) = (self.system.states(), self.system.inputs());
        let k = self.annihilators.first().map_or(0, DMatrix::nrows);
        let saturates = self.saturates();
        let command_weight = unknowns.scalar("m");
        let one_sided = |factor: f64| factor * &command_weight;
        let (relative_weight, absolute_share) = match (self.relative > 0.0, self.absolute > 0.0) {
            (true, true) => (unknowns.scalar("a"), unknowns.scalar("b")),
            (_, false) => (one_sided(ONE_SIDED), Affine::zeros(1, 1)),
            (false, true) => {
                let part = self.absolute * self.absolute / self.supply();
                (one_sided(1.0 / ONE_SIDED), one_sided(ONE_SIDED * part))
            }
        };
        HeldCommandUnknowns {
            lyapunov: unknowns.symmetric("U", n),
            integral_weight: unknowns.symmetric("hbar Y", n),
            state_multiplier: unknowns.general("Q1", n, n),
            rate_multiplier: unknowns.general("Q2", n, n),
            free_state: unknowns.general("G1", n, n),
            free_change: unknowns.general("G2", n, n),
            annihilator_state: unknowns.general("R1", n, k),
            annihilator_rate: unknowns.general("R2", n, k),
            sector_weight: saturates.then(|| unknowns.diagonal("M", m)),
            command_weight,
            relative_weight,
            absolute_share,
            disturbance_weight: unknowns.scalar("xi"),
        }
    }

    /// Every condition: the decrease with one slack for all vertices at each end of the sampling interval, which loses
    /// nothing, and what holds on the certified set.
    pub fn conditions(
        &self,
        unknowns: &mut Unknowns,
        own: &HeldCommandUnknowns,
    ) -> Vec<Inequality> {
        let mut out = vec![
            Inequality::strict("lyapunov", own.lyapunov.clone()),
            Inequality::strict("integral weight", own.integral_weight.clone()),
            Inequality::strict("disturbance weight", own.disturbance_weight.clone()),
            Inequality::strict("supply", self.supply_room(own)),
        ];
        if self.relative > 0.0 && self.absolute > 0.0 {
            out.push(Inequality::strict("split", self.split(own)));
        }
        for end in [End::First, End::Last] {
            self.decrease(unknowns, own, end, &mut out);
        }
        out.extend(self.region(own));
        out.extend(self.limits(own));
        out
    }

    /// `[ a, m ga ; *, b ga^2 ] >= 0`, in units of the supply: a b >= m^2.
    fn split(&self, own: &HeldCommandUnknowns) -> Affine {
        let beside = self.absolute / self.supply().sqrt() * &own.command_weight;
        let upper: [&[&Affine]; 2] = [&[&own.relative_weight, &beside], &[&own.absolute_share]];
        SymmetricBlocks::of(&upper)
    }

    /// 1 - (xi taubar^2 + (m + b) ga^2) / (phi final_level).
    fn supply_room(&self, own: &HeldCommandUnknowns) -> Affine {
        let bound = self.system.disturbance_bound;
        let supply = self.supply();
        let disturbance = bound * bound / supply * &own.disturbance_weight;
        let whole = self.absolute * self.absolute / supply * &own.command_weight;
        Affine::identity(1, 1.0) - disturbance - whole - own.absolute_share.clone()
    }

    /// The decrease condition, negated: `slack - M_i >= 0` at each vertex, with M_i what depends on it, and the rest with
    /// the slack in the place of M_i.
    fn decrease(
        &self,
        unknowns: &mut Unknowns,
        own: &HeldCommandUnknowns,
        end: End,
        out: &mut Vec<Inequality>,
    ) {
        let n = self.system.states();
        let r = match end {
            End::First => 1,
            End::Last => 2,
        };
        let slack = unknowns.symmetric(&format!("Z{r}"), 2 * n);
        let mut form = self.common(own, end);
        form.add_block(0, 0, &slack);
        out.push(Inequality::strict(format!("decrease r={r}"), -form));
        for (index, vertex) in self.system.vertices.iter().enumerate() {
            let part = &slack - &self.vertex_part(own, vertex, &self.annihilators[index]);
            let name = format!("decrease r={r} vertex {}", index + 1);
            out.push(Inequality::strict(name, part));
        }
    }

    /// 2 (x'Q1 + x''Q2) A_i x + 2 (x'R1 + x''R2) W_i x on the rows x, x'.
    fn vertex_part(
        &self,
        own: &HeldCommandUnknowns,
        vertex: &DMatrix<f64>,
        annihilator: &DMatrix<f64>,
    ) -> Affine {
        let n = self.system.states();
        let moved = |multiplier: &Affine, zero: &Affine| multiplier * vertex + zero * annihilator;
        let state = moved(&own.state_multiplier, &own.annihilator_state);
        let rate = moved(&own.rate_multiplier, &own.annihilator_rate);
        let (state, rate) = (state.symmetrised(), rate.transposed());
        let none = Affine::zeros(n, n);
        SymmetricBlocks::of(&[&[&state, &rate], &[&none]])
    }

    fn place(&self, signal: Signal) -> usize {
        match signal {
            Signal::State => 0,
            Signal::Rate => 1,
            Signal::Change => 2,
            Signal::Error => 3,
            Signal::Disturbance => 4,
            Signal::DeadZone => 5,
            Signal::Integral => 5 + usize::from(self.saturates()),
        }
    }

    /// The decrease condition without what depends on the vertex.
    fn common(&self, own: &HeldCommandUnknowns, end: End) -> Affine {
        use Signal::{Change, DeadZone, Disturbance, Error, Integral, Rate, State};
        let (n, m) = (self.system.states(), self.system.inputs());
        let d = self.system.disturbance.ncols();
        let mut sizes = vec![n, n, n, m, d];
        sizes.extend(self.saturates().then_some(m));
        sizes.extend((end == End::Last).then_some(n));
        let mut out = SymmetricBlocks::new(&sizes);
        let mut add = |left: Signal, right: Signal, block: &Affine| {
            out.add(self.place(left), self.place(right), block);
        };
        let (q1, q2) = (&own.state_multiplier, &own.rate_multiplier);
        let (b, bw) = (&self.system.input, &self.system.disturbance);
        let closed = b * &self.gain;
        let hbar = self.sampling_interval_max;
        add(State, State, &(self.decay_rate * &own.lyapunov));
        add(State, Rate, &own.lyapunov);
        // 2 (x'Q1 + x''Q2) (B F (x - hbar delta) + B (e - p) + B_w tau - x')
        add(State, State, &(q1 * &closed).symmetrised());
        add(State, Rate, &((q2 * &closed).transposed() - q1.clone()));
        add(Rate, Rate, &(-q2.symmetrised()));
        for (row, multiplier) in [(State, q1), (Rate, q2)] {
            add(row, Change, &(-hbar * &(multiplier * &closed)));
            add(row, Error, &(multiplier * b));
            add(row, Disturbance, &(multiplier * bw));
        }
        // 2 (x'G1 + delta'G2) delta
        add(State, Change, &own.free_state);
        add(Change, Change, &own.free_change.symmetrised());
        // (m + a) al^2 |F (x - hbar delta)|^2 - m |e|^2 - xi |tau|^2
        let square = self.gain.transpose() * &self.gain;
        let share = self.relative * self.relative * &(&own.command_weight + &own.relative_weight);
        add(State, State, &share.times_matrix(&square));
        add(State, Change, &(-hbar * &share.times_matrix(&square)));
        add(
            Change,
            Change,
            &(hbar * hbar * &share.times_matrix(&square)),
        );
        add(Error, Error, &(-identity(&own.command_weight, m)));
        let weight = identity(&own.disturbance_weight, d);
        add(Disturbance, Disturbance, &(-weight));
        // -2 p'M (p - (1 - theta) (F (x - hbar delta) + e))
        if let Some(sector) = &own.sector_weight {
            let beyond = (1.0 - self.within_limit) * sector;
            let commanded = &self.gain.transpose() * &beyond;
            add(State, DeadZone, &(commanded.clone() - q1 * b));
            add(Rate, DeadZone, &(-(q2 * b)));
            add(Change, DeadZone, &(-hbar * &commanded));
            add(Error, DeadZone, &beyond);
            add(DeadZone, DeadZone, &(-2.0 * sector));
        }
        match end {
            End::First => add(Rate, Rate, &own.integral_weight),
            End::Last => {
                let factor = (self.decay_rate * hbar).exp();
                add(State, Integral, &(factor * &own.free_state));
                add(Change, Integral, &(factor * &own.free_change));
                add(Integral, Integral, &(-factor * &own.integral_weight));
            }
        }
        out.finish()
    }

    /// |rows x| <= bound on the set.
    fn region<'a>(&'a self, own: &'a HeldCommandUnknowns) -> impl Iterator<Item = Inequality> + 'a {
        self.system.region.iter().map(|bound| {
            let rows = &bound.rows / bound.bound_squared.sqrt();
            Inequality::strict(format!("box {}", bound.name), inside(&own.lyapunov, &rows))
        })
    }

    /// |theta F_s x| <= ubar_s on the set.
    fn limits<'a>(&'a self, own: &'a HeldCommandUnknowns) -> impl Iterator<Item = Inequality> + 'a {
        self.system
            .input_limit
            .iter()
            .enumerate()
            .map(|(s, limit)| {
                let row = self.gain.rows(s, 1) * (self.within_limit / limit);
                let name = format!("command within limit {}", s + 1);
                Inequality::strict(name, inside(&own.lyapunov, &row))
            })
    }

    /// (1 + al) |F x| + ga <= bound wherever x'Ux <= level: a command decided upon there stays within the bound.
    pub fn held_within(&self, own: &HeldCommandUnknowns, level: f64, bound: f64) -> Inequality {
        let factor = (1.0 + self.relative) * level.sqrt() / (bound - self.absolute);
        let rows = &self.gain * factor;
        Inequality::strict("held command within limit", inside(&own.lyapunov, &rows))
    }

    /// U0 >= level U for the U0 of another certificate: x'U0 x <= level lies in this certificate's set.
    pub fn contains(
        &self,
        own: &HeldCommandUnknowns,
        other: &DMatrix<f64>,
        level: f64,
    ) -> Inequality {
        let room = Affine::constant(&(other / level)) - own.lyapunov.clone();
        Inequality::strict("hand-over set contained", room)
    }
}

/// `[ U, rows' ; *, I ] >= 0`: |rows x| <= 1 wherever x'Ux <= 1.
fn inside(lyapunov: &Affine, rows: &DMatrix<f64>) -> Affine {
    let corner = Affine::identity(rows.nrows(), 1.0);
    let beside = Affine::constant(&rows.transpose());
    SymmetricBlocks::of(&[&[lyapunov, &beside], &[&corner]])
}

fn identity(scalar: &Affine, side: usize) -> Affine {
    scalar.times_matrix(&DMatrix::identity(side, side))
}
