"""Copies the pages of the documentation with their pictures, for the installation.

    install_pages.py SOURCES OUT PAGE...

Copies docs/ and the other pages that are named. The pages keep their folders. A link to a file that is not installed becomes its text, so that no link is dead.
"""

import pathlib
import re
import shutil
import sys

LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)")


def main():
    """Copies all of them."""
    sources, out = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    files = [path for path in sorted((sources / "docs").rglob("*")) if path.is_file()]
    files += [sources / page for page in sys.argv[3:]]
    installed = {place for path in files for place in (path, path.parent)}

    def kept(page, link):
        target = link.group(3)
        if re.match(r"[a-z]+:|#", target):
            return link.group(0)
        there = (page.parent / target.split("#")[0]).resolve()
        return link.group(0) if there in installed else link.group(2)

    for path in files:
        copy = out / path.relative_to(sources)
        copy.parent.mkdir(parents=True, exist_ok=True)
        if path.suffix == ".md":
            text = path.read_text(encoding="utf-8")
            copy.write_text(LINK.sub(lambda link, page=path: kept(page, link), text), encoding="utf-8")
        else:
            shutil.copyfile(path, copy)


if __name__ == "__main__":
    main()
