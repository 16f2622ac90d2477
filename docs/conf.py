"""Settings of the site, which Sphinx builds from the pages that `website/assemble.py` puts together."""

import sys
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parent), str(Path(__file__).parent.parent)]

from derive.version import VERSION  # noqa: E402  of this repository, installed or not

project = "Tisserand"
author = "The authors of Tisserand"
project_copyright = ""
version = release = VERSION
language = "en"
smartquotes = False  # quotation marks are often those of code
python_maximum_signature_line_length = 80
add_module_names = False
html_title = "Tisserand"
html_theme = "furo"
extensions = ["myst_nb", "sphinx_copybutton", "website.accessibility", "website.formulas"]
exclude_patterns = ["README.md"]  # parts of it are included by pages

myst_enable_extensions = ["deflist", "dollarmath"]
myst_heading_anchors = 6
nb_execution_mode = "cache"
nb_execution_cache_path = str(Path(__file__).parent.parent / "build/docs/notebooks")
nb_execution_raise_on_error = True
nb_execution_timeout = 300

html_math_renderer = "mathml"
html_static_path = ["website/static"]
html_extra_path = ["../build/docs/extra"]  # players and reports, which are complete pages
html_css_files = ["site.css", "gallery.css"]
html_js_files = ["keyboard.js"]
html_show_sphinx = False
html_show_copyright = False
html_show_search_summary = False  # needs a server; pages open from disk
html_copy_source = False
pygments_style = "a11y-high-contrast-light"
pygments_dark_style = "a11y-high-contrast-dark"
copybutton_exclude = ".linenos, .gp, .go"
