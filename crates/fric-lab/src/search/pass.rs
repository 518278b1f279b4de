//! Passes of the cycle's equations over the records of cables, with derivatives with respect to chosen parameters.

use fric_core::parameters::{OFFSET, Values};
use fric_core::scalar::Scalar;
use fric_core::{CableCycle, CableGroup, CableParams, LANES, Lanes};

use super::dual::Dual;
use super::vector::Parameter;
use crate::samples::cable::CableRecord;
use crate::samples::record::Row;

/// Runs `$run::<N>`, where `N` is the number of derivatives that a lane carries in a pass over `$parts`. The compiler generates the whole cycle for each
/// `N`.
macro_rules! with_width_for {
    ($parts:expr, $run:ident($($argument:expr),* $(,)?)) => {
        match $crate::search::pass::lane_width($parts) {
            0 => $run::<0>($($argument),*),
            1 => $run::<1>($($argument),*),
            2 => $run::<2>($($argument),*),
            3 => $run::<3>($($argument),*),
            _ => $run::<6>($($argument),*),
        }
    };
}
pub(crate) use with_width_for;

/// Returns the number of derivatives per lane in a pass: as few as fit into the lanes of one group, because the time of a group grows with them.
pub fn lane_width(parts: &[Part<'_>]) -> usize {
    let of_group = |parts: &[Part<'_>]| {
        let lanes = |width: usize| parts.iter().map(|part| part.carried().div_ceil(width)).sum::<usize>();
        let none = parts.iter().all(|part| part.carried() == 0);
        if none { 0 } else { [1, 2, 3].into_iter().find(|width| lanes(*width) <= LANES).unwrap_or(6) }
    };
    parts.chunks(LANES).map(of_group).max().unwrap_or(0)
}

/// One cable's part in a pass.
#[derive(Clone, Debug)]
pub struct Part<'a> {
    pub record: CableRecord<'a>,
    pub values: Values,
    /// The parameters to differentiate with respect to.
    pub free: Vec<Parameter>,
}

impl Part<'_> {
    /// Returns how many derivatives the pass has to carry. The offset needs none, because the derivative of every force with respect to it is 1.
    pub fn carried(&self) -> usize {
        carried(&self.free).count()
    }

    /// Whether the forces of this part are those of the other, with at least its derivatives.
    pub fn serves(&self, other: &Self) -> bool {
        let bits = |part: &Self| part.values.map(f64::to_bits);
        std::ptr::eq(self.record.rows, other.record.rows)
            && self.record.added_noise.is_none()
            && other.record.added_noise.is_none()
            && bits(self) == bits(other)
            && (other.free.is_empty() || self.free == other.free)
    }
}

fn carried(free: &[Parameter]) -> impl Iterator<Item = &Parameter> {
    free.iter().filter(|parameter| parameter.place() != OFFSET)
}

/// Forces of one cable at the platform and their derivatives, cycle by cycle.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Forces {
    derivative_count: usize,
    numbers: Vec<f64>,
}

impl Forces {
    /// Removes all forces and reserves room for `cycles` with this number of derivatives.
    pub fn clear(&mut self, derivative_count: usize, cycles: usize) {
        self.derivative_count = derivative_count;
        self.numbers.clear();
        self.numbers.reserve(cycles * (derivative_count + 1));
    }

    /// Extrapolates the forces linearly for small changes of the parameters.
    pub fn step(&mut self, by: &[f64]) {
        for numbers in self.numbers.chunks_exact_mut(self.derivative_count + 1) {
            if let Some((force_n, derivatives)) = numbers.split_first_mut() {
                *force_n += derivatives.iter().zip(by).map(|(derivative, step)| derivative * step).sum::<f64>();
            }
        }
    }

    /// Returns the force, N, and its derivatives in a cycle; NaN past the end.
    #[inline]
    pub fn at(&self, cycle: usize) -> (f64, &[f64]) {
        let width = self.derivative_count + 1;
        let numbers = self.numbers.get(cycle * width..(cycle + 1) * width);
        numbers.and_then(<[f64]>::split_first).map_or((f64::NAN, &[]), |(force_n, derivatives)| (*force_n, derivatives))
    }
}

