"""Writes the boxes that OpenCV's cascades find in frames of AV16.3, for tests/vision/cascades.rs. No pixels are kept.

    apt install ffmpeg opencv-data
    pip install opencv-python-headless==4.10.0.84 "numpy<2"
    python make_cascades.py FOLDER-OF-AV16.3-SEQUENCE-30

Every frame comes with a checksum: another decoder may give other pixels, and then other boxes.
"""

import json
import pathlib
import subprocess
import sys

import cv2
import numpy as np

WIDTH, HEIGHT = 360, 288
EVERY, FRAMES = 80, 6
SMALLEST = (20, 20)
STEP = 1.1
CASCADES = pathlib.Path("/usr/share/opencv4/haarcascades")
NAMES = [
    "frontalface_alt2",
    "frontalface_default",
    "profileface",
    "upperbody",
    "licence_plate_rus_16stages",
]
# Accepted windows of these scales (powers of the step) are kept with the sum of their last stage.
SCORED = [0, 3, 6, 9, 12, 16]


def checksum(data):
    """FNV-1a, 64 bits."""
    value = 0xCBF2_9CE4_8422_2325
    for byte in data:
        value = ((value ^ byte) * 0x100_0000_01B3) & 0xFFFF_FFFF_FFFF_FFFF
    return f"{value:016x}"


def frames(file):
    command = ["ffmpeg", "-v", "error", "-i", file, "-vf", f"select=not(mod(n\\,{EVERY}))", "-vsync", "0"]
    command += ["-frames:v", str(FRAMES), "-pix_fmt", "gray", "-f", "rawvideo", "-"]
    data = subprocess.run(command, check=True, capture_output=True).stdout
    return np.frombuffer(data, np.uint8).reshape(-1, HEIGHT, WIDTH)


def scores(cascade, frame):
    """Accepted windows of one scale each, with the sum of the last stage."""
    width, height = cascade.getOriginalWindowSize()
    out = []
    for power in SCORED:
        scale = 1.0
        for _ in range(power):
            scale *= STEP
        size = (round(width * scale), round(height * scale))
        if size[0] > WIDTH or size[1] > HEIGHT or size[0] < SMALLEST[0] or size[1] < SMALLEST[1]:
            continue
        boxes, _, sums = cascade.detectMultiScale3(frame, STEP, 0, 0, size, size, True)
        out += [[*map(int, box), float(total)] for box, total in zip(boxes, np.ravel(sums))]
    return sorted(out)


def main():
    cv2.setNumThreads(1)
    cascades = {name: cv2.CascadeClassifier(str(CASCADES / f"haarcascade_{name}.xml")) for name in NAMES}
    goldens = []
    for camera in (1, 2, 3):
        file = pathlib.Path(sys.argv[1]) / f"seq30-2p-1101_cam{camera}_divx_audio.avi"
        for number, frame in enumerate(frames(file)):
            found = {}
            for name, cascade in cascades.items():
                for key, picture in ((name, frame), (f"{name} mirrored", frame[:, ::-1].copy())):
                    if key.endswith("mirrored") and name != "profileface":
                        continue
                    windows = cascade.detectMultiScale(picture, STEP, 0, minSize=SMALLEST)
                    groups, counts = cascade.detectMultiScale2(picture, STEP, 3, minSize=SMALLEST)
                    groups = [[*map(int, box), int(n)] for box, n in zip(groups, np.ravel(counts))]
                    found[key] = {
                        "windows": sorted([*map(int, box)] for box in windows),
                        "groups": sorted(groups),
                        "scores": scores(cascade, picture),
                    }
            goldens.append(
                {"file": file.name, "frame": number, "checksum": checksum(frame.tobytes()), "found": found}
            )
    path = pathlib.Path(__file__).with_name("cascades.json")
    lines = ",\n".join(json.dumps(golden, separators=(",", ":")) for golden in goldens)
    path.write_text(f"[\n{lines}\n]\n")


main()
