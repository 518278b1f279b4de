//! Distances between the model's disks and the markers, by the four friction models: the form of \[C\], figures 12 and 15.

use fric_tendon::{
    AnyStaticModel, Direction, Friction, MAX_DISKS, ManipulatorError, ManipulatorParams, ShapeStatus, Tendon,
};
use serde::Serialize;

use super::gratings::GratingSample;
use super::run::RunSample;

/// A friction model, by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Way {
    /// Without friction.
    None,
    /// Coulomb friction with the direction of pulling: the published friction model (\[C\] 11–13).
    Coulomb,
    /// Friction measured by the gratings (\[C\] 14).
    Measured,
    /// Friction from the history of the base tension, without gratings.
    History,
}

impl Way {
    /// All friction models.
    pub const ALL: [Self; 4] = [Self::None, Self::Coulomb, Self::Measured, Self::History];

    /// Returns the friction model of a name.
    #[must_use]
    pub fn of_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|way| way.name() == name)
    }

    /// Returns the name in one word.
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
    /// Status of the model; without a shape, the lists are those of the last one.
    pub status: ShapeStatus,
    /// Centres of the disks, m.
    pub disk_position_m: Vec<[f64; 2]>,
    /// Tension in each segment, N.
    pub tension_n: Vec<f64>,
    /// Friction at each hole, N.
    pub friction_n: Vec<f64>,
    /// Greatest friction that each hole can hold, N.
    pub bound_n: Vec<f64>,
    /// Bend of the whole manipulator, rad.
    pub bend_rad: f64,
}

/// Computes the shapes of a whole run by one friction model. `measured` holds the tensions of the gratings, sample by sample. Only [`Way::Measured`]
/// uses it, also for the tensions at the base if these were not measured.
///
/// # Errors
/// Checked parameters cause no error; the signature is that of the model's constructor.
pub fn shapes(
    params: &ManipulatorParams,
    samples: &[RunSample],
    way: Way,
    measured: &[GratingSample],
) -> Result<Vec<ComputedShape>, ManipulatorError> {
    Ok(shapes_by(AnyStaticModel::new(params)?, samples, way, measured))
}

/// Computes the same by a model in any state.
pub(super) fn shapes_by(
    mut model: AnyStaticModel,
    samples: &[RunSample],
    way: Way,
    measured: &[GratingSample],
) -> Vec<ComputedShape> {
    let count = model.params().disk_count();
    let mut measured = measured.iter();
    let mut tension_n = Vec::with_capacity(count);
    let computed = samples.iter().map(|sample| {
        let base_n = [sample.tension_base_n, 0.0];
        let status = match way {
            Way::None => model.solve(base_n, Friction::None),
            Way::Coulomb => model.solve(base_n, Friction::Coulomb(Direction::Pulling)),
            Way::History => model.solve(base_n, Friction::History),
            Way::Measured => {
                let gratings = measured.next();
                tension_n.clear();
                tension_n.extend(gratings.iter().flat_map(|gratings| &gratings.tension).map(|tension| tension.value_n));
                let first_n = tension_n.first().copied().unwrap_or(f64::NAN).max(0.0);
                let base_n = if base_n[0].is_nan() { [first_n, 0.0] } else { base_n };
                // Without a grating nothing was measured, but an empty list would mean a slack tendon.
                let no_tension = [f64::NAN; MAX_DISKS];
                let given_n = if tension_n.is_empty() { &no_tension[..count] } else { &tension_n[..] };
                model.solve(base_n, Friction::Measured([given_n, &[]]))
            }
        };
        ComputedShape {
            status,
            bend_rad: model.bend_rad(),
            disk_position_m: model.disk_position_m().to_vec(),
            tension_n: model.tension_n(Tendon::Agonist).to_vec(),
            friction_n: model.friction_n(Tendon::Agonist).to_vec(),
            bound_n: model.bound_n(Tendon::Agonist).to_vec(),
        }
    });
    computed.collect()
}

/// Distances between disks and their markers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShapeErrors {
    /// Greatest distance over all disks and shapes, mm.
    pub max_mm: f64,
    /// Sum of the distances over all disks and shapes, mm.
    sum_mm: f64,
    /// Number of compared disks.
    pub disk_count: usize,
    /// Number of compared shapes.
    pub shape_count: usize,
    /// Number of shapes that the model did not find; they are left out of the rest.
    pub missing_count: usize,
}

impl ShapeErrors {
    /// Computes the errors of one shape.
    #[must_use]
    pub fn of(shape: &ComputedShape, marker_m: &[[f64; 2]]) -> Self {
        let mut errors = Self::default();
        errors.add(shape, marker_m);
        errors
    }

    /// Returns the mean distance over all disks and shapes, mm; `None` if there are none.
    #[must_use]
    pub fn mean_mm(&self) -> Option<f64> {
        #[expect(clippy::cast_precision_loss, reason = "a number of disks")]
        (self.disk_count > 0).then(|| self.sum_mm / self.disk_count as f64)
    }

    /// Adds a shape. Markers that are not finite are left out, and so is a shape that was not found or has no marker.
    pub fn add(&mut self, shape: &ComputedShape, marker_m: &[[f64; 2]]) {
        if !shape.status.has_shape() {
            self.missing_count += 1;
            return;
        }
        self.shape_count += usize::from(!marker_m.is_empty());
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
