//! Runs the passes of several searches side by side, each with its own cable.
//!
//! A cable whose few derivatives fit into one lane leaves the other lanes of its pass to other cables, so up to [`LANES`] searches form a gang. (A
//! search on one cable with many derivatives fills the lanes by itself.) A search that needs a pass waits until all others need one too or have ended;
//! the last one to arrive runs the pass for all. The result of a search does not depend on the others, because lanes do not interact.

use std::cell::RefCell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use fric_core::LANES;
use fric_core::parameters::Values;
use rayon::prelude::*;

use super::pass::{Forces, LanePass, Part, with_width_for};
use super::vector::Parameter;

/// Samples between two checks of the stop flag.
const CHUNK: usize = 2048;

/// A group of searches that run their passes together.
#[derive(Debug)]
pub struct Gang<'a> {
    seats: Mutex<Vec<State<'a>>>,
    turn: Condvar,
    stop: &'a AtomicBool,
}

/// The state of a search.
#[derive(Debug)]
enum State<'a> {
    /// The search runs on its own.
    Busy,
    /// The search waits for a pass and holds the buffer for its result.
    Waiting(Box<Part<'a>>, Forces),
    /// The pass is done (`None` if stopped), but the search has not picked it up.
    Served(Option<Forces>),
    /// The search has ended.
    Gone,
}

/// The seat of one search in a gang. Dropping it ends the search's membership.
#[derive(Debug)]
pub struct Seat<'a> {
    gang: &'a Gang<'a>,
    place: usize,
    last: RefCell<Option<Last<'a>>>,
}

/// The last request and its result.
#[derive(Debug)]
struct Last<'a> {
    part: Part<'a>,
    forces: Arc<Forces>,
    /// Whether the forces were extrapolated from those of the pass.
    moved: bool,
}

impl<'a> Gang<'a> {
    /// Creates a gang of `count` searches, at most [`LANES`]. Each search must take its [`Seat`].
    pub fn new(count: usize, stop: &'a AtomicBool) -> Self {
        let seats = (0..count.min(LANES)).map(|_| State::Busy).collect();
        Self { seats: Mutex::new(seats), turn: Condvar::new(), stop }
    }

    /// Returns the seat of a search.
    pub fn seat(&'a self, place: usize) -> Seat<'a> {
        Seat { gang: self, place, last: RefCell::new(None) }
    }

    /// Locks the states. A search that panicked leaves its state consistent, because each change is a single assignment.
    fn lock(&self) -> MutexGuard<'_, Vec<State<'a>>> {
        self.seats.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<'a> Seat<'a> {
    /// Returns the forces of a cable in every cycle, with at least the derivatives that its part asks for; `None` if stopped. The forces of the last
    /// pass are cached.
    pub fn forces(&self, part: &Part<'a>) -> Option<Arc<Forces>> {
        if let Some(last) = self.last.borrow().as_ref().filter(|last| last.part.serves(part)) {
            return Some(Arc::clone(&last.forces));
        }
        let room = self.last.take().and_then(|last| Arc::into_inner(last.forces)).unwrap_or_default();
        let forces = Arc::new(self.pass(part, room)?);
        *self.last.borrow_mut() = Some(Last { part: part.clone(), forces: Arc::clone(&forces), moved: false });
        Some(forces)
    }

    /// If the forces of the last pass belong to `at`, extrapolates them by their derivatives to other `values`.
    pub fn step(&self, at: &Part<'a>, values: &Values) {
        if let Some(last) = self.last.borrow_mut().as_mut().filter(|last| last.part.serves(at)) {
            let change = |of: &Parameter| values[of.place()] - last.part.values[of.place()];
            let by: Vec<f64> = last.part.free.iter().map(change).collect();
            Arc::make_mut(&mut last.forces).step(&by);
            last.part.values = *values;
            last.moved = true;
        }
    }

    /// Discards extrapolated forces, so that the next ones come from a pass, to the last bit.
    pub fn forget_moved(&self) {
        self.last.borrow_mut().take_if(|last| last.moved);
    }

    fn pass(&self, part: &Part<'a>, room: Forces) -> Option<Forces> {
        let mut seats = self.gang.lock();
        if let Some(seat) = seats.get_mut(self.place) {
            *seat = State::Waiting(Box::new(part.clone()), room);
        }
        loop {
            match seats.get_mut(self.place) {
                Some(seat @ State::Served(_)) => {
                    let State::Served(forces) = std::mem::replace(seat, State::Busy) else { return None };
                    return forces;
                }
                Some(State::Waiting(..)) => {}
                _ => return None,
            }
            if seats.iter().any(|seat| matches!(seat, State::Busy | State::Served(_))) {
                seats = self.gang.turn.wait(seats).unwrap_or_else(PoisonError::into_inner);
            } else {
                serve(&mut seats, self.gang.stop);
                self.gang.turn.notify_all();
            }
        }
    }
}

impl Drop for Seat<'_> {
    fn drop(&mut self) {
        if let Some(seat) = self.gang.lock().get_mut(self.place) {
            *seat = State::Gone;
        }
        self.gang.turn.notify_all();
    }
}

/// Runs a joint pass for those waiting searches that need the fewest cycles. The others keep waiting, because these may join them later. No other search
/// has work to do meanwhile.
fn serve(seats: &mut [State<'_>], stop: &AtomicBool) {
    let wish = |seat: &State<'_>| match seat {
        State::Waiting(part, _) => Some(part.record.rows.len()),
        _ => None,
    };
    let Some(least) = seats.iter().filter_map(wish).min() else { return };
    let (mut together, mut parts, mut rooms) = (Vec::new(), Vec::new(), Vec::new());
    for seat in seats.iter_mut().filter(|seat| wish(seat) == Some(least)) {
        if let State::Waiting(part, room) = std::mem::replace(seat, State::Served(None)) {
            together.push(seat);
            parts.push(*part);
            rooms.push(room);
        }
    }
    if let Some(forces) = with_width_for!(&parts, all_forces(&parts, rooms, stop)) {
        for (seat, forces) in together.into_iter().zip(forces) {
            *seat = State::Served(Some(forces));
        }
    }
}

/// Returns the forces of several cables in every cycle, as many in parallel as there are lanes; `None` if stopped.
pub fn forces_of(parts: &[Part<'_>], stop: &AtomicBool) -> Option<Vec<Forces>> {
    let of_lanes = |parts: &[Part<'_>]| {
        let rooms = vec![Forces::default(); parts.len()];
        with_width_for!(parts, all_forces(parts, rooms, stop))
    };
    let all: Option<Vec<Vec<Forces>>> = parts.par_chunks(LANES).map(of_lanes).collect();
    Some(all?.into_iter().flatten().collect())
}

/// Computes the forces of up to [`LANES`] cables in every cycle, in the buffer given for each; returns `None` if stopped.
pub fn all_forces<const N: usize>(
    parts: &[Part<'_>],
    mut forces: Vec<Forces>,
    stop: &AtomicBool,
) -> Option<Vec<Forces>> {
    let mut pass = LanePass::<N>::new(parts.iter().cloned());
    let cycles = parts.first().map_or(0, |part| part.record.rows.len());
    for (forces, part) in forces.iter_mut().zip(parts) {
        forces.clear(part.free.len(), cycles);
    }
    for (start, rows) in parts.first().iter().flat_map(|part| part.record.logs()) {
        pass.rest();
        let end = start + rows.len();
        for from in (start..end).step_by(CHUNK) {
            if stop.load(Ordering::Relaxed) {
                return None;
            }
            pass.advance(from, (from + CHUNK).min(end), &mut forces);
        }
    }
    Some(forces)
}
