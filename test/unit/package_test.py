#!/usr/bin/python3
"""The package's files agree with each other: package.xml declares the imported packages, and the named files exist."""

import ast
import os
import re
import subprocess
import sys
import unittest
import xml.etree.ElementTree

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
TOP = {"CHANGELOG.rst", "CMakeLists.txt", "LICENSE", "README.md", "config", "launch", "msg", "package.xml", "src", "test"}  # and dot-files
OURS = {"plotting", "stochastic_platoon", "watching"}
NAMED_FILE = re.compile(r"(?<![\w/.*-])((?:src|launch|config|msg|test)/[\w/.-]+\.(?:py|cpp|hpp|launch|yaml|md|msg|srv|js|html))\b")


def text_of(name):
    with open(os.path.join(PACKAGE, name), errors="replace") as file:
        return file.read()


def source_files():
    """All files except those of the build, relative to the package."""
    for folder, folders, names in os.walk(PACKAGE):
        folders[:] = [name for name in folders if name not in ("build", "devel", "corpus", "data", "__pycache__", ".git")]
        for name in names:
            yield os.path.relpath(os.path.join(folder, name), PACKAGE)


def is_python(name):
    return name.endswith(".py") or re.match(r"#!/usr/bin/(env )?python3?\n", text_of(name)[:40])


def imported(name):
    for node in ast.walk(ast.parse(text_of(name))):
        if isinstance(node, ast.Import):
            yield from (alias.name.split(".")[0] for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0:
            yield node.module.split(".")[0]


class Package(unittest.TestCase):
    def test_what_the_installed_programs_import_is_declared(self):
        manifest = xml.etree.ElementTree.fromstring(text_of("package.xml"))
        declared = {entry.text.replace("python3-", "") for kind in ("depend", "exec_depend") for entry in manifest.findall(kind)}
        found = 0
        for name in source_files():
            if name.startswith(("src", "launch")) and is_python(name):
                foreign = set(imported(name)) - OURS - set(sys.stdlib_module_names)
                found += len(foreign)
                self.assertEqual(foreign - declared, set(), name + ": missing in package.xml")
        self.assertGreater(found, 20)

    def test_the_files_that_are_named_exist(self):
        found = 0
        for name in source_files():
            if name.endswith((".py", ".cpp", ".hpp", ".md", ".txt", ".launch", ".yaml", ".rst", ".msg")) or "." not in os.path.basename(name):
                for path in NAMED_FILE.findall(text_of(name)):
                    found += 1
                    beside = os.path.join(os.path.dirname(name), path)
                    self.assertTrue(any(os.path.exists(os.path.join(PACKAGE, place)) for place in (path, beside)),
                                    "{} names {}, which does not exist".format(name, path))
        self.assertGreater(found, 50)

    @unittest.skipUnless(os.path.exists(os.path.join(PACKAGE, ".git")), "needs the repository")
    def test_nothing_else_lies_at_the_top_level(self):
        tracked = subprocess.run(["git", "-c", "safe.directory=*", "-C", PACKAGE, "ls-files"], stdout=subprocess.PIPE, universal_newlines=True, check=True)
        top = {name.split("/")[0] for name in tracked.stdout.splitlines()}
        self.assertEqual({name for name in top if not name.startswith(".")}, TOP)


if __name__ == "__main__":
    unittest.main()
