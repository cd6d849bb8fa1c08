#!/usr/bin/python3
"""The API reference (.github/reference): Doxygen builds it without a warning, all its links have targets, every folder with headers is
a module, and MathJax can read every formula. Without Doxygen 1.9.4 the test is skipped: status 77."""

import glob
import html
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest
import urllib.parse

import live_platoon

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
FORMULA = re.compile(r"\\\[.*?\\\]|\\\(.*?\\\)", re.S)


def build(package, folder, **environment):
    return subprocess.run([os.path.join(package, ".github/reference/run"), folder], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                          universal_newlines=True, env=dict(os.environ, **environment))


class Reference(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.mkdtemp()
        cls.addClassCleanup(shutil.rmtree, cls.folder, ignore_errors=True)
        cls.built = build(PACKAGE, cls.folder)
        cls.pages = {}
        for path in glob.glob(os.path.join(cls.folder, "html", "*.html")):
            with open(path) as file:
                cls.pages[os.path.basename(path)] = file.read()

    def test_it_is_built_without_a_warning(self):
        self.assertEqual(self.built.stdout, "reference: {}/html/index.html\n".format(self.folder))
        self.assertEqual(self.built.returncode, 0)

    def test_model_theory_and_the_library_for_external_vehicles_have_their_pages(self):
        for name, words in (("structplatoon_1_1PlatoonModel.html", "the contents of the model file"),
                            ("classplatoon_1_1ExternalVehicle.html", "keeps the vehicle contract"),
                            ("index.html", "structplatoon_1_1PlatoonModel.html")):
            self.assertTrue(words in self.pages[name], name)
        for name in ("string_stability", "error_moments", "stationary_variances", "stable_headways"):
            self.assertTrue("</span>{}()".format(name) in self.pages["group__math__string.html"], name)

    def test_the_main_page_leads_to_the_python_module(self):
        for name, page, words in (("Model", "classstochastic__platoon_1_1model_1_1Model.html", "replace"),
                                  ("analyze", "namespacestochastic__platoon_1_1theory.html", "stability_map"),
                                  ("rare", "namespacestochastic__platoon_1_1rare__events.html", "that a gap falls below"),
                                  ("tune", "namespacestochastic__platoon_1_1tuning.html", "minimise"),
                                  ("Results", "classstochastic__platoon_1_1results_1_1Results.html", "standard_error_of_variance")):
            self.assertRegex(self.pages["index.html"], 'href="{}[^"]*"[^>]*>sp.{}</a>'.format(page, name))
            self.assertTrue(words in self.pages[page], name)

    def test_the_stationary_variance_is_a_formula(self):
        formula = r"\[ P_1 = \|H T\|_2^2 P_d, \qquad P_i = P_{i-1} + \|S T^{i-1}\|_2^2 P_d, \]"
        self.assertTrue('<p class="formulaDsp">\n' + formula in self.pages["group__math__string.html"])
        self.assertTrue(os.path.exists(os.path.join(self.folder, "html", "mathjax", "MathJax.js")))

    def test_every_link_leads_to_a_file_and_those_of_the_readmes_to_a_heading(self):
        readmes = 0
        for name, page in self.pages.items():
            for link in set(re.findall(r'(?:href|src)="([^"]*)"', page)):
                file, _, anchor = urllib.parse.unquote(html.unescape(link)).partition("#")
                if re.match(r"\w+:", file):
                    continue
                self.assertTrue(os.path.exists(os.path.join(self.folder, "html", file or name)), "{}: {}".format(name, link))
                if file.startswith("page-") and anchor:
                    readmes += 1
                    self.assertTrue('id="{}"'.format(anchor) in self.pages[file], "{}: {}".format(name, link))
        self.assertGreater(readmes, 10)

    def test_every_folder_with_headers_is_a_module(self):
        with open(os.path.join(PACKAGE, ".github/reference/structure.dox")) as file:
            modules = set(re.findall(r"@defgroup (\w+_\w+)", file.read())) - {"external_vehicle"}
        headers = glob.glob(os.path.join(PACKAGE, "src/stochastic_platoon/*/*/*.hpp"))
        self.assertEqual(modules, {"_".join(header.split(os.sep)[-3:-1]) for header in headers})

    @unittest.skipUnless(shutil.which("chromium") and shutil.which("chromedriver"), "needs chromium and chromium-driver")
    def test_mathjax_reads_every_formula(self):
        formulas = sorted({found for page in self.pages.values() for found in FORMULA.findall(page)})
        self.assertGreater(len(formulas), 40)
        path = os.path.join(self.folder, "html", "all_formulas.html")
        with open(path, "w") as file:
            head = re.search(r'<script type="text/x-mathjax-config">.*?MathJax\.js"></script>', self.pages["index.html"], re.S)[0]
            file.write("<html><head>{}</head><body><p>{}</p></body></html>".format(head, "</p><p>".join(formulas)))
        from browser import Browser
        browser = Browser()
        self.addCleanup(browser.close)
        browser.open("file://" + path)
        read = live_platoon.wait_for(lambda: browser.run(
            "return window.MathJax && MathJax.isReady && MathJax.Hub.queue.pending === 0 && MathJax.Hub.getAllJax().length > 0 &&"
            "MathJax.Hub.getAllJax().map(jax => [jax.originalText, !!jax.texError])"), "MathJax")
        self.assertEqual(len(read), len(formulas))
        self.assertEqual([text for text, is_error in read if is_error], [])

    def test_a_docstring_that_names_a_parameter_that_does_not_exist_fails(self):
        copy = os.path.join(self.folder, "copy")
        shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("build", "devel", "install", ".git", "data", "corpus", "__pycache__"))
        with open(os.path.join(copy, "src/stochastic_platoon/math/string/settling_time.hpp"), "a") as file:
            file.write("/// @param vehicles no parameter has this name\nvoid broken(int followers);\n")
        broken = build(copy, os.path.join(copy, "output"))
        self.assertNotEqual(broken.returncode, 0)
        self.assertIn("settling_time.hpp", broken.stdout)
        self.assertIn("argument 'vehicles'", broken.stdout)

    def test_without_doxygen_one_line_names_the_packages(self):
        programs = os.path.join(self.folder, "programs")
        os.mkdir(programs)
        for name in ("bash", "dirname", "realpath"):
            os.symlink(shutil.which(name), os.path.join(programs, name))
        for environment in (dict(PATH=programs), dict(MATHJAX="/nowhere")):
            failed = build(PACKAGE, os.path.join(self.folder, "none"), **environment)
            self.assertEqual(failed.stdout, "reference: Doxygen or MathJax is missing: apt install doxygen libjs-mathjax\n")
            self.assertEqual(failed.returncode, 1)


if __name__ == "__main__":
    live_platoon.skip_without("doxygen")
    VERSION = subprocess.run(["doxygen", "--version"], stdout=subprocess.PIPE, universal_newlines=True, check=True).stdout
    if not VERSION.startswith("1.9.4"):
        print("skipped: needs Doxygen 1.9.4, as others give other warnings; found " + VERSION)
        sys.exit(77)
    unittest.main()
