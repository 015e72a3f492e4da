"""Runs every command of the user's guide, page after page in one folder, as its reader would.

    guide_test.py GUIDE SONARCAL

Each fenced block of "sh" is a script of its own (set -e). A page without one, but for README.md, is a mistake.
Then the figures of the pages that compare must be those that the fit states for the same frames.
"""

import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile

BLOCK = re.compile(r"^```sh\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def check_figures(folder):
    """`compare` of pages 3 and 5 against `fit` of page 4, on the frame that was held out."""
    fit = json.loads((folder / "fitted/fit.json").read_text(encoding="utf-8"))
    for key, compared in (("metrics_before", "before"), ("metrics_after", "after")):
        metrics = json.loads((folder / compared / "metrics.json").read_text(encoding="utf-8"))
        assert fit[key]["segmentation"] == metrics["segmentation"], key
        for frame in fit[key]["frames"]:
            same = metrics["frames"][frame["index"]]
            assert frame["object_region"] == same["object_region"], key
            for name in ("iou", "ns_over_nr", "na_over_ns", "na_over_nr"):
                assert abs(frame[name] - same[name]) <= 0.01, f"{key}: {name} {frame[name]}, compared {same[name]}"
            for view in ("polar", "fan"):
                error, compared_error = frame["intensity_error"][view], same["intensity_error"][view]
                assert abs(error - compared_error) <= 0.01, f"{key}: {view} {error}, compared {compared_error}"
    before, after = (fit[key]["macro"] for key in ("metrics_before", "metrics_after"))
    worse = (after["iou"] < 0.99 * before["iou"]
             or after["intensity_error"]["polar"] > 1.01 * before["intensity_error"]["polar"])
    warned = any("makes the simulation worse" in sentence for sentence in fit["warnings"])
    assert worse == warned, f"worse: {worse}, warnings: {fit['warnings']}"


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
        check_figures(pathlib.Path(folder))
        linked = set(re.findall(r"\]\((\d\w+\.md)\)", (guide / "README.md").read_text(encoding="utf-8")))
        pages = {page.name for page in guide.glob("[0-9]*.md")}
        assert linked == pages, f"README.md links {sorted(linked ^ pages)} wrongly"
    print(f"ok: {count} blocks")
    return 0


if __name__ == "__main__":
    sys.exit(main())