/// Forces of several cables with records of the same length, side by side.
///
/// A lane carries the derivatives of one cable with respect to up to `N` parameters. A cable with more of them takes several lanes, and lanes beyond
/// [`LANES`] run in further groups.
#[derive(Debug)]
pub struct LanePass<'a, const N: usize> {
    parts: Vec<Part<'a>>,
    /// For each part, where the numbers of its forces stand among those of all groups.
    columns: Vec<Vec<usize>>,
    /// The part in each lane of each group.
    lanes: Vec<[usize; LANES]>,
    /// The groups at rest.
    at_rest: Vec<CableGroup<Dual<Lanes, N>>>,
    groups: Vec<CableGroup<Dual<Lanes, N>>>,
}

/// The share of a lane in a pass: a part, and how many of its carried derivatives other lanes carry before it.
#[derive(Clone, Copy)]
struct Share {
    part: usize,
    first: usize,
}

impl<'a, const N: usize> LanePass<'a, N> {
    /// Creates a pass.
    pub fn new(parts: impl IntoIterator<Item = Part<'a>>) -> Self {
        let parts: Vec<Part<'a>> = parts.into_iter().collect();
        let shares_of = |(part, of): (usize, &Part<'_>)| {
            (0..of.carried().max(1)).step_by(N.max(1)).map(move |first| Share { part, first })
        };
        let shares: Vec<Share> = parts.iter().enumerate().flat_map(shares_of).collect();
        // The numbers of a group: the force and the derivatives in all lanes.
        let place = |lane: usize, number: usize| ((lane / LANES) * (N + 1) + number) * LANES + lane % LANES;
        let one = shares.len().div_ceil(LANES) * (N + 1) * LANES;
        let columns_of = |(part, Part { free, .. }): (usize, &Part<'_>)| {
            let first = shares.iter().position(|share| share.part == part).unwrap_or(0);
            let mut carried = (first..).flat_map(|lane| (1..=N).map(move |number| place(lane, number)));
            let of = |parameter: &Parameter| if parameter.place() == OFFSET { Some(one) } else { carried.next() };
            std::iter::once(place(first, 0)).chain(free.iter().filter_map(of)).collect()
        };
        let columns = parts.iter().enumerate().map(columns_of).collect();
        let of_shares = |shares: &[Share]| group_of::<N>(&parts, shares);
        let at_rest = shares.chunks(LANES).filter_map(of_shares).collect();
        let lanes = |shares: &[Share]| {
            std::array::from_fn(|lane| shares.get(lane).or(shares.last()).map_or(0, |share| share.part))
        };
        let lanes = shares.chunks(LANES).map(lanes).collect();
        Self { at_rest, groups: Vec::new(), columns, lanes, parts }
    }

    /// Starts a log with an empty memory.
    pub fn rest(&mut self) {
        self.groups.clone_from(&self.at_rest);
    }

    /// Runs the cycles `from..to` and appends the forces of each part to `forces`.
    pub fn advance(&mut self, from: usize, to: usize, forces: &mut [Forces]) {
        let of_log = |part: &Part<'a>| part.record.rows.get(from..to).unwrap_or_default();
        let with_noise = |part: &Part<'a>| part.record.added_noise.map(|noise| noise.on(of_log(part), from..to));
        let with_noise: Vec<Option<Vec<Row>>> = self.parts.iter().map(with_noise).collect();
        let parts = self.parts.iter().zip(&with_noise);
        let rows: Vec<&[Row]> = parts.map(|(part, noisy)| noisy.as_deref().unwrap_or(of_log(part))).collect();
        let rows_of = |lanes: &[usize; LANES]| lanes.map(|part| rows.get(part).copied().unwrap_or_default());
        let rows: Vec<[&[Row]; LANES]> = self.lanes.iter().map(rows_of).collect();
        // The numbers of all groups, and 1.
        let mut numbers = vec![1.0; self.groups.len() * (N + 1) * LANES + 1];
        for at in 0..to - from {
            let of_groups = self.groups.iter_mut().zip(&rows).zip(numbers.chunks_exact_mut((N + 1) * LANES));
            for ((group, rows), numbers) in of_groups {
                let [Some(first), Some(second), Some(third), Some(fourth)] = rows.map(|rows| rows.get(at)) else {
                    return;
                };
                let rows = [first, second, third, fourth];
                let force = group.step(|lane| cycle(rows[lane % LANES])).platform_force_n;
                let parts = std::iter::once(force.value).chain(force.gradient);
                numbers.chunks_exact_mut(LANES).zip(parts).for_each(|(to, part)| to.copy_from_slice(&part.to_array()));
            }
            for (forces, columns) in forces.iter_mut().zip(&self.columns) {
                forces.numbers.extend(columns.iter().map(|column| numbers[*column]));
            }
        }
    }
}

