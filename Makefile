# Two commands for a fresh machine: `make paper` and `make test`.
PYTHON ?= python3
CORES ?= 2
export PATH := $(CURDIR)/.venv/bin:$(PATH)
# a job is a process: what it imports is compiled once
export PYTHONDONTWRITEBYTECODE :=

.PHONY: help paper smoke quick types lint test test-kill reproduce-twice processors slurm test-slurm \
	docs layers scaling fault-matrix fuzz loop-benchmark benchmark benchmark-all clean

help:  ## what each target does
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "  %-16s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

paper: .venv/.ready  ## every table and figure of the paper, into results/
	snakemake --cores $(CORES) all

smoke: .venv/.ready  ## the same rules on small settings, into results/smoke
	snakemake --cores $(CORES) smoke

quick: .venv/.ready  ## style, types and the fast unit tests, while you work
	ruff check --quiet .
	ruff format --quiet --check .
	mypy
	FPRC_EXAMPLES=10 pytest --quiet --numprocesses $(CORES) --dist loadfile -m "not slow" tests/unit \
	  $(PYTEST)

types: .venv/.ready  ## the types of src
	mypy

lint: .venv/.ready  ## style, types, layers, the lint of the workflow
	ruff check .
	ruff format --check .
	mypy
	snakefmt --check Snakefile workflow/rules
	snakemake --lint
	lint-imports

LONGEST = tests/workflow/test_twice.py tests/workflow/test_slurm.py tests/workflow/test_kill.py

# The longest first. The third process works while the others wait: of what they start, much sleeps.
test: lint  ## everything that must be green
	@shared=$$(mktemp -d) && trap 'rm -rf "$$shared"' EXIT && FPRC_SMOKED=$$shared \
	  pytest --numprocesses 3 --dist loadfile --no-loadscope-reorder $(LONGEST) tests/workflow \
	  tests/faults tests/fuzz tests/reference tests/unit $(PYTEST)

# ten minutes or more; `make test` kills one build
test-kill: .venv/.ready  ## twenty kills at random moments of the workflow
	FPRC_KILLS=20 pytest tests/workflow/test_kill.py

# the last commit in two cold builds, compared byte by byte: some ten minutes on two cores
reproduce-twice: .venv/.ready  ## the last commit in two cold builds, compared byte by byte
	python tests/twice.py

# the last commit as older processors compute it, small settings: some ten minutes on one core
processors: .venv/.ready  ## the last commit as older processors compute it, small settings
	python tests/twice.py --smoke --processors

# What tests/workflow/test_slurm.py needs, where it can be had; without it that test is skipped.
# The plugin asks Slurm at every start of Snakemake, so it has a folder of its own.
slurm: .venv/.ready  ## what the test of Slurm needs, where it can be had
	@if python tests/slurm/one_node.py --why-not | grep -q "not installed"; then \
	  if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
	    apt-get -qq update && DEBIAN_FRONTEND=noninteractive \
	      apt-get -qq install --no-install-recommends slurm-wlm munge >/dev/null \
	      || echo "slurm: apt-get could not install slurm-wlm and munge"; \
	  else echo "slurm: neither installed nor to be installed without root and apt-get"; fi; \
	fi
	@python -m pip install --quiet --disable-pip-version-check --no-deps --upgrade \
	  --target .venv/slurm --requirement environment-slurm.txt \
	  || echo "slurm: no snakemake-executor-plugin-slurm"

# The whole smoke run through Slurm, some minutes; `make test` takes one job of each kind.
test-slurm: slurm  ## the smoke run through Slurm
	SLURM_TARGETS=all pytest tests/workflow/test_slurm.py

scaling: .venv/.ready  ## the numbers of docs/scaling.md
	snakemake --cores $(CORES) scaling_page

docs: .venv/.ready  ## the numbers and pictures of README.md and docs/calibration.md
	snakemake --cores $(CORES) readme calibration_page

# the picture of the packages in CONTRIBUTING.md, from the imports
layers: .venv/.ready  ## the picture of the packages in CONTRIBUTING.md
	python tests/layers.py

# what comes of each fault of the real rig, of files and of settings: docs/faults.md
fault-matrix: .venv/.ready  ## the tables of docs/faults.md
	pytest tests/faults --write-matrix

# damaged files through the commands that read them, some quarter of an hour on two cores; fewer
# with CASES=500, others with SEED=2, the counts as a page with PAGE=docs/fuzz.md
CASES ?= 10000
SEED ?= 1
fuzz: .venv/.ready  ## 10,000 damaged files through the commands that read them
	python tests/fuzz --cases $(CASES) --seed $(SEED) $(PAGE:%=--write %)

# how punctual the real rig's loop is on this computer
loop-benchmark: .venv/.ready  ## how punctual the real rig's loop is on this computer
	python tests/faults/benchmark_loop.py

# speed beside other libraries, growth, time by rule: docs/performance.md
benchmark: .venv/.ready  ## speed beside other libraries
	python -m pip install --quiet --disable-pip-version-check --constraint environment.txt --editable '.[benchmark]'
	snakemake --cores $(CORES) --forcerun rule_times -- benchmark performance_page

# the whole workflow beside the same rules plainly written: half an hour or so
benchmark-all: benchmark  ## the whole workflow beside the same rules plainly written
	snakemake --cores $(CORES) --forcerun measure_all -- results/benchmark/all.json
	snakemake --cores $(CORES) --forcerun benchmark_table -- benchmark performance_page

.venv/.ready: environment.txt pyproject.toml
	$(PYTHON) -c 'import sys; v = sys.version_info[:2]; (3, 11) <= v <= (3, 13) or sys.exit(f"fprc needs Python 3.11, 3.12 or 3.13, this is {v[0]}.{v[1]}; use: make PYTHON=python3.12 ...")'
	$(PYTHON) -m venv .venv
	python -m pip install --quiet --disable-pip-version-check --requirement environment.txt
	python -m pip install --quiet --disable-pip-version-check --no-deps --editable .
	touch $@

# .snakemake stays: without its records, results of older code would pass for finished
clean:  ## remove .venv
	rm -rf .venv
