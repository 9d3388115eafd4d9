# Two commands for a fresh machine: `make paper` and `make test`.
PYTHON ?= python3
CORES ?= 2
STUDIES = snakemake --cores $(CORES) --snakefile workflow/studies/Snakefile
export PATH := $(CURDIR)/.venv/bin:$(PATH)
# each job is a new process: let Python cache the compiled modules for the next one
export PYTHONDONTWRITEBYTECODE :=

.PHONY: help paper smoke quick style fast types kernels lint site tests faults test damage test-kill reproduce-twice \
	slurm slurm-programs test-slurm chromium docs check lowest newest fault-matrix fuzz loop-benchmark benchmark \
	recordings container test-container release release-tools test-release clean

help:  ## list the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "  %-16s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

paper: .venv/.ready  ## every table and figure of the paper, into results/
	snakemake --cores $(CORES) all

smoke: .venv/.ready  ## the same rules with small settings, into results/smoke
	snakemake --cores $(CORES) --workflow-profile smoke all

quick: .venv/.ready  ## style, types and the paper's fast unit tests, side by side, while you work
	@$(MAKE) --no-print-directory --jobs 2 style fast

style: types
	ruff check .
	ruff format --check .

# Nothing of the paper imports the studies: pytest -m "not slow" tests/unit/studies
fast: .venv/.ready
	FPRC_EXAMPLES=10 $(ONE_THREAD) pytest --quiet --numprocesses $(CORES) --dist loadfile \
	  -m "not slow" tests/unit --ignore tests/unit/studies $(PYTEST)

types: .venv/.ready  ## type-check src
	mypy

lint: style  ## style, types, layers, workflow lint
	snakefmt --check Snakefile workflow
	snakemake --lint
	snakemake --lint --snakefile workflow/studies/Snakefile
	lint-imports

# Else the processes of the tests and of the site, which begin together, would each compile them.
kernels: .venv/.ready  ## compile the functions that numba compiles, for all that runs later
	$(ONE_THREAD) python tools/kernels.py

site: kernels  ## build the documentation site into docs/_build/html, with its examples run
	sphinx-build -W --keep-going -q docs docs/_build/html

test: lint site tests faults  ## everything that must pass

# First what takes long: test_twice.py begins the shared smoke run, and the next four files do not
# wait for it. Files, because pytest drops a file whose folder is named too.
FIRST = $(addprefix tests/, workflow/test_twice.py workflow/test_slurm.py fuzz/test_fuzz.py \
  workflow/test_wheel.py workflow/test_targets.py workflow/test_smoke.py workflow/test_kill.py)
LATER = $(filter-out $(FIRST), $(wildcard tests/workflow/test_*.py tests/fuzz/test_*.py))

# Several processes with several threads each would wait for each other, for instance trees for a minute.
ONE_THREAD = OMP_NUM_THREADS=1

# Four processes, because tests often wait for programs that they start, and for Slurm.
tests: kernels  ## the tests, without those of faults
	@shared=$$(mktemp -d) && trap 'rm -rf "$$shared"' EXIT && FPRC_SMOKED=$$shared \
	  $(ONE_THREAD) pytest --numprocesses 4 --dist loadfile --no-loadscope-reorder $(FIRST) $(LATER) \
	  tests/reference tests/unit $(PYTEST)

# One process, because docs/faults.md is compared with what all of them found.
faults: kernels  ## the tests of faults, most of them in real time: three minutes
	$(ONE_THREAD) pytest tests/faults $(PYTEST)

test-kill: .venv/.ready  ## kill the workflow at twenty random moments: ten minutes or more
	FPRC_KILLS=20 pytest tests/workflow/test_kill.py

reproduce-twice: .venv/.ready  ## compare two cold builds byte by byte: ten minutes on two cores
	python tools/twice.py

# Without Slurm, tests/workflow/test_slurm.py is skipped. The plugin has its own folder because, once
# installed, it calls Slurm at every start of Snakemake.
slurm: slurm-programs .venv/.ready  ## install Slurm for its test, as root on Debian
	@python -m pip install --quiet --disable-pip-version-check --no-deps --upgrade \
	  --target .venv/slurm --requirement environment-slurm.txt \
	  || echo "slurm: no snakemake-executor-plugin-slurm"