/// Creates the group of up to [`LANES`] lanes at rest; further lanes repeat the last one.
fn group_of<const N: usize>(parts: &[Part<'_>], shares: &[Share]) -> Option<CableGroup<Dual<Lanes, N>>> {
    let of_lane = |lane: usize| {
        let share = shares.get(lane).or(shares.last())?;
        Some((parts.get(share.part)?, share.first))
    };
    let value = |place: usize| Dual {
        value: Lanes::from_lanes(|lane| of_lane(lane).map_or(f64::NAN, |(part, _)| part.values[place])),
        gradient: std::array::from_fn(|derivative| {
            let is_it = |(part, first): (&Part<'_>, usize)| {
                carried(&part.free).nth(first + derivative).is_some_and(|of| of.place() == place)
            };
            Lanes::from_lanes(|lane| f64::from(u8::from(of_lane(lane).is_some_and(is_it))))
        }),
    };
    let of_group = || (0..shares.len()).filter_map(of_lane);
    let params: Vec<&CableParams> = of_group().map(|(part, _)| part.record.params).collect();
    let cycle_s = of_lane(0)?.0.record.cycle_s;
    let varies = |place: usize| of_group().any(|(part, _)| part.free.iter().any(|of| of.place() == place));
    CableGroup::new(&params, &std::array::from_fn(value), cycle_s, varies)
}

fn cycle(row: &Row) -> CableCycle<'_> {
    CableCycle { signals: &row.signals, pose_wrap: row.pose_wrap, cycle: row.cycle }
}

/// Forces of one cable for several sets of values side by side, without derivatives.
#[derive(Debug)]
pub struct CandidatePass {
    groups: Vec<CableGroup<Lanes>>,
}

impl CandidatePass {
    /// Creates a pass at rest, with one candidate in each lane of the values.
    pub fn new(record: &CableRecord<'_>, candidates: &[Values<Lanes>]) -> Self {
        let group = |values| CableGroup::new(&[record.params], values, record.cycle_s, |_| false);
        Self { groups: candidates.iter().filter_map(group).collect() }
    }

    /// Creates a pass at rest with the same values for all candidates. `ratio` gives the μ of a candidate's pulley as a multiple of the cable's μ.
    pub fn of_mu_ratios(
        record: &CableRecord<'_>,
        values: &Values,
        candidates: usize,
        ratio: impl Fn(usize, usize) -> f64,
    ) -> Self {
        let alike = Self::new(record, &vec![values.map(Lanes::splat); candidates.div_ceil(LANES)]);
        let groups = alike.groups.into_iter().enumerate();
        let unlike = groups.map(|(place, group)| {
            group.with_mu_ratios(&[record.params], |lane, pulley| ratio(place * LANES + lane, pulley))
        });
        Self { groups: unlike.collect() }
    }

