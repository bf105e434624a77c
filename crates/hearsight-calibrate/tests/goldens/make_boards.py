#!/usr/bin/env python3
"""Renders pictures of a chessboard and of a ChArUco board with AprilTags, and calibrates the camera with OpenCV.

    python3 -m venv .venv && .venv/bin/pip install numpy==1.26.4 opencv-contrib-python-headless==4.10.0.84
    .venv/bin/python make_boards.py

Writes `chessboard/*.png`, `charuco/*.png`, and `boards.json`: for each board the camera that rendered it, the corners that
OpenCV found, and what its calibrateCamera made of them (k3 held at 0). Each pixel is the mean of 5 x 5 rays through the
distorted lens, then blurred a little, as lenses do. There is no
noise: pictures without are a tenth as large.
"""

import json
import pathlib

import cv2
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
WIDTH, HEIGHT = 480, 360
FOCAL, CENTRE = np.array([430.0, 428.0]), np.array([243.5, 176.0])
DISTORTION = np.array([-0.22, 0.07, 0.0012, -0.0008])
COLUMNS, ROWS, SQUARE = 9, 7, 0.03  # squares; metres
MARKER = 0.022
SUB = 5


def poses():
    """The board's middle at half a metre, turned about, towards all corners of the picture."""
    views = []
    for turn_x, turn_y, turn_z, x, y, z in [
        (0.35, 0.05, 0.0, -0.02, 0.00, 0.36), (-0.40, 0.10, 0.1, 0.03, -0.02, 0.40), (0.10, 0.45, -0.1, -0.04, 0.02, 0.38),
        (0.05, -0.45, 0.2, 0.04, 0.02, 0.38), (0.30, 0.30, -0.2, -0.05, -0.03, 0.44), (-0.30, -0.30, 0.15, 0.05, 0.03, 0.44),
        (0.45, -0.20, 0.05, 0.03, -0.04, 0.46), (-0.20, 0.40, -0.05, -0.04, 0.04, 0.46), (0.0, 0.0, 0.3, 0.0, 0.0, 0.42),
    ]:
        rotation = cv2.Rodrigues(np.array([turn_x, 0, 0]))[0] @ cv2.Rodrigues(np.array([0.0, turn_y, 0]))[0]
        rotation = rotation @ cv2.Rodrigues(np.array([0.0, 0, turn_z]))[0]
        middle = np.array([COLUMNS * SQUARE / 2, ROWS * SQUARE / 2, 0.0])
        views.append((rotation, np.array([x, y, z]) - rotation @ middle))
    return views


def texture(kind):
    """An image of the board, 100 pixels a square, with a white margin of one square."""
    if kind == "chessboard":
        board = np.zeros((ROWS * 100, COLUMNS * 100), np.uint8)
        for row in range(ROWS):
            for column in range(COLUMNS):
                board[row * 100:row * 100 + 100, column * 100:column * 100 + 100] = 255 * ((row + column) % 2)
    else:
        board = charuco().generateImage((COLUMNS * 100, ROWS * 100), marginSize=0)
    return cv2.copyMakeBorder(board, 100, 100, 100, 100, cv2.BORDER_CONSTANT, value=255)


def charuco():
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_APRILTAG_36h11)
    return cv2.aruco.CharucoBoard((COLUMNS, ROWS), SQUARE, MARKER, dictionary)


def render(image, rotation, translation):
    camera = np.array([[FOCAL[0], 0, CENTRE[0]], [0, FOCAL[1], CENTRE[1]], [0, 0, 1]])
    steps = (np.arange(SUB) + 0.5) / SUB - 0.5
    u = (np.arange(WIDTH)[:, None] + steps).ravel()
    v = (np.arange(HEIGHT)[:, None] + steps).ravel()
    pixels = np.stack(np.meshgrid(u, v), -1).reshape(-1, 1, 2)
    criteria = (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 40, 1e-9)
    ideal = cv2.undistortPointsIter(pixels, camera, DISTORTION, None, None, criteria).reshape(-1, 2)
    rays = np.column_stack([ideal, np.ones(len(ideal))]) @ rotation
    origin = -rotation.T @ translation
    distance = -origin[2] / rays[:, 2]
    place = origin[:2] + rays[:, :2] * distance[:, None]
    # Pixel (0, 0) of the texture is centred half a pixel in.
    at = (place / SQUARE * 100 + 100 - 0.5).astype(np.float32)
    shape = (HEIGHT * SUB, WIDTH * SUB)
    seen = cv2.remap(image, at[:, 0].reshape(shape), at[:, 1].reshape(shape), cv2.INTER_LINEAR, borderValue=90)
    grey = seen.reshape(HEIGHT, SUB, WIDTH, SUB).mean(axis=(1, 3)) * 0.75 + 30
    grey = cv2.GaussianBlur(grey, (0, 0), 0.6)
    return np.clip(np.round(grey), 0, 255).astype(np.uint8)


def corners_of(kind, picture):
    if kind == "chessboard":
        size = (COLUMNS - 1, ROWS - 1)
        found, corners = cv2.findChessboardCorners(picture, size)
        assert found
        corners = cv2.cornerSubPix(picture, corners, (5, 5), (-1, -1), (3, 100, 1e-5)).reshape(-1, 2)
        grid = np.array([[x, y, 0] for y in range(size[1]) for x in range(size[0])], np.float32) * SQUARE
        return grid, corners
    board = charuco()
    corners, ids, _, _ = cv2.aruco.CharucoDetector(board).detectBoard(picture)
    grid, corners = board.matchImagePoints(corners, ids)
    return grid.reshape(-1, 3), corners.reshape(-1, 2)


def main():
    result = {"size": [WIDTH, HEIGHT], "columns": COLUMNS, "rows": ROWS, "square_m": SQUARE, "marker_m": MARKER}
    result["truth"] = {"focal_px": FOCAL.tolist(), "centre_px": CENTRE.tolist(), "distortion": DISTORTION.tolist()}
    for kind in ("chessboard", "charuco"):
        folder = HERE / kind
        folder.mkdir(exist_ok=True)
        image, grids, points = texture(kind), [], []
        for number, (rotation, translation) in enumerate(poses()):
            picture = render(image, rotation, translation)
            cv2.imwrite(str(folder / f"{number:02}.png"), picture, [cv2.IMWRITE_PNG_COMPRESSION, 9])
            grid, corners = corners_of(kind, picture)
            grids.append(grid.astype(np.float32))
            points.append(corners.astype(np.float32))
        error, camera, distortion, turns, shifts = cv2.calibrateCamera(
            grids, points, (WIDTH, HEIGHT), None, None, flags=cv2.CALIB_FIX_K3)
        result[kind] = {
            "rms_px": error,
            "focal_px": [camera[0, 0], camera[1, 1]],
            "centre_px": [camera[0, 2], camera[1, 2]],
            "distortion": distortion.ravel()[:4].tolist(),
            "turns": [turn.ravel().tolist() for turn in turns],
            "shifts": [shift.ravel().tolist() for shift in shifts],
            "grids": [[[round(float(x), 6) for x in place[:2]] for place in grid] for grid in grids],
            "corners": [[[round(float(x), 4) for x in corner] for corner in corners] for corners in points],
        }
        print(kind, len(points), "views", sum(map(len, points)), "corners", error, camera[0, 0], camera[1, 1], distortion.ravel())
    (HERE / "boards.json").write_text(json.dumps(result) + "\n")


main()
