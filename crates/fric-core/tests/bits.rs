//! Outputs compared bit by bit, by the tests and the soak.

use fric_core::CableOutput;

/// The bits of everything a cable's output says.
pub fn bits(output: &CableOutput) -> [u64; 4] {
    [
        output.force_at_platform_n.to_bits(),
        output.friction_n.to_bits(),
        output.frictionless_n.to_bits(),
        u64::from(output.status.bits()),
    ]
}
