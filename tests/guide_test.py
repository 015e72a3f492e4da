"""Runs the commands of the user's guide in one folder, as its reader would, and compares what the pages show.

    guide_test.py GUIDE SONARCAL [--update-pictures]
    guide_test.py --self-test

The numbered pages come first, then those of ALSO_RUN. Each fenced block of "sh" is a script of its own (set -e). Three kinds are
not run: a block that calls scripts/, which is for a clone with a network; one with a value "..." or a recording REC, which its
reader fills in; and one that reads $SONARCAL_RECORDINGS without this folder. A plain block after it shows lines of its output, in
their order; "..." stands for lines, or the end of a line, that are left out. Numbers may differ a little, because processors round
differently. Blocks of other languages are neither run nor compared. A picture below a comment "made: FILE" looks like this file of
the commands; --update-pictures copies it into the sources. A numbered page without commands is a mistake.
"""

import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

ALSO_RUN = ["segmentation.md", "batch.md", "noise.md", "static.md", "export.md", "gallery.md", "standard_target.md", "explain.md",
            "poses.md", "calibrate.md", "rays.md", "locate.md", "moving.md"]

BLOCK = re.compile(r"^```(\w*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
PICTURE = re.compile(r"<!-- made: (\S+) -->\n!\[[^\]]*\]\((\S+)\)")
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e[-+]?\d+)?")

# A share of a number, and units of its last digit.
RELATIVE_TOLERANCE = 0.03
LAST_DIGITS = 2

# Mean difference of grey values, and median difference of the coordinates of a chart.
PICTURE_TOLERANCE = 3
CHART_TOLERANCE = 1


def same_number(shown, made):
    """Whether two numbers differ by rounding only."""
    digits = len(shown.partition(".")[2]) if "e" not in shown else 12
    tolerance = max(RELATIVE_TOLERANCE * abs(float(shown)), LAST_DIGITS * 10.0**-digits if digits else 0)
    return abs(float(shown) - float(made)) <= tolerance


def same_line(shown, made):
    """Whether a line of a page and one of an output have the same words and nearly the same numbers."""
    shown, made = shown.split(), made.split()
    if shown[-1:] == ["..."]:
        shown.pop()
        made = made[:len(shown)]
    shown, made = " ".join(shown), " ".join(made)
    if NUMBER.sub("#", shown) != NUMBER.sub("#", made):
        return False
    return all(map(same_number, NUMBER.findall(shown), NUMBER.findall(made)))


def first_missing(block, output):
    """First line of a block that the output does not have after the lines before it, or None."""
    made = iter(output.splitlines())
    for shown in block.splitlines():
        if shown.strip() in ("", "..."):
            continue
        if not any(same_line(shown, line) for line in made):
            return shown
    return None


def words_and_points(chart):
    """Words of a chart, and the coordinates of its marks: of a path, those of 21 points from end to end."""
    points = []
    for path in re.findall(r"<path[^>]* d=['\"]([^'\"]*)", chart):
        numbers = [float(number) for number in NUMBER.findall(path)]
        last = len(numbers) // 2 - 1
        for part in range(21):
            at = 2 * round(last * part / 20)
            points += numbers[at:at + 2]
    points += [float(number) for number in re.findall(r" c[xy]=['\"]([-.\d]+)", chart)]
    return re.findall(r">([^<>]+)</text>", chart), points


