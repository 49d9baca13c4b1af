"""What Python says of a build tree in which the module was not built: its package must not import as an empty one."""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import unittest

SOURCES = pathlib.Path(__file__).resolve().parents[2]
BUILT = pathlib.Path(os.environ["PYTHONPATH"]) / "aurasim"


def try_to_import(folder):
    return subprocess.run([sys.executable, "-c", "import aurasim; print(aurasim.World)"], capture_output=True, text=True,
                          env={**os.environ, "PYTHONPATH": str(folder)}, timeout=60)


class ImportTest(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="aurasim_import_"))
        self.addCleanup(shutil.rmtree, self.folder)

    def test_a_package_without_its_module_says_what_to_build(self):
        shutil.copytree(BUILT, self.folder / "aurasim", ignore=shutil.ignore_patterns("*.so"))
        tried = try_to_import(self.folder)
        self.assertNotEqual(tried.returncode, 0, tried.stdout)
        self.assertIn("ImportError", tried.stderr)
        self.assertIn("--target aurasim_python", tried.stderr)
        self.assertIn(str(self.folder), tried.stderr)

    def test_a_tree_that_is_configured_and_not_built_says_so_too(self):
        """The module's own CMakeLists.txt, with stand-ins for what it links."""
        (self.folder / "main.cpp").write_text("int main() {}\n")
        (self.folder / "CMakeLists.txt").write_text(f"""
            cmake_minimum_required(VERSION 3.25)
            project(aurasim CXX)
            add_library(aurasim_client_objects OBJECT main.cpp)
            add_library(aurasim_options INTERFACE)
            function(aurasim_say_if_not_built)
            endfunction()
            add_executable(aurasim main.cpp)
            add_subdirectory({SOURCES / "src" / "python"} python)
        """)
        subprocess.run(["cmake", "-S", self.folder, "-B", self.folder / "build", "-G", "Ninja"], check=True,
                       capture_output=True, timeout=100)
        tried = try_to_import(self.folder / "build" / "python")
        self.assertIn("ImportError", tried.stderr)
        self.assertIn("--target aurasim_python", tried.stderr)

    def test_what_is_built_imports(self):
        tried = try_to_import(BUILT.parent)
        self.assertEqual(tried.returncode, 0, tried.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
