//! Several searches, each with its own cable, whose passes run side by side.
//!
//! A pass over one cable waits for its own results most of the time: the friction of a cycle needs that of the cycle before. Four
//! cables in the lanes of one pass take hardly longer than one. So up to [`LANES`] searches form a gang: each, when it needs a pass, waits
//! until all others want one too or have ended; the last one to come runs it for all. What a search gets does not depend on
//! who else is there: lanes do not know of each other.

use std::cell::RefCell;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

use fric_core::LANES;
use fric_core::parameters::Values;
use rayon::prelude::*;

use super::pass::{Forces, LanePass, Part, room_for, with_room_for};
use super::vector::Parameter;

/// Samples between two looks at the request to stop.
const CHUNK: usize = 2048;

/// Searches that wait for each other's passes.
#[derive(Debug)]
pub struct Gang<'a> {
    seats: Mutex<Vec<State<'a>>>,
    turn: Condvar,
    stop: &'a AtomicBool,
}

/// What a search is about.
#[derive(Debug)]
enum State<'a> {
    /// On its own.
    Busy,
    /// Waits for a pass, with the room for it.
    Waiting(Box<Part<'a>>, Forces),
    /// Its pass is done, `None` when stopped, and it has yet to notice.
    Served(Option<Forces>),
    /// Ended.
    Gone,
}

/// The place of one search in a gang; it counts as ended when this is dropped.
#[derive(Debug)]
pub struct Seat<'a> {
    gang: &'a Gang<'a>,
    place: usize,
    last: RefCell<Option<Last<'a>>>,
}

/// What was asked for last, and what came out.
#[derive(Debug)]
struct Last<'a> {
    part: Part<'a>,
    forces: Arc<Forces>,
    /// Whether they were moved from where they came out.
    moved: bool,
}

impl<'a> Gang<'a> {
    /// Of so many searches, at most [`LANES`]; each has to take its [`Seat`].
    pub fn new(count: usize, stop: &'a AtomicBool) -> Self {
        let seats = (0..count.min(LANES)).map(|_| State::Busy).collect();
        Self { seats: Mutex::new(seats), turn: Condvar::new(), stop }
    }

    /// The seat of a search.
    pub fn seat(&'a self, place: usize) -> Seat<'a> {
        Seat { gang: self, place, last: RefCell::new(None) }
    }

    /// A search that panicked has left its state whole: each change of it is a single one.
    fn lock(&self) -> MutexGuard<'_, Vec<State<'a>>> {
        self.seats.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<'a> Seat<'a> {
    /// Forces of a cable in every cycle, with the derivatives that its part asks for, or more; `None` when stopped. Those of the
    /// last pass are at hand.
    pub fn forces(&self, part: &Part<'a>) -> Option<Arc<Forces>> {
        if let Some(last) = self.last.borrow().as_ref().filter(|last| last.part.serves(part)) {
            return Some(Arc::clone(&last.forces));
        }
        let room = self.last.take().and_then(|last| Arc::into_inner(last.forces)).unwrap_or_default();
        let forces = Arc::new(self.pass(part, room)?);
        *self.last.borrow_mut() = Some(Last { part: part.clone(), forces: Arc::clone(&forces), moved: false });
        Some(forces)
    }

    /// Moves the forces of the last pass by their derivatives, should they be those `at`, to what they are for other `values`.
    pub fn step(&self, at: &Part<'a>, values: &Values) {
        if let Some(last) = self.last.borrow_mut().as_mut().filter(|last| last.part.serves(at)) {
            let change = |of: &Parameter| values[of.place()] - last.part.values[of.place()];
            let by: Vec<f64> = last.part.free.iter().map(change).collect();
            Arc::make_mut(&mut last.forces).step(&by);
            last.part.values = *values;
            last.moved = true;
        }
    }

    /// Forgets forces that were moved: the next are those of a pass, to the last bit.
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

/// Runs the passes of those that wait for the fewest cycles, with as many derivatives, together; the others wait on, for these may
/// join them. Nobody else has anything to do meanwhile.
fn serve(seats: &mut [State<'_>], stop: &AtomicBool) {
    let wish = |seat: &State<'_>| match seat {
        State::Waiting(part, _) => Some((part.record.rows.len(), room_for(part.carried()))),
        _ => None,
    };
    let Some(least) = seats.iter().filter_map(wish).min() else { return };
    let mut together = Vec::with_capacity(seats.len());
    for seat in seats.iter_mut().filter(|seat| wish(seat) == Some(least)) {
        if let State::Waiting(part, room) = std::mem::replace(seat, State::Served(None)) {
            together.push((seat, (*part, room)));
        }
    }
    with_room_for!(least.1, serve_together(together, stop));
}

fn serve_together<const N: usize>(waiting: Vec<(&mut State<'_>, (Part<'_>, Forces))>, stop: &AtomicBool) {
    let (seats, waiting): (Vec<_>, Vec<_>) = waiting.into_iter().unzip();
    let (parts, rooms): (Vec<_>, Vec<_>) = waiting.into_iter().unzip();
    if let Some(forces) = all_forces::<N>(&parts, rooms, stop) {
        for (seat, forces) in seats.into_iter().zip(forces) {
            *seat = State::Served(Some(forces));
        }
    }
}

/// Forces of several cables in every cycle, as many side by side as there are lanes; `None` when stopped.
pub fn forces_of(parts: &[Part<'_>], stop: &AtomicBool) -> Option<Vec<Forces>> {
    let of_lanes = |parts: &[Part<'_>]| {
        let rooms = vec![Forces::default(); parts.len()];
        let most = parts.iter().map(Part::carried).max().unwrap_or(0);
        with_room_for!(most, all_forces(parts, rooms, stop))
    };
    let all: Option<Vec<Vec<Forces>>> = parts.par_chunks(LANES).map(of_lanes).collect();
    Some(all?.into_iter().flatten().collect())
}

/// Forces of up to [`LANES`] cables in every cycle, in the room given for each; `None` when stopped.
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
