//! Uncertainty of an estimate if its residuals are correlated in time.
//!
//! The covariance of a least-squares estimate is `H⁻¹ S H⁻¹` with `H = JᵀJ` and `S` the covariance of `Σ g_t`, where `g_t = J_tᵀ r_t` is the score of
//! a sample. With independent residuals `S = Σ g_t g_tᵀ`. With correlated residuals, sums over blocks longer than the correlation replace `g_t`
//! (method of block means; the search for the block length after H. Flyvbjerg, H. G. Petersen, *Error estimates on averages of correlated data*, J.
//! Chem. Phys. 91, 1989). Block lengths of 1, 2, 4 … samples are tried while there are [`FEWEST_BLOCKS`] blocks, and the two longest are
//! extrapolated. For each parameter the length with the greatest variance counts. 95 % intervals cover 95 of 100 cases under white noise, and 90
//! under a drift with a correlation time of a hundredth of the log. For slower drift the log is too short.
//!
//! No model is exact. Its error does not scatter from one block to the next but repeats in the same operating condition: each speed, load or distance
//! since the reversal prefers its own values, and the estimate is a mean over the conditions of the log. So the same sums are also computed over
//! groups of samples in the same condition, as if the conditions of the log were drawn from all possible ones (a sandwich with clusters: K.-Y. Liang,
//! S. L. Zeger, *Longitudinal data analysis using generalized linear models*, Biometrika 73, 1986). They count if they are greater. Without a model
//! error they agree with the white noise.

use nalgebra::{DMatrix, DVector};

use super::groups::Groups;
use crate::search::gram::add_products;

/// The variance over the groups of a condition counts if it exceeds that of white noise by more than this many standard deviations. With a dozen
/// conditions and as many parameters, few exceed it by chance.
const CHANCE: f64 = 3.0;
/// Minimum number of blocks or groups for an estimate of their scatter.
const FEWEST_BLOCKS: usize = 16;

/// Sums of scores over blocks of 1, 2, 4 … samples.
#[derive(Clone, Debug)]
pub struct Scores {
    levels: Vec<Level>,
    parameters: usize,
    /// The block that is passed through the levels.
    block: Vec<f64>,
    /// Groups by operating condition, with the sums over each group of each condition.
    groups: Option<(Groups, Vec<Vec<f64>>)>,
}

#[derive(Clone, Debug)]
struct Level {
    /// First half of a block of the next length, if one is pending.
    half: Vec<f64>,
    is_waiting: bool,
    /// `Σ g gᵀ` of the blocks, upper triangle stored column by column.
    squares: Vec<f64>,
    count: usize,
}

impl Scores {
    /// None yet.
    #[must_use]
    pub fn new(parameters: usize) -> Self {
        Self { levels: Vec::new(), parameters, block: vec![0.0; parameters], groups: None }
    }

    /// None yet, to be summed up in groups too.
    pub(crate) fn grouped(parameters: usize, groups: Groups) -> Self {
        let sums = groups.groupings.iter().map(|of| vec![0.0; of.count * parameters]).collect();
        Self { groups: Some((groups, sums)), ..Self::new(parameters) }
    }

    /// Takes in the score of the next sample, which has this place in the record of the groups.
    pub(crate) fn add_of(&mut self, place: usize, score: &[f64]) {
        if let Some((groups, sums)) = &mut self.groups {
            for (grouping, sums) in groups.groupings.iter().zip(sums) {
                let Some(group) = grouping.of_sample(place) else { continue };
                let of_group = sums.iter_mut().skip(group * self.parameters);
                of_group.zip(score).for_each(|(sum, part)| *sum += part);
            }
        }
        self.add(score);
    }

    /// Takes in the score of the next sample: as many numbers as there are parameters.
    pub fn add(&mut self, score: &[f64]) {
        self.block.copy_from_slice(score);
        for level in &mut self.levels {
            if !level.add(&mut self.block) {
                return;
            }
        }
        let mut level = Level {
            half: vec![0.0; self.parameters],
            is_waiting: false,
            squares: vec![0.0; self.parameters * (self.parameters + 1) / 2],
            count: 0,
        };
        level.add(&mut self.block);
        self.levels.push(level);
    }

    /// Covariance of the estimate, from the inverse of `JᵀJ`.
    #[must_use]
    pub fn covariance(&self, inverse: &DMatrix<f64>) -> DMatrix<f64> {
        let of_level = |level: &Level| {
            let scatter = DMatrix::from_fn(self.parameters, self.parameters, |row, column| {
                let (low, high) = (row.min(column), row.max(column));
                level.squares.get(high * (high + 1) / 2 + low).copied().unwrap_or(f64::NAN)
            });
            inverse * scatter * inverse
        };
        let levels = self.levels.iter().filter(|level| level.count >= FEWEST_BLOCKS);
        let of_levels: Vec<DMatrix<f64>> = levels.map(of_level).collect();
        let Some(single) = of_levels.first() else {
            return DMatrix::from_element(self.parameters, self.parameters, f64::INFINITY);
        };
        let variances: DVector<f64> = single.diagonal();
        let inflation = |covariance: &DMatrix<f64>| -> f64 { covariance.diagonal().component_div(&variances).sum() };
        // The correlation that blocks of length L miss falls as 1/L, so the two longest lengths extrapolate to infinite blocks.
        let endless = match of_levels.as_slice() {
            [.., shorter, longer] => Some(longer * 2.0 - shorter),
            _ => None,
        };
        let endless = endless.filter(|covariance| covariance.clone().cholesky().is_some());
        let of_groups = self.of_groups(inverse, &variances);
        let all = || of_levels.iter().chain(&endless).chain(&of_groups);
        let in_time = of_levels.iter().chain(&endless);
        let most = in_time.fold(single, |most, other| if inflation(other) > inflation(most) { other } else { most });
        // Each variance comes from the length at which it is greatest; the correlations come from the length with the greatest total.
        let factors = DVector::from_fn(self.parameters, |place, _| {
            let greatest = all().fold(0.0, |greatest: f64, covariance| greatest.max(covariance[(place, place)]));
            let ratio = greatest / most[(place, place)];
            if ratio.is_finite() { ratio.sqrt() } else { 1.0 }
        });
        DMatrix::from_fn(self.parameters, self.parameters, |row, column| {
            factors[row] * factors[column] * most[(row, column)]
        })
    }
}

