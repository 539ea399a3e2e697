#!/usr/bin/env python3
"""Compares physical models of a magnetometer skin with ridge regressions of its readings.

    python3 docs/figures/magnet_models.py [normal] [shear] [place]

Reads the folder `eflesh-force` in FEELER_DATA (default ../shared/data): readings of five (shear: ten) three-axis
magnetometers, µT, and of a scale. Prints a row for each split, without and with memory, and family of models: the
cross-validated error of the training part, the error of the held-out part (RMSE in N; of places the mean absolute error
of x and y in mm), and the chosen model. Deterministic. Needs numpy; takes six minutes on one core. Families:

  ridge    readings or their direction and length, and products, as `feeler calibrate --wrench --taxels`
  springs  polynomials of the first principal components of the readings, with or without products
  dipoles  polynomials of the motion of magnets, estimated from the readings by nonlinear least squares
  both     the chosen terms of ridge and of dipoles

Memory is the difference between a reading, component or displacement and its low-pass filters. Cross-validation over
blocks of time of the training part chooses terms, numbers of components and dipoles, and penalties. Positions, moments
and rotations are fitted to the readings of the training part, without forces."""

import itertools
import os
import sys

import numpy as np

DATA = os.path.join(os.environ.get("FEELER_DATA", "../shared/data"), "eflesh-force")
NEWTONS, DELAY = 9.80665e-3, -0.15  # per gram; of the scale after the readings, s
TIME_CONSTANTS = [0.3, 1.0, 3.0, 10.0, 30.0]  # s
PENALTIES = 10.0 ** (np.arange(-8, 13) / 2)
STRENGTH = 2.6e7  # magnet of N52, 3/8 x 1/8 inch, µT mm³
CHIPS = np.array([[0, 0, 0], [-7, 0, 0], [7, 0, 0], [0, 7, 0], [0, -7, 0.0]])  # mm
SIDE, TURNS = -1, np.deg2rad([-90, -90, 0, 90, 180])  # sign of y, rotations of chips: best of 16, at known places
NOISE = 8.0  # of readings, with errors of the dipole model, µT
GRID = np.array([[9, 9], [-9, 9], [-9, -9], [9, -9.0]])  # mm
POLARITIES = {1: [[1], [-1]], 4: [[1, 1, 1, 1], [-1, -1, -1, -1], [1, -1, 1, -1], [-1, 1, -1, 1]]}  # by number of magnets
HEIGHTS = {1: (14.0, 20.0, 26.0), 4: (16.0,)}  # initial heights of the magnets above the chips, mm
STATES = [("translation", 4), ("rigid", 1), ("rigid", 4), ("independent", 4)]  # 3, 6, 6, 12 unknowns per row
FITTED = {}  # models and magnets of earlier fits

def load(name):
    """Times, readings and states of a recording."""
    sensor, states = (np.loadtxt(f"{DATA}/{name}-{table}.csv.gz", delimiter=",") for table in ("sensor", "states"))
    zero = 0 if name.startswith("place") else sensor[:10, 1:].mean(0)
    return sensor[:, 0], sensor[:, 1:] - zero, states

def force(times, states):
    """Force at each of `times`, N, and whether it can be interpolated."""
    valid = states[:, 4] >= 0
    at, values = states[valid, 0], states[valid, 4] * NEWTONS
    intervals = np.r_[np.inf, np.diff(at), np.inf][np.searchsorted(at, times + DELAY)]
    return np.interp(times + DELAY, at, values), intervals < 4 * np.median(np.diff(at))

def memory(times, values):
    """Differences between `values` and their low-pass filters."""
    intervals = np.maximum(np.diff(times, prepend=times[0]), 0)[:, None, None]
    parts = 1 - np.exp(-intervals / np.array(TIME_CONSTANTS)[:, None])
    filtered = np.zeros((len(times) + 1, len(TIME_CONSTANTS), values.shape[1]))
    for row, (part, value) in enumerate(zip(parts, values)):
        filtered[row + 1] = filtered[row] + part * (value - filtered[row])
    return (values[:, None] - filtered[1:]).reshape(len(times), -1)

def monomials(values, order, additive=False):
    """All products of up to `order` columns; powers alone if `additive`."""
    if additive:
        return np.hstack([values**o for o in range(1, order + 1)])
    sets = [itertools.combinations_with_replacement(range(values.shape[1]), o) for o in range(1, order + 1)]
    return np.stack([np.prod(values[:, list(c)], axis=1) for c in itertools.chain(*sets)], axis=1)

