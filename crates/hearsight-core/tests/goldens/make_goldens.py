"""Writes the projections and undistortions of OpenCV that tests/opencv_goldens.rs compares with.

    pip install opencv-python-headless==4.10.0.84 "numpy<2"
    python make_goldens.py

Undistorted pixels are in the same camera matrix (P = K), iterated to convergence rather than OpenCV's default of five
steps. Every point lies where the distortion is one to one, so that there is one right answer.
"""

import json
import pathlib

import cv2
import numpy as np

POINTS = 50
# OpenCV marks a fisheye pixel as failed unless a step falls below the bound, so it must stay above rounding.
CRITERIA = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 10_000, 1e-14)

# (name, width, height, fx, fy, cx, cy, [k1, k2, p1, p2, k3], half angle of the view cone in degrees)
PINHOLE = [
    ("ideal", 640, 480, 600.0, 600.0, 319.5, 239.5, [0, 0, 0, 0, 0], 35),
    ("barrel", 360, 288, 387.025, 424.735, 178.184, 141.870, [-0.29314, 0, 0.00518, -0.00463, 0], 30),
    ("pincushion", 1280, 720, 900.0, 905.0, 650.0, 350.0, [0.21, -0.09, -0.0012, 0.0009, 0.03], 38),
    ("strong", 1920, 1080, 1010.0, 1012.0, 961.0, 534.0, [-0.35, 0.16, 0.0004, -0.0007, -0.037], 40),
]
# (name, width, height, fx, fy, cx, cy, [k1, k2, k3, k4], half angle)
FISHEYE = [
    ("equidistant", 640, 480, 280.0, 281.0, 320.0, 240.0, [0, 0, 0, 0], 70),
    ("mild", 640, 480, 285.1, 284.8, 317.3, 242.9, [-0.0109, 0.0317, -0.0263, 0.0076], 75),
    ("strong", 1280, 960, 420.0, 421.5, 633.0, 487.0, [0.082, -0.041, 0.012, -0.0015], 75),
]


def directions(generator, half_angle):
    """Random points in a cone around the optical axis, 0.5 to 6 m away: POINTS x 3."""
    angle = np.radians(half_angle) * np.sqrt(generator.random(POINTS))
    around = 2 * np.pi * generator.random(POINTS)
    distance = 0.5 + 5.5 * generator.random(POINTS)
    unit = np.stack([np.sin(angle) * np.cos(around), np.sin(angle) * np.sin(around), np.cos(angle)], 1)
    return unit * distance[:, None]


def case(generator, model, row):
    """One camera: a random pose, points, their pixels, and the undistorted pixels of those."""
    name, width, height, fx, fy, cx, cy, distortion, half_angle = row
    matrix = np.array([[fx, 0, cx], [0, fy, cy], [0, 0, 1.0]])
    coefficients = np.array(distortion, float)
    rotation_vector = generator.normal(size=3)
    translation = generator.normal(size=3)
    rotation, _ = cv2.Rodrigues(rotation_vector)
    world = (directions(generator, half_angle) - translation) @ rotation
    shaped = world.reshape(-1, 1, 3)
    if model == "pinhole":
        pixels, jacobian = cv2.projectPoints(shaped, rotation_vector, translation, matrix, coefficients)
        undistorted = cv2.undistortPointsIter(pixels, matrix, coefficients, np.eye(3), matrix, CRITERIA)
    else:
        pixels, jacobian = cv2.fisheye.projectPoints(shaped, rotation_vector, translation, matrix, coefficients)
        undistorted = cv2.fisheye.undistortPoints(
            pixels, matrix, coefficients, np.eye(3), matrix, criteria=CRITERIA
        )
    # d pixel / d translation is d pixel / d camera point: columns 3..5 (pinhole) or 11..13 (fisheye).
    first = 3 if model == "pinhole" else 11
    return {
        "name": name,
        "model": model,
        "width": width,
        "height": height,
        "focal_px": [fx, fy],
        "centre_px": [cx, cy],
        "distortion": distortion,
        "rotation_vector": rotation_vector.tolist(),
        "translation_m": translation.tolist(),
        "world_m": world.tolist(),
        "pixels": pixels.reshape(-1, 2).tolist(),
        "undistorted": undistorted.reshape(-1, 2).tolist(),
        "jacobians": jacobian[: 2 * 10, first : first + 3].reshape(10, 6).tolist(),
    }


def main():
    assert cv2.__version__ == "4.10.0", cv2.__version__
    generator = np.random.default_rng(20240229)
    cases = [case(generator, "pinhole", row) for row in PINHOLE]
    cases += [case(generator, "fisheye", row) for row in FISHEYE]
    folder = pathlib.Path(__file__).parent
    (folder / "cameras.json").write_text(
        "[\n" + ",\n".join(json.dumps(one, separators=(",", ":")) for one in cases) + "\n]\n"
    )
    write_storage(folder)


def write_storage(folder):
    """The same small calibration in both of OpenCV's file formats, as cv::FileStorage writes them."""
    for extension in ("yaml", "json"):
        storage = cv2.FileStorage(str(folder / f"opencv_storage.{extension}"), cv2.FILE_STORAGE_WRITE)
        storage.write("calibration_time", "Thu 29 Feb 2024 12:00:00")
        storage.write("image_width", 640)
        storage.write("image_height", 480)
        storage.write("camera_matrix", np.array([[612.5, 0, 318.25], [0, 613.75, 241.5], [0, 0, 1.0]]))
        storage.write("distortion_coefficients", np.array([[-0.31, 0.12, 0.0011, -0.0022, -0.017]]).T)
        storage.write("R", cv2.Rodrigues(np.array([0.3, -1.2, 0.4]))[0])
        storage.write("T", np.array([[0.25], [-0.5], [2.0]]))
        storage.write("avg_reprojection_error", 0.21)
        storage.release()


if __name__ == "__main__":
    main()
