"""Measures median times from an image to the moments of 41 dewarped squares with OpenCV on one thread.

Usage: opencv.py FOLDER, where FOLDER holds what `examples/moments_speed.rs` wrote, and its printout
as `feeler.txt`. Prints OpenCV's medians and their ratios to feeler's in the same run.
"""

import pathlib
import re
import sys
import time

import cv2
import numpy

SIDE, ELEMENTS, DARK_LEVEL, FRAMES = 60, 41, 24, 501


def median_us(work):
    for _ in range(20):
        work()
    times = []
    for _ in range(FRAMES):
        start = time.perf_counter()
        work()
        times.append(time.perf_counter() - start)
    return 1e6 * sorted(times)[FRAMES // 2]


def fastest_us(work):
    """Enables or disables Intel's primitives, which slow down `cv2.moments` of small images on some processors."""
    times = []
    for with_ipp in (True, False):
        cv2.ipp.setUseIPP(with_ipp)
        times.append(median_us(work))
    return min(times)


def read_table(folder, shape):
    """Image coordinates of each pixel of the dewarped squares [H, W, 2], px."""
    return numpy.fromfile(folder / "remap.f32", "<f4").reshape(*shape, 2)


def square_corners(shape):
    """Row and column of the first pixel of each element's square."""
    across = shape[1] // SIDE
    return [(e // across * SIDE, e % across * SIDE) for e in range(ELEMENTS)]


def all_moments(image, corners):
    """Moments of each element's square."""
    return [cv2.moments(image[y : y + SIDE, x : x + SIDE]) for y, x in corners]


def natural_pipeline(table):
    """Straightforward OpenCV pipeline from an image to the moments of all elements: remap, blur, threshold, moments."""
    coarse, fine = cv2.convertMaps(table, None, cv2.CV_16SC2)
    corners = square_corners(table.shape)
    flat, smooth, bright = (numpy.empty(table.shape[:2], numpy.uint8) for _ in range(3))

    def work(picture):
        cv2.remap(picture, coarse, fine, cv2.INTER_LINEAR, dst=flat)
        cv2.GaussianBlur(flat, (5, 5), 0, dst=smooth)
        cv2.threshold(smooth, DARK_LEVEL, 255, cv2.THRESH_TOZERO, dst=bright)
        return all_moments(bright, corners)

    return work


def main(folder):
    cv2.setNumThreads(1)
    picture = cv2.imread(str(folder / "picture.pgm"), cv2.IMREAD_GRAYSCALE)
    table = read_table(folder, picture.shape)
    # Fixed-point tables, which OpenCV recommends for speed.
    coarse, fine = cv2.convertMaps(table, None, cv2.CV_16SC2)
    corners = square_corners(picture.shape)
    rows = corners[-1][0] + SIDE
    few_coarse, few_fine = coarse[:rows].copy(), fine[:rows].copy()
    buffer = numpy.empty_like(picture)
    few_buffers = [numpy.empty_like(picture[:rows]) for _ in range(2)]
    natural = natural_pipeline(table)

    def only_squares():
        flat, bright = few_buffers
        cv2.remap(picture, few_coarse, few_fine, cv2.INTER_LINEAR, dst=flat)
        cv2.threshold(flat, DARK_LEVEL, 255, cv2.THRESH_TOZERO, dst=bright)
        return all_moments(bright, corners)

    def only_squares_nearest():
        flat, bright = few_buffers
        cv2.remap(picture, few_coarse, None, cv2.INTER_NEAREST, dst=flat)
        cv2.threshold(flat, DARK_LEVEL, 255, cv2.THRESH_TOZERO, dst=bright)
        return all_moments(bright, corners)

    def no_dewarp():
        cv2.threshold(picture, DARK_LEVEL, 255, cv2.THRESH_TOZERO, dst=buffer)
        return all_moments(buffer, corners)

    feeler = (folder / "feeler.txt").read_text()
    own, squares = (
        float(re.search(rf"^640x480 {what} .*forces +([0-9.]+) us", feeler, re.M)[1])
        for what in ("own", "squares")
    )
    print(f"OpenCV {cv2.__version__}, numpy {numpy.__version__}, one thread")
    print(f"{'feeler, picture to forces':48} own sub-regions {own:8.2f} us, squares {squares:8.2f} us")
    for name, work in [
        ("natural: remap, blur, threshold, 41 moments", lambda: natural(picture)),
        ("best: remap of the squares, threshold, moments", only_squares),
        ("rougher: the same, nearest pixel", only_squares_nearest),
        ("without dewarp: threshold, moments", no_dewarp),
    ]:
        time_us = fastest_us(work)
        print(f"{name:48} {time_us:8.1f} us, {time_us / own:6.1f} and {time_us / squares:6.1f} times as long")


if __name__ == "__main__":
    main(pathlib.Path(sys.argv[1]))
