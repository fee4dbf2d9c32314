//! The confidence interval of a probability that was estimated by counting.

/// The confidence interval (95 %) of a success rate; `None` without trials: Wilson, *Probable Inference, the Law of
/// Succession, and Statistical Inference*, 1927.
pub fn wilson_95(successes: u64, trials: u64) -> Option<[f64; 2]> {
    /// The 97.5 % quantile of the normal distribution.
    const Z: f64 = 1.959_963_984_540_054;
    if trials == 0 {
        return None;
    }
    let n = trials as f64;
    let p = successes as f64 / n;
    let square = Z * Z / n;
    let half = Z * (p * (1.0 - p) / n + square / (4.0 * n)).sqrt();
    let end = |sign: f64| ((p + square / 2.0 + sign * half) / (1.0 + square)).clamp(0.0, 1.0);
    Some([end(-1.0), end(1.0)])
}
