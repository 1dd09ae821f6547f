# Every target works alone on a fresh machine with Python 3.11: the first one creates .venv.
export PYTHONDONTWRITEBYTECODE :=
PYTHON ?= python3
BIN := .venv/bin
PIP := $(BIN)/python -m pip --disable-pip-version-check
SEED ?= 0
# processes for the tests: flights over the wire mostly wait
WORKERS ?= 3

.PHONY: run test lint types layers kernels kernels-quadrotor kernels-free-flyer collected unit bench studies schema reference docs picture clean

run: .venv/ready
	$(BIN)/missionkit run missions/precision_task.yaml --seed $(SEED)

test: .venv/ready
	$(MAKE) --no-print-directory --jobs 2 --output-sync kernels lint types layers collected
	$(MAKE) --no-print-directory unit

lint: .venv/ready
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: .venv/ready
	$(BIN)/mypy

layers: .venv/ready
	$(BIN)/lint-imports

kernels: kernels-quadrotor kernels-free-flyer

kernels-quadrotor: .venv/ready
	PYTHONPATH=tests $(BIN)/python -m compile_kernels precision_landing precision_task known_map detectors

kernels-free-flyer: .venv/ready
	PYTHONPATH=tests $(BIN)/python -m compile_kernels docking

# bytecode of all that the tests import: once, instead of in every worker; `unit` says what is wrong
collected: .venv/ready kernels-quadrotor
	$(BIN)/pytest --collect-only > /dev/null 2>&1 || true

unit: .venv/ready
	$(BIN)/pytest -n $(WORKERS) --dist loadfile --no-loadscope-reorder

bench: .venv/ready
	$(PIP) install --constraint requirements.lock --editable '.[bench]'
	$(BIN)/python -m benchmarks

studies: .venv/ready
	$(BIN)/python -m studies.precision_task
	$(BIN)/python -m studies.resume
	$(BIN)/python -m studies.record_kills
	$(BIN)/python -m studies.page
	$(BIN)/python -m studies.replay
	$(BIN)/python -m studies.why
	$(BIN)/python -m studies.planted_edits
	$(BIN)/python -m studies.fuzz
	$(BIN)/python -m studies.soundness
	$(BIN)/python -m studies.hover
	$(BIN)/python -m studies.known_map
	$(BIN)/python -m studies.precision_landing
	$(BIN)/python -m studies.pad_landing
	$(BIN)/python -m studies.docking
	$(BIN)/python -m studies.placement
	$(BIN)/python -m studies.tracking
	$(BIN)/python -m studies.shadow
	$(BIN)/python -m studies.detection
	$(BIN)/python -m studies.herding
	$(BIN)/python -m studies.envelope
	$(BIN)/python -m studies.over_the_wire
	$(BIN)/python -m studies.faults
	$(BIN)/python -m studies.ud_filter
	$(BIN)/python -m studies.ddp

picture: .venv/ready
	rm -rf build/picture
	$(BIN)/missionkit run missions/precision_task.yaml --seed 0 --headless --out build/picture
	cp build/picture/precision-task-seed0/track.png docs/images/precision_task.png
	$(BIN)/python -m docs.patterns_picture
	$(BIN)/python -m docs.jobs_picture

schema: .venv/ready
	$(BIN)/missionkit schema --write schemas

reference: .venv/ready
	$(BIN)/python -m docs.python_api

docs: .venv/ready
	$(PIP) install --constraint requirements.lock --constraint docs/constraints.txt --editable '.[docs]'
	$(BIN)/python -m sphinx -q -W -b html -d build/doctrees docs build/docs
	@echo build/docs/index.html

.venv/ready: requirements.lock pyproject.toml
	@echo "Installing what requirements.lock names into .venv: minutes on a slow network"
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(PIP) install --no-compile --requirement requirements.lock  # a start compiles what it needs
	$(PIP) install --no-deps --editable .
	@touch $@
	@echo "Installed; the first flight also compiles the simulator, which takes about a minute"

clean:
	rm -rf .venv runs build *.egg-info missionkit/__pycache__/kernels
