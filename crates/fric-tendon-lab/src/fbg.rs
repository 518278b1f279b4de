//! Fibre Bragg gratings: converts wavelength shifts to tensions, \[C\] 2–7.
//!
//! The calibration of each grating is a line `T = a·Δλ + b`, fitted by least squares over load steps; without load steps [`StrainForm`] computes it
//! from the fibre's properties. An unloaded grating measures the temperature alone ([`without_temperature`]). Non-finite shifts give non-finite
//! tensions; [`bridged`] interpolates them and marks them.

use fric_tendon::ManipulatorParams;
use serde::Serialize;

use super::error::ContinuumError;

/// One step of a calibration.
#[derive(Clone, Debug, PartialEq)]
pub struct LoadStep {
    /// Load on the fibre, N.
    pub load_n: f64,
    /// Shift of each grating, nm.
    pub shift_nm: Vec<f64>,
}

/// The calibration line of one grating, \[C\] 7, with its uncertainty.
#[derive(Clone, Debug, PartialEq)]
pub struct Calibration {
    /// a, N/nm.
    pub newton_per_nm: f64,
    /// b, N.
    pub offset_n: f64,
    /// Residuals of the load steps relative to the greatest load; empty without load steps.
    pub residual_ratio: Vec<f64>,
    /// Error at each load step of the line through all others, relative to the greatest load.
    pub left_out_ratio: Vec<f64>,
    /// Standard deviation of a tension from one shift, N, including the noise of the shift.
    pub noise_n: f64,
    /// Mean shift, nm. The variance of the line grows with the distance from it: `var = noise²(1/n + (Δλ − mean)²/spread)`.
    mean_nm: f64,
    spread_nm2: f64,
    /// Least and greatest shift of the load steps, nm.
    range_nm: [f64; 2],
    count: usize,
}

/// The uncertainty of a line: an error of its constant and an independent error of its slope, around the mean shift of its load steps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct LineError {
    /// Standard error at the mean shift, N.
    pub line_error_n: f64,
    /// Standard error of the slope, N/nm.
    pub slope_error_n_per_nm: f64,
    /// Mean shift, nm.
    pub mean_shift_nm: f64,
}

impl LineError {
    /// Returns the error of the tension at a shift for one standard error of the constant and for one of the slope, N.
    #[must_use]
    pub fn parts_n(&self, shift_nm: f64) -> [f64; 2] {
        [self.line_error_n, self.slope_error_n_per_nm * (shift_nm - self.mean_shift_nm)]
    }
}

/// A tension with its standard error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tension {
    /// The tension, N.
    pub value_n: f64,
    /// Its standard error, N, due to line and shift.
    pub standard_error_n: f64,
}

impl Calibration {
    /// Creates a known line, with the standard error of a tension from one shift.
    #[must_use]
    pub fn known(newton_per_nm: f64, offset_n: f64, standard_error_n: f64) -> Self {
        Self {
            newton_per_nm,
            offset_n,
            residual_ratio: Vec::new(),
            left_out_ratio: Vec::new(),
            noise_n: standard_error_n,
            mean_nm: 0.0,
            spread_nm2: f64::INFINITY,
            range_nm: [0.0; 2],
            count: 0,
        }
    }

    /// Returns the greatest standard error of a tension over the shifts of the load steps, N.
    #[must_use]
    pub fn largest_standard_error_n(&self) -> f64 {
        let far_nm = self.range_nm.iter().map(|shift_nm| self.tension(*shift_nm).standard_error_n);
        far_nm.fold(self.noise_n, f64::max)
    }

    /// Returns the uncertainty of the line from its load steps; zero for a known line.
    #[must_use]
    pub fn line_error(&self) -> LineError {
        if self.count == 0 {
            return LineError::default();
        }
        #[expect(clippy::cast_precision_loss, reason = "a number of load steps")]
        let count = self.count as f64;
        LineError {
            line_error_n: self.noise_n / libm::sqrt(count),
            slope_error_n_per_nm: self.noise_n / libm::sqrt(self.spread_nm2),
            mean_shift_nm: self.mean_nm,
        }
    }

    /// Fits the lines of all gratings.
    ///
    /// # Errors
    /// Returns [`ContinuumError::TooFewLoads`] for fewer than three load steps, [`ContinuumError::WrongCount`] for steps with different numbers of
    /// gratings, and [`ContinuumError::DeadGrating`] for a grating whose shift does not follow the load.
    pub fn fit_all(steps: &[LoadStep]) -> Result<Vec<Self>, ContinuumError> {
        let count = steps.first().map_or(0, |step| step.shift_nm.len());
        if let Some(step) = steps.iter().find(|step| step.shift_nm.len() != count) {
            return Err(ContinuumError::WrongCount { what: "shifts", count: step.shift_nm.len(), needed: count });
        }
        (0..count)
            .map(|grating| {
                let points = steps.iter().filter_map(|step| Some((*step.shift_nm.get(grating)?, step.load_n)));
                Self::fit(
                    grating,
                    &points.filter(|(shift, load)| shift.is_finite() && load.is_finite()).collect::<Vec<_>>(),
                )
            })
            .collect()
    }

