//! Simple laws that effects of the catalogue may stand in for, each as signals over the log.

use std::rc::Rc;

use fric_core::effects::Effect;
use fric_core::parameters::{VISCOUS, Values};

use crate::discover::rest::contacts::contacts;
use crate::discover::rest::past::{CREEP_S, crept, loaded};
use crate::discover::workbench::{Evaluated, Workbench};
use crate::fit::{CableRecord, Row};

/// Number of cycles on either side over which rates are computed.
const RATE_CYCLES: usize = 5;
/// The same for the rate at which contacts store friction. After a quick reversal they do so within a few cycles.
const STORING_CYCLES: usize = 1;
/// Effects of how contacts yield after a reversal or under another load, which contacts of another law look like. They do not look like what acts while the
/// cable slides: an asymmetry, a ripple, a drift, a gain.
const OF_YIELDING: [Effect; 6] = [
    Effect::TimeDelay,
    Effect::LoadRelease,
    Effect::PulleyDefect,
    Effect::PreslidingShape,
    Effect::GearBacklash,
    Effect::DwellStiction,
];
/// Time constants of warm-up, as fractions of the log's duration.
const TIME_CONSTANT_RATIOS: [f64; 4] = [0.06, 0.12, 0.25, 0.5];

/// Contacts of another law, or a creep, stand in for a name if they remove all but this fraction of what the name does, and both leave more than that. Where
/// another simulator had such laws, they removed all but 0.02 of it. Not so jumps, which are placed where they fit, and damping, which a late motion looks like.
const NEARLY: f64 = 0.05;
/// Damping of the contacts takes the place of a name only if it removes more than this fraction of the excess that the name leaves. A motion that is
/// known late is extrapolated, with an error of which the rate of the friction removes a quarter though nothing is damped; of what a delay leaves of
/// damped contacts it removes three quarters. Half of this fraction refuses true delays, double never applies.
const LEAST_OF_DAMPING: f64 = 0.5;

/// The numbers of a signal, one per cycle.
pub type Numbers<'a> = Box<dyn Iterator<Item = f64> + 'a>;

/// A simple law.
pub struct Law<'a> {
    /// The signal that the law depends on.
    pub signal: &'static str,
    /// The effect that it is to first order, if it is one.
    pub of: Option<Effect>,
    /// Fraction of the excess above the noise that the law has to remove in addition to what the names do.
    pub least_of_excess: f64,
    /// Fraction of what a name removes by which the law may remove less and still stand in for it, where both leave more than that.
    pub nearly_ratio: f64,
    /// Effects that the law may stand in for; all if there are none.
    pub looks_like: &'static [Effect],
    /// The effect that the law is where its levels are equal, if it has levels.
    pub level_of: Option<Effect>,
    /// Each gives a signal of the law from the first cycle on, of any unit. Series of all laws would take up more memory than the log.
    pub columns: Vec<Box<dyn Fn() -> Numbers<'a> + 'a>>,
}

impl<'a> Law<'a> {
    /// Creates the law that is the effect `of` to first order from its number in each of so many cycles.
    pub fn by_cycle(
        (signal, of): (&'static str, Option<Effect>),
        cycle_count: usize,
        number: impl Fn(usize) -> f64 + 'a,
    ) -> Self {
        let number = Rc::new(number);
        let numbers = move || -> Numbers<'a> {
            let number = Rc::clone(&number);
            Box::new((0..cycle_count).map(move |cycle| number(cycle)))
        };
        Self {
            signal,
            of,
            least_of_excess: 0.0,
            nearly_ratio: 0.0,
            looks_like: &[],
            level_of: None,
            columns: vec![Box::new(numbers)],
        }
    }
}

