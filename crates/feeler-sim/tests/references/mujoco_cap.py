"""Simulates two fingertips of 41 feelers that turn a cap in MuJoCo, and writes `mujoco_cap_*.json`.

    python3 -m venv target/references
    target/references/bin/pip install mujoco==3.3.7 numpy==2.4.6
    target/references/bin/python crates/feeler-sim/tests/references/mujoco_cap.py crates/feeler-sim/tests/references

MuJoCo 4.0.0 gives the same cap angles to the last stored digit, and forces within 6e-5 of their RMS.

`tests/all/mujoco_cap.rs` replays the motion and compares the cap angle and the forces on the elements. With
`--time`, the script prints the mean and median duration of a step (us) instead, for `benches/peers/mujoco.py`.

The motion is a function of time: joint angles (rad) are interpolated between knots by 3 s^2 - 2 s^3, and determine the
poses of the fingertips by forward kinematics. An element is a small mass with a sphere that touches the cap, on three
slide joints with springs. The cap is a cylinder on a hinge; its thread is a friction torque that increases on the seat.
Forces are the spring forces in the element's frame: F_x, F_y on the feeler by the cap, F_z compression.

There are two scenes: round tips, which roll on the turning cap, and almost point-like tips, for which rolling is
negligible. The centres of the tips lie on the same circle in both.

The scene requires an elliptic cone, the implicitfast integrator, a few noslip iterations (otherwise shear decays in
sticking contacts), and contacts that are stiff compared to the springs. Static and kinetic friction are equal, as
MuJoCo has only one coefficient.
"""

import json
import math
import sys
import time

import mujoco
import numpy as np

DOME = 0.018
SCENES = {"round_tips": (0.0015, 0.014), "point_tips": (0.00002, 0.01548)}  # radii of tip and cap, m
RINGS = [(1, 0.0), (8, 22.5), (12, 45.0), (20, 67.5)]
NORMAL, SHEAR, FRICTION = 1180.0, 480.0, 0.8
TIP = 0.0015
CAP = {"radius": 0.014, "height": 0.020, "position": [0.0, 0.0, 0.1], "running_torque": 0.0025,
       "seat_angle": 0.15, "seat_stiffness": 0.75}
LINKS = [0.030, 0.060, 0.055]
BASES = [([-0.1655, 0.0, 0.0576], 0.0), ([0.1655, 0.0, 0.0576], math.pi)]  # position, m; rotation about y, rad
# Mass (kg) and damping (N s/m) of an element. The damping prevents overshoot after a slip, which would ratchet the cap
# forward. It adds 5 mN at 3.5 mm/s.
MASS, DAMPING = 1e-3, 1.4
CAP_INERTIA, CAP_DAMPING = 2e-5, 2e-4  # kg m^2, N m s
# Knots of the motion of finger 0: times (s) and centres of the dome (m). Finger 1 moves likewise, turned by pi about z.
TIMES = [0.0, 1.0, 4.0, 5.0]
CENTRES = [[-0.0337, 0.0010, 0.1], [-0.0324, 0.0010, 0.1], [-0.0319, -0.0060, 0.1], [-0.0345, -0.0060, 0.1]]
SAMPLE = 0.04


def rotation_y(a):
    c, s = math.cos(a), math.sin(a)
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


def elements():
    """Returns the rotation of each element's frame in the fingertip's: columns x (meridian), y, z (normal)."""
    frames = []
    for count, polar in RINGS:
        for j in range(count):
            a, p = 2 * math.pi * j / count, math.radians(polar)
            ca, sa, cp, sp = math.cos(a), math.sin(a), math.cos(p), math.sin(p)
            n, m = np.array([cp, sp * ca, sp * sa]), np.array([-sp, cp * ca, cp * sa])
            frames.append(np.column_stack([m, np.cross(n, m), n]))
    return frames


def pose(finger, theta):
    """Returns the centre of the dome (m) and the rotation of the fingertip in the world: eqs. (2), (3) of the paper."""
    base, phi = BASES[finger]
    b = rotation_y(phi)
    (s1, s2, s3), (c1, c2, c3) = np.sin(theta), np.cos(theta)
    s23, c23 = s2 * c3 + c2 * s3, c2 * c3 - s2 * s3
    radial, sideways, axial = b[:, 0] * c1 + b[:, 1] * s1, b[:, 1] * c1 - b[:, 0] * s1, b[:, 2]
    l2, l3, l4 = LINKS
    at = np.array(base) + radial * (l2 + l3 * c2 + l4 * c23) + axial * (l3 * s2 + l4 * s23)
    return at, np.column_stack([radial * c23 + axial * s23, axial * c23 - radial * s23, -sideways])


