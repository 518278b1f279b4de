#!/usr/bin/env bash
# Builds a package and prints where cargo has put one of its files: for another target or target directory that is not the usual place, and what lies
# there is older.
#
# Usage: packaging/built.sh PROFILE PACKAGE FILE    CARGO (cargo) is heeded
set -euo pipefail
profile=$1 package=$2 file=$3
messages=$(${CARGO:-cargo} build --quiet --profile "$profile" -p "$package" --message-format=json-render-diagnostics)
paths=$(grep '"reason":"compiler-artifact"' <<< "$messages" | grep -o "\"/[^\"]*/${file//./\\.}\"" | tr -d '"' | sort -u || true)
case $(grep -c . <<< "$paths") in
    1) echo "$paths" ;;
    0) echo "cargo has built no $file of $package; set build.target of cargo (CARGO_BUILD_TARGET) to a Linux target, or unset it" >&2; exit 1 ;;
    *) echo "cargo has built $file of $package for several targets; set CARGO_BUILD_TARGET to one of them" >&2; exit 1 ;;
esac
