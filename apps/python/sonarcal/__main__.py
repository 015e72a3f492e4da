"""Runs the program `sonarcal`, as the command `sonarcal` of an installation with pip and as python -m sonarcal."""

from __future__ import annotations

import os
import pathlib
import shutil
import sys
from typing import NoReturn


def main() -> NoReturn:
    """Replaces this process by the program, with the same arguments."""
    packaged = pathlib.Path(__file__).parent / "bin" / "sonarcal"
    program = str(packaged) if packaged.is_file() else shutil.which("sonarcal")
    if program is None:
        sys.exit("sonarcal: the program is neither in the Python package nor on PATH")
    os.execv(program, ["sonarcal", *sys.argv[1:]])


if __name__ == "__main__":
    main()
