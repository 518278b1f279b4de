#!/usr/bin/env bash
# Builds the source distribution and the wheels of the Python package, and installs the wheel of this machine without Rust.
#
# Usage: packaging/wheel.sh FOLDER    where the files go; CARGO_TARGET_DIR is heeded
#
# The wheel is built from the source distribution, so that this is known to build. On Linux zig links against an old glibc, so that
# the wheels run on every distribution since 2014 (manylinux2014). What cannot be built is named.
set -euo pipefail
cd "$(dirname "$0")/.."
folder=$1
target=${CARGO_TARGET_DIR:-target}
tools=$target/wheel-tools
python=${PYTHON:-python3}
mkdir -p "$folder"
rm -f "$folder"/fric-*

[ -x "$tools/bin/maturin" ] || { "$python" -m venv "$tools" && "$tools/bin/python" -m pip install --quiet --disable-pip-version-check 'maturin>=1.9,<2' ziglang; }
# The Python of the tools has zig, which maturin asks it for.
export PATH="$PWD/$tools/bin:$PATH"
case $tools in /*) PATH="$tools/bin:$PATH" ;; esac
build() {
    maturin build --release --out "$folder" "$@"
}

if [ "$(uname -s)" = Linux ]; then
    build --sdist --zig --compatibility manylinux2014
    other=aarch64-unknown-linux-gnu
    if [ "$(uname -m)" = aarch64 ]; then other=x86_64-unknown-linux-gnu; fi
    if rustup target add "$other" >/dev/null 2>&1; then
        build --zig --compatibility manylinux2014 --target "$other"
    else
        echo "not built: a wheel for $other; rustup cannot add that target"
    fi
else
    build --sdist
fi

# A bare environment: the only programs on the path are its own.
bare=$target/wheel-bare
rm -rf "$bare"
"$python" -m venv "$bare"
bare=$(cd "$bare" && pwd)
start=$(date +%s)
PATH="$bare/bin" python -m pip install --quiet --disable-pip-version-check --no-index --no-deps --find-links "$folder" fric
end=$(date +%s)
"$bare/bin/python" -m pip install --quiet --disable-pip-version-check numpy
PATH="$bare/bin" python - <<'PYTHON'
import shutil
import fric
assert shutil.which("cargo") is None
errors = fric.replay(fric.Robot.read("examples/mini-ipanema.toml"), "examples/mini-ipanema.mcap").cable("cable1")
assert errors.after.rms_n < 0.1 * errors.before.rms_n, errors
PYTHON
PATH="$bare/bin" fric-cli replay examples/mini-ipanema.mcap >/dev/null

echo "built in $folder:"
(cd "$folder" && ls -l | awk 'NR > 1 { printf "  %-75s %5.1f MB\n", $NF, $5 / 1e6 }')
echo "installed without Rust in $((end - start)) s, and the example replayed"
