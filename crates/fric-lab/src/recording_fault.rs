//! A fault of a recording: its kind and values, and what to say about it.

use serde::Serialize;

use crate::numbers::Numbers;
use crate::text::{quantity, significant, wrapped};
use crate::words::{Times, newtons};

/// Key of the play that keeps a noisy length out: of this fault, and of the monitor in a robot file.
pub(crate) const LENGTH_NOISE_M: &str = "length_noise_m";

/// The kind of a recording fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// A spectral line that is unrelated to the motion and load of the cable.
    Hum,
    /// A damped oscillation of one frequency, as of a sensor on a mount that gives way.
    Vibration,
    /// The length trembles, and the model takes it for motion.
    NoisyLength,
    /// The force sensor repeats one value.
    Frozen,
    /// The force sensor is saturated.
    Clipped,
    /// The force sensor shows single values far from those before and after.
    Spikes,
    /// The converter behind the force sensor has coarse steps.
    CoarseConverter,
    /// The reference is late.
    ReferenceDelay,
    /// The clock of the reference runs at another rate than the clock of the winch.
    ClockSkew,
}

/// A fault of a recording. It concerns the log, not the machine.
#[derive(Clone, Debug, PartialEq)]
pub struct RecordingFault {
    /// The kind of the fault.
    pub fault: Fault,
    /// The values of the fault, by key with the unit.
    pub parameters: Vec<(&'static str, f64)>,
    /// Time intervals of the fault, s since the first sample; empty if it lasts throughout the log.
    pub intervals_s: Vec<[f64; 2]>,
}

/// A fault of a recording, as results have it.
#[derive(Clone, Debug, Serialize)]
pub struct FaultResult {
    /// Its name.
    pub kind: &'static str,
    /// Its values, by key with the unit.
    pub parameters: Numbers,
    /// Time intervals of the fault, s since the first sample; empty if it lasts throughout the log.
    pub intervals_s: Vec<[f64; 2]>,
    /// The kind of the fault.
    #[serde(skip)]
    pub fault: Fault,
}

impl Fault {
    /// Returns the name used in results.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hum => "hum",
            Self::Vibration => "vibration",
            Self::NoisyLength => "noisy_length",
            Self::Frozen => "frozen",
            Self::Clipped => "clipped",
            Self::Spikes => "spikes",
            Self::CoarseConverter => "coarse_converter",
            Self::ReferenceDelay => "reference_delay",
            Self::ClockSkew => "clock_skew",
        }
    }
}

impl FaultResult {
    /// Creates the entry of a fault.
    #[must_use]
    pub fn of(found: &RecordingFault) -> Self {
        Self {
            kind: found.fault.name(),
            parameters: Numbers(found.parameters.iter().map(|(key, value)| ((*key).to_owned(), *value)).collect()),
            intervals_s: found.intervals_s.clone(),
            fault: found.fault,
        }
    }

    /// Returns the fault and what to do, as a sentence without its full stop. `times` are those of the result.
    #[must_use]
    pub fn in_words(&self, times: &Times<'_>) -> String {
        let value = |key: &str| self.parameters.get(key).unwrap_or(f64::NAN);
        let left_out = || format!("at {}: left out of all the rest", times.in_words(&self.intervals_s));
        match self.fault {
            Fault::Hum => format!(
                "it hums at {:.2} Hz with an amplitude of {}: no friction does; look at wiring and amplifiers",
                value("frequency_hz"),
                newtons(value("amplitude_n"))
            ),
            Fault::Vibration => format!(
                "it vibrates at {:.2} Hz, damped by {} of the critical, {} rms: a mount or a frame that rings; stiffen it, fix the sensor nearer to the \
                 pulley, or drive it with less jerk",
                value("frequency_hz"),
                significant(value("damping_ratio")),
                newtons(value("rms_n"))
            ),
            Fault::NoisyLength => format!(
                "the length trembles by {} (standard deviation), which the model takes for motion; `length_noise_m` = {} m of the monitor keeps \
                 it out, which the written file sets; look at the encoder's resolution, supply and shielding",
                quantity(value("noise_m"), None, "m"),
                significant(value("length_noise_m"))
            ),
            Fault::Frozen => format!("the force sensor stands still {}", left_out()),
            Fault::Clipped => format!("the force sensor is at the end of its range {}", left_out()),
            Fault::Spikes => {
                format!(
                    "the force sensor spikes {}; look at its cable, its plugs and what switches beside it",
                    left_out()
                )
            }
            Fault::CoarseConverter => {
                let of_sensor = self.parameters.get("step_n").map(|step_n| ("force sensor", step_n));
                let (signal, step_n) = of_sensor.unwrap_or(("reference", value("reference_step_n")));
                format!(
                    "the {signal} has steps of {}, which are part of the noise; use more of the converter's range, or one of more bits",
                    newtons(step_n)
                )
            }
            Fault::ReferenceDelay if value("delay_s") < 0.0 => format!(
                "the reference is early by {}, and was put where it belongs; stamp both with one clock where they are measured, and if they are, \
                 look for what delays the cable forces, because the loop gets them as late",
                quantity(-value("delay_s"), None, "s")
            ),
            Fault::ReferenceDelay => format!(
                "the reference comes late by {}, and was put where it belongs; stamp it where it is measured, or take the filter of its \
                 amplifier into account",
                quantity(value("delay_s"), None, "s")
            ),
            Fault::ClockSkew => {
                let (skew_ratio, delay_s) = (value("skew_ratio"), value("delay_s"));
                format!(
                    "the reference {} by {} ppm, so its clock is another one, and at the beginning it is {} by {}; it was put where it belongs; \
                     record both with one clock, or synchronise them",
                    if skew_ratio < 0.0 { "falls behind" } else { "gets ahead" },
                    significant(1e6 * skew_ratio.abs()),
                    if delay_s < 0.0 { "early" } else { "late" },
                    quantity(delay_s.abs(), None, "s")
                )
            }
        }
    }
}

/// Describes the recording faults of each cable that last throughout the logs, one paragraph per fault; empty if there are none.
pub fn recording_lines<'a>(cables: impl Iterator<Item = (&'a str, &'a [FaultResult])>) -> String {
    let told = cables.flat_map(|(name, faults)| {
        faults.iter().map(move |fault| wrapped(&format!("{name}, recording: "), &fault.in_words(&Times::default())))
    });
    let text: String = told.collect();
    if text.is_empty() { text } else { format!("\n{text}") }
}
