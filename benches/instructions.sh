#!/usr/bin/env bash
# Instructions per cycle, counted by callgrind for baseline x86-64: the difference between two runs, so that set-up drops out.
# Usage: benches/instructions.sh            compares 8 cables with benches/instructions.txt; exits 1 if 3 % above it
#        benches/instructions.sh --record   writes benches/instructions.txt anew
#        benches/instructions.sh --counts   4 to 64 cables
set -euo pipefail
cd "$(dirname "$0")/.."
record=benches/instructions.txt
target=${CARGO_TARGET_DIR:-target}
if [ "$(uname -sm)" != "Linux x86_64" ]; then
    echo "not checked: instructions per cycle; they are recorded for Linux on x86_64"
    exit 0
fi
command -v valgrind >/dev/null || { echo "valgrind is missing: apt-get install valgrind" >&2; exit 2; }
# Whatever else is set, the count is that of the baseline.
unset CARGO_ENCODED_RUSTFLAGS
RUSTFLAGS="" cargo build --quiet --release -p cycle-instructions
program=$target/release/cycle_instructions

# Instructions of one run of $1 over $2 rounds of 4096 cycles, $3 cables.
count() {
    valgrind --tool=callgrind --callgrind-out-file=/dev/null "$program" run "$1" "$2" "$3" 2>&1 |
        awk '/Collected/ { print $NF }'
}
per_cycle() { # FORM CABLES
    local one two
    one=$(count "$1" 1 "$2")
    two=$(count "$1" 2 "$2")
    echo $(((two - one) / 4096))
}

if [ "${1:-}" = --counts ]; then
    for form in lumped per_pulley; do
        for cables in 4 8 16 32 64; do
            now=$(per_cycle $form $cables)
            echo "$form, $cables cables: $now instructions per cycle, $((now / cables)) a cable"
        done
    done
    exit 0
fi

compiler=$(rustc --version)
if [ "${1:-}" = --record ]; then
    {
        echo "# Instructions per cycle of 8 cables, baseline x86-64, and the compiler that they are of; by benches/instructions.sh --record"
        echo "compiler $compiler"
        for form in lumped per_pulley; do echo "$form $(per_cycle $form 8)"; done
    } > "$record.new"
    mv "$record.new" "$record"
    cat "$record"
    exit 0
fi

recorded() { awk -v key="$1" '$1 == key { sub(/^[^ ]+ /, ""); print }' "$record"; }
status=0
for form in lumped per_pulley; do
    now=$(per_cycle $form 8)
    was=$(recorded $form)
    echo "$form: $now instructions per cycle, recorded $was"
    if [ $((100 * now)) -gt $((103 * was)) ]; then
        echo "$form: more than 3 % above the record" >&2
        status=1
    elif [ $((100 * now)) -lt $((97 * was)) ]; then
        echo "$form: more than 3 % below the record: benches/instructions.sh --record keeps the gain"
    fi
done
if [ $status -ne 0 ]; then
    echo "counted with $compiler, recorded with $(recorded compiler)" >&2
    echo "If the cycle is to cost more, or another compiler counts otherwise: benches/instructions.sh --record" >&2
fi
exit $status
