#!/usr/bin/env python3
"""The picture of docs/reference/parameters.md that explains A to F, drawn from the formula of GSAB.

usage: scripts/gsab_picture.py docs/images/gsab_curve.svg
"""
import math
import sys
from pathlib import Path

# Power ratios and degrees: the curve of tests/sim/physics/gsab_test.cc.
A, B, C, D, E, F = 10**-0.8, 3.0, 10**-2.4, 2.0, 10**-1.8, 12.0
WIDTH, HEIGHT = 860, 470
LEFT, RIGHT, TOP, BOTTOM = 76, 846, 52, 410
LOW_DB, HIGH_DB = -50.0, 0.0
BLUE, GREEN, ORANGE = "#1f6fb4", "#2f8f57", "#c2410c"


def specular(deg):
    return A * math.exp(-(deg**2) / (2 * B**2))


def oblique(deg):
    return C * max(0.0, math.cos(math.radians(deg))) ** D


def transitional(deg):
    return E * math.exp(-(deg**2) / (2 * F**2))


def gsab(deg):
    return specular(deg) + oblique(deg) + transitional(deg)


def db(power):
    return 10 * math.log10(max(power, 1e-30))


def x_of(deg):
    return LEFT + (RIGHT - LEFT) * deg / 90


def y_of(level_db):
    return TOP + (BOTTOM - TOP) * (HIGH_DB - level_db) / (HIGH_DB - LOW_DB)


def curve(power, color, width, dashes=""):
    points = []
    for step in range(901):
        level = db(power(step / 10))
        if level < LOW_DB:
            break
        points.append(f"{x_of(step / 10):.1f},{y_of(level):.1f}")
    dash = f' stroke-dasharray="{dashes}"' if dashes else ""
    return f'<polyline points="{" ".join(points)}" fill="none" stroke="{color}" stroke-width="{width}"{dash}/>'


def minus(number):
    return number.replace("-", "−")


# Attributes rather than a style sheet, which the policy of the live view would refuse.
TEXT = ('font-family="Arial, Helvetica, sans-serif" font-size="14" paint-order="stroke" stroke="#ffffff" '
        'stroke-width="4"')


def text(x, y, words, color="#1c2733", anchor="start", weight="normal"):
    return (f'<text {TEXT} x="{x:.1f}" y="{y:.1f}" fill="{color}" text-anchor="{anchor}" font-weight="{weight}">{words}'
            '</text>')


def line(x1, y1, x2, y2, color="#44525f", extra=""):
    return f'<line x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}" stroke="{color}" {extra}/>'


def axes():
    parts = []
    for deg in range(0, 91, 10):
        parts.append(line(x_of(deg), TOP, x_of(deg), BOTTOM, "#e1e6ea"))
        parts.append(text(x_of(deg), BOTTOM + 20, deg, anchor="middle"))
    for level in range(int(LOW_DB), int(HIGH_DB) + 1, 10):
        parts.append(line(LEFT, y_of(level), RIGHT, y_of(level), "#e1e6ea"))
        parts.append(text(LEFT - 8, y_of(level) + 5, minus(str(level)), anchor="end"))
    words = "incidence angle δ, degrees (0: the ray meets the surface head-on)"
    parts.append(text((LEFT + RIGHT) / 2, BOTTOM + 44, words, anchor="middle"))
    parts.append(f'<text {TEXT} transform="translate(22 {(TOP + BOTTOM) / 2}) rotate(-90)" text-anchor="middle">10 log10 GSAB, dB</text>')
    return parts


def amplitude(name, power, color):
    """A tick at normal incidence with the level of one term there."""
    y = y_of(db(power))
    return [f'<circle cx="{LEFT}" cy="{y:.1f}" r="4.5" fill="{color}"/>', text(LEFT + 9, y - 7, name, color, weight="bold")]


def half_width(name, power, peak, deg, color):
    """An arrow from normal incidence to the angle where a peak has fallen by 2.17 dB, a factor exp(-1/2)."""
    y = y_of(db(power(deg)))
    fallen = minus(f"{10 * math.log10(power(deg) / peak):.1f}")
    return [line(LEFT, y, x_of(deg), y, color, 'stroke-width="1.5" marker-end="url(#end)" stroke-dasharray="3 2"'),
            text(x_of(deg) + 16, y + 5, f'<tspan font-weight="bold">{name}</tspan>: {fallen} dB here', color)]


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    parts = axes()
    parts += [curve(specular, BLUE, 2, "7 4"), curve(transitional, GREEN, 2, "7 4"), curve(oblique, ORANGE, 2, "7 4"),
              curve(gsab, "#1c2733", 2.6)]
    parts += amplitude("A", A, BLUE) + amplitude("E", E, GREEN) + amplitude("C", C, ORANGE)
    parts += half_width("B", specular, A, B, BLUE) + half_width("F", transitional, E, F, GREEN)
    words = '<tspan font-weight="bold">D</tspan>: how fast it falls, cos(δ)^D'
    parts.append(text(x_of(62), y_of(db(oblique(62))) - 14, words, ORANGE))
    legend = [("#1c2733", "GSAB, the sum"), (BLUE, "specular: A exp(−δ² / 2 B²)"),
              (GREEN, "transitional: E exp(−δ² / 2 F²)"), (ORANGE, "oblique: C cos(δ)^D")]
    for row, (color, words) in enumerate(legend):
        parts.append(text(560, TOP + 24 + 21 * row, words, color, weight="bold" if row == 0 else "normal"))
    words = f"A {db(A):.0f} dB, B {B:g}°, C {db(C):.0f} dB, D {D:g}, E {db(E):.0f} dB, F {F:g}°"
    parts.append(text(LEFT, 30, minus(words)))
    body = "\n".join(parts)
    Path(sys.argv[1]).write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}" role="img" '
        f'aria-labelledby="title">\n<title id="title">The six parameters of the backscatter curve GSAB</title>\n'
        '<defs><marker id="end" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto">'
        '<path d="M0 0 L8 4 L0 8 Z" fill="#44525f"/></marker></defs>\n'
        f'<rect width="{WIDTH}" height="{HEIGHT}" fill="#ffffff"/>\n{body}\n</svg>\n', encoding="utf-8")


main()
