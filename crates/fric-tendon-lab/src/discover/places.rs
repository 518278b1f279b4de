//! Segments and disks, sorted by their fraction of the rest.

use super::case::Fit;
use super::markers::MarkerFit;
use super::result::TendonPlace;

/// Returns the segments by their fraction of the squared residual.
pub fn segments(fit: &Fit) -> Vec<TendonPlace> {
    by_share("grating", fit.model.mu.len(), |segment| {
        let values = fit.residual_n.iter().filter_map(|row| row.get(segment));
        values.filter(|value| value.is_finite()).map(|value| value * value).sum()
    })
}

/// Returns the disks by their fraction of the squared distance.
pub fn disks(markers: &MarkerFit) -> Vec<TendonPlace> {
    by_share("marker", markers.residual_m.iter().map(Vec::len).max().unwrap_or(0), |disk| {
        let places = markers.residual_m.iter().filter_map(|row| row.get(disk));
        places.map(|[x_m, y_m]| x_m * x_m + y_m * y_m).filter(|square| square.is_finite()).sum()
    })
}

fn by_share(signal: &'static str, place_count: usize, squares: impl Fn(usize) -> f64) -> Vec<TendonPlace> {
    let squares: Vec<f64> = (0..place_count).map(squares).collect();
    let whole: f64 = squares.iter().sum();
    let place = |(place, squares): (usize, &f64)| TendonPlace {
        signal,
        from: place + 1,
        to: place + 1,
        unit: "1",
        share_of_excess: squares / whole,
    };
    let all = squares.iter().enumerate().map(place);
    let mut all: Vec<TendonPlace> = all.filter(|one| one.share_of_excess > 0.0).collect();
    all.sort_by(|one, other| other.share_of_excess.total_cmp(&one.share_of_excess));
    all
}
