//! Sums from which the ratio and the correlation of quantities of one motion follow.

/// Sums over quantities that belong together, one of each in a sample.
#[derive(Clone, Copy, Debug)]
pub struct Sums<const COUNT: usize> {
    count: f64,
    pub totals: [f64; COUNT],
    pub products: [[f64; COUNT]; COUNT],
}

impl<const COUNT: usize> Default for Sums<COUNT> {
    fn default() -> Self {
        Self { count: 0.0, totals: [0.0; COUNT], products: [[0.0; COUNT]; COUNT] }
    }
}

impl<const COUNT: usize> Sums<COUNT> {
    /// Adds a sample.
    pub fn add(&mut self, sample: [f64; COUNT]) {
        self.count += 1.0;
        for ((total, products), one) in self.totals.iter_mut().zip(&mut self.products).zip(sample) {
            *total += one;
            products.iter_mut().zip(sample).for_each(|(product, other)| *product += one * other);
        }
    }

    /// Returns the same with products about the means.
    pub fn centred(mut self) -> Self {
        for (products, one) in self.products.iter_mut().zip(self.totals) {
            for (product, other) in products.iter_mut().zip(self.totals) {
                *product -= one * other / self.count.max(1.0);
            }
        }
        self
    }

    /// Adds the products of another stretch.
    pub fn join(&mut self, other: &Self) {
        self.count += other.count;
        for (products, more) in self.products.iter_mut().zip(&other.products) {
            products.iter_mut().zip(more).for_each(|(product, more)| *product += more);
        }
    }

    /// Whether a quantity is so large, rms.
    pub fn is_beyond(&self, quantity: usize, least: f64) -> bool {
        self.products[quantity][quantity] > self.count * least * least
    }

    /// Returns the ratio of two quantities if they are proportional to this squared correlation.
    pub fn ratio(&self, one: usize, other: usize, correlation: f64) -> Option<f64> {
        let [own, others, both] =
            [(one, one), (other, other), (one, other)].map(|(row, column)| self.products[row][column]);
        (both * both > correlation * own * others).then(|| (own / others).sqrt().copysign(both))
    }
}
