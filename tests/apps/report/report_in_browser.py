"""Opens a comparison's report in headless Chromium as a reader would, and says what is wrong with it.

    report_in_browser.py REPORT.html EXPECTED.json [SCREENSHOTS]

The real side of the comparison is a simulation too. EXPECTED.json: {"frames": N, "bins": N, "beams": N, "range_m": [MIN, MAX], "azimuth_deg": [FIRST, LAST],
"samples": [{"bin": I, "beam": I, "real": GREY, "simulated": GREY}, ...]} of the viewer's first frame.
Ends with status 77 where there is no Chromium, no ChromeDriver or no Selenium to drive it.
"""

import json
import math
import pathlib
import re
import shutil
import sys
import time

NOT_HERE = 77
PHONE_PX = (375, 800)

try:
    from selenium import webdriver
    from selenium.webdriver.common.action_chains import ActionChains
    from selenium.webdriver.common.by import By
    from selenium.webdriver.common.keys import Keys
    from selenium.webdriver.chrome.service import Service
    from selenium.webdriver.support.ui import WebDriverWait
except ImportError:
    print("Selenium is not installed")
    sys.exit(NOT_HERE)


def start_browser(browser, driver):
    options = webdriver.ChromeOptions()
    options.binary_location = browser
    for flag in ("--headless=new", "--no-sandbox", "--disable-dev-shm-usage", "--window-size=1280,1000",
                 "--force-device-scale-factor=1", "--hide-scrollbars"):
        options.add_argument(flag)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL", "performance": "ALL"})
    return webdriver.Chrome(service=Service(driver), options=options)


