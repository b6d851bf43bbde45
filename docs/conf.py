"""How Sphinx builds the documentation: `make docs`."""

import logging
import os
import sys
from pathlib import Path

os.environ.setdefault("MPLBACKEND", "agg")
sys.path.insert(0, str(Path(__file__).parent / "_ext"))

import mimoc

logging.getLogger("OpenGL").setLevel(logging.WARNING)

project = "mimoc"
author = "The mimoc authors"
copyright = author
release = version = mimoc.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx_gallery.gen_gallery",
    "docstrings",
    "repository",
]
exclude_patterns = ["_ext"]
language = "en"
default_role = "code"
suppress_warnings = ["config.cache"]

myst_enable_extensions = ["deflist", "colon_fence", "attrs_inline"]
myst_heading_anchors = 3

# Libraries of extras, which docstrings do not need.
# Libraries of extras, which docstrings do not need.
autodoc_mock_imports = ["stable_baselines3", "torch", "pyarrow", "av"]
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
autodoc_member_order = "bysource"
autodoc_preserve_defaults = True
napoleon_google_docstring = True
napoleon_numpy_docstring = False

sphinx_gallery_conf = {
    "examples_dirs": "../examples/gallery",
    "gallery_dirs": "gallery",
    "filename_pattern": r"\.py$",
    "within_subsection_order": "gallery_order.GalleryOrder",
    "download_all_examples": False,
    "show_signature": False,
    "show_memory": False,
    "write_computation_times": False,
    "min_reported_time": 1e9,
    "remove_config_comments": True,
    "plot_gallery": os.environ.get("GALLERY", "1") != "0",
}

html_theme = "furo"
html_title = "mimoc"
html_static_path = ["_static"]
html_css_files = ["mimoc.css"]
html_copy_source = False
html_show_sourcelink = False
html_show_sphinx = False
html_show_search_summary = False  # Summaries are fetched, which browsers refuse for pages that are opened from disk.
html_theme_options = {
    "light_css_variables": {"color-brand-primary": "#2b6a78", "color-brand-content": "#2b6a78"},
    "dark_css_variables": {"color-brand-primary": "#7cc4d4", "color-brand-content": "#7cc4d4"},
}
