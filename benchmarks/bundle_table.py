"""The tables of compare_bundle.sh from the results that its runs left: bundle_table.py FOLDER."""
import json
import math
import pathlib
import sys


def load(folder, name):
    """The run of least CPU time of all repetitions; the largest peak."""
    runs = [json.loads(path.read_text()) for path in sorted(folder.glob(name + ".*.json"))]
    if not runs:
        return None
    best = min(runs, key=lambda run: run["cpu_s"])
    best["peak_bytes"] = max(run["peak_bytes"] for run in runs)
    return best


def compare(own, others):
    print(f"{own['arm']}, {own['samples']} samples, {len(own['unknowns'])} unknowns; ratios to the first line")
    print(f"{'solver':14} {'CPU [s]':>9} {'ratio':>7} {'wall [s]':>9} {'steps':>6} {'us a sample, step':>18}"
          f" {'peak [MB]':>10} {'ratio':>7} {'before data':>12} {'data held':>10} {'cost':>14}"
          f" {'estimates':>10} {'st. dev.':>9}")
    for run in [own] + others:
        sd = own["standard_deviation"]
        # Of any unknown, in its standard deviations; and of the standard deviations, relative.
        apart = max(abs(a - b) / s for a, b, s in zip(run["values"], own["values"], sd))
        spread = max((abs(a / b - 1) for a, b in zip(run["standard_deviation"], sd)), default=math.nan)
        print(f"{run['solver']:14} {run['cpu_s']:9.3f} {run['cpu_s'] / own['cpu_s']:7.2f} {run['wall_s']:9.3f}"
              f" {run['iterations']:6d} {1e6 * run['cpu_s'] / run['samples'] / run['iterations']:18.2f}"
              f" {run['peak_bytes'] / 1e6:10.1f} {run['peak_bytes'] / own['peak_bytes']:7.2f}"
              f" {run['program_bytes'] / 1e6:12.1f} {run['held_bytes'] / 1e6:10.1f} {run['cost']:14.4f} {apart:10.1e}"
              f" {spread:9.1e}" + ("" if run["message"] == "converged" else "  NOT CONVERGED: " + run["message"]))
    print("estimates: largest difference to the first line's in standard deviations; st. dev.: of those, relative\n")


def exponent(points):
    """Slope of the least-squares line through the logarithms."""
    x, y = [math.log(a) for a, _ in points], [math.log(b) for _, b in points]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    return sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / sum((a - mean_x) ** 2 for a in x)


def series(runs):
    print(f"closed, {runs[0]['arm']}, {len(runs[0]['unknowns'])} unknowns")
    print(f"{'samples':>8} {'CPU [s]':>9} {'steps':>6} {'us a sample':>12} {'us a sample, step':>18} {'peak [MB]':>10}"
          f" {'bytes a sample':>15} {'of them solving':>16}")
    for run in runs:
        n = run["samples"]
        print(f"{n:8d} {run['cpu_s']:9.3f} {run['iterations']:6d} {1e6 * run['cpu_s'] / n:12.2f}"
              f" {1e6 * run['cpu_s'] / n / run['iterations']:18.2f} {run['peak_bytes'] / 1e6:10.1f}"
              f" {(run['peak_bytes'] - run['program_bytes']) / n:15.0f}"
              f" {(run['peak_bytes'] - run['held_bytes']) / n:16.0f}"
              + ("" if run["message"] == "converged" else "  NOT CONVERGED: " + run["message"]))
    if len(runs) > 1:
        print("exponent of the samples: seconds a step "
              f"{exponent([(run['samples'], run['cpu_s'] / run['iterations']) for run in runs]):.3f}, bytes "
              f"{exponent([(run['samples'], run['peak_bytes'] - run['program_bytes']) for run in runs]):.3f}")


def main():
    folder = pathlib.Path(sys.argv[1])
    compare(load(folder, "2r.closed"), [load(folder, "2r." + name) for name in ("odrpack", "odrpack_tight", "ceres")])
    names = {path.name.split(".closed")[0] for path in folder.glob("6r_*.closed.*.json")}
    sizes = sorted(int(name[3:]) for name in names)
    for size in sizes:
        ceres = load(folder, f"6r_{size}.ceres")
        if ceres:
            compare(load(folder, f"6r_{size}.closed"), [ceres])
    if sizes:
        series([load(folder, f"6r_{size}.closed") for size in sizes])


main()
