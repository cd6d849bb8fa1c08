#!/usr/bin/python3
"""The package's files agree with each other: package.xml declares the imported packages, and the named files exist."""

import ast
import collections
import glob
import importlib.util
import os
import re
import subprocess
import sysconfig
import unittest
import xml.etree.ElementTree

PACKAGE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
TOP = {"CHANGELOG.rst", "CMakeLists.txt", "LICENSE", "README.md", "config", "launch", "msg", "package.xml", "src", "test"}  # and dot-files
OURS = {"plotting", "reporting", "stochastic_platoon", "watching"}
NAMED_FILE = re.compile(r"(?<![\w/.*-])((?:src|launch|config|msg|test)/[\w/.-]+\.(?:py|cpp|hpp|launch|yaml|md|msg|srv|js|html))\b")

# A constant, an alias or a type at the level of a namespace, as clang-format lays it out.
GLOBAL_NAME = re.compile(r"^(?:constexpr [\w:<>, ]+[ >](?P<constant>k\w+)(?:\[\])? ?[={]|using (?P<alias>\w+) = (?P<meaning>[^;]*);|"
                         r"(?:struct|class|enum class) (?P<type>\w+)\b[^;\n]*{)", re.M)

# What ROS Noetic's compiler, libraries and Python do not have yet; Debian 11, which test/distributions tries, has some of it.
TOO_NEW = {
    ("cpp", "hpp"): {
        r"\.(?:expm1|logistic|rint|cbrt)\(\)|\.reshaped\b|\bEigen::(?:seqN?|all|last|lastN|fix)\b|\.(?:col|row)wise\(\)\.(?:begin|end)\(": "Eigen 3.4",
        r"\bregister_local_\w+|\)\.reshape\(|\bpy::(?:module_|kw_only|pos_only|is_final|type|prepend|custom_type_setup)\b": "pybind11 2.6 or 2.8",
        r"\bordered_json\b|\bNLOHMANN_DEFINE_\w+|\bpatch_inplace\b|\bas_base_class\b": "nlohmann-json 3.9",
        r"#include <(?:bit|concepts|format|numbers|ranges|source_location|span|syncstream)>|\bstd::(?:ssize|erase_if|to_chars)\b": "C++20 or GCC 11",
    },
    ("py",): {
        r"\bsys\.stdlib_\w+|\bzip\([^\n]*strict=|\.bit_count\(|\bpairwise\(|\broot_dir=": "Python 3.10",
        r"\.remove(?:prefix|suffix)\(|\bfunctools\.cache\b|\bmath\.(?:lcm|nextafter|ulp)\b|\bast\.unparse\b|\brandbytes\(|\b(?:graphlib|zoneinfo|tomllib)\b": "Python 3.9",
        r"\benter(?:Class|Module)?Context\(|\bassertNoLogs\(|\bprocess_group=|\bfile_digest\(": "Python 3.10 or 3.11",
    },
    ("txt", "cmake"): {
        r"\b(?:cmake_path|cmake_language)\(|\bCOMMAND_ERROR_IS_FATAL\b|\bfile\(REAL_PATH\b|\bblock\(": "CMake 3.18 or later",
    },
}


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


def is_standard(module):
    """Whether Python's own library has the module; only Python 3.10 and later list them."""
    found = importlib.util.find_spec(module)
    return found is not None and (found.origin in ("built-in", "frozen") or (found.origin or "").startswith(sysconfig.get_path("stdlib") + "/"))