class Reader:
    def __init__(self, page, report, expected, screenshots):
        self.page = page
        self.report = report
        self.expected = expected
        self.screenshots = screenshots
        self.faults = []
        self.requests = []

    def check(self, true, sentence):
        if not true:
            self.faults.append(sentence)

    def part(self, name):
        return self.page.find_element(By.CSS_SELECTOR, f'.viewer [data-part="{name}"]')

    def choose(self, what, value):
        self.page.find_element(By.CSS_SELECTOR, f'input[data-choice="{what}"][value="{value}"]').click()
        time.sleep(0.1)

    def shoot(self, name):
        if self.screenshots:
            self.page.save_screenshot(str(self.screenshots / f"{name}.png"))

    def open(self):
        self.page.get(self.report.as_uri())
        WebDriverWait(self.page, 30).until(
            lambda page: page.execute_script(
                "return [...document.querySelectorAll('.viewer')].every((v) => v.dataset.ready === 'yes')"))
        folded = self.page.execute_script(
            "const folds = [...document.querySelectorAll('.viewers details')];"
            "const folded = folds.every((fold) => !fold.open && !fold.hidden);"
            "for (const fold of folds) fold.open = true;"
            "return folded;")
        self.check(folded, "the viewer shows pictures of the page a second time before it is asked for")

    def pixel(self, x_share, y_share):
        return self.page.execute_script(
            "const c = document.querySelector('.viewer canvas');"
            "return [...c.getContext('2d').getImageData(Math.floor(arguments[0] * c.width),"
            " Math.floor(arguments[1] * c.height), 1, 1).data];", x_share, y_share)

    def point(self, x_share, y_share):
        self.page.execute_script(
            "const c = document.querySelector('.viewer canvas'); const b = c.getBoundingClientRect();"
            "c.dispatchEvent(new PointerEvent('pointermove', {clientX: b.left + arguments[0] * b.width,"
            " clientY: b.top + arguments[1] * b.height}));", x_share, y_share)
        return self.part("readout").text

    # Where the middle of a sample is in the picture, as a share of its width and height.
    def place(self, view, bin_number, beam):
        bins, beams = self.expected["bins"], self.expected["beams"]
        if view == "polar":
            return (beam + 0.5) / beams, (bin_number + 0.5) / bins
        nearest, farthest = self.expected["range_m"]
        first, last = (math.radians(a) for a in self.expected["azimuth_deg"])
        half_beam = 0.5 * (last - first) / (beams - 1)
        left, right = farthest * math.sin(first - half_beam), farthest * math.sin(last + half_beam)
        bottom = nearest * min(math.cos(first - half_beam), math.cos(last + half_beam))
        range_m = nearest + (bin_number + 0.5) * (farthest - nearest) / bins
        azimuth = first + beam * (last - first) / (beams - 1)
        x, y = range_m * math.sin(azimuth), range_m * math.cos(azimuth)
        return (x - left) / (right - left), (farthest - y) / (farthest - bottom)

    def read_values(self):
        self.page.find_element(By.CSS_SELECTOR, '[data-part="colours"] option[value="grey"]').click()
        for view in ("polar", "fan"):
            self.choose("view", view)
            for sample in self.expected["samples"]:
                x, y = self.place(view, sample["bin"], sample["beam"])
                where = f'{view} view, bin {sample["bin"]}, beam {sample["beam"]}'
                text = self.point(x, y)
                numbers = re.search(r"bin (\d+), beam (\d+)\): synthetic (\d+), simulated (\d+)", text)
                self.check(numbers is not None and [int(n) for n in numbers.groups()] ==
                           [sample["bin"], sample["beam"], sample["real"], sample["simulated"]],
                           f"{where}: reads '{text}', expected {sample}")
                self.point(-1, -1)  # the ring about the pointer hides the pixel
                for show in ("real", "simulated"):
                    self.choose("show", show)
                    grey = sample[show]
                    self.check(self.pixel(x, y) == [grey, grey, grey, 255],
                               f"{where}: {show} is drawn {self.pixel(x, y)}, expected {grey}")
        self.check("ecorded" not in self.page.find_element(By.CSS_SELECTOR, ".viewers").text,
                   "the viewer calls a synthetic frame recorded")
        for show in ("overlay", "difference", "regions", "real"):
            self.choose("show", show)
            self.page.execute_script("document.querySelector('.viewer').scrollIntoView()")
            self.shoot(f"viewer_{show}")

    # Red, green, blue and opacity of each pixel of an element as shown, without its colour bar.
    def drawn_pixels(self, element):
        return self.page.execute_async_script(
            "const done = arguments[1]; const image = new Image();"
            "image.onload = () => { const c = document.createElement('canvas'); c.width = image.width;"
            " c.height = 0.8 * image.height; const d = c.getContext('2d'); d.drawImage(image, 0, 0);"
            " done([...d.getImageData(0, 0, c.width, c.height).data]); };"
            "image.src = 'data:image/png;base64,' + arguments[0];", element.screenshot_as_base64)

    # Pictures that the page draws by filters: colours of the data, axes, transparent outside a fan.
    def look_at_pictures(self):
        page = self.page
        page.execute_script("document.documentElement.scrollTop = 0")
        opening = page.find_element(By.CSS_SELECTOR, "main > figure")
        labels = [svg.get_attribute("aria-label") for svg in opening.find_elements(By.CSS_SELECTOR, "svg.sonar")]
        self.check(len(labels) == 3 and labels[0].startswith("Synthetic") and labels[1].startswith("Simulated") and
                   labels[2].startswith("Both"), f"the page opens with {labels}")
        text = page.find_element(By.CSS_SELECTOR, "main > figure + p").text
        self.check(text.count(". ") == 1 and text.endswith("."), f"not two sentences below the first picture: {text}")
        for svg in page.find_elements(By.CSS_SELECTOR, "figure.pictures svg.sonar"):
            ranges = svg.find_elements(By.CSS_SELECTOR, ".range")
            azimuths = svg.find_elements(By.CSS_SELECTOR, ".azimuth")
            self.check(len(ranges) > 1 and len(azimuths) > 1,
                       f'{svg.get_attribute("aria-label")}: {len(ranges)} ranges, {len(azimuths)} azimuths')
        real, _, overlay = (self.drawn_pixels(svg) for svg in opening.find_elements(By.CSS_SELECTOR, "svg.sonar"))
        self.check(real[:3] == [255, 255, 255], f"beside a fan the page is {real[:3]}, expected white")
        spread = max(max(real[i:i + 3]) - min(real[i:i + 3]) for i in range(0, len(real), 4))
        self.check(spread > 60, "a fan is drawn without colours")
        # Where the synthetic image is brighter, its blue is mixed with the orange of the simulated one.
        pixels = [overlay[i:i + 3] for i in range(0, len(overlay), 4)]
        mixed = sum(blue > 180 and 40 < red < blue - 40 for red, _, blue in pixels)
        self.check(mixed > 20, f"{mixed} pixels of the overlay mix blue and orange")

    # Values under the pointer of a chart, and its zoom.
    def read_chart(self):
        page = self.page
        chart = page.find_element(By.CSS_SELECTOR, "[data-chart]")
        data = json.loads(chart.get_attribute("data-chart"))
        svg = chart.find_element(By.CSS_SELECTOR, ".plot")
        page.execute_script("arguments[0].scrollIntoView({block: 'center'})", svg)
        ticks = [t.text for t in chart.find_elements(By.CSS_SELECTOR, ".ticks text")]
        act = ActionChains(page)
        width = svg.size["width"]
        act.move_to_element_with_offset(svg, -0.2 * width, 0).perform()
        text = chart.find_element(By.TAG_NAME, "output").text
        self.check(text.startswith(data["x"]["text"]) and data["series"][0]["name"] in text,
                   f"the pointer on a chart reads '{text}'")
        act.click_and_hold().move_by_offset(0.3 * width, 0).release().perform()
        zoomed = [t.text for t in chart.find_elements(By.CSS_SELECTOR, ".ticks text")]
        self.check(zoomed != ticks, "a drag over a chart does not zoom")
        act.double_click(svg).perform()
        again = [t.text for t in chart.find_elements(By.CSS_SELECTOR, ".ticks text")]
        self.check(again == ticks, f"the ticks of a chart are {ticks}, after zooming in and out {again}")

    # Every control is reached by the Tab key alone and answers to the keyboard.
    def use_keyboard(self):
        self.page.execute_script("document.activeElement.blur(); window.getSelection().removeAllRanges();"
                                 "document.documentElement.scrollTop = 0;")
        self.open()
        body = self.page.find_element(By.TAG_NAME, "body")
        body.send_keys(Keys.TAB)
        reached = []
        for _ in range(400):
            element = self.page.switch_to.active_element
            if element.tag_name == "body":
                break
            reached.append((element.tag_name, element.get_attribute("data-part") or
                            element.get_attribute("data-choice") or ""))
            element.send_keys(Keys.TAB)
        for wanted in (("input", "show"), ("input", "view"), ("select", "colours"), ("input", "outline"),
                       ("button", "before"), ("input", "slider"), ("button", "after"), ("canvas", "canvas")):
            self.check(wanted in reached, f"the Tab key does not reach {wanted}, only {sorted(set(reached))}")
        scrolls = len(self.page.find_elements(By.CSS_SELECTOR, ".scroll"))
        links = len(self.page.find_elements(By.CSS_SELECTOR, "nav a"))
        self.check(reached.count(("div", "")) >= scrolls, "a table that scrolls is not reached by the Tab key")
        self.check(reached.count(("a", "")) >= links, "a line of the contents is not reached by the Tab key")

        self.page.find_element(By.CSS_SELECTOR, 'input[data-choice="show"]:checked').send_keys(Keys.ARROW_RIGHT)
        chosen = self.page.find_element(By.CSS_SELECTOR, 'input[data-choice="show"]:checked')
        self.check(chosen.get_attribute("value") == "simulated", "an arrow key does not go on to 'Simulated'")
        before = self.part("name").text
        self.part("slider").send_keys(Keys.ARROW_RIGHT)
        WebDriverWait(self.page, 10).until(lambda page: self.part("name").text != before)
        self.check(f'2 of {self.expected["frames"]}' in self.part("name").text,
                   f'the slider goes to "{self.part("name").text}"')
        canvas = self.part("canvas")
        canvas.send_keys(Keys.ARROW_UP)
        self.check("synthetic" in self.part("readout").text, "arrow keys on the picture read no value")
        self.choose("show", "blink")
        which = self.part("which").text
        canvas.send_keys(Keys.SPACE)
        WebDriverWait(self.page, 5).until(lambda page: self.part("which").text != which)
        self.choose("show", "real")
        canvas.send_keys(Keys.PAGE_UP)
        WebDriverWait(self.page, 10).until(lambda page: "(1 of" in self.part("name").text)

    def look_elsewhere(self):
        page = self.page
        self.open()
        self.shoot("top")
        light = page.execute_script("return getComputedStyle(document.documentElement).backgroundColor")
        page.execute_cdp_cmd("Emulation.setEmulatedMedia",
                             {"features": [{"name": "prefers-color-scheme", "value": "dark"}]})
        dark = page.execute_script("return getComputedStyle(document.documentElement).backgroundColor")
        self.check(light != dark, f"light and dark pages have one background, {light}")
        self.shoot("dark")
        page.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print", "features": []})
        shown = page.execute_script("return getComputedStyle(document.querySelector('.viewers')).display")
        self.check(shown == "none", "the viewer is printed")
        page.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "", "features": []})
        page.execute_cdp_cmd("Emulation.setDeviceMetricsOverride",
                             {"width": PHONE_PX[0], "height": PHONE_PX[1], "deviceScaleFactor": 1, "mobile": True})
        self.open()
        width = page.execute_script("return document.documentElement.scrollWidth")
        self.check(width <= PHONE_PX[0], f"a phone of {PHONE_PX[0]} px has to scroll sideways over {width} px")
        listed = page.find_element(By.CSS_SELECTOR, "nav ol")
        self.check(not listed.is_displayed(), "a phone shows the contents open")
        page.find_element(By.CSS_SELECTOR, "nav label").click()
        self.check(listed.is_displayed(), "a phone does not open the contents")
        self.shoot("phone")
        page.execute_cdp_cmd("Emulation.clearDeviceMetricsOverride", {})

    # A script that is not the report's own does not run, however it came in.
    def inject(self):
        self.page.execute_script(
            "const s = document.createElement('script'); s.textContent = 'window.injected = 1';"
            "document.body.append(s);")
        self.check(self.page.execute_script("return window.injected === undefined"), "an injected script runs")
        self.page.get_log("browser")  # the refusal just asked for

    def look_at_logs(self):
        for entry in self.page.get_log("browser"):
            self.faults.append(f'the console says: {entry["level"]} {entry["message"]}')
        for entry in self.page.get_log("performance"):
            message = json.loads(entry["message"])["message"]
            if message["method"] != "Network.requestWillBeSent":
                continue
            url = message["params"]["request"]["url"]
            if not url.startswith("data:") and url.split("#")[0] != self.report.as_uri():
                self.faults.append(f"the page asks for {url}")


def main():
    report = pathlib.Path(sys.argv[1]).resolve()
    expected = json.loads(pathlib.Path(sys.argv[2]).read_text(encoding="utf-8"))
    screenshots = pathlib.Path(sys.argv[3]) if len(sys.argv) > 3 else None
    browser, driver = shutil.which("chromium"), shutil.which("chromedriver")
    if browser is None or driver is None:
        print("Chromium or ChromeDriver is not installed")
        return NOT_HERE
    page = start_browser(browser, driver)
    try:
        reader = Reader(page, report, expected, screenshots)
        reader.open()
        reader.look_at_pictures()
        reader.read_chart()
        reader.read_values()
        reader.use_keyboard()
        reader.look_elsewhere()
        reader.look_at_logs()
        reader.inject()
    finally:
        page.quit()
    for fault in reader.faults:
        print(fault)
    return 1 if reader.faults else 0


if __name__ == "__main__":
    sys.exit(main())
