"""Uses the page of `sonarcal view` in headless Chromium as a person would, and says what is wrong with it.

    view_in_browser.py SONARCAL FOLDER [SCREENSHOTS]

FOLDER holds scene.gltf, params.json and the recording `real` (8 bits); what the page writes goes into its
subfolder `kept`. Prints how many images a second it saw. Ends with status 77 where there is no Chromium, no
ChromeDriver or no Selenium to drive it.
"""

import contextlib
import json
import pathlib
import shlex
import shutil
import struct
import subprocess
import sys
import time
import zlib

NOT_HERE = 77

try:
    from selenium import webdriver
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.support.ui import Select, WebDriverWait
except ImportError:
    print("Selenium is not installed")
    sys.exit(NOT_HERE)

SIZES = {"laptop": (1366, 768), "projector": (1024, 768), "large": (1920, 1080), "phone": (390, 844)}


def start_browser(browser, driver):
    options = webdriver.ChromeOptions()
    options.binary_location = browser
    for flag in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--window-size=1366,768",
                 "--force-device-scale-factor=1", "--hide-scrollbars", "--use-angle=swiftshader",
                 "--enable-unsafe-swiftshader"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    return webdriver.Chrome(service=Service(driver), options=options)


def read_grey_png(path):
    """Rows of an 8-bit grey PNG, by the standard's own rules."""
    data = path.read_bytes()
    at, width, height, packed = 8, 0, 0, b""
    while at < len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        chunk = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, bits, colour, _, _, interlaced = struct.unpack(">IIBBBBB", chunk)
            assert (bits, colour, interlaced) == (8, 0, 0), "not an 8-bit grey picture"
        elif kind == b"IDAT":
            packed += chunk
        at += 12 + length
    raw = zlib.decompress(packed)
    above, values = [0] * width, []
    for row in range(height):
        line = list(raw[row * (width + 1) + 1:(row + 1) * (width + 1)])
        how = raw[row * (width + 1)]
        for i in range(width):
            a = line[i - 1] if i else 0
            b, c = above[i], above[i - 1] if i else 0
            p = a + b - c
            nearest = min((abs(p - a), 0, a), (abs(p - b), 1, b), (abs(p - c), 2, c))[2]
            line[i] = (line[i] + [0, a, b, (a + b) // 2, nearest][how]) & 255
        values += line
        above = line
    return values


class Visitor:
    def __init__(self, page, sonarcal, folder, url, screenshots):
        self.page = page
        self.sonarcal = sonarcal
        self.folder = folder
        self.url = url
        self.screenshots = screenshots
        self.faults = []

    def check(self, true, sentence):
        if not true:
            self.faults.append(sentence)

    def find(self, selector):
        return self.page.find_element(By.CSS_SELECTOR, selector)

    def script(self, text, *arguments):
        return self.page.execute_script(text, *arguments)

    def shoot(self, name):
        if self.screenshots:
            time.sleep(0.3)
            self.page.save_screenshot(str(self.screenshots / f"view_{name}.png"))

    def settle(self):
        """Until the image of the latest state is shown and compared."""
        WebDriverWait(self.page, 60, 0.05).until(lambda page: page.execute_script(
            "return view.shown > 0 && view.shown === view.sequence && view.compared === view.shown"))

    def open(self):
        self.page.get(self.url)
        WebDriverWait(self.page, 60).until(lambda page: page.execute_script(
            "return document.body.dataset.ready === 'yes' && window.view && view.images !== null"))
        self.settle()

    def values(self, of="simulated"):
        return self.script(f"return Array.from(view.images.{of}.values)")

    def picture(self, view="fan"):
        return self.script(
            f"""const c = document.querySelector('[data-part="{view}-canvas"]');
            return Array.from(c.getContext('2d').getImageData(0, 0, c.width, c.height).data).join()""")

    def row(self, name):
        """The row of a parameter that is not hidden, with the groups around it unfolded."""
        rows = [row for row in self.page.find_elements(By.CSS_SELECTOR, f'.row[data-name="{name}"]')
                if not row.get_property("hidden")]
        assert len(rows) == 1, f"{len(rows)} rows of {name}"
        self.script("for (let e = arguments[0]; e; e = e.parentElement) if (e.tagName === 'DETAILS') e.open = true;"
                    "arguments[0].scrollIntoView({block: 'center'})", rows[0])
        return rows[0]

    def choose(self, value):
        self.find(f'input[name="show"][value="{value}"]').click()
        time.sleep(0.1)

    def state(self, path):
        return self.script(f"return view.state.{path}")

    def run(self, arguments):
        done = subprocess.run([self.sonarcal, *arguments], capture_output=True, text=True, cwd=self.folder, check=False)
        self.check(done.returncode == 0, f"sonarcal {' '.join(arguments)}: {done.stderr}")

    def write(self):
        """Has the page write its files, and `simulate` render them: the grey values of the frame shown."""
        self.find("#write").click()
        WebDriverWait(self.page, 20).until(lambda page: self.find("#saved").text.startswith("Written into"))
        command = shlex.split(self.find("#command").text)
        self.script("document.getElementById('saved').textContent = ''")
        self.check(command[:2] == ["sonarcal", "simulate"], f"the page names the command {command}")
        self.run([*command[1:], "-q"])
        return read_grey_png(self.folder / "kept" / "sim" / f"frame_{self.state('frame'):04}.png")

    def move_a_slider(self):
        before, drawn = self.values(), self.picture()
        slider = self.row("material.box.gsab.C").find_element(By.CSS_SELECTOR, 'input[type="range"]')
        width = slider.size["width"]
        drag = ActionChains(self.page, duration=30).move_to_element(slider).click_and_hold()
        for step in range(40):
            drag.move_by_offset(2 if step < 20 else -1, 0)
        drag.release().perform()
        print(f"{self.script('return view.rate'):.0f} images a second while a slider of {width} px was dragged")
        self.settle()
        self.check(self.values() != before, "the image does not follow the slider")
        self.check(self.picture() != drawn, "the picture does not follow the slider")
        self.check(self.values() == self.write(), "the image is not that of sonarcal simulate with the files saved")
        self.shoot("slider")
        undo = self.find("#undo")
        undo.click()
        self.settle()
        self.check(self.values() == before, "one undo does not put back what a drag did")
        self.check(not undo.is_enabled(), "after undoing everything there is more to undo")
        self.find("#redo").click()
        self.settle()
        self.check(self.values() != before, "redo does nothing")

    def type_a_number(self):
        number = self.row("material.floor.gsab.C").find_element(By.CSS_SELECTOR, 'input[type="number"]')
        before, value = self.values(), self.state("parameters.materials.floor.gsab.C")
        number.send_keys(Keys.CONTROL, "a")
        number.send_keys("0.7", Keys.TAB)
        self.settle()
        self.check(self.state("parameters.materials.floor.gsab.C") == 0.7, "a typed number is not taken")
        self.check(self.values() == self.write(), "a typed number does not make the image of sonarcal simulate")
        self.find("body").send_keys(Keys.CONTROL, "z")
        self.settle()
        self.check(self.state("parameters.materials.floor.gsab.C") == value, "Ctrl+Z does not put the number back")
        self.check(self.values() == before, "Ctrl+Z does not put the image back")
        number.send_keys(Keys.CONTROL, "a")
        number.send_keys("1e9", Keys.TAB)
        fault = self.row("material.floor.gsab.C").find_element(By.CSS_SELECTOR, ".fault")
        self.check("expected a number from" in fault.text, f"a number beyond the bounds gets '{fault.text}'")
        self.check(self.state("parameters.materials.floor.gsab.C") == value, "a number beyond the bounds is taken")
        number.send_keys(Keys.CONTROL, "a")
        number.send_keys(str(value), Keys.TAB)
        self.check(not fault.is_displayed(), "a fault stays after it was mended")
        self.settle()

    def move_the_sonar(self):
        before = self.values()
        number = self.find("#pose-z")
        number.send_keys(Keys.CONTROL, "a")
        number.send_keys("1.35", Keys.TAB)
        self.settle()
        self.check(self.values() != before, "the image does not follow the pose")
        self.check(self.values() == self.write(), "a moved sonar does not make the image of sonarcal simulate")
        height = self.script("return view.world.sonar.matrix.elements[14]")
        self.check(abs(height - 1.35) < 1e-12, f"the sonar of the 3D view stands {height} m high")
        self.find("#put-back").click()
        self.settle()
        self.check(self.values() == before, "the pose is not put back")

    def go_through_frames(self):
        for of in ("#pictures", "#recorded"):
            text = self.find(of).text
            self.check("ecorded" not in text, f"a synthetic recording is called recorded: '{text}'")
        simulated, recorded = self.values(), self.values("recorded")
        self.find("#frame").send_keys(Keys.END)
        self.settle()
        self.check(self.state("frame") == 3, f"the scrubber goes to frame {self.state('frame')}")
        self.check(self.values() != simulated, "the simulated image does not follow the frame")
        WebDriverWait(self.page, 10).until(lambda page: self.values("recorded") != recorded)
        real = read_grey_png(self.folder / "real" / "frame_0003.png")
        self.check(self.values("recorded") == real, "the recorded frame is not that of the recording")
        self.find("#world canvas").send_keys(Keys.PAGE_UP)
        self.settle()
        self.check(self.state("frame") == 2, "Page Up does not go to the frame before")
        self.find("#before").click()
        self.find("#before").click()
        self.settle()

    def search(self):
        def shown():
            return {row.get_attribute("data-name") for row in self.page.find_elements(By.CSS_SELECTOR, ".row[data-name]")
                    if row.is_displayed()}
        before = shown()
        box = self.find("#search")
        box.send_keys("cosine floor")
        self.check(shown() == {"material.floor.gsab.D"}, f"'cosine floor' finds {sorted(shown())}")
        box.send_keys("zzz")
        self.check(not shown() and self.find("#nothing").is_displayed(), "a search in vain does not say so")
        box.send_keys(Keys.CONTROL, "a")
        box.send_keys(Keys.DELETE)
        self.check(shown() == before, "after a search the page is not as before")

    def play(self):
        self.script("view.saved = []; const make = URL.createObjectURL.bind(URL);"
                    "URL.createObjectURL = (blob) => { view.saved.push([blob.type, blob.size]); return make(blob); };")
        saved = "return view.saved"
        self.find("#picture").click()
        WebDriverWait(self.page, 10).until(lambda page: len(self.script(saved)) == 2)
        self.check(all(kind == "image/png" and size > 100 for kind, size in self.script(saved)),
                   f"pictures are saved as {self.script(saved)}")
        self.find("#video").click()
        WebDriverWait(self.page, 60, 0.1).until(lambda page: len(self.script(saved)) == 3)
        kind, size = self.script(saved)[2]
        self.check(kind.startswith("video/") and size > 1000, f"the video is {size} bytes of {kind}")
        self.check(self.state("frame") == 3, f"playing ends at frame {self.state('frame')}")
        self.find("#undo").click()
        self.settle()
        self.check(self.state("frame") == 0, "one undo does not go back to where playing began")

    def point_and_zoom(self):
        """The sample under the pointer is the one that is drawn there, also in a picture that is zoomed."""
        canvas = self.find('[data-part="polar-canvas"]')
        beams, bins = self.script("return [view.images.simulated.beams, view.images.simulated.bins]")
        wide, high = self.script("return [arguments[0].width, arguments[0].height]", canvas)
        box = canvas.rect
        scale = min(box["width"] / wide, box["height"] / high)
        right, down = 0.3, -0.2  # of the picture, from its middle

        def point():
            ActionChains(self.page).move_to_element_with_offset(
                canvas, round(right * wide * scale), round(down * high * scale)).perform()
            return self.script("return view.images.cursor")
        at = point()
        self.check(abs(at % beams - (0.5 + right) * beams) <= 1.5 and abs(at // beams - (0.5 + down) * bins) <= 1.5,
                   f"the pointer reads bin {at // beams} of {bins} and beam {at % beams} of {beams}")
        self.script("const box = arguments[0].parentElement.parentElement.getBoundingClientRect();"
                    "arguments[0].dispatchEvent(new WheelEvent('wheel', {deltaY: -400, bubbles: true, cancelable: true,"
                    "clientX: box.left + box.width / 2, clientY: box.top + box.height / 2}))", canvas)
        width = "return arguments[0].getBoundingClientRect().width"
        self.check(self.script(width, canvas) > 2 * box["width"], "the wheel does not zoom")
        nearer = point()
        self.check(abs(nearer % beams - (0.5 + right / 2.2255) * beams) <= 1.5, f"zoomed, beam {nearer % beams} is read")
        ActionChains(self.page).double_click(canvas).perform()
        self.check(abs(self.script(width, canvas) - box["width"]) < 1, "a double click does not show all again")
        self.check("m" in self.script("return document.querySelector('[data-part=\"fan-axes\"]').textContent"),
                   "no range stands at the fan")

    def show_side_by_side(self):
        self.choose("simulated")  # and the pointer leaves the pictures
        fan = self.picture()
        self.choose("real")
        real = self.picture()
        self.choose("both")
        self.check(self.picture() == fan, "side by side, the left fan is not the simulated one")
        self.check(self.picture("polar") == real, "side by side, the right fan is not that of the recording")
        self.shoot("side_by_side")
        self.choose("simulated")

    def compare(self):
        drawn = self.write()
        self.run(["compare", "--real", "real", "--sim", "kept/sim", "--as-displayed", "--out", "compared", "-q"])
        metrics = json.loads((self.folder / "compared" / "metrics.json").read_text(encoding="utf-8"))
        frame = metrics["frames"][self.state("frame")]
        figures = self.script("return view.figures")
        for key, value in frame.items():
            self.check(figures[key] == value, f"{key} is {figures[key]} here and {value} by sonarcal compare")
        text = self.find("#figures").text
        for value in (frame["iou"], frame["intensity_error"]["polar"], frame["intensity_error"]["fan"]):
            self.check(f"{value:.3f}" in text, f"{value:.3f} is not shown among '{text}'")
        self.choose("overlay")
        real = self.values("recorded")
        lookup = self.script("return Array.from(view.images.views[1].lookup.index)")
        shown = self.script("const c = view.images.views[1].canvas; return Array.from(c.getContext('2d')"
                            ".getImageData(0, 0, c.width, c.height).data)")
        wrong = 0
        for pixel in range(0, len(lookup), 997):
            r, s = real[lookup[pixel]], drawn[lookup[pixel]]
            wanted = (s, (r + s) / 2, r)
            wrong += any(abs(a - b) > 0.5 for a, b in zip(wanted, shown[4 * pixel:4 * pixel + 3]))
        self.check(wrong == 0, f"{wrong} pixels of the overlay are not what it says")
        self.shoot("overlay")
        self.choose("blink")
        self.find('[data-part="pause"]').click()
        one = self.picture("polar")
        self.find('[data-part="polar-canvas"]').send_keys(Keys.SPACE)
        other = self.picture("polar")
        self.check(one != other, "the space bar does not change over")
        self.find('[data-part="pause"]').click()
        WebDriverWait(self.page, 10, 0.1).until(lambda page: self.picture("polar") == one)
        self.choose("difference")
        self.shoot("difference")
        self.choose("regions")
        self.shoot("regions")
        self.choose("simulated")

    def change_the_model(self):
        Select(self.find("#model")).select_by_visible_text("acoustic")
        self.settle()
        self.row("receiver.gain_db")
        hidden = self.page.find_elements(By.CSS_SELECTOR, '.row[data-name="jitter.sigma_range_m"]')[0]
        self.check(hidden.get_property("hidden"), "the acoustic model shows the paper's range error")
        switch = self.row("mirror.floor.loss_db").find_element(By.CSS_SELECTOR, 'input[type="checkbox"]')
        switch.click()
        self.settle()
        self.check(self.state("parameters.mirror.floor.loss_db") == 6, "a mirror can't be switched on")
        self.check(self.values() == self.write(), "the acoustic image is not that of sonarcal simulate")
        self.shoot("acoustic")
        for _ in range(2):
            self.find("#undo").click()
        self.settle()
        self.check(self.state("parameters.model") == "paper", "undo does not put the model back")

    def fit(self):
        value = self.state("parameters.materials.box.gsab.C")
        starts = self.find("#fit-starts")
        starts.clear()
        starts.send_keys("1")
        self.find('#fit [data-part="start"]').click()
        WebDriverWait(self.page, 300, 0.1).until(
            lambda page: self.find("#fit").get_attribute("data-state") in ("done", "failed", "stopped"))
        self.check(self.find("#fit").get_attribute("data-state") == "done", self.find("#fit").text)
        self.settle()
        fitted = self.state("parameters.materials.box.gsab.C")
        self.check(fitted != value, "the fit's values are not in the sliders")
        shown = float(self.row("material.box.gsab.C").find_element(By.CSS_SELECTOR, 'input[type="number"]')
                      .get_property("value"))
        self.check(abs(shown - fitted) <= 1e-5 * abs(fitted), f"the row shows {shown}, the fit found {fitted}")
        self.script("document.querySelector('#fit').scrollIntoView()")
        self.shoot("fit")
        self.find("#undo").click()
        self.settle()
        self.check(self.state("parameters.materials.box.gsab.C") == value, "undo does not put back what a fit did")
        self.find("#redo").click()
        self.settle()

    def look_at_it(self):
        nameless = self.script(
            "return [...document.querySelectorAll('input, select, button, canvas, progress')].filter((e) => "
            "!(e.labels && e.labels.length) && !e.getAttribute('aria-label') && !e.textContent.trim())"
            ".map((e) => e.outerHTML)")
        self.check(not nameless, f"without a name for who can't see: {nameless}")
        light = self.script("return getComputedStyle(document.documentElement).backgroundColor")
        for name, (width, height) in SIZES.items():
            self.page.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                                      {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False})
            time.sleep(0.3)
            wide = self.script("return document.documentElement.scrollWidth")
            self.check(wide <= width, f"{name}: {wide} px wide on a screen of {width} px")
            if name != "phone":
                below = self.script("return document.documentElement.scrollHeight")
                self.check(below <= height, f"{name}: {below} px high on a screen of {height} px")
                canvas = self.find('[data-part="fan-canvas"]').size
                self.check(min(canvas.values()) > 120, f"{name}: the fan is drawn in {canvas}")
            self.shoot(name)
        self.page.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})
        self.page.execute_cdp_cmd("Emulation.setEmulatedMedia",
                                  {"features": [{"name": "prefers-color-scheme", "value": "dark"}]})
        dark = self.script("return getComputedStyle(document.documentElement).backgroundColor")
        self.check(light != dark, f"light and dark pages have one background, {light}")
        self.shoot("dark")
        self.page.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": []})
        self.check(self.script("return view.world !== undefined"), "there is no 3D view")
        drawn = self.script("view.world.renderer.render(view.world.scene, view.world.camera);"
                            "return view.world.renderer.info.render.triangles")
        self.check(drawn > 12, f"the 3D view draws {drawn} triangles")

    def look_at_logs(self):
        for entry in self.page.get_log("browser"):
            self.faults.append(f'the console says: {entry["level"]} {entry["message"]}')
        home = self.url.split("#")[0]
        for entry in self.page.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] != "Network.requestWillBeSent":
                continue
            url = message["params"]["request"]["url"]
            if not url.startswith((home, "data:", f"blob:{home}")):
                self.faults.append(f"the page asks for {url}")

    def come_without_the_token(self):
        self.page.get(self.url.split("#")[0] + "#wrong")
        self.page.refresh()
        WebDriverWait(self.page, 10).until(lambda page: self.find("#fault").is_displayed())
        self.check("whole address" in self.find("#fault").text, f"without the token: '{self.find('#fault').text}'")


