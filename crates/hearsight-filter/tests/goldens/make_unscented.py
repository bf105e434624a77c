"""Writes what filterpy's unscented filter makes of a head's contour, for tests/unscented_against_filterpy.rs.

    pip install filterpy==2.0.0 "numpy<2" scipy
    python make_unscented.py

State: place, size and their velocities, moved by Langevin steps as printed (Chen and Rui 2004, equation 12); measured are
signed distances along the normals of the predicted ellipse (equation 13, corrected).
"""

import json
import pathlib

import numpy as np
from filterpy.kalman import MerweScaledSigmaPoints, UnscentedKalmanFilter

LINES = 12
TAU = 0.064  # whole nanoseconds, as the clock counts
ASPECT = 1.2


def distance(state, x, y, angle):
    b = np.array([state[2] / ASPECT, state[2]])
    offset = np.array([x - state[0], y - state[1]]) / b
    direction = np.array([np.cos(angle), np.sin(angle)]) / b
    a, h, c = direction @ direction, offset @ direction, offset @ offset - 1
    root = np.sqrt(max(h * h - a * c, 0))
    near, far = (-h - root) / a, (-h + root) / a
    return near if abs(near) < abs(far) else far


def run(alpha, beta, kappa):
    keep = np.exp(-10 * TAU)
    step = np.eye(6)
    step[:3, 3:] = TAU * np.eye(3)
    step[3:, 3:] = keep * np.eye(3)
    rms = np.array([100, 100, 10])
    noise = np.diag(np.concatenate([[0.5] * 3, (rms * np.sqrt(1 - keep**2)) ** 2]))
    points = MerweScaledSigmaPoints(6, alpha, beta, kappa)
    lines = []
    ukf = UnscentedKalmanFilter(
        dim_x=6,
        dim_z=LINES,
        dt=TAU,
        fx=lambda state, dt: step @ state,
        hx=lambda state: np.array([distance(state, *line) for line in lines]),
        points=points,
    )
    ukf.x = np.array([100.0, 80, 20, 5, -3, 0.5])
    ukf.P = np.diag([9.0, 9, 4, 100, 100, 9])
    ukf.Q = noise
    ukf.R = np.diag(0.5 + 0.25 * np.arange(LINES))
    out = []
    for frame in range(4):
        ukf.predict()
        x, y, size = ukf.x[:3]
        lines.clear()
        for k in range(LINES):
            angle = 2 * np.pi * k / LINES
            px, py = x + size / ASPECT * np.cos(angle), y + size * np.sin(angle)
            normal = np.arctan2(np.sin(angle) / size, np.cos(angle) / (size / ASPECT))
            lines.append((px, py, normal))
        truth = np.array([101.0 + 2 * frame, 79.5 - frame, 20.5 + 0.2 * frame])
        measured = np.array([distance(truth, *line) for line in lines]) + 0.3 * np.sin(np.arange(LINES) + frame)
        prior = (ukf.x.tolist(), ukf.P.tolist())
        copied = [list(line) for line in lines]
        # The points of the prior with its noise, as Wan and van der Merwe's table 7.3.2 has them for additive noise.
        ukf.sigmas_f = points.sigma_points(ukf.x, ukf.P)
        ukf.update(measured)
        out.append(
            {
                "lines": copied,
                "measured": measured.tolist(),
                "prior_mean": prior[0],
                "prior_covariance": prior[1],
                "mean": ukf.x.tolist(),
                "covariance": ukf.P.tolist(),
            }
        )
    return {"alpha": alpha, "beta": beta, "kappa": kappa, "frames": out}


runs = [run(1.0, 2.0, 0.0), run(1e-3, 2.0, 0.0), run(0.5, 2.0, -3.0)]
path = pathlib.Path(__file__).with_name("unscented.json")
path.write_text(json.dumps(runs, separators=(",", ":")) + "\n")