def pattern(values, floor):
    """Direction and ln of the length of all readings, and their products."""
    norm = np.sqrt((values**2).sum(1, keepdims=True) + floor**2)
    return monomials(np.hstack([values / norm, np.log(norm)]), 2)

def ridge(terms, remembered, measured):
    """Ridge regression. Returns the cross-validated RMSE and the prediction as a function of terms and memory."""
    scale, x = np.repeat([1, 0.1], [terms.shape[1], remembered.shape[1]]), np.hstack([terms, remembered])
    mean, deviation = x.mean(0), x.std(0) + 1e-12
    z, rows = (x - mean) / deviation * scale, len(x)
    gram, total, squares = z.T @ z, z.T @ measured, np.zeros((len(PENALTIES), rows))
    for count in (5, 8):
        for held in np.array_split(np.arange(rows), count):
            own, left = z[held], rows - len(held)
            middle, level = -own.sum(0) / left, (measured.sum() - measured[held].sum()) / left
            values, vectors = np.linalg.eigh(gram - own.T @ own - left * np.outer(middle, middle))
            right = vectors.T @ (total - own.T @ measured[held] - left * middle * level)
            weights = vectors @ (right[:, None] / (np.maximum(values, 0)[:, None] + PENALTIES))
            squares[:, held] += (((own - middle) @ weights + level - measured[held][:, None]) ** 2).T / 2
    best, worse = squares.mean(1).argmin(), np.sqrt(squares)
    worse -= worse[best]
    as_good = [k for k in range(best, len(worse)) if worse[k].mean() <= worse[k].std() / np.sqrt(rows)]
    chosen = (best + max(as_good)) // 2
    weights = np.linalg.solve(gram + PENALTIES[chosen] * np.eye(len(gram)), z.T @ (measured - measured.mean()))
    predict = lambda t, m: (np.hstack([t, m]) - mean) / deviation * scale @ weights + measured.mean()
    return np.sqrt(squares[chosen].mean()), predict

def rotated(vectors, turn):
    """Rotates `vectors` by the rotation vectors `turn`."""
    angle = np.sqrt((turn * turn).sum(-1, keepdims=True)) + 1e-12
    axis, cos = turn / angle, np.cos(angle)
    return vectors * cos + np.cross(axis, vectors) * np.sin(angle) + axis * (axis * vectors).sum(-1, keepdims=True) * (1 - cos)

def dipole_model(kind, count):
    """Change of the readings as a function of magnets (positions, moments, rotations of chips) and of their motion per row."""
    def field(places, moments, angles):
        r = (CHIPS * [1, SIDE, 1])[:, None] - places[:, None]
        square, along = (r * r).sum(-1), (moments[:, None] * r).sum(-1)
        b = ((3 * along / square)[..., None] * r - moments[:, None]) / (square**1.5)[..., None]
        b, cos, sin = STRENGTH * b.sum(2), np.cos(angles), np.sin(angles)
        turned = [cos * b[..., 0] + sin * b[..., 1], cos * b[..., 1] - sin * b[..., 0], b[..., 2]]
        return np.stack(turned, -1).reshape(len(places), -1)
    def model(magnets, motion):
        places, moments = magnets[: 6 * count].reshape(2, count, 3)
        angles, shape = SIDE * TURNS + magnets[6 * count :], (len(motion), count, 3)
        moved, tilted = places + np.zeros(shape), moments + np.zeros(shape)
        if kind == "rigid":
            turn, middle = 0.1 * motion[:, None, 3:] + np.zeros(shape), places.mean(0)
            moved, tilted = middle + rotated(moved - middle, turn), rotated(tilted, turn)
        moved = moved + (motion.reshape(shape) if kind == "independent" else motion[:, None, :3])
        return field(moved, tilted, angles) - field(places[None], moments[None], angles)
    return model

