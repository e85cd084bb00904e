#!/usr/bin/env python3
"""The page of `doublet view` in a headless Chromium: its picture for docs/view.md, and how fast it simulates.

python benchmarks/view_page.py FOLDER -o docs/pictures/view.jpg [--seconds 20] [--phone]

Prints ms per simulated frame and frames per second. Nothing is drawn during the measurement: without a graphics card drawing uses
the processor that the simulation needs. Needs selenium, Chromium and its driver.
"""

import argparse
import io
import shutil
import time
from pathlib import Path

from PIL import Image
from selenium import webdriver

MEASURE = """
const [seconds, done] = arguments, { actor } = doubletView.state.actors[0];
const times = [], start = performance.now(), arrive = actor.on_frame.bind(actor);
const next = () => {
  while (actor.schedule.length <= actor.arrived + 3) actor.schedule.push((actor.schedule.at(-1) + 1) % actor.poses.length);
  actor.ask(actor.arrived - 2, actor.arrived);
};
actor.on_frame = (message) => {
  arrive(message);
  if (message.how === "step") times.push(message.milliseconds);
  if (performance.now() - start > 1000 * seconds) done(times);
  else next();
};
next();
"""


def browser(width: int, height: int, phone: bool = False):
    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium") or ""
    for flag in ("--headless=new", "--no-sandbox", "--enable-unsafe-swiftshader", f"--window-size={width},{height}"):
        options.add_argument(flag)
    if phone:
        metrics = {"width": width, "height": height, "pixelRatio": 2.0}
        options.add_experimental_option("mobileEmulation", {"deviceMetrics": metrics})
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(shutil.which("chromedriver")))
    driver.set_script_timeout(600)
    return driver


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path, metavar="FOLDER", help="that `doublet view` wrote")
    parser.add_argument("-o", "--out", type=Path, metavar="PICTURE")
    parser.add_argument("--seconds", type=float, default=20.0, metavar="X", help="of measuring (default: 20)")
    parser.add_argument("--frame", type=int, default=48, metavar="N", help="of the clip, in the picture (default: 48)")
    parser.add_argument("--phone", action="store_true", help="a window of 390 x 780")
    arguments = parser.parse_args()
    width, height = (390, 780) if arguments.phone else (1240, 860)
    driver = browser(width, height, arguments.phone)
    try:
        driver.get((arguments.folder.resolve() / "index.html").as_uri())
        # Time goes on by a tenth of a second a picture at most, however long that takes to draw.
        driver.execute_script("doubletView.stage.lighten = () => {}")
        while driver.execute_script("return doubletView.state.time") < arguments.frame:
            time.sleep(0.1)
        driver.execute_script("doubletView.state.playing = false")
        if arguments.seconds > 0:
            times = sorted(driver.execute_async_script(MEASURE, arguments.seconds))
            mean, median = sum(times) / len(times), times[len(times) // 2]
            print(f"{len(times)} frames, mean {mean:.1f} ms, median {median:.1f} ms: {1000 / mean:.0f} frames a second")
        if arguments.out:
            time.sleep(1)
            picture = Image.open(io.BytesIO(driver.get_screenshot_as_png())).convert("RGB")
            picture.save(arguments.out, quality=88)
    finally:
        driver.quit()


if __name__ == "__main__":
    main()
