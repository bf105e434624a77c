#!/usr/bin/env python3
"""What the usual scorer of AV16.3 sequence 30 says of tracks that are made from its truth by a rule: av163.json.

    pip install 'numpy<2' motmetrics scipy
    python make_av163.py DIRECTORY OF av16.3-seq30 SCORER.py > av163.json

The rule is that of tests/corpora.rs; only values are kept.
"""

import csv
import json
import pathlib
import subprocess
import sys
import tempfile

directory, scorer = pathlib.Path(sys.argv[1]), sys.argv[2]


def score(*arguments):
    return json.loads(subprocess.run([sys.executable, scorer, *map(str, arguments)], check=True, stdout=subprocess.PIPE).stdout)


def rows_of_picture(camera):
    for row in csv.DictReader(open(directory / f"seq30_cam{camera}_frames.csv")):
        frame = int(row["frame"])
        for person in (1, 2):
            u, v = float(row[f"p{person}_u"]), float(row[f"p{person}_v"])
            if (frame * 3 + person) % 10 == 0:
                continue
            u += (frame * 7 + person * 13) % 41 - 20
            v += (frame * 11 + person * 5) % 41 - 20
            track = person + 2 * (frame // 97 % 2)
            yield f"{frame},{track},{u - 12:.3f},{v - 24:.3f},24,32,1,-1,-1,-1"


def rows_of_world():
    yield "t_sec,track,x_m,y_m,z_m"
    for row in csv.DictReader(open(directory / "seq30_gt3d.csv")):
        tick, person = round(float(row["t_sec"]) * 25), int(row["person"])
        if (tick * 3 + person) % 10 == 0:
            continue
        x = float(row["x_m"]) + ((tick * 7 + person * 13) % 41 - 20) / 40
        y = float(row["y_m"]) + ((tick * 11 + person * 5) % 41 - 20) / 60
        track = person + 2 * (tick // 97 % 2)
        yield f"{row['t_sec']},{track},{x:.6f},{y:.6f},{row['z_m']}"


values = {}
with tempfile.TemporaryDirectory() as temporary:
    file = pathlib.Path(temporary) / "tracks"
    for camera in (1, 2, 3):
        file.write_text("\n".join(rows_of_picture(camera)) + "\n")
        values[f"cam{camera}"] = score("2d", camera, file)
    file.write_text("\n".join(rows_of_world()) + "\n")
    values["world"] = score("3d", file)
print(json.dumps(values, indent=1))
