#!/usr/bin/env python3
"""Makes a recording folder from published frames of an ARIS 3000, so that every command of sonarcal reads them.

usage: scripts/make_aris3000_recording.py PUBLISHED OUT [--template RECORDING_JSON] [--other-pose CASE_JSON]

PUBLISHED holds frame_NNNN_128x780.png: 8-bit grey, 780 range bins (row 0 nearest) by 128 beams, recovered from the
pictures of github.com/dfki-ric/uxo-dataset2024. beam_table_ARIS3000_128.csv (beam,center_deg,...) may lie beside them.
OUT gets the frames and recording.json (docs/reference/recording.md). Sonar, window and beams that the frames do not
state come from the template, by default cases/bomb/recording.json.

Each published frame was stretched over its own grey levels: grey = floor(count * 255 / N). One count is 80/255 dB. The
script finds N from the levels that occur. Frames with a smaller N are shown with the largest N, so that a grey level
means the same level in dB in all frames. If N cannot be found, the dB scale stays unknown.

With --other-pose, OUT gets instead the one picture of the object in another pose. The plan of the case (cases/bomb/
case.json) says where the fan lies in the picture. Each sample is the nearest pixel. The picture was not stretched.
"""

import argparse
import json
import math
import pathlib
import re
import shutil
import struct
import sys
import zlib

BEAMS = 128
RANGE_BINS = 780
DB_PER_COUNT = 80.0 / 255.0
FRAME = re.compile(r"frame_\d+_128x780\.png")
BEAM_TABLE = "beam_table_ARIS3000_128.csv"
TEMPLATE = pathlib.Path(__file__).resolve().parent.parent / "cases" / "bomb" / "recording.json"
SIGNATURE = b"\x89PNG\r\n\x1a\n"


def fail(message):
    """Ends the program with one sentence."""
    sys.exit(f"make_aris3000_recording.py: {message}")


def chunks(data, path):
    """Type and content of each chunk of a PNG file."""
    at = len(SIGNATURE)
    while at + 12 <= len(data):
        (length,) = struct.unpack(">I", data[at : at + 4])
        if at + 12 + length > len(data):
            fail(f"{path}: the file is cut off")
        yield data[at + 4 : at + 8], data[at + 8 : at + 8 + length]
        at += 12 + length


