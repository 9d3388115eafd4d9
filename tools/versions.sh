#!/usr/bin/env bash
# Run the unit tests with the oldest or the newest Python and libraries: `tools/versions.sh lowest`, or newest.
# OLDEST and NEWEST name the Pythons; PYTEST has more options.
set -euo pipefail
cd "$(dirname "$0")/.."
fast=(-m pytest --quiet -m "not slow" ${PYTEST:-})
install=(-m pip install --quiet --disable-pip-version-check --editable '.[workflow,test]')
python=.venv/$1/bin/python
case $1 in
lowest)
  "${OLDEST:-python3.11}" -m venv .venv/lowest
  "$python" -c 'import tomllib
needs = tomllib.load(open("pyproject.toml", "rb"))["project"]["dependencies"]
print(*(need.replace(">=", "==") for need in needs), sep="\n")' > .venv/lowest/lowest.txt
  "$python" "${install[@]}" --requirement .venv/lowest/lowest.txt
  # with old libraries, newer ones warn, and scikit-learn's checks are others
  "$python" "${fast[@]}" --override-ini filterwarnings=default \
    --ignore tests/unit/models/test_sklearn_checks.py tests/unit
  ;;
newest)
  "${NEWEST:-python3.13}" -m venv .venv/newest
  "$python" "${install[@]}" --upgrade
  "$python" "${fast[@]}" tests/unit
  "$python" -m pytest --quiet tests/unit/models/test_sklearn_checks.py
  ;;
*)
  echo "usage: tools/versions.sh lowest|newest" >&2
  exit 2
  ;;
esac
