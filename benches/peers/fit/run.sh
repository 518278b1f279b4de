#!/usr/bin/env bash
# The identification beside scipy and numba: same log, values that agree, then the time of the fits alone.
# Usage: benches/peers/fit/run.sh [LOG.mcap ROBOT.toml]    by default a simulated run of examples/mini-ipanema.toml, about
# 50 s, with one guess for all cables in the robot file. Exits 1 if the values differ. Ours starts from the data, scipy
# from the robot file.
set -euo pipefail
if [ $# -ne 0 ] && [ $# -ne 2 ]; then
    echo "usage: $0 [LOG.mcap ROBOT.toml]" >&2
    exit 2
fi
log=${1:+$(realpath "$1")} robot=${2:+$(realpath "$2")}
cd "$(dirname "$0")/../../.."
target=${CARGO_TARGET_DIR:-target}
build=$target/peers/fit
requirements=benches/peers/fit/requirements.txt
mkdir -p "$build"
python3 -c 'import tomllib, ensurepip' 2>/dev/null ||
    { echo "Python 3.11 or newer with venv is missing: apt-get install python3-venv" >&2; exit 2; }
if [ ! "$build/venv/ready" -nt $requirements ]; then
    python3 -m venv "$build/venv"
    "$build/venv/bin/python" -m pip install --quiet --disable-pip-version-check -r $requirements
    touch "$build/venv/ready"
fi

cargo build --quiet --release -p fric-cli --bin fric-cli --example fit
if [ -z "$log" ]; then
    log=$build/log.mcap robot=$build/robot.toml
    "$target/release/fric-cli" simulate --model examples/mini-ipanema.toml -o "$log" --force > "$build/simulate.txt"
    # The truth is what the log was made with: nobody starts from there.
    sed 's/^friction = .*/friction = { mu = 0.02, sigma_n_per_m = 900.0, viscous_n_s_per_m = 0.2 }/' \
        examples/mini-ipanema.toml > "$robot"
fi

# BLAS threads gain nothing on four columns, and would make one worker more than one thread.
export OPENBLAS_NUM_THREADS=1
ours() { RAYON_NUM_THREADS=$1 "$target/release/examples/fit" "$log" "$robot" > "$build/ours-$2.txt"; }
theirs() { "$build/venv/bin/python" benches/peers/fit/scipy_fit.py "$log" "$robot" "$1" > "$build/scipy.txt"; }
cables() { grep '^cable ' "$1" | sort -k 2,2; }
seconds() { awk -v key="$2" '$1 == key { print $2 }' "$1"; }

status=0
threads=1
while :; do
    # Ours before and after: how far the two are apart tells how noisy the machine is.
    ours "$threads" before
    theirs "$threads"
    ours "$threads" after
    if [ "$threads" -eq 1 ]; then
        join -j 2 <(cables "$build/ours-before.txt") <(cables "$build/scipy.txt") | awk '
            function relative(a, b) { return (a > b ? a - b : b - a) / (b > 0 ? b : -b) }
            function most(a, b) { return a > b ? a : b }
            {
                mu = relative($3, $10)
                sigma = relative($4, $11)
                viscous = relative($5, $12)
                good += mu <= 0.001 && sigma <= 0.005 && viscous <= 0.005
                worst_mu = most(worst_mu, mu)
                worst_sigma = most(worst_sigma, sigma)
                worst_viscous = most(worst_viscous, viscous)
                evaluations += $8
                passes += $15
            }
            END {
                printf "%d cables: mu agrees to %.3f %%, sigma to %.3f %%, F_pv to %.3f %%\n",
                    NR, 100 * worst_mu, 100 * worst_sigma, 100 * worst_viscous
                printf "evaluations: ours %d with derivatives (last searches), scipy %d without\n", evaluations, passes
                exit !(NR > 0 && good == NR) }' || status=1
    fi
    for clock in seconds processor_seconds; do
        before=$(seconds "$build/ours-before.txt" $clock) after=$(seconds "$build/ours-after.txt" $clock)
        awk -v threads="$threads" -v clock=$clock -v before="$before" -v after="$after" \
            -v scipy="$(seconds "$build/scipy.txt" $clock)" 'BEGIN {
                printf "threads %d: %s: ours %.3f and %.3f, scipy %.3f; ours/scipy %.2f\n",
                    threads, clock, before, after, scipy, (before + after) / 2 / scipy }'
    done
    if [ "$threads" -eq "$(nproc)" ]; then break; fi
    threads=$(nproc)
done
echo "scipy: one pass over all samples of a cable: $(seconds "$build/scipy.txt" pass_seconds) s"
if [ $status -ne 0 ]; then echo "the values differ by more than 0.1 % (mu) or 0.5 % (sigma, F_pv)" >&2; fi
exit $status