slurm-programs:
	@if $(PYTHON) tests/slurm/one_node.py --why-not | grep -q "not installed"; then \
	  $(call install,slurm-wlm munge); fi

# Without Chromium, the tests of tests/workflow/test_report.py that need a browser are skipped.
chromium:  ## install Chromium for the tests of the report page, as root on Debian
	@command -v chromium >/dev/null || command -v chromium-browser >/dev/null || { $(call install,chromium); }

# One after another, because apt-get has a lock; what cannot be installed is no error.
define install
if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
  flock /var/lib/apt sh -c 'apt-get -qq update && DEBIAN_FRONTEND=noninteractive \
    apt-get -qq install --no-install-recommends $(1) >/dev/null' \
    || echo "apt-get could not install $(1)"; \
else echo "$(1): not installed; installing it needs root and apt-get"; fi
endef

test-slurm: slurm  ## the smoke run through Slurm; `make test` runs one job of each kind
	SLURM_TARGETS=all pytest tests/workflow/test_slurm.py

recordings: .venv/.ready  ## evaluate the recordings of docs/chamber.md: DATASETS=folder with the public ones
	python tools/recordings.py $(DATASETS)

docs: .venv/.ready  ## update numbers and pictures in README.md and docs/
	$(STUDIES) readme calibration_page beyond_page drift_page

check: .venv/.ready  ## compare verdicts and pictures with what is declared
	$(STUDIES) check

fault-matrix: .venv/.ready  ## inject faults and write the outcomes to docs/faults.md
	pytest tests/faults --write-matrix

# EXAMPLES=100: fewer files.
EXAMPLES ?= 2000
fuzz: .venv/.ready  ## run the commands on some 14,000 damaged files: half an hour; other files each time
	FPRC_EXAMPLES=$(EXAMPLES) pytest --numprocesses $(CORES) --dist load tests/fuzz $(PYTEST)

# With old libraries, newer ones warn, and scikit-learn's checks are others.
OLDEST ?= python3.11
lowest:  ## run the unit tests with the oldest Python and libraries allowed: OLDEST=python3.11
	$(OLDEST) -m venv .venv/lowest
	.venv/lowest/bin/python -c 'import tomllib; \
	  needs = tomllib.load(open("pyproject.toml", "rb"))["project"]["dependencies"]; \
	  print(*(need.replace(">=", "==") for need in needs), sep="\n")' > .venv/lowest/lowest.txt
	.venv/lowest/bin/python -m pip install --quiet --disable-pip-version-check \
	  --requirement .venv/lowest/lowest.txt --editable '.[workflow,test]'
	.venv/lowest/bin/python -m pytest --quiet -m "not slow" --override-ini filterwarnings=default \
	  --ignore tests/unit/models/test_sklearn_checks.py tests/unit $(PYTEST)

NEWEST ?= python3.13
newest:  ## run the unit tests with the newest Python and libraries: NEWEST=python3.13
	$(NEWEST) -m venv .venv/newest
	.venv/newest/bin/python -m pip install --quiet --disable-pip-version-check --upgrade \
	  --editable '.[workflow,test]'
	.venv/newest/bin/python -m pytest --quiet -m "not slow" tests/unit $(PYTEST)
	.venv/newest/bin/python -m pytest --quiet tests/unit/models/test_sklearn_checks.py

damage: .venv/.ready  ## damage every byte of small logs; CI damages one of 23
	FPRC_EXAMPLES=200 pytest -m slow tests/unit/logs

loop-benchmark: .venv/.ready  ## measure the timing of the real rig's loop on this computer
	python tests/faults/benchmark_loop.py

