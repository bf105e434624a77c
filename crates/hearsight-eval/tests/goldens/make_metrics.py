#!/usr/bin/env python3
"""What the reference implementations say of random sequences and of MOTChallenge's usual example: metrics.json.

    pip install numpy==2.4.6 scipy==1.17.1 motmetrics==1.4.0 trackeval==1.3.0 pyannote-metrics==4.2.0 stonesoup==1.9.1
    python make_metrics.py [DIRECTORY OF mot-tud] > metrics.json

Only values are kept of mot-tud, not its rows. Without the directory its values are left out.
"""

import datetime
import json
import math
import pathlib
import sys
import warnings

import motmetrics as mm
import numpy as np
from pyannote.core import Annotation, Segment, Timeline
from pyannote.metrics.diarization import DiarizationErrorRate, JaccardErrorRate
from scipy.optimize import brentq
from stonesoup.metricgenerator.ospametric import GOSPAMetric, OSPAMetric
from stonesoup.types.state import State
from trackeval.metrics import CLEAR, HOTA, Identity

warnings.filterwarnings("ignore")
random = np.random.default_rng(16)
CLEAR_NAMES = ["mota", "motp", "recall", "precision", "num_misses", "num_false_positives", "num_switches",
               "num_fragmentations", "mostly_tracked", "partially_tracked", "mostly_lost", "num_unique_objects",
               "num_objects", "num_predictions", "num_frames", "idf1", "idp", "idr", "idtp", "idfp", "idfn"]
HOTA_NAMES = ["HOTA", "DetA", "AssA", "LocA", "DetRe", "DetPr", "AssRe", "AssPr", "HOTA(0)", "LocA(0)"]


def finite(value):
    """The value, or none where there was nothing to divide by."""
    return float(value) if math.isfinite(value) else None


def walk(people, frames, kind, noise, lost, false):
    """Frames of [id, place...] on both sides: people who cross, come and go; tracks that miss, jump and swap."""
    size = 2 if kind != "metres" else 3
    place, speed = random.uniform(0, 60, (people, size)), random.normal(0, 2.5, (people, size))
    track, next_track = list(range(people)), people
    sides = []
    for _ in range(frames):
        place += speed
        speed = np.where((place < 0) | (place > 60), -speed, speed) + random.normal(0, 0.4, speed.shape)
        truth, result = [], []
        for person in range(people):
            if random.random() < 0.12:
                continue
            scale = {"boxes": 1.0, "pixels": 2.0, "metres": 0.05}[kind]
            seen = place[person] * scale
            shape = [18.0 + person, 24.0] if kind == "boxes" else []
            truth.append([person, *np.round([*seen, *shape], 3).tolist()])
            if random.random() < 0.03:
                track[person], next_track = next_track, next_track + 1
            elif random.random() < 0.03:
                other = random.integers(people)
                track[person], track[other] = track[other], track[person]
            if random.random() > lost:
                found = seen + random.normal(0, noise, size) * scale
                shape = list(np.array(shape) * random.uniform(0.9, 1.2, len(shape)))
                result.append([track[person], *np.round([*found, *shape], 3).tolist()])
        for _ in range(random.poisson(false)):
            ghost = random.uniform(0, 60, size) * scale
            shape = [20.0, 25.0] if kind == "boxes" else []
            result.append([next_track, *np.round([*ghost, *shape], 3).tolist()])
            next_track += int(random.random() < 0.5)
        random.shuffle(truth)
        random.shuffle(result)
        # A swap within a frame can give one track to two people.
        seen = set()
        result = [row for row in result if not (row[0] in seen or seen.add(row[0]))]
        sides.append([truth, result])
    return sides


def raw(truth, result, kind):
    """Overlaps of boxes or distances of points, people x tracks."""
    if not truth or not result:
        return np.zeros((len(truth), len(result)))
    one, other = np.array(truth)[:, 1:], np.array(result)[:, 1:]
    if kind == "boxes":
        return mm.distances.boxiou(one[:, None], other[None])
    return np.linalg.norm(one[:, None] - other[None], axis=2)


def accumulate(frames, kind, gate):
    accumulator = mm.MOTAccumulator(auto_id=True)
    for truth, result in frames:
        distance = raw(truth, result, kind)
        distance = 1 - distance if kind == "boxes" else distance
        distance = np.where(distance > gate, np.nan, distance)
        accumulator.update([row[0] for row in truth], [row[0] for row in result], distance)
    return accumulator


