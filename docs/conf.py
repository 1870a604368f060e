"""Settings of the docs site for Sphinx."""

from __future__ import annotations

from importlib.metadata import distribution
from importlib.metadata import version as version_of

from sphinx.errors import ConfigError

if not tags.has("staged"):  # type: ignore[name-defined]  # noqa: F821  # a name that Sphinx gives to this file
    raise ConfigError("The site is built from README, docs/ and notebooks/ together; run: python docs/builder")

project, author, copyright = "thermicon", "The thermicon authors", "The thermicon authors"
release = version_of("thermicon")

extensions = ["myst_nb", "sphinx_design", "sphinx_copybutton", "sphinx.ext.autodoc", "sphinx.ext.mathjax", "numpydoc"]
root_doc = "index"
language = "en"
smartquotes = False  # two hyphens are an option, not a dash

# Pages link to each other by file and heading, as a code host does.
myst_enable_extensions = ["colon_fence", "tasklist"]
myst_heading_anchors = 4
myst_fence_as_directive = {"math"}
myst_links_external_new_tab = True

# Tutorials run while the site is built; what they printed is kept until the program or the cell changes.
nb_execution_timeout = 600
nb_execution_raise_on_error = True
nb_merge_streams = True
nb_ipywidgets_js: dict[str, dict[str, str]] = {}  # the workbench needs a kernel, so a page shows its picture
nb_mime_priority_overrides = [("html", "application/vnd.jupyter.widget-view+json", None)]

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
python_use_unqualified_type_names = True
maximum_signature_line_length = 90
toc_object_entries = False  # each name has a heading already
numpydoc_show_class_members = False
numpydoc_xref_param_type = False
default_role = "literal"  # numpydoc puts names of parameters between single backticks

copybutton_prompt_text = "$ "
copybutton_only_copy_prompt_lines = True
copybutton_selector = "div.highlight pre"

# Pages on errors show cue text that has some; the staging checks the languages of blocks.
suppress_warnings = ["misc.highlighting_failure"]

# Nothing is fetched from elsewhere: the site works from a folder and without a network.
MATHJAX = "sphinx-mathjax-offline"
html_static_path = ["builder/static", str(distribution(MATHJAX).locate_file(f"{MATHJAX}/static/mathjax/tex-svg.js"))]
mathjax_path = "tex-svg.js"

html_theme = "pydata_sphinx_theme"
html_title = f"thermicon {release}"
html_css_files = ["site.css"]
html_show_sourcelink = False
html_copy_source = False
html_theme_options = {
    "logo": {"text": "thermicon"},
    "navbar_align": "left",
    "navbar_end": ["theme-switcher"],
    "header_links_before_dropdown": 7,
    "show_toc_level": 2,
    "collapse_navigation": True,  # a button that unfolds pages has no name for a screen reader
    "navigation_with_keys": False,
    "footer_start": ["copyright"],
    "footer_end": [],
    "pygments_light_style": "a11y-high-contrast-light",
    "pygments_dark_style": "a11y-high-contrast-dark",
}
html_context = {"default_mode": "auto"}
html_sidebars = {"index": [], "gallery": []}
