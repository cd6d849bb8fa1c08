"""The base of tests that compare the Python module with the programs."""

import numpy as np

from folder import FolderTest
from live_platoon import tool

SIGNALS = ["gap", "speed", "acceleration"]


def program(name, *arguments, fails=False, **options):
    """What a program prints that succeeds, or fails as it should."""
    result = tool(name, *arguments, **options)
    assert (result.returncode != 0) == fails, result.stderr
    return result.stderr if fails else result.stdout


class ModuleTest(FolderTest):
    def assertRaisesText(self, kind, text, function, *arguments, **options):
        with self.assertRaises(kind) as caught:
            function(*arguments, **options)
        self.assertIn(text, caught.exception.args[0])

    def assertSameTables(self, one, other):
        for name in one.summary["crc32"]:
            if name != "summary":
                columns, others = one.table(name), other.table(name)
                self.assertEqual(list(columns), list(others))
                for column in columns:
                    np.testing.assert_array_equal(columns[column], others[column])
                self.assertEqual(one.summary["crc32"][name], other.summary["crc32"][name])