/// The laws: sensor and reference that follow late, a bent sensor, a drag of turbulence, contacts that yield one after the other, what warms up, of the
/// sensor and of the friction, a cable that creeps, and contacts whose friction follows the load.
pub fn laws<'b>(bench: &'b Workbench<'b>, friction_values: &Values) -> Vec<Law<'b>> {
    let record = bench.record;
    let count = record.rows.len();
    let of = move |cycle: usize, value: fn(&Row) -> f64| record.rows.get(cycle).map_or(f64::NAN, value);
    let sensor_n = move |cycle: usize| of(cycle, |row| row.signals.sensor_force_n);
    let counted = || bench.counts.iter().enumerate().filter(|(_, counts)| **counts).map(|(cycle, _)| cycle);
    #[expect(clippy::cast_precision_loss, reason = "a count of samples")]
    let mean_n = counted().map(sensor_n).sum::<f64>() / counted().count().max(1) as f64;
    let law = |signal, of, number: Box<dyn Fn(usize) -> f64 + 'b>| Law::by_cycle((signal, Some(of)), count, number);
    let mut laws = vec![
        law("force_rate", Effect::SensorLag, Box::new(move |cycle| rate(&record, sensor_n, RATE_CYCLES, cycle))),
        law(
            "reference_rate",
            Effect::SensorLag,
            Box::new(move |cycle| rate(&record, |cycle| record.reference_n(cycle), RATE_CYCLES, cycle)),
        ),
        law("sensor_force", Effect::SensorNonlinearity, Box::new(move |cycle| (sensor_n(cycle) - mean_n).powi(2))),
        law(
            "speed",
            Effect::ViscousNonlinearity,
            Box::new(move |cycle| of(cycle, |row| row.signals.speed_m_per_s * row.signals.speed_m_per_s.abs())),
        ),
    ];
    let end_s = record.rows.iter().map(|row| row.cycle).fold(0.0, f64::max) * record.cycle_s;
    let contacts = contacts(bench, friction_values)
        .map(|contact| Law::by_cycle(("way_since_reversal", None), count, move |cycle| contact.added_n(cycle)));
    laws.extend(contacts.into_iter().reduce(|mut law, contact| {
        law.columns.extend(contact.columns);
        Law { nearly_ratio: NEARLY, looks_like: &OF_YIELDING, ..law }
    }));
    let friction = Rc::new(bench.evaluated(friction_values));
    for ratio in TIME_CONSTANT_RATIOS {
        let decay = move |cycle: usize| (-of(cycle, |row| row.cycle) * record.cycle_s / (ratio * end_s)).exp();
        let friction = Rc::clone(&friction);
        let of_friction = move |cycle: usize| decay(cycle) * friction.added_n(cycle);
        laws.push(law("time", Effect::FrictionWarmup, Box::new(of_friction)));
        laws.push(law("time", Effect::SensorWarmup, Box::new(decay)));
    }
    let creep = |lag_s| Law {
        signal: "past_load",
        of: None,
        least_of_excess: 0.0,
        nearly_ratio: NEARLY,
        looks_like: &[],
        level_of: None,
        columns: vec![Box::new(move || Box::new(crept(&record, lag_s)))],
    };
    laws.extend(CREEP_S.map(creep));
    let friction_values = *friction_values;
    laws.push(Law {
        signal: "past_load",
        of: None,
        least_of_excess: 0.0,
        nearly_ratio: NEARLY,
        looks_like: &OF_YIELDING,
        level_of: None,
        columns: vec![Box::new(move || {
            let friction = Rc::clone(&friction);
            Box::new(loaded(&record, &friction_values, move |cycle| friction.added_n(cycle)))
        })],
    });
    laws
}

/// Damping of the contacts: a force in proportion to the rate at which they store friction, the term `σ₁·dz/dt` of the `LuGre` model (C. Canudas de
/// Wit, H. Olsson, K. J. Åström, P. Lischinsky, *A New Model for Control of Systems with Friction*, IEEE Trans. Autom. Control 40, 1995, eq. 1–3).
/// It makes the stored friction lead, as motion that is known late does, but neither the viscous friction nor the friction at constant sliding. None if
/// the residual without the name (model minus reference) asks for the opposite: no damping makes friction late.
pub fn contact_damping<'b>(bench: &'b Workbench<'b>, values: &Values, without: &Evaluated<'_, '_>) -> Option<Law<'b>> {
    let mut stored = *values;
    stored[VISCOUS] = 0.0;
    let (stored, record) = (bench.evaluated(&stored), bench.record);
    let stored_rate = move |cycle: usize| rate(&record, |cycle| stored.added_n(cycle), STORING_CYCLES, cycle);
    let products = without.residuals_n().enumerate().map(|(cycle, residual_n)| residual_n * stored_rate(cycle));
    let leads = products.filter(|product| product.is_finite()).sum::<f64>() < 0.0;
    let law = Law::by_cycle(("friction_rate", None), record.rows.len(), stored_rate);
    leads.then_some(Law { least_of_excess: LEAST_OF_DAMPING, ..law })
}

/// Returns the difference of a signal over so many cycles on either side, within the log of the cycle.
fn rate(record: &CableRecord<'_>, signal: impl Fn(usize) -> f64, cycles: usize, cycle: usize) -> f64 {
    let log = record.log_of(cycle);
    let (from, to) = (cycle.saturating_sub(cycles).max(log.start), (cycle + cycles).min(log.end - 1));
    signal(to) - signal(from)
}