    /// Replaces the content of `forces` by the forces in these cycles: those of all candidates in the first cycle, then in the next.
    pub fn advance(&mut self, rows: &[Row], forces: &mut Vec<f64>) {
        forces.clear();
        for row in rows {
            // The groups run side by side, because each mostly waits for its own previous cycle.
            forces.extend(
                self.groups.iter_mut().flat_map(|group| group.step(|_| cycle(row)).platform_force_n.to_array()),
            );
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::AtomicBool;

    use fric_core::robot::file::RobotFile;
    use fric_core::{CableInput, Sample};

    use super::*;
    use crate::fit::{Measurements, Reference};
    use crate::search::gang::forces_of;

    const ROBOT: &str = "format = \"fric-robot/1\"\nname = \"bench\"\ncycle_s = 0.001\n[platform]\nmass_kg = 0.5\n[[cable]]\n\
                         name = \"drive\"\npulleys = [{ wrap_deg = 180.0, sensor = true }, { wrap_deg = 90.0 }]\n\
                         friction = { mu = 0.019, sigma_n_per_m = 950.0, viscous_n_s_per_m = 0.2, offset_n = 0.1 }\n\
                         effects = [{ kind = \"stribeck\", ratio = 0.4, velocity_m_per_s = 0.02 },\n\
                         { kind = \"winch_ripple\", sin_n = 0.03, cos_n = 0.01, period_m = 0.05 },\n\
                         { kind = \"sensor_gain\", gain = 1.02 }]\n";
    /// In this order; the offset is carried by no lane.
    const FREE: [&str; 8] = [
        "mu",
        "sigma_n_per_m",
        "offset_n",
        "viscous_n_s_per_m",
        "stribeck.ratio",
        "winch_ripple.sin_n",
        "winch_ripple.cos_n",
        "sensor_gain.gain",
    ];

    /// The derivatives are those of central differences, however many lanes and groups they need, and the parts of a pass have the same numbers as
    /// alone.
    #[test]
    fn derivatives_spread_over_lanes_are_those_of_differences() {
        let robot = RobotFile::parse(ROBOT, "bench").unwrap();
        let mut measurements = Measurements::new(&robot.params(), Reference::Forces);
        for sample in 0..600_i32 {
            let t_s = 1e-3 * f64::from(sample);
            let input = CableInput {
                sensor_force_n: 15.0 + (5.0 * t_s).sin(),
                length_m: 0.8 + 0.02 * (20.0 * t_s).sin(),
                speed_m_per_s: 0.4 * (20.0 * t_s).cos(),
            };
            let stamp_nanos = 1_000_000 * i64::from(sample);
            measurements.add(&Sample {
                stamp_nanos,
                cables: &[input],
                reference_force_n: &[15.0],
                pose: None,
                outside_wrench: None,
            });
        }
        let record = measurements.cable(0).unwrap();
        let (stop, values) = (AtomicBool::new(false), record.params.values());
        let part = |free: &[Parameter], values: Values| Part { record, values, free: free.to_vec() };
        let all = Parameter::all_named(FREE).unwrap();
        for together in [vec![1], vec![4], vec![8], vec![8, 1, 3], vec![3, 3, 3, 3], vec![8, 8, 8, 5]] {
            let parts: Vec<Part<'_>> = together.iter().map(|count| part(&all[..*count], values)).collect();
            let forces = forces_of(&parts, &stop).unwrap();
            for (part_of, forces) in parts.iter().zip(&forces) {
                assert_eq!(&forces_of(std::slice::from_ref(part_of), &stop).unwrap()[0], forces);
                for (place, parameter) in part_of.free.iter().enumerate() {
                    let change = 1e-6 * values[parameter.place()].abs().max(1e-3);
                    let [less, more] = [-change, change].map(|change| {
                        let mut moved = values;
                        moved[parameter.place()] += change;
                        forces_of(&[part(&[], moved)], &stop).unwrap().remove(0)
                    });
                    let (mut errors, mut squares) = (0.0, 0.0);
                    for cycle in 0..record.rows.len() {
                        let difference = (more.at(cycle).0 - less.at(cycle).0) / (2.0 * change);
                        errors += (forces.at(cycle).1[place] - difference).powi(2);
                        squares += difference * difference;
                    }
                    assert!(
                        squares > 0.0 && errors < 1e-8 * squares,
                        "{parameter} of {together:?}: {errors} {squares}"
                    );
                }
            }
        }
    }
}
