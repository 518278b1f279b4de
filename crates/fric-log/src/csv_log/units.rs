//! Detects values that seem to have another unit than their column.

/// A quantity whose unit is checked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Quantity {
    Force,
    Length,
    Speed,
}

/// The magnitudes of the values of one quantity.
#[derive(Debug, Clone, Copy, Default)]
struct Sizes {
    count: u64,
    sum: f64,
    greatest: f64,
}

/// The magnitudes of all values so far.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Units([Sizes; 3]);

/// Mean force above which the unit is probably grams or millinewtons, N: the largest cable robots with sensors have lower forces.
const GREAT_FORCE_N: f64 = 2000.0;
/// Force below which all values are probably in kilonewtons, N.
const SMALL_FORCE_N: f64 = 0.1;
/// Length above which the unit is probably millimetres, m: the diagonal of a hall.
const GREAT_LENGTH_M: f64 = 150.0;
/// Speed above which the unit is probably millimetres per second, m/s.
const GREAT_SPEED_M_PER_S: f64 = 30.0;

impl Units {
    /// Adds a converted value.
    pub fn add(&mut self, quantity: Quantity, value: f64) {
        if value.is_finite() {
            let Sizes { count, sum, greatest } = &mut self.0[quantity as usize];
            *count += 1;
            *sum += value.abs();
            *greatest = greatest.max(value.abs());
        }
    }

    /// Returns warnings about quantities that seem to have another unit, one sentence each.
    pub fn warnings(&self) -> Vec<String> {
        let [force, length, speed] = self.0;
        #[expect(clippy::cast_precision_loss, reason = "a mean for people")]
        let mean = |sizes: Sizes| sizes.sum / sizes.count as f64;
        let warning = |what: &str, value: f64, unit: &str, other: &str, factor: &str| {
            format!(
                "{what} {value:.4} {unit}, which looks like {other}: if so, give the columns `factor = {factor}` under \
                 `[log.columns]` in the robot file"
            )
        };
        let mut warnings = Vec::new();
        if force.count > 0 && mean(force) > GREAT_FORCE_N {
            warnings.push(warning(
                "forces are on average",
                mean(force),
                "N",
                "grams (or millinewtons, factor 0.001)",
                "0.00980665",
            ));
        }
        if force.greatest > 0.0 && force.greatest < SMALL_FORCE_N {
            warnings.push(warning("forces are at most", force.greatest, "N", "kilonewtons", "1000"));
        }
        if length.greatest > GREAT_LENGTH_M {
            warnings.push(warning("lengths are up to", length.greatest, "m", "millimetres", "0.001"));
        }
        if speed.greatest > GREAT_SPEED_M_PER_S {
            warnings.push(warning("speeds are up to", speed.greatest, "m/s", "millimetres a second", "0.001"));
        }
        warnings
    }
}
