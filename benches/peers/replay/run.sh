#!/usr/bin/env bash
# Replay with output beside the `mcap` crate alone copying the same log, and beside Python's `mcap` with NumPy on a twentieth of it.
# Usage: benches/peers/replay/run.sh [LOG.mcap ROBOT.toml [BYTES]]    by default examples/mini-ipanema.mcap; the log is repeated, its
# times going on, to BYTES, by default 10^9. Exits 1 if the outputs differ from Python's by more than 1e-9, or if replay is slower than half
# the copy's message rate or five times Python's. Needs 2.2 times BYTES on the disk of the target
# folder, deleted in the end, and BYTES of memory for the copy.
set -euo pipefail
if [ $# -ne 0 ] && [ $# -ne 2 ] && [ $# -ne 3 ]; then
    echo "usage: $0 [LOG.mcap ROBOT.toml [BYTES]]" >&2
    exit 2
fi
log=$(realpath "${1:-$(dirname "$0")/../../../examples/mini-ipanema.mcap}")
robot=$(realpath "${2:-$(dirname "$0")/../../../examples/mini-ipanema.toml}")
bytes=${3:-1000000000}
cd "$(dirname "$0")/../../.."
target=${CARGO_TARGET_DIR:-target}
. benches/peers/venv.sh
build=$(mktemp -d "$target/peers/replay.XXXXXX")
trap 'rm -rf "$build"' EXIT
cargo build --quiet --release -p fric-cli --bin fric-cli --example replay_peer

peer="$target/release/examples/replay_peer"
"$peer" repeat "$log" "$bytes" "$build/log.mcap"
"$peer" repeat "$log" $((bytes / 20)) "$build/part.mcap"
replay() { "$target/release/fric-cli" replay "$1" --model "$robot" -o "$2" --force > /dev/null 2> "$build/warnings.txt"; }
# `timed NAME COMMAND…`: time and processor time of a process, s, on a line each in times-NAME.txt.
timed() {
    { TIMEFORMAT='%R %U %S'; time "${@:2}" > "$build/$1.txt" 2> "$build/errors.txt"; } 2>> "$build/times-$1.txt" ||
        { cat "$build/errors.txt" "$build/warnings.txt" >&2; exit 1; }
}
median() { sort -g | awk '{ of[NR] = $1 } END { print of[int((NR + 1) / 2)] }'; }
wall() { cut -d ' ' -f 1 "$build/times-$1.txt" | median; }
copying() { median < "$build/seconds-$1.txt"; }
processor() { awk '{ print $2 + $3 }' "$build/times-$1.txt" | median; }
value() { awk -v key="$2" '$1 == key { print $2 }' "$build/$1.txt"; }

# In turns, so that what else the machine does meets all of them.
for _ in 1 2 3; do
    timed replay replay "$build/log.mcap" "$build/out.mcap"
    timed copy "$peer" copy "$build/log.mcap" "$build/out.mcap" default
    timed copy-alone "$peer" copy "$build/log.mcap" "$build/out.mcap" 0
    # Without reading the log into memory, which a copy could do otherwise.
    for name in copy copy-alone; do value $name seconds >> "$build/seconds-$name.txt"; done
done
replay "$build/part.mcap" "$build/ours.mcap"
"$python" benches/peers/replay/numpy_replay.py "$build/part.mcap" "$robot" "$build/out.mcap" "$build/ours.mcap" \
    > "$build/numpy.txt" || { cat "$build/numpy.txt" >&2; exit 1; }
grep -v '^\(messages\|seconds\|processor_seconds\) ' "$build/numpy.txt"

messages=$(value copy messages)
report() { awk -v what="$1" -v n="$2" -v s="$3" -v p="$4" 'BEGIN {
    printf "%-38s %8.0f messages/s, %6.2f s and %6.2f s of processor time per million\n", what, n / s, 1e6 * s / n, 1e6 * p / n }'; }
echo "$messages messages, $(stat -c %s "$build/log.mcap") bytes; medians of three runs in turns:"
report "fric-cli replay -o" "$messages" "$(wall replay)" "$(processor replay)"
report "mcap crate copying, as it comes" "$messages" "$(copying copy)" "$(processor copy)"
report "mcap crate copying, no threads" "$messages" "$(copying copy-alone)" "$(processor copy-alone)"
report "Python, $(value numpy messages) messages" "$(value numpy messages)" "$(value numpy seconds)" "$(value numpy processor_seconds)"
awk -v n="$messages" -v ours="$(wall replay)" -v copy="$(copying copy)" -v alone="$(copying copy-alone)" \
    -v part="$(value numpy messages)" -v python="$(value numpy seconds)" 'BEGIN {
    if (alone < copy) copy = alone
    printf "message rate, ours / the faster copy: %.2f\n", copy / ours
    printf "message rate, ours / Python: %.0f\n", (n / ours) / (part / python)
    exit !(copy / ours >= 0.5 && (n / ours) / (part / python) >= 5) }'
