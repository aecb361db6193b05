"""How a laser moved between two of its level scans, from the scans themselves: point-to-line matching in the plane.

Each point of the new scan is laid where the guess says it was seen from, meets the line through its nearest neighbours of the old scan, and
all together move the guess until they lie on their lines (Gauss-Newton; Censi, An ICP variant using a point-to-line metric, 2008). What
stands out by more than a few centimetres counts little, so people who walk through change nothing.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from estimation.se2 import Pose2
from pluto_bt.maps.kernel import kernel

Array = NDArray[np.float64]

NEAR_M = 0.8  # nearer points are not asked: somebody who stands there would fill half of the scan
STRIDE = 3  # every third beam of the new scan is enough
ROUNDS = 10
SETTLED_M, SETTLED_RAD = 5e-4, 1e-4  # a smaller step is the last
NEIGHBOURS = 10  # beams to each side among which the nearest point is looked for
REACH_M, LEAST_REACH_M, NARROWING = 0.5, 0.1, 0.6  # how far a point may lie from its line: in the first round, at last, from round to round
SOFT_M = 0.03  # a point so far off its line counts half: three times the noise of an LMS200
NOISE_M = 0.015  # of one range: noise and centimetre steps
BASE_M, MOST_BASE = 0.3, 8  # a line is drawn through neighbours so far apart: with nearer ones their noise would turn it
SPURIOUS = 4.0 * 2.0 * (0.01 / BASE_M) ** 2  # what noise in such a line tells of a motion along it, four times over: as much is not believed
JOINED = 0.15  # neighbours whose ranges differ by a larger share lie on different things
PRIOR_M, PRIOR_RAD = 0.3, 0.2  # how far off the guess may be; what the scans cannot see stays as guessed
ASIDE_M = 0.012  # so far aside of where it is reckoned to be a robot on wheels may be between two scans
FITS_M = 0.05  # a point so near its line is explained
APART_M = 0.3  # a beam that ends so much earlier or later than foreseen saw something else
FITS, FITTED_BEFORE, LONGER, SHORTER, LOOKED, VAR_X, VAR_Y, VAR_THETA, COV_XY = range(3, 12)
RESULT_SIZE = 12


class ScanStep(NamedTuple):
    """How the laser moved, seen from where it was, and how well that explains the new scan.

    Attributes:
        fits, fits_as_guessed: share of the points on their lines, after and before the matching. longer, shorter: share of the beams
            that ended at least 0.3 m later or earlier than foreseen. points: so many were compared.
        sigma_x_m, sigma_y_m, sigma_theta_rad: standard deviations in the laser's old frame, large where the scans see nothing across.
        cov_xy_m2: large where they see only one wall, and that obliquely.
    """

    step: Pose2
    fits: float
    fits_as_guessed: float
    longer: float
    shorter: float
    points: int
    sigma_x_m: float
    sigma_y_m: float
    sigma_theta_rad: float
    cov_xy_m2: float = 0.0

    def along(self, bearing_rad: float, dx_m: float, dy_m: float) -> tuple[float, float]:
        """(m, standard deviation in m) of the motion along a bearing that explains a step of (dx, dy), all in the laser's old frame.

        What only a wall says that is seen obliquely is a motion across it; of the robots that stand on its far side the one is meant that has moved
        along the bearing, and aside no more than `ASIDE_M`.
        """
        c, s = math.cos(bearing_rad), math.sin(bearing_rad)
        xx, xy, yy = self.sigma_x_m**2 + ASIDE_M**2 * s * s, self.cov_xy_m2 - ASIDE_M**2 * c * s, self.sigma_y_m**2 + ASIDE_M**2 * c * c
        det = xx * yy - xy * xy
        wx, wy = (c * yy - s * xy) / det, (s * xx - c * xy) / det
        information = wx * c + wy * s
        return (wx * dx_m + wy * dy_m) / information, 1.0 / math.sqrt(information)


def match_scans(before_m: Array, now_m: Array, first_rad: float, step_rad: float, guess: Pose2, max_range_m: float) -> ScanStep:
    """The motion of the laser from one scan to the next.

    Args:
        before_m, now_m: (n,) ranges of the same beams; what is not between 0 and `max_range_m` says nothing, and what is very near neither.
        first_rad, step_rad: direction of the first beam, and between two.
        guess: the new laser pose seen from the old one.
    Raises: ValueError if the scans are not of one shape.
    """
    if before_m.shape != now_m.shape or before_m.ndim != 1:
        raise ValueError(f"scans of shapes {before_m.shape} and {now_m.shape}")
    out = np.zeros(RESULT_SIZE)
    out[:3] = guess
    _match(before_m, now_m, first_rad, step_rad, max_range_m, out)
    x, y, theta, fits, guessed, longer, shorter, looked, vx, vy, vt, cov_xy = out.tolist()
    return ScanStep((x, y, theta), fits, guessed, longer, shorter, int(looked), math.sqrt(vx), math.sqrt(vy), math.sqrt(vt), cov_xy)


@kernel
def _match(before_m: Array, now_m: Array, first_rad: float, step_rad: float, max_range_m: float, out: Array) -> None:
    """Fill `out`: the pose that it holds is the guess, and is moved; behind it come the figures of `ScanStep`."""
    n = before_m.shape[0]
    px, py, now_x, now_y = np.zeros(n), np.zeros(n), np.zeros(n), np.zeros(n)
    for i in range(n):
        c, s = math.cos(first_rad + i * step_rad), math.sin(first_rad + i * step_rad)
        px[i], py[i], now_x[i], now_y[i] = before_m[i] * c, before_m[i] * s, now_m[i] * c, now_m[i] * s
    gx, gy, gt = out[0], out[1], out[2]
    x, y, theta, reach_m = gx, gy, gt, REACH_M
    is_settled = False
    for round_ in range(ROUNDS + 1):
        is_last = is_settled or round_ == ROUNDS
        c, s = math.cos(theta), math.sin(theta)
        axx, ayy, att, axy, axt, ayt = 0.0, 0.0, (NOISE_M / PRIOR_RAD) ** 2, 0.0, 0.0, 0.0
        bx, by, bt = 0.0, 0.0, (NOISE_M / PRIOR_RAD) ** 2 * (gt - theta)
        sure = (NOISE_M / PRIOR_M) ** 2  # of the guess
        looked, fits, longer, shorter = 0, 0, 0, 0
        for i in range(0, n, STRIDE):
            r = now_m[i]
            if not NEAR_M < r < max_range_m:
                continue
            rx, ry = now_x[i], now_y[i]
            dx, dy = c * rx - s * ry, s * rx + c * ry
            qx, qy = x + dx, y + dy
            j0 = int(math.floor((math.atan2(qy, qx) - first_rad) / step_rad + 0.5))  # noqa: RUF046  # a kernel's floor gives a float
            if j0 < 1 or j0 > n - 2:
                continue
            if NEAR_M < before_m[j0] < max_range_m:
                looked += 1
                foreseen_m = math.hypot(qx, qy)
                longer += 1 if before_m[j0] < foreseen_m - APART_M else 0
                shorter += 1 if before_m[j0] > foreseen_m + APART_M else 0
            best, nearest = -1, reach_m * reach_m
            for j in range(max(1, j0 - NEIGHBOURS), min(n - 1, j0 + NEIGHBOURS + 1)):
                if not 0.0 < before_m[j] < max_range_m:
                    continue
                d2 = (qx - px[j]) ** 2 + (qy - py[j]) ** 2
                if d2 < nearest:
                    best, nearest = j, d2
            if best < 0:
                continue
            low, high = best, best
            for _ in range(MOST_BASE):
                if (px[high] - px[low]) ** 2 + (py[high] - py[low]) ** 2 > BASE_M**2:
                    break
                low = low - 1 if low > 0 and abs(before_m[low - 1] - before_m[low]) < JOINED * before_m[low] else low
                high = high + 1 if high < n - 1 and abs(before_m[high + 1] - before_m[high]) < JOINED * before_m[high] else high
            tx, ty = px[high] - px[low], py[high] - py[low]
            length = math.hypot(tx, ty)
            if low == high or not length > 0.0:
                continue
            nx, ny = -ty / length, tx / length
            off_m = nx * (qx - px[best]) + ny * (qy - py[best])
            if abs(off_m) < FITS_M:
                fits += 1
            weight = 1.0 / (1.0 + (off_m / SOFT_M) ** 2)
            sure += weight * SPURIOUS
            jt = -nx * dy + ny * dx
            axx += weight * nx * nx
            ayy += weight * ny * ny
            att += weight * jt * jt
            axy += weight * nx * ny
            axt += weight * nx * jt
            ayt += weight * ny * jt
            bx -= weight * nx * off_m
            by -= weight * ny * off_m
            bt -= weight * jt * off_m
        axx, ayy, bx, by = axx + sure, ayy + sure, bx + sure * (gx - x), by + sure * (gy - y)
        share = 1.0 / max(1, looked)
        if round_ == 0:
            out[FITTED_BEFORE] = fits * share
        # the inverse of the symmetric 3 × 3, by its cofactors
        cxx, cxy, cxt = ayy * att - ayt * ayt, axt * ayt - axy * att, axy * ayt - axt * ayy
        cyy, cyt, ctt = axx * att - axt * axt, axy * axt - axx * ayt, axx * ayy - axy * axy
        det = axx * cxx + axy * cxy + axt * cxt
        if is_last or not det > 0.0:
            out[FITS], out[LONGER], out[SHORTER], out[LOOKED] = fits * share, longer * share, shorter * share, looked
            out[VAR_X], out[VAR_Y], out[VAR_THETA] = NOISE_M**2 * cxx / det, NOISE_M**2 * cyy / det, NOISE_M**2 * ctt / det
            out[COV_XY] = NOISE_M**2 * cxy / det
            break
        step_x, step_y = (cxx * bx + cxy * by + cxt * bt) / det, (cxy * bx + cyy * by + cyt * bt) / det
        step_t = (cxt * bx + cyt * by + ctt * bt) / det
        x, y, theta = x + step_x, y + step_y, theta + step_t
        is_settled = max(abs(step_x), abs(step_y)) < SETTLED_M and abs(step_t) < SETTLED_RAD
        reach_m = max(LEAST_REACH_M, NARROWING * reach_m)
    out[0], out[1], out[2] = x, y, theta
