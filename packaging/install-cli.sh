#!/usr/bin/env bash
# Puts the command line where shell and man find it: program, manual pages, completions of bash, zsh and fish.
# Usage: install-cli.sh PROGRAM    with PREFIX and, for packages, DESTDIR in the environment
set -euo pipefail
repository=$(cd "$(dirname "$0")/.." && pwd)
program=$1
prefix=${PREFIX:-/usr/local}
case $prefix in /*) ;; *) echo "PREFIX is '$prefix'; it must be an absolute path, for example PREFIX=\"\$PWD/dist\"" >&2; exit 2 ;; esac
root=${DESTDIR:-}$prefix

share=$root/share
install -d "$root/bin" "$share/man/man1" "$share/licenses/fric" \
    "$share/bash-completion/completions" "$share/zsh/site-functions" "$share/fish/vendor_completions.d"
install -m 755 "$program" "$root/bin/fric-cli"
install -m 644 "$repository"/{LICENSE,LICENSE-APACHE,LICENSE-MIT,THIRD-PARTY.txt} "$share/licenses/fric"
"$program" man "$share/man/man1" --force --quiet
"$program" completions bash > "$share/bash-completion/completions/fric-cli"
"$program" completions zsh > "$share/zsh/site-functions/_fric-cli"
"$program" completions fish > "$share/fish/vendor_completions.d/fric-cli.fish"
echo "fric-cli is in $root/bin, its manual pages and completions are in $share"
