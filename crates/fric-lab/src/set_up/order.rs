//! Detects sensors and references in different orders, where the sensor of one cable goes with the reference of another, and one sensor in place of several.
//!
//! Each sensor's force is regressed on the reference of every cable. Gain and zero leave nothing, friction leaves its part of the load, and the reference of
//! another cable leaves what its load has of its own. Only cables that have each other's references in a ring are told, which no friction makes.

use fric_core::Sample;

use crate::text::listed;

/// Least ratio of the rest beside a sensor's own reference to that beside another cable's, both rms. An exchange of cables whose loads differ by more than
/// their friction makes more; half of it would tell cables whose loads are alike but for noise, twice as much only loads that differ by four times the
/// friction.
const LEAST_RATIO: f64 = 2.0;

/// Part of a variance below which it may be rounding.
const ROUNDING: f64 = 1e-12;

/// Sums over the samples that have both of two forces, each less its first value.
#[derive(Clone, Copy, Debug, Default)]
struct Pair {
    first_n: Option<[f64; 2]>,
    count: f64,
    sums: [f64; 2],
    squares: [f64; 2],
    product: f64,
}

impl Pair {
    fn add(&mut self, forces_n: [f64; 2]) {
        if !forces_n.iter().all(|force_n| force_n.is_finite()) {
            return;
        }
        let first_n = *self.first_n.get_or_insert(forces_n);
        let [one, other] = [0, 1].map(|place| forces_n[place] - first_n[place]);
        self.count += 1.0;
        self.sums = [self.sums[0] + one, self.sums[1] + other];
        self.squares = [self.squares[0] + one * one, self.squares[1] + other * other];
        self.product += one * other;
    }

    /// Returns the variance of the first force, N², and of its rest beside the second; `None` if they do not rise and fall together.
    fn rest(&self) -> Option<[f64; 2]> {
        let centred =
            |product: f64, one: f64, other: f64| product / self.count - one * other / (self.count * self.count);
        let own = [0, 1].map(|place| centred(self.squares[place], self.sums[place], self.sums[place]));
        let both = centred(self.product, self.sums[0], self.sums[1]);
        (both > 0.0).then(|| [own[0], own[0] - both * both / own[1]])
    }
}

/// Sums over each sensor and each cable's reference.
#[derive(Clone, Debug)]
pub(super) struct Order {
    cable_count: usize,
    /// Row by row, a row for a sensor.
    pairs: Vec<Pair>,
    /// For each sensor the first of those that have shown the same in all samples.
    twins: Vec<usize>,
    /// The last force of each sensor, and whether it has ever changed.
    lasts: Vec<(f64, bool)>,
}

impl Order {
    pub fn new(cable_count: usize) -> Self {
        Self {
            cable_count,
            pairs: vec![Pair::default(); cable_count * cable_count],
            twins: vec![0; cable_count],
            lasts: vec![(f64::NAN, false); cable_count],
        }
    }

    pub fn add(&mut self, sample: &Sample<'_>) {
        for (pairs, input) in self.pairs.chunks_exact_mut(self.cable_count).zip(sample.cables) {
            for (pair, reference_n) in pairs.iter_mut().zip(sample.reference_force_n) {
                pair.add([input.sensor_force_n, *reference_n]);
            }
        }
        for ((last_n, has_changed), input) in self.lasts.iter_mut().zip(sample.cables) {
            *has_changed |= (input.sensor_force_n - *last_n).abs() > 0.0;
            *last_n = input.sensor_force_n;
        }
        // From the last on, so that those before still have the twin of the sample before.
        for cable in (0..self.cable_count).rev() {
            let is_twin = |other: &usize| {
                self.twins.get(*other) == self.twins.get(cable) && self.shown(*other) == self.shown(cable)
            };
            let first = (0..cable).find(is_twin).unwrap_or(cable);
            self.twins.iter_mut().skip(cable).take(1).for_each(|twin| *twin = first);
        }
    }

    fn shown(&self, cable: usize) -> Option<u64> {
        self.lasts.get(cable).map(|(force_n, _)| force_n.to_bits())
    }

