# Two words for a stranger: `make demo` and `make test`. Each makes in .venv what it lacks there.
PYTHON ?= python3
BIN := .venv/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check install
PYTEST := OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n auto --maxprocesses 4 --dist loadfile
RUNS := .venv/.runs
TOOLS := .venv/.tools
LEARNS := .venv/.learns

.PHONY: demo test everything every-test check format lint types arrows wheel release bench clean

demo: $(RUNS)             ## a simulated scan through the whole chain, then the report
	$(BIN)/prunus demo -o prunus-out/demo

test: $(LEARNS)           ## the tests but the slow ones, import arrows and laws among them
	$(PYTEST) -m "not slow"
	@echo "the tests that are marked slow were left out: make check runs them"

check: format lint types every-test wheel   ## all that CI asks for

every-test: $(LEARNS)     ## the tests, the slow ones too
	$(PYTEST)

format: $(TOOLS)
	$(BIN)/ruff format --check .

lint: $(TOOLS)
	$(BIN)/ruff check .

types: $(LEARNS)
	$(BIN)/mypy

arrows: $(TOOLS)          ## the floor plan alone (also part of `make test`)
	$(BIN)/python -m pytest tests/test_import_arrows.py

wheel: $(TOOLS)           ## build it into dist/, install it alone on every Python here, use it
	$(BIN)/python .ci/wheel.py

release: check            ## all checks; what they tried lies in dist/; uploads nothing
	@ls dist
	@git diff --quiet HEAD || echo "not yet: there are changes that are not committed"
	@! grep -q "(unreleased)" CHANGELOG.md || echo "not yet: CHANGELOG.md says (unreleased)"
	@echo "nothing was uploaded; docs/releasing.md says how to"

bench: $(TOOLS)           ## measure; figures go to the screen
	$(BIN)/python -m bench

everything: $(LEARNS)     ## .venv with all that the checks need

$(RUNS): pyproject.toml
	@echo "making .venv"
	@$(PYTHON) -m venv .venv
	@echo "installing what prunus needs to run"
	@$(PIP) -e .
	@touch $(RUNS)

$(TOOLS): $(RUNS)
	@echo "installing what its developers need: tests, types, format"
	@$(PIP) -e ".[dev]"
	@touch $(TOOLS)

$(LEARNS): $(TOOLS)
	@echo "installing what training needs: torch, which is large"
	@$(PIP) torch==2.13.0
	@$(PIP) -e ".[train]"
	@touch $(LEARNS)

clean:
	rm -rf .venv prunus-out dist
