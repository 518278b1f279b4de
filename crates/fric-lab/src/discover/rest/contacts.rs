//! Contacts in parallel that yield one after the other, each at another displacement: the Maxwell slip model (F. Al-Bender, V. Lampaert, J. Swevers, *The
//! generalized Maxwell-slip model*, IEEE Trans. Autom. Control 50, 2005). The model has contacts of one stiffness.

use fric_core::parameters::{SIGMA, Values};

use super::past::{SHIFTS, loaded};
use super::places::Excess;
use crate::discover::naming::projection::{Columns, Signals, visit_less_projection};
use crate::discover::workbench::{Evaluated, Model, Workbench};

/// Stiffnesses of further contacts, as multiples of σ. Each is some three times the one before, as contacts of twice the stiffness look nearly the same;
/// those of σ itself are the model's.
const STIFFNESS_RATIOS: [f64; 4] = [0.1, 0.3, 3.0, 10.0];

/// Returns the model with each of these stiffnesses in place of σ.
pub fn contacts<'b>(bench: &'b Workbench<'b>, values: &Values) -> [Evaluated<'b, 'b>; STIFFNESS_RATIOS.len()] {
    STIFFNESS_RATIOS.map(|ratio| {
        let mut values = *values;
        values[SIGMA] *= ratio;
        bench.evaluated(&values)
    })
}

/// Returns the fraction of the excess that such contacts, or contacts that keep their ratio of friction to load, explain and the model's parameters cannot;
/// zero where this may be chance. The chance level is the greatest fraction for residuals shifted in time against the contacts.
pub fn share_of_contacts(bench: &Workbench<'_>, model: &Model, excess: &Excess<'_>) -> f64 {
    const COUNT: usize = STIFFNESS_RATIOS.len() + 1;
    let contacts = contacts(bench, &model.values);
    let friction = bench.evaluated(&model.values);
    let signals = || -> Signals<'_> {
        let friction_n = |cycle| friction.added_n(cycle);
        let mut loaded = loaded(&bench.record, &model.values, friction_n).enumerate();
        let contacts = &contacts;
        Box::new(move |cycle, numbers| {
            numbers.extend(contacts.iter().map(|contact| contact.added_n(cycle)));
            numbers.push(loaded.find(|(place, _)| *place == cycle).map_or(f64::NAN, |(_, stored_n)| stored_n));
        })
    };
    let mut added_n: Vec<(usize, [f64; COUNT])> = Vec::new();
    let problem = bench.problem(&model.free, None);
    let is_finite = visit_less_projection(&problem, &model.values, &signals, |cycle, numbers| {
        added_n.extend(<[f64; COUNT]>::try_from(numbers).map(|numbers| (cycle, numbers)));
    });
    let (count, all): (usize, [usize; COUNT]) = (excess.residual_n.len(), std::array::from_fn(|place| place));
    let squares = |shift: usize| {
        let mut columns = Columns::new(COUNT, 0, COUNT);
        for (cycle, numbers) in &added_n {
            let shifted = (cycle + shift * count / SHIFTS) % count;
            columns.add(numbers, excess.residual_n.get(shifted).copied().unwrap_or(f64::NAN));
        }
        columns.gain(&all)
    };
    let explained = squares(0);
    if is_finite.is_none() || (1..SHIFTS).any(|shift| squares(shift) >= explained) {
        return 0.0;
    }
    (explained / excess.sum()).min(1.0)
}
