#!/usr/bin/python3
"""compare.py --data FILE of the cases with experiments: made-up runs beside made-up series, and a run that is drawn.

Usage: compare_test.py BIN_DIRECTORY [unittest options]."""

import importlib.util
import json
import pathlib
import subprocess
import sys
import tempfile
import types
import unittest

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
BIN = pathlib.Path(sys.argv.pop(1)).resolve()
sys.path.insert(0, str(ROOT / "src/programs"))
import impinge_compare  # noqa: E402


def module(case):
    """The compare.py of a case."""
    spec = importlib.util.spec_from_file_location("compare_" + case.replace("-", "_"), ROOT / "input" / case / "compare.py")
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    return loaded


def gauges(*names_and_places):
    return [{"name": name, "point": place} for name, place in names_and_places]


class Series(unittest.TestCase):
    def series(self, text):
        with tempfile.NamedTemporaryFile("w", suffix=".csv") as file:
            file.write("# made up\n" + text)
            file.flush()
            return impinge_compare.Series(file.name)

    def errors(self, case, text, **run):
        """Errors of the rows of a made-up run, whose tables are `run`, by metric."""
        fluid = {"density": 1000.0, "gravity": [0.0, -9.81]} | run.pop("fluid", {})
        more = run.pop("more", {})
        made_up = types.SimpleNamespace(spacing=0.01, case={"fluid": fluid, **more}, **run)
        return {row.metric: row for row in module(case).rows(made_up, self.series(text))}

    def test_columns_are_numbers_or_words_and_gaps_are_nan(self):
        series = self.series("series,t,z\nfirst,0,1.5\nfirst,1,\nsecond,2,3\n")
        self.assertEqual(list(series["series"]), ["first", "first", "second"])
        np.testing.assert_array_equal(series["z"], [1.5, np.nan, 3.0])
        np.testing.assert_array_equal(series.of(("t", "z"), series="sec"), [[2.0, 3.0]])

    def test_dam_break(self):
        t = np.linspace(0, 2, 201)
        rate = np.sqrt(9.81 / 0.3)
        run = {"gauges": {"t": t, **{f"H{k}": 0.3 * 0.5 + 0 * t for k in range(1, 5)}},
               "probes": {"t": t, **{f"p_{k}": 0.2 * 1000 * 9.81 * 0.3 + 0 * t for k in range(1, 5)}}}
        levels = "tstar,H1_run1,H1_run2,H2_run1,H3_run1,H4_run1\n1,0.4,0.4,0.5,0.5,0.5\n2,,0.6,0.5,0.5,0.5\n7,0.5,0.5,0.5,0.5,0.5\n"
        rows = self.errors("dam-break", levels, **run)
        self.assertAlmostEqual(rows["level H1, mean error over H until t* = 5.5"].error, 0.1)
        self.assertAlmostEqual(rows["level H2, mean error over H until t* = 7"].error, 0.0)
        band = "tstar,p2_low,p2_median,p2_high\n3,0.1,0.2,0.3\n4,0.3,0.4,0.5\n"
        self.assertGreater(t[-1] * rate, 4)
        share = self.errors("dam-break", band, **run)["share of the time that sensor 2 is in the 95 % band"]
        self.assertEqual(share.measured, 0.5)

    def test_martin_moyce(self):
        a = 0.05715
        t = np.linspace(0, 1, 501)
        scaled = t * np.sqrt(2 * 9.81 / a)
        data = "series,quantity,tscaled,value\n" + "".join(
            f"n2_2_table,Z,{T},{1 + T}\nn2_1_fig,Z,{T},9\nn2_2_table,H,{T},0.3\n" for T in (1.0, 1.5, 2.0, 2.5))
        rows = self.errors("martin-moyce", data, more={}, fluid={"region": [{"high": [a, 2 * a]}]},
                           gauges={"t": t, "front": a * (1 + scaled), "column": 0 * t + 2 * a * 0.4})
        self.assertAlmostEqual(rows["front, mean error, no shift"].error, 0.0, places=4)
        self.assertAlmostEqual(rows["height of the column, mean error over the first height"].error, 0.1)

    def test_koshizuka_oka(self):
        t = np.linspace(0, 0.4, 401)
        data = "series,T,Z\n" + "".join(f"experiment_1995,{T},{1 + T}\nmps_1996,{T},9\n" for T in (0.5, 1.0, 2.0, 3.0))
        rows = self.errors("koshizuka-oka", data, gauges={"t": t, "front": 0.146 * (1.1 + t * np.sqrt(2 * 9.81 / 0.146))})
        self.assertAlmostEqual(rows["shift of the clock in T"].measured, 0.1, places=2)
        self.assertAlmostEqual(rows["lead of the front over the measured, T = 1.935, over L"].measured, 0.1, places=6)

    def test_dam_break_box(self):
        t = np.linspace(0, 1.6, 1601)
        run = {"gauges": {"t": t, "H2": 0.1 + 0 * t, "H4": 0.2 + 0 * t},
               "probes": {"t": t, "p_P1": 500 + 0 * t, "p_P2": 500 + 0 * t}, "history": {"lost": [0], "in": [1]}}
        rows = self.errors("dam-break-box", "t,H1,H2,H3,H4\n0,0,0.1,0,0.2\n1,0,0.1341,0,0.2\n", **run)
        self.assertAlmostEqual(rows["level H2 to 1.5 s, mean error over its largest"].error, 0.05)
        self.assertAlmostEqual(rows["level H4 to 1.5 s, mean error over its largest"].error, 0.0)

    def test_sloshing_impact(self):
        t = np.linspace(0, 8, 8001)
        rows = self.errors("sloshing-impact", "t,p_min,p_max\n1,0,200\n2,184,300\n9,9000,9999\n",
                           probes={"t": t, "p_1": 100 + 0 * t})
        row = rows["mean distance from the measured envelope [Pa]"]
        self.assertAlmostEqual(row.measured, 42.0, places=3)
        self.assertAlmostEqual(row.error, 0.05, places=5)

    def test_swaying_tank(self):
        t = np.linspace(0, 10, 1001)
        level = 0.6 - 0.08 * np.exp(-(((t - 1.93) / 0.2) ** 2))
        tank = gauges(("a", [0.0, 0.0]), ("b", [0.1, 0.0]))
        data = "t,eta\n4,0.0142\n3,0.0142\n5,-0.0142\n"
        rows = self.errors("swaying-tank", data, more={"gauge": tank}, gauges={"t": t, "a": level, "b": level})
        self.assertAlmostEqual(rows["level, rms error over the crest, first trough aligned"].error, 0.1, places=3)

    def test_shallow_bore(self):
        t = np.linspace(0, 33, 6601)
        share = (t / 2.9993) % 1
        level = 0.03 + np.where(share < 0.5, 0.05, -0.01)
        tank = gauges(("a", [0.0, 0.0]), ("b", [0.2, 0.0]))
        data = "t_over_T,eta\n8.7,-0.01\n8.95,-0.01\n9,0.05\n9.3,0.05\n9.7,-0.039\n"  # the last is 0.5 of the crest off
        rows = self.errors("shallow-bore", data, more={"gauge": tank}, gauges={"t": t, "a": level, "b": level})
        self.assertAlmostEqual(rows["level, mean error over the crest"].error, 0.5 / 5, delta=0.01)

    def test_ciem_flume(self):
        t = np.linspace(0, 8, 801)
        wave = 0.03 * np.sin(2 * np.pi * t)
        names = ("wg1", "wg2", "wg3")
        data = "t,piston,wg1,wg2,wg3\n" + "".join(f"{x},0,{2 * y},{y},{y}\n" for x, y in zip(t, wave))
        rows = self.errors("ciem-flume", data, more={"gauge": gauges(*((name, [0, 0.0]) for name in names)),
                                                     "motion": [{"amplitude": [0.0262, 0]}]},
                           gauges={"t": t, **{name: 0.31 + wave for name in names}})
        self.assertAlmostEqual(rows["amplitude at wg1 [m]"].error, -0.5, places=4)
        self.assertAlmostEqual(rows["amplitude at wg2 [m]"].error, 0.0, places=4)

    def test_bore_on_column(self):
        t = np.linspace(0, 2, 20001)
        force = np.where(t > 0.5, 20.0, 0.0)
        data = "series,t,value\nu,0,1\nF,0.1,0\nF,0.3,3.31\nF,0.4,23.31\nF,0.5,20\n"
        rows = self.errors("bore-on-column", data, forces={"t": t, "fx_column": force},
                           history={"kinetic_energy": np.ones(60)})
        row = next(row for metric, row in rows.items() if metric.startswith("force, mean error"))
        # Both clocks begin where the force passes 2 N; the run's first force is that, its mean rises through it.
        self.assertAlmostEqual(row.error, ((3.31 - 2.0) + (23.31 - 20.0) + 0.0) / 3 / 33.1, delta=0.005)

    def test_a_run_is_compared_and_drawn(self):
        with tempfile.TemporaryDirectory() as directory:
            root = pathlib.Path(directory)
            words = [BIN / "impinge", ROOT / "input/koshizuka-oka/koshizuka-oka.toml"]
            for setting in (f"output.directory={root}/run", "particles.spacing=0.01825", "time.dt=2.5e-3"):
                words += ["--set", setting]
            subprocess.run(words, check=True, capture_output=True, timeout=300)
            (root / "outlines.csv").write_text("t,x,z\n" + "".join(f"{when},0.1,0.1\n" for when in (0.2, 0.4, 0.6, 0.8)))
            pictures = []
            for data in ([], ["--data", root / "outlines.csv"]):
                pictures.append(root / f"figure{len(data)}.png")
                done = subprocess.run([ROOT / "input/koshizuka-oka/compare.py", root / "run", *data, "--json", "--figure",
                                       pictures[-1]], check=True, capture_output=True, text=True, timeout=300)
                self.assertEqual(json.loads(done.stdout)[0]["status"], "finished")
            with_and_without = [path.read_bytes() for path in pictures]
            self.assertNotEqual(*with_and_without)


if __name__ == "__main__":
    unittest.main(verbosity=1)
