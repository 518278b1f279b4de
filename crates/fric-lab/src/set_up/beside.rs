//! A force beside the reference: levels, and how the one changes with the other.
//!
//! Friction changes its sign with the direction of motion, so changes are those within each direction. Neither force is exact; the slope of the one over the
//! other lies between those of the regressions either way (R. Frisch, *Statistical Confluence Analysis*, 1934).

/// Least squared correlation of two forces that change together: both slopes are then within a factor of two. At 0.3 and 0.7 the same of the logs at hand
/// change together.
const LEAST_COHERENCE: f64 = 0.5;

/// Sums over samples of one direction of motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sums {
    pub count: f64,
    pub force: f64,
    pub reference: f64,
    force_squares: f64,
    reference_squares: f64,
    products: f64,
}

impl Sums {
    fn add(&mut self, force_n: f64, reference_n: f64) {
        self.count += 1.0;
        self.force += force_n;
        self.reference += reference_n;
        self.force_squares += force_n * force_n;
        self.reference_squares += reference_n * reference_n;
        self.products += force_n * reference_n;
    }

    fn join(self, other: Self) -> Self {
        Self {
            count: self.count + other.count,
            force: self.force + other.force,
            reference: self.reference + other.reference,
            force_squares: self.force_squares + other.force_squares,
            reference_squares: self.reference_squares + other.reference_squares,
            products: self.products + other.products,
        }
    }

    /// Returns the root of the mean square of the reference, N.
    pub fn reference_rms_n(&self) -> f64 {
        (self.reference_squares / self.count).sqrt()
    }

    /// Returns the sums of squares and products about the means.
    fn centred(&self) -> Centred {
        let beyond = |products: f64, one: f64, other: f64| {
            if self.count > 0.0 { products - one * other / self.count } else { 0.0 }
        };
        Centred {
            count: self.count,
            force: beyond(self.force_squares, self.force, self.force),
            reference: beyond(self.reference_squares, self.reference, self.reference),
            both: beyond(self.products, self.force, self.reference),
        }
    }
}

/// Sums of squares and products about means.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Centred {
    count: f64,
    force: f64,
    reference: f64,
    both: f64,
}

impl Centred {
    /// Returns the variance of the reference.
    pub fn variance(&self) -> f64 {
        self.reference / self.count
    }

    /// Returns the slopes of the force over the reference, by least squares of either.
    pub fn slopes(&self) -> [f64; 2] {
        [self.both / self.reference, self.force / self.both]
    }
}

/// A force beside the reference, apart for both directions of motion and for before the first.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Beside([Sums; 3]);

/// How a force changes with the reference within each direction of motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Changes {
    /// The least and the greatest slope.
    pub slopes: [f64; 2],
    /// Half the difference between both directions at the same reference, N.
    pub friction_n: f64,
    /// Standard deviation of the reference, N.
    pub reference_n: f64,
}

impl Beside {
    /// Adds a sample; `sign` is that of the motion.
    pub fn add(&mut self, sign: f64, force_n: f64, reference_n: f64) {
        let [back, still, out] = &mut self.0;
        let of_direction = if sign > 0.0 {
            out
        } else if sign < 0.0 {
            back
        } else {
            still
        };
        of_direction.add(force_n, reference_n);
    }

    /// Returns the sums over all samples.
    pub fn total(&self) -> Sums {
        self.0.into_iter().fold(Sums::default(), Sums::join)
    }

    /// Returns the sums over all samples about their means.
    pub fn centred(&self) -> Centred {
        self.total().centred()
    }

    /// Returns how the force changes with the reference; `None` if it does not.
    pub fn changes(&self) -> Option<Changes> {
        let [mut sum, still, out] = self.0.map(|sums| sums.centred());
        for of in [still, out] {
            sum = Centred {
                count: sum.count + of.count,
                force: sum.force + of.force,
                reference: sum.reference + of.reference,
                both: sum.both + of.both,
            };
        }
        if sum.both * sum.both <= LEAST_COHERENCE * sum.force * sum.reference {
            return None;
        }
        let mut slopes = sum.slopes();
        slopes.sort_by(f64::total_cmp);
        let slope = Changes { slopes, friction_n: 0.0, reference_n: 0.0 }.slope();
        let level_n = |sums: &Sums| (sums.force - slope * sums.reference) / sums.count;
        let [back, _, out] = &self.0;
        let apart_n = level_n(back) - level_n(out);
        let friction_n = if apart_n.is_finite() { 0.5 * apart_n.abs() } else { 0.0 };
        Some(Changes { slopes, friction_n, reference_n: sum.variance().sqrt() })
    }
}

impl Changes {
    /// Returns the slope between both.
    pub fn slope(&self) -> f64 {
        let [least, greatest] = self.slopes;
        least.signum() * (least * greatest).sqrt()
    }

    /// Returns the least and the greatest slope if friction goes with the load as far as it can.
    pub fn beside_friction(&self) -> [f64; 2] {
        let [least, greatest] = self.slopes;
        let by_friction = self.friction_n / self.reference_n;
        [least - by_friction, greatest + by_friction]
    }
}
