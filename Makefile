# Two commands serve a fresh machine (Python 3.11+, make, pip): `make report` and `make test`.
PYTHON ?= python3
BIN := .venv/bin
RUN ?= datasets/rig3m/run04
JOBS ?= 2

.PHONY: setup setup-report lock report test plain oldest verify verify-logs verify-lines verify-rest \
	bench stability mutants lint schema site
.DEFAULT_GOAL := report

# One environment that grows: a report needs few packages, tests and checks need more, both from locked files.
# Modules are byte-compiled when they are first imported: most never are.
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-compile
LOCKED := $(PIP) --only-binary :all: --require-hashes -r
setup-report: .venv/.report
setup: .venv/.ready

.venv/.report: requirements.lock pyproject.toml
	$(PYTHON) -m venv .venv
	$(LOCKED) requirements.lock
	$(PIP) --no-build-isolation --editable .
	touch $@

.venv/.ready: requirements.lock requirements-dev.lock pyproject.toml
	$(PYTHON) -m venv .venv
	$(LOCKED) requirements-dev.lock
	$(PIP) --no-build-isolation --editable .
	touch .venv/.report $@

# Versions that are locked stay while they serve; `make lock UPGRADE=--upgrade` takes the newest.
UV := .venv/lock/bin/uv
COMPILE = $(UV) pip compile --quiet $(UPGRADE) --universal --python-version 3.11 --generate-hashes --no-annotate \
	--no-emit-index-url --custom-compile-command "make lock" pyproject.toml --group build

$(UV):
	$(PYTHON) -m venv .venv/lock
	.venv/lock/bin/python -m pip install --quiet --disable-pip-version-check uv==0.13.9

lock: $(UV)  ## write requirements.lock (what a report needs) and requirements-dev.lock (tests and checks too)
	$(COMPILE) --extra dev --output-file requirements-dev.lock
	$(COMPILE) --constraints requirements-dev.lock --output-file requirements.lock

report: setup-report  ## the main job on one run: reports/<run>/report.html
	$(BIN)/tethertest report $(RUN)

test: setup  ## the tests
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest -n $(JOBS) --dist worksteal -m "not browser and not verify"

plain: setup  ## kernels as the Python that they are written in
	NUMBA_DISABLE_JIT=1 OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest -n $(JOBS) tests/unit/kernels

# Neighbours that no bound names are the newest, and warn of what the oldest do: warnings are no errors here.
OLDEST := .venv/oldest/bin/python
oldest: $(UV)  ## the tests with the lowest versions that pyproject.toml allows
	$(PYTHON) -m venv .venv/oldest
	$(UV) pip compile --quiet --resolution lowest-direct --only-binary :all: --no-emit-index-url --python $(OLDEST) \
		pyproject.toml --extra dev --group build --output-file .venv/oldest/lowest.txt
	$(OLDEST) -m pip install --quiet --disable-pip-version-check --no-deps --no-compile -r .venv/oldest/lowest.txt
	$(OLDEST) -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	NUMBA_CACHE_DIR=.venv/oldest/kernels OPENBLAS_NUM_THREADS=1 $(OLDEST) -m pytest -n $(JOBS) \
		-o filterwarnings=default -m "not browser and not verify"

# the longest come first: what is left is shared out as it comes
LOGS := tests/verification/test_clock_errors.py tests/store tests/fuzz tests/hostile tests/readers \
	tests/unit/conditioning tests/verification/test_flag_rates.py
LINES := tests/unit/spectra tests/jobs tests/verification/test_line_calibration.py tests/verification/test_wave_energy.py
PROOF := OPENBLAS_NUM_THREADS=1 $(BIN)/python -m reports
VERIFY := OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest -n $(JOBS) --dist worksteal -m verify

verify: verify-logs verify-lines verify-rest  ## the long batteries, and the campaign against its truth; writes nothing

verify-logs: setup  ## readers, hostile and damaged logs, stores, clocks, flags, gratings
	$(VERIFY) $(LOGS)

verify-lines: setup  ## the line search at its stated rates, sweeps, waves, every run's lines and events
	$(VERIFY) $(LINES)
	$(PROOF).rig3m_lines

verify-rest: setup  ## solver batteries, every run's report, stated against true errors
	$(VERIFY) $(addprefix --ignore=,$(LOGS) $(LINES))
	$(PROOF).rig3m_campaign
	$(PROOF).error_coverage

bench: setup  ## writes reports/speed_vs_error; times whole processes and reading
	$(PROOF).speed_vs_error -o reports/speed_vs_error
	$(BIN)/python tests/benchmarks/whole_processes.py
	$(BIN)/python tests/benchmarks/reading.py

stability: setup  ## writes reports/stability: runs of a million steps
	$(PROOF).stability -o reports/stability

mutants: setup  ## faults put into the package one at a time: how many the tests notice
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --editable '.[mutants]'  # one of its needs has no wheel
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m reports.mutants --jobs $(JOBS) -o reports/mutants

lint: setup  ## style, types, layers
	$(BIN)/ruff format --check
	$(BIN)/ruff check
	$(BIN)/mypy
	$(BIN)/lint-imports

FILES := run rig prototype scene
COMMANDS := report analyze across inspect solve scale ingest export new bench

schema: setup  ## write the JSON schemas of files and of what commands print, and the reference pages
	for kind in $(FILES); do $(BIN)/tethertest schema $$kind > rigs/schema/$$kind.schema.json; done
	for kind in $(COMMANDS); do $(BIN)/tethertest schema $$kind > docs/schema/$$kind.schema.json; done
	$(BIN)/python docs/reference.py

site: setup  ## docs/_build/index.html, of the pages in docs/
	$(BIN)/python -m sphinx -q -W --keep-going -b html docs docs/_build
