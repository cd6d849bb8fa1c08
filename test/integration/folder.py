"""A temporary folder for each test, and processes that end with it. A test that imports this module runs contained: see contained.py."""

import os
import shutil
import subprocess
import sys
import tempfile
import unittest

sys.path.append(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))

import contained  # noqa: E402: test/contained.py

contained.contain_this_script()


def temporary_folder(cleanup):
    """A new folder that `cleanup` (addCleanup, addClassCleanup) removes."""
    folder = tempfile.mkdtemp()
    cleanup(shutil.rmtree, folder, ignore_errors=True)
    return folder


class FolderTest(unittest.TestCase):
    def setUp(self):
        self.folder = temporary_folder(self.addCleanup)

    def path(self, *names):
        return os.path.join(self.folder, *names)

    def write(self, name, text):
        """Writes a file in the folder; returns its path."""
        with open(self.path(name), "w") as file:
            file.write(text)
        return self.path(name)

    def background(self, *command, **options):
        """Starts a process that ends with the test."""
        process = subprocess.Popen(command, **options)
        self.addCleanup(process.wait)
        self.addCleanup(process.terminate)
        return process
