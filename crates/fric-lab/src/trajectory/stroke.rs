//! A movement along a line, or about an axis, from rest to rest with bounded acceleration and jerk.
//!
//! Distances are in m or rad, depending on the movement; speeds and accelerations are per s and s².
//!
//! The speed rises along a raised cosine, stays constant, and falls along one: with the ramp `T = πv/(2a)`, `v(t) = v/2·(1 − cos(πt/T))`, so that the
//! acceleration starts and ends at zero and reaches its maximum `a` half way.

use core::f64::consts::PI;

/// Distance along a line over time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    distance: f64,
    peak: f64,
    ramp_s: f64,
    cruise_s: f64,
}

/// Distance, speed and acceleration along the line at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Along {
    pub distance: f64,
    pub speed: f64,
    pub acceleration: f64,
}

impl Stroke {
    /// Creates a stroke of `distance ≥ 0` that reaches `speed`, or what the distance allows, with at most `acceleration`. Both limits are positive.
    pub fn new(distance: f64, speed: f64, acceleration: f64) -> Self {
        // Both ramps together cover v·T = πv²/(2a).
        let reachable = libm::sqrt(distance * acceleration * 2.0 / PI);
        let peak = speed.min(reachable);
        let ramp_s = PI * peak / (2.0 * acceleration);
        let cruise = (distance - peak * ramp_s).max(0.0);
        let cruise_s = if peak > 0.0 { cruise / peak } else { 0.0 };
        Self { distance, peak, ramp_s, cruise_s }
    }

    pub fn duration_s(&self) -> f64 {
        2.0 * self.ramp_s + self.cruise_s
    }

    /// Returns the greatest speed.
    pub fn peak(&self) -> f64 {
        self.peak
    }

    /// Returns distance, speed and acceleration at a time; at rest before the start and after the end.
    pub fn at(&self, time_s: f64) -> Along {
        let left_s = self.duration_s() - time_s;
        if left_s <= 0.0 || self.ramp_s <= 0.0 {
            return Along { distance: if left_s <= 0.0 { self.distance } else { 0.0 }, ..Along::default() };
        }
        if time_s < self.ramp_s {
            return self.ramp(time_s.max(0.0));
        }
        if left_s < self.ramp_s {
            let mirrored = self.ramp(left_s);
            return Along {
                distance: self.distance - mirrored.distance,
                acceleration: -mirrored.acceleration,
                ..mirrored
            };
        }
        let distance = self.peak * (time_s - 0.5 * self.ramp_s);
        Along { distance, speed: self.peak, acceleration: 0.0 }
    }

    fn ramp(&self, time_s: f64) -> Along {
        let (half_peak, rate) = (0.5 * self.peak, PI / self.ramp_s);
        let (sin, cos) = libm::sincos(rate * time_s);
        Along {
            distance: half_peak * (time_s - sin / rate),
            speed: half_peak * (1.0 - cos),
            acceleration: half_peak * rate * sin,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_belong_together_and_limits_hold() {
        for (distance, fastest, limit) in [(0.1, 1.0, 16.0), (0.000_25, 0.083, 4.0), (0.3, 0.167, 4.0)] {
            let stroke = Stroke::new(distance, fastest, limit);
            let step_s = 1e-6;
            let count = 500;
            for part in 1..count {
                let time_s = stroke.duration_s() * f64::from(part) / f64::from(count);
                let [before, here, after] = [-step_s, 0.0, step_s].map(|shift_s| stroke.at(time_s + shift_s));
                let speed = (after.distance - before.distance) / (2.0 * step_s);
                let acceleration = (after.speed - before.speed) / (2.0 * step_s);
                assert!((speed - here.speed).abs() < 1e-8, "{time_s}");
                assert!((acceleration - here.acceleration).abs() < 1e-2, "{time_s}");
                assert!(here.speed <= fastest * (1.0 + 1e-12));
                assert!(here.acceleration.abs() <= limit * (1.0 + 1e-12));
            }
            assert!((stroke.at(stroke.duration_s() - 1e-12).distance - distance).abs() < 1e-12);
            assert_eq!(stroke.at(0.0), Along::default());
            assert_eq!(stroke.at(9.0), Along { distance, ..Along::default() });
        }
    }

    #[test]
    fn a_stroke_of_no_length_takes_no_time() {
        let stroke = Stroke::new(0.0, 1.0, 1.0);
        assert!(stroke.duration_s().abs() < 1e-300);
        assert_eq!(stroke.at(0.0), Along::default());
    }
}