def solve_motion(model, magnets, readings, motion, iterations=25):
    """Motion of each row by Levenberg-Marquardt, with a prior of 3 mm (tilts: 0.3 rad)."""
    step, identity, damping = 1e-5, np.eye(motion.shape[1]), np.full(len(readings), 1e-2)
    cost, residual = lambda r, q: (r * r).sum(1) + (q * q).sum(1) / 9, lambda q: (model(magnets, q) - readings) / NOISE
    now = cost(r := residual(motion), motion)
    for _ in range(iterations):
        j = np.stack([residual(motion + step * e) - r for e in identity], -1) / step
        h = np.einsum("nci,ncj->nij", j, j) + identity / 9
        h += damping[:, None, None] * np.einsum("nii->ni", h)[:, :, None] * identity
        new = motion - np.linalg.solve(h, (np.einsum("nci,nc->ni", j, r) + motion / 9)[..., None])[..., 0]
        r_new = residual(new)
        better = (after := cost(r_new, new)) < now
        motion[better], r[better], small = new[better], r_new[better], np.where(better, now - after, 0) < 1e-4 * now
        now = np.where(better, after, now)
        damping = np.where(better, np.maximum(damping / 5, 1e-8), np.minimum(damping * 5, 1e6))
        if small.mean() > 0.999:
            break
    return motion

def fit_magnets(model, prior, spread, readings, size, magnets, iterations):
    """Magnets and motions of all rows together (Schur complement of Levenberg-Marquardt). Returns cost and magnets."""
    motion, damping, step = np.zeros((len(readings), size)), 1e-2, 1e-5
    cost = lambda p, q, r: (r * r).sum() + (q * q).sum() / 9 + (((p - prior) / spread) ** 2).sum()
    residual = lambda p, q: (model(p, q) - readings) / NOISE
    r = residual(magnets, motion)
    now, identity = cost(magnets, motion, r), np.eye(size)
    for _ in range(iterations):
        jq = np.stack([residual(magnets, motion + step * e) - r for e in identity], -1) / step
        jp = np.stack([residual(magnets + step * e, motion) - r for e in np.eye(len(magnets))], -1) / step
        h, g = np.einsum("nci,ncj->nij", jq, jq) + identity / 9, np.einsum("nci,nc->ni", jq, r) + motion / 9
        a = np.einsum("nci,ncj->ij", jp, jp) + np.diag(1 / spread**2)
        b, w = np.einsum("nci,nc->i", jp, r) + (magnets - prior) / spread**2, np.einsum("nci,ncj->nij", jp, jq)
        for _ in range(7):
            inverse = np.linalg.inv(h + damping * np.einsum("nii->ni", h)[:, :, None] * identity)
            s = a + damping * np.diag(np.diag(a)) - np.einsum("nij,nkj->ik", w @ inverse, w)
            dp = np.linalg.solve(s, np.einsum("nij,nj->i", w @ inverse, g) - b)
            dq = -np.einsum("nij,nj->ni", inverse, g + np.einsum("nij,i->nj", w, dp))
            r_new = residual(magnets + dp, motion + dq)
            if (after := cost(magnets + dp, motion + dq, r_new)) < now:
                break
            damping *= 6
        else:
            break
        magnets, motion, r, gain, now = magnets + dp, motion + dq, r_new, 1 - after / now, after
        if gain < 1e-4:
            break
        damping = max(damping / 6, 1e-7)
    return now, magnets

def displacements(kind, count, training, tables):
    """Displacements for each table of readings by magnets fitted to `training` from several starts; RMS residual, µT."""
    size, key = {"translation": 3, "rigid": 6, "independent": 3 * count}[kind], (kind, count, training.tobytes())
    if key not in FITTED:
        order = np.argsort(np.linalg.norm(training, axis=1))
        chosen = training[order[np.linspace(0, len(order) - 1, 90).astype(int)]]
        model, starts = dipole_model(kind, count), []
        spread = np.repeat([3.0, 0.3, 0.2], [3 * count, 3 * count, 5])
        for polarity, height in itertools.product(POLARITIES[count], HEIGHTS[count]):
            places = np.c_[GRID if count == 4 else np.zeros((1, 2)), np.full(count, height)].ravel()
            prior = np.r_[places, np.c_[np.zeros((count, 2)), polarity].ravel(), np.zeros(5)]
            starts.append((*fit_magnets(model, prior, spread, chosen[::3], size, prior, 6), prior))
        steps, kept = (60, 6) if count == 1 else (20, 2)
        starts = sorted(starts, key=lambda start: start[0])[:kept]
        ends = [fit_magnets(model, prior, spread, chosen, size, p, steps) for _, p, prior in starts]
        FITTED[key] = model, min(ends, key=lambda end: end[0])[1]
    model, magnets = FITTED[key]
    motions = [solve_motion(model, magnets, t, np.zeros((len(t), size))) for t in tables]
    return motions, np.sqrt(np.mean([((model(magnets, q) - t) ** 2).mean() for q, t in zip(motions, tables)]))

