//! Shapes by the four friction models beside the markers, as in figures 10 to 15 of \[C\].

use std::fmt::Write as _;

use fric_lab::text::{table, wrapped};
use fric_tendon::{ManipulatorOptions, ManipulatorParams, ShapeStatus};
use serde::Serialize;

use super::friction::grating_warnings;
use super::{BridgedGrating, millimetres};
use crate::base_noise::BaseNoise;
use crate::begin::Begin;
use crate::comparison::{WayShapes, is_beyond};
use crate::guard::{Guard, Guarded};
use crate::run::Run;
use crate::shape_errors::{ShapeErrors, Way};

/// Errors that \[C\] measured on its prototype, mm: title, and max and mean for none, Coulomb and measured.
const PUBLISHED: [(&str, [[f64; 2]; 3]); 2] = [
    ("[C] fig. 12 one way", [[9.37, 5.03], [3.06, 2.21], [2.84, 2.03]]),
    ("[C] fig. 15 mixed", [[15.1, 10.56], [19.11, 16.47], [2.87, 1.75]]),
];

/// Explanation of the friction models whose names are not self-explanatory.
const LEGEND: [(Way, &str); 3] = [
    (Way::Coulomb, "friction with all holes sliding one way"),
    (Way::Measured, "friction from the gratings"),
    (Way::History, "friction from the run of the tension at the base"),
];
const PUBLISHED_LEGEND: &str = "; [C] is what the paper measured on its prototype, of which this is a model";

/// `fric-continuum-shape/1`. Distances are absent if there are no markers.
#[derive(Clone, Debug, Serialize)]
pub struct ShapeResult {
    /// Name and version of the format.
    pub format: &'static str,
    /// Name of the manipulator.
    pub manipulator: String,
    /// Number of samples.
    pub samples: usize,
    /// Errors of each friction model over the selected shapes and over all samples.
    pub ways: Vec<WayErrors>,
    /// The selected shapes.
    pub shapes: Vec<PickedShape>,
    /// Gratings that were dead in some samples.
    pub bridged: Vec<BridgedGrating>,
    /// What the guards of the gratings have found.
    pub guards: Vec<Guard>,
    /// Times of all samples, s.
    pub time_s: Vec<f64>,
    /// Each friction model at all samples.
    pub series: Vec<WaySeries>,
    /// Whether the manipulator is the one of [`PUBLISHED`].
    #[serde(skip)]
    is_prototype: bool,
}

/// Errors of one friction model.
#[derive(Clone, Debug, Serialize)]
pub struct WayErrors {
    /// The friction model.
    pub way: Way,
    /// Errors over the selected shapes.
    pub picked: ErrorResult,
    /// Errors over all samples.
    pub all: ErrorResult,
    /// Number of samples for which the model has no shape.
    pub missing: usize,
    /// Noise that was taken off the tension at the base.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub base_noise: Option<BaseNoise>,
    /// What the holes hold at the beginning of a run under tension.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub begin: Option<Begin>,
}

/// Distances between disks and markers.
#[derive(Clone, Copy, Debug, Default, Serialize)]
pub struct ErrorResult {
    /// Greatest distance, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_mm: Option<f64>,
    /// Mean distance over disks and shapes, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_mm: Option<f64>,
}

/// One shape by all friction models.
#[derive(Clone, Debug, Serialize)]
pub struct PickedShape {
    /// Index of the sample, from 0.
    pub sample: usize,
    /// Time, s.
    pub time_s: f64,
    /// Tension at the base, N; null if it was not measured.
    pub tension_base_n: f64,
    /// Measured centres of the disks, m; empty without markers.
    pub marker_m: Vec<[f64; 2]>,
    /// The shape by each friction model.
    pub ways: Vec<WayShape>,
}

/// One shape by one friction model.
#[derive(Clone, Debug, Serialize)]
pub struct WayShape {
    /// The friction model.
    pub way: Way,
    /// Distances between disks and markers.
    #[serde(flatten)]
    pub errors: ErrorResult,
    /// Bend of the manipulator, rad.
    pub bend_rad: f64,
    /// Centres of the disks, m.
    pub disk_position_m: Vec<[f64; 2]>,
    /// Tension in each segment, N.
    pub tension_n: Vec<f64>,
    /// Friction at each hole, N.
    pub friction_n: Vec<f64>,
    /// Greatest friction that each hole can hold, N.
    pub bound_n: Vec<f64>,
}

