#!/usr/bin/env bash
# Make all results in a new clone; wheel, sdist and archive into dist/.
#
# Results of a clean clone are all of one commit. Nothing is uploaded. SMOKE=...: options for a smoke
# run; TOOLS=...: a Python that has the tools of the dependency group `release`.
set -euo pipefail
cd "$(dirname "$0")/.."
version=$(sed -n 's/^__version__ = "\(.*\)"/\1/p' src/fprc/__init__.py)
refuse() {
  echo "release: $1" >&2
  exit 1
}
test -z "$(git status --porcelain)" || refuse "uncommitted changes; commit them"
grep -q "^## $version (20" CHANGELOG.md || refuse "CHANGELOG.md has no heading '## $version (DATE)'; add it"
test -z "$(git tag --list "v$version")" || refuse "the tag v$version exists; give a newer version"
test ! -e dist || refuse "dist exists; move it away"
if [ -z "${TOOLS:-}" ]; then
  python -m venv .venv/release
  TOOLS=.venv/release/bin/python
  "$TOOLS" -m pip install --quiet --disable-pip-version-check --upgrade 'pip>=25.1'
  "$TOOLS" -m pip install --quiet --disable-pip-version-check --group release
fi
git clone --quiet . dist/clone
(
  cd dist/clone
  # shellcheck disable=SC2086
  PYTHONPATH=src snakemake --cores "${CORES:-2}" ${SMOKE:-} all
  {
    git ls-files -z
    git ls-files -z --others results data/raw ':(exclude,glob)results/**/logs/**'
  } | tar -czf "../fprc-$version-with-results.tar.gz" --null -T -
)
SOURCE_DATE_EPOCH=$(git log -1 --format=%ct) "$TOOLS" -m build --outdir dist dist/clone
"$TOOLS" -m twine check --strict dist/*.whl "dist/fprc-$version.tar.gz"
rm -rf dist/clone