def solve(finger, target):
    """Returns the joint angles that place the dome's centre at `target`, by Newton's method."""
    theta = np.array([0.0, 0.78, -0.78]) * (1 if finger == 0 else -1)
    for _ in range(50):
        at = pose(finger, theta)[0]
        jacobian = np.column_stack([(pose(finger, theta + 1e-7 * e)[0] - at) / 1e-7 for e in np.eye(3)])
        theta = theta + np.linalg.solve(jacobian, np.asarray(target) - at)
    return np.round(theta, 9)


def knots():
    turned = [[-x, -y, z] for x, y, z in CENTRES]
    return [[solve(f, c).tolist() for c in (CENTRES, turned)[f]] for f in (0, 1)]


def joints(knots, t):
    i = min(max(int(np.searchsorted(TIMES, t, side="right")) - 1, 0), len(TIMES) - 2)
    s = min(max((t - TIMES[i]) / (TIMES[i + 1] - TIMES[i]), 0.0), 1.0)
    s = s * s * (3 - 2 * s)
    return [(1 - s) * np.array(k[i]) + s * np.array(k[i + 1]) for k in knots]


def quaternion(rotation):
    q = np.zeros(4)
    mujoco.mju_mat2Quat(q, np.asarray(rotation).flatten())
    return q


def scene(step, solver="Newton"):
    text = lambda v: " ".join(repr(float(x)) for x in v)
    contact = f'friction="{FRICTION} 0 0" condim="3" solref="{2 * step} 1" solimp="0.995 0.995 0.001"'
    fingers = ""
    for f in range(2):
        bodies = ""
        for e, frame in enumerate(elements()):
            axes = [("x", "1 0 0", SHEAR), ("y", "0 1 0", SHEAR), ("z", "0 0 1", NORMAL)]
            slides = "".join(
                f'<joint name="f{f}e{e}{n}" type="slide" axis="{a}" stiffness="{k}" damping="{DAMPING}"/>' for n, a, k in axes)
            bodies += (f'<body pos="{text(DOME * frame[:, 2])}" quat="{text(quaternion(frame))}">{slides}'
                       f'<inertial pos="0 0 0" mass="{MASS}" diaginertia="1e-9 1e-9 1e-9"/>'
                       f'<geom type="sphere" size="{TIP}" contype="1" conaffinity="0" {contact}/></body>')
        # The pose is prescribed. The large mass keeps forces from moving the fingertip within a step.
        fingers += (f'<body name="finger{f}" pos="{1 - 2 * f} 0 0"><freejoint name="finger{f}"/>'
                    f'<inertial pos="0 0 0" mass="1000" diaginertia="10 10 10"/>{bodies}</body>')
    return f"""<mujoco><compiler angle="radian"/>
<option timestep="{step}" gravity="0 0 0" cone="elliptic" integrator="implicitfast" noslip_iterations="5"
  solver="{solver}" tolerance="1e-10" iterations="100" jacobian="sparse"/>
<worldbody><body name="cap" pos="{text(CAP['position'])}">
<joint name="cap" type="hinge" damping="{CAP_DAMPING}" axis="0 0 1" frictionloss="{CAP['running_torque']}" solreffriction="{2 * step} 1"
  solimpfriction="0.995 0.995 0.001"/>
<inertial pos="0 0 0" mass="0.01" diaginertia="{CAP_INERTIA} {CAP_INERTIA} {CAP_INERTIA}"/>
<geom type="cylinder" size="{CAP['radius']} {CAP['height'] / 2}" contype="0" conaffinity="1" {contact}/>
</body>{fingers}</worldbody></mujoco>"""


