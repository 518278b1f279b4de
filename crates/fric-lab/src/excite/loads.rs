//! The stated and expected cable tensions over a run.

use fric_core::KnownReference;

use super::error::ExcitationError;
use super::options::ExcitationOptions;
use crate::simulate::mechanics::tension::TensionLevel;

/// The source of the load.
#[derive(Clone, Copy, Debug)]
pub struct Loads {
    least_n: f64,
    usual_n: f64,
    source: Source,
}

#[derive(Clone, Copy, Debug)]
enum Source {
    /// The cables hold a platform, with forces up to this one.
    Platform { greatest_n: f64 },
    /// A test bench whose load the run sets, up to this force.
    StatedBench { greatest_n: f64 },
    /// A test bench whose load the run cannot set, known or not.
    Bench { load: Option<KnownReference> },
}

impl Loads {
    /// Creates the loads between the bounds of the options; `is_held` says whether the cables hold a platform. By default, the least force of a
    /// platform's cables is a tenth of their mean plus the viscous friction, and the greatest is as far above the mean as the least is below.
    pub fn new(
        level: &TensionLevel,
        options: &ExcitationOptions,
        known: Option<KnownReference>,
        is_held: bool,
    ) -> Result<Self, ExcitationError> {
        let stated = options.max_tension_n;
        if let (false, Some(_), Some(greatest_n)) = (is_held, known, stated) {
            return Err(ExcitationError::LoadIsKnown { greatest_n });
        }
        if let (false, None, Some(least_n)) = (is_held, stated, options.min_tension_n) {
            return Err(ExcitationError::NoGreatestLoad { least_n });
        }
        let least_n = options
            .min_tension_n
            .unwrap_or_else(|| stated.map_or(level.least_n, |greatest_n| level.least_n.min(0.5 * greatest_n)));
        let usual_n = stated.map_or_else(|| level.mean_n.max(2.0 * least_n), |greatest_n| 0.5 * (least_n + greatest_n));
        let source = match stated {
            _ if is_held => Source::Platform { greatest_n: stated.unwrap_or(2.0 * usual_n - least_n) },
            Some(greatest_n) => Source::StatedBench { greatest_n },
            None => Source::Bench { load: known },
        };
        Ok(Self { least_n, usual_n, source })
    }

    /// Returns the least force of a cable, N.
    pub fn least_n(&self) -> f64 {
        self.least_n
    }

    /// Returns the force of a cable if the run states none, N.
    pub fn usual_n(&self) -> f64 {
        self.usual_n
    }

    /// Whether nothing states the load of a test bench.
    pub fn is_assumed(&self) -> bool {
        matches!(self.source, Source::Bench { load: None })
    }

    /// Returns the force at a fraction of the range, N; `None` if the run cannot set it.
    pub fn stated_n(&self, share: f64) -> Option<f64> {
        match self.source {
            Source::Platform { greatest_n } | Source::StatedBench { greatest_n } => {
                Some(self.least_n + share * (greatest_n - self.least_n))
            }
            Source::Bench { .. } => None,
        }
    }

    /// Returns the load of a test bench that the run cannot set, N, while its cable is accelerated.
    pub fn expected_n(&self, acceleration_m_per_s2: f64) -> f64 {
        match self.source {
            Source::Bench { load: Some(load) } => load.force_n(acceleration_m_per_s2),
            _ => self.usual_n,
        }
    }

    /// Returns the bounds of the load of a test bench that the run sets, N.
    pub fn of_bench_n(&self) -> Option<(f64, Option<f64>)> {
        match self.source {
            Source::StatedBench { greatest_n } => Some((self.least_n, Some(greatest_n))),
            Source::Platform { .. } | Source::Bench { .. } => None,
        }
    }
}