@contextlib.contextmanager
def visiting(sonarcal, folder, options, screenshots=None):
    """A visitor of the page that `sonarcal view` with these options serves, in a headless browser."""
    program = subprocess.Popen(
        [sonarcal, "view", *options, "--out", "kept", "--port", "0", "--json", "--quiet"],
        cwd=folder, stdout=subprocess.PIPE, text=True)
    text = program.stdout.readline()
    while text.count("{") > text.count("}"):
        text += program.stdout.readline()
    page = start_browser(shutil.which("chromium"), shutil.which("chromedriver"))
    try:
        yield Visitor(page, sonarcal, folder, json.loads(text)["url"], screenshots)
    finally:
        page.quit()
        program.terminate()
        program.wait()


def main():
    sonarcal, folder = sys.argv[1], pathlib.Path(sys.argv[2]).resolve()
    screenshots = pathlib.Path(sys.argv[3]) if len(sys.argv) > 3 else None
    if shutil.which("chromium") is None or shutil.which("chromedriver") is None:
        print("Chromium or ChromeDriver is not installed")
        return NOT_HERE
    options = ["--scene", "scene.gltf", "--params", "params.json", "--real", "real", "--sampling", "beams", "--rays", "96x200"]
    with visiting(sonarcal, folder, options, screenshots) as visitor:
        visitor.open()
        visitor.move_a_slider()
        visitor.type_a_number()
        visitor.move_the_sonar()
        visitor.go_through_frames()
        visitor.search()
        visitor.play()
        visitor.point_and_zoom()
        visitor.show_side_by_side()
        visitor.compare()
        visitor.change_the_model()
        visitor.fit()
        visitor.look_at_it()
        visitor.look_at_logs()
        visitor.come_without_the_token()
    for fault in visitor.faults:
        print(fault)
    return 1 if visitor.faults else 0


if __name__ == "__main__":
    sys.exit(main())
