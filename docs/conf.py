"""How Sphinx builds the documentation site: `make docs`."""

from __future__ import annotations

from missionkit import __version__

project = "missionkit"
release = __version__
extensions = ["myst_parser"]
html_theme = "furo"
html_title = "missionkit"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_copyright = False
myst_heading_anchors = 3
highlight_language = "none"
