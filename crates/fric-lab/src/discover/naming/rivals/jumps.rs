//! One jump or two of the sensor's zero or of the friction.

use std::ops::Range;

use super::laws::Law;

/// Sums of the products of a residual and a signal, and of the signal's squares, up to each cycle, over the samples that have both.
struct Sums(Vec<[f64; 2]>);

impl Sums {
    fn new(residuals_n: impl Iterator<Item = f64>, signal: impl Fn(usize) -> f64) -> Self {
        let (mut sums, mut sum) = (vec![[0.0; 2]], [0.0; 2]);
        for (cycle, residual_n) in residuals_n.enumerate() {
            let signal = signal(cycle);
            if residual_n.is_finite() && signal.is_finite() {
                sum = [sum[0] + residual_n * signal, sum[1] + signal * signal];
            }
            sums.push(sum);
        }
        Self(sums)
    }

    /// Returns the factor of the signal that explains most of the residual in these cycles, and how much it explains.
    fn level(&self, cycles: &Range<usize>) -> (f64, f64) {
        let ([product_to, square_to], [product_from, square_from]) = (self.0[cycles.end], self.0[cycles.start]);
        let (product, square) = (product_to - product_from, square_to - square_from);
        if square > 0.0 { (product / square, product * product / square) } else { (0.0, 0.0) }
    }

    /// Returns the cycle at which a step between two levels explains most, and how much more than one level.
    fn step(&self, cycles: &Range<usize>) -> (usize, f64) {
        let whole = self.level(cycles).1;
        let explained = |at: usize| self.level(&(cycles.start..at)).1 + self.level(&(at..cycles.end)).1 - whole;
        let steps = (cycles.start + 1..cycles.end).map(|at| (at, explained(at)));
        steps.max_by(|(_, one), (_, other)| one.total_cmp(other)).unwrap_or((cycles.end, 0.0))
    }
}

/// A signal that jumps from one level to the next once, and one that does so twice, where that explains most of a residual; NaN where there is no
/// sample. A drift is no jump: of a residual that grows evenly two jumps leave a ninth.
pub fn jumps<'a>(residuals_n: impl Iterator<Item = f64>, signal: impl Fn(usize) -> f64 + Clone + 'a) -> [Law<'a>; 2] {
    let sums = Sums::new(residuals_n, &signal);
    let cycle_count = sums.0.len() - 1;
    let (first, _) = sums.step(&(0..cycle_count));
    let (second, _) = [0..first, first..cycle_count]
        .iter()
        .map(|part| sums.step(part))
        .max_by(|(_, one), (_, other)| one.total_cmp(other))
        .unwrap_or((cycle_count, 0.0));
    [vec![first], vec![first.min(second), first.max(second)]].map(|starts| {
        let ends = starts.iter().copied().chain([cycle_count]);
        let parts: Vec<Range<usize>> =
            [0].into_iter().chain(starts.clone()).zip(ends).map(|(from, to)| from..to).collect();
        let levels: Vec<(usize, f64)> = parts.iter().map(|part| (part.end, sums.level(part).0)).collect();
        let signal = signal.clone();
        Law::by_cycle(("time", None), cycle_count, move |cycle| {
            let level = levels.iter().find(|(end, _)| cycle < *end).map_or(0.0, |(_, level)| *level);
            level * signal(cycle)
        })
    })
}

#[cfg(test)]
mod tests {
    use super::jumps;

    #[test]
    fn jumps_are_where_they_explain_most() {
        // Samples that are missing do not hide them.
        let signal: Vec<f64> = (0..400).map(|place| 1.0 + 0.5 * f64::from(place % 7)).collect();
        let level = |place: usize| match place {
            0..90 => 0.2,
            90..250 => -0.1,
            _ => 0.4,
        };
        let residual = |place: usize| if (100..120).contains(&place) { f64::NAN } else { level(place) * signal[place] };
        let [one, two] = jumps((0..400).map(residual), |cycle| signal[cycle]);
        for (place, number) in (two.columns[0])().enumerate() {
            assert!((number - level(place) * signal[place]).abs() < 1e-12, "{place}");
        }
        // The greater one, from the mean of what is before.
        let numbers: Vec<f64> = (one.columns[0])().collect();
        let levels: Vec<f64> = numbers.iter().zip(&signal).map(|(number, signal)| number / signal).collect();
        assert!(levels[..250].iter().all(|level| (level - levels[0]).abs() < 1e-12 && (-0.1..0.2).contains(level)));
        assert!(levels[250..].iter().all(|level| (level - 0.4).abs() < 1e-12));
        assert_eq!((one.of, two.of, levels.len()), (None, None, 400));
    }
}