    /// Returns the other cable with whose reference a sensor goes.
    fn partner(sensor: usize, pairs: &[Pair]) -> Option<usize> {
        let own = pairs.get(sensor)?;
        let variance_n2 = pairs.iter().find_map(Pair::rest)?[0];
        let own_n2 = own.rest().map_or(variance_n2, |[_, rest_n2]| rest_n2);
        let others = pairs.iter().enumerate().filter(|(_, pair)| 2.0 * pair.count >= own.count);
        let rests = others.filter_map(|(cable, pair)| Some((cable, pair.rest()?[1])));
        let (partner, least_n2) = rests.min_by(|(_, one), (_, other)| one.total_cmp(other))?;
        (own_n2 > LEAST_RATIO * LEAST_RATIO * least_n2.max(ROUNDING * variance_n2)).then_some(partner)
    }

    /// Returns the cables whose sensors go with one another's references, with the one of each.
    fn exchanged(&self) -> Vec<(usize, usize)> {
        let rows = self.pairs.chunks_exact(self.cable_count).enumerate();
        let mut exchanged: Vec<(usize, usize)> =
            rows.filter_map(|(sensor, pairs)| Some((sensor, Self::partner(sensor, pairs)?))).collect();
        // What remains is a ring, or several: each has a partner, and is the partner of one.
        loop {
            let all = exchanged.clone();
            let is_sensor = |cable: usize| all.iter().any(|(sensor, _)| *sensor == cable);
            let partner_count = |cable: usize| all.iter().filter(|(_, partner)| *partner == cable).count();
            exchanged.retain(|(sensor, partner)| is_sensor(*partner) && partner_count(*sensor) == 1);
            if exchanged.len() == all.len() {
                return exchanged;
            }
        }
    }

    /// Returns what is wrong if the reference of cables is their own sensor's force in every sample, whatever its unit and zero.
    pub fn copied(&self, names: &[&str]) -> Option<String> {
        let is_copy = |cable: &usize| {
            let own = self.pairs.get(cable * (self.cable_count + 1)).and_then(Pair::rest);
            own.is_some_and(|[variance_n2, rest_n2]| rest_n2 <= ROUNDING * variance_n2)
        };
        let copies = (0..self.cable_count).filter(is_copy);
        let copies: Vec<&str> = copies.filter_map(|cable| names.get(cable)).copied().collect();
        let (references, show) = match copies[..] {
            [] => return None,
            [_] => ("the reference", "shows the force of its own sensor"),
            _ => ("the references", "show the forces of their own sensors"),
        };
        Some(format!("{references} of {} {show} in every sample, so nothing is known of friction", listed(&copies)))
    }

    /// Returns warnings about sensors that go with one another's references, about those that are one, and about those that are their own reference.
    pub fn warnings(&self, names: &[&str]) -> Vec<String> {
        let of =
            |cables: &[usize]| -> Vec<&str> { cables.iter().filter_map(|cable| names.get(*cable)).copied().collect() };
        let (sensors, references): (Vec<usize>, Vec<usize>) = self.exchanged().into_iter().unzip();
        let exchanged = (!sensors.is_empty()).then(|| {
            format!(
                "the sensors of {} go with the references of {}, in this order, and not with their own; compare the names and the order of both in the log \
                 and in the robot file",
                of(&sensors).join(", "),
                of(&references).join(", ")
            )
        });
        let shared = (0..self.cable_count).filter_map(|first| {
            let is_twin = |cable: &usize| self.twins.get(*cable) == Some(&first);
            let twins: Vec<usize> = (0..self.cable_count).filter(is_twin).collect();
            let has_changed = self.lasts.get(first).is_some_and(|(_, has_changed)| *has_changed);
            (twins.len() > 1 && has_changed).then(|| {
                let names = listed(&of(&twins));
                format!("the sensors of {names} show the same force in every sample; if each has its own, compare their names in the log and in the robot file")
            })
        });
        exchanged.into_iter().chain(shared).chain(self.copied(names)).collect()
    }
}

