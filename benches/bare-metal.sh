#!/usr/bin/env bash
# Code size and worst stack use of `Compensator::step_into` for eight cables on a Cortex-M4F: read from the linked program.
set -euo pipefail
cd "$(dirname "$0")/.."
machine=thumbv7em-none-eabihf
target=$(realpath -m "${CARGO_TARGET_DIR:-target}")/bare-metal
rustup target add $machine >/dev/null 2>&1 || { echo "rustup cannot add $machine" >&2; exit 2; }
unset CARGO_ENCODED_RUSTFLAGS
(cd benches/bare-metal && CARGO_TARGET_DIR=$target RUSTFLAGS="-C link-arg=--entry=step -C link-arg=--gc-sections" \
    cargo build --quiet --locked --release --target $machine)
python3 benches/bare_metal.py "$target/$machine/release/fric-bare-metal"
