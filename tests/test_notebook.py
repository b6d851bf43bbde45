"""What notebooks show of bundles and specs."""

import html
import io
import re
import subprocess
import sys
from base64 import b64decode
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from support import store

import mimoc
from mimoc.base.errors import RenderingError
from mimoc.viewer.formatters import bundle_html

CONFIG = Path(__file__).parents[1] / "configs" / "individual.yaml"


@pytest.fixture(scope="module")
def bundle():
    return store.built(CONFIG)


def test_a_bundle_shows_a_picture_and_its_measures_with_percentiles(bundle):
    shown = bundle_html(bundle)
    (picture,) = re.findall(r'src="data:image/png;base64,([^"]+)"', shown)
    cells = re.findall("<td>(.*?)</td>", shown)
    child = bundle.manifest.child
    assert np.ptp(Image.open(io.BytesIO(b64decode(picture)))) > 50
    assert cells[3:6] == ["length", f"{child.length_cm:.1f} cm", "25"]
    assert 'src="http' not in shown


NOTEBOOK = """
from IPython.core.interactiveshell import InteractiveShell
shell = InteractiveShell.instance()
import mimoc
print(shell.display_formatter.format(mimoc.build({config!r}))[0]["text/html"])
"""


def test_ipython_shows_it(bundle, tmp_path, monkeypatch):
    monkeypatch.setenv("IPYTHONDIR", str(tmp_path))
    program = NOTEBOOK.format(config=str(CONFIG))
    process = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    without_picture = re.compile('src="[^"]+"')  # Another process may draw its last bits otherwise.
    shown, expected = (without_picture.sub("", text.strip()) for text in (process.stdout, bundle_html(bundle)))
    assert shown == expected


def test_without_opengl_a_bundle_shows_its_measures(bundle, monkeypatch):
    def fail(*_):
        raise RenderingError("no OpenGL")

    monkeypatch.setattr("mimoc.render.portrait.portrait", fail)
    shown = bundle_html(bundle)
    assert "<img" not in shown
    assert f"{bundle.manifest.child.weight_kg:.1f} kg" in shown


def test_a_spec_shows_its_text():
    shown = mimoc.load_spec(CONFIG)._repr_html_()
    assert html.unescape(shown) == f"<pre>{CONFIG.read_text()}</pre>"
