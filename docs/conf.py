"""The site: ``make site`` turns the pages of this folder into docs/_build/index.html."""

from tethertest import __version__

project = "tethertest"
author = "the tethertest developers"
release = version = __version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx.ext.intersphinx"]
source_suffix = {".md": "markdown"}
exclude_patterns = ["_build"]
html_theme = "furo"
html_title = f"tethertest {release}"

autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
autodoc_member_order = "bysource"
napoleon_google_docstring = False
napoleon_use_rtype = False
default_role = "any"
myst_heading_anchors = 3
# docstrings name private helpers, pages name files of the tree
suppress_warnings = ["ref.any", "myst.xref_missing"]
intersphinx_mapping: dict[str, tuple[str, str | None]] = {}  # the site is built without a network
