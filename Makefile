# `make run` shows the tool at work, `make test` proves it; both set up what they need in .venv.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin

.PHONY: run test setup clean

run: setup
	$(BIN)/tisserand build scenes/free_beam_mean.toml scenes/free_beam_point.toml
	$(BIN)/tisserand compare scenes/free_beam_mean.toml scenes/free_beam_point.toml

test: setup
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/tisserand check
	$(BIN)/pytest --numprocesses 2 --dist loadfile

setup: $(VENV)/installed

$(VENV)/installed: pyproject.toml constraints.txt
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --constraint constraints.txt --editable '.[test]'
	touch $@

clean:
	rm -rf $(VENV) build dist
