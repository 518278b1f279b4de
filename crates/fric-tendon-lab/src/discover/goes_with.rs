//! Finds what the rest correlates with: the one physical regressor that explains most of it.
//!
//! The regressor is not a name but a hint: a temperature change shifts all gratings equally, and a backbone that is stiffer than stated displaces all
//! disks along their bending motion.

use fric_lab::numbers::Numbers;
use nalgebra::{DMatrix, DVector};
use serde::Serialize;

use super::case::{Case, Fit};
use super::markers::{MarkerFit, residuals};

/// Minimum fraction of the rest's squares that a regressor must explain.
const LEAST_SHARE: f64 = 0.5;
/// Relative change of the stiffness for its derivative by finite differences.
const STIFFNESS_CHANGE: f64 = 0.01;
/// Temperature sensitivity of a silica grating, `α_Λ + α_n`, 1/K, and the C-band wavelength, nm, which is used if the file states none.
pub const SILICA_PER_K: f64 = 6.85e-6;
pub const USUAL_WAVELENGTH_NM: f64 = 1550.0;

/// A regressor that a rest correlates with.
#[derive(Clone, Debug, Serialize)]
pub struct GoesWith {
    /// `grating` or `marker`: the signal of the rest.
    pub signal: &'static str,
    /// `temperature`, `temperature_step`, `temperature_drift`, `tension`; `bending`, `frame`, `frame_drift`; of faults of the recording `frozen`,
    /// `exchanged`, `reference_delay`.
    pub with: &'static str,
    /// Fraction of the squares that it explains; `None` for a fault of the recording, which the run is compared without.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub share: Option<f64>,
    /// Its size.
    pub parameters: Numbers,
    /// A sentence for people.
    #[serde(skip)]
    pub sentence: String,
}

impl GoesWith {
    fn explained(&self) -> f64 {
        self.share.unwrap_or(0.0)
    }
}

/// Rows of regressors, with the explained quantity last. Rows with a gap are left out.
struct Rows {
    normal: DMatrix<f64>,
    right: DVector<f64>,
    squares: f64,
}

impl Rows {
    fn new(rows: impl Iterator<Item = (Vec<f64>, f64)>, count: usize) -> Self {
        let mut all = Self { normal: DMatrix::zeros(count, count), right: DVector::zeros(count), squares: 0.0 };
        for (regressors, left) in
            rows.filter(|(regressors, left)| left.is_finite() && regressors.iter().all(|one| one.is_finite()))
        {
            let regressors = DVector::from_vec(regressors);
            all.normal += &regressors * regressors.transpose();
            all.right += left * regressors;
            all.squares += left * left;
        }
        all
    }

    /// Returns the fraction of the squares that the regressors explain, and their coefficients.
    fn solved(&self) -> Option<(f64, Vec<f64>)> {
        let found = self.normal.clone().cholesky()?.solve(&self.right);
        (self.squares > 0.0).then(|| (found.dot(&self.right) / self.squares, found.as_slice().to_vec()))
    }
}

fn numbers(pairs: &[(&str, f64)]) -> Numbers {
    Numbers(pairs.iter().map(|(name, value)| ((*name).to_owned(), *value)).collect())
}

fn best(candidates: impl IntoIterator<Item = GoesWith>) -> Option<GoesWith> {
    let likely = candidates.into_iter().filter(|one| one.share >= Some(LEAST_SHARE));
    likely.max_by(|one, other| one.explained().total_cmp(&other.explained()))
}

/// Returns the step of all shifts that explains most of a rest: its fraction of the squares, the shift, nm, and the sample at which it starts. One
/// pass from the end adds samples to the part after the step; the part before it only contributes to the total squares.
fn best_step(rest_n: &[Vec<f64>], newton_per_nm: &dyn Fn(usize) -> f64) -> Option<(f64, f64, usize)> {
    let mut sums = Vec::with_capacity(rest_n.len());
    let (mut normal, mut right, mut squares) = (0.0, 0.0, 0.0);
    for (begin, row) in rest_n.iter().enumerate().rev() {
        for (segment, left_n) in row.iter().enumerate().filter(|(_, left_n)| left_n.is_finite()) {
            let slope = newton_per_nm(segment);
            normal += slope * slope;
            right += slope * left_n;
            squares += left_n * left_n;
        }
        sums.push((begin, normal, right));
    }
    let steps = sums.into_iter().filter(|(begin, normal, _)| *begin > 0 && *normal > 0.0);
    let found = steps.map(|(begin, normal, right)| (right * right / (normal * squares), right / normal, begin));
    found.filter(|_| squares > 0.0).max_by(|(one, ..), (other, ..)| one.total_cmp(other))
}