class Scene:
    def __init__(self, step):
        self.step, self.knots = step, knots()
        self.model = mujoco.MjModel.from_xml_string(scene(step))
        self.data = mujoco.MjData(self.model)
        m = self.model
        joint = lambda name: mujoco.mj_name2id(m, mujoco.mjtObj.mjOBJ_JOINT, name)
        self.cap = joint("cap")
        self.fingers = [joint(f"finger{f}") for f in range(2)]
        self.slides = np.array([[[m.jnt_qposadr[joint(f"f{f}e{e}{n}")] for n in "xyz"] for e in range(41)] for f in range(2)])
        self.stiffness = np.array([SHEAR, SHEAR, -NORMAL])
        steps = round(TIMES[-1] / step)
        self.poses = [self.at(n * step) for n in range(steps + 1)]
        self.steps = steps
        self.place(0)

    def at(self, t):
        poses = [pose(f, theta) for f, theta in enumerate(joints(self.knots, t))]
        return [(p, r, quaternion(r)) for p, r in poses]

    def place(self, n):
        """Sets the fingertips' poses at step `n` and their velocities to the next step."""
        m, d = self.model, self.data
        for f, j in enumerate(self.fingers):
            (p, r, q), (p1, _, q1) = self.poses[n][f], self.poses[min(n + 1, self.steps)][f]
            turn = np.zeros(3)
            mujoco.mju_subQuat(turn, q1, q)
            a, v = m.jnt_qposadr[j], m.jnt_dofadr[j]
            d.qpos[a:a + 3], d.qpos[a + 3:a + 7] = p, q
            d.qvel[v:v + 3], d.qvel[v + 3:v + 6] = (p1 - p) / self.step, turn / self.step

    def advance(self, n):
        m, d = self.model, self.data
        self.place(n)
        over = max(0.0, d.qpos[m.jnt_qposadr[self.cap]] - CAP["seat_angle"])
        m.dof_frictionloss[m.jnt_dofadr[self.cap]] = CAP["running_torque"] + CAP["seat_stiffness"] * over
        mujoco.mj_step(m, d)

    def angle(self):
        return float(self.data.qpos[self.model.jnt_qposadr[self.cap]])

    def forces(self):
        return self.data.qpos[self.slides] * self.stiffness


def run(step):
    world, every = Scene(step), round(SAMPLE / step)
    angles, forces = [], []
    for n in range(world.steps):
        world.advance(n)
        if (n + 1) % every == 0:
            angles.append(world.angle())
            forces.append(world.forces())
    return np.array(angles), np.array(forces)


def time_step():
    world = Scene(0.0005)
    spent = []
    for n in range(world.steps):
        world.place(n)
        start = time.perf_counter()
        mujoco.mj_step(world.model, world.data)
        spent.append(time.perf_counter() - start)
    return 1e6 * sum(spent) / len(spent), 1e6 * sorted(spent)[len(spent) // 2]


def converged_until(coarse, fine):
    """Returns the time (s) at which the cap angles first differ by more than 0.5 % of the final angle."""
    apart = np.nonzero(np.abs(coarse - fine) > 0.005 * abs(fine[-1]))[0]
    return float(SAMPLE * (apart[0] if len(apart) else len(fine)))


def difference(a, b):
    (angles, forces), (other_angles, other_forces) = a, b
    rms = lambda x: float(np.sqrt(np.mean(np.square(x))))
    touching = np.abs(other_forces).max(axis=(0, 3)) > 1e-3
    return {"cap_angle_relative_to_final": float(np.abs(angles - other_angles).max() / abs(other_angles[-1])),
            "force_rms_relative": rms((forces - other_forces)[:, touching]) / rms(other_forces[:, touching])}


def main(path):
    """Simulates the scene set by `TIP` and `CAP`, and writes it to `path`."""
    coarse, fine = run(0.0005), run(0.00025)
    angles, forces = fine
    touching = np.abs(forces).max(axis=(0, 3)) > 1e-3
    series = {f"{f}/{e}": np.round(forces[:, f, e], 4).tolist() for f in range(2) for e in range(41) if touching[f, e]}
    header = {
        "converged_until": converged_until(coarse[0], angles), "made_by": f"crates/feeler-sim/tests/references/mujoco_cap.py, MuJoCo {mujoco.__version__}, step 0.25 ms",
        "half_millisecond_step_differs_by": difference(coarse, fine),
        "dome_radius": DOME, "tip_radius": TIP, "normal_stiffness": NORMAL, "shear_stiffness": SHEAR,
        "friction": FRICTION, "cap": CAP, "links": LINKS, "bases": [b[0] for b in BASES], "phi1_deg": [0.0, 180.0],
        "knot_times": TIMES, "knot_joints": knots(), "sample": SAMPLE,
    }
    print(json.dumps(header["half_millisecond_step_differs_by"]), "final angle", angles[-1],
          "touching", int(touching.sum()), "max force", float(np.abs(forces).max()), file=sys.stderr)
    lines = ['  ' + json.dumps(k) + ": " + json.dumps(v, separators=(",", ":")) for k, v in series.items()]
    with open(path, "w") as file:
        file.write('{\n"header": ' + json.dumps(header) + ',\n"cap_angle": ' + json.dumps(np.round(angles, 6).tolist())
                   + ',\n"forces": {\n' + ",\n".join(lines) + "\n}\n}\n")


if __name__ == "__main__":
    if sys.argv[1] == "--time":
        print("{:.2f} {:.2f}".format(*time_step()))
    else:
        for name, (TIP, CAP["radius"]) in SCENES.items():
            main(f"{sys.argv[1]}/mujoco_cap_{name}.json")