#[cfg(test)]
mod tests {
    use fric_core::CableInput;

    use super::*;

    /// The warning about a robot of four cables under friction of 8 %, whose sensors are read in another order. The loads vary by `swing_n` about 20 N.
    fn told(order: [usize; 4], swing_n: f64, shown: impl Fn(f64) -> f64) -> Vec<String> {
        let mut sums = Order::new(4);
        for sample in 0..6000_i32 {
            let angle = 0.01 * f64::from(sample);
            let loads_n: Vec<f64> =
                (0..4).map(|cable| 20.0 + swing_n * (angle + 1.3 * f64::from(cable)).sin()).collect();
            let rubbed_n: Vec<f64> = (0..4)
                .zip(&loads_n)
                .map(|(cable, load_n)| load_n * (1.0 + 0.08 * (1.7 * angle + f64::from(cable)).cos().signum()))
                .collect();
            let cables =
                order.map(|cable| CableInput { sensor_force_n: shown(rubbed_n[cable]), ..CableInput::default() });
            sums.add(&Sample {
                stamp_nanos: i64::from(sample),
                cables: &cables,
                reference_force_n: &loads_n,
                pose: None,
                outside_wrench: None,
            });
        }
        sums.warnings(&["a", "b", "c", "d"])
    }

    #[test]
    fn exchanged_sensors_are_told_and_no_others() {
        let as_it_is = |force_n: f64| force_n;
        let nothing: Vec<String> = Vec::new();
        for swing_n in [0.0, 0.5, 5.0] {
            assert_eq!(told([0, 1, 2, 3], swing_n, as_it_is), nothing, "{swing_n} N");
        }
        let pair = told([2, 1, 0, 3], 5.0, as_it_is);
        assert!(pair[0].starts_with("the sensors of a, c go with the references of c, a, in this order"), "{pair:?}");
        let ring = told([1, 2, 3, 0], 5.0, as_it_is);
        assert!(ring[0].starts_with("the sensors of a, b, c, d go with the references of b, c, d, a,"), "{ring:?}");
        assert_eq!([pair.len(), ring.len()], [1, 1]);
        // In pounds, with a zero.
        assert_eq!(told([2, 1, 0, 3], 5.0, |force_n| 0.2248 * force_n + 3.0), pair);
        // Sensors that show nothing, always the same, or no more than their friction.
        assert_eq!(told([2, 1, 0, 3], 5.0, |_| f64::NAN), nothing);
        assert_eq!(told([2, 1, 0, 3], 5.0, |_| 7.0), nothing);
        assert_eq!(told([2, 1, 0, 3], 0.5, as_it_is), nothing);
    }

    /// Of friction of 8 % the copy has none, whatever its unit and zero.
    #[test]
    fn a_reference_that_is_the_sensor_itself_is_told() {
        let told = |copied: bool| {
            let mut sums = Order::new(1);
            for sample in 0..1000_i32 {
                let angle = 0.01 * f64::from(sample);
                let load_n = 20.0 + angle.sin();
                let sensor_force_n = load_n * (1.0 + 0.08 * angle.cos().signum());
                sums.add(&Sample {
                    stamp_nanos: i64::from(sample),
                    cables: &[CableInput { sensor_force_n, ..CableInput::default() }],
                    reference_force_n: &[if copied { 9.81 * sensor_force_n - 3.0 } else { load_n }],
                    pose: None,
                    outside_wrench: None,
                });
            }
            sums.warnings(&["a"])
        };
        assert_eq!(told(false), Vec::<String>::new());
        assert!(told(true)[0].starts_with("the reference of a shows the force of its own sensor in every sample"));
    }

    #[test]
    fn one_sensor_in_place_of_several_is_told() {
        let shared = told([1, 1, 0, 1], 5.0, |force_n| force_n);
        assert_eq!(shared.len(), 1, "{shared:?}");
        assert!(shared[0].starts_with("the sensors of a, b and d show the same force in every sample"), "{shared:?}");
    }
}
