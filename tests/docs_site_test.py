"""The documentation site can be built, its search knows pages, C++ and commands, and a dead link fails.

    docs_site_test.py BUILD SITE
"""

import pathlib
import subprocess
import sys
import tempfile

sys.dont_write_bytecode = True
sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "cmake/docs_site"))

import make_site  # noqa: E402  pylint: disable=wrong-import-position,import-error


def check_dead_links(folder):
    """A missing file and a missing place in a file are found, and nothing else."""
    folder.joinpath("other.html").write_text('<p id="there"></p>', encoding="utf-8")
    folder.joinpath("page.html").write_text(
        '<a href="other.html#there"></a><a href="https://example.org"></a><a href="other.html#gone"></a><img src="gone.png">',
        encoding="utf-8",
    )
    assert make_site.dead_links(folder) == ["page.html: other.html#gone", "page.html: gone.png"]


def check_missing_page(folder):
    """A link of a page to a file that the sources do not have ends the build."""
    sources = folder / "sources"
    sources.joinpath("docs").mkdir(parents=True)
    sources.joinpath("docs/page.md").write_text("[here](page.md) [nowhere](gone.md)", encoding="utf-8")
    try:
        make_site.install_pages.copy_pages(sources, folder / "copy", [])
    except SystemExit as ended:
        assert ended.code == "docs/page.md: link to 'gone.md', which does not exist", ended.code
    else:
        raise AssertionError("a link to a missing page was taken")


def main():
    """The test."""
    for check in (check_dead_links, check_missing_page):
        with tempfile.TemporaryDirectory() as folder:
            check(pathlib.Path(folder).resolve())
    build, site = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
    subprocess.run(["cmake", "--build", str(build), "--target", "docs_site"], check=True)
    index = site.joinpath("searchindex.js").read_text(encoding="utf-8")
    words = ["raycast", "speckl"]  # a class of C++, and the stem of a word of the pages
    if list(build.glob("python/sonarcal/_sonarcal*.so")):
        words.append("residual_view")
    for word in words:
        assert f'"{word}"' in index or f"{word}:" in index, f"the search does not know '{word}'"
    for page in ("index.html", "docs/guide/4_fit.html", "data_io/README.html", "api/python.html", "api/cpp/index.html"):
        assert site.joinpath(page).is_file(), f"the site has no {page}"
    print("ok")


if __name__ == "__main__":
    main()
