//! Integration of the plant between events, with the input held.

/// How the plant is integrated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// The classical Runge-Kutta method of order 4 with steps of at most `step_s` seconds.
    RungeKutta4 {
        /// Longest step, s.
        step_s: f64,
    },
    /// Dormand and Prince's method of order 8 with a step chosen from its error estimate: the
    /// reference that the other is checked against.
    DormandPrince853 {
        /// Allowed error of a step, relative to the state (and absolute where it is below 1).
        tolerance: f64,
    },
}
