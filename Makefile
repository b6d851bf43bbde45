# Development tasks; `make help` lists them. Each goal installs what it needs into .venv.

PYTHON ?= python3
VENV ?= .venv
OUT ?= out/demo
ROOMS ?= 0:12
TESTS ?= tests
MINUTES ?= 10
SEED ?= 0
LIVES ?= 200
SPECS ?= 2000
SOAK ?=
DEVICE ?= cuda:0
STEPS ?= 3000000
# Whatever the tests of a file share is made once; in the order of the tree, where the longest ones are not the last.
TWO_WORKERS := -n 2 --dist loadfile --no-loadscope-reorder
# More threads would wait for one another on the cores that the workers share.
ONE_THREAD := OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
# What `make test` leaves out: long tests, and those of libraries that it does not install.
WHOLE := full or extras
APPTAINER ?= $(shell command -v apptainer || command -v singularity)
BIN := $(VENV)/bin
SPHINX := $(BIN)/python -m sphinx -b html -E -W --keep-going -q docs
# Markers of what is installed in $(VENV): the packages for the demo, for `make test`, and for all else: training, GPU, docs.
DEMO := $(VENV)/.demo
TEST := $(VENV)/.test
FULL := $(VENV)/.full
INFANT := $(OUT)/nine_months

export PIP_DISABLE_PIP_VERSION_CHECK := 1
export PYRIGHT_PYTHON_IGNORE_WARNINGS := 1

.DEFAULT_GOAL := help
.PHONY: help demo test test-all docs clusters coverage golden skin pictures toys matrix consumers fuzz soak experiments poses skills gpu bench trainings pages viewer container apptainer opengl clean

help: ## List the goals.
	@awk -F ':.*## ' '/^[a-z-]+:.*## / {printf "  make %-11s %s\n", $$1, $$2}' Makefile

demo: $(DEMO) opengl ## Build, validate, check, run, render and show an infant of nine months, and let it reach.
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

test: $(TEST) opengl ## Lint and run the tests (or TESTS=tests/body), without PyTorch; say how long each part took.
	@$(BIN)/python .ci/parts.py \
		"lint: $(BIN)/ruff check ." \
		"format: $(BIN)/ruff format --check ." \
		"tests: $(ONE_THREAD) $(BIN)/pytest $(TWO_WORKERS) --durations 15 $(TESTS)"

test-all: test $(FULL) ## Run `make test`, then check types, read the documentation, and test training, devices, long laws, container and wheel.
	@$(BIN)/python .ci/parts.py \
		"types: $(BIN)/pyright --pythonpath $(BIN)/python" \
		"docs: GALLERY=0 $(SPHINX) out/docs_without_gallery" \
		"full: $(ONE_THREAD) $(BIN)/pytest $(TWO_WORKERS) --durations 15 -m '$(WHOLE)' $(TESTS)"

docs: $(FULL) opengl ## Build the documentation, out/docs/index.html, with its gallery; every warning is an error.
	MUJOCO_GL=$${MUJOCO_GL:-egl} $(SPHINX) out/docs
	@echo "the documentation   out/docs/index.html"

clusters: $(FULL) ## Test cohorts on a real SLURM and a real Ray cluster (minutes; needs Debian's slurm-wlm and munge).
	@PATH="$$PATH:/usr/sbin:/sbin"; for each in munged slurmctld slurmd sbatch; do command -v $$each >/dev/null || \
		{ echo "make clusters needs SLURM; install it (Debian: apt-get install slurm-wlm munge)"; exit 1; }; done
	$(BIN)/pip install --editable '.[slurm,ray,record]'
	PATH="$(CURDIR)/$(BIN):$$PATH" $(BIN)/pytest tests/clusters

coverage: $(FULL) opengl ## Run every test, list the modules that are least covered, and write out/coverage/index.html.
	rm -rf out/coverage
	$(BIN)/pytest $(TWO_WORKERS) -m "$(WHOLE) or not full" --cov --cov-report= $(TESTS)
	$(BIN)/coverage html --quiet
	$(BIN)/coverage report

golden: $(FULL) ## Update the golden files; review the diff before committing it.
	$(BIN)/pytest -m "$(WHOLE) or not full" --snapshot-update $$(grep -rl --include='test_*.py' 'snapshot' tests)

skin: $(TEST) ## Sculpt the skin of infants again (minutes; needs scikit-image); see docs/looks.md.
	$(BIN)/pip install 'scikit-image>=0.22'
	$(BIN)/python sculpt/make_skin.py

pictures: $(TEST) ## Paint the wallpapers, faces and clothes again (seconds); see docs/looks.md.
	$(BIN)/python sculpt/make_pictures.py

toys: $(TEST) ## Make the built-in toys again (seconds); see CONTRIBUTING.md.
	$(BIN)/python sculpt/make_toys.py

matrix: ## Test several versions of MuJoCo and Python, and the oldest of all else, in .matrix (9 GB, an hour).
	@$(PYTHON) .ci/matrix.py

consumers: opengl ## Let libraries of others read default bundles, in .consumers (15 GB; minutes after the first time).
	@$(PYTHON) .ci/consumers.py

