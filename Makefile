# Everything runs in a virtual environment of its own, .venv, which `make` fills when it is needed; `make help` lists the targets.

SHELL := /bin/bash
.DEFAULT_GOAL := help

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check --quiet
# `ci` builds fast and runs nearly as fast as `release`, which the benchmarks use.
PROFILE ?= ci
PYTEST_FLAGS ?= -n auto --dist loadfile
FRAMES ?= 1000000
SECONDS ?= 20

BUILD_INPUTS := Cargo.toml $(wildcard Cargo.lock) pyproject.toml \
	$(shell find rust message_definitions -type f -not -path '*/target/*' -not -path 'rust/fuzz/*' 2>/dev/null)
# Modules whose stubs are compared with what is really there.
STUBBED := mavwire._native $(subst /,.,$(patsubst python/%.py,%,$(wildcard python/mavwire/dialects/v[12]0/[!_]*.py)))

export VIRTUAL_ENV := $(CURDIR)/$(VENV)
export PYO3_PYTHON := $(CURDIR)/$(BIN)/python

.PHONY: help
help: ## List the targets
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## (.*)/\1|\2/' | column -t -s '|'

$(BIN)/python:
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python 3.11 or newer is needed: make PYTHON=python3.12")'
	@echo 'Making $(VENV), then building into it, which takes some minutes'
	$(PYTHON) -m venv $(VENV)

$(VENV)/.requirements-%: requirements/%.txt | $(BIN)/python
	$(PIP) install -r $<
	@touch $@

# Each line by itself and without dependencies: one that does not install here is left out.
define install_each
	@grep -v '^#' $(1) | while read -r name; do \
		$(PIP) install $(2) --no-deps "$$name" </dev/null || echo "$$name does not install here and is left out"; \
	done
endef

$(VENV)/.requirements-peers: requirements/peers.txt $(VENV)/.requirements-test
	$(call install_each,$<)
	@touch $@

$(VENV)/.requirements-bench: requirements/bench.txt requirements/bench-build.txt $(VENV)/.requirements-test
	-$(PIP) install -r requirements/bench-build.txt
	$(call install_each,$<,--no-build-isolation)
	@touch $@

$(VENV)/.built-$(PROFILE): $(VENV)/.requirements-build $(BUILD_INPUTS)
	@command -v cargo >/dev/null || { echo 'Rust is needed: https://rustup.rs'; exit 1; }
	@echo 'Building the extension module, which takes some minutes the first time'
	@[ -t 2 ] || quiet=--quiet; $(BIN)/maturin develop --profile $(PROFILE) --locked $$quiet
	@rm -f $(VENV)/.built-*
	@touch $@

.PHONY: build
build: $(VENV)/.built-$(PROFILE) ## Build the extension module into .venv

.PHONY: demo
demo: build ## Fly a simulated copter and read the log of the flight (LOG=path: only read your own log)
	@$(BIN)/python examples/demo.py $(if $(LOG),"$(LOG)",--record target/flight.tlog)

.PHONY: test
test: test-rust test-python ## Set up and run every test

.PHONY: test-rust
test-rust: ## Run the tests of the Rust crates (the extension module is tested through Python)
	cargo test --workspace --exclude mavwire-py --locked
	cargo test --manifest-path rust/fuzz/Cargo.toml --target-dir target --locked

.PHONY: test-python
test-python: build $(VENV)/.requirements-test $(VENV)/.requirements-peers ## Run the tests of the Python package
	$(BIN)/python -m pytest $(PYTEST_FLAGS)

.PHONY: requirements
requirements: ## Print which tests prove which requirement of docs/requirements.md
	@$(PYTHON) tools/requirement_coverage.py

.PHONY: hardening
hardening: build $(VENV)/.requirements-test ## Print the hardening table, mavwire beside pymavlink (HARDENING_FLAGS=--short)
	@PYTHONPATH=tests/python $(BIN)/python -m hardening $(HARDENING_FLAGS)

.PHONY: fuzz
fuzz: ## Fuzz each target of rust/fuzz for SECONDS with libFuzzer, which needs nightly Rust (FUZZ_FLAGS="scanner --keep")
	@$(PYTHON) tools/fuzz.py --seconds $(SECONDS) $(FUZZ_FLAGS)

.PHONY: differential
differential: build $(VENV)/.requirements-test ## Compare FRAMES frames with pymavlink on all processors
	PYTHONPATH=tests/python $(BIN)/python -m differential.bulk --frames $(FRAMES)

.PHONY: bench
bench: $(VENV)/.requirements-bench ## Print one table: mavwire beside pymavlink and other readers
	@$(MAKE) --no-print-directory build PROFILE=release
	@cargo build --quiet --release --locked -p mavwire-core --example hot_paths
	@$(BIN)/python benches/compare.py $(BENCH_FLAGS)

.PHONY: bench-live
bench-live: $(VENV)/.requirements-test ## Receive from sockets at rising rates, beside pymavlink
	@$(MAKE) --no-print-directory build PROFILE=release
	@$(BIN)/python benches/live.py $(BENCH_FLAGS)

.PHONY: bench-large
bench-large: ## Read logs of up to 1 GB: time of a message, and memory (BENCH_FLAGS="--bytes 1e10")
	@$(MAKE) --no-print-directory build PROFILE=release
	@$(BIN)/python benches/large_log.py $(BENCH_FLAGS)

.PHONY: bench-threads
bench-threads: ## Make tables of logs on one thread and on two
	@$(MAKE) --no-print-directory build PROFILE=release
	@$(BIN)/python benches/threads.py $(BENCH_FLAGS)

