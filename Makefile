# Everything that is done with mimoc's source; `make help` lists it. Each goal sets itself up in .venv.

PYTHON ?= python3
VENV ?= .venv
OUT ?= out/demo
ROOMS ?= 0:12
TESTS ?= tests
# Whatever the tests of a file share is made once; in the order of the tree, where the longest ones are not the last.
TWO_WORKERS := -n 2 --dist loadfile --no-loadscope-reorder
APPTAINER ?= $(shell command -v apptainer || command -v singularity)
BIN := $(VENV)/bin
# What is in $(VENV) already: what the demo needs, and what tests and training need besides.
DEMO := $(VENV)/.demo
TEST := $(VENV)/.test
INFANT := $(OUT)/nine_months

export PIP_DISABLE_PIP_VERSION_CHECK := 1
export PYRIGHT_PYTHON_IGNORE_WARNINGS := 1

.DEFAULT_GOAL := help
.PHONY: help demo test coverage golden matrix bench container apptainer opengl clean

help: ## Say what there is to make.
	@awk -F ':.*## ' '/^[a-z]+:.*## / {printf "  make %-9s %s\n", $$1, $$2}' Makefile

demo: $(DEMO) opengl ## Build, validate, check, run and draw an infant of nine months, and let it reach.
	$(BIN)/mimoc build configs/nine_months.yaml -o $(INFANT) --force
	$(BIN)/mimoc validate --against who --plot $(OUT)/growth.png
	$(BIN)/mimoc check $(INFANT)
	$(BIN)/mimoc run $(INFANT) --policy random
	$(BIN)/mimoc run $(INFANT) --policy reach --steps 600
	$(BIN)/mimoc render $(INFANT) -o $(OUT)/nine_months.png
	$(BIN)/mimoc rooms configs/playroom.yaml --seeds $(ROOMS) -o $(OUT)/rooms.png
	$(BIN)/mimoc build configs/playroom.yaml --seed 1 -o $(OUT)/playroom --force
	$(BIN)/mimoc see $(OUT)/playroom -o $(OUT)/seen.png
	@echo
	@echo "the infant   $(INFANT)/scene.xml   ($(BIN)/python -m mujoco.viewer --mjcf=$(INFANT)/scene.xml)"
	@echo "its picture  $(OUT)/nine_months.png"
	@echo "rooms        $(OUT)/rooms.png"
	@echo "what it sees $(OUT)/seen.png   (in one of them, through eyes of 1 to 12 months)"
	@echo "its growth   $(OUT)/growth.png"

test: $(TEST) opengl ## Lint, check types and run every test, and say how long each part took.
	@$(BIN)/python .ci/parts.py \
		"lint: $(BIN)/ruff check ." \
		"format: $(BIN)/ruff format --check ." \
		"types: $(BIN)/pyright --pythonpath $(BIN)/python" \
		"tests: $(BIN)/pytest $(TWO_WORKERS) --durations 15"

coverage: $(TEST) opengl ## Run every test, list the modules that are least covered, and write out/coverage/index.html.
	rm -rf out/coverage
	$(BIN)/pytest $(TWO_WORKERS) --cov --cov-report= $(TESTS)
	$(BIN)/coverage html --quiet
	$(BIN)/coverage report

golden: $(TEST) ## Renew the golden files; read the difference before you commit it.
	$(BIN)/pytest --snapshot-update $$(grep -rl --include='test_*.py' 'snapshot' tests)

matrix: ## Try several MuJoCos and Pythons, each pair in an environment of its own under .matrix (7 GB, half an hour).
	@$(PYTHON) .ci/matrix.py

bench: $(TEST) ## Measure speed and the solver (minutes).
	@set -e; for each in $$(grep -l __main__ benchmarks/*.py); do echo "== $$each"; $(BIN)/python $$each; done

container: apptainer $(TEST) ## Build dist/mimoc.sif, a container with all that mimoc needs, and test it.
	rm -f dist/mimoc-*.whl
	$(BIN)/python -m build --wheel --no-isolation --outdir dist .
	$(APPTAINER) build --force dist/mimoc.sif containers/mimoc.def

apptainer:
	@[ -n "$(APPTAINER)" ] || { echo "make container needs Apptainer or Singularity, and there is none; install one" \
		"(https://apptainer.org/docs/admin/main/installation.html), or name it with: make container APPTAINER=..."; exit 1; }

clean: ## Remove what was built here: .venv, .matrix, out, caches.
	rm -rf $(VENV) .matrix out dist build .pytest_cache .ruff_cache .hypothesis
	find mimoc tests benchmarks -name __pycache__ -prune -exec rm -rf {} +

$(DEMO): pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' || \
		{ echo "mimoc needs Python 3.11 or later; name one with: make PYTHON=/path/to/python3.12"; exit 1; }
	@echo "Installing mimoc and what it needs into $(VENV): some 500 MB (MuJoCo, SciPy, Matplotlib), in a minute or two."
	@$(PYTHON) -m venv $(VENV) || { echo "python's venv is missing (Debian: apt-get install python3-venv)"; exit 1; }
	$(BIN)/pip install --editable '.[report]'
	@touch $@

$(TEST): $(DEMO)
	@echo "Installing what tests and training need into $(VENV): PyTorch, pytest, ruff, pyright and more. With a PyTorch"
	@echo "without CUDA, where that is to be had, some 1 GB in a few minutes; with CUDA some 6 GB, in ten minutes."
	@$(torch_without_cuda) || echo "There is no PyTorch without CUDA to be had now: taking PyTorch as it comes."
	$(BIN)/pip install --editable '.[report,toys,train,test,dev]'
	@touch $@

# uv knows the index of builds without CUDA. It gives up after some ten seconds without an answer. On a Mac there is no CUDA.
torch_without_cuda = [ "$$(uname)" != Linux ] || { $(BIN)/pip install uv && \
	UV_HTTP_CONNECT_TIMEOUT=4 UV_HTTP_TIMEOUT=8 UV_HTTP_RETRIES=1 \
	$(BIN)/uv pip install --python $(BIN)/python --torch-backend cpu --no-deps 'torch<3'; }

# Pictures need OpenGL without a screen. It is tried rather than looked up: a library may be there and not work.
opengl: $(DEMO)
	@$(draw) || { $(install_opengl) && $(draw); } || \
		echo "No OpenGL: pictures will fail. Install EGL or OSMesa (Debian: $(OPENGL_PACKAGES))."

OPENGL_PACKAGES := libegl1 libgl1 libgl1-mesa-dri libosmesa6
draw = $(BIN)/python -c 'from mimoc.render.opengl import open_context; open_context(8, 8).free()' 2>/dev/null
install_opengl = [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null && echo "installing $(OPENGL_PACKAGES)" && \
	export DEBIAN_FRONTEND=noninteractive PATH="$$PATH:/usr/sbin:/sbin" && apt-get update -qq </dev/null && \
	apt-get install -y -qq --no-install-recommends $(OPENGL_PACKAGES) </dev/null >/dev/null
