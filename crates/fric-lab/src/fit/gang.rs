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

use super::pass::{Forces, LanePass, Part, room_for, with_room_for};

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
    /// Waits for a pass.
    Waiting(Box<Part<'a>>),
    /// Its pass is done; `None` when stopped.
    Served(Option<Forces>),
    /// Ended.
    Gone,
}

/// The place of one search in a gang; it counts as ended when this is dropped.
#[derive(Debug)]
pub struct Seat<'a> {
    gang: &'a Gang<'a>,
    place: usize,
    last: RefCell<Option<(Part<'a>, Arc<Forces>)>>,
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
        if let Some((_, forces)) = self.last.borrow().as_ref().filter(|(last, _)| last.serves(part)) {
            return Some(Arc::clone(forces));
        }
        let forces = Arc::new(self.pass(part)?);
        *self.last.borrow_mut() = Some((part.clone(), Arc::clone(&forces)));
        Some(forces)
    }

    fn pass(&self, part: &Part<'a>) -> Option<Forces> {
        let mut seats = self.gang.lock();
        if let Some(seat) = seats.get_mut(self.place) {
            *seat = State::Waiting(Box::new(part.clone()));
        }
        loop {
            match seats.get_mut(self.place) {
                Some(seat @ State::Served(_)) => {
                    let State::Served(forces) = std::mem::replace(seat, State::Busy) else { return None };
                    return forces;
                }
                Some(State::Waiting(_)) => {}
                _ => return None,
            }
            if seats.iter().any(|seat| matches!(seat, State::Busy)) {
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

/// Runs the passes of all that wait, those with as many derivatives and cycles together. Nobody else has anything to do meanwhile.
fn serve(seats: &mut [State<'_>], stop: &AtomicBool) {
    let waits = |seat: &State<'_>| match seat {
        State::Waiting(part) => Some((room_for(part.free.len()), part.record.rows.len())),
        _ => None,
    };
    while let Some(alike) = seats.iter().find_map(waits) {
        let mut together = Vec::with_capacity(seats.len());
        for seat in seats.iter_mut().filter(|seat| waits(seat) == Some(alike)) {
            if let State::Waiting(part) = std::mem::replace(seat, State::Served(None)) {
                together.push((seat, *part));
            }
        }
        with_room_for!(alike.0, serve_together(together, stop));
    }
}

fn serve_together<const N: usize>(waiting: Vec<(&mut State<'_>, Part<'_>)>, stop: &AtomicBool) {
    let (seats, parts): (Vec<_>, Vec<_>) = waiting.into_iter().unzip();
    if let Some(forces) = all_forces::<N>(&parts, stop) {
        for (seat, forces) in seats.into_iter().zip(forces) {
            *seat = State::Served(Some(forces));
        }
    }
}

/// Forces of up to [`LANES`] cables in every cycle; `None` when stopped.
pub fn all_forces<const N: usize>(parts: &[Part<'_>], stop: &AtomicBool) -> Option<Vec<Forces>> {
    let mut pass = LanePass::<N>::new(parts.iter().cloned());
    let cycles = parts.first().map_or(0, |part| part.record.rows.len());
    let mut forces: Vec<Forces> = parts.iter().take(LANES).map(|_| Forces::new(N, cycles)).collect();
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
