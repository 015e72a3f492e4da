#!/usr/bin/env python3
"""The picture of docs/studies/bomb.md, from what `sonarcal reproduce --out REPORT` wrote.

usage: scripts/bomb_pictures.py REPORT docs/images/bomb_models.png

Recorded, the paper's model fitted, the acoustic model fitted (expected image, speckled sample): the part of the
polar image that shows the bomb, side by side, in 64 colours.
"""
import sys
from pathlib import Path

from PIL import Image

BOX = (0.0, 0.08, 0.8, 0.42)  # left, top, right, bottom, of the picture
GAP_PX = 6


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    report = Path(sys.argv[1])
    files = [
        report / "bomb_pictures/frame_0001_polar_real.png",
        report / "bomb_pictures/frame_0001_polar_simulated.png",
        report / "bomb_acoustic_pictures/frame_0001_polar_simulated.png",
        report / "bomb_acoustic_sample_pictures/frame_0001_polar_simulated.png",
    ]
    parts = []
    for file in files:
        image = Image.open(file).convert("RGB")
        width, height = image.size
        parts.append(image.crop((int(BOX[0] * width), int(BOX[1] * height), int(BOX[2] * width), int(BOX[3] * height))))
    width, height = parts[0].size
    joined = Image.new("RGB", (2 * width + GAP_PX, 2 * height + GAP_PX), "white")
    for i, part in enumerate(parts):
        joined.paste(part, ((i % 2) * (width + GAP_PX), (i // 2) * (height + GAP_PX)))
    joined.quantize(64).save(sys.argv[2], optimize=True)


main()
