"""Keyword arguments as the words of the commands' options, of which they have the names, units and defaults."""

from __future__ import annotations

import os
from typing import Any, Iterable, Mapping

# How a tuple is written, where not with commas.
_BY_X = {"rays", "cell", "guard", "training", "blur", "opening", "closing", "max_size", "object_margin"}
_BY_COLON = {"region_range", "region_azimuth", "sweep_range"}


def _text(name: str, value: Any) -> str:
    if isinstance(value, (str, os.PathLike)):
        return os.fspath(value)
    if isinstance(value, range):
        if value.step != 1:
            raise ValueError(f"{name}: expected a range of step 1, not {value}")
        return f"{value.start}:{value.stop}"
    if name == "frames":
        raise ValueError(f"frames: expected range(A, B) or 'A:B', as they follow each other, not {value}")
    if name == "region_polygon":
        return ",".join(f"{range_m}:{azimuth_deg}" for range_m, azimuth_deg in value)
    if isinstance(value, Iterable):
        separator = "x" if name in _BY_X else ":" if name in _BY_COLON else ","
        return separator.join(str(item) for item in value)
    return str(value)


def words(options: Mapping[str, Any]) -> list[str]:
    """`{"bits": 12, "noise": True, "seed": None}` as `["--bits=12", "--noise"]`: None and False say nothing."""
    result = []
    for name, value in options.items():
        option = "--" + name.replace("_", "-")
        if value is None or value is False:
            continue
        result.append(option if value is True else f"{option}={_text(name, value)}")
    return result
