"""What `pip install .` calls (PEP 517): builds the program and the module with CMake, and makes a wheel of them.

With Debian's python3-wheel, and no network: pip install --no-build-isolation .
$AURASIM_BUILD: a build folder that exists already; otherwise build/python, which takes some minutes the first time.
"""

import os
import pathlib
import subprocess
import sys
import sysconfig
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]


def _version():
    for line in (ROOT / "CMakeLists.txt").read_text().splitlines():
        if line.startswith("project(aurasim VERSION "):
            return line.split()[2]
    raise RuntimeError("CMakeLists.txt names no version")


def _run(*words):
    print("+", *words, flush=True)
    subprocess.run([str(word) for word in words], check=True, cwd=ROOT)


def _build():
    """The program as the preset `demo` has it, and the module for the Python that runs this."""
    if os.environ.get("AURASIM_BUILD"):
        return pathlib.Path(os.environ["AURASIM_BUILD"]).resolve()
    folder = ROOT / "build" / "python"
    _run("cmake", "--preset", "demo", "-B", folder, "-D", f"Python_EXECUTABLE={sys.executable}")
    _run("cmake", "--build", folder, "--target", "aurasim", "aurasim_python", "--parallel", os.cpu_count() or 1)
    return folder


def _metadata(version):
    return (f"Metadata-Version: 2.1\nName: aurasim\nVersion: {version}\n"
            "Summary: one world of rigid bodies, simulated by any number of nodes over DDS\n"
            "Requires-Python: >=3.11\nRequires-Dist: numpy\n")


def _tag():
    python = f"cp{sys.version_info.major}{sys.version_info.minor}"
    platform = sysconfig.get_platform().replace("-", "_").replace(".", "_")
    return f"{python}-{python}-{platform}"


def _write_info(folder, version):
    folder.mkdir()
    (folder / "METADATA").write_text(_metadata(version))
    (folder / "WHEEL").write_text("Wheel-Version: 1.0\nGenerator: aurasim\nRoot-Is-Purelib: false\n"
                                  f"Tag: {_tag()}\n")


def get_requires_for_build_wheel(config_settings=None):
    return []


def prepare_metadata_for_build_wheel(metadata_directory, config_settings=None):
    version = _version()
    name = f"aurasim-{version}.dist-info"
    _write_info(pathlib.Path(metadata_directory) / name, version)
    return name


def build_wheel(wheel_directory, config_settings=None, metadata_directory=None):
    from wheel.wheelfile import WheelFile

    version = _version()
    name = f"aurasim-{version}-{_tag()}.whl"
    with tempfile.TemporaryDirectory() as folder:
        stage = pathlib.Path(folder)
        # The program and what it needs lie in the package: nothing else has to be installed.
        _run("cmake", "--install", _build(), "--prefix", stage, "--component", "wheel", "--strip")
        _write_info(stage / f"aurasim-{version}.dist-info", version)
        with WheelFile(str(pathlib.Path(wheel_directory) / name), "w") as wheel:
            wheel.write_files(str(stage))
    return name


def build_sdist(sdist_directory, config_settings=None):
    raise NotImplementedError("the sources are the repository: pip install .")
