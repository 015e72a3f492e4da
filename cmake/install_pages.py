"""Copies the pages of the documentation with their pictures, for the installation and for the site.

    install_pages.py SOURCES OUT PAGE...

Copies docs/ and the other pages that are named. The pages keep their folders. A link to a file that is not copied becomes its text, so
that no link is dead. A link to a file that does not exist is a mistake.
"""

import pathlib
import re
import shutil
import sys

LINK = re.compile(r"(!?)\[([^\]]*)\]\(([^)\s]+)\)")


def copy_pages(sources, out, pages, folders_too=True):
    """Copies all of them. Links to folders become text unless `folders_too`."""
    files = [path for path in sorted((sources / "docs").rglob("*")) if path.is_file()]
    files += [sources / page for page in pages]
    copied = set(files)
    if folders_too:
        copied |= {path.parent for path in files}

    def kept(page, link):
        target = link.group(3)
        if re.match(r"[a-z]+:|#", target):
            return link.group(0)
        there = (page.parent / target.split("#")[0]).resolve()
        if not there.exists():
            sys.exit(f"{page.relative_to(sources)}: link to '{target}', which does not exist")
        return link.group(0) if there in copied else link.group(2)

    for path in files:
        copy = out / path.relative_to(sources)
        copy.parent.mkdir(parents=True, exist_ok=True)
        if path.suffix == ".md":
            text = path.read_text(encoding="utf-8")
            copy.write_text(LINK.sub(lambda link, page=path: kept(page, link), text), encoding="utf-8")
        else:
            shutil.copyfile(path, copy)


if __name__ == "__main__":
    copy_pages(pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]), sys.argv[3:])
