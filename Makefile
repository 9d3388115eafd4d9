# Two commands for a fresh machine: `make paper` and `make test`.
PYTHON ?= python3
CORES ?= 2
export PATH := $(CURDIR)/.venv/bin:$(PATH)

.PHONY: paper smoke test docs benchmark clean

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

docs: .venv/.ready
	snakemake --cores $(CORES) readme calibration_page

benchmark: .venv/.ready
	python -m pip install --quiet --disable-pip-version-check --constraint environment.txt --editable '.[benchmark]'
	snakemake --cores $(CORES) --forcerun rule_times -- benchmark performance_page

.venv/.ready: environment.txt pyproject.toml
	$(PYTHON) -c 'import sys; v = sys.version_info[:2]; (3, 11) <= v <= (3, 13) or sys.exit(f"fprc needs Python 3.11, 3.12 or 3.13, this is {v[0]}.{v[1]}; use: make PYTHON=python3.12 ...")'
	$(PYTHON) -m venv .venv
	python -m pip install --quiet --disable-pip-version-check --requirement environment.txt
	python -m pip install --quiet --disable-pip-version-check --no-deps --editable .
	touch $@

clean:
	rm -rf .venv .snakemake
