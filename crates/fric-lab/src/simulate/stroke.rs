//! A straight movement from rest to rest with bounded acceleration and jerk.
//!
//! Speed follows a raised cosine up, stays, and follows it down: with the ramp `T = πv/(2a)`,
//! `v(t) = v/2·(1 − cos(πt/T))`, so that acceleration starts and ends at zero and has its greatest value `a` half way.

use core::f64::consts::PI;

/// Distance along a line over time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    distance_m: f64,
    peak_m_per_s: f64,
    ramp_s: f64,
    cruise_s: f64,
}

/// Distance, speed and acceleration along the line at one time.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Along {
    pub distance_m: f64,
    pub speed_m_per_s: f64,
    pub acceleration_m_per_s2: f64,
}

impl Stroke {
    /// A stroke of `distance_m ≥ 0` that reaches `speed_m_per_s`, or what the distance allows, with at most
    /// `acceleration_m_per_s2`. Both limits are positive.
    pub fn new(distance_m: f64, speed_m_per_s: f64, acceleration_m_per_s2: f64) -> Self {
        // Both ramps together cover v·T = πv²/(2a).
        let reachable_m_per_s = libm::sqrt(distance_m * acceleration_m_per_s2 * 2.0 / PI);
        let peak_m_per_s = speed_m_per_s.min(reachable_m_per_s);
        let ramp_s = PI * peak_m_per_s / (2.0 * acceleration_m_per_s2);
        let cruise_m = (distance_m - peak_m_per_s * ramp_s).max(0.0);
        let cruise_s = if peak_m_per_s > 0.0 { cruise_m / peak_m_per_s } else { 0.0 };
        Self { distance_m, peak_m_per_s, ramp_s, cruise_s }
    }

    pub fn duration_s(&self) -> f64 {
        2.0 * self.ramp_s + self.cruise_s
    }

    /// The greatest speed on the way.
    pub fn peak_m_per_s(&self) -> f64 {
        self.peak_m_per_s
    }

    /// Where and how fast at a time; at rest before the start and after the end.
    pub fn at(&self, time_s: f64) -> Along {
        let left_s = self.duration_s() - time_s;
        if left_s <= 0.0 || self.ramp_s <= 0.0 {
            return Along { distance_m: if left_s <= 0.0 { self.distance_m } else { 0.0 }, ..Along::default() };
        }
        if time_s < self.ramp_s {
            return self.ramp(time_s.max(0.0));
        }
        if left_s < self.ramp_s {
            let mirrored = self.ramp(left_s);
            return Along {
                distance_m: self.distance_m - mirrored.distance_m,
                acceleration_m_per_s2: -mirrored.acceleration_m_per_s2,
                ..mirrored
            };
        }
        let distance_m = self.peak_m_per_s * (time_s - 0.5 * self.ramp_s);
        Along { distance_m, speed_m_per_s: self.peak_m_per_s, acceleration_m_per_s2: 0.0 }
    }

    fn ramp(&self, time_s: f64) -> Along {
        let (half_m_per_s, rate) = (0.5 * self.peak_m_per_s, PI / self.ramp_s);
        let (sin, cos) = libm::sincos(rate * time_s);
        Along {
            distance_m: half_m_per_s * (time_s - sin / rate),
            speed_m_per_s: half_m_per_s * (1.0 - cos),
            acceleration_m_per_s2: half_m_per_s * rate * sin,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn derivatives_belong_together_and_limits_hold() {
        for (distance_m, speed_m_per_s, limit) in [(0.1, 1.0, 16.0), (0.000_25, 0.083, 4.0), (0.3, 0.167, 4.0)] {
            let stroke = Stroke::new(distance_m, speed_m_per_s, limit);
            let step_s = 1e-6;
            let count = 500;
            for part in 1..count {
                let time_s = stroke.duration_s() * f64::from(part) / f64::from(count);
                let [before, here, after] = [-step_s, 0.0, step_s].map(|shift_s| stroke.at(time_s + shift_s));
                let speed = (after.distance_m - before.distance_m) / (2.0 * step_s);
                let acceleration = (after.speed_m_per_s - before.speed_m_per_s) / (2.0 * step_s);
                assert!((speed - here.speed_m_per_s).abs() < 1e-8, "{time_s}");
                assert!((acceleration - here.acceleration_m_per_s2).abs() < 1e-2, "{time_s}");
                assert!(here.speed_m_per_s <= speed_m_per_s * (1.0 + 1e-12));
                assert!(here.acceleration_m_per_s2.abs() <= limit * (1.0 + 1e-12));
            }
            assert!((stroke.at(stroke.duration_s() - 1e-12).distance_m - distance_m).abs() < 1e-12);
            assert_eq!(stroke.at(0.0), Along::default());
            assert_eq!(stroke.at(9.0), Along { distance_m, ..Along::default() });
        }
    }

    #[test]
    fn a_stroke_of_no_length_takes_no_time() {
        let stroke = Stroke::new(0.0, 1.0, 1.0);
        assert!(stroke.duration_s().abs() < 1e-300);
        assert_eq!(stroke.at(0.0), Along::default());
    }
}