/// Returns the regressor of the tensions' rest. `given` is the model as stated in the file, because a fit would adjust the friction to other causes.
pub fn of_tensions(case: &Case<'_>, given: &Fit) -> Option<GoesWith> {
    let start_s = case.samples.first()?.time_s;
    let wavelengths = case.file.tables().gratings.as_ref().and_then(|table| table.wavelength_nm.as_ref());
    let wavelength_nm = wavelengths.and_then(|all| all.as_slice().first()).copied().unwrap_or(USUAL_WAVELENGTH_NM);
    let kelvin = |shift_nm: f64| shift_nm / (wavelength_nm * SILICA_PER_K);
    let remedy = "Calibrate at the temperature of the run, or lead a grating without load along and record it as shift_reference_nm.";
    let solved = |regressor: &dyn Fn(usize, usize) -> f64| {
        let rows =
            given.residual_n.iter().enumerate().flat_map(|(sample, row)| {
                row.iter().enumerate().map(move |(segment, left_n)| (sample, segment, *left_n))
            });
        Rows::new(rows.map(|(sample, segment, left_n)| (vec![regressor(sample, segment)], left_n)), 1).solved()
    };
    let slope = |segment: usize| case.newton_per_nm.get(segment).copied().unwrap_or(f64::NAN);
    let found = |with, share, parameters: &[(&str, f64)], text: String| GoesWith {
        signal: "grating",
        with,
        share: Some(share),
        parameters: numbers(parameters),
        sentence: format!("{:.0} % of it {text}", 100.0 * share),
    };
    let constant = solved(&|_, segment| slope(segment)).map(|(share, shift)| {
        let text = format!(
            "is a shift of all gratings alike by {:.4} nm, as {:.1} K do. {remedy}",
            shift[0],
            kelvin(shift[0])
        );
        found("temperature", share, &[("shift_nm", shift[0]), ("temperature_k", kelvin(shift[0]))], text)
    });
    let step = best_step(&given.residual_n, &slope)
        .and_then(|(share, shift_nm, begin)| Some((share, shift_nm, case.samples.get(begin)?.time_s)))
        .map(|(share, shift_nm, from_s)| {
            let text = format!(
                "is a shift of all gratings alike by {shift_nm:.4} nm from {from_s} s on, as {:.1} K do. {remedy}",
                kelvin(shift_nm)
            );
            let parameters = [("shift_nm", shift_nm), ("temperature_k", kelvin(shift_nm)), ("from_s", from_s)];
            found("temperature_step", share, &parameters, text)
        });
    let elapsed_s = |sample: usize| case.samples.get(sample).map_or(f64::NAN, |sample| sample.time_s - start_s);
    let drift = solved(&|sample, segment| slope(segment) * elapsed_s(sample)).map(|(share, rate)| {
        let text = format!(
            "is a drift of all gratings alike by {:.2e} nm/s, as {:.2e} K/s do. {remedy}",
            rate[0],
            kelvin(rate[0])
        );
        found(
            "temperature_drift",
            share,
            &[("shift_nm_per_s", rate[0]), ("temperature_k_per_s", kelvin(rate[0]))],
            text,
        )
    });
    let observed_n =
        |sample: usize, segment: usize| case.observed_n.get(sample).and_then(|row| row.get(segment)).copied();
    let tension = solved(&|sample, segment| observed_n(sample, segment).unwrap_or(f64::NAN)).map(|(share, ratio)| {
        let text = format!(
            "goes with the tension: the gratings show {:.1} % of it more than load cell and friction account for. Check the load cell and \
             the calibration of the gratings.",
            100.0 * ratio[0]
        );
        found("tension", share, &[("ratio", ratio[0])], text)
    });
    // A step has one more parameter, its time, and approximates a drift or a constant.
    let simple = best([constant, drift, tension].into_iter().flatten());
    let is_clearer =
        |step: &GoesWith| simple.as_ref().is_none_or(|one| 1.0 - step.explained() < 0.5 * (1.0 - one.explained()));
    best(step.filter(is_clearer)).or(simple)
}

