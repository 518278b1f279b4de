//! Faults of the recording in words, each with what to do about it.

use super::{Times, newtons};
use crate::discover::faults::Fault;
use crate::discover::result::FaultResult;
use crate::text::{quantity, significant, wrapped};

/// Describes the recording faults of each cable that last throughout the logs, one paragraph per fault; empty if there are none.
pub fn recording_lines<'a>(cables: impl Iterator<Item = (&'a str, &'a [FaultResult])>) -> String {
    let told = cables.flat_map(|(name, faults)| {
        faults.iter().map(move |fault| wrapped(&format!("{name}, recording: "), &fault.in_words(&Times::default())))
    });
    let text: String = told.collect();
    if text.is_empty() { text } else { format!("\n{text}") }
}

impl FaultResult {
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
