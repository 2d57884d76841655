# Each target makes .venv from constraints.txt when needed; nothing else is to be installed by hand.
PYTHON ?= python3
BIN := .venv/bin
UV := $(shell command -v uv 2>/dev/null)
export OMP_NUM_THREADS := 1
# Bytecode is kept even where the caller's environment forbids it: without it half of a short command's time
# goes into compiling the same sources again.
export PYTHONDONTWRITEBYTECODE :=
# Types are checked beside the compiling of the inner loops.
ifeq ($(MAKELEVEL),0)
MAKEFLAGS += --jobs=2
endif

.PHONY: .venv demo test lint bench soak screenshots clean

## demo: Table 1 of the paper, three robots in two kitchens, every verdict saved as triples
demo: .venv/compiled
	$(BIN)/sdt table --drive omni --jobs 2 --save demo.trig

## test: lint, types, import contracts, then all tests
test: lint .venv/compiled
	$(BIN)/pytest -n auto --dist loadgroup -p no:benchmark --ignore=tests/benchmarks --ignore=tests/soak

## lint: format, rules, types and import contracts
lint: .venv/packages
	$(BIN)/ruff format --check
	$(BIN)/ruff check
	$(BIN)/pyright --threads
	$(BIN)/lint-imports

## bench: figures, never assertions on time; the JSON is kept
bench: .venv/compiled
	$(BIN)/pytest tests/benchmarks --benchmark-json=benchmark.json

## soak: whole tables with reference models, other tasks, states and drives
soak: .venv/compiled
	$(BIN)/pytest -p no:benchmark tests/soak

## screenshots: every page and report as a picture, to be looked at; needs chromium and chromium-driver
screenshots: .venv/compiled demo.trig
	$(BIN)/python -m tests.screenshots screenshots demo.trig

demo.trig: .venv/compiled
	$(MAKE) demo

.venv: .venv/compiled

.venv/packages: pyproject.toml constraints.txt
ifdef UV
	$(UV) venv --quiet --clear --python $(PYTHON) .venv
	$(UV) pip install --quiet --python $(BIN)/python -c constraints.txt -e '.[dev]'
else
	$(PYTHON) -m venv --clear .venv
	$(BIN)/python -m pip install --quiet --no-compile --disable-pip-version-check -c constraints.txt -e '.[dev]'
endif
	@touch $@

# Side by side: the inner loops are compiled once, here, so that no question waits for it (those of proofs
# by a robot that must not drive and does not come to that door, hence exit 1); and bytecode of our own
# modules, and of what servers and pages import; of packages only what is used.
.venv/compiled: .venv/packages
	{ $(BIN)/python -m compileall -q kitchens ontology predicates robots sdt_kg services && \
	  $(BIN)/python -c 'import services.http.app, services.viewer.session, services.bus.server, services.bus.client'; } & \
	$(BIN)/sdt achieve --kitchen b --robot pr2 --task open:sink_area_left_middle_drawer_main >/dev/null && \
	{ $(BIN)/sdt achieve --kitchen b --robot stretch --drive fixed --task open:iai_fridge_door >/dev/null || test $$? = 1; } && \
	wait $$!
	@touch $@

clean:
	rm -rf .venv dist build .pytest_cache .ruff_cache
