# Every target works alone on a fresh machine with Python 3.11: the first one creates .venv.
export PYTHONDONTWRITEBYTECODE :=
PYTHON ?= python3
BIN := .venv/bin
SEED ?= 0

.PHONY: run test lint types layers unit bench studies schema clean

run: .venv/ready
	$(BIN)/missionkit run missions/precision_task.yaml --seed $(SEED)

test: lint types layers unit

lint: .venv/ready
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .

types: .venv/ready
	$(BIN)/mypy

layers: .venv/ready
	$(BIN)/lint-imports

unit: .venv/ready
	$(BIN)/pytest -n 2

bench: .venv/ready
	$(BIN)/python -m pip install --quiet --constraint requirements.lock --editable '.[bench]'
	$(BIN)/python -m benchmarks

studies: .venv/ready
	$(BIN)/python -m studies.precision_task
	$(BIN)/python -m studies.resume
	$(BIN)/python -m studies.fuzz
	$(BIN)/python -m studies.hover
	$(BIN)/python -m studies.known_map
	$(BIN)/python -m studies.over_the_wire

schema: .venv/ready
	$(BIN)/missionkit schema --write schemas

.venv/ready: requirements.lock pyproject.toml
	test -x $(BIN)/python || $(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --requirement requirements.lock
	$(BIN)/python -m pip install --quiet --no-deps --editable .
	touch $@

clean:
	rm -rf .venv runs build *.egg-info

.PHONY: clean-kernels
clean-kernels:
	find missionkit -name '*.nb[ci]' -delete
