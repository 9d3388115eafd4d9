# Two commands for a fresh machine: `make paper` and `make test`. What is not here is in .ci/ and tools/.
PYTHON ?= python3
CORES ?= 2
STUDIES = snakemake --cores $(CORES) --snakefile workflow/studies/Snakefile
# Several processes with several threads each would wait for each other.
ONE_THREAD = OMP_NUM_THREADS=1
export PATH := $(CURDIR)/.venv/bin:$(PATH)
# each job is a new process: let Python cache the compiled modules for the next one
export PYTHONDONTWRITEBYTECODE :=
.PHONY: help paper smoke quick style fast lint test tests site docs check clean

help:  ## list the targets
	@awk -F ':.*## ' '/^[a-z ]+:.*## / {printf "  %-14s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

paper: .venv/.ready  ## every table and figure of the paper, into results/
	snakemake --cores $(CORES) all

smoke: .venv/.ready  ## the same rules with small settings, into results/smoke
	snakemake --cores $(CORES) --workflow-profile smoke all

quick: .venv/.ready  ## style, types and the fast unit tests side by side, while you work
	@$(MAKE) --no-print-directory --jobs 2 style fast

style: .venv/.ready
	mypy
	ruff check .
	ruff format --check .

fast: .venv/.ready  # nothing of the paper imports the studies
	FPRC_EXAMPLES=10 $(ONE_THREAD) pytest --quiet --numprocesses $(CORES) --dist loadfile \
	  -m "not slow" tests/unit --ignore tests/unit/studies $(PYTEST)

lint: style  ## style, types, layers, workflow lint
	snakefmt --check Snakefile workflow
	snakemake --lint
	snakemake --lint --snakefile workflow/studies/Snakefile
	lint-imports

test: lint site tests  ## everything that must pass: ten minutes or more

# Four processes, because tests often wait for programs. Faults in one: their clocks want a processor.
tests: .venv/.ready
	@shared=$$(mktemp -d) && trap 'rm -rf "$$shared"' EXIT && FPRC_SMOKED=$$shared $(ONE_THREAD) \
	  pytest --numprocesses 4 --dist loadfile --no-loadscope-reorder \
	  tests/workflow tests/fuzz tests/reference tests/unit $(PYTEST)
	$(ONE_THREAD) pytest tests/faults $(PYTEST)

site: .venv/.ready  ## the documentation, into docs/_build/html, with its examples run
	sphinx-build -W --keep-going -q docs docs/_build/html

docs: .venv/.ready  ## update numbers and pictures in README.md and docs/
	$(STUDIES) readme beyond_page drift_page

check: .venv/.ready  ## compare verdicts and README.md with what was built
	$(STUDIES) check

clean:  ## remove .venv; .snakemake stays: without it results of older code would count as finished
	rm -rf .venv

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
