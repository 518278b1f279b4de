//! How far the model's disks are from the markers, by the four ways of friction: the form of \[C\], figures 12 and 15.

use fric_core::continuum::{
    Direction, Friction, MAX_DISKS, ManipulatorError, ManipulatorParams, ShapeStatus, StaticModel, Tendon,
};

use super::fbg::{Calibration, bridged};
use super::run::RunSample;

/// A way to find the friction, by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Without friction.
    None,
    /// Coulomb's, always as pulled: the published friction model (\[C\] 11–13).
    Coulomb,
    /// From the gratings (\[C\] 14).
    Measured,
    /// From the history of the base tension, without gratings.
    History,
}

impl Way {
    /// All there are.
    pub const ALL: [Self; 4] = [Self::None, Self::Coulomb, Self::Measured, Self::History];

    /// In one word.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "none",
            Self::Coulomb => "coulomb",
            Self::Measured => "measured",
            Self::History => "history",
        }
    }
}

/// A shape computed for one sample of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct ComputedShape {
    /// What the model had to say; without a shape the lists are those of the last one.
    pub status: ShapeStatus,
    /// Centres of the disks, m.
    pub disk_position_m: Vec<[f64; 2]>,
    /// Tension in each segment, N.
    pub tension_n: Vec<f64>,
    /// Friction at each hole, N.
    pub friction_n: Vec<f64>,
    /// What each hole can hold, N.
    pub bound_n: Vec<f64>,
    /// Gratings that were bridged; empty where none are used.
    pub bridged: Vec<bool>,
}

/// Shapes of a whole run by one way. [`Way::Measured`] without calibration, or for samples without shifts, takes all gratings for dead.
///
/// # Errors
/// None for parameters that have been checked; the model's constructor has one.
pub fn shapes(
    params: &ManipulatorParams,
    samples: &[RunSample],
    way: Way,
    calibration: &[Calibration],
) -> Result<Vec<ComputedShape>, ManipulatorError> {
    let mut model = Box::new(StaticModel::<MAX_DISKS>::new(params)?);
    let mut computed = Vec::with_capacity(samples.len());
    for sample in samples {
        let base_n = [sample.tension_base_n, 0.0];
        let mut flagged = Vec::new();
        let status = match way {
            Way::None => model.solve(base_n, Friction::None),
            Way::Coulomb => model.solve(base_n, Friction::Coulomb(Direction::Pulling)),
            Way::History => model.solve(base_n, Friction::History),
            Way::Measured => {
                let mut tension_n = vec![f64::NAN; params.disk_count()];
                let gratings = sample.shift_nm.iter().zip(calibration);
                for (tension_n, (shift_nm, line)) in tension_n.iter_mut().zip(gratings) {
                    *tension_n = line.tension(*shift_nm).value_n;
                }
                let (tension_n, is_dead) = bridged(sample.tension_base_n, &tension_n);
                flagged = is_dead;
                model.solve(base_n, Friction::Measured([&tension_n, &[]]))
            }
        };
        let shape = model.shape();
        computed.push(ComputedShape {
            status,
            disk_position_m: shape.disk_position_m().to_vec(),
            tension_n: shape.tension_n(Tendon::Agonist).to_vec(),
            friction_n: shape.friction_n(Tendon::Agonist).to_vec(),
            bound_n: shape.bound_n(Tendon::Agonist).to_vec(),
            bridged: flagged,
        });
    }
    Ok(computed)
}

/// Distances between disks and their markers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShapeErrors {
    /// Greatest over all disks and shapes, mm.
    pub max_mm: f64,
    /// Sum over all disks and shapes, mm.
    sum_mm: f64,
    /// Disks compared.
    pub disk_count: usize,
    /// Shapes compared.
    pub shape_count: usize,
    /// Shapes that the model did not find, left out of the rest.
    pub missing_count: usize,
}

impl ShapeErrors {
    /// Mean over all disks and shapes, mm; `None` without any.
    #[must_use]
    pub fn mean_mm(&self) -> Option<f64> {
        #[expect(clippy::cast_precision_loss, reason = "a number of disks")]
        (self.disk_count > 0).then(|| self.sum_mm / self.disk_count as f64)
    }

    /// Adds a shape. Markers that are not finite are left out, and so is a shape that was not found.
    pub fn add(&mut self, shape: &ComputedShape, marker_m: &[[f64; 2]]) {
        if !shape.status.has_shape() {
            self.missing_count += 1;
            return;
        }
        self.shape_count += 1;
        for ([x, y], [marker_x, marker_y]) in shape.disk_position_m.iter().zip(marker_m) {
            let distance_mm = 1e3 * libm::hypot(x - marker_x, y - marker_y);
            if distance_mm.is_finite() {
                self.max_mm = self.max_mm.max(distance_mm);
                self.sum_mm += distance_mm;
                self.disk_count += 1;
            }
        }
    }
}

/// Errors of one way over chosen samples of a run. The whole run is computed all the same: history needs it.
///
/// # Errors
/// As [`shapes`].
pub fn shape_errors(
    params: &ManipulatorParams,
    samples: &[RunSample],
    way: Way,
    calibration: &[Calibration],
    mut chosen: impl FnMut(usize) -> bool,
) -> Result<ShapeErrors, ManipulatorError> {
    let mut errors = ShapeErrors::default();
    for (place, (shape, sample)) in shapes(params, samples, way, calibration)?.iter().zip(samples).enumerate() {
        if chosen(place) {
            errors.add(shape, &sample.marker_m);
        }
    }
    Ok(errors)
}