fuzz: $(FULL) opengl ## Try to break mimoc with what strangers may send (MINUTES=10, SEED=0), with honest specs (SPECS=2000: 40 minutes), and with calls in any order (LIVES=1000); docs/trust.md.
	PYTHONPATH=tests MUJOCO_GL=$${MUJOCO_GL:-egl} $(BIN)/python tests/fuzz/run.py --minutes $(MINUTES) --seed $(SEED)
	PYTHONPATH=tests MUJOCO_GL=$${MUJOCO_GL:-egl} $(BIN)/python tests/fuzz/run.py honest_specs --tries $(SPECS) --minutes 1000 --seed $(SEED)
	PYTHONPATH=tests MUJOCO_GL=$${MUJOCO_GL:-egl} $(BIN)/python tests/fuzz/lives.py --sequences $(LIVES)

soak: $(FULL) opengl ## See whether memory and file handles stay flat for hours (SOAK="--steps 1000 --scenes 0 --cycles 0"); docs/trust.md.
	MUJOCO_GL=$${MUJOCO_GL:-egl} $(BIN)/python tests/fuzz/soak.py $(SOAK)

skills: $(FULL) ## Search again for the skills that ship with mimoc (an hour or two; resumes); see docs/skills.md.
	$(ONE_THREAD) $(BIN)/python sculpt/make_skills.py --ship

gpu: $(FULL) ## On a GPU: test, measure, and learn each skill for a few minutes, with a page at the end (DEVICE=cuda:0, STEPS=3000000); docs/gpu.md.
	MIMOC_TEST_DEVICE=$(DEVICE) $(BIN)/pytest -m '$(WHOLE)' tests/runtime/device
	$(BIN)/python benchmarks/gpu.py --device $(DEVICE)
	$(BIN)/python sculpt/make_skills.py --device $(DEVICE) --steps $(STEPS) -o out/gpu

experiments: $(FULL) opengl ## Run the experiments of seconds again whose pages are of earlier bodies, and let the other pages say so; docs/experiments.
	$(BIN)/python sculpt/renew_pages.py

poses: $(TEST) ## See whether start poses rest at all ages (a minute); docs/development.md.
	PYTHONPATH=tests $(BIN)/python -m support.start_poses

bench: $(FULL) ## Run the benchmarks that need no code or recordings of others (minutes).
	@set -e; for each in $$(grep -l __main__ benchmarks/*.py | xargs grep -LE "PATH_TO_MIMO|RECORDING"); do echo "== $$each"; $(BIN)/python $$each; done

trainings: $(FULL) ## Run every training that the documentation prints for 5,000 steps (a minute or two).
	MIMOC_TRAINING_STEPS=5000 $(BIN)/pytest -m "$(WHOLE) or not full" tests/test_trainings_in_docs.py

viewer: ## Build what pages of `mimoc view` contain from mimoc/viewer/source, which needs Node.js and npm; then commit it.
	@command -v npm >/dev/null || { echo "make viewer needs Node.js 20 or later with npm (https://nodejs.org)"; exit 1; }
	mkdir -p .viewer
	cp mimoc/viewer/source/package.json mimoc/viewer/source/build.mjs .viewer
	npm install --prefix .viewer --no-package-lock --no-audit --no-fund --loglevel error
	node .viewer/build.mjs mimoc/viewer/source .viewer/node_modules

pages: $(TEST) viewer ## Test the pages of `mimoc view` in Chromium (minutes; installs Playwright, and Chromium if there is none).
	$(BIN)/pip install --editable '.[live,record,pages]'
	command -v chromium >/dev/null || $(BIN)/playwright install chromium-headless-shell
	$(BIN)/pytest tests/pages

container: apptainer $(TEST) ## Build and test the container dist/mimoc.sif.
	rm -f dist/mimoc-*.whl
	$(BIN)/python -m build --wheel --no-isolation --outdir dist .
	$(APPTAINER) build --force dist/mimoc.sif containers/mimoc.def

apptainer:
	@[ -n "$(APPTAINER)" ] || { echo "make container needs Apptainer or Singularity; install one of them" \
		"(https://apptainer.org/docs/admin/main/installation.html), or give its path: make container APPTAINER=..."; exit 1; }

clean: ## Remove everything that was built: .venv, .matrix, out, caches.
	rm -rf $(VENV) .matrix .consumers .viewer out docs/gallery dist build .pytest_cache .ruff_cache .hypothesis
	find mimoc tests benchmarks -name __pycache__ -prune -exec rm -rf {} +

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

# Rendering needs OpenGL without a display. It is tested, as a library may be installed and still not work.
opengl: $(DEMO)
	@$(draw) || { $(install_opengl) && $(draw); } || \
		echo "OpenGL is not available: rendering will fail. Install EGL or OSMesa (Debian: $(OPENGL_PACKAGES))."

OPENGL_PACKAGES := libegl1 libgl1 libgl1-mesa-dri libosmesa6
draw = $(BIN)/python -c 'from mimoc.render.opengl import open_context; open_context(8, 8).free()' 2>/dev/null
install_opengl = [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null && echo "installing $(OPENGL_PACKAGES)" && \
	export DEBIAN_FRONTEND=noninteractive PATH="$$PATH:/usr/sbin:/sbin" && apt-get update -qq </dev/null && \
	apt-get install -y -qq --no-install-recommends $(OPENGL_PACKAGES) </dev/null >/dev/null
