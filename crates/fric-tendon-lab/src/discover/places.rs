//! Segments and disks, sorted by their fraction of the rest.

use fric_lab::discover::result::{Absent, WhereResult};

use super::case::Fit;
use super::markers::MarkerFit;
use super::result::Manipulator;

/// Returns the segments by their fraction of the squared residual.
pub fn segments(fit: &Fit) -> Vec<WhereResult<Manipulator>> {
    by_share("grating", fit.model.mu.len(), |segment| {
        let values = fit.residual_n.iter().filter_map(|row| row.get(segment));
        values.filter(|value| value.is_finite()).map(|value| value * value).sum()
    })
}

/// Returns the disks by their fraction of the squared distance.
pub fn disks(markers: &MarkerFit) -> Vec<WhereResult<Manipulator>> {
    by_share("marker", markers.residual_m.iter().map(Vec::len).max().unwrap_or(0), |disk| {
        let places = markers.residual_m.iter().filter_map(|row| row.get(disk));
        places.map(|[x_m, y_m]| x_m * x_m + y_m * y_m).filter(|square| square.is_finite()).sum()
    })
}

fn by_share(signal: &'static str, place_count: usize, squares: impl Fn(usize) -> f64) -> Vec<WhereResult<Manipulator>> {
    let squares: Vec<f64> = (0..place_count).map(squares).collect();
    let whole: f64 = squares.iter().sum();
    let mut shares: Vec<(usize, f64)> = squares.iter().map(|squares| squares / whole).enumerate().collect();
    shares.retain(|(_, share)| *share > 0.0);
    shares.sort_by(|(_, one), (_, other)| other.total_cmp(one));
    let place = |(place, share): (usize, f64)| WhereResult {
        signal,
        from: place + 1,
        to: place + 1,
        unit: "1",
        share_of_excess: Some(share),
        share_of_samples: Absent,
        explains: Absent,
        significance: Absent,
        intervals_s: Absent,
        range: Absent,
    };
    shares.into_iter().map(place).collect()
}
