#!/usr/bin/env bash
# Instructions per cycle of 8 cables, counted by callgrind: the difference between two runs, so that set-up drops out.
# Usage: benches/instructions.sh [MOST]    exits 1 if `lumped` needs more than MOST instructions.
set -euo pipefail
cd "$(dirname "$0")/.."
target=${CARGO_TARGET_DIR:-target}
command -v valgrind >/dev/null || { echo "valgrind is missing: apt-get install valgrind" >&2; exit 2; }
cargo build --quiet --release -p fric-core --example cycle_instructions
program=$target/release/examples/cycle_instructions

# Instructions of one run of $1 over $2 rounds of 4096 cycles.
count() {
    valgrind --tool=callgrind --callgrind-out-file=/dev/null "$program" run "$1" "$2" 2>&1 |
        awk '/Collected/ { print $NF }'
}

status=0
for form in lumped per_pulley; do
    one=$(count "$form" 1)
    three=$(count "$form" 3)
    per_cycle=$(((three - one) / (2 * 4096)))
    echo "$form: $per_cycle instructions per cycle"
    if [ "$form" = lumped ] && [ $# -gt 0 ] && [ "$per_cycle" -gt "$1" ]; then
        echo "more than the $1 that are allowed" >&2
        status=1
    fi
done
exit $status
