# `make run` installs Tisserand into .venv and builds the two beams of the README.
# `make test` also installs the test tools and runs all checks and tests; `make test-long` whole studies and
# benchmarks, `make test-hosts` exports in the programs that they are for, see docs/hosts.md. `make docs` builds the
# site in site/, and `make test-docs` looks at each of its pages in a browser. `make release` builds the
# wheel and the source distribution, and tries both in empty environments.

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/$(if $(filter Windows_NT,$(OS)),Scripts,bin)
# Bytecode of modules that are never imported would take half of the time of an installation.
PIP := $(BIN)/python -m pip install --no-compile --disable-pip-version-check --constraint constraints.txt

.PHONY: run test checks tests test-long test-hosts docs test-docs release clean

# Bytecode of the tests and of the package is kept: without it, each of the many processes of a run compiles them again.
export PYTHONDONTWRITEBYTECODE =

run: $(VENV)/installed
	$(BIN)/tisserand build scenes/free_beam_mean.toml scenes/free_beam_point.toml
	$(BIN)/tisserand compare scenes/free_beam_mean.toml scenes/free_beam_point.toml

test: $(VENV)/installed-test
	@$(MAKE) --no-print-directory --jobs 2 checks tests

checks: $(VENV)/installed-test
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/tisserand check

# A worker that crashes ends the run with the test that it ran: with a new worker, pytest-xdist 3.8 may wait for ever
# (its issues 784 and 1378).
PARALLEL := --numprocesses 2 --max-worker-restart 0 --durations 20

# Tests run `make` themselves, which is not to look for the jobs of this one.
tests: $(VENV)/installed-test
	MAKEFLAGS= $(BIN)/pytest $(PARALLEL) --dist loadfile

test-long: $(VENV)/installed-test
	$(BIN)/pytest $(PARALLEL) --dist loadfile -m "long and not hosts"

test-hosts: $(VENV)/installed-hosts
	$(BIN)/pytest $(PARALLEL) --dist loadfile -m hosts

docs: $(VENV)/installed-docs
	$(BIN)/python -m docs.gallery
	$(BIN)/python docs/website/assemble.py build/docs/source
	rm -rf site
	$(BIN)/sphinx-build --quiet --jobs 2 --fail-on-warning --keep-going -c docs -d build/docs/doctrees build/docs/source site
	@echo "The site is site/index.html."

test-docs: docs $(VENV)/installed-test
	$(BIN)/pytest $(PARALLEL) -m docs tests/site

release: $(VENV)/installed-release
	$(BIN)/python tools/release.py

$(BIN)/python:
	@echo "Creating the virtual environment $(VENV) ..."
	@$(PYTHON) -m venv $(VENV)

$(VENV)/installed: pyproject.toml constraints.txt | $(BIN)/python
	@echo "Installing Tisserand and its dependencies into $(VENV); the first time this takes about a minute ..."
	@$(PIP) --editable .
	@touch $@

$(VENV)/installed-test: pyproject.toml constraints.txt | $(BIN)/python
	@echo "Installing Tisserand and the test tools into $(VENV); the first time this takes about a minute ..."
	@$(PIP) --editable '.[test]'
	@touch $(VENV)/installed $@

$(VENV)/installed-hosts: $(VENV)/installed-test
	@echo "Installing the packages of Python for other programs into $(VENV) ..."
	@$(PIP) --editable '.[hosts]'
	@touch $@

$(VENV)/installed-docs: pyproject.toml constraints.txt | $(BIN)/python
	@echo "Installing Sphinx and what else builds and checks the site into $(VENV) ..."
	@$(PIP) --editable '.[docs]'
	@touch $(VENV)/installed $@

$(VENV)/installed-release: pyproject.toml constraints.txt | $(BIN)/python
	@echo "Installing the tools of releases into $(VENV) ..."
	@$(PIP) --editable '.[release]'
	@touch $@

clean:
	rm -rf $(VENV) build dist site jupyter_execute
