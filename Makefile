# Development tasks; `make help` lists them, and `.ci/task` rarer ones. Each goal installs what it needs into .venv.

PYTHON ?= python3
VENV ?= .venv
OUT ?= out/demo
ROOMS ?= 0:12
TESTS ?= tests
# Whatever the tests of a file share is made once; in the order of the tree, where the longest ones are not the last.
TWO_WORKERS := -n 2 --dist loadfile --no-loadscope-reorder
# More threads would wait for one another on the cores that the workers share.
ONE_THREAD := OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
# What `make test` leaves out: long tests, and those of libraries that it does not install.
WHOLE := full or extras
BIN := $(VENV)/bin
OPENGL := .ci/opengl $(BIN)/python
SPHINX := $(BIN)/python -m sphinx -b html -E -W --keep-going -q docs
# Markers of what is installed in $(VENV): the packages for the demo, for `make test`, and for all else: training, GPU, docs.
DEMO := $(VENV)/.demo
TEST := $(VENV)/.test
FULL := $(VENV)/.full
INFANT := $(OUT)/nine_months

export PIP_DISABLE_PIP_VERSION_CHECK := 1
export PYRIGHT_PYTHON_IGNORE_WARNINGS := 1

.DEFAULT_GOAL := help
.PHONY: help demo test test-all docs golden pages consumers matrix clusters

help: ## List the goals.
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "  make %-11s %s\n", $$1, $$2}' Makefile

demo: $(DEMO) ## Build, validate, check, run, render and show an infant of nine months, and let it reach.
	@$(OPENGL)
	$(BIN)/mimoc build configs/nine_months.yaml -o $(INFANT) --force
	$(BIN)/mimoc validate --against who --plot $(OUT)/growth.png
	$(BIN)/mimoc check $(INFANT)
	$(BIN)/mimoc run $(INFANT) --policy random
	$(BIN)/mimoc run $(INFANT) --policy reach --steps 600
	$(BIN)/mimoc render $(INFANT) -o $(OUT)/nine_months.png
	$(BIN)/mimoc view $(INFANT) -o $(OUT)/nine_months.html --no-open
	$(BIN)/mimoc rooms configs/playroom.yaml --seeds $(ROOMS) -o $(OUT)/rooms.png
	$(BIN)/mimoc build configs/playroom.yaml --seed 1 -o $(OUT)/playroom --force
	$(BIN)/mimoc see $(OUT)/playroom -o $(OUT)/seen.png
	@echo
	@echo "the infant   $(INFANT)/scene.xml   ($(BIN)/python -m mujoco.viewer --mjcf=$(INFANT)/scene.xml)"
	@echo "its image    $(OUT)/nine_months.png"
	@echo "its page     $(OUT)/nine_months.html   (open it in a browser: it grows, and can be moved)"
	@echo "rooms        $(OUT)/rooms.png"
	@echo "what it sees $(OUT)/seen.png   (in one of the rooms, at 1 to 12 months)"
	@echo "its growth   $(OUT)/growth.png"

test: $(TEST) ## Lint and run the tests (or TESTS=tests/body), without PyTorch; say how long each part took.
	@$(OPENGL)
	@$(BIN)/python .ci/parts.py \
		"lint: $(BIN)/ruff check ." \
		"format: $(BIN)/ruff format --check ." \
		"tests: $(ONE_THREAD) $(BIN)/pytest $(TWO_WORKERS) --durations 15 $(TESTS)"

test-all: test $(FULL) ## Run `make test`, then check types, read the documentation, and test training, devices, long laws, container and wheel.
	@$(BIN)/python .ci/parts.py \
		"types: $(BIN)/pyright --pythonpath $(BIN)/python" \
		"docs: GALLERY=0 $(SPHINX) out/docs_without_gallery" \
		"full: $(ONE_THREAD) $(BIN)/pytest $(TWO_WORKERS) --durations 15 -m '$(WHOLE)' $(TESTS)"

docs: $(FULL) ## Build the documentation, out/docs/index.html, with its gallery; every warning is an error.
	@$(OPENGL)
	MUJOCO_GL=$${MUJOCO_GL:-egl} $(SPHINX) out/docs
	@echo "the documentation   out/docs/index.html"

clusters: $(FULL) ## Test cohorts on a real SLURM and a real Ray cluster (minutes; needs Debian's slurm-wlm and munge).
	@PATH="$$PATH:/usr/sbin:/sbin"; for each in munged slurmctld slurmd sbatch; do command -v $$each >/dev/null || \
		{ echo "make clusters needs SLURM; install it (Debian: apt-get install slurm-wlm munge)"; exit 1; }; done
	$(BIN)/pip install --editable '.[slurm,ray,record]'
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/pytest tests/clusters

golden: $(FULL) ## Update the golden files; review the diff before committing it.
	$(BIN)/pytest -m "$(WHOLE) or not full" --snapshot-update $$(grep -rl --include='test_*.py' 'snapshot' tests)

matrix: ## Test several versions of MuJoCo and Python, and the oldest of all else, in .matrix (9 GB, an hour).
	@$(PYTHON) .ci/matrix.py

consumers: $(DEMO) ## Let libraries of others read default bundles, in .consumers (15 GB; minutes after the first time).
	@$(OPENGL)
	@$(PYTHON) .ci/consumers.py

pages: $(TEST) ## Test the pages of `mimoc view` in Chromium (minutes; installs Playwright, and Chromium if there is none).
	.ci/task viewer
	$(BIN)/pip install --editable '.[live,record,pages]'
	command -v chromium >/dev/null || $(BIN)/playwright install chromium-headless-shell
	$(BIN)/pytest tests/pages

$(DEMO): pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "mimoc needs Python 3.11 or later; choose one with: make PYTHON=/path/to/python3.12"; exit 1; }
	@echo "Installing mimoc and its dependencies into $(VENV): about 500 MB (MuJoCo, SciPy, Matplotlib), a minute or two."
	@$(PYTHON) -m venv $(VENV) || { echo "python's venv is missing (Debian: apt-get install python3-venv)"; exit 1; }
	$(BIN)/pip install --editable '.[report]'
	@touch $@

$(TEST): $(DEMO)
	@echo "Installing the packages for tests into $(VENV): pytest, Hypothesis, PyArrow, PyAV, ruff and more, about 450 MB."
	$(BIN)/pip install --editable '.[report,toys,test]'
	@touch $@

$(FULL): $(TEST)
	@echo "Installing the packages for training, devices, types and documentation into $(VENV): PyTorch, Stable-Baselines3,"
	@echo "MuJoCo Warp, pyright, Sphinx. A CPU build of PyTorch needs about 1 GB and a few minutes; if none is available, a"
	@echo "CUDA build needs about 6 GB and ten minutes."
	@$(torch_without_cuda) || echo "No CPU build of PyTorch is available now: installing the default build."
	$(BIN)/pip install --editable '.[report,toys,train,gpu,live,test,dev,docs]'
	@touch $@

# uv knows the index of CPU builds; it gives up after about ten seconds without an answer. On macOS there is no CUDA.
# Tests on a GPU need the default build, which knows CUDA.
torch_without_cuda = [ "$$(uname)" != Linux ] || echo "$$MIMOC_TEST_DEVICE" | grep -q ^cuda || { $(BIN)/pip install uv && \
	UV_HTTP_CONNECT_TIMEOUT=4 UV_HTTP_TIMEOUT=8 UV_HTTP_RETRIES=1 \
	$(BIN)/uv pip install --python $(BIN)/python --torch-backend cpu --no-deps 'torch<3'; }
