//! New parameters from one thread into the cycle of another.
//!
//! For: [`AnyCompensator`] in a control loop, and whoever identifies, tunes or reads files beside it. Both ends are
//! wait-free (two rings of the `rtrb` crate): the loop looks at a pointer, copies, and gives the pointer back, so that it
//! neither allocates nor frees. One change at a time: its parameters leave their ring of one place when it is over, and
//! until then nothing else can be sent. Needs the feature `alloc`.

use alloc::boxed::Box;
use core::fmt;

use rtrb::{Consumer, Producer, RingBuffer};

use crate::any::AnyCompensator;
use crate::robot::{ParamError, ParamProblem, RobotParams};

/// The longest blend, s.
const LONGEST_BLEND_S: f64 = 3600.0;

/// Parameters on their way.
#[derive(Debug)]
struct Parcel {
    next: AnyCompensator,
    blend_cycles: u32,
}

/// The end outside of the loop.
#[derive(Debug)]
pub struct ParameterSender {
    /// Has the cables and pulleys of the robot that runs.
    pattern: AnyCompensator,
    outward: Producer<Box<Parcel>>,
    back: Consumer<Box<Parcel>>,
}

/// The end inside of the loop.
#[derive(Debug)]
pub struct ParameterReceiver {
    inward: Consumer<Box<Parcel>>,
    /// The change to the parameters in `inward` has begun.
    has_begun: bool,
    back: Producer<Box<Parcel>>,
}

/// Why parameters were not sent.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum SendError {
    /// The change to those sent before is not over; try again some cycles later.
    Busy,
    /// They are not for the robot that runs, or the blend is no time.
    Param(ParamError),
}

impl fmt::Display for SendError {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Busy => {
                formatter.write_str("the change to the parameters sent before is not over; try again some cycles later")
            }
            Self::Param(error) => error.fmt(formatter),
        }
    }
}

impl core::error::Error for SendError {}

/// Both ends for a compensator of `robot`, the robot that runs. Allocates.
///
/// # Errors
/// As [`AnyCompensator::new`].
pub fn parameter_exchange(robot: &RobotParams<'_>) -> Result<(ParameterSender, ParameterReceiver), ParamError> {
    let pattern = AnyCompensator::new(robot)?;
    let (outward, inward) = RingBuffer::new(1);
    // Between two looks of the sender at what has come back, the parcel sent before may come and the one sent last.
    let (back_in, back) = RingBuffer::new(2);
    let receiver = ParameterReceiver { inward, has_begun: false, back: back_in };
    Ok((ParameterSender { pattern, outward, back }, receiver))
}

impl ParameterSender {
    /// Sends the parameters of `robot` into the loop, whose output goes over to them within `blend_s` seconds (0…3600, one
    /// cycle at least). The change begins with the next [`deliver_to`](ParameterReceiver::deliver_to); it is over, and others
    /// can be sent, with the first one after its blend. Allocates, and frees what has come back; never waits. Names of cables are
    /// not known here: that these are the same cables in the same order is the caller's to see to.
    ///
    /// # Errors
    /// [`SendError`]; nothing has been sent then.
    pub fn send(&mut self, robot: &RobotParams<'_>, blend_s: f64) -> Result<(), SendError> {
        while self.back.pop().is_ok() {}
        if !(0.0..=LONGEST_BLEND_S).contains(&blend_s) {
            let problem = ParamProblem::OutOfRange { value: blend_s, min: 0.0, max: LONGEST_BLEND_S };
            return Err(SendError::Param(ParamError { key: "blend_s", pulley: None, effect: None, problem }));
        }
        let next = AnyCompensator::new(robot).map_err(SendError::Param)?;
        self.pattern.check_exchange(&next).map_err(SendError::Param)?;
        #[expect(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "0 to 3.6e9, cycles of 1 µs or more"
        )]
        let blend_cycles = libm::round(blend_s / robot.cycle_s()) as u32;
        self.outward.push(Box::new(Parcel { next, blend_cycles })).map_err(|_| SendError::Busy)
    }
}

impl ParameterReceiver {
    /// To be called before each cycle: ends the change whose blend is over, and begins the one to parameters that have come.
    /// Wait-free; neither allocates nor frees.
    ///
    /// # Errors
    /// [`ParamError`] if the parameters do not fit, as with a `compensator` of another robot than [`parameter_exchange`] was
    /// given; nothing is changed then, and the sender is told nothing.
    pub fn deliver_to(&mut self, compensator: &mut AnyCompensator) -> Result<(), ParamError> {
        if compensator.is_changing() {
            return Ok(());
        }
        if self.has_begun {
            self.give_back();
        }
        let Ok(parcel) = self.inward.peek() else { return Ok(()) };
        self.has_begun = true;
        compensator.change(&parcel.next, parcel.blend_cycles)
    }

    fn give_back(&mut self) {
        self.has_begun = false;
        let Ok(parcel) = self.inward.pop() else { return };
        if let Err(rtrb::PushError::Full(parcel)) = self.back.push(parcel) {
            // There was room; were there none, losing memory would do less harm here than freeing it.
            core::mem::forget(parcel);
        }
    }
}
