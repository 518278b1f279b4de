//! Load benches: converts columns to the steps of a calibration, and to the loads on a single hole.

use std::f64::consts::PI;

use fric_tendon::{ManipulatorParams, Tendon};

use super::columns::{self, Columns};
use super::error::ContinuumError;
use super::fbg::{LoadStep, without_temperature};
use super::friction::HoleLoad;
use super::simulate::STANDARD_GRAVITY_M_PER_S2;

/// Returns the calibration steps of a manipulator from `load_g` (mass on a hook, g) or `load_n`, and `shift_1_nm …`. If `wavelengths_nm` holds the
/// Bragg wavelengths of the gratings and of the reference, and `shift_reference_nm` is present, the temperature effect is removed (\[C\] 2).
///
/// # Errors
/// Returns a [`ContinuumError`] for a column that is unknown, missing, of another length or likely in another unit, and for a load that is not a
/// number.
pub fn load_steps(
    given: &[(String, Vec<f64>)],
    params: &ManipulatorParams,
    wavelengths_nm: Option<(&[f64], f64)>,
) -> Result<Vec<LoadStep>, ContinuumError> {
    let disk_count = params.disk_count();
    let all = Columns::new(given, &columns::of_calibration(disk_count))?;
    let [grams, newtons] = columns::LOADS;
    let (key, unit_n) =
        if all.get(newtons).is_some() { (newtons, 1.0) } else { (grams, 1e-3 * STANDARD_GRAVITY_M_PER_S2) };
    let loads = all.required(key)?;
    let greatest_n = loads.iter().map(|load| load.abs()).fold(0.0, f64::max);
    let capacity_n = params.capacity_n(Tendon::Agonist);
    if key == newtons && greatest_n > capacity_n {
        return Err(ContinuumError::LoadUnit { greatest_n, capacity_n });
    }
    let shift_nm = all.shifts(disk_count)?.ok_or_else(|| ContinuumError::MissingColumn {
        column: columns::shifts(1).concat(),
        beside: Some(key.to_owned()),
    })?;
    let reference_nm = all.get(columns::SHIFT_REFERENCE);
    loads
        .iter()
        .enumerate()
        .map(|(row, load)| {
            if !load.is_finite() {
                return Err(ContinuumError::NotFinite { column: key.to_owned(), row: row + 1, value: *load });
            }
            let shift_nm: Vec<f64> = shift_nm.iter().filter_map(|column| column.get(row)).copied().collect();
            let reference_nm = reference_nm.and_then(|column| column.get(row)).copied();
            let shift_nm = match (reference_nm, wavelengths_nm) {
                (Some(reference_nm), Some((all, reference))) => {
                    without_temperature(&shift_nm, reference_nm, all, reference)
                }
                _ => shift_nm,
            };
            Ok(LoadStep { load_n: load * unit_n, shift_nm })
        })
        .collect()
}

/// Returns the loads on a single hole from `tension_1_n`, `tension_2_n`, `angle_1_rad` and `angle_2_rad`: F_1, F_2, θ_1 and θ_2 of \[C\] 16.
///
/// # Errors
/// Returns a [`ContinuumError`] for a column that is unknown, missing or of another length, and for a cell that is not a number, or not an angle in
/// rad.
pub fn hole_loads(given: &[(String, Vec<f64>)]) -> Result<Vec<HoleLoad>, ContinuumError> {
    let all = Columns::new(given, &columns::of_hole())?;
    let [first_n, second_n, first_rad, second_rad] = columns::HOLE;
    let number = |column: &str, row: usize| {
        let value = all.required(column)?.get(row).copied().unwrap_or(f64::NAN);
        if value.is_finite() {
            Ok(value)
        } else {
            Err(ContinuumError::NotFinite { column: column.to_owned(), row: row + 1, value })
        }
    };
    let angle = |column: &str, row: usize| {
        let value = number(column, row)?;
        if value.abs() <= PI {
            Ok(value)
        } else {
            Err(ContinuumError::NoAngle { column: column.to_owned(), row: row + 1, value })
        }
    };
    let load = |row: usize| {
        Ok(HoleLoad {
            first_n: number(first_n, row)?,
            second_n: number(second_n, row)?,
            first_rad: angle(first_rad, row)?,
            second_rad: angle(second_rad, row)?,
        })
    };
    (0..all.row_count()).map(load).collect()
}
