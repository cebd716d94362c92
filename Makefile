# Two words for a stranger: `make demo` and `make test`. Both make .venv when it is missing.
PYTHON ?= python3
BIN := .venv/bin
READY := .venv/.ready
LEARN := .venv/.learn

.PHONY: demo test check format lint types arrows bench clean

demo: $(READY)            ## a simulated scan through the whole chain, then the report
	$(BIN)/prunus demo -o prunus-out/demo

test: $(READY) $(LEARN)   ## the tests, import arrows and laws among them
	$(BIN)/python -m pytest

check: format lint types test   ## all that CI asks for

format: $(READY)
	$(BIN)/ruff format --check .

lint: $(READY)
	$(BIN)/ruff check .

types: $(READY) $(LEARN)
	$(BIN)/mypy

arrows: $(READY)          ## the floor plan alone (also part of `make test`)
	$(BIN)/python -m pytest tests/test_import_arrows.py

bench: $(READY)           ## measure; figures go to the screen
	$(BIN)/python -m bench

$(READY): pyproject.toml
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet -e ".[dev]"
	touch $(READY)

$(LEARN): $(READY)        ## what training needs; a build of torch for the CPU where there is one
	$(BIN)/python -m pip install --quiet torch==2.13.0
	$(BIN)/python -m pip install --quiet -e ".[train]"
	touch $(LEARN)

clean:
	rm -rf .venv prunus-out
