#!/usr/bin/env python3
"""Counts the images per second that `sonarcal view` shows in headless Chromium while a control moves.

usage: view_rates.py SONARCAL RECORDING SCENE PARAMS

Drags the slider of a material's curve, then moves the sonar upwards, each for some seconds, and prints the images
per second of either and their limits. Needs Chromium, ChromeDriver and Selenium (python3-selenium).
"""

import pathlib
import sys
import tempfile

TESTS = pathlib.Path(__file__).resolve().parent.parent / "apps" / "view"
sys.path.insert(0, str(TESTS))
import view_in_browser  # noqa: E402  pylint: disable=wrong-import-position

SECONDS = 6
LIMITS = {"a slider moves": 10, "the sonar moves": 5}

# Moves a control on each picture that the browser draws, as a hand does. Counts the images shown meanwhile.
COUNT = """
const [control, seconds, done] = arguments;
const from = Number(control.value), step = (control.max - control.min) / 400;
const began = performance.now();
let images = 0, shown = view.shown, moves = 0;
function move() {
  if (view.shown !== shown) { ++images; shown = view.shown; }
  const past = performance.now() - began;
  if (past > 1000 * seconds) return done(1000 * images / past);
  control.value = from + step * (++moves % 40);
  control.dispatchEvent(new Event('input', {bubbles: true}));
  requestAnimationFrame(move);
}
move();
"""


def main():
    """The program."""
    if len(sys.argv) != 5:
        sys.exit("usage: view_rates.py SONARCAL RECORDING SCENE PARAMS")
    sonarcal, recording, scene, params = (str(pathlib.Path(argument).resolve()) for argument in sys.argv[1:])
    with tempfile.TemporaryDirectory() as folder:
        options = ["--scene", scene, "--params", params, "--real", recording]
        with view_in_browser.visiting(sonarcal, pathlib.Path(folder), options) as visitor:
            visitor.page.set_script_timeout(10 * SECONDS)
            visitor.open()
            curves = visitor.page.find_elements(view_in_browser.By.CSS_SELECTOR, '.row[data-name$=".gsab.C"]')
            slider = visitor.row(curves[0].get_attribute("data-name")).find_element(
                view_in_browser.By.CSS_SELECTOR, 'input[type="range"]')
            height = visitor.find("#pose-z").find_element(view_in_browser.By.XPATH, '../input[@type="range"]')
            for what, control in (("a slider moves", slider), ("the sonar moves", height)):
                rate = visitor.page.execute_async_script(COUNT, control, SECONDS)
                visitor.settle()
                print(visitor.find("#rate").text, file=sys.stderr)
                print(f"while {what}: {rate:.1f} images per second, limit min {LIMITS[what]}")


if __name__ == "__main__":
    main()
