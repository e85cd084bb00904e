"""The pages of `doublet edit-template` and `doublet edit-segmentation` in a headless Chromium: their pictures for the docs.

python benchmarks/edit_pages.py template OUT -o docs/pictures/edit-template.png
python benchmarks/edit_pages.py segmentation OUT -o docs/pictures/edit-segmentation.png

Nothing is saved in OUT. Needs selenium, Chromium and its driver.
"""

import argparse
from pathlib import Path
from threading import Thread

from doublet.pages import edit_segmentation, edit_template
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.actions.wheel_input import ScrollOrigin
from selenium.webdriver.common.by import By
from selenium.webdriver.support.ui import WebDriverWait
from view_page import browser

NEARER = -600  # px, of the wheel
FROM = {"front": "0 0", "left": "1.5708 0", "back": "3.1416 0", "right": "-1.5708 0", "below": "0 -1.2"}


def look(driver, side: str) -> None:
    driver.find_element(By.CSS_SELECTOR, f"[data-turn='{FROM[side]}']").click()


def across(driver) -> None:
    """A stroke over the skirt: from its middle, as one beside the surface would turn it, to one side, and to the other."""
    mouse = ActionChains(driver).move_to_element_with_offset(driver.find_element(By.ID, "view"), 0, 40).click_and_hold()
    for step in [-6] * 15 + [6] * 30:
        mouse = mouse.move_by_offset(step, 0)
    mouse.release().perform()


def template(driver) -> None:
    """The hem, from nearby."""
    look(driver, "below")
    origin = ScrollOrigin.from_element(driver.find_element(By.ID, "view"))
    ActionChains(driver).scroll_from_origin(origin, 0, NEARER).perform()


def segmentation(driver) -> None:
    """A border all around."""
    driver.find_element(By.ID, "border").click()
    for side in ("left", "back", "right", "front"):
        look(driver, side)
        across(driver)
    shown = driver.find_element(By.ID, "regions").text
    if not shown.startswith("2 "):
        raise RuntimeError(f"expected a border that parts 2 regions, found {shown}")


PAGES = {"template": (edit_template.open_page, template), "segmentation": (edit_segmentation.open_page, segmentation)}


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("page", choices=PAGES)
    parser.add_argument("out", type=Path, metavar="OUT", help="folder of `doublet reconstruct`")
    parser.add_argument("-o", "--picture", type=Path, required=True, metavar="FILE.png")
    chosen = parser.parse_args()
    driver = browser(1000, 800)
    try:
        open_page, act = PAGES[chosen.page]
        with open_page(chosen.out) as page:
            Thread(target=page.serve_forever, daemon=True).start()
            driver.get(page.url)
            WebDriverWait(driver, 60).until(lambda b: "Ready" in b.find_element(By.ID, "status").text)
            act(driver)
            driver.save_screenshot(str(chosen.picture))
            page.shutdown()
    finally:
        driver.quit()


if __name__ == "__main__":
    main()
