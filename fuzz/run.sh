#!/usr/bin/env bash
# Fuzzes targets one after the other: fuzz/run.sh SECONDS [TARGET …], all targets if none is named.
set -euo pipefail
cd "$(dirname "$0")/.."
if [ $# -eq 0 ]; then
    echo "usage: $0 SECONDS [TARGET …]" >&2
    exit 2
fi
seconds=$1
shift
targets=("$@")
[ ${#targets[@]} -gt 0 ] || mapfile -t targets < <(cd fuzz && cargo +nightly fuzz list)

for target in "${targets[@]}"; do
  corpus=fuzz/corpus/$target
  mkdir -p "$corpus"
  case $target in
    robot_file) seeds=(fuzz/seeds/robot_file/* examples/mini-ipanema.toml) ;;
    manipulator_file) seeds=(examples/tendon-prototype.toml) ;;
    mcap) seeds=(fuzz/seeds/mcap/* tests/data/mcap-conformance/*-ch-*.mcap) ;;
    log) seeds=(fuzz/seeds/log/* fuzz/seeds/mcap/*) ;;
    table) seeds=(fuzz/seeds/table/* fuzz/seeds/mcap/*) ;;
    ros2msg | message_path) seeds=(fuzz/seeds/"$target"/*) ;;
    *) seeds=() ;;
  esac
  [ ${#seeds[@]} -eq 0 ] || cp "${seeds[@]}" "$corpus"
  dictionary=fuzz/dictionaries/$target.dict
  options=(-max_total_time="$seconds" -max_len=8192 -timeout=20 -rss_limit_mb=3000 -print_final_stats=1)
  [ ! -e "$dictionary" ] || options+=(-dict="$dictionary")
  cargo +nightly fuzz run "$target" -- "${options[@]}"
done