/// One friction model over the run, with one entry per sample.
#[derive(Clone, Debug, Serialize)]
pub struct WaySeries {
    /// The friction model.
    pub way: Way,
    /// Status of the model.
    pub status: Vec<String>,
    /// Bend of the manipulator, rad.
    pub bend_rad: Vec<f64>,
    /// Friction at each hole, N.
    pub friction_n: Vec<Vec<f64>>,
}

impl From<&ShapeErrors> for ErrorResult {
    fn from(errors: &ShapeErrors) -> Self {
        let mean_mm = errors.mean_mm();
        Self { max_mm: mean_mm.map(|_| errors.max_mm), mean_mm }
    }
}

/// Whether a manipulator agrees with the published prototype of \[C\] and has no load: dimensions within 1 %, and the bending stiffness, for which E
/// is not published, within 10 %.
fn is_prototype(params: &ManipulatorParams) -> bool {
    let published = ManipulatorOptions::published();
    let near = |one: f64, other: f64, share: f64| (one - other).abs() <= share * other;
    params.disk_count() == published.disk_count
        && params.pitch_m().iter().all(|pitch_m| published.pitch_m.iter().all(|other_m| near(*pitch_m, *other_m, 0.01)))
        && near(params.disk_thickness_m(), published.disk_thickness_m, 0.01)
        && near(params.hole_radius_m(), published.hole_radius_m, 0.01)
        && near(params.bending_stiffness_n_m2(), published.bending_stiffness_n_m2, 0.1)
        && params.loads_n().iter().flatten().all(|load_n| load_n.abs() <= 0.0)
}

impl ShapeResult {
    /// Name and version of the format.
    pub const FORMAT: &str = "fric-continuum-shape/1";

    /// Creates the result of a computed run. `picked` holds indices of samples.
    #[must_use]
    pub fn new(
        manipulator: &str,
        params: &ManipulatorParams,
        run: &Run,
        guarded: Option<&Guarded>,
        ways: &[WayShapes],
        picked: &[usize],
    ) -> Self {
        let shape = |place: &usize| {
            let sample = run.samples().get(*place)?;
            let by = |way: &WayShapes| {
                let shape = way.shapes.get(*place)?.clone();
                Some(WayShape {
                    way: way.way,
                    errors: ErrorResult::from(&ShapeErrors::of(&shape, &sample.marker_m)),
                    bend_rad: shape.bend_rad,
                    disk_position_m: shape.disk_position_m,
                    tension_n: shape.tension_n,
                    friction_n: shape.friction_n,
                    bound_n: shape.bound_n,
                })
            };
            Some(PickedShape {
                sample: *place,
                time_s: sample.time_s,
                tension_base_n: sample.tension_base_n,
                marker_m: sample.marker_m.clone(),
                ways: ways.iter().filter_map(by).collect(),
            })
        };
        let errors = |way: &WayShapes| {
            let mut errors = ShapeErrors::default();
            for (place, sample) in run.samples().iter().enumerate().filter(|(place, _)| picked.contains(place)) {
                if let Some(shape) = way.shapes.get(place) {
                    errors.add(shape, &sample.marker_m);
                }
            }
            let missing = way.errors.missing_count;
            WayErrors {
                way: way.way,
                picked: (&errors).into(),
                all: (&way.errors).into(),
                missing,
                base_noise: way.base_noise,
                begin: way.begin.clone(),
            }
        };
        let series = |way: &WayShapes| WaySeries {
            way: way.way,
            status: way.shapes.iter().map(|shape| shape.status.to_string()).collect(),
            bend_rad: way.shapes.iter().map(|shape| shape.bend_rad).collect(),
            friction_n: way.shapes.iter().map(|shape| shape.friction_n.clone()).collect(),
        };
        Self {
            format: Self::FORMAT,
            manipulator: manipulator.to_owned(),
            samples: run.samples().len(),
            ways: ways.iter().map(errors).collect(),
            shapes: picked.iter().filter_map(shape).collect(),
            bridged: guarded.map(|guarded| BridgedGrating::all(run, &guarded.measured)).unwrap_or_default(),
            guards: guarded.map(|guarded| guarded.guards.clone()).unwrap_or_default(),
            time_s: run.samples().iter().map(|sample| sample.time_s).collect(),
            series: ways.iter().map(series).collect(),
            is_prototype: is_prototype(params),
        }
    }

    /// Returns the greatest bend of the last friction model, which is nearest to the truth, rad.
    #[must_use]
    pub fn greatest_bend_rad(&self) -> f64 {
        let last = self.series.last().map_or(&[][..], |way| &way.bend_rad);
        last.iter().fold(0.0, |most, bend_rad| bend_rad.abs().max(most))
    }

    /// Returns the warnings about the gratings, one sentence each.
    #[must_use]
    pub fn grating_warnings(&self) -> Vec<String> {
        grating_warnings(&self.bridged, &self.guards, self.samples)
    }