def candidates(tables, train, places):
    """Candidates: family, name, terms of each table, and quantities whose memory is added. `train`: rows of the first."""
    readings, training = [v for _, v in tables], tables[0][1][train]
    fitted = train & (np.arange(len(train)) < int(0.8 * len(train)))  # the same rows for the other run: the fit is reused
    scaled = [v / np.sqrt((training**2).sum(1).mean()) for v in readings]
    axes = np.linalg.svd(training, full_matrices=False)[2]
    yield "ridge", "products", [monomials(v, 2) for v in scaled], scaled
    yield "ridge", "direction", [pattern(v, 0.1) for v in scaled], scaled
    for count, order, additive in itertools.product((1, 2, 4, 6), (1, 2, 3), (False, True)):
        scores = [v @ axes[:count].T for v in scaled]
        name = f"{count} {'powers' if additive else 'products'}, order {order}"
        yield "springs", name, [monomials(q, order, additive) for q in scores], scores
    for kind, count in STATES:
        skins = []
        for first in range(0, training.shape[1], 15):
            own = [v[:, first : first + 15] for v in readings]
            motions, residual = displacements(kind, count, own[0][fitted], own)
            skins += [motions]
            print(f"# {count} dipoles, {kind}: residual {residual:.1f} µT", flush=True)
        moved = [np.hstack(parts) for parts in zip(*skins)]
        for order in (1, 2) if kind == "independent" else (1, 2, 3):
            terms = [np.hstack([monomials(q, order) for q in parts]) for parts in zip(*skins)]
            yield "dipoles", f"{count} {kind}, order {order}", terms, moved
        if places:
            floor = 0.1 * np.sqrt((moved[0][train] ** 2).sum(1).mean())
            yield "dipoles", f"{count} {kind}, direction", [pattern(q, floor) for q in moved], moved

def compare(title, tables, train, targets, hold, tested, places=False):
    """Prints errors. `tables`: times and readings; of the first, the rows `train` with the values `targets` of each
    quantity are for training; of the last, the rows `hold` with the values `tested` for testing."""
    all_candidates = list(candidates(tables, train, places))
    for remembers in (False,) if places else (False, True):
        best = {}

        def fit(family, name, terms, remembered):
            past = [memory(t, q) if remembers else q[:, :0] for (t, _), q in zip(tables, remembered)]
            fits = [ridge(terms[0][train], past[0][train], y) for y in targets]
            errors = [predict(terms[-1][hold], past[-1][hold]) - y for (_, predict), y in zip(fits, tested)]
            score = np.mean([validated for validated, _ in fits])
            if family not in best or score < best[family][0]:
                error = [np.abs(e).mean() if places else np.sqrt((e * e).mean()) for e in errors]
                best[family] = score, error, name, terms, remembered
        list(itertools.starmap(fit, all_candidates))
        fit("both", "", *([np.hstack(p) for p in zip(best["ridge"][k], best["dipoles"][k])] for k in (3, 4)))
        for family, (score, error, name, *_) in best.items():
            shown = ", ".join(f"{e:.3f}" for e in error) + (" mm" if places else " N")
            print(f"{title} | {'memory' if remembers else 'no memory'} | {family} | {score:.3f} | {shown} | {name}", flush=True)

if __name__ == "__main__":
    wanted = sys.argv[1:] or ["normal", "shear", "place"]
    loaded = {name: load(name) for name in ("normal-1", "normal-2", "shear-1", "place-1") if name[:-2] in wanted}
    for name, (times, readings, states) in loaded.items():
        places, first = name.startswith("place"), np.arange(len(times)) < int(0.8 * len(times))
        values, valid = (states[:, 1:3].T, first | True) if places else force(times, states)
        values, train, hold = np.atleast_2d(values), valid & first, valid & ~first
        compare(f"{name}, last fifth", [(times, readings)], train, values[:, train], hold, values[:, hold], places)
    for one, other in (("normal-1", "normal-2"), ("normal-2", "normal-1")) if "normal" in wanted else ():
        (f, train), (g, hold) = (force(loaded[name][0], loaded[name][2]) for name in (one, other))
        compare(f"{other} from {one}", [loaded[one][:2], loaded[other][:2]], train, [f[train]], hold, [g[hold]])