/// Returns the regressor of the markers' rest.
pub fn of_markers(case: &Case<'_>, fit: &Fit, markers: &MarkerFit) -> Option<GoesWith> {
    let start_s = case.samples.first()?.time_s;
    let stiffer_m = residuals(case, &fit.model, &case.samples, &markers.tension_n, 1.0 + STIFFNESS_CHANGE)?;
    let noise_m2 = markers.noise_m.powi(2) / markers.rms_m().powi(2);
    let solved = |count: usize, regressors: &dyn Fn(usize, usize, usize) -> Vec<f64>| {
        let rows = markers.residual_m.iter().enumerate().flat_map(|(sample, row)| {
            let disks = row.iter().enumerate();
            disks.flat_map(move |(disk, place)| [0, 1].map(|axis| (sample, disk, axis, place[axis])))
        });
        let rows = rows.map(|(sample, disk, axis, left_m)| (regressors(sample, disk, axis), left_m));
        let (share, found) = Rows::new(rows, count).solved()?;
        Some(((share / (1.0 - noise_m2)).min(1.0), found))
    };
    let found = |with, share, parameters: &[(&str, f64)], text: String| GoesWith {
        signal: "marker",
        with,
        share: Some(share),
        parameters: numbers(parameters),
        sentence: format!("{:.0} % of it {text}", 100.0 * share),
    };
    // The relative change of a shape with the stiffness. The sign is that of markers minus disks.
    let change = |sample: usize, disk: usize, axis: usize| {
        let at = |rows: &[Vec<[f64; 2]>]| rows.get(sample).and_then(|row| row.get(disk)).map(|place| place[axis]);
        at(&markers.residual_m).zip(at(&stiffer_m)).map_or(f64::NAN, |(now, moved)| (now - moved) / STIFFNESS_CHANGE)
    };
    let bending = solved(1, &|sample, disk, axis| vec![change(sample, disk, axis)]).map(|(share, ratio)| {
        let [more, stiffer] = if ratio[0] > 0.0 { ["less", "stiffer"] } else { ["more", "softer"] };
        let text = format!(
            "goes with the bending: the manipulator bends {more} than the model, as if the backbone was {:.1} % {stiffer} than stated. Check its \
             dimensions and Young's modulus, hole_radius_m, and the load cell.",
            100.0 * ratio[0].abs()
        );
        found("bending", share, &[("stiffness_ratio", 1.0 + ratio[0])], text)
    });
    let marker = |sample: usize, disk: usize| case.samples.get(sample).and_then(|one| one.marker_m.get(disk)).copied();
    let frame = |sample: usize, disk: usize, axis: usize| {
        let [x_m, y_m] = marker(sample, disk).unwrap_or([f64::NAN; 2]);
        if axis == 0 { vec![1.0, 0.0, -y_m] } else { vec![0.0, 1.0, x_m] }
    };
    let still = solved(3, &frame).map(|(share, moved)| {
        let text = format!(
            "stands still, as if the markers' frame was off by {:.2} mm, {:.2} mm and {:.2}°. Measure the frame of the markers at the base again.",
            1e3 * moved[0],
            1e3 * moved[1],
            moved[2].to_degrees()
        );
        found("frame", share, &[("x_m", moved[0]), ("y_m", moved[1]), ("angle_rad", moved[2])], text)
    });
    let elapsed_s = |sample: usize| case.samples.get(sample).map_or(f64::NAN, |sample| sample.time_s - start_s);
    let moving =
        solved(3, &|sample, disk, axis| frame(sample, disk, axis).iter().map(|one| one * elapsed_s(sample)).collect());
    let moving = moving.map(|(share, rate)| {
        let text = "goes with the time, as if base or camera moved during the run. Fix both.".to_owned();
        let parameters = [("x_m_per_s", rate[0]), ("y_m_per_s", rate[1]), ("angle_rad_per_s", rate[2])];
        found("frame_drift", share, &parameters, text)
    });
    // The frame has two more parameters than the bending.
    let frame = best([still, moving].into_iter().flatten());
    let is_clearer = |bending: &GoesWith| frame.as_ref().is_none_or(|one| bending.explained() > one.explained() - 0.02);
    best(bending.filter(is_clearer)).or(frame)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Compares with one regression for each possible start of the step, computed by [`Rows`].
    #[test]
    fn one_pass_finds_the_step_of_all_regressions() {
        let slopes = [11.0, 10.5, 12.0];
        let rest_n: Vec<Vec<f64>> = (0..60_u32)
            .map(|sample| {
                let noise = |segment: u32| f64::from((7919 * (3 * sample + segment)) % 101) / 1e4;
                let warm_nm = if sample >= 23 { 0.003 } else { 0.0 };
                let left_n = (0..3).map(|segment| slopes[segment as usize] * warm_nm + noise(segment));
                left_n.map(|left_n| if sample == 40 { f64::NAN } else { left_n }).collect()
            })
            .collect();
        let single = |begin: usize| {
            let rows = rest_n.iter().enumerate().flat_map(|(sample, row)| {
                let after = if sample >= begin { 1.0 } else { 0.0 };
                row.iter().zip(slopes).map(move |(left_n, slope)| (vec![after * slope], *left_n))
            });
            Rows::new(rows, 1).solved().map(|(share, shift)| (share, shift[0], begin))
        };
        let (share, shift_nm, begin) =
            (1..60).filter_map(single).max_by(|(one, ..), (other, ..)| one.total_cmp(other)).unwrap();
        let found = best_step(&rest_n, &|segment| slopes[segment]).unwrap();
        assert_eq!(found.2, begin);
        assert!((found.0 - share).abs() < 1e-12 && (found.1 - shift_nm).abs() < 1e-12);
        assert_eq!(begin, 23);
    }
}
