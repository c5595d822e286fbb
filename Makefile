# Two commands do all set-up on a fresh machine: `make demo` and `make test`.
PYTHON ?= python3
BIN := .venv/bin
# Small matrices: BLAS threads only hurt.
export OMP_NUM_THREADS := 1
export OPENBLAS_NUM_THREADS := 1

.PHONY: install demo test browser docs site lint wheel architecture clean

install: .venv/installed

.venv/installed: pyproject.toml constraints.txt
	$(PYTHON) -m venv .venv
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e ".[test]"
	touch $@

demo: install
	$(BIN)/tpsim run cup-and-sugar --situations 2

# Two processes; a file's tests stay together, since they share what is taught.
test: install lint wheel
	$(BIN)/python -m pytest -n 2 --dist loadfile

# What a user adds, through the installed wheel: nothing of the checkout is on its path.
wheel: install
	rm -rf .venv/wheel .venv/site
	$(BIN)/python -m pip wheel --quiet --disable-pip-version-check --no-deps -w .venv/wheel .
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --target .venv/site .venv/wheel/*.whl
	cd .venv/site && PYTHONPATH=$(CURDIR)/.venv/site TPSIM_SITE=$(CURDIR)/.venv/site \
		../bin/python -m pytest -p no:cacheprovider $(CURDIR)/tests/outside

lint: install
	$(BIN)/ruff check .
	$(BIN)/mypy

docs: .venv/documented
	$(BIN)/python -m sphinx -W --keep-going -q -b html docs docs/_build/html
	@echo "the site is docs/_build/html/index.html"

# The site in a browser: links, console, a phone's width, dark mode, search.
site: docs
	$(BIN)/python -m pytest -m site tests/docs

# The playground in a real browser, which is dragged, taught and pushed.
browser: install
	$(BIN)/python -m pytest -m browser tests/play

.venv/documented: .venv/installed
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e ".[docs]"
	touch $@

architecture: install
	$(BIN)/python docs/draw_architecture.py

clean:
	rm -rf .venv recordings/runs docs/_build docs/_made docs/gallery