    /// Returns all warnings, one sentence each.
    #[must_use]
    pub fn warnings(&self, ways: &[WayShapes]) -> Vec<String> {
        let mut warnings = self.grating_warnings();
        for way in ways {
            let name = way.way.name();
            warnings.extend(way.base_noise.map(|noise| noise.warning()));
            warnings.extend(way.begin.as_ref().map(|begin| begin.warning(self.samples)));
            let beyond: Vec<ShapeStatus> =
                way.shapes.iter().map(|shape| shape.status).filter(|status| is_beyond(*status)).collect();
            if let Some(status) = beyond.first() {
                warnings.push(format!(
                    "by `{name}` the bend of {} samples is beyond the model ({status}); those without a shape are left out",
                    beyond.len()
                ));
            }
        }
        warnings
    }

    /// Returns a table for people, at most 80 columns wide, with mean distances.
    #[must_use]
    pub fn summary(&self) -> String {
        self.table(false)
    }

    /// Returns the same table; `wide` adds the greatest distances.
    #[must_use]
    pub fn table(&self, wide: bool) -> String {
        let picked = |mean: String, max: String| if wide { vec![mean, max] } else { vec![mean] };
        let cells = |errors: ErrorResult| picked(millimetres(errors.mean_mm), millimetres(errors.max_mm));
        let mut header = ["", "time\n[s]", "tension\n[N]", "bend\n[°]"].map(ToOwned::to_owned).to_vec();
        let head = |way: &WayErrors| {
            let lines = if way.way == Way::None { ["no", "friction"] } else { ["", way.way.name()] };
            if wide {
                let name = lines.join(" ");
                vec![format!("{}\nmean", name.trim()), format!("{}\nmax", name.trim())]
            } else {
                vec![lines.join("\n")]
            }
        };
        header.extend(self.ways.iter().flat_map(head));
        let mut rows: Vec<Vec<String>> = Vec::new();
        for (place, shape) in self.shapes.iter().enumerate() {
            let best = shape.ways.iter().rev().find(|way| way.way != Way::Coulomb).or(shape.ways.last());
            let bend_rad = best.map(|way| way.bend_rad);
            let tension =
                if shape.tension_base_n.is_nan() { "–".to_owned() } else { format!("{:.3}", shape.tension_base_n) };
            let mut row = vec![
                format!("shape {}", place + 1),
                format!("{:.2}", shape.time_s),
                tension,
                bend_rad.map_or_else(|| "–".to_owned(), |bend_rad| format!("{:.1}", bend_rad.to_degrees())),
            ];
            row.extend(shape.ways.iter().flat_map(|way| cells(way.errors)));
            rows.push(row);
        }
        let mut sum = |name: String, of: &dyn Fn(&WayErrors) -> Vec<String>| {
            let mut row = vec![name, String::new(), String::new(), String::new()];
            row.extend(self.ways.iter().flat_map(of));
            rows.push(row);
        };
        let has_markers = self.ways.iter().any(|way| way.all.mean_mm.is_some());
        if has_markers {
            sum(format!("these {}", self.shapes.len()), &|way| cells(way.picked));
            sum(format!("all {}", self.samples), &|way| cells(way.all));
            for (name, published) in PUBLISHED.into_iter().filter(|_| self.is_prototype) {
                sum(name.to_owned(), &|way| {
                    let place = Way::ALL.iter().position(|other| *other == way.way);
                    let found = place.and_then(|place| published.get(place));
                    let [max, mean] = [0, 1].map(|end| millimetres(found.map(|pair| pair[end])));
                    picked(mean, max)
                });
            }
        }
        let columns: Vec<&str> = header.iter().map(String::as_str).collect();
        let legend = LEGEND.iter().filter(|(way, _)| self.ways.iter().any(|shown| shown.way == *way));
        let legend: Vec<String> = legend.map(|(way, what)| format!("{}: {what}", way.name())).collect();
        let what = if wide { "mean and greatest" } else { "mean" };
        let published = if self.is_prototype { PUBLISHED_LEGEND } else { "" };
        let legend = wrapped("", &format!("{}{published}.", legend.join("; ")));
        let mut text = format!("{}: {} samples", self.manipulator, self.samples);
        // Writing to a String cannot fail.
        let _ = if has_markers {
            write!(text, ", {what} distance between disks and markers in mm\n\n{}\n{legend}", table(&columns, 1, &rows))
        } else {
            write!(text, "\n\n{}\nNo markers to compare with.\n", table(&columns, 1, &rows))
        };
        text
    }
}