def data(frames, kind, gate):
    """The frames as TrackEval's metrics want them."""
    dense = [{}, {}]
    ids = [[], []]
    for frame in frames:
        for side in (0, 1):
            ids[side].append(np.array([dense[side].setdefault(row[0], len(dense[side])) for row in frame[side]], int))
    def similarity(frame):
        values = raw(*frame, kind)
        return values if kind == "boxes" else np.maximum(0, 1 - values / (2 * gate))
    return {"num_timesteps": len(frames), "gt_ids": ids[0], "tracker_ids": ids[1],
            "num_gt_ids": len(dense[0]), "num_tracker_ids": len(dense[1]),
            "num_gt_dets": sum(map(len, ids[0])), "num_tracker_dets": sum(map(len, ids[1])),
            "similarity_scores": [similarity(frame) for frame in frames]}


def hota_values(result):
    return {name: float(np.mean(result[name])) for name in HOTA_NAMES}


def sets(frames, cutoff):
    """OSPA at order 1 and, by squared distances, at order 2; GOSPA at order 2; of points, frame by frame."""
    now = datetime.datetime(2026, 1, 1)
    ospa = OSPAMetric(c=cutoff, p=1)
    squared = OSPAMetric(c=cutoff**2, p=1, measure=lambda a, b: float(np.sum((a.state_vector - b.state_vector) ** 2)))
    gospa = GOSPAMetric(c=cutoff, p=2)
    values = []
    for truth, result in frames:
        if not truth and not result:
            values.append(None)
            continue
        states = [[State(np.array(row[1:]), timestamp=now) for row in side] for side in (truth, result)]
        parts = gospa.compute_gospa_metric(states[1], states[0])[0].value
        values.append([float(ospa.compute_OSPA_distance(states[1], states[0]).value),
                       math.sqrt(squared.compute_OSPA_distance(states[1], states[0]).value),
                       *(float(parts[name]) for name in ("distance", "localisation", "missed", "false"))])
    return values


def sequences():
    cases = [
        ("boxes", walk(6, 40, "boxes", 3.0, 0.1, 0.4), 0.5),
        ("boxes", walk(4, 30, "boxes", 6.0, 0.2, 0.8), 0.7),
        ("boxes", walk(9, 15, "boxes", 2.0, 0.05, 0.2), 0.5),
        ("pixels", walk(5, 40, "pixels", 4.0, 0.1, 0.5), 15.0),
        ("metres", walk(5, 40, "metres", 3.0, 0.1, 0.5), 0.5),
        ("boxes", [[truth, []] for truth, _ in walk(3, 5, "boxes", 1.0, 0.0, 0.0)], 0.5),
        ("boxes", [[[], result] for _, result in walk(3, 5, "boxes", 1.0, 0.0, 0.0)], 0.5),
        ("metres", walk(2, 1, "metres", 1.0, 0.0, 1.0), 0.5),
        ("metres", [[[], []], [[[0, 1.0, 1.0, 1.0]], [[0, 1.1, 1.0, 1.0]]], [[], []]], 0.5),
    ]
    host = mm.metrics.create()
    for kind, frames, gate in cases:
        accumulator = accumulate(frames, kind, gate)
        clear = host.compute(accumulator, metrics=CLEAR_NAMES, return_dataframe=False)
        case = {"kind": kind, "gate": gate, "frames": frames,
                "motmetrics": {name: finite(value) for name, value in clear.items()},
                "trackeval": hota_values(HOTA().eval_sequence(data(frames, kind, gate)))}
        if kind != "boxes":
            case["sets"] = sets(frames, gate)
        yield case


def overall(cases):
    """All sequences of boxes with the same gate together."""
    cases = [case for case in cases if case["kind"] == "boxes" and case["gate"] == 0.5]
    return together([(case["frames"], "boxes", 0.5) for case in cases])


def together(cases):
    host = mm.metrics.create()
    accumulators = [accumulate(*case) for case in cases]
    # motmetrics multiplies by the motp of an empty sequence, which is no number.
    useful = [a for a, case in zip(accumulators, cases) if all(any(frame[side] for frame in case[0]) for side in (0, 1))]
    clear = host.compute_many(useful, metrics=CLEAR_NAMES, names=[str(n) for n in range(len(useful))], generate_overall=True)
    hota = HOTA()
    each = {str(n): hota.eval_sequence(data(*case)) for n, case in enumerate(cases) if accumulators[n] in useful}
    return {"motmetrics": {name: finite(clear.loc["OVERALL"][name]) for name in CLEAR_NAMES},
            "trackeval": hota_values(hota.combine_sequences(each))}


