#!/usr/bin/env bash
# The cycle beside the same equations written by hand in C++ with Eigen, and in Python with numba: same input, same numbers, then time
# and instructions. Usage: benches/peers/run.sh
# Exits 1 if the numbers differ, if ours is not twice as fast as Eigen with both built for this machine, or if `per_pulley` takes
# more than twice as long as `lumped`.
set -euo pipefail
cd "$(dirname "$0")/../.."
target=${CARGO_TARGET_DIR:-target}
build=$target/peers
mkdir -p "$build"
for tool in g++ valgrind; do
    command -v $tool >/dev/null || { echo "$tool is missing: apt-get install g++ valgrind libeigen3-dev" >&2; exit 2; }
done
eigen=${EIGEN_INCLUDE:-/usr/include/eigen3}
[ -d "$eigen/Eigen" ] || { echo "Eigen is missing: apt-get install libeigen3-dev, or set EIGEN_INCLUDE" >&2; exit 2; }
. benches/peers/venv.sh

unset CARGO_ENCODED_RUSTFLAGS
RUSTFLAGS="" cargo build --quiet --release -p cycle-instructions
RUSTFLAGS="-C target-cpu=native" CARGO_TARGET_DIR=$target/native cargo build --quiet --release -p cycle-instructions
flags="-std=c++17 -O3 -DNDEBUG -isystem $eigen -Wall -Wextra"
g++ $flags benches/peers/eigen/main.cpp -o "$build/eigen"
g++ $flags -march=native benches/peers/eigen/main.cpp -o "$build/eigen-native"
input=$build/input.txt
"$target/release/cycle_instructions" input "$input"

# A program by its name in the tables: COMMAND FORM LAST.
program() {
    case $1 in
        ours) "$target/release/cycle_instructions" "$2" "$3" "$4" ;;
        ours-native) "$target/native/release/cycle_instructions" "$2" "$3" "$4" ;;
        numba) "$python" benches/peers/numba/cycle.py "$2" "$3" "$input" "$4" ;;
        *) "$build/$1" "$2" "$3" "$input" "$4" ;;
    esac
}
names="ours ours-native eigen eigen-native numba"
instructions() { valgrind --tool=callgrind --callgrind-out-file=/dev/null "$@" 2>&1 | awk '/Collected/ { print $NF }'; }
per_cycle() { # COMMAND… with the rounds as last argument left off
    local one two
    one=$(instructions "$@" 1)
    two=$(instructions "$@" 2)
    echo $(((two - one) / 4096))
}
median() { sort -g | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }

status=0
for form in lumped per_pulley; do
    for name in $names; do program $name output $form "$build/$name-$form.txt"; done
    cmp "$build/ours-$form.txt" "$build/ours-native-$form.txt" || status=1
    for name in eigen eigen-native numba; do
        paste -d' ' "$build/ours-$form.txt" "$build/$name-$form.txt" | awk -v form=$form -v name=$name '
            { for (i = 1; i <= NF / 2; i++) { d = $i - $(i + NF / 2); if (d < 0) d = -d; if (d > worst) worst = d }; count += NF / 2 }
            END { printf "%s: %d numbers of ours and %s agree to %.1e\n", form, count, name, worst; exit !(count > 0 && worst <= 1e-9) }' ||
            status=1
    done
    for name in $names; do : > "$build/$name.ns"; done
    # In turns, so that whatever disturbs the machine disturbs all; each gives the best of its rounds.
    for _ in $(seq "${TURNS:-9}"); do
        for name in $names; do program $name time $form 40 >> "$build/$name.ns"; done
    done
    echo "$form: ns per cycle, median of the turns: $(for name in $names; do printf '%s %.0f  ' $name "$(median < "$build/$name.ns")"; done)"
    # Ratios within a turn, then their median.
    for pair in "ours eigen" "ours-native eigen-native" "ours eigen-native" "ours numba"; do
        read -r one other <<< "$pair"
        ratio=$(paste "$build/$one.ns" "$build/$other.ns" | awk '{ print $1 / $2 }' | median)
        printf '%s: %s/%s %.2f\n' $form "$one" "$other" "$ratio"
        if [ "$pair" = "ours-native eigen-native" ] && awk -v r="$ratio" 'BEGIN { exit !(r > 0.5) }'; then
            echo "$form: not twice as fast as Eigen" >&2
            status=1
        fi
    done
    for name in ours ours-native; do cp "$build/$name.ns" "$build/$name-$form.ns"; done
    echo "$form: instructions per cycle for baseline x86-64: ours $(per_cycle "$target/release/cycle_instructions" run $form)," \
        "Eigen $(per_cycle "$build/eigen" run $form "$input")"
done
for name in ours ours-native; do
    ratio=$(paste <(sort -g "$build/$name-per_pulley.ns") <(sort -g "$build/$name-lumped.ns") | awk '{ print $1 / $2 }' | median)
    printf '%s: per_pulley/lumped %.2f\n' $name "$ratio"
    if awk -v r="$ratio" 'BEGIN { exit !(r > 2) }'; then
        echo "$name: per_pulley takes more than twice as long as lumped" >&2
        status=1
    fi
done
exit $status
