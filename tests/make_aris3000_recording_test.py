"""scripts/make_aris3000_recording.py on made-up frames and, if they are there, on the published ones.

    make_aris3000_recording_test.py SONARCAL
"""

import json
import os
import pathlib
import random
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "scripts"))
import make_aris3000_recording as script  # noqa: E402  pylint: disable=wrong-import-position

SONARCAL = sys.argv[1]
PIXELS = script.RANGE_BINS * script.BEAMS


def run(published, out):
    """Status and standard error of the script."""
    command = [sys.executable, str(ROOT / "scripts/make_aris3000_recording.py"), str(published), str(out)]
    done = subprocess.run(command, stderr=subprocess.PIPE, text=True, check=False)
    return done.returncode, done.stderr


def counts_of(counts):
    """Counts about a smooth slope."""
    return [(i * 7 + i // script.BEAMS) % (counts + 1) for i in range(PIXELS)]


def stretched(counts, interpolated):
    """Those counts stretched; one pixel in `interpolated` lies between the levels."""
    greys = [count * 255 // counts for count in counts_of(counts)]
    for i in range(interpolated - 1, PIXELS, interpolated):
        greys[i] = min(255, greys[i] + 1)
    return bytes(greys)


def frame(folder, index, image):
    """Writes a made-up frame."""
    script.write_png(folder / f"frame_{index:04}_128x780.png", image)


def noise():
    """An image of no particular levels."""
    return random.Random(1).randbytes(PIXELS)


def fresh(folder, name):
    """An empty folder and a path that is not there."""
    published = folder / name
    published.mkdir()
    return published, folder / f"{name}_recording"


def check_counts(folder):
    """N follows from the levels, and becomes the dB scale."""
    for counts in (97, 96, 95, 60, 31):
        assert script.stretched_counts(stretched(counts, 100)) == counts
    published, out = fresh(folder, "counts")
    frame(published, 7, stretched(60, 100))
    assert run(published, out) == (0, "")
    recording = json.loads((out / "recording.json").read_text(encoding="utf-8"))
    assert abs(recording["image"]["db_span"] - 60 * 80 / 255) < 1e-12
    assert "N = 60, a count" in recording["notes"][-1], recording["notes"]
    assert recording["frames"] == [{"file": "frame_0007_128x780.png"}]
    assert recording["sonar"]["beam_azimuth_deg"][0] == -15.0068, "the template's beams"


def check_one_scale(folder):
    """Frames of different N are shown on the scale of the largest."""
    published, out = fresh(folder, "one_scale")
    frame(published, 0, stretched(95, PIXELS + 1))
    frame(published, 1, stretched(97, PIXELS + 1))
    assert run(published, out) == (0, "")
    recording = json.loads((out / "recording.json").read_text(encoding="utf-8"))
    assert abs(recording["image"]["db_span"] - 97 * 80 / 255) < 1e-12
    assert "N = 95 to 97" in recording["notes"][-1]
    for index, counts in enumerate((95, 97)):
        greys = script.read_png(out / f"frame_{index:04}_128x780.png")[2]
        assert list(greys) == [count * 255 // 97 for count in counts_of(counts)], counts


def check_unknown(folder):
    """Without a clear N the dB scale stays unknown."""
    published, out = fresh(folder, "unknown")
    frame(published, 0, noise())
    assert run(published, out) == (0, "")
    recording = json.loads((out / "recording.json").read_text(encoding="utf-8"))
    assert "db_span" not in recording["image"] and "the dB scale is unknown" in recording["notes"][-1]
    subprocess.run([SONARCAL, "inspect", str(out)], stdout=subprocess.DEVNULL, check=True)


def check_refusals(folder):
    """Mistakes cost one sentence and leave nothing behind."""
    published, out = fresh(folder, "refused")
    picture = published / "frame_0000_128x780.png"

    def expect(part):
        status, error = run(published, out)
        assert status == 1 and part in error and error.count("\n") == 1, error
        assert not out.exists()

    expect("no frame_NNNN_128x780.png")
    picture.write_bytes(b"nothing")
    expect("expected an 8-bit grey PNG of 780 x 128 pixels")
    frame(published, 0, noise()[: -script.BEAMS])
    expect("the picture is damaged")
    frame(published, 0, noise())
    whole = picture.read_bytes()
    picture.write_bytes(whole[:50000])
    expect("cut off")
    picture.write_bytes(whole)
    rows = [f"{beam},{0.2 * beam - 13}" for beam in range(script.BEAMS)]
    for table, part in (
        ([], "0 beams, expected 128"),
        (["0,-1.0"], "1 beams, expected 128"),
        (["0,-1.0", "2,-0.5"], ":3: '2,-0.5', expected"),
        (["0,nan"], "'0,nan'"),
        (["0"], "expected 'beam,center_deg,...'"),
        (rows[:5] + ["5,-90"] + rows[6:], "from left to right"),
    ):
        (published / script.BEAM_TABLE).write_text("\n".join(["beam,center_deg", *table]), encoding="utf-8")
        expect(part)


def check_published(folder):
    """The published frames give the recording.json of cases/bomb, byte for byte."""
    recordings = pathlib.Path(os.environ.get("SONARCAL_RECORDINGS") or ROOT / "recordings")
    published = recordings / "aris3000_uxo"
    if not published.is_dir():
        return "skipped (not there)"
    out = folder / "published"
    assert run(published, out) == (0, "")
    assert (out / "recording.json").read_bytes() == script.TEMPLATE.read_bytes()
    for path in published.glob("frame_*.png"):
        assert (out / path.name).read_bytes() == path.read_bytes()
    inspected = subprocess.run([SONARCAL, "inspect", str(out)], stdout=subprocess.PIPE, text=True, check=True).stdout
    for part in ("780 bins of 2.959 mm", "128 from -15.01° to +15.02°", "spanning 30.43 dB", "formed by a lens"):
        assert part in inspected, inspected
    other = folder / "other"
    subprocess.run(
        [sys.executable, str(ROOT / "scripts/make_aris3000_recording.py"), str(published), str(other)]
        + ["--other-pose", str(ROOT / "cases/bomb/case.json")],
        check=True,
    )
    inspected = subprocess.run([SONARCAL, "inspect", str(other)], stdout=subprocess.PIPE, text=True, check=True).stdout
    for part in ("780 bins of 2.959 mm", "spanning 80 dB", "nearest pixel"):
        assert part in inspected, inspected
    return "checked"


def main():
    """The test."""
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        check_counts(folder)
        check_one_scale(folder)
        check_unknown(folder)
        check_refusals(folder)
        print("ok: published frames", check_published(folder))


if __name__ == "__main__":
    main()
