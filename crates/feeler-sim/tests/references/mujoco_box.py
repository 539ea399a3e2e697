"""Simulates a free box on a table in MuJoCo and writes its poses over time to `mujoco_box.json`.

Usage, in the environment of `mujoco_cap.py`: mujoco_box.py OUTPUT. A box of 40 x 40 x 80 mm and 0.2 kg is dropped flat
or tilted, or pushed by a constant horizontal force at a fixed point of the box: low and weak (stays), low and strong
(slides), high (tips).
"""

import json
import sys

import mujoco

# Half sizes (m), mass (kg), friction coefficient, time step (s) and sampling period (s).
SIZE, MASS, FRICTION, STEP, SAMPLE = [0.02, 0.02, 0.04], 0.2, 0.5, 0.0005, 0.02
# name: initial position (m), tilt about y (rad), force along x (N), its height above the box's centre (m), duration (s)
CASES = {
    "dropped_flat": ([0, 0, 0.06], 0.0, 0.0, 0.0, 1.0),
    "dropped_tilted": ([0, 0, 0.07], 0.3, 0.0, 0.0, 1.5),
    "pushed_stays": ([0, 0, 0.04], 0.0, 0.4, -0.02, 0.5),
    "pushed_slides": ([0, 0, 0.04], 0.0, 1.3, -0.03, 0.5),
    "pushed_tips": ([0, 0, 0.04], 0.0, 0.8, 0.03, 0.4),
}


def run(start, tilt, force, height, end):
    model = mujoco.MjModel.from_xml_string(f"""<mujoco><compiler angle="radian"/>
<option timestep="{STEP}" cone="elliptic" integrator="implicitfast" impratio="10"/>
<worldbody><geom type="plane" size="1 1 1" friction="{FRICTION} 0 0" condim="3" solref="0.005 1" solimp="0.9 0.95 0.001"/>
<body name="box" pos="{start[0]} {start[1]} {start[2]}" euler="0 {tilt} 0"><freejoint/>
<geom type="box" size="{SIZE[0]} {SIZE[1]} {SIZE[2]}" mass="{MASS}" friction="{FRICTION} 0 0" condim="3"
  solref="0.005 1" solimp="0.9 0.95 0.001"/></body></worldbody></mujoco>""")
    data, rows = mujoco.MjData(model), []
    mujoco.mj_forward(model, data)
    for n in range(round(end / STEP)):
        point = data.xpos[1] + data.xmat[1].reshape(3, 3) @ [-SIZE[0], 0, height]
        data.qfrc_applied[:] = 0
        mujoco.mj_applyFT(model, data, [force, 0, 0], [0, 0, 0], point, 1, data.qfrc_applied)
        mujoco.mj_step(model, data)
        if (n + 1) % round(SAMPLE / STEP) == 0:
            rows.append([round(float(q), 6) for q in data.qpos])
    return rows


def main(path):
    made = {"made_by": f"crates/feeler-sim/tests/references/mujoco_box.py, MuJoCo {mujoco.__version__}", "half_size": SIZE, "mass": MASS,
            "friction": FRICTION, "step": STEP, "sample": SAMPLE, "gravity": 9.81,
            "row": "x, y, z (m), quaternion w, x, y, z"}
    cases = [f'"{name}": ' + json.dumps({"case": case, "poses": run(*case)}) for name, case in CASES.items()]
    with open(path, "w") as file:
        file.write('{"header": ' + json.dumps(made) + ",\n" + ",\n".join(cases) + "}\n")


if __name__ == "__main__":
    main(sys.argv[1])