    /// Fits one line to pairs of shift, nm, and load, N.
    fn fit(grating: usize, points: &[(f64, f64)]) -> Result<Self, ContinuumError> {
        const NEEDED: usize = 3;
        let grating = grating + 1;
        let too_few = ContinuumError::TooFewLoads { grating, count: points.len(), needed: NEEDED };
        if points.len() < NEEDED {
            return Err(too_few);
        }
        #[expect(clippy::cast_precision_loss, reason = "a number of load steps")]
        let count = points.len() as f64;
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / count;
        let mean_nm = mean(&|point| point.0);
        let mean_n = mean(&|point| point.1);
        let spread_nm2: f64 = points.iter().map(|point| (point.0 - mean_nm).powi(2)).sum();
        let load_spread_n2: f64 = points.iter().map(|point| (point.1 - mean_n).powi(2)).sum();
        let common: f64 = points.iter().map(|point| (point.0 - mean_nm) * (point.1 - mean_n)).sum();
        if load_spread_n2 <= 0.0 {
            return Err(too_few);
        }
        // Less than half of the scatter follows the load.
        if spread_nm2 <= 0.0 || common * common < 0.5 * spread_nm2 * load_spread_n2 {
            return Err(ContinuumError::DeadGrating { grating });
        }
        let newton_per_nm = common / spread_nm2;
        let offset_n = mean_n - newton_per_nm * mean_nm;
        let residuals: Vec<f64> = points.iter().map(|(shift, load)| load - newton_per_nm * shift - offset_n).collect();
        let full_n = points.iter().map(|point| point.1.abs()).fold(0.0, f64::max);
        let squares: f64 = residuals.iter().map(|residual| residual * residual).sum();
        // The residual of the line through all other points: r/(1 − h) with the leverage h of the point.
        let left_out = points.iter().zip(&residuals).map(|((shift, _), residual)| {
            residual / (1.0 - 1.0 / count - (shift - mean_nm).powi(2) / spread_nm2) / full_n
        });
        Ok(Self {
            newton_per_nm,
            offset_n,
            left_out_ratio: left_out.collect(),
            residual_ratio: residuals.iter().map(|residual| residual / full_n).collect(),
            noise_n: libm::sqrt(squares / (count - 2.0)),
            mean_nm,
            spread_nm2,
            range_nm: points
                .iter()
                .fold([mean_nm; 2], |[least, most], (shift, _)| [least.min(*shift), most.max(*shift)]),
            count: points.len(),
        })
    }

    /// Returns the tension for a shift, \[C\] 7.
    #[must_use]
    pub fn tension(&self, shift_nm: f64) -> Tension {
        #[expect(clippy::cast_precision_loss, reason = "a number of load steps")]
        let share = if self.count == 0 { 0.0 } else { 1.0 / self.count as f64 };
        let line = share + (shift_nm - self.mean_nm).powi(2) / self.spread_nm2;
        Tension {
            value_n: self.newton_per_nm * shift_nm + self.offset_n,
            standard_error_n: self.noise_n * libm::sqrt(1.0 + line),
        }
    }

    /// Returns the shift for a tension, nm.
    #[must_use]
    pub fn shift_nm(&self, tension_n: f64) -> f64 {
        (tension_n - self.offset_n) / self.newton_per_nm
    }

    /// Returns the greatest residual, relative to the greatest load.
    #[must_use]
    pub fn largest_residual_ratio(&self) -> f64 {
        self.residual_ratio.iter().fold(0.0, |most, residual| most.max(residual.abs()))
    }

    /// Returns the greatest error at a load step of the line through all others, relative to the greatest load.
    #[must_use]
    pub fn largest_left_out_ratio(&self) -> f64 {
        self.left_out_ratio.iter().fold(0.0, |most, error| most.max(error.abs()))
    }
}

/// A grating without calibration, \[C\] 3 and 4.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StrainForm {
    /// Bragg wavelength λ_B, nm.
    pub wavelength_nm: f64,
    /// Effective photoelastic coefficient P_e, 1; 0.22 for silica.
    pub photoelastic_ratio: f64,
    /// Axial stiffness E_f·A_f of the fibre, N.
    pub axial_stiffness_n: f64,
}

