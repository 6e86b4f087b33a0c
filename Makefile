# `make help` lists what this can do.
.DEFAULT_GOAL := help
.PHONY: help setup demo check lint-types lint-tests lint-rest test test-all test-durations test-ros2 test-pythons test-arm64 lint coverage mutation fuzz steady bench bench-fleet soak eval study docs lock check-locks

BIN := .venv/bin
PYTHON := $(BIN)/python
ROS2_PYTHON := .venv-ros2/bin/python
CODE := src tests scripts bench evaluation figures
WORKERS := --processes 3
EXAMPLES :=
PYTHONS := 3.10 3.13
LOCKED_PYTHONS := 3.10 3.11 3.12 3.13 3.14
LOCKED_PLATFORMS := x86_64-manylinux_2_28 aarch64-manylinux_2_28
# The tests start hundreds of Python processes, each of which would compile all modules again.
unexport PYTHONDONTWRITEBYTECODE

help: ## List the targets, and how long each takes on 2 cores
	@awk -F ':.*## ' '/^[a-z0-9-]+:.*## / {printf "make %-14s %s\n", $$1, $$2}' $(MAKEFILE_LIST)

setup: ## Install Debian's ROS 1 packages, .venv and .venv-ros2, if they are missing (1 minute)
	@scripts/setup.sh

demo: ## Attack a simulated robot, guard it, attack it again, and show it (ROS 2, no root, 2 to 4 minutes)
	@scripts/setup.sh demo
	@.venv-ros2/bin/rtron demo all --ros 2 --speed 3 --console

lint: setup ## Check style, types, names, sizes, imports, tests and whether the generated docs are fresh (1 minute)
	@$(MAKE) -j 2 --no-print-directory --output-sync=target lint-types lint-tests lint-rest

lint-types:
	$(BIN)/mypy

# Also compiles the tests, which each of pytest's processes would do by itself in a fresh clone.
lint-tests:
	@mkdir -p build
	$(PYTHON) -m pytest -q --collect-only tests >build/collected.txt 2>&1 || { tail -n 40 build/collected.txt; exit 1; }

lint-rest:
	$(BIN)/ruff check $(CODE)
	$(BIN)/ruff format --check $(CODE)
	$(PYTHON) scripts/lint_structure.py
	$(BIN)/lint-imports
	$(PYTHON) scripts/docs_rules.py --check
	$(PYTHON) scripts/docs_policies.py --check
	$(PYTHON) scripts/docs_schemas.py --check

check: setup ## Run lint and the tests beside what differs from main, without ROS and network (2 minutes)
	$(PYTHON) scripts/run_tests.py --changed main

test: setup ## Run lint and all tests but the long ones, fast ones first (17 minutes)
	$(PYTHON) scripts/run_tests.py

test-all: setup ## Run all of that and the long tests: every scene on a real ROS, case studies, soak, load, faults (2 hours)
	$(PYTHON) scripts/run_tests.py --long

test-durations: ## Show the slowest files of the last run, and its tests over 20 s
	$(PYTHON) scripts/run_tests.py --durations

coverage: setup ## Run the tests of policies, risks, plans and vocabulary, which must run every branch (1 minute)
	$(PYTHON) scripts/run_tests.py covered

test-ros2: setup ## Run the tests on a real ROS 2 but the long ones (5 minutes)
	$(PYTHON) scripts/run_tests.py ros2

test-pythons: ## Run the tests that need no ROS 2 on Python 3.10 and 3.13 (20 minutes each)
	for python in $(PYTHONS); do scripts/test_python.sh $$python $(WORKERS) $(EXAMPLES) || exit 1; done

test-arm64: setup ## Run the tests of policies, plans, messages and wire on arm64, with qemu, as root (10 minutes)
	scripts/test_arm64.sh $(EXAMPLES)

mutation: setup ## Change the policies in over a thousand small ways; the tests must fail (hours)
	$(BIN)/mutmut run --max-children 1
	$(PYTHON) -W ignore scripts/mutate.py

fuzz: setup ## Give the wire parsers over 100000 hostile inputs, and scan 1000 random programs; SEED=N repeats these (4 minutes)
	$(BIN)/pytest tests/wire --hypothesis-profile=fuzz -k fuzz --timeout=0 -q
	seed=$(or $(SEED),$$(date +%s)); echo "programs from seed $$seed on"; \
	  FUZZ_PROGRAMS=500 FUZZ_SEED=$$seed $(BIN)/pytest tests/sources/code/fuzz -m "not long" --timeout=0 -q

steady: setup ## Run the tests in FILES ten times while real-time processes stall the cores; SEED=N repeats it (ten times as long as they take)
	$(PYTHON) scripts/steady.py $(FILES) $(if $(TIMES),--times $(TIMES)) $(if $(SEED),--seed $(SEED)) $(if $(LONG),--long)

bench: setup ## Measure beside the peers, and write build/bench.json and build/bench-ros2.json (2 hours)
	$(PYTHON) -m bench
	if [ -x $(ROS2_PYTHON) ]; then $(ROS2_PYTHON) -m bench -o build/bench-ros2.json; fi

bench-fleet: setup ## Measure one service, its console, two replicas and roll-outs with 100 to 1,000 simulated guards (20 minutes)
	$(PYTHON) -m bench fleet console replicas rollouts -o build/bench-fleet.json

soak: setup ## Load, kill, freeze and attack a guarded app at random, on each ROS; SEED=N repeats it (30 minutes)
	$(PYTHON) -m bench.soak $(if $(SEED),--seed $(SEED)) -o build/soak.json
	if [ -x $(ROS2_PYTHON) ]; then $(ROS2_PYTHON) -m bench.soak $(if $(SEED),--seed $(SEED)) -o build/soak-ros2.json; fi

eval: setup ## Evaluate on the apps in RTRON_APPS and RTRON_DATA, and write build/eval.json (as long as the apps take)
	$(PYTHON) -m evaluation

study: setup ## Survey the apps in RTRON_APPS and write docs/study.html (7 minutes for 1000 apps, seconds the next time)
	$(BIN)/rtron survey "$(RTRON_APPS)" -o docs/study.html

docs: setup ## Write the pages and schemas that are made from the code (10 seconds)
	$(PYTHON) scripts/docs_rules.py
	$(PYTHON) scripts/docs_policies.py
	$(PYTHON) scripts/docs_schemas.py

lock: setup ## Pin and hash every dependency in requirements.lock (1 minute)
	$(BIN)/uv pip compile pyproject.toml --extra dev --universal --python-version 3.10 \
	  --generate-hashes --custom-compile-command "make lock" --quiet -o requirements.lock
	$(BIN)/uv pip compile pyproject.toml --extra ros2-dev --universal --python-version 3.10 \
	  --generate-hashes --custom-compile-command "make lock" --quiet -o requirements-ros2.lock \
	  -c requirements.lock

check-locks: setup ## Check that there are wheels of what is pinned for every Python and processor (2 minutes)
	for python in $(LOCKED_PYTHONS); do for platform in $(LOCKED_PLATFORMS); do \
	  echo "$$python $$platform"; \
	  $(BIN)/uv pip compile -q pyproject.toml --extra service --extra demo -c requirements.lock --only-binary :all: \
	    --python-version $$python --python-platform $$platform -o /dev/null || exit 1; \
	done; done