class Package(unittest.TestCase):
    def test_imports_of_the_installed_programs_are_declared(self):
        manifest = xml.etree.ElementTree.fromstring(text_of("package.xml"))
        declared = {entry.text.replace("python3-", "") for kind in ("depend", "exec_depend") for entry in manifest.findall(kind)}
        # What ros-core depends on, the Debian package need not name.
        packaged = {name.replace("-", "_") for name in re.findall(r"python3-([\w-]+)", text_of("CMakeLists.txt"))} | {"rosgraph", "roslaunch"}
        found = 0
        for name in source_files():
            if name.startswith(("src", "launch")) and is_python(name):
                foreign = {module for module in set(imported(name)) - OURS if not is_standard(module)}
                found += len(foreign)
                self.assertEqual(foreign - declared, set(), name + ": missing in package.xml")
                self.assertEqual(foreign - packaged, set(), name + ": missing in CPACK_DEBIAN_PACKAGE_DEPENDS")
        self.assertGreater(found, 20)

    def test_a_path_with_a_space_is_rejected_before_anything_is_installed_or_built(self):
        script = 'source_folder="/tmp/my platoon"; . "{}"; platoon_install() {{ echo installs; }}; platoon_setup'.format(
            os.path.join(PACKAGE, "launch", "setup.bash"))
        done = subprocess.run(["bash", "-c", script], stdout=subprocess.PIPE, stderr=subprocess.PIPE, universal_newlines=True)
        self.assertEqual((done.returncode, done.stdout), (1, ""))
        self.assertIn("/tmp/my platoon: must be a path without spaces", done.stderr)

    def test_nothing_is_newer_than_noetic_has(self):
        """CMake 3.16, Eigen 3.3.7, GCC 9, nlohmann-json 3.7.3, pybind11 2.4.3, Python 3.8."""
        read = 0
        for name in source_files():
            kind = "py" if is_python(name) else name.rpartition(".")[2]
            if kind == "py":
                ast.parse(text_of(name), name, feature_version=(3, 8))
            for pattern, version in next((table for kinds, table in TOO_NEW.items() if kind in kinds), {}).items():
                read += 1
                found = name != os.path.relpath(__file__, PACKAGE) and re.search(pattern, text_of(name))
                self.assertFalse(found, "{}: {} needs {}".format(name, found and found[0], version))
        self.assertGreater(read, 1500)

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

    def test_the_table_of_equations_names_sources_and_tests_that_exist(self):
        """`folder/name` names src/stochastic_platoon/folder/name.* or test/unit/folder/name_test.*; later names of a cell lie beside it."""
        table = text_of("src/README.md").split("| paper | source | test |")[1].split("\n\n")[0]
        found = 0
        for row in table.splitlines()[2:]:
            for cell in row.split("|")[2:4]:
                folder = ""
                for path in re.findall(r"`([\w/.*]+)`", cell):
                    if "." in path and not glob.glob(os.path.join(PACKAGE, path)):
                        places = [os.path.join("test", "**", path)]
                    else:
                        folder = os.path.dirname(path) or folder
                        name = os.path.join(folder, os.path.basename(path))
                        places = [name, os.path.join("src", "stochastic_platoon", name + ".*"), os.path.join("test", "unit", name + "_test.*"), name + ".*"]
                    self.assertTrue(any(glob.glob(os.path.join(PACKAGE, place), recursive=True) for place in places), path)
                    found += 1
        self.assertGreater(found, 50)

    def test_sources_whose_tests_have_their_names_in_the_table_of_equations_have_such_tests(self):
        """In a row with "tests of these names", but for those that it names a test for: `source` in `test`."""
        table = text_of("src/README.md").split("| paper | source | test |")[1].split("\n\n")[0]
        found = 0
        for row in table.splitlines()[2:]:
            sources, tests = row.split("|")[2:4]
            if not re.match(r" tests? of th(ese|is) names?", tests):
                continue
            elsewhere = {os.path.basename(source): test for source, test in re.findall(r"`([\w/]+)` in `([\w/.]+)`", tests)}
            folder = ""
            for path in re.findall(r"`([\w/]+)`", sources):
                folder = os.path.dirname(path) or folder
                name = os.path.basename(path)
                test = elsewhere.pop(name, None)
                places = [test, os.path.join("test", "unit", "**", test + "_test.*")] if test else [
                    os.path.join("test", "unit", folder, name + "_test.*"), os.path.join(folder, name + "_test.*")]
                self.assertTrue(any(glob.glob(os.path.join(PACKAGE, place), recursive=True) for place in places), name + ": " + row)
                found += 1
            self.assertEqual(elsewhere, {}, "not a source of its row")
        self.assertGreater(found, 30)

    def test_folders_depend_on_each_other_in_one_direction(self):
        """Folders of src/stochastic_platoon by their includes: no circle, and no wing includes one above it."""
        wings, below = ["math", "run", "ros"], collections.defaultdict(set)
        for name in source_files():
            own = re.match(r"src/stochastic_platoon/(\w+/\w+)/", name)
            for used in re.findall(r'#include "stochastic_platoon/(\w+/\w+)/', text_of(name)) if own else ():
                self.assertLessEqual(wings.index(used.split("/")[0]), wings.index(own[1].split("/")[0]), name)
                if used != own[1]:
                    below[own[1]].add(used)
        self.assertGreater(len(below), 20)
        while below:
            ground = [folder for folder in below if not below[folder] & set(below)]
            self.assertTrue(ground, "these folders include each other: {}".format(sorted(below)))
            for folder in ground:
                del below[folder]

    def test_constants_and_types_of_a_library_have_different_names(self):
        """Two files of a library that define the same name in unnamed namespaces cannot be compiled as one file (CMAKE_UNITY_BUILD)."""
        places, meanings = collections.defaultdict(set), collections.defaultdict(set)
        for name in source_files():
            library = re.match(r"src/(?:stochastic_platoon/)?(\w+)/.*\.cpp$", name)
            for definition in GLOBAL_NAME.finditer(text_of(name)) if library else ():
                key = library[1], definition["constant"] or definition["alias"] or definition["type"]
                places[key].add(name)
                meanings[key].add(definition["meaning"] or name)  # equal aliases may be repeated
        self.assertGreater(len(places), 150)
        for key, files in places.items():
            self.assertTrue(len(files) == 1 or len(meanings[key]) == 1, "{} is defined in {}".format(key[1], ", ".join(sorted(files))))

    @unittest.skipUnless(os.path.exists(os.path.join(PACKAGE, ".git")), "needs the repository")
    def test_nothing_else_lies_at_the_top_level(self):
        tracked = subprocess.run(["git", "-c", "safe.directory=*", "-C", PACKAGE, "ls-files"], stdout=subprocess.PIPE, universal_newlines=True, check=True)
        top = {name.split("/")[0] for name in tracked.stdout.splitlines()}
        self.assertEqual({name for name in top if not name.startswith(".")}, TOP)


if __name__ == "__main__":
    unittest.main()
