//! Passes new parameters from one thread to the cycle of another.
//!
//! It connects an [`AnyCompensator`] in a control loop with a thread that identifies, tunes or reads files. Both ends are wait-free (two rings of the
//! `rtrb` crate): the loop reads a pointer, copies, and returns the pointer, so that it neither allocates nor frees. There is one change at a time:
//! its parameters stay in their ring, which has one slot, until it is over, and until then nothing else can be sent. Needs the feature `alloc`.

use alloc::boxed::Box;
use core::fmt;

use rtrb::{Consumer, Producer, RingBuffer};

use crate::compensator::any::AnyCompensator;
use crate::robot::{ParamError, ParamProblem, RobotParams};

/// Maximum duration of a blend, s.
const LONGEST_BLEND_S: f64 = 3600.0;

/// Parameters in transit.
#[derive(Debug)]
struct Parcel {
    next: AnyCompensator,
    blend_cycles: u32,
}

/// The end outside the loop.
#[derive(Debug)]
pub struct ParameterSender {
    /// A compensator with the cables and pulleys of the running robot, to compare with.
    pattern: AnyCompensator,
    outward: Producer<Box<Parcel>>,
    back: Consumer<Box<Parcel>>,
}

/// The end inside the loop.
#[derive(Debug)]
pub struct ParameterReceiver {
    inward: Consumer<Box<Parcel>>,
    /// Whether the change to the parameters in `inward` has begun.
    has_begun: bool,
    back: Producer<Box<Parcel>>,
}

/// The reason why parameters were not sent.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum SendError {
    /// The previous change is not over; try again some cycles later.
    Busy,
    /// The parameters do not fit the running robot, or the blend time is invalid.
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

/// Creates both ends for a compensator of `robot`, the running robot. Allocates.
///
/// ```
/// use fric_core::robot::{CableOptions, CableParams, FrictionOptions, MonitorOptions, PlatformOptions, PulleyOptions};
/// use fric_core::{AnyCompensator, CableInput, RobotParams, parameter_exchange};
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let pulleys = [PulleyOptions::Fixed { wrap_rad: core::f64::consts::PI, sensor: true }];
/// let cable_with = |mu| {
///     let friction = FrictionOptions { mu, sigma_n_per_m: Some(1000.0), ..FrictionOptions::default() };
///     CableParams::new(&CableOptions { friction, ..CableOptions::new(&pulleys) })
/// };
/// let (running, fitted) = ([cable_with(0.02)?], [cable_with(0.03)?]);
/// let robot = |cables| RobotParams::new(0.001, &PlatformOptions::default(), MonitorOptions::for_cycle(0.001), cables);
/// let mut compensator = AnyCompensator::new(&robot(&running)?)?;
/// let (mut sender, mut receiver) = parameter_exchange(&robot(&running)?)?;
///
/// std::thread::scope(|scope| {
///     // Outside the loop: the output is to blend over within 0.1 s, 100 cycles.
///     let sent = scope.spawn(|| sender.send(&robot(&fitted)?, 0.1).map_err(Box::<dyn std::error::Error + Send + Sync>::from));
///     assert!(sent.join().is_ok_and(|sent| sent.is_ok()));
/// });
///
/// // The loop: each cycle takes up what has arrived.
/// for cycle in 0..200 {
///     receiver.deliver_to(&mut compensator)?;
///     let length_m = 1e-4 * f64::from(cycle);
///     let signals = CableInput { sensor_force_n: 20.0 + 1e-3 * f64::from(cycle % 3), length_m, speed_m_per_s: 0.1 };
///     compensator.set_input(&[signals], None, 1.0);
///     compensator.step();
///     assert_eq!(compensator.is_changing(), cycle < 99);
/// }
/// // Paying out over a pulley of 180°: F_1 = F_s (1 + μ)/2, with the new μ.
/// let force_n = compensator.outputs()[0].force_at_platform_n;
/// assert!((force_n - 20.001 * 1.03 / 2.0).abs() < 1e-4);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// Returns the errors of [`AnyCompensator::new`].
pub fn parameter_exchange(robot: &RobotParams<'_>) -> Result<(ParameterSender, ParameterReceiver), ParamError> {
    let pattern = AnyCompensator::new(robot)?;
    let (outward, inward) = RingBuffer::new(1);
    // Between two reads of the return ring, both the previous parcel and the last one may arrive.
    let (back_in, back) = RingBuffer::new(2);
    let receiver = ParameterReceiver { inward, has_begun: false, back: back_in };
    Ok((ParameterSender { pattern, outward, back }, receiver))
}

impl ParameterSender {
    /// Sends the parameters of `robot` to the loop, whose output blends over to them within `blend_s` seconds (0…3600, at least one cycle). The
    /// change begins with the next [`deliver_to`](ParameterReceiver::deliver_to). It is over, and others can be sent, with the first call of that
    /// function after the blend. Allocates, and frees returned parameters; never waits. Names of cables are not checked: the caller must ensure that
    /// these are the same cables in the same order.
    ///
    /// # Errors
    /// Returns a [`SendError`]; nothing has been sent then.
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
    /// Call this before each cycle. It ends the change whose blend is over, and begins the one to parameters that have arrived. Wait-free; neither
    /// allocates nor frees.
    ///
    /// # Errors
    /// Returns a [`ParamError`] if the parameters do not fit, as with a `compensator` of another robot than [`parameter_exchange`] was given. Nothing
    /// is changed then, and the sender is not notified.
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
            // There is always room. If there were none, leaking memory would be less harmful here than freeing it.
            core::mem::forget(parcel);
        }
    }
}