def read(file):
    frames = {}
    for line in file.read_text().split():
        row = [float(value) for value in line.split(",")]
        frames.setdefault(int(row[0]), []).append(row[1:6])
    return frames


def mot_tud(directory):
    cases, values = [], {}
    for name in ("TUD-Campus", "TUD-Stadtmitte"):
        truth, result = (read(directory / name / file) for file in ("gt.txt", "test.txt"))
        frames = [[truth.get(n, []), result.get(n, [])] for n in sorted(truth.keys() | result.keys())]
        cases.append((frames, "boxes", 0.5))
        clear = mm.metrics.create().compute(accumulate(*cases[-1]), metrics=CLEAR_NAMES, return_dataframe=False)
        both = data(*cases[-1])
        other = CLEAR({"PRINT_CONFIG": False}).eval_sequence(both) | Identity({"PRINT_CONFIG": False}).eval_sequence(both)
        values[name] = {"motmetrics": {key: finite(value) for key, value in clear.items()},
                        "trackeval": hota_values(HOTA().eval_sequence(both)),
                        "trackeval_clear": {key: float(other[key]) for key in ("MOTA", "MOTP", "IDSW", "IDF1", "IDTP")}}
    values["overall"] = together(cases)
    return values


def speech():
    """Turns of both sides, and the rates with collars and overlap."""
    options = [(0.0, False), (0.5, False), (0.0, True), (0.25, True)]
    totals = {option: (DiarizationErrorRate(*option), JaccardErrorRate(*option)) for option in options}
    cases = []
    for number in range(6):
        truth, result = [], []
        for speaker in range(random.integers(1, 5)):
            time = random.uniform(0, 3)
            while time < 40:
                length = random.exponential(3) + 0.1
                truth.append([round(time, 3), round(time + length, 3), speaker])
                if random.random() > 0.1:
                    shift = random.normal(0, 0.3, 2)
                    who = speaker if random.random() > 0.2 else int(random.integers(6))
                    start, end = round(time + shift[0], 3), round(time + length + shift[1], 3)
                    if end > start:
                        result.append([start, end, who])
                time += length + random.exponential(4)
        result = [] if number == 4 else result
        truth = [] if number == 5 else truth
        span = [1.5, 38.25] if number % 2 else None
        case = {"truth": truth, "result": result, "span": span, "scores": []}
        sides = []
        for side in (truth, result):
            annotation = Annotation()
            for index, (start, end, speaker) in enumerate(side):
                annotation[Segment(start, end), index] = speaker
            sides.append(annotation)
        uem = Timeline([Segment(*span)]) if span else None
        for collar, skip in options:
            der, jer = totals[collar, skip]
            parts = der(*sides, uem=uem, detailed=True)
            jaccard = jer(*sides, uem=uem, detailed=True)
            speakers = float(jaccard["speaker count"])
            case["scores"].append({"collar": collar, "skip": skip, "parts": {k: float(v) for k, v in parts.items()},
                                   "speakers": speakers, "jer": float(jaccard["jaccard error rate"]) if speakers else None})
        cases.append(case)
    return {"cases": cases, "overall": [[abs(der), abs(jer)] for der, jer in totals.values()]}


def equal_errors():
    for speaking, silent, digits in ((200, 300, 6), (40, 500, 2), (7, 5, 1)):
        one, other = random.beta(4, 2, speaking).round(digits), random.beta(2, 4, silent).round(digits)
        thresholds = np.unique(np.concatenate([one, other]))[::-1]
        false = np.array([0.0, *[(other >= t).mean() for t in thresholds]])
        true = np.array([0.0, *[(one >= t).mean() for t in thresholds]])
        # Along the curve, whose points are those of scikit-learn's roc_curve without dropping any.
        points = np.arange(len(false))
        place = brentq(lambda s: np.interp(s, points, false) + np.interp(s, points, true) - 1, 0, points[-1], xtol=1e-13)
        rate = np.interp(place, points, false)
        yield {"speaking": one.tolist(), "silent": other.tolist(), "rate": float(rate)}


def main():
    cases = list(sequences())
    values = {"sequences": cases, "overall": overall(cases), "speech": speech(), "equal_errors": list(equal_errors())}
    if len(sys.argv) > 1:
        values["mot_tud"] = mot_tud(pathlib.Path(sys.argv[1]))
    print(json.dumps(values, separators=(",", ":")))


main()