def unfiltered(raw, width):
    """Grey levels of the filtered rows of an 8-bit grey PNG, row after row."""
    image = bytearray()
    above = [0] * (width + 1)  # with a pixel to the left
    for start in range(0, len(raw), width + 1):
        kind = raw[start]
        row = [0]
        for col, value in enumerate(raw[start + 1 : start + width + 1], start=1):
            left, up, corner = row[-1], above[col], above[col - 1]
            paeth = min((left, up, corner), key=lambda p: abs(left + up - corner - p))
            row.append((value + (0, left, up, (left + up) // 2, paeth)[kind]) % 256)
        image += bytes(row[1:])
        above = row
    return bytes(image)


def read_png(path, size=(BEAMS, RANGE_BINS)):
    """Width, height and grey levels of a PNG, row after row. `size`: the expected one; None: any."""
    data = path.read_bytes()
    parts = {}
    if data.startswith(SIGNATURE):
        for kind, content in chunks(data, path):
            parts[kind] = parts.get(kind, b"") + content
    header = parts.get(b"IHDR", b"")
    width, height = size or (struct.unpack(">II", header[:8]) if len(header) == 13 else (0, 0))
    if header != struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0):
        fail(f"{path}: expected an 8-bit grey PNG" + (f" of {height} x {width} pixels" if size else ""))
    try:
        raw = zlib.decompress(parts.get(b"IDAT", b""))
    except zlib.error as error:
        fail(f"{path}: {error}")
    if len(raw) != height * (width + 1) or max(raw[:: width + 1]) > 4:
        fail(f"{path}: the picture is damaged")
    return width, height, unfiltered(raw, width)


def write_png(path, image):
    """Writes an 8-bit grey PNG."""
    raw = b"".join(b"\0" + image[start : start + BEAMS] for start in range(0, len(image), BEAMS))
    header = struct.pack(">IIBBBBB", BEAMS, RANGE_BINS, 8, 0, 0, 0, 0)
    parts = ((b"IHDR", header), (b"IDAT", zlib.compress(raw, 9)), (b"IEND", b""))
    with path.open("wb") as file:
        file.write(SIGNATURE)
        for kind, content in parts:
            file.write(struct.pack(">I", len(content)) + kind + content)
            file.write(struct.pack(">I", zlib.crc32(kind + content)))


def stretched_counts(image):
    """The N of grey = floor(count * 255 / N), or None if no N stands out. A few pixels may be interpolated."""
    share = [image.count(level) / len(image) for level in range(256)]
    best, best_excess = None, 0.2
    for counts in range(16, 255):
        # Share of the pixels on the levels that N counts can have, beyond the share of such levels.
        excess = sum(share[count * 255 // counts] - 1 / 256 for count in range(counts + 1))
        if excess > best_excess:
            best, best_excess = counts, excess
    return best


def read_beam_table(path):
    """Beam centres in degrees."""
    centres = []
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines()[1:], start=2):
        fields = line.split(",")
        try:
            beam, centre = int(fields[0]), float(fields[1])
        except (IndexError, ValueError):
            beam, centre = -1, math.nan
        if beam != len(centres) or not math.isfinite(centre):
            fail(f"{path}:{number}: '{line}', expected 'beam,center_deg,...' of beam {len(centres)}")
        if centres and centre <= centres[-1]:
            fail(f"{path}:{number}: '{line}', expected beams from left to right")
        centres.append(centre)
    if len(centres) != BEAMS:
        fail(f"{path}: {len(centres)} beams, expected {BEAMS}")
    return centres


def scale_note(counts):
    """A sentence about the stretching."""
    if None in counts:
        return "The grey levels that occur do not show how each frame was stretched: the dB scale is unknown."
    fewest, most = min(counts), max(counts)
    shown = f"{most}" if fewest == most else f"{fewest} to {most} (all are shown as with N = {most})"
    return (
        "Grey values were stretched, frame by frame: grey = floor(count * 255 / N), "
        f"N = {shown}, a count being 80/255 dB."
    )


def sample_fan(picture, fan, sonar):
    """Grey levels of the fan of a picture at the beams and range bins of a sonar, row after row."""
    width, height, grey = picture
    (apex_x, apex_y), (radius_min, radius_max) = fan["apex_px"], fan["radius_px"]
    image = bytearray()
    for range_bin in range(RANGE_BINS):
        radius = radius_min + (range_bin + 0.5) / RANGE_BINS * (radius_max - radius_min)
        for azimuth_deg in sonar["beam_azimuth_deg"]:
            azimuth = math.radians(azimuth_deg)
            row = math.floor(apex_y - radius * math.cos(azimuth) + 0.5)
            col = math.floor(apex_x + fan.get("x_scale", 1.0) * radius * math.sin(azimuth) + 0.5)
            if not (0 <= row < height and 0 <= col < width):
                fail(f"the picture of {width} x {height} pixels does not hold the whole fan")
            image.append(grey[row * width + col])
    return bytes(image)


def write_recording(out, recording):
    """Writes recording.json, with lists of numbers on one line."""
    text = json.dumps(recording, indent=1, ensure_ascii=False)
    text = re.sub(r"\[[-\d.,\s]+\]", lambda list_: re.sub(r"\s+", "", list_[0]).replace(",", ", "), text)
    (out / "recording.json").write_text(text + "\n", encoding="utf-8")


def make_other_pose(arguments, recording):
    """Writes the recording of the other pose."""
    other = json.loads(arguments.other_pose.read_text(encoding="utf-8"))["target"]["other_view"]
    image = sample_fan(read_png(arguments.published / other["picture"], None), other["fan"], recording["sonar"])
    recording["image"]["db_span"] = other["db_span"]
    recording["notes"] = [note for note in recording["notes"] if "stretched" not in note and "frames are of" not in note]
    recording["notes"].append("Each sample is the nearest pixel of a fan picture, which was not stretched.")
    recording["frames"] = [{"file": "frame_0000.png"}]
    arguments.out.mkdir(parents=True)
    write_png(arguments.out / "frame_0000.png", image)
    write_recording(arguments.out, recording)


def main():
    """The program."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("published", type=pathlib.Path)
    parser.add_argument("out", type=pathlib.Path)
    parser.add_argument("--template", type=pathlib.Path, default=TEMPLATE)
    parser.add_argument("--other-pose", type=pathlib.Path, metavar="CASE_JSON")
    arguments = parser.parse_args()

    frames = sorted(path for path in arguments.published.glob("*.png") if FRAME.fullmatch(path.name))
    if not frames:
        fail(f"{arguments.published}: no frame_NNNN_128x780.png in it")
    recording = json.loads(arguments.template.read_text(encoding="utf-8"))
    table = arguments.published / BEAM_TABLE
    if table.is_file():
        recording["sonar"]["beam_azimuth_deg"] = read_beam_table(table)
    if arguments.other_pose:
        make_other_pose(arguments, recording)
        return
    images = [read_png(path)[2] for path in frames]
    counts = [stretched_counts(image) for image in images]
    scale = None if None in counts else max(counts)
    recording["image"].pop("db_span", None)
    if scale is not None:
        recording["image"]["db_span"] = scale * DB_PER_COUNT
    recording["notes"] = [note for note in recording["notes"] if "stretched" not in note] + [scale_note(counts)]
    recording["frames"] = [{"file": path.name} for path in frames]

    arguments.out.mkdir(parents=True)
    for path, image, own in zip(frames, images, counts):
        if scale is None or own == scale:
            shutil.copyfile(path, arguments.out / path.name)
        else:
            write_png(arguments.out / path.name, bytes(-(-grey * own // 255) * 255 // scale for grey in image))
    write_recording(arguments.out, recording)


if __name__ == "__main__":
    main()
