# Two commands for a fresh machine: `make paper` and `make test`.
PYTHON ?= python3
CORES ?= 2
export PATH := $(CURDIR)/.venv/bin:$(PATH)

.PHONY: paper smoke test test-parts test-workflow test-kill reproduce-twice processors slurm \
	test-slurm docs layers scaling fault-matrix fuzz loop-benchmark benchmark benchmark-all clean

paper: .venv/.ready
	snakemake --cores $(CORES) all

smoke: .venv/.ready
	snakemake --cores $(CORES) smoke

test: .venv/.ready
	ruff check .
	ruff format --check .
	snakefmt --check Snakefile workflow/rules
	snakemake --lint
	lint-imports
	$(MAKE) --no-print-directory types
	@shared=$$(mktemp -d) && trap 'rm -rf "$$shared"' EXIT && FPRC_SMOKED=$$shared \
	  $(MAKE) --no-print-directory --jobs 2 --output-sync test-parts test-workflow

types: .venv/.ready
	mypy

# two processes of about the same length, which share one smoke run
APART = tests/workflow/test_targets.py tests/workflow/test_hardware.py \
	tests/workflow/test_twice.py tests/workflow/test_bad_input.py tests/workflow/test_disk.py

test-parts:
	pytest --ignore tests/workflow $(PYTEST) && pytest $(APART) $(PYTEST)

test-workflow:
	pytest tests/workflow $(APART:%=--ignore %) $(PYTEST)

# twenty kills at random moments, ten minutes or more; `make test` makes two
test-kill: .venv/.ready
	FPRC_KILLS=20 pytest tests/workflow/test_kill.py

# the last commit in two cold builds, compared byte by byte: some ten minutes on two cores
reproduce-twice: .venv/.ready
	python tests/twice.py

# the last commit as older processors compute it, small settings: some ten minutes on one core
processors: .venv/.ready
	python tests/twice.py --smoke --processors

# What tests/workflow/test_slurm.py needs, where it can be had; without it that test is skipped.
# The plugin asks Slurm at every start of Snakemake, so it has a folder of its own.
slurm: .venv/.ready
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
test-slurm: slurm
	SLURM_TARGETS=all pytest tests/workflow/test_slurm.py

scaling: .venv/.ready
	snakemake --cores $(CORES) scaling_page

docs: .venv/.ready
	snakemake --cores $(CORES) readme calibration_page

# the picture of the packages in CONTRIBUTING.md, from the imports
layers: .venv/.ready
	python tests/layers.py

# what comes of each fault of the real rig, of files and of settings: docs/faults.md
fault-matrix: .venv/.ready
	pytest tests/faults --write-matrix

# damaged files through the commands that read them, some quarter of an hour on two cores; fewer
# with CASES=500, others with SEED=2, the counts as a page with PAGE=docs/fuzz.md
CASES ?= 10000
SEED ?= 1
fuzz: .venv/.ready
	python tests/fuzz --cases $(CASES) --seed $(SEED) $(PAGE:%=--write %)

# how punctual the real rig's loop is on this computer
loop-benchmark: .venv/.ready
	python tests/faults/benchmark_loop.py

# speed beside other libraries, growth, time by rule: docs/performance.md
benchmark: .venv/.ready
	python -m pip install --quiet --disable-pip-version-check --constraint environment.txt --editable '.[benchmark]'
	snakemake --cores $(CORES) --forcerun rule_times -- benchmark performance_page

# the whole workflow beside the same rules plainly written: half an hour or so
benchmark-all: benchmark
	snakemake --cores $(CORES) --forcerun measure_all -- results/benchmark/all.json
	snakemake --cores $(CORES) --forcerun benchmark_table -- benchmark performance_page

.venv/.ready: environment.txt pyproject.toml
	$(PYTHON) -c 'import sys; v = sys.version_info[:2]; (3, 11) <= v <= (3, 13) or sys.exit(f"fprc needs Python 3.11, 3.12 or 3.13, this is {v[0]}.{v[1]}; use: make PYTHON=python3.12 ...")'
	$(PYTHON) -m venv .venv
	python -m pip install --quiet --disable-pip-version-check --requirement environment.txt
	python -m pip install --quiet --disable-pip-version-check --no-deps --editable .
	touch $@

# .snakemake stays: without its records, results of older code would pass for finished
clean:
	rm -rf .venv
