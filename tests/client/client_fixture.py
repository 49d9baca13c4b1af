"""What tests of the Python module share: a DDS domain of their own, worlds, and a look at what is left behind."""

import csv
import fcntl
import os
import pathlib
import shutil
import subprocess
import tempfile
import time
import unittest

import aurasim

GENEROUS_S = 90.0  # for what happens at once on a machine that has nothing else to do
SOURCES = pathlib.Path(__file__).resolve().parents[2]


class LeasedDomain:
    """As tests/own_domain.h: who holds it has locked a file of its number."""

    FIRST, COUNT = 2, 100

    def __init__(self):
        folder = pathlib.Path(tempfile.gettempdir()) / "aurasim_test_domains"
        folder.mkdir(mode=0o1777, exist_ok=True)
        for tries in range(self.COUNT):
            self.number = self.FIRST + (31 * os.getpid() + LeasedDomain.cursor + tries) % self.COUNT
            file = os.open(folder / str(self.number), os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o666)
            try:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                os.close(file)
                continue
            self.file = file
            LeasedDomain.cursor += tries + 1
            return
        raise RuntimeError("no DDS domain is free")

    cursor = 0

    def release(self):
        os.close(self.file)


def launch_file(name):
    return SOURCES / "launch_configs" / f"{name}.yaml"


def wait_until(condition, patience_s=GENEROUS_S):
    end = time.monotonic() + patience_s
    while not condition():
        if time.monotonic() > end:
            return False
        time.sleep(0.02)
    return True


def command_line(pid):
    try:
        words = pathlib.Path(f"/proc/{pid}/cmdline").read_bytes().split(b"\0")
        state = pathlib.Path(f"/proc/{pid}/stat").read_text().rsplit(")", 1)[1].split()[0]
    except OSError:
        return []
    return [] if state == "Z" else [word.decode() for word in words]


def processes_of_domain(domain):
    """Those with `--set dds.domain=N`: launchers, nodes."""
    named = f"dds.domain={domain}"
    return [int(entry) for entry in os.listdir("/proc") if entry.isdigit() and named in command_line(entry)]


def shared_memory_of_dds():
    return {name for name in os.listdir("/dev/shm") if "fastrtps" in name or "fastdds" in name}


def is_mapped(name):
    for entry in os.listdir("/proc"):
        try:
            if entry.isdigit() and f"/dev/shm/{name}" in pathlib.Path(f"/proc/{entry}/maps").read_text():
                return True
        except OSError:
            continue
    return False


def hashes(report):
    with open(pathlib.Path(report) / "state_hash.csv") as file:
        return {int(row["step"]): row["hash"] for row in csv.DictReader(file)}


def setpoint_rows(report):
    with open(pathlib.Path(report) / "setpoints.csv") as file:
        return list(csv.DictReader(file))


class WorldTest(unittest.TestCase):
    def setUp(self):
        self.domain = LeasedDomain()
        self.addCleanup(self.domain.release)
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="aurasim_client_"))
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)
        self.memory_before = shared_memory_of_dds()
        self.worlds = []

    def tearDown(self):
        agents = [world.agent_pid for world in self.worlds]
        for world in self.worlds:
            world.close()
        number = self.domain.number
        self.assertTrue(wait_until(lambda: not processes_of_domain(number)), "processes are left behind")
        self.assertEqual([pid for pid in agents if pid and command_line(pid)[1:2] == ["agent"]], [])
        left = [name for name in shared_memory_of_dds() - self.memory_before if not is_mapped(name)]
        self.assertEqual(left, [], "/dev/shm")

    def overrides(self, **more):
        """Keyword a__b is key a.b."""
        return {"dds.domain": self.domain.number, **{key.replace("__", "."): value for key, value in more.items()}}

    def keep(self, world):
        self.worlds.append(world)
        return world

    def launch(self, name="demo", paused=True, load=None, report=None, **overrides):
        world = self.keep(aurasim.World.launch(launch_file(name), set=self.overrides(**overrides), paused=paused,
                                               load=load, report=report, saves=self.folder / "saves",
                                               timeout=GENEROUS_S))
        if paused and load is None:
            self.assertEqual(world.bodies().step, 0)
        return world

    def connect(self, name="demo", timeout=GENEROUS_S, **overrides):
        return self.keep(aurasim.World.connect(launch_file(name), set=self.overrides(**overrides), timeout=timeout))

    def assert_same_from_record(self, name, live, called, **layout):
        """A run of the same launch file that is given the record of `live` has its bits in every state."""
        expected = hashes(live)
        again = self.folder / f"again on {called}"
        words = [os.environ["AURASIM_PROGRAM"], "launch", str(launch_file(name)), "--headless", "--steps",
                 str(max(expected)), "--report", str(again)]
        overrides = self.overrides(time__sync="deterministic", time__pace="none", **layout)
        for key, value in {**overrides, "control.replay": str(live / "setpoints.csv")}.items():
            words += ["--set", f"{key}={value}"]
        done = subprocess.run(words, capture_output=True, text=True, timeout=3 * GENEROUS_S)
        self.assertEqual(done.returncode, 0, done.stderr[-2000:])
        found = hashes(again)
        differ = [step for step in expected if found.get(step) != expected[step]]
        self.assertEqual(differ, [], f"{called}: {len(differ)} of {len(expected)} states")
