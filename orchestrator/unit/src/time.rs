//! Simulated time: ticks of a whole number of nanoseconds.

/// Seconds at a tick: one product and one quotient, never a sum, so that rounding errors do not accumulate.
#[must_use]
#[inline]
pub fn seconds(tick: u64, step_ns: u64) -> f64 {
    #[expect(clippy::cast_precision_loss, reason = "exact up to 2^53 ns, which is 104 days; beyond, rounded once")]
    let nanoseconds = (tick * step_ns) as f64;
    nanoseconds / 1e9
}
