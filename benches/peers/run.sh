#!/usr/bin/env bash
# The cycle beside the same equations written by hand with Eigen: same input, same numbers, then time and instructions.
# Usage: benches/peers/run.sh [--most-instructions RATIO]    exits 1 if ours/Eigen of `lumped` exceeds RATIO.
set -euo pipefail
cd "$(dirname "$0")/../.."
most=${2:-}
target=${CARGO_TARGET_DIR:-target}
build=$target/peers
mkdir -p "$build"
for tool in g++ valgrind; do
    command -v $tool >/dev/null || { echo "$tool is missing: apt-get install g++ valgrind libeigen3-dev" >&2; exit 2; }
done
eigen=${EIGEN_INCLUDE:-/usr/include/eigen3}
[ -d "$eigen/Eigen" ] || { echo "Eigen is missing: apt-get install libeigen3-dev, or set EIGEN_INCLUDE" >&2; exit 2; }

cargo build --quiet --release -p fric-core --example cycle_instructions
ours=$target/release/examples/cycle_instructions
flags="-std=c++17 -O3 -DNDEBUG -isystem $eigen -Wall -Wextra"
g++ $flags benches/peers/eigen/main.cpp -o "$build/eigen"
g++ $flags -march=native benches/peers/eigen/main.cpp -o "$build/eigen-native"
input=$build/input.txt
"$ours" input "$input"

instructions() { valgrind --tool=callgrind --callgrind-out-file=/dev/null "$@" 2>&1 | awk '/Collected/ { print $NF }'; }
per_cycle() { # COMMAND… with the rounds as last argument left off
    local one three
    one=$(instructions "$@" 1)
    three=$(instructions "$@" 3)
    echo $(((three - one) / 8192))
}
median() { sort -g | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }

status=0
for form in lumped per_pulley; do
    "$ours" output $form "$build/ours-$form.txt"
    "$build/eigen" output $form "$input" "$build/eigen-$form.txt"
    paste -d' ' "$build/ours-$form.txt" "$build/eigen-$form.txt" | awk -v form=$form '
        { for (i = 1; i <= NF / 2; i++) { d = $i - $(i + NF / 2); if (d < 0) d = -d; if (d > worst) worst = d }; count += NF / 2 }
        END { printf "%s: %d numbers agree to %.1e\n", form, count, worst; exit !(count > 0 && worst <= 1e-9) }'
    : > "$build/a" ; : > "$build/b" ; : > "$build/c"
    for _ in 1 2 3 4 5 6 7 8 9; do
        "$ours" time $form 40 >> "$build/a"
        "$build/eigen" time $form "$input" 40 >> "$build/b"
        "$build/eigen-native" time $form "$input" 40 >> "$build/c"
    done
    a=$(median < "$build/a") b=$(median < "$build/b") c=$(median < "$build/c")
    i=$(per_cycle "$ours" run $form) j=$(per_cycle "$build/eigen" run $form "$input")
    awk -v f=$form -v a="$a" -v b="$b" -v c="$c" -v i="$i" -v j="$j" 'BEGIN {
        printf "%s: ns per cycle: ours %.0f, Eigen %.0f, Eigen -march=native %.0f; ours/Eigen %.2f, ours/native %.2f\n", f, a, b, c, a / b, a / c
        printf "%s: instructions per cycle: ours %d, Eigen %d; ours/Eigen %.2f\n", f, i, j, i / j }'
    if [ "$form" = lumped ] && [ -n "$most" ] && awk -v i="$i" -v j="$j" -v m="$most" 'BEGIN { exit !(i > m * j) }'; then
        echo "more instructions than $most times Eigen's" >&2
        status=1
    fi
done
exit $status
