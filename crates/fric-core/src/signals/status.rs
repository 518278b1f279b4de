//! Status flags of a cable in a cycle.

use core::fmt;
use core::ops::BitOr;

use crate::words::Words;

/// Flags of one cable in one cycle; [`CableStatus::OK`] if there is no fault.
///
/// Every flag concerns its own cable; no flag of one cable changes a bit of another. All of them clear by themselves in the first cycle in which
/// their cause is gone. A cable that has moved by more than `length_jump_m` while its motion was not finite returns with one cycle of `LENGTH_JUMP`.
/// `SENSOR_JUMP` and `UNSETTLED` have memory, because their causes last.
///
/// | flag | cause | what the output is |
/// |---|---|---|
/// | `SLACK` | sensor force, less what `sensor_*` effects correct of it, ≤ 0 | no force but the offset; stored friction released |
/// | `SLACK` | viscous friction exceeds the tension | no force but the offset; stored friction goes on as usual |
/// | `SLIP` | `F_j/F_{j−1}` beyond `e^{±μ_p α}` at a pulley; with `lumped` in the sliding that the motion leads to | the ratio held at that bound; with `lumped`, what is stored already is left as it is |
/// | `SENSOR_NOT_FINITE` | sensor force NaN, infinite or beyond ±10⁹ N | last good force and friction held; the stored friction follows the motion with the last good force, so that the first good cycle goes on from where the cable is |
/// | `SENSOR_FROZEN` | the same positive sensor value to the last bit over `frozen_cycles` cycles, in which the cable has got 1 mm away; until it changes | as above |
/// | `LENGTH_JUMP` | length changed by more than `length_jump_m` per elapsed cycle | friction held, force follows the sensor; the jump is not taken for motion |
/// | `MOTION_NOT_FINITE` | length or speed NaN, infinite or beyond ±10⁶ | friction held, force follows the sensor |
/// | `OUT_OF_RANGE` | force or speed outside the cable's `validated` range | computed as usual |
/// | `POSE_MISSING` | no pose, or not a usable one (not finite, or a quaternion far from norm 1), for a cable that needs it | last wrap and direction held; 90° until the first pose |
/// | `POSE_UNREACHABLE` | the attachment lies inside the last pulley's circle | last wrap and direction held |
/// | `SENSOR_JUMP` | sensor force changed by more than `sensor_jump_n` in a cycle (`σ·length_jump_m/20` unless the robot file states it, and never less than 5 % of the force + 0.1 N at the platform; `1 + n` times as much after `n` cycles without a new value, 11 times at most); until jumps have cancelled or led back to the force before, to within that limit, else for 5 s | computed as usual |
/// | `UNSETTLED` | friction stored beyond what the present load bears, `Σμk_jT_j` and drag, by more than 25 % of the tension + 0.1 N; or a jump may have left more than half of 5 % + 0.1 N in it; until motion has forgotten it | computed as usual |
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct CableStatus(u32);

impl CableStatus {
    /// No fault.
    pub const OK: Self = Self(0);
    /// The cable carries no tension.
    pub const SLACK: Self = Self(1);
    /// The cable slips on a pulley.
    pub const SLIP: Self = Self(1 << 1);
    /// The sensor force is not a number.
    pub const SENSOR_NOT_FINITE: Self = Self(1 << 2);
    /// The sensor is frozen.
    pub const SENSOR_FROZEN: Self = Self(1 << 3);
    /// The length jumped.
    pub const LENGTH_JUMP: Self = Self(1 << 4);
    /// Length or speed is not a number.
    pub const MOTION_NOT_FINITE: Self = Self(1 << 5);
    /// The signals are outside the range in which the parameters were identified.
    pub const OUT_OF_RANGE: Self = Self(1 << 6);
    /// The pose is missing.
    pub const POSE_MISSING: Self = Self(1 << 7);
    /// The pose leaves the cable no way out of its last pulley.
    pub const POSE_UNREACHABLE: Self = Self(1 << 8);
    /// The sensor force has jumped and not yet returned.
    pub const SENSOR_JUMP: Self = Self(1 << 9);
    /// The stored friction exceeds what the load allows, or is uncertain after a jump.
    pub const UNSETTLED: Self = Self(1 << 10);

    /// Every flag with its name, lowest bit first.
    pub const NAMES: [(&'static str, Self); 11] = [
        ("SLACK", Self::SLACK),
        ("SLIP", Self::SLIP),
        ("SENSOR_NOT_FINITE", Self::SENSOR_NOT_FINITE),
        ("SENSOR_FROZEN", Self::SENSOR_FROZEN),
        ("LENGTH_JUMP", Self::LENGTH_JUMP),
        ("MOTION_NOT_FINITE", Self::MOTION_NOT_FINITE),
        ("OUT_OF_RANGE", Self::OUT_OF_RANGE),
        ("POSE_MISSING", Self::POSE_MISSING),
        ("POSE_UNREACHABLE", Self::POSE_UNREACHABLE),
        ("SENSOR_JUMP", Self::SENSOR_JUMP),
        ("UNSETTLED", Self::UNSETTLED),
    ];

    /// Returns the flags as a number, as in `/fric/status`.
    #[must_use]
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// Creates the flags from a number of `/fric/status`.
    #[must_use]
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// Whether there is no fault.
    #[must_use]
    pub const fn is_ok(self) -> bool {
        self.0 == 0
    }

    /// Whether all flags of `other` are set.
    #[must_use]
    pub const fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Whether any flag of `other` is set.
    #[must_use]
    pub const fn intersects(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    /// Returns the flags of both.
    #[must_use]
    pub const fn union(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Returns `self` where the condition holds, else [`OK`](Self::OK).
    #[inline(always)]
    pub(crate) const fn if_set(self, lanes: u32, lane: usize) -> Self {
        Self(self.0 * ((lanes >> lane) & 1))
    }
}

impl BitOr for CableStatus {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        self.union(other)
    }
}

/// Writes `ok`, or the names of the flags separated by `|`.
impl fmt::Display for CableStatus {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_ok() {
            return formatter.write_str("ok");
        }
        let mut separator = "";
        for (name, flag) in Self::NAMES {
            if self.contains(flag) {
                write!(formatter, "{separator}{name}")?;
                separator = "|";
            }
        }
        Ok(())
    }
}

impl Words for CableStatus {
    fn each_word(&mut self, show: &mut dyn FnMut(&mut u64)) {
        let mut word = u64::from(self.bits());
        show(&mut word);
        *self = Self::from_bits(u32::try_from(word).unwrap_or_default());
    }
}