# The libraries have their own folder, so that nothing else finds them. Variables can select kernels of
# BLAS that are older than the processor, which a measurement of speed does not want.
benchmark: .venv/.ready  ## compare speed with other libraries, for docs/running.md: some minutes
	python -m pip install --quiet --disable-pip-version-check --no-deps --upgrade \
	  --target .venv/benchmark --requirement tools/benchmark/requirements.txt
	PYTHONPATH=".venv/benchmark:$$PYTHONPATH" env -u OPENBLAS_CORETYPE -u OPENBLAS_L2_SIZE \
	  python -m tools.benchmark.speed

# The file pins everything, so there is nothing to resolve, and several processes can install it. pip
# would compile on one processor, and the tests of the libraries too.
.venv/.ready: environment.txt pyproject.toml
	$(PYTHON) -c 'import sys; v = sys.version_info[:2]; (3, 11) <= v <= (3, 13) or sys.exit(f"fprc needs Python 3.11, 3.12 or 3.13, this is {v[0]}.{v[1]}; use: make PYTHON=python3.12 ...")'
	$(PYTHON) -m venv .venv
	grep -v '^#' environment.txt | xargs -P $(CORES) -n 21 \
	  python -m pip install --quiet --disable-pip-version-check --no-compile --no-deps
	python -m pip install --quiet --disable-pip-version-check --no-deps --editable .
	python -m pip check
	-python -m compileall -q -j $(CORES) -x '/tests?/' .venv/lib
	touch $@

# Docker counts only if its daemon answers. BASE=...: another image with Debian and Python 3.11 to 3.13
container:  ## build the image of the Containerfile with podman, docker or buildah
	@for engine in podman docker buildah; do \
	  if $$engine info >/dev/null 2>&1; then \
	    echo "container: building fprc:latest with $$engine"; \
	    exec $$engine build --file Containerfile --tag fprc $(BASE:%=--build-arg BASE=%) .; \
	  fi; \
	done; \
	echo "container: no podman, docker or buildah that answers; install one of them, or start docker" >&2; \
	exit 1

test-container: .venv/.ready  ## build the image and run it as a user without a home: ten minutes
	FPRC_CONTAINER=1 BASE=$(BASE) pytest tests/workflow/test_container.py

# Results of a clean clone are all of one commit. Nothing is uploaded. SMOKE=...: options for a smoke run
VERSION = $(shell sed -n 's/^__version__ = "\(.*\)"/\1/p' src/fprc/__init__.py)
release: .venv/.ready release-tools  ## make all results in a new clone; wheel, sdist and archive into dist/
	@test -z "$$(git status --porcelain)" || { echo "release: uncommitted changes; commit them" >&2; exit 1; }
	@grep -q "^## $(VERSION) (20" CHANGELOG.md || \
	  { echo "release: CHANGELOG.md has no heading '## $(VERSION) (DATE)'; add it" >&2; exit 1; }
	@test -z "$$(git tag --list v$(VERSION))" || \
	  { echo "release: the tag v$(VERSION) exists; give a newer version" >&2; exit 1; }
	@test ! -e dist || { echo "release: dist exists; move it away" >&2; exit 1; }
	git clone --quiet . dist/clone
	cd dist/clone && PYTHONPATH=src snakemake --cores $(CORES) $(SMOKE) all
	cd dist/clone && { git ls-files -z; git ls-files -z --others results data/raw \
	  ':(exclude,glob)results/**/logs/**'; } | tar -czf ../fprc-$(VERSION)-with-results.tar.gz --null -T -
	SOURCE_DATE_EPOCH=$$(git log -1 --format=%ct) .venv/release/bin/python -m build --outdir dist dist/clone
	.venv/release/bin/python -m twine check --strict dist/*.whl dist/fprc-$(VERSION).tar.gz
	rm -rf dist/clone

test-release: .venv/.ready release-tools  ## build a release of a smoke run with the real tools
	pytest tests/workflow/test_release.py

release-tools:
	$(PYTHON) -m venv .venv/release
	.venv/release/bin/python -m pip install --quiet --disable-pip-version-check --upgrade 'pip>=25.1'
	.venv/release/bin/python -m pip install --quiet --disable-pip-version-check --group release

# .snakemake stays: without its records, Snakemake would treat results of older code as finished
clean:  ## remove .venv
	rm -rf .venv
