#!/usr/bin/env bash
# Tries the command line on other platforms than this one: on aarch64 Linux a replay has the same bits as on x86-64, and for
# Windows the program builds. Each check that lacks a tool is named as not checked.
#
# Usage: packaging/platforms.sh    PROFILE (release) and CARGO_TARGET_DIR are heeded
# On Debian it takes: apt-get install gcc-aarch64-linux-gnu libc6-dev-arm64-cross qemu-user gcc-mingw-w64-x86-64
set -euo pipefail
cd "$(dirname "$0")/.."
target=${CARGO_TARGET_DIR:-target}
profile=${PROFILE:-release}
folder=$profile
[ "$profile" != dev ] || folder=debug
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT

# Says what is missing for a check: programs, or the target in rustup.
lacks() {
    local check=$1 triple=$2
    shift 2
    for program; do
        command -v "$program" >/dev/null || { echo "not checked: $check; $program is missing"; return 0; }
    done
    rustup target add "$triple" >/dev/null 2>&1 || { echo "not checked: $check; rustup cannot add $triple"; return 0; }
    return 1
}

# Everything that a log goes through: read, interpolated, compensated, written; and a search on it.
outcome() {
    local name=$1
    shift
    "$@" replay examples/mini-ipanema.mcap -o "$place/$name.mcap" --json "$place/$name-replay.json" -q >/dev/null
    "$@" fit examples/mini-ipanema.mcap --end 12 -o "$place/$name.toml" --json "$place/$name-fit.json" -q >/dev/null
    "$@" simulate --model examples/mini-ipanema.toml --duration 3 --effect stribeck:ratio=0.5 -o "$place/$name-simulated.mcap" -q >/dev/null
    # Times of this computer and names of outputs are no results.
    python3 - "$place/$name-replay.json" "$place/$name-fit.json" <<'PYTHON'
import json, sys
for path in sys.argv[1:]:
    result = json.load(open(path, encoding="utf-8"))
    result.pop("cycle", None)
    del result["provenance"]
    json.dump(result, open(path, "w", encoding="utf-8"), indent=1)
PYTHON
}

aarch64="the bits of a replay on aarch64"
if [ "$(uname -sm)" != "Linux x86_64" ]; then
    echo "not checked: $aarch64; this is not Linux on x86-64"
elif ! lacks "$aarch64" aarch64-unknown-linux-gnu aarch64-linux-gnu-gcc qemu-aarch64; then
    cargo build --quiet --profile "$profile" -p fric-cli
    CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER=aarch64-linux-gnu-gcc cargo build --quiet --profile "$profile" -p fric-cli --target aarch64-unknown-linux-gnu
    outcome x86-64 "$target/$folder/fric-cli"
    outcome aarch64 qemu-aarch64 -L /usr/aarch64-linux-gnu "$target/aarch64-unknown-linux-gnu/$folder/fric-cli"
    for file in .mcap -replay.json -fit.json .toml -simulated.mcap; do
        cmp "$place/x86-64$file" "$place/aarch64$file" || { echo "aarch64 and x86-64 differ in $file" >&2; exit 1; }
    done
    echo "aarch64 has the bits of x86-64: a replay with its output, a fit and a simulated log"
fi

windows="the command line for Windows"
if ! lacks "$windows" x86_64-pc-windows-gnu x86_64-w64-mingw32-gcc; then
    cargo build --quiet --profile "$profile" -p fric-cli --target x86_64-pc-windows-gnu
    echo "the command line builds for x86_64-pc-windows-gnu"
fi
