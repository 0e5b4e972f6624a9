"""The site: the pages of this folder, and the reference made from the docstrings."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

project = "vmach"
copyright = "the vmach developers"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
exclude_patterns = ["_build"]
root_doc = "index"
html_theme = "furo"
html_title = "vmach"
myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 3
#: pages also link to files of the repository, which the site does not hold
suppress_warnings = ["myst.xref_missing", "myst.header"]
napoleon_google_docstring = False
autodoc_typehints = "none"
autodoc_member_order = "bysource"
autodoc_default_options = {"members": True, "show-inheritance": False}
#: what the pages load lazily is imported for real: nothing is mocked
nitpicky = False
