#!/usr/bin/python3
"""The guides (launch/guides): every command line works as typed, every block of Python runs with the values of its comments, and every
other block that names a file in /tmp in its first line becomes this file."""

import importlib.util
import os
import re
import unittest

import yaml

import readme_test
from code_blocks import BLOCK, CodeTest

FOLDER = os.path.join("launch", "guides")
PART = re.compile(r"^```(\w*)\n(.*?)^```$|^((?:    [^\n]*\n)+)", re.M | re.S)
NAMED = re.compile(r"(?:#|//|%) (/tmp/\S+)\n")
# Blocks that no test runs: another program is needed, or the block quotes a file of the package.
QUOTED = {"matlab", "cpp", "cmake", ""}


def guides():
    """(name, text) of the guides in the order of their list."""
    listed = re.findall(r"^- \[(.+)\]\((\w+\.md)\)$", readme_test.text_of(os.path.join(FOLDER, "README.md")), re.M)
    return [(title, name, readme_test.text_of(os.path.join(FOLDER, name))) for title, name in listed]


class Guides(readme_test.Commands, CodeTest):
    shorter = ()

    def test_every_guide_is_listed_by_its_title_and_is_one_page(self):
        self.assertGreaterEqual(len(guides()), 10)
        present = {name for name in os.listdir(os.path.join(readme_test.PACKAGE, FOLDER)) if name != "README.md"}
        self.assertEqual({name for _, name, _ in guides()}, present)
        for title, name, text in guides():
            self.assertEqual(text.splitlines()[0], "# " + title, name)
            self.assertLessEqual(len(text.splitlines()), 75, name)

    def test_links_lead_to_files(self):
        for _, name, text in guides():
            for link, _, anchor in re.findall(r"\]\((?!http)([^)#]+)(#([^)]+))?\)", text):
                file = os.path.join(FOLDER, link)
                self.assertTrue(os.path.exists(os.path.join(readme_test.PACKAGE, file)), name + ": " + link)
                headings = re.findall("^#+ (.+)$", readme_test.text_of(file), re.M) if anchor else []
                self.assertIn(anchor, [re.sub(r"[^\w -]", "", of.lower()).replace(" ", "-") for of in headings] + [""], name + ": " + link)

    def test_quoted_blocks_are_lines_of_the_example(self):
        example = "".join(readme_test.text_of(os.path.join("launch", "examples", "string_margin", name))
                          for name in ("CMakeLists.txt", os.path.join("src", "string_margin.cpp")))
        quoted = [line.strip() for _, _, text in guides() for language, block in BLOCK.findall(text) if language in ("cpp", "cmake")
                  for line in block.splitlines()]
        self.assertGreater(len(quoted), 5)
        for line in quoted:
            self.assertIn(line, example)

    def save(self, text):
        """Writes a block to the file that its first line names."""
        file = NAMED.match(text)[1].replace("/tmp/", self.folder + "/")
        os.makedirs(os.path.dirname(file), exist_ok=True)
        content = text.split("\n", 1)[1] if file.endswith(".csv") else text
        if file.endswith((".yaml", ".yml")):
            yaml.safe_load(content)
        with open(file, "w") as stream:
            stream.write(content.replace("/tmp/", self.folder + "/"))

    def test_every_block_works_in_turn(self):
        for _, name, text in guides():
            with self.subTest(guide=name):
                os.makedirs(self.folder, exist_ok=True)
                session, lines = {}, []
                for language, block, commands in PART.findall(text + "\n"):
                    if commands:
                        lines += readme_test.command_lines(commands)
                        continue
                    if language in QUOTED:
                        continue
                    self.type_all(lines)
                    lines = []
                    if NAMED.match(block):
                        self.save(block)
                    elif language == "python" and ("import pandas" not in block or importlib.util.find_spec("pandas")):
                        self.run_block(block.replace("/tmp/", self.folder + "/"), session)
                    elif language == "python":
                        print("left out, without pandas: a block of " + name)
                    else:
                        self.fail("a block of {} that names no file".format(language))
                self.type_all(lines)
        self.assertGreaterEqual(self.checked, 3)


if __name__ == "__main__":
    unittest.main()
