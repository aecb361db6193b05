# The two commands of the README, and a few more. Everything lives in .venv/ and out/; nothing else is touched.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed

.PHONY: demo test fuzz fuzz-by-coverage lint types bench dist clean help

help:            ## what there is to make
	@grep -E '^[a-z-]+:.*##' Makefile | sed -E 's/:.*##/  -/'

$(STAMP): pyproject.toml requirements-dev.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "pluto_bt needs Python 3.11 or newer; make PYTHON=python3.12 …")'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/pip install --quiet --requirement requirements-dev.txt
	$(BIN)/pip install --quiet --no-deps --editable .
	@touch $(STAMP)

demo: $(STAMP)   ## set everything up and run a mission in a world, with summary and picture
	@mkdir -p out
	$(BIN)/pluto run patrol.xml --world yard.xml --port goals="$(GOALS)" --plot out/demo.png
	@echo "the picture is out/demo.png"

GOALS ?= 8,3;13.5,3;10.5,8;2,3.5

test: $(STAMP)   ## set everything up and run all tests
	$(BIN)/python -m pytest -n 2 -q

fuzz: $(STAMP)   ## loader, scripts and formatter for about ten minutes, elsewhere each time, then led by coverage
	FUZZ_FACTOR=40 $(BIN)/python -m pytest tests/fuzz -n 2 -q
	$(MAKE) fuzz-by-coverage FUZZ_SECONDS=300

fuzz-by-coverage: $(STAMP)  ## the same led by coverage (atheris), FUZZ_SECONDS each; what is learnt stays in out/fuzz
	$(BIN)/pip install --quiet 'atheris>=3'
	@mkdir -p out/fuzz/missions out/fuzz/scripts out/fuzz/protocol
	$(BIN)/python -m tests.fuzz.by_coverage missions out/fuzz/missions -max_total_time=$(FUZZ_SECONDS)
	$(BIN)/python -m tests.fuzz.by_coverage scripts out/fuzz/scripts -max_total_time=$(FUZZ_SECONDS)
	$(BIN)/python -m tests.fuzz.by_coverage protocol out/fuzz/protocol -max_total_time=$(FUZZ_SECONDS) -rss_limit_mb=1024

FUZZ_SECONDS ?= 30

lint: $(STAMP)   ## ruff
	$(BIN)/ruff check .

types: $(STAMP)  ## mypy --strict
	$(BIN)/mypy

bench: $(STAMP)  ## the benchmarks, as ratios
	$(BIN)/pluto bench

dist: $(STAMP)   ## a wheel and a source archive in dist/
	$(BIN)/python -m build --quiet --outdir dist .

clean:           ## remove what make made
	rm -rf $(VENV) out build dist *.egg-info .pytest_cache .mypy_cache .ruff_cache .hypothesis
	find . -name __pycache__ -type d -prune -exec rm -rf {} +
