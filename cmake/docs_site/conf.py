"""Sphinx settings of the documentation site. make_site.py passes the version and the folder of the Python module."""

import inspect
import os
import re
import sys

sys.path.insert(0, os.environ["SONARCAL_SITE_PYTHON"])
sys.dont_write_bytecode = True

project = "sonarcal"
author = "the sonarcal developers"
copyright = author  # pylint: disable=redefined-builtin
version = release = os.environ["SONARCAL_SITE_VERSION"]
root_doc = "README"
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
exclude_patterns = ["_*"]
html_theme = "furo"
html_title = f"sonarcal {version}"
html_copy_source = False
html_show_sphinx = False
html_last_updated_fmt = None
html_static_path = ["static"]
html_css_files = ["site.css"]

myst_heading_anchors = 4
smartquotes = False
default_role = "code"
highlight_language = "none"
suppress_warnings = ["misc.highlighting_failure", "myst.header"]

autodoc_typehints = "none"
autodoc_member_order = "bysource"
napoleon_google_docstring = False
napoleon_use_rtype = False


def shortened(app, what, name, obj, options, signature, return_annotation):  # pylint: disable=too-many-arguments
    """Options are listed below the signature: there they stand as **keywords."""
    try:
        known = inspect.signature(obj)
    except (TypeError, ValueError):
        return None
    parameters = list(known.parameters.values())
    if len(parameters) < 12:
        return None
    own = [p for p in parameters if p.default is p.empty or p.name in ("options", "progress", "source")]
    keywords = inspect.Parameter("keywords", inspect.Parameter.VAR_KEYWORD)
    own = [p.replace(annotation=p.empty) for p in own]
    return str(inspect.Signature([*own, keywords])), None


texts_of_properties = {}


def remembered(app, what, name, obj, options, lines):  # pylint: disable=too-many-arguments
    """Napoleon takes the words before a colon for the type of a property."""
    if what == "property":
        texts_of_properties[name] = list(lines)


def escaped(app, what, name, obj, options, lines):  # pylint: disable=too-many-arguments
    """A star of a help text, such as "names with *", begins no emphasis."""
    lines[:] = texts_of_properties.pop(name, lines)
    lines[:] = [re.sub(r"(?<=\s)\*(?=[\s.,])", r"\\*", line) for line in lines]


def setup(app):
    """Called by Sphinx. Napoleon's hook has priority 500."""
    app.connect("autodoc-process-signature", shortened)
    app.connect("autodoc-process-docstring", remembered, priority=100)
    app.connect("autodoc-process-docstring", escaped, priority=900)
