#!/usr/bin/env bash
# Run the unit tests with the oldest or the newest libraries: `tools/versions.sh lowest python3.11`,
# or `newest python3.13`.
set -euo pipefail
cd "$(dirname "$0")/.."
"$2" -m venv ".venv/$1"
python=.venv/$1/bin/python
with=(--upgrade)
more=(tests/unit)
if [ "$1" = lowest ]; then
  "$python" -c 'import tomllib
needs = tomllib.load(open("pyproject.toml", "rb"))["project"]["dependencies"]
print(*(need.replace(">=", "==") for need in needs), sep="\n")' > .venv/lowest/lowest.txt
  with=(--requirement .venv/lowest/lowest.txt)
  # with old libraries, newer ones warn, and scikit-learn's checks are others
  more+=(--override-ini filterwarnings=default --ignore tests/unit/models/test_sklearn_checks.py)
fi
"$python" -m pip install --quiet --disable-pip-version-check --editable '.[workflow,test]' "${with[@]}"
"$python" -m pytest --quiet -m "not slow" "${more[@]}"