impl StrainForm {
    /// Returns `T = Δλ·E_f·A_f/(λ_B(1 − P_e))`, \[C\] 4, as a line without offset or uncertainty.
    ///
    /// # Errors
    /// Returns [`ContinuumError::OptionOutOfRange`] for a number that no fibre has.
    pub fn calibration(&self) -> Result<Calibration, ContinuumError> {
        let ranges = [
            ("wavelength_nm", self.wavelength_nm, 100.0, 1e4),
            ("photoelastic_ratio", self.photoelastic_ratio, 0.0, 0.9),
            ("axial_stiffness_n", self.axial_stiffness_n, 1.0, 1e9),
        ];
        for (key, value, min, max) in ranges {
            if !(min..=max).contains(&value) {
                return Err(ContinuumError::OptionOutOfRange { key, value, min, max });
            }
        }
        let strain_per_nm = 1.0 / (self.wavelength_nm * (1.0 - self.photoelastic_ratio));
        Ok(Calibration::known(strain_per_nm * self.axial_stiffness_n, 0.0, 0.0))
    }
}

/// Returns the shifts without the effect of temperature, \[C\] 2.
///
/// An unloaded grating of the same fibre at the same temperature shows `Δλ_ref = λ_ref(α_Λ + α_n)ΔT`; `λ_i/λ_ref` times this shift is subtracted from
/// each other grating. `wavelength_nm` holds the Bragg wavelengths of the loaded gratings and, last, of the reference. Lists of different lengths are
/// cut to the shortest.
#[must_use]
pub fn without_temperature(
    shift_nm: &[f64],
    reference_shift_nm: f64,
    wavelength_nm: &[f64],
    reference_wavelength_nm: f64,
) -> Vec<f64> {
    let thermal_ratio = reference_shift_nm / reference_wavelength_nm;
    shift_nm.iter().zip(wavelength_nm).map(|(shift, wavelength)| shift - wavelength * thermal_ratio).collect()
}

/// Returns the tensions with dead gratings interpolated linearly between their neighbours (at the tip, equal to the last live one; before the first
/// live one, from the tension at the base, if that is known), and a flag for each interpolated one. Without any live grating, all equal the tension
/// at the base.
#[must_use]
pub fn bridged(tension_base_n: f64, tension_n: &[f64]) -> (Vec<f64>, Vec<bool>) {
    let is_dead: Vec<bool> = tension_n.iter().map(|tension_n| !tension_n.is_finite()).collect();
    let mut whole = tension_n.to_vec();
    let (mut before_n, mut place) = (tension_base_n, 0);
    while place < whole.len() {
        let live = (place..whole.len()).find(|&other| !is_dead[other]);
        let Some(live) = live else {
            whole[place..].fill(before_n);
            break;
        };
        let after_n = whole[live];
        if !before_n.is_finite() {
            before_n = after_n;
        }
        #[expect(clippy::cast_precision_loss, reason = "a number of gratings")]
        let part_n = (after_n - before_n) / (live - place + 1) as f64;
        for gap in &mut whole[place..live] {
            before_n += part_n;
            *gap = before_n;
        }
        before_n = after_n;
        place = live + 1;
    }
    (whole, is_dead)
}

/// The position of a grating on the straight manipulator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GratingPlace {
    /// Distance from the face of the disk on its base side to the near end of the grating, m.
    pub from_base_side_m: f64,
    /// Length of the grating, m.
    pub length_m: f64,
}

/// Checks that every grating stays between its disks up to a bend of the whole manipulator, \[C\] 6.
///
/// The grating in segment i moves towards the base by `θ·r` for the bend θ of its own segment and those beyond, here spread evenly; \[C\] 6 is the
/// case of the first grating. The free space of a segment is between the faces of two disks.
///
/// # Errors
/// Returns [`ContinuumError::TravelTooLong`] with the first grating that would meet a disk, or [`ContinuumError::WrongCount`] for a list of the wrong
/// length.
pub fn check_travel(
    params: &ManipulatorParams,
    gratings: &[GratingPlace],
    greatest_bend_rad: f64,
) -> Result<(), ContinuumError> {
    let count = params.disk_count();
    if gratings.len() != count {
        return Err(ContinuumError::WrongCount { what: "gratings", count: gratings.len(), needed: count });
    }
    for (place, (grating, pitch_m)) in gratings.iter().zip(params.pitch_m()).enumerate() {
        let gap_m = pitch_m - params.disk_thickness_m();
        #[expect(clippy::cast_precision_loss, reason = "a number of segments")]
        let beyond_ratio = (count - place) as f64 / count as f64;
        let travel_m = greatest_bend_rad.abs() * params.hole_radius_m() * beyond_ratio;
        let fits = grating.from_base_side_m + grating.length_m <= gap_m && grating.length_m >= 0.0;
        let room_m = if fits { grating.from_base_side_m } else { 0.0 };
        if travel_m > room_m || travel_m.is_nan() {
            return Err(ContinuumError::TravelTooLong {
                grating: place + 1,
                travel_mm: 1e3 * travel_m,
                room_mm: 1e3 * room_m,
            });
        }
    }
    Ok(())
}
