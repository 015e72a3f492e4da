#!/usr/bin/env python3
"""A picture of docs/studies/explain.md, from what `sonarcal explain --known ... --out EXPLAINED` wrote.

usage: scripts/explain_pictures.py EXPLAINED NUMBER,NUMBER FRAME OUT.png
  NUMBER  of the waterfalls in EXPLAINED/figures
  FRAME   held out, whose map of causes stands beside them; no recorded pixel is shown

Needs Chromium and python3-pil.
"""
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

WIDTH, MAP_WIDTH, GAP = 720, 230, 10


def main():
    if len(sys.argv) != 5:
        sys.exit(__doc__)
    explained, numbers, frame, out = Path(sys.argv[1]).resolve(), sys.argv[2].split(","), int(sys.argv[3]), sys.argv[4]
    figures = [explained / f"figures/figure_{number}.svg" for number in numbers]
    causes = explained / f"causes_{frame:04}_picture.png"
    html = "".join(f'<img src="{figure.as_uri()}" style="display:block">' for figure in figures)
    map_html = f'<img src="{causes.as_uri()}" style="width:{MAP_WIDTH}px;position:absolute;right:0;top:0">'
    with tempfile.TemporaryDirectory() as folder:
        page, shot = Path(folder) / "page.html", Path(folder) / "shot.png"
        page.write_text(f'<body style="margin:0;background:white">{html}{map_html}')
        subprocess.run(
            ["chromium", "--headless", "--no-sandbox", "--hide-scrollbars", f"--window-size={WIDTH + MAP_WIDTH + GAP},1000",
             f"--screenshot={shot}", page.as_uri()], check=True, capture_output=True)
        image = Image.open(shot).convert("RGB")
    white = Image.new("RGB", image.size, "white")
    changed = [y for y in range(image.height) if image.crop((0, y, image.width, y + 1)).tobytes()
               != white.crop((0, y, image.width, y + 1)).tobytes()]
    image = image.crop((0, 0, image.width, min(image.height, changed[-1] + GAP)))
    image.quantize(64).save(out, optimize=True)


main()
