#!/usr/bin/env bash
# Build the paper twice under different conditions and compare every file.
#
# Execution times differ from build to build, so the second build gets the measurements of the first
# and is made again from there. Then every table, figure and page must have the same bytes. Logs
# contain process ids and are not compared. In the second build text that names no encoding is ASCII.
set -euo pipefail
cd "$(dirname "$0")/.."
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
for folder in build "build 1"; do git clone --quiet --no-hardlinks . "$scratch/$folder"; done
build() {
  (cd "$scratch/$1" && env PYTHONPATH=src "${@:3}" snakemake --cores "$2" all)
}
second() {
  build "build 1" 1 TZ=Pacific/Kiritimati LC_ALL=C PYTHONUTF8=0 PYTHONCOERCECLOCALE=0 PYTHONHASHSEED=4711
}
build build 4 TZ=America/St_Johns LC_ALL=C.UTF-8
second
cp "$scratch"/build/results/timing/times*.json "$scratch/build 1/results/timing"
second
for part in data results; do
  diff --recursive --brief --exclude logs "$scratch/build/$part" "$scratch/build 1/$part"
done
echo "all files have the same bytes"
