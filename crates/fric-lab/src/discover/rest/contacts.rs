//! Contacts in parallel that yield one after the other, each at another displacement: the Maxwell slip model (F. Al-Bender, V. Lampaert, J. Swevers, *The
//! generalized Maxwell-slip model*, IEEE Trans. Autom. Control 50, 2005). The model has contacts of one stiffness.

use std::rc::Rc;

use fric_core::parameters::{SIGMA, Values};

use super::past::loaded;
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

/// What contacts of another law add: such contacts, and those that keep their ratio of friction to load.
pub struct Contacts<'b> {
    of_stiffness: [Evaluated<'b, 'b>; STIFFNESS_RATIOS.len()],
    loaded: Box<dyn Iterator<Item = (usize, f64)> + 'b>,
}

impl<'b> Contacts<'b> {
    /// Number of signals.
    pub const COUNT: usize = STIFFNESS_RATIOS.len() + 1;

    /// Returns the contacts in place of those of a model.
    pub fn of(bench: &'b Workbench<'b>, model: &Model) -> Self {
        let friction = Rc::new(bench.evaluated(&model.values));
        let loaded = loaded(&bench.record, &model.values, move |cycle| friction.added_n(cycle));
        Self { of_stiffness: contacts(bench, &model.values), loaded: Box::new(loaded.enumerate()) }
    }

    /// Writes what each adds in a cycle, N; 0 where that is unknown. Cycles must ascend.
    pub fn write(&mut self, cycle: usize, numbers: &mut [f64]) {
        let loaded_n = self.loaded.find(|(place, _)| *place == cycle).map_or(0.0, |(_, stored_n)| stored_n);
        let all_n = self.of_stiffness.iter().map(|contacts| contacts.added_n(cycle)).chain([loaded_n]);
        for (number, added_n) in numbers.iter_mut().zip(all_n) {
            *number = if added_n.is_finite() { added_n } else { 0.0 };
        }
    }
}
