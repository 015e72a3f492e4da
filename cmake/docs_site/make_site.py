"""Builds the documentation site from the pages of the sources and Doxygen's output.

    make_site.py SOURCES VERSION DOXYGEN_OUTPUT PYTHON OUT

DOXYGEN_OUTPUT holds api/ (HTML) and xml/. PYTHON holds the built package `sonarcal`, or does not exist. docs/README.md gives the
order of the pages: a page that it does not list is a mistake, and so is a link that leads nowhere.
"""

import ast
import html
import html.parser
import os
import pathlib
import re
import shutil
import subprocess
import sys
import urllib.parse
import xml.etree.ElementTree as ElementTree

HERE = pathlib.Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

import install_pages  # noqa: E402  pylint: disable=wrong-import-position

OTHER_PAGES = ["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "THIRD_PARTY_NOTICES.md", "data_io/README.md", "notebooks/README.md"]
CPP_FOLDERS = ["core", "data_io", "metrics", "sim", "calib", "apps/workflow"]


def contents(stage):
    """Lists of pages for the sidebar, in the order of docs/README.md."""
    text = (stage / "docs/README.md").read_text(encoding="utf-8")
    lists = []
    for section in re.split(r"^## ", text, flags=re.MULTILINE)[1:]:
        pages = [os.path.normpath(f"docs/{page}") for page in re.findall(r"^\| \[[^\]]*\]\(([^)#]+\.md)\)", section, re.MULTILINE)]
        if section.startswith("About"):
            pages = ["docs/README.md", *pages]
        lists.append((section.partition("\n")[0].partition(":")[0], pages))
    lists.insert(-1, ("Programming interfaces", ["api/python.rst", *(f"api/cpp_{pathlib.Path(f).name}.md" for f in CPP_FOLDERS)]))
    out = []
    for caption, pages in lists:
        out += ["", "```{toctree}", ":hidden:", f":caption: {caption}", "", *(page.rpartition(".")[0] for page in pages), "```"]
    return "\n".join(out) + "\n"


def text_of(element):
    """Words of a description."""
    return " ".join("".join(element.itertext()).split()) if element is not None else ""


def address_of(refid):
    """Page of Doxygen that describes this."""
    member = re.fullmatch(r"(.*)_1(a[0-9a-f]{32})", refid)
    return f"cpp/{member[1]}.html#{member[2]}" if member else f"cpp/{refid}.html"


def linked(refid, name):
    """Name with a link to its description."""
    return f'<a href="{address_of(refid)}"><code>{html.escape(name)}</code></a>'


def header_section(xml, refid):
    """Contract of a header and names that it declares, or nothing."""
    header = ElementTree.parse(xml / f"{refid}.xml").getroot().find("compounddef")
    place = header.find("location").get("file")
    names = {}
    for inner in header.findall("innerclass[@prot='public']"):
        names[inner.text.removeprefix("sonarcal::")] = inner.get("refid")
    for inner in header.findall("innernamespace"):
        space = ElementTree.parse(xml / f"{inner.get('refid')}.xml").getroot()
        for member in space.iter("memberdef"):
            if member.find("location").get("file") == place and member.get("kind") != "variable":
                name = f"{text_of(inner)}::{member.findtext('name')}".removeprefix("sonarcal::")
                names.setdefault(name, member.get("id"))
    contract = text_of(header.find("detaileddescription/para"))
    text = re.sub(r"[\\`*_\[\]$]", lambda found: f"&#{ord(found[0])};", html.escape(contract))
    lines = [f"## {place}", "", f'{text} <a href="{address_of(refid)}">More</a>', ""]
    if names:
        lines += ["Declares " + ", ".join(linked(names[name], name) for name in sorted(names)) + ".", ""]
    return place, "\n".join(lines)


def write_cpp(stage, xml):
    """One page per library: its headers, which lead to Doxygen's pages."""
    sections = {}
    for compound in ElementTree.parse(xml / "index.xml").getroot().findall("compound[@kind='file']"):
        place, section = header_section(xml, compound.get("refid"))
        sections[place] = section
    for folder in CPP_FOLDERS:
        mine = [sections[place] for place in sorted(sections) if place.startswith(f"{folder}/")]
        name = pathlib.Path(folder).name
        assert mine, f"Doxygen's output has no header of {folder}"
        head = f"# C++: sonarcal::{name}\n\n"
        head += '<a href="cpp/index.html">Complete reference</a> of all libraries, made by Doxygen, with a search of its own.\n\n'
        (stage / f"api/cpp_{name}.md").write_text(head + "\n".join(mine), encoding="utf-8")


def groups_of_names(module):
    """Heading, directive and names of the functions, results, options and errors that a module offers."""
    tree = ast.parse(module.read_text(encoding="utf-8"))
    names = next(ast.literal_eval(node.value) for node in tree.body
                 if isinstance(node, ast.Assign) and node.targets[0].id == "__all__")
    names = [name for name in names if not name.startswith("_")]
    options = [name for name in names if name.endswith("Options")]
    errors = [name for name in names if name.endswith("Error")]
    functions = [name for name in names if name[0].islower()]
    classes = [name for name in names if name not in options + errors + functions]
    return [("Functions", "autofunction", functions), ("Classes", "autoclass", classes), ("Options", "autoclass", options),
            ("Errors", "autoexception", errors)]


def write_python(stage, sources, module):
    """The reference of the module from its docstrings, or the type stubs if it is not built."""
    lines = ["Python: module sonarcal", "=======================", ""]
    if list(module.glob("sonarcal/_sonarcal*.so")):
        lines += [".. automodule:: sonarcal", ""]
        for heading, directive, names in groups_of_names(sources / "apps/python/sonarcal/__init__.py"):
            lines += [heading, "-" * len(heading), ""]
            for name in names:
                lines += [f".. {directive}:: sonarcal.{name}", *(["   :members:"] if directive == "autoclass" else []), ""]
    else:
        print("docs_site: the Python module is not built: its page shows the type stubs only")
        lines += ["The module was not built with this site. Its type stubs:", "", ".. literalinclude:: stubs.txt",
                  "   :language: python", ""]
        shutil.copyfile(sources / "apps/python/_sonarcal.pyi", stage / "api/stubs.txt")
    (stage / "api/python.rst").write_text("\n".join(lines), encoding="utf-8")


class Links(html.parser.HTMLParser):
    """Places of a page to which links can lead, and its own links."""

    def __init__(self, text):
        super().__init__()
        self.ids, self.links = set(), []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        for key, value in attrs:
            if key in ("id", "name") and value:
                self.ids.add(value)
            elif key in ("href", "src") and value:
                self.links.append(value)


def dead_links(site):
    """Links of the pages, except Doxygen's own, that lead to no file or to no place in it."""
    known, dead = {}, []

    def read(path):
        if path not in known:
            known[path] = Links(path.read_text(encoding="utf-8"))
        return known[path]

    for page in sorted(site.rglob("*.html")):
        if "cpp" in page.relative_to(site).parts:
            continue
        for link in read(page).links:
            parts = urllib.parse.urlsplit(link)
            if parts.scheme or parts.netloc:
                continue
            there = (page.parent / urllib.parse.unquote(parts.path)).resolve() if parts.path else page
            if not there.is_file() and there != site:
                dead.append(f"{page.relative_to(site)}: {link}")
            elif parts.fragment and there.suffix == ".html" and parts.fragment not in read(there).ids:
                dead.append(f"{page.relative_to(site)}: {link}")
    return dead


def main():
    """Copies, writes, builds, checks."""
    sources, version, doxygen, module, out = sys.argv[1], sys.argv[2], *map(pathlib.Path, sys.argv[3:6])
    sources, out = pathlib.Path(sources).resolve(), out.resolve()
    stage = out.with_name(out.name + "_pages")
    for folder in (stage, out):
        shutil.rmtree(folder, ignore_errors=True)
    install_pages.copy_pages(sources, stage, OTHER_PAGES, folders_too=False)
    (stage / "api").mkdir()
    with (stage / "README.md").open("a", encoding="utf-8") as home:
        home.write(contents(stage))
    write_python(stage, sources, module)
    write_cpp(stage, doxygen / "xml")
    environment = dict(os.environ, SONARCAL_SITE_VERSION=version, SONARCAL_SITE_PYTHON=str(module), LC_ALL="C.UTF-8")
    # Debian's Python, as another one has no Sphinx.
    ended = subprocess.run(
        [sys.executable, "-m", "sphinx", "-q", "-W", "--keep-going", "-c", str(HERE), "-d", str(stage / "_doctrees"), str(stage), str(out)],
        env=environment, check=False,
    )
    if ended.returncode != 0:
        return 1
    shutil.copytree(doxygen / "api", out / "api/cpp")
    shutil.copyfile(out / "README.html", out / "index.html")
    dead = dead_links(out)
    for link in dead:
        print(f"docs_site: dead link in {link}")
    shutil.rmtree(stage)
    return 1 if dead else 0


if __name__ == "__main__":
    sys.exit(main())
