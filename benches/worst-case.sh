#!/usr/bin/env bash
# What a cycle can cost at most, in instructions, for the robot of a file, baseline x86-64: benches/worst-case.sh ROBOT [RUNS]
# Each run is 2000 cycles, some 10 s. benches/worst_case.py says what the bound is.
set -euo pipefail
robot=$(realpath "${1:?usage: benches/worst-case.sh ROBOT [RUNS]}")
cd "$(dirname "$0")/.."
command -v valgrind >/dev/null || { echo "valgrind is missing: apt-get install valgrind" >&2; exit 2; }
unset CARGO_ENCODED_RUSTFLAGS
RUSTFLAGS="" cargo build --quiet --release -p fric-core --features alloc,robot-file --example worst_case
python3 benches/worst_case.py "${CARGO_TARGET_DIR:-target}/release/examples/worst_case" "$robot" "${2:-10}"
