#!/usr/bin/env bash
# The identification beside scipy and numba: same log, values that agree, then the time of the fits alone.
# Usage: benches/peers/fit/run.sh [LOG.mcap ROBOT.toml]    by default a simulated run of examples/mini-ipanema.toml, about
# 50 s, with one guess for all cables in the robot file. Exits 1 if the values differ. Both get the same robot file: scipy starts
# from its values, ours from the data.
set -euo pipefail
if [ $# -ne 0 ] && [ $# -ne 2 ]; then
    echo "usage: $0 [LOG.mcap ROBOT.toml]" >&2
    exit 2
fi
log=${1:+$(realpath "$1")} robot=${2:+$(realpath "$2")}
cd "$(dirname "$0")/../../.."
target=${CARGO_TARGET_DIR:-target}
build=$target/peers/fit
mkdir -p "$build"
. benches/peers/venv.sh

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
ours() { "${@:2}" "$target/release/examples/fit" "$log" "$robot" > "$build/ours-$1.txt"; }
cables() { grep '^cable ' "$1" | sort -k 2,2; }
seconds() { awk -v key="$2" '$1 == key { print $2 }' "$1"; }

# Ours before and after: how far the two are apart tells how noisy the machine is.
ours before
ours one-core taskset -c 0
"$python" benches/peers/fit/scipy_fit.py "$log" "$robot" "$build/ours-before.txt" > "$build/scipy.txt"
ours after
grep -E '^(scipy|ours)' "$build/scipy.txt"
status=0
join -j 2 <(cables "$build/ours-before.txt") <(cables "$build/scipy.txt") | awk '
    function relative(a, b) { return (a > b ? a - b : b - a) / (b > 0 ? b : -b) }
    function most(a, b) { return a > b ? a : b }
    {
        mu = relative($3, $11)
        sigma = relative($4, $12)
        viscous = relative($5, $13)
        good += mu <= 0.001 && sigma <= 0.005 && viscous <= 0.005
        worst_mu = most(worst_mu, mu)
        worst_sigma = most(worst_sigma, sigma)
        worst_viscous = most(worst_viscous, viscous)
        evaluations += $9
    }
    END {
        printf "%d cables, ours without the warm-up: mu agrees to %.3f %%, sigma to %.3f %%, F_pv to %.3f %%\n",
            NR, 100 * worst_mu, 100 * worst_sigma, 100 * worst_viscous
        printf "ours: %d evaluations of all samples, with derivatives\n", evaluations
        exit !(NR > 0 && good == NR) }' || status=1
compare() {
    awk -v what="$1" -v ours="$2" -v scipy="$3" 'BEGIN {
        printf "%s: ours %.3f s, scipy %.3f s; ours/scipy %.2f\n", what, ours, scipy, ours / scipy }'
}
of_scipy() { seconds "$build/scipy.txt" "$1"; }
echo "with the fastest of scipy that has ended near the minimum:"
for run in before after; do
    compare "$(nproc) cores, scipy as it comes, $run" "$(seconds "$build/ours-$run.txt" seconds)" "$(of_scipy seconds)"
done
compare "processor time" "$(seconds "$build/ours-after.txt" processor_seconds)" "$(of_scipy processor_seconds)"
compare "one core" "$(seconds "$build/ours-one-core.txt" seconds)" "$(of_scipy seconds)"
compare "$(nproc) cores, scipy with as many cables at once" "$(seconds "$build/ours-after.txt" seconds)" \
    "$(of_scipy all_cores_seconds)"
echo "scipy: one pass over all samples of a cable: $(of_scipy pass_seconds) s"
if [ $status -ne 0 ]; then echo "the values differ by more than 0.1 % (mu) or 0.5 % (sigma, F_pv)" >&2; fi
exit $status