.PHONY: bench-lake
bench-lake: $(VENV)/.requirements-test ## Make tables of 200 logs, as files of each log and as a lake (BENCH_FLAGS=--formats)
	@$(MAKE) --no-print-directory build PROFILE=release
	@$(BIN)/python benches/lake.py $(BENCH_FLAGS)

.PHONY: bench-bridge
bench-bridge: ## Forward through a bridge at rising rates, to many links, from many components
	@$(MAKE) --no-print-directory build PROFILE=release
	@$(BIN)/python benches/bridge.py $(BENCH_FLAGS)

.PHONY: soak
soak: ## Fly through bridge, link, log and decoder for SECONDS, and look for losses and growth (BENCH_FLAGS="--hostile --rate 40000")
	@$(MAKE) --no-print-directory build PROFILE=release
	@$(BIN)/python benches/soak.py --seconds $(SECONDS) $(BENCH_FLAGS)

.PHONY: bench-tools
bench-tools: $(VENV)/.requirements-test ## Run the tools and pymavlink's scripts over the same log
	@$(MAKE) --no-print-directory build PROFILE=release
	@$(BIN)/python benches/tools.py $(BENCH_FLAGS)

.PHONY: bench-rust
bench-rust: ## Run the criterion benches of the core
	cargo bench -p mavwire-core --locked

.PHONY: budget
budget: build ## Count instructions of the hot paths and compare with benches/instruction_budget.json
	$(BIN)/python tools/instruction_budget.py $(BUDGET_FLAGS)

.PHONY: lint
lint: lint-rust lint-python ## Check format, style and types

.PHONY: lint-rust
lint-rust: | $(BIN)/python ## Check the Rust sources
	cargo fmt --all --check
	cargo fmt --manifest-path rust/fuzz/Cargo.toml --check
	cargo clippy --workspace --all-targets --locked -- -D warnings

.PHONY: lint-python
lint-python: build $(VENV)/.requirements-lint $(VENV)/.requirements-test ## Check the Python sources
	$(BIN)/ruff format --check .
	$(BIN)/ruff check .
	$(BIN)/mypy
	@export PYRIGHT_PYTHON_IGNORE_WARNINGS=1; if $(BIN)/pyright --version >/dev/null 2>&1; then \
		$(BIN)/pyright --warnings --pythonpath $(BIN)/python --project tests/typed; \
	else echo 'pyright, which fetches itself when it first runs, cannot do so here and is left out'; fi
	$(BIN)/python tools/generate_stubs.py --check
	@$(BIN)/python tools/house.py >/dev/null
	$(BIN)/python -m mypy.stubtest $(STUBBED) --allowlist tests/stubtest_allowlist.txt

.PHONY: house
house: ## Print the size of the sources and their cycles, against the limits of today
	@$(PYTHON) tools/house.py

.PHONY: format
format: $(VENV)/.requirements-lint ## Format all sources
	cargo fmt --all
	cargo fmt --manifest-path rust/fuzz/Cargo.toml
	$(BIN)/ruff check --fix-only --quiet .
	$(BIN)/ruff format .

.PHONY: docs
docs: build $(VENV)/.requirements-docs ## Build the documentation site into target/site; warnings are errors
	@$(BIN)/python tools/docs_pages.py
	@NO_MKDOCS_2_WARNING=true $(BIN)/mkdocs build --strict
	@echo 'The site is in target/site/index.html'

.PHONY: wheel
wheel: $(VENV)/.requirements-build $(VENV)/.requirements-package ## Make source distribution and release wheel in dist, and check the wheel
	rm -rf dist
	$(BIN)/maturin sdist --out dist
	PATH="$(CURDIR)/$(BIN):$$PATH" $(PIP) wheel --no-deps --no-build-isolation --wheel-dir dist dist/*.tar.gz
	$(BIN)/python tools/check_wheel.py dist/*.whl

.PHONY: audit
audit: | $(BIN)/python ## Check licences and sources of all crates, and look up advisories where their data is to be had
	@$(PIP) install -r requirements/audit.txt || echo 'pip-audit does not install here and is left out'
	@$(BIN)/python tools/audit.py

.PHONY: targets
targets: $(VENV)/.requirements-targets ## Check that mavwire compiles for other systems (TARGETS="aarch64-apple-darwin")
	@$(BIN)/python tools/check_targets.py $(TARGETS)

.PHONY: sbom
sbom: | $(BIN)/python ## Write the bill of materials into dist, as CycloneDX
	@$(BIN)/python tools/sbom.py

.PHONY: reproducible
reproducible: $(VENV)/.requirements-build ## Build the committed sources twice, in two places, and compare the wheels
	@$(BIN)/python tools/reproducible.py

.PHONY: stubs
stubs: build ## Write the type stubs of the dialect modules
	$(BIN)/python tools/generate_stubs.py

.PHONY: definitions-check
definitions-check: build ## Compare newer checkouts of the upstreams with the pinned definitions (DIRS="mavlink ardupilot")
	@$(BIN)/python tools/definitions_check.py $(CHECK_FLAGS) $(DIRS)

.PHONY: definitions-import
definitions-import: build ## Import the definitions of these checkouts of the upstreams (DIRS="mavlink ardupilot")
	$(BIN)/python tools/union_definitions.py $(DIRS)
	@$(MAKE) --no-print-directory stubs

.PHONY: coverage-table
coverage-table: build $(VENV)/.requirements-test ## Write docs/coverage.md: every public name of pymavlink
	$(BIN)/python tools/coverage_table.py

.PHONY: clean
clean: ## Remove everything that was built
	rm -rf $(VENV) target dist rust/fuzz/target rust/fuzz/artifacts python/mavwire/*.so .pytest_cache .mypy_cache .ruff_cache .hypothesis
