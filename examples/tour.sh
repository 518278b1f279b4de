#!/bin/sh
# A tour of five minutes: hide an effect in a simulated log, and find it again.
#
#   examples/tour.sh [DIRECTORY]      writes into DIRECTORY, by default a new one; nothing else is touched
#
# It needs `fric-cli` on the path, or `cargo` to build it. FRIC_CLI names another program.
set -eu

root=$(cd "$(dirname "$0")/.." && pwd)
place=${1:-$(mktemp -d "${TMPDIR:-/tmp}/fric-tour-XXXXXX")}
mkdir -p "$place"

if [ -n "${FRIC_CLI:-}" ]; then
    program=$FRIC_CLI
elif command -v fric-cli >/dev/null; then
    program=fric-cli
else
    cargo build --quiet --release --manifest-path "$root/Cargo.toml" -p fric-cli
    program=${CARGO_TARGET_DIR:-$root/target}/release/fric-cli
fi

cp "$root/examples/winch.toml" "$place/winch.toml"
cd "$place"

say() {
    printf '\n== %s\n' "$1"
}

run() {
    printf '\n$ fric-cli %s\n\n' "$*"
    "$program" "$@"
}

say "1. A winch, and something hidden in its log.
   winch.toml describes a test bench: one cable, two pulleys. The simulated log
   has an effect that the file does not know: more friction at low speed
   (Stribeck)."
run simulate --model winch.toml -o run.mcap --duration 24 --seed 7 --effect stribeck:ratio=0.5,velocity_m_per_s=0.02

say "2. What is in the log, and what is it good for?"
run info run.mcap

say "3. Replay: the compensator runs over the log as the control loop would.
   The file's friction helps, but an error is left that is far above the noise."
run replay run.mcap

say "4. Fit: the parameters of the model, from the same log.
   The error shrinks, but not to the noise: no value of these parameters is
   right at low and at high speed."
run fit run.mcap -o fitted.toml
run replay run.mcap --model fitted.toml

say "5. Discover: what does the model lack?
   The effect is named, with its size, its cause and the remedy on the machine."
run discover run.mcap -o extended.toml --report discovery.html

say "6. Replay again, with the extended file.
   What is left is the noise of the sensors."
run replay run.mcap --model extended.toml -o compensated.mcap --report errors.html

say "The end. Open discovery.html and errors.html in a browser; all files are in
   $place"