impl Scores {
    /// Returns the covariances by groups of each condition, for those parameters whose value exceeds `variances` by more than chance; the variances
    /// of the others are zero.
    fn of_groups(&self, inverse: &DMatrix<f64>, variances: &DVector<f64>) -> Vec<DMatrix<f64>> {
        let of_condition = |sums: &Vec<f64>| {
            let mut scatter = DMatrix::zeros(self.parameters, self.parameters);
            let mut count = 0_usize;
            for of_group in sums.chunks_exact(self.parameters).filter(|sums| sums.iter().any(|sum| sum.abs() > 0.0)) {
                let score = DVector::from_row_slice(of_group);
                scatter += &score * score.transpose();
                count += 1;
            }
            #[expect(clippy::cast_precision_loss, reason = "a small count")]
            let (groups, free) = (count as f64, count.saturating_sub(self.parameters) as f64);
            // The scores of all groups sum to zero for every parameter.
            let covariance = inverse * scatter * inverse * (groups / free);
            // A variance computed from `count` squares has a relative standard deviation of √(2/count).
            let bound = 1.0 + CHANCE * (2.0 / groups).sqrt();
            let counts = |place: usize| covariance[(place, place)] > bound * variances[place];
            let kept = DMatrix::from_fn(self.parameters, self.parameters, |row, column| {
                if counts(row) && counts(column) { covariance[(row, column)] } else { 0.0 }
            });
            let any = (0..self.parameters).any(counts);
            (any && count >= FEWEST_BLOCKS.max(2 * self.parameters)).then_some(kept)
        };
        self.groups.iter().flat_map(|(_, sums)| sums).filter(|_| self.parameters > 0).filter_map(of_condition).collect()
    }
}

impl Level {
    /// Adds a block. Returns true if it completes a block of the next length, which then replaces it.
    fn add(&mut self, block: &mut [f64]) -> bool {
        self.count += 1;
        add_products(&mut self.squares, block);
        if self.is_waiting {
            block.iter_mut().zip(&self.half).for_each(|(part, half)| *part += half);
        } else {
            self.half.copy_from_slice(block);
        }
        self.is_waiting = !self.is_waiting;
        !self.is_waiting
    }
}

#[cfg(test)]
mod tests {
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    /// Returns the standard error of the mean of `count` numbers with correlation `memory` from one sample to the next.
    fn error_of_mean(seed: u64, count: u32, memory: f64) -> f64 {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut scores = Scores::new(1);
        let mut number = 0.0;
        for _ in 0..count {
            let fresh: f64 = StandardNormal.sample(&mut random);
            number = memory * number + (1.0 - memory * memory).sqrt() * fresh;
            scores.add(&[number]);
        }
        scores.covariance(&DMatrix::from_element(1, 1, 1.0 / f64::from(count)))[(0, 0)].sqrt()
    }

    /// A mean over twenty operating conditions, each with a level of its own: its error is that of a mean of twenty numbers, however many samples
    /// each condition has. Without levels it is that of the white noise.
    #[test]
    fn a_model_error_that_goes_with_a_condition_counts_once_for_each() {
        const CONDITIONS: usize = 20;
        const COUNT: usize = 20_000;
        let mut random = ChaCha8Rng::seed_from_u64(7);
        for deviation in [0.0, 0.5] {
            let mut numbers: Vec<f64> = (0..CONDITIONS).map(|_| StandardNormal.sample(&mut random)).collect();
            let mean = numbers.iter().sum::<f64>() / 20.0;
            for number in &mut numbers {
                *number = deviation * (*number - mean);
            }
            let of_levels = (numbers.iter().map(|level| level * level).sum::<f64>() / (20.0 * 19.0)).sqrt();
            let mut scores = Scores::grouped(1, Groups::every(CONDITIONS, COUNT));
            for place in 0..COUNT {
                let fresh: f64 = StandardNormal.sample(&mut random);
                scores.add_of(place, &[numbers[place % CONDITIONS] + fresh]);
            }
            let found = scores.covariance(&DMatrix::from_element(1, 1, 1.0 / 20_000.0))[(0, 0)].sqrt();
            let white = (1.0_f64 / 20_000.0).sqrt();
            let expected = of_levels.max(white);
            assert!(found > 0.8 * expected && found < 1.6 * expected, "{deviation}: {found} {expected}");
        }
    }

    #[test]
    fn the_error_of_a_mean_is_the_textbooks() {
        for (memory, tolerance) in [(0.0_f64, 0.25), (0.9, 0.3), (0.99, 0.45)] {
            // Variance of the mean of an AR(1) series: σ²/n·(1 + ρ)/(1 − ρ).
            let expected = ((1.0 + memory) / (1.0 - memory) / 40_000.0).sqrt();
            let mean: f64 = (0..10).map(|seed| error_of_mean(seed, 40_000, memory)).sum::<f64>() / 10.0;
            assert!(mean > 0.9 * expected && mean < (1.0 + tolerance) * expected, "{memory}: {mean} {expected}");
        }
    }
}