def picture_difference(shown, made):
    """How much two files differ: grey values of pictures, coordinates of charts."""
    if shown.suffix == ".svg":
        (words, points), (other_words, other_points) = (words_and_points(path.read_text(encoding="utf-8")) for path in (shown, made))
        if words != other_words or len(points) != len(other_points):
            return float("inf")
        differences = sorted(abs(a - b) for a, b in zip(points, other_points))
        return differences[len(differences) // 2] / CHART_TOLERANCE
    import matplotlib.image  # pylint: disable=import-outside-toplevel

    one, other = (matplotlib.image.imread(path) for path in (shown, made))
    if one.shape != other.shape:
        return float("inf")
    return 255 * float(abs(one.astype(float) - other).mean()) / PICTURE_TOLERANCE


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


def is_run(block):
    """Whether a block can be run here."""
    if "scripts/" in block or "=..." in block or " REC " in block:
        return False
    needed = re.findall(r"\$SONARCAL_RECORDINGS/([\w/]+)", block)
    recordings = os.environ.get("SONARCAL_RECORDINGS")
    return not needed or (bool(recordings) and all(pathlib.Path(recordings, name).exists() for name in needed))


def run_page(page, folder, environment):
    """Runs and compares one page. Returns counts of what was compared, and what is wrong."""
    text = page.read_text(encoding="utf-8")
    counts, wrong, output, left_out = [0, 0, 0], [], None, False
    for language, block in BLOCK.findall(text):
        if language == "sh":
            output = None
            if not is_run(block):
                print(f"{page.name}: not run here: {block.splitlines()[0]}")
                left_out = True
                continue
            ended = subprocess.run(
                ["bash", "-euo", "pipefail", "-c", block],
                cwd=folder, env=environment, text=True, check=False, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
            )
            if ended.returncode != 0:
                return counts, [f"{page.name}: ended with {ended.returncode}:\n{block}\n{ended.stdout}"]
            output = ended.stdout
            counts[0] += 1
        elif language == "" and output is not None:
            missing = first_missing(block, output)
            if missing is not None:
                wrong.append(f"{page.name} shows\n{missing}\nwhich is not, in this place, in\n{output}")
            counts[1] += 1
    for made, shown in PICTURE.findall(text):
        made, shown = folder / made, page.parent / shown
        if left_out and not made.exists():
            continue
        if "--update-pictures" in sys.argv:
            shutil.copyfile(made, shown)
        elif picture_difference(shown, made) > 1:
            wrong.append(f"{page.name}: {shown.name} does not look like {made.name}, which its commands made")
        counts[2] += 1
    return counts, wrong


def self_test():
    """Small differences pass, others do not."""
    output = "a table\n  IoU   0.939 [0.932, 0.946]\n  noise  93.99  0.04  dB\nend\n"
    assert first_missing("IoU 0.941 [0.930, 0.946]\n...\nend\n", output) is None
    assert first_missing("IoU 0.901 [0.932, 0.946]\n", output) is not None
    assert first_missing("noise 93.99 0.04 m\n", output) is not None
    assert first_missing("IoU 0.941 ...\nend\n", output) is None
    assert first_missing("IoU 0.901 ...\n", output) is not None
    assert first_missing("end\n...\na table\n", output) == "a table"
    for block in ("scripts/setup.sh", "export FOLDER=...", "sonarcal inspect REC --json"):
        assert not is_run(block)
    assert is_run("sonarcal sonars\n")
    with tempfile.TemporaryDirectory() as folder:
        one, other = pathlib.Path(folder, "1.svg"), pathlib.Path(folder, "2.svg")
        one.write_text("<path d='M 1 2 L 3 4'/>", encoding="utf-8")
        other.write_text("<path d='M 5 6 L 7 8'/>", encoding="utf-8")
        assert picture_difference(one, one) == 0 and picture_difference(one, other) > 1
    print("ok")


def main():
    """Runs the pages in their order."""
    if sys.argv[1] == "--self-test":
        return self_test()
    guide, sonarcal = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]).resolve()
    environment = dict(os.environ, PATH=f"{sonarcal.parent}:{os.environ['PATH']}")
    totals, wrong = [0, 0, 0], []
    numbered = sorted(guide.glob("[0-9]*.md"))
    with tempfile.TemporaryDirectory() as folder:
        for page in [*numbered, *(guide / name for name in ALSO_RUN)]:
            start_s = time.monotonic()
            counts, faults = run_page(page, pathlib.Path(folder), environment)
            print(f"{page.name}: {time.monotonic() - start_s:.0f} s")
            totals = [sum(pair) for pair in zip(totals, counts)]
            wrong += faults
            if page in numbered and not faults:
                assert counts[0], f"{page.name} has no commands"
        print("\n".join(wrong))
        if wrong:
            return 1
        check_figures(pathlib.Path(folder))
    linked = set(re.findall(r"\]\((\d\w+\.md)\)", (guide / "README.md").read_text(encoding="utf-8")))
    pages = {page.name for page in numbered}
    assert linked == pages, f"README.md links {sorted(linked ^ pages)} wrongly"
    assert totals[2] > 5, "the pages show hardly a picture"
    print("ok: {} blocks run, {} outputs and {} pictures compared".format(*totals))
    return 0


if __name__ == "__main__":
    sys.exit(main())
