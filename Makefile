# `make demo` and `make test` need only Python 3.11 or newer with its venv module.
PYTHON ?= python3
VENV ?= .venv
RUN := $(VENV)/bin/python -m
# The package as it is when installed, with filters/ in its place
TREE := build/lint
# Compiling kernels takes one core; tests of two files run at once
WORKERS ?= 2
TIMINGS := tests/bench/test_benchmarks.py --benchmark-storage=tests/bench/baselines \
	--benchmark-columns=min,median,rounds -W default
INSTALL := $(RUN) pip install --quiet --disable-pip-version-check

.PHONY: demo test slow sanitize numerics lint bench bench-compare bench-baseline accuracy speed gpu paraview vtk92 clean

$(VENV)/installed: pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(INSTALL) --editable .
	touch $@

$(VENV)/installed-test: $(VENV)/installed
	$(INSTALL) --editable ".[test]"
	touch $@

$(VENV)/installed-lint: $(VENV)/installed-test
	$(INSTALL) --editable ".[lint]"
	touch $@

demo: $(VENV)/installed
	$(RUN) vtkmcvr demo

test: $(VENV)/installed-test
	$(RUN) pytest -n $(WORKERS) --dist loadfile -m "not slow and not bench"

# Long statistics, and the comparison with Mitsuba where it is installed
slow: $(VENV)/installed-test
	$(RUN) pytest -n $(WORKERS) --dist loadfile -m slow

# Kernels as plain Python, where a float that overflows or divides by zero is an error; then compiled
# with bounds checks, which have a cache of their own
sanitize: $(VENV)/installed-test
	NUMBA_DISABLE_JIT=1 $(RUN) pytest tests/hard_cases/test_pure_python.py
	NUMBA_BOUNDSCHECK=1 NUMBA_CACHE_DIR=$(CURDIR)/build/bounds $(RUN) pytest -m "not slow" \
		tests/hard_cases/test_bounds.py tests/hard_cases/test_rays.py tests/physics/test_media.py \
		tests/physics/test_estimators.py tests/kernels/test_tracking.py

# The table of docs/numerics.md, written by the tests
numerics: $(VENV)/installed-test
	VTKMCVR_NUMERICS=docs/numerics.json $(RUN) pytest -m "not slow" \
		--ignore tests/hard_cases/test_page.py tests/hard_cases tests/physics/test_furnace.py
	$(VENV)/bin/python tests/hard_cases/numerics_page.py

lint: $(VENV)/installed-lint
	$(RUN) ruff check .
	rm -rf $(TREE) && mkdir -p $(TREE)
	cp -r vtkmcvr $(TREE)/ && cp -r filters $(TREE)/vtkmcvr/filters
	cd $(TREE) && PYTHONPATH=. $(CURDIR)/$(VENV)/bin/lint-imports --config $(CURDIR)/pyproject.toml
	cd $(TREE) && $(CURDIR)/$(VENV)/bin/mypy --config-file $(CURDIR)/pyproject.toml

# Beside Mitsuba, VTK's own mappers and the bare look-ups, in one run; volumes from VTKMCVR_DATA
bench: $(VENV)/installed-test
	$(INSTALL) --editable ".[peers]"
	$(VENV)/bin/python tests/bench/bench_mitsuba.py
	$(VENV)/bin/python tests/bench/bench_vtk.py
	$(VENV)/bin/python tests/bench/bench_floor.py

# Timings beside those of the baseline; fails where one takes a quarter longer
bench-compare: $(VENV)/installed-test
	$(INSTALL) --editable ".[bench]"
	$(RUN) pytest -m bench $(TIMINGS) --benchmark-compare --benchmark-compare-fail=min:25%

# The baseline of this machine
bench-baseline: $(VENV)/installed-test
	$(INSTALL) --editable ".[bench]"
	$(RUN) pytest -m bench $(TIMINGS) --benchmark-save=baseline

# All checks that take a CUDA device, within ten minutes; says so where there is none
gpu: $(VENV)/installed-test
	$(INSTALL) --editable ".[cuda]"
	$(VENV)/bin/python tests/gpu -o gpu.json

# A picture inside ParaView, which apt installs where it can; says so, loudly, where it is not there
paraview: $(VENV)/installed-test
	tests/paraview/run.sh $(CURDIR)/$(VENV)/bin/python

# Tests of the filters with VTK 9.2 and without PyVista, in an environment of their own
vtk92: $(VENV)/installed-test
	tests/filters/old_vtk.sh $(CURDIR)/$(VENV)/bin/python

# docs/accuracy.md anew, in some 12 minutes on 2 quiet cores, once all kernels are compiled
accuracy: $(VENV)/installed-test
	$(INSTALL) --editable ".[peers,plot]"
	$(VENV)/bin/python tests/bench/bench_accuracy.py

# What each effect adds: docs/speed.md and docs/speed.json, from the volumes in VTKMCVR_DATA
speed: $(VENV)/installed-test
	$(VENV)/bin/python tests/bench/bench_effects.py

clean:
	rm -rf $(VENV) build dist *.egg-info
	find . -name __pycache__ -prune -exec rm -rf {} +
