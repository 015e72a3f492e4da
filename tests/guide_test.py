"""Runs every command of the user's guide, page after page in one folder, as its reader would.

    guide_test.py GUIDE SONARCAL

Each fenced block of "sh" is a script of its own (set -e). A page without one, but for README.md, is a mistake.
"""

import os
import pathlib
import re
import subprocess
import sys
import tempfile

BLOCK = re.compile(r"^```sh\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def main():
    """Runs the pages in the order of their names."""
    guide, sonarcal = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    environment = dict(os.environ, PATH=f"{sonarcal.parent}:{os.environ['PATH']}")
    count = 0
    with tempfile.TemporaryDirectory() as folder:
        for page in sorted(guide.glob("[0-9]*.md")):
            blocks = BLOCK.findall(page.read_text(encoding="utf-8"))
            assert blocks, f"{page.name} has no commands"
            for block in blocks:
                ended = subprocess.run(
                    ["bash", "-euo", "pipefail", "-c", block],
                    cwd=folder, env=environment, text=True, check=False,
                    stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                )
                if ended.returncode != 0:
                    print(f"{page.name}: ended with {ended.returncode}:\n{block}\n{ended.stdout}")
                    return 1
                count += 1
        linked = set(re.findall(r"\]\((\d\w+\.md)\)", (guide / "README.md").read_text(encoding="utf-8")))
        pages = {page.name for page in guide.glob("[0-9]*.md")}
        assert linked == pages, f"README.md links {sorted(linked ^ pages)} wrongly"
    print(f"ok: {count} blocks")
    return 0


if __name__ == "__main__":
    sys.exit(main())
