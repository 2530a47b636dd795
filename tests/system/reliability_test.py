#!/usr/bin/python3
"""A run is never lost: restarts, signals, faults. Usage: reliability_test.py BIN_DIRECTORY [unittest options]"""

import concurrent.futures
import csv
import errno
import os
import pathlib
import shlex
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import unittest
import xml.etree.ElementTree

import h5py
import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(sys.argv.pop(1)).resolve()
SHIM = BIN.parent / "tests/libfault_shim.so"
QUICK = ROOT / "input/jet60-quick.toml"
STOPPED = 4
FIELDS = ("Points", "PointData/id", "PointData/velocity", "PointData/pressure", "PointData/pressure_impulse")


def command(*words, ranks=2):
    launcher = ["mpirun", "--oversubscribe", "-n", str(ranks)] if ranks else []
    return [*launcher, str(BIN / "impinge"), *map(str, words)]


class Reliability(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.directory = pathlib.Path(temporary.name)

    def impinge(self, *words, ranks=2, code=0, environment=None):
        done = subprocess.run(command(*words, ranks=ranks), cwd=self.directory, capture_output=True, text=True,
                              timeout=120, check=False, env={**os.environ, **(environment or {})})
        if code is not None:
            self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done

    def run_case(self, out, *settings, **options):
        words = [word for setting in (f"output.directory={out}", "time.end=0.1", "output.interval=0.03",
                                      "output.average_start=0.05", *settings) for word in ("--set", setting)]
        return self.impinge(QUICK, *words, **options)

    def history(self, out):
        (path,) = (self.directory / out).glob("*_history.csv")
        with open(path, encoding="utf-8") as file:
            return [{key: value for key, value in row.items() if key != "seconds"} for row in csv.DictReader(file)]

    def files(self, out, ending):
        return sorted((self.directory / out).glob(f"*.{ending}"))

    def step_of(self, path):
        return int(path.stem.split("_")[-1])

    def expect_the_same_run(self, out, expected):
        """Bitwise, but for the clock."""
        self.assertEqual(self.history(out), self.history(expected))
        tables = [path for path in self.files(expected, "csv") if not path.stem.endswith("_history")]
        for path in tables:
            self.assertEqual((self.directory / out / path.name).read_text(), path.read_text(), path.name)
        snapshots = self.files(expected, "vtkhdf")
        self.assertEqual([path.name for path in self.files(out, "vtkhdf")], [path.name for path in snapshots])
        for path in snapshots:
            with h5py.File(path) as a, h5py.File(self.directory / out / path.name) as b:
                for name in FIELDS:
                    np.testing.assert_array_equal(a["VTKHDF"][name][:], b["VTKHDF"][name][:], f"{path.name} {name}")
        series = [path.read_text() for name in (out, expected) for path in self.files(name, "xmf")]
        self.assertEqual(*series)
        listed = [path.read_text() for name in (out, expected) for path in self.files(name, "series")]
        self.assertEqual(*listed)
        times = [float(time.get("Value")) for time in xml.etree.ElementTree.fromstring(series[0]).iter("Time")]
        self.assertEqual(times, sorted(set(times)))
        self.assertEqual(len(times), len(snapshots))


class Restart(Reliability):
    def test_goes_on_bitwise_and_keeps_the_last_two(self):
        self.run_case("whole", "checkpoint.minutes=0")
        self.assertEqual(self.files("whole", "checkpoint"), [])
        steps = len(self.history("whole"))
        self.run_case("out", "checkpoint.steps=17")
        checkpoints = self.files("out", "checkpoint")
        self.assertEqual([self.step_of(path) for path in checkpoints], [(steps - 1) // 17 * 17, steps])
        self.expect_the_same_run("out", "whole")
        checkpoints[-1].unlink()
        done = self.impinge("--restart", "out")
        self.assertIn(f"from step {self.step_of(checkpoints[0])}", done.stdout)
        self.expect_the_same_run("out", "whole")
        # The end is a checkpoint, too.
        self.assertIn(f"from step {steps}", self.impinge("--restart", "out").stdout)
        self.expect_the_same_run("out", "whole")

    def test_goes_on_bitwise_between_times_of_output(self):
        settings = ("checkpoint.interval=0.021", "output.interval=0.016", "checkpoint.minutes=0")
        self.run_case("whole", *settings)
        self.run_case("out", *settings)
        before_the_end, at_the_end = self.files("out", "checkpoint")
        at_the_end.unlink()
        with h5py.File(before_the_end) as file:
            self.assertEqual(file.attrs["time"], 4 * 0.021)
        self.impinge("--restart", "out")
        self.expect_the_same_run("out", "whole")

    def test_prolongs_a_run_elsewhere_on_other_ranks_and_refuses_changes(self):
        self.run_case("whole", "checkpoint.minutes=0", "pressure.tolerance=1e-12")
        self.run_case("out", "time.end=0.05", "output.average_start=0.03", "pressure.tolerance=1e-12")
        (self.directory / "out").rename(self.directory / "moved")
        done = self.impinge("--restart", "moved", "--set", "particles.spacing=0.01", "--set", "time.end=0.1", code=2)
        self.assertIn("--set: particles.spacing = 0.01: a restart cannot change this key; allowed: 0.02", done.stderr)
        self.impinge("--restart", "moved", "--set", "time.end=0.1", "--set", "output.average_start=0.05", ranks=3)
        self.assertFalse((self.directory / "out").exists())
        history, expected = self.history("moved"), self.history("whole")
        self.assertEqual([row["step"] for row in history], [row["step"] for row in expected])
        for name in ("t", "kinetic_energy", "plate_force"):
            self.assertAlmostEqual(float(history[-1][name]) / float(expected[-1][name]), 1.0, delta=1e-7)

    def test_refuses_damaged_checkpoints_and_takes_the_one_before(self):
        self.run_case("whole", "checkpoint.minutes=0")
        self.run_case("out", "checkpoint.steps=20")
        older, newer = self.files("out", "checkpoint")
        whole = newer.read_bytes()
        kept = older.read_bytes()

        def damages():
            yield "truncated", lambda: newer.write_bytes(whole[:-1000])
            yield "cannot read", lambda: newer.write_bytes(b"")
            yield "cannot read", lambda: newer.write_text("no HDF5 file")
            yield "a snapshot, not a checkpoint", lambda: shutil.copy(self.files("out", "vtkhdf")[-1], newer)

            def change_a_value():
                newer.write_bytes(whole)
                with h5py.File(newer, "r+") as file:
                    file["VTKHDF/PointData/velocity"][3, 0] += 1e-9
            yield "the checksum of /VTKHDF/PointData/velocity does not match", change_a_value

            def rename_the_case():
                newer.write_bytes(whole)
                with h5py.File(newer, "r+") as file:
                    file.attrs["case"] = np.bytes_(file.attrs["case"].replace(b'"jet60-quick"', b'"other"'))
            yield "it is of the case other", rename_the_case

        for reason, damage in damages():
            older.write_bytes(kept)
            damage()
            done = self.impinge("--restart", "out")
            self.assertEqual(done.stderr.count(reason), 1, done.stderr)
            self.assertIn(f"out/{newer.name}", done.stderr)
            self.assertIn(f"from step {self.step_of(older)}", done.stdout)
            self.expect_the_same_run("out", "whole")

        older.write_text("")
        newer.write_text("")
        done = self.impinge("--restart", "out", code=2)
        self.assertIn("--restart out: no checkpoint there can be read", done.stderr)
        self.expect_the_same_run("out", "whole")  # it is left as it was
        for directory, reason in (("nowhere", "No such file or directory"), (".", "no checkpoint there")):
            done = self.impinge("--restart", directory, code=2)
            self.assertEqual(done.stderr.count(f"--restart {directory}: "), 1, done.stderr)
            self.assertIn(reason, done.stderr)
        shutil.copy(newer, newer.with_name("other_00000001.checkpoint"))
        self.assertIn("several cases: jet60-quick, other", self.impinge("--restart", "out", code=2).stderr)

    def test_a_new_run_replaces_the_checkpoints_of_the_last(self):
        self.run_case("out", "checkpoint.steps=1")
        (self.directory / "out/jet60-quick_00000099.checkpoint.partial").write_text("")
        self.run_case("out", "checkpoint.minutes=0")
        self.assertEqual(self.files("out", "checkpoint") + self.files("out", "partial"), [])

    def test_minutes(self):
        self.run_case("out", "checkpoint.minutes=1e-9", "time.end=0.01", "output.average_start=0")
        last = len(self.history("out"))
        self.assertEqual([self.step_of(path) for path in self.files("out", "checkpoint")], [last - 1, last])


class Signals(Reliability):
    def start(self, *settings, ranks=2):
        """A run that would take long; returns when it has made some steps."""
        words = [word for setting in ("output.directory=out", "time.end=1000", "output.interval=0.03",
                                      "output.average_start=0.05", *settings) for word in ("--set", setting)]
        run = subprocess.Popen(command(QUICK, *words, ranks=ranks), cwd=self.directory, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE, text=True, start_new_session=True)
        self.addCleanup(self.kill, run)
        deadline = time.time() + 60
        path = self.directory / "out/jet60-quick_history.csv"
        while time.time() < deadline and run.poll() is None and not (path.exists() and len(self.history("out")) > 60):
            time.sleep(0.01)
        return run

    def kill(self, run):
        if run.poll() is None:
            os.killpg(run.pid, signal.SIGKILL)
        run.communicate()

    def ranks_of(self, run):
        found = subprocess.run(["pgrep", "-P", str(run.pid), "impinge"], capture_output=True, text=True, check=True)
        return [int(word) for word in found.stdout.split()]

    def expect_a_stop(self, run, name):
        out, err = run.communicate(timeout=60)
        self.assertEqual(run.returncode, STOPPED, out + err)
        self.assertIn(f"{name}: stopped after step ", out)
        self.assertIn("to go on: impinge --restart out", out)
        (checkpoint,) = self.files("out", "checkpoint")
        self.assertEqual(self.step_of(checkpoint), len(self.history("out")))
        return self.step_of(checkpoint)

    def test_stop_with_a_checkpoint_from_which_the_run_goes_on_bitwise(self):
        for name, to_one_rank in (("SIGUSR1", False), ("SIGTERM", True), ("SIGINT", True)):
            shutil.rmtree(self.directory / "out", ignore_errors=True)
            run = self.start()
            if to_one_rank:
                os.kill(self.ranks_of(run)[-1], getattr(signal, name))
            else:
                os.kill(run.pid, getattr(signal, name))  # mpirun passes SIGUSR1 on
            step = self.expect_a_stop(run, name)
            last = float(self.history("out")[-1]["t"])
            end = last + 0.05  # far enough for the stopped run not to have fitted its steps to it
            self.impinge("--restart", "out", "--set", f"time.end={end}")
            self.assertGreater(len(self.history("out")), step)
            self.run_case("whole", f"time.end={end}", "checkpoint.minutes=0")
            self.expect_the_same_run("out", "whole")


    def test_streams_that_are_gone_end_no_run(self):
        """A log on a full disk, closed streams, a reader that has gone."""
        case = (ROOT / "input/hydrostatic.toml", *(word for setting in (
            "particles.spacing=0.05", "time.end=0.05", "output.interval=0", "output.average_start=0",
            "walls.model=particles") for word in ("--set", setting)))  # the last is a warning on standard error

        def at_the_end(out, shell):
            words = " ".join(map(shlex.quote, command(*case, "--set", f"output.directory={out}", ranks=0)))
            done = subprocess.run(["bash", "-c", shell.replace("RUN", words)], cwd=self.directory, capture_output=True,
                                  text=True, timeout=120, check=False)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
            self.assertEqual(len(self.files(out, "checkpoint")), 1)
            self.assertEqual(self.files(out, "lock"), [])
            return done.stderr

        self.assertIn("impinge: cannot write to standard output: No space left on device", at_the_end("a", "RUN >/dev/full"))
        at_the_end("c", "RUN <&- >&- 2>&-")
        for path in (self.directory / "c").iterdir():
            self.assertNotIn(b"particles in - out", path.read_bytes())
        at_the_end("d", "set -o pipefail; RUN | true")
        self.assertEqual(self.history("a"), self.history("c"))

    def test_a_file_beyond_its_largest_size_is_an_error(self):
        words = command(ROOT / "input/hydrostatic.toml", "--set", "particles.spacing=1e-3", "--set", "time.end=1e-3",
                        "--set", "output.directory=out", "--set", "output.average_start=0", ranks=0)
        done = subprocess.run(["mpirun", "-n", "1", "bash", "-c", 'ulimit -f 3000; exec "$@"', "bash", *words],
                              cwd=self.directory, capture_output=True, text=True, timeout=120, check=False)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertRegex(done.stderr, "impinge: cannot write out/hydrostatic_.*: ")
        self.assertEqual(self.files("out", "lock"), [])

    def test_a_run_that_was_taken_over_writes_nothing_more(self):
        """It stood still for so long that another host took it for dead."""
        run = subprocess.Popen(command(QUICK, "--set", "output.directory=out", "--set", "time.end=1000", ranks=2),
                               cwd=self.directory, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        lock, history = self.directory / "out/jet60-quick.lock", self.directory / "out/jet60-quick_history.csv"
        while not history.exists() or history.read_text().count("\n") < 3:
            time.sleep(0.1)
        owner = int(lock.read_text().split()[1])
        os.kill(owner, signal.SIGSTOP)
        time.sleep(21)
        other = self.directory / "out/other"
        other.write_text("elsewhere 7 1 - -\n")
        other.rename(lock)
        before = history.read_bytes()
        os.kill(owner, signal.SIGCONT)
        _, told = run.communicate(timeout=60)
        self.assertEqual(run.returncode, 1)
        self.assertIn("process 7 on elsewhere has taken this run over", told)
        self.assertEqual(history.read_bytes(), before)
        self.assertTrue(lock.exists())

    def test_a_container_of_the_same_host_is_another_host(self):
        container = ["unshare", "--pid", "--fork", "--mount-proc"]
        if subprocess.run([*container, "true"], capture_output=True, check=False).returncode:
            self.skipTest("process numbers of one's own are not allowed here")
        words = command(QUICK, "--set", "output.directory=out", "--set", "time.end=1000", ranks=0)
        run = subprocess.Popen(words, cwd=self.directory, stdout=subprocess.DEVNULL)
        while not self.files("out", "vtkhdf") if (self.directory / "out").exists() else True:
            time.sleep(0.1)
        done = subprocess.run([*container, *words], cwd=self.directory, capture_output=True, text=True, timeout=60, check=False)
        run.terminate()
        self.assertEqual(run.wait(60), STOPPED)
        self.assertEqual(done.returncode, 2, done.stdout + done.stderr)
        self.assertIn("is writing this run", done.stderr)

    def test_kill_9_of_one_rank_ends_all_and_loses_nothing(self):
        run = self.start("checkpoint.steps=1")
        os.kill(self.ranks_of(run)[-1], signal.SIGKILL)
        run.communicate(timeout=60)
        self.assertEqual(run.returncode, 128 + signal.SIGKILL)
        newest = self.step_of(self.files("out", "checkpoint")[-1])
        self.assertGreaterEqual(newest, len(self.history("out")) - 1)
        done = self.impinge("--restart", "out", "--set", "time.end=1e-3", "--set", "output.average_start=0")
        self.assertIn(f"from step {newest},", done.stdout)

    def test_a_removed_directory_is_told(self):
        run = self.start("checkpoint.steps=5")
        shutil.rmtree(self.directory / "out", ignore_errors=True)
        _, err = run.communicate(timeout=60)
        self.assertEqual(run.returncode, 1, err)
        self.assertRegex(err, r"impinge: cannot write out/\S+: .*[nN]o such file or directory")


class Faults(Reliability):
    """The third step of a run, broken off between any two system calls that write its files."""

    CASE = ROOT / "tests/system/basin.toml"
    WORDS = [word for setting in ("particles.spacing=0.05", "output.interval=1e-3", "checkpoint.steps=1",
                                  "output.average_start=0") for word in ("--set", setting)]
    END = ("--set", "time.end=3e-3")
    ERRORS = {errno.ENOSPC: "No space left on device", errno.EIO: "Input/output error",
              errno.EROFS: "Read-only file system"}

    def setUp(self):
        super().setUp()
        self.impinge(self.CASE, *self.WORDS, "--set", "output.directory=whole", *self.END, ranks=0)
        self.impinge(self.CASE, *self.WORDS, "--set", "output.directory=before", "--set", "time.end=2e-3", ranks=0)

    def third_step(self, out, call, error=0, rank=0, ranks=0):
        shutil.copytree(self.directory / "before", self.directory / out)
        shim = {"LD_PRELOAD": str(SHIM), "ASAN_OPTIONS": "verify_asan_link_order=0",
                "FAULT_DIRECTORY": str(self.directory / out), "FAULT_AT": str(call), "FAULT_ERROR": str(error),
                "FAULT_RANK": str(rank)}
        if not ranks:
            return self.impinge("--restart", out, *self.END, ranks=0, code=None, environment=shim)
        words = command("--restart", out, *self.END, ranks=ranks)
        words[1:1] = [word for name, value in shim.items() for word in ("-x", f"{name}={value}")]
        return subprocess.run(words, cwd=self.directory, capture_output=True, text=True, timeout=30, check=False)

    def expect_that_it_goes_on(self, out, ranks=0):
        checkpoints = self.files(out, "checkpoint")
        self.assertGreaterEqual(len(checkpoints), 2)
        done = self.impinge("--restart", out, *self.END, ranks=ranks)
        self.assertNotIn("cannot read", done.stderr)
        left = [path for path in self.files(out, "partial") if path.suffixes[-2] not in (".xmf", ".series")]
        self.assertEqual(left, [])
        if not ranks:
            self.expect_the_same_run(out, "whole")
        shutil.rmtree(self.directory / out)

    def at_calls(self, calls, expect):
        """expect(output directory, call) -> False where the run came to its end; some at a time, as they mostly wait."""
        with concurrent.futures.ThreadPoolExecutor(4) as pool:
            return sum(pool.map(lambda call: expect(f"out{call}", call), calls))

    def test_kills_at_many_calls(self):
        stride = int(os.environ.get("FAULT_STRIDE", "4"))

        def is_killed(out, call):
            done = self.third_step(out, call)
            if done.returncode != 0:
                self.assertEqual(done.returncode, -signal.SIGKILL, done.stderr)
            self.expect_that_it_goes_on(out)
            return done.returncode != 0

        points = self.at_calls(sorted({*range(1, 30), *range(1, 500, stride)}), is_killed)  # all of the start
        print(f"{points} kill points survived", end=" ", flush=True)
        self.assertGreaterEqual(points, 200 // stride)

    def test_kills_of_one_rank_of_two(self):
        for rank, calls in ((0, (20, 130)), (1, (5, 45))):
            for call in calls:
                done = self.third_step("out", call, rank=rank, ranks=2)
                self.assertEqual(done.returncode, 128 + signal.SIGKILL, done.stdout + done.stderr)
                self.expect_that_it_goes_on("out", ranks=2)

    def test_errors_are_told_and_the_run_goes_on_when_they_are_gone(self):
        def is_told(out, call):
            error, reason = list(self.ERRORS.items())[call % len(self.ERRORS)]
            done = self.third_step(out, call, error)
            if done.returncode != 0:
                self.assertIn(done.returncode, (1, 2), done.stderr)
                self.assertRegex(done.stderr.lower(), f"impinge: .*{out}.*({reason.lower()}|mpi_err)")
            self.expect_that_it_goes_on(out)
            return done.returncode != 0

        self.assertGreater(self.at_calls(range(3, 250, 13), is_told), 10)

    def test_errors_of_one_rank_of_two_end_both(self):
        for rank, calls in ((0, (61, 136)), (1, (17, 73))):
            for call in calls:
                done = self.third_step("out", call, errno.ENOSPC, rank=rank, ranks=2)
                self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
                self.assertRegex(done.stderr.lower(), "cannot write out/basin_.*no space left on device")
                self.expect_that_it_goes_on("out", ranks=2)

    def test_a_full_and_a_read_only_disk(self):
        disk = self.directory / "disk"
        disk.mkdir()
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=400k", "tmpfs", str(disk)], capture_output=True,
                                 check=False)
        if mounted.returncode:
            self.skipTest("mounting a small disk is not allowed here")
        self.addCleanup(subprocess.run, ["umount", "-l", str(disk)], check=False)
        done = self.impinge(self.CASE, *self.WORDS, "--set", "output.directory=disk", "--set", "time.end=1", code=1)
        self.assertRegex(done.stderr.lower(), "cannot write disk/.*no space")
        newest = self.step_of(self.files("disk", "checkpoint")[-1])
        self.assertGreater(newest, 2)
        end = ("--set", f"time.end={(newest + 2) * 1e-3}")
        subprocess.run(["mount", "-o", "remount,ro", str(disk)], check=True)
        done = self.impinge("--restart", "disk", *end, code=2)
        self.assertIn("cannot write there: Read-only file system", done.stderr)
        subprocess.run(["mount", "-o", "remount,rw,size=2m", str(disk)], check=True)
        self.assertIn(f"from step {newest},", self.impinge("--restart", "disk", *end).stdout)
        self.assertEqual([int(row["step"]) for row in self.history("disk")], list(range(1, newest + 3)))


class Jobs(Reliability):
    def test_a_slurm_job_queues_again_after_a_signal_and_goes_on(self):
        """With an srun that notes its words and ends as it is told, and an scontrol that notes them."""
        tools = self.directory / "tools"
        tools.mkdir()
        for name, end in (("srun", 'exit "$SRUN_CODE"'), ("scontrol", "exit 0")):
            (tools / name).write_text(f'#!/bin/sh\necho {name} "$@" >>calls\n{end}\n')
            (tools / name).chmod(0o755)

        def job(restarts, code):
            environment = {"PATH": f"{tools}:{os.environ['PATH']}", "SLURM_JOB_ID": "7", "SRUN_CODE": str(code),
                           "SLURM_RESTART_COUNT": str(restarts), "CASE": "a/b.toml", "OPTIONS": "--set time.end=2"}
            (self.directory / "calls").unlink(missing_ok=True)
            done = subprocess.run(["bash", ROOT / "jobs/impinge.slurm"], cwd=self.directory, env={**os.environ, **environment},
                                  capture_output=True, text=True, check=False)
            return done.returncode, (self.directory / "calls").read_text().splitlines()

        program = "srun --mpi=pmix build/release/bin/impinge"
        start = f"{program} a/b.toml --set output.directory=output/b --set time.end=2"
        self.assertEqual(job(0, 0), (0, [start]))
        self.assertEqual(job(0, 3), (3, [start]))
        self.assertEqual(job(0, STOPPED), (0, [start, "scontrol requeue 7"]))
        self.assertEqual(job(1, 0), (0, [start]))  # no checkpoint yet
        (self.directory / "output/b").mkdir(parents=True)
        (self.directory / "output/b/b_00000001.checkpoint").write_text("")
        self.assertEqual(job(1, STOPPED), (0, [f"{program} --restart output/b --set time.end=2", "scontrol requeue 7"]))
        goes_on = f"{program} --restart output/b --set time.end=2"
        self.assertEqual(job(0, 0), (0, [goes_on]))  # submitted once more
        (self.directory / "a").mkdir()
        (self.directory / "a/b.toml").write_text("")
        os.utime(self.directory / "output/b/b_00000001.checkpoint", (0, 0))
        self.assertEqual(job(0, 0), (0, [start]))  # another case
        self.assertEqual(job(1, 0), (0, [goes_on]))  # the same job

    def test_a_pbs_job_goes_on_with_what_is_there(self):
        nodes = self.directory / "nodes"
        nodes.write_text("one\ntwo\n")
        (self.directory / "mpirun").write_text('#!/bin/sh\necho mpirun "$@" >>calls\n')
        (self.directory / "mpirun").chmod(0o755)

        def job():
            environment = {"PATH": f"{self.directory}:{os.environ['PATH']}", "PBS_NODEFILE": str(nodes), "CASE": "b.toml"}
            (self.directory / "calls").unlink(missing_ok=True)
            subprocess.run(["bash", ROOT / "jobs/impinge.pbs"], cwd=self.directory, env={**os.environ, **environment},
                           check=True)
            return (self.directory / "calls").read_text()

        program = f"mpirun -n 2 --hostfile {nodes} build/release/bin/impinge"
        start, goes_on = f"{program} b.toml --set output.directory=output/b\n", f"{program} --restart output/b\n"
        self.assertEqual(job(), start)
        (self.directory / "b.toml").write_text("")
        os.utime(self.directory / "b.toml", (0, 0))
        (self.directory / "output/b").mkdir(parents=True)
        (self.directory / "output/b/b_00000001.checkpoint").write_text("")
        self.assertEqual(job(), goes_on)
        os.utime(self.directory / "output/b/b_00000001.checkpoint", (0, 0))
        (self.directory / "b.toml").write_text("changed")
        self.assertEqual(job(), start)


class Memory(Reliability):
    @unittest.skipIf("sanitize" in BIN.parts, "AddressSanitizer keeps memory of its own; it reports leaks by itself")
    def test_does_not_grow_over_2000_steps(self):
        words = command(ROOT / "input/hydrostatic.toml", "--set", "output.directory=out", "--set", "time.end=2.6",
                        "--set", "checkpoint.steps=50", "--set", "output.interval=0.05", "-ppe_ksp_max_it", "1000",
                        ranks=0)
        with subprocess.Popen(words, cwd=self.directory, stdout=subprocess.DEVNULL) as run:
            self.addCleanup(run.kill)
            resident = {}
            path = self.directory / "out/hydrostatic_history.csv"
            while run.poll() is None:
                time.sleep(0.02)
                if path.exists():
                    step = path.read_bytes().count(b"\n") - 1
                    for line in pathlib.Path(f"/proc/{run.pid}/status").read_text().splitlines():
                        if line.startswith("VmRSS"):
                            resident[step] = int(line.split()[1])
        self.assertEqual(run.returncode, 0)
        first = max(size for step, size in resident.items() if 400 <= step <= 600)
        last = max(size for step, size in resident.items() if 2400 <= step <= 2600)
        particles = int(self.history("out")[-1]["particles"])
        growth = 1024 * (last - first) / particles
        print(f"{growth:.0f} bytes per particle over 2000 steps, of {1024 * last / particles:.0f}", end=" ", flush=True)
        self.assertLess(growth, 500)


if __name__ == "__main__":
    if os.geteuid() == 0:
        os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    unittest.main(verbosity=2)
