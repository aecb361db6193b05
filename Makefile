# The two commands of the README, and a few more. Everything lives in .venv/ and out/; nothing else is touched.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed

.PHONY: demo test fuzz fuzz-protocol lint types bench dist clean help

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

fuzz: $(STAMP)   ## loader, scripts, formatter and the gateway's protocol for about ten minutes, elsewhere each time
	FUZZ_FACTOR=40 $(BIN)/python -m pytest tests/fuzz -n 2 -q

fuzz-protocol: $(STAMP)  ## the gateway's protocol for ten minutes under atheris, led by coverage
	$(BIN)/pip install --quiet atheris
	$(BIN)/python -m tests.fuzz.atheris_protocol -max_total_time=600 -rss_limit_mb=1024 -max_len=8192

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
