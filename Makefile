# Two commands for a fresh machine: `make paper` and `make test`.
PYTHON ?= python3
CORES ?= 2
export PATH := $(CURDIR)/.venv/bin:$(PATH)

.PHONY: paper smoke test test-kill reproduce-twice docs fault-matrix loop-benchmark clean

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
	pytest $(PYTEST)

# twenty kills at random moments, half an hour; `make test` makes three
test-kill: .venv/.ready
	FPRC_KILLS=20 pytest tests/workflow/test_kill.py

# the last commit in two cold builds, compared byte by byte: half an hour on two cores
reproduce-twice: .venv/.ready
	python tests/twice.py

docs: .venv/.ready
	snakemake --cores $(CORES) readme calibration_page

# what comes of each fault of the real rig: docs/faults.md
fault-matrix: .venv/.ready
	pytest tests/faults --write-matrix

# how punctual the real rig's loop is on this computer
loop-benchmark: .venv/.ready
	python tests/faults/benchmark_loop.py

.venv/.ready: environment.txt pyproject.toml
	$(PYTHON) -c 'import sys; v = sys.version_info[:2]; (3, 11) <= v <= (3, 13) or sys.exit(f"fprc needs Python 3.11, 3.12 or 3.13, this is {v[0]}.{v[1]}; use: make PYTHON=python3.12 ...")'
	$(PYTHON) -m venv .venv
	python -m pip install --quiet --disable-pip-version-check --requirement environment.txt
	python -m pip install --quiet --disable-pip-version-check --no-deps --editable .
	touch $@

clean:
	rm -rf .venv .snakemake
