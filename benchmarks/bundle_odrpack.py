"""The 2R problem of bundle_benchmark by ODRPACK (scipy.odr): explicit model, analytic jacobians, equal weights.

  bundle_odrpack.py PREFIX RESULT.json [--tight]     PREFIX as bundle_benchmark --write made it

--tight iterates to rounding, past ODRPACK's own tolerances, so that the minima can be compared.

Nothing is linearised here: the torque is that of the state plus its deviation. Planar horizontal arm, L = 0.5 m,
c = cos q2, s = sin q2; the payload adds its ZZ, MX, MY to those of link 2 and its known mass to joint 1:
  tau1 = ZZ1 ddq1 + Fv1 dq1 + ZZ2 (ddq1 + ddq2) + M L^2 ddq1
         + L [MX2 ((2 ddq1 + ddq2) c - dq2 (2 dq1 + dq2) s) - MY2 ((2 ddq1 + ddq2) s + dq2 (2 dq1 + dq2) c)]
  tau2 = ZZ2 (ddq1 + ddq2) + Ia2 ddq2 + Fv2 dq2 + L [MX2 (ddq1 c + dq1^2 s) + MY2 (dq1^2 c - ddq1 s)]
"""
import json
import resource
import sys
import time

import numpy as np
import scipy.odr

LENGTH = 0.5


def peak_memory():
    with open("/proc/self/status") as status:
        return next(1024.0 * float(line.split()[1]) for line in status if line.startswith("VmHWM:"))


def cpu_seconds():
    usage = resource.getrusage(resource.RUSAGE_SELF)
    return usage.ru_utime + usage.ru_stime


def main():
    prefix, result = sys.argv[1:3]
    tight = sys.argv[3:] == ["--tight"]
    program = peak_memory()
    with open(prefix + ".json") as file:
        given = json.load(file)
    rows = np.fromfile(prefix + ".bin").reshape(-1, 8)
    names = given["unknowns"]
    assert given["arm"] == "2r" and len(rows) == given["samples"]
    at = {name: k for k, name in enumerate(names)}
    # The base names are those of links with others regrouped into them (ZZ1R); joint and kind say enough here.
    zz1, fv1, zz2, mx2, my2, ia2, fv2 = (
        next(k for k, name in enumerate(names) if name in (key, key + "R"))
        for key in ("ZZ1", "Fv1", "ZZ2", "MX2", "MY2", "Ia2", "Fv2"))
    x = np.ascontiguousarray(rows[:, :6].T)
    y = np.ascontiguousarray(rows[:, 6:].T)
    del rows
    loaded = (2 * np.arange(x.shape[1]) >= x.shape[1]).astype(float)
    mass_inertia = given["payload_mass"] * LENGTH**2
    count = {"iterations": 0}

    def terms(x):
        """cos and sin of q2 and what MX2 and MY2 multiply in tau1 and tau2."""
        _, q2, w1, w2, a1, a2 = x
        c, s = np.cos(q2), np.sin(q2)
        a, b = 2 * a1 + a2, w2 * (2 * w1 + w2)
        return c, s, a, b, LENGTH * (a * c - b * s), -LENGTH * (a * s + b * c), \
            LENGTH * (a1 * c + w1 * w1 * s), LENGTH * (w1 * w1 * c - a1 * s)

    def moments(beta):
        return (beta[zz2] + loaded * beta[at["ZZP"]], beta[mx2] + loaded * beta[at["MXP"]],
                beta[my2] + loaded * beta[at["MYP"]])

    def torque(beta, x):
        _, _, w1, w2, a1, a2 = x
        _, _, _, _, x1, y1, x2, y2 = terms(x)
        zz, mx, my = moments(beta)
        sum_a = zz * (a1 + a2)
        return np.array([(beta[zz1] + loaded * mass_inertia) * a1 + beta[fv1] * w1 + sum_a + mx * x1 + my * y1,
                         sum_a + beta[ia2] * a2 + beta[fv2] * w2 + mx * x2 + my * y2])

    def model(beta, x):
        tau = torque(beta, x)
        tau[0] /= beta[0]
        tau[1] /= beta[1]
        return tau

    def by_parameters(beta, x):
        count["iterations"] += 1
        _, _, w1, w2, a1, a2 = x
        _, _, _, _, x1, y1, x2, y2 = terms(x)
        jacobian = np.zeros((2, 12, x.shape[1]))
        tau = torque(beta, x)
        jacobian[0, 0] = -tau[0] / beta[0]
        jacobian[1, 1] = -tau[1] / beta[1]
        jacobian[0, zz1], jacobian[0, fv1] = a1, w1
        jacobian[1, ia2], jacobian[1, fv2] = a2, w2
        for row, dmx, dmy in ((0, x1, y1), (1, x2, y2)):
            for column, payload, value in ((zz2, "ZZP", a1 + a2), (mx2, "MXP", dmx), (my2, "MYP", dmy)):
                jacobian[row, column] = value
                jacobian[row, at[payload]] = loaded * value
            jacobian[row] /= beta[row]
        return jacobian

    def by_state(beta, x):
        _, _, w1, w2, a1, a2 = x
        c, s, a, b, x1, y1, x2, y2 = terms(x)
        zz, mx, my = moments(beta)
        lx, ly = LENGTH * mx, LENGTH * my
        p, r = lx * c - ly * s, -lx * s - ly * c
        jacobian = np.zeros((2, 6, x.shape[1]))
        # d(x1)/d(q2) = y1 and d(y1)/d(q2) = -x1; the same of x2 and y2.
        jacobian[0, 1] = mx * y1 - my * x1
        jacobian[0, 2] = beta[fv1] + 2 * w2 * r
        jacobian[0, 3] = 2 * (w1 + w2) * r
        jacobian[0, 4] = beta[zz1] + loaded * mass_inertia + zz + 2 * p
        jacobian[0, 5] = zz + p
        jacobian[1, 1] = mx * y2 - my * x2
        jacobian[1, 2] = -2 * w1 * r
        jacobian[1, 3] = beta[fv2]
        jacobian[1, 4] = zz + p
        jacobian[1, 5] = zz + beta[ia2]
        jacobian[0] /= beta[0]
        jacobian[1] /= beta[1]
        return jacobian

    held = peak_memory()
    cpu, wall = cpu_seconds(), time.monotonic()
    data = scipy.odr.Data(x, y, we=1.0 / np.array(given["sigma"])**2,
                          wd=np.linalg.inv(np.array(given["state_covariance"]).reshape(6, 6)))
    tolerances = {"sstol": 1e-15, "partol": 1e-15} if tight else {}
    odr = scipy.odr.ODR(data, scipy.odr.Model(model, fjacb=by_parameters, fjacd=by_state),
                        beta0=np.array(given["start"]), maxit=200, **tolerances)
    odr.set_job(fit_type=0, deriv=3)  # explicit, orthogonal; our derivatives, not checked in every run
    output = odr.run()
    cpu, wall = cpu_seconds() - cpu, time.monotonic() - wall
    with open(result, "w") as file:
        json.dump({"solver": "odrpack, tight" if tight else "odrpack", "arm": "2r", "samples": given["samples"],
                   "cpu_s": cpu, "wall_s": wall, "program_bytes": program, "held_bytes": held,
                   "peak_bytes": peak_memory(), "iterations": count["iterations"], "cost": output.sum_square,
                   "message": "converged" if output.info in (1, 2, 3) else "; ".join(output.stopreason),
                   "unknowns": names, "truth": given["truth"], "values": list(output.beta),
                   "standard_deviation": list(np.sqrt(np.diag(output.cov_beta)))}, file, indent=1)


main()
