#!/usr/bin/env bash
# Compare speed with other libraries: prints rows of docs/repeat.md.
#
# The libraries have their own folder, so that nothing else finds them. Variables can select kernels
# of BLAS that are older than the processor, which a measurement of speed does not want.
set -euo pipefail
cd "$(dirname "$0")/.."
python -m pip install --quiet --disable-pip-version-check --no-deps --upgrade \
  --target .venv/benchmark --requirement tools/benchmark.txt
PYTHONPATH=".venv/benchmark:${PYTHONPATH:-}" env -u OPENBLAS_CORETYPE -u OPENBLAS_L2_SIZE \
  python tools/benchmark.py
