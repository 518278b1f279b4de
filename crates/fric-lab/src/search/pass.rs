//! Passes of the cycle's equations over the records of cables, with derivatives with respect to chosen parameters.

use fric_core::parameters::{OFFSET, Values};
use fric_core::scalar::Scalar;
use fric_core::{CableCycle, CableGroup, CableParams, LANES, Lanes};

use super::dual::Dual;
use super::vector::Parameter;
use crate::samples::record::{CableRecord, Row};

/// Runs `$run::<N>`, where `N` is the number of derivatives that one group of cables carries for `$count` derivatives in all. The compiler generates
/// the whole cycle for each of a few `N`; larger counts use several groups.
macro_rules! with_room_for {
    ($count:expr, $run:ident($($argument:expr),* $(,)?)) => {
        match $count {
            0 => $run::<0>($($argument),*),
            1..=3 => $run::<3>($($argument),*),
            _ => $run::<6>($($argument),*),
        }
    };
}
pub(crate) use with_room_for;

/// Returns the number of derivatives that all groups together have room for.
pub fn room_for(count: usize) -> usize {
    fn room<const N: usize>(count: usize) -> usize {
        N * count.div_ceil(N.max(1))
    }
    with_room_for!(count, room(count))
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

/// Forces of up to [`LANES`] cables with records of the same length, side by side.
#[derive(Debug)]
pub struct LanePass<'a, const N: usize> {
    parts: Vec<Part<'a>>,
    /// For each part, the order in which the numbers of a cycle enter its forces: the force, the carried derivatives, and 1.
    columns: Vec<Vec<usize>>,
    /// The groups at rest; each carries `N` of the derivatives.
    at_rest: Vec<CableGroup<Dual<Lanes, N>>>,
    groups: Vec<CableGroup<Dual<Lanes, N>>>,
}

impl<'a, const N: usize> LanePass<'a, N> {
    /// Creates a pass over the first [`LANES`] parts.
    pub fn new(parts: impl IntoIterator<Item = Part<'a>>) -> Self {
        let parts: Vec<Part<'a>> = parts.into_iter().take(LANES).collect();
        let of_lane = |lane: usize| parts.get(lane).or(parts.last());
        let value = |first: usize, place: usize| Dual {
            value: Lanes::from_lanes(|lane| of_lane(lane).map_or(f64::NAN, |part| part.values[place])),
            gradient: std::array::from_fn(|derivative| {
                let is_it =
                    |part: &Part<'_>| carried(&part.free).nth(first + derivative).is_some_and(|of| of.place() == place);
                Lanes::from_lanes(|lane| f64::from(u8::from(of_lane(lane).is_some_and(is_it))))
            }),
        };
        let most = parts.iter().map(Part::carried).max().unwrap_or(0);
        let room = N * most.div_ceil(N.max(1));
        let columns = |part: &Part<'_>| {
            let mut carried = 1..;
            let of = |parameter: &Parameter| if parameter.place() == OFFSET { Some(room + 1) } else { carried.next() };
            std::iter::once(0).chain(part.free.iter().filter_map(of)).collect()
        };
        let columns = parts.iter().map(columns).collect();
        let varies = |place: usize| parts.iter().any(|part| part.free.iter().any(|of| of.place() == place));
        let params: Vec<&CableParams> = parts.iter().map(|part| part.record.params).collect();
        let cycle_s = parts.first().map_or(f64::NAN, |part| part.record.cycle_s);
        let of_first =
            |first: usize| CableGroup::new(&params, &std::array::from_fn(|place| value(first, place)), cycle_s, varies);
        let at_rest = (0..room.max(1)).step_by(N.max(1)).filter_map(of_first).collect();
        Self { at_rest, groups: Vec::new(), columns, parts }
    }

    /// Starts a log with an empty memory.
    pub fn rest(&mut self) {
        self.groups.clone_from(&self.at_rest);
    }

    /// Runs the cycles `from..to` and appends the forces of each part to `forces`.
    pub fn advance(&mut self, from: usize, to: usize, forces: &mut [Forces]) {
        let Some(last) = self.parts.len().checked_sub(1) else { return };
        let rows: [&[Row]; LANES] = std::array::from_fn(|lane| {
            self.parts.get(lane.min(last)).and_then(|part| part.record.rows.get(from..to)).unwrap_or_default()
        });
        let [first, second, third, fourth] = rows;
        // The force, its derivatives, and 1.
        let mut numbers = vec![[1.0; LANES]; N * self.groups.len() + 2];
        for (((first, second), third), fourth) in first.iter().zip(second).zip(third).zip(fourth) {
            let rows = [first, second, third, fourth];
            let mut derivatives = 1;
            for group in &mut self.groups {
                let force = group.step(|lane| cycle(rows[lane % LANES])).platform_force_n;
                numbers[0] = force.value.to_array();
                for (number, part) in numbers.iter_mut().skip(derivatives).zip(force.gradient) {
                    *number = part.to_array();
                }
                derivatives += N;
            }
            for (lane, (forces, columns)) in forces.iter_mut().zip(&self.columns).enumerate() {
                forces.numbers.extend(columns.iter().map(|column| numbers[*column][lane]));
            }
        }
    }
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
