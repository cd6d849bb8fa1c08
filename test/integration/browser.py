"""A page in headless Chromium, through its driver."""

import base64
import os
import shutil
import unittest

import live_platoon
from folder import temporary_folder

live_platoon.skip_without("chromium", "chromedriver")
from selenium import webdriver  # noqa: E402
from selenium.webdriver.chrome.options import Options  # noqa: E402
from selenium.webdriver.chrome.service import Service  # noqa: E402

ARGUMENTS = ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars",
             "--force-device-scale-factor=1", "--disable-background-networking", "--disable-component-update", "--no-first-run",
             "--host-resolver-rules=MAP * ~NOTFOUND, EXCLUDE localhost, EXCLUDE 127.0.0.1")


class Browser:
    def __init__(self, width=1280, height=1200):
        options = Options()
        options.binary_location = shutil.which("chromium")
        for argument in ARGUMENTS + ("--window-size={},{}".format(width, height),):
            options.add_argument(argument)
        options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
        self.driver = webdriver.Chrome(options=options, service=Service(
            shutil.which("chromedriver"), env=dict(os.environ, TMPDIR=temporary_folder(unittest.addModuleCleanup))))  # Chromium leaves folders
        self.driver.set_page_load_timeout(30)
        self.driver.set_script_timeout(30)

    def open(self, url):
        self.driver.get(url)

    def run(self, script, *arguments):
        """Runs a script in the page; returns its result."""
        return self.driver.execute_script(script, *arguments)

    def text(self, selector):
        return self.run("return document.querySelector(arguments[0]).textContent", selector)

    def device(self, command, **parameters):
        return self.driver.execute_cdp_cmd(command, parameters)

    def show_as(self, width, height, dark=False, scale=1):
        self.device("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=scale, mobile=width < 600)
        self.device("Emulation.setEmulatedMedia", features=[{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}])

    def complaints(self):
        """Warnings and errors on the console since the last call."""
        return [entry["message"] for entry in self.driver.get_log("browser") if entry["level"] in ("SEVERE", "WARNING")]

    def picture(self, path):
        """The whole page as a PNG."""
        content = self.device("Page.captureScreenshot", captureBeyondViewport=True)["data"]
        with open(path, "wb") as file:
            file.write(base64.b64decode(content))

    def close(self):
        self.driver.quit()
