"""The soft tip in MuJoCo: one rigid contact on springs (`mujoco_tip.py OUT sphere`) or a flex (`mujoco_tip.py OUT flex`).

The plate moves instead of the tip, by prescribed velocity and position, because MuJoCo's friction acts on velocities. Its
mass of 1 t keeps forces from moving it within a step. The load is the constraint force on the plate's joints.

* sphere: a rigid sphere on joint springs of Mindlin's shear stiffness and of the stiffness in torsion. The contact's
  direct stiffness is fitted to Hertz's force at the last depth; its torsional friction is Hertz's limit there. The
  sensing elements are the pixels of the plugin `touch_grid`; the sensor `tactile` reports depths, not forces.
* flex: tetrahedra of the given Young's modulus and Poisson's ratio, bonded at the top. The elements are its contacts.
"""

import math
import sys

import mujoco
import numpy as np

import mesh
import scene

MASS = 1000.0
TIP_MASS = 1e-3
# Mass (kg) of the rubber at 1000 kg/m^3.
MASS_OF_TIP = 0.0019
ACROSS, LAYERS = 13, 6
SOLVER = "CG"


def text(values):
    return " ".join(repr(float(v)) for v in np.ravel(values))


PLATE = f"""<body name="plate"><joint name="px" type="slide" axis="1 0 0"/><joint name="pz" type="slide" axis="0 0 1"/>
<joint name="turn" type="hinge" axis="0 0 1"/><inertial pos="0 0 0" mass="{MASS}" diaginertia="1000 1000 1000"/>
<geom name="plate" type="box" size=".05 .05 .01" pos="0 0 -.01" {{contact}}/></body>"""


class Tip:
    """Motion of the plate and forces on it."""

    def __init__(self, xml):
        self.model = mujoco.MjModel.from_xml_string(xml)
        self.data = mujoco.MjData(self.model)
        joint = lambda name: self.model.joint(name)
        self.dofs = [joint(n).dofadr[0] for n in ("px", "pz", "turn")]
        self.places = [joint(n).qposadr[0] for n in ("px", "pz", "turn")]
        self.before = np.zeros(3)

    def advance(self, depth, travel, turn):
        now = np.array([-travel, depth, -turn])
        self.data.qpos[self.places] = self.before
        self.data.qvel[self.dofs] = (now - self.before) / self.model.opt.timestep
        self.before = now
        mujoco.mj_step(self.model, self.data)

    def contacts(self):
        """Forces on the plate along the world's axes [n, 3] and positions [n, 3] of the contacts."""
        forces, places = [], []
        for index in range(self.data.ncon):
            contact, force = self.data.contact[index], np.zeros(6)
            mujoco.mj_contactForce(self.model, self.data, index, force)
            frame = contact.frame.reshape(3, 3)
            # The force acts on the second body along the normal, away from the first.
            sign = 1 if contact.geom[1] == self.plate else -1
            forces.append(sign * frame.T @ force[:3])
            places.append(contact.pos.copy())
        return np.array(forces).reshape(-1, 3), np.array(places).reshape(-1, 3)

    @property
    def plate(self):
        return self.model.geom("plate").id

    def read(self):
        force = self.data.qfrc_constraint[self.dofs]
        forces, places = self.contacts()
        pressed = places[forces[:, 2] < 0]
        # Forces are relative to the tip's motion, which is opposite to the plate's.
        return {"load": -float(force[1]), "elements": self.elements(forces), "shear": float(force[0]),
                "moment": float(force[2]),
                "radius": float(np.hypot(*pressed[:, :2].T).max()) if len(pressed) > 1 else None}


class Sphere(Tip):
    def __init__(self, step, stiffness=None):
        stiffness = stiffness or fitted()
        shear, twist = scene.shear_stiffness(), scene.twist_stiffness()
        torsional = 3 * math.pi / 16 * scene.FRICTION * scene.hertz_radius(scene.DEPTH)
        contact = (f'condim="4" friction="{scene.FRICTION} {torsional} 0" solref="{-stiffness} {-2 * math.sqrt(stiffness)}" '
                   'solimp="0.9 0.9 0.001"')
        damp = 2 * math.sqrt(shear * TIP_MASS)
        inertia = 0.4 * TIP_MASS * scene.RADIUS**2
        grid = f"""<plugin name="grid" plugin="mujoco.sensor.touch_grid" objtype="site" objname="grid"><config key="size" value="16 16"/>
<config key="fov" value="60 60"/><config key="gamma" value="0"/><config key="nchannel" value="3"/></plugin>"""
        super().__init__(f"""<mujoco><compiler angle="radian"/><option timestep="{step}" gravity="0 0 0" cone="elliptic"
integrator="implicitfast" tolerance="1e-10" iterations="100" noslip_iterations="5"/>
<extension><plugin plugin="mujoco.sensor.touch_grid"/></extension>
<asset><mesh name="cap" builtin="wedge" params="20 20 60 60 0" scale="{scene.RADIUS} {scene.RADIUS} {scene.RADIUS}"/></asset>
<worldbody>{PLATE.format(contact=contact)}
<body name="tip" pos="0 0 {scene.RADIUS}"><joint type="slide" axis="1 0 0" stiffness="{shear}" damping="{damp}"/>
<joint type="slide" axis="0 1 0" stiffness="{shear}" damping="{damp}"/>
<joint type="hinge" axis="0 0 1" stiffness="{twist}" damping="{2 * math.sqrt(twist * inertia)}"/>
<inertial pos="0 0 0" mass="{TIP_MASS}" diaginertia="{inertia} {inertia} {inertia}"/>
<geom name="ball" type="sphere" size="{scene.RADIUS}" {contact}/>
<geom name="cap" type="mesh" mesh="cap" contype="0" conaffinity="0" mass="0"/>
<site name="grid"/></body></worldbody>
<sensor>{grid}<tactile name="tactile" geom="cap" mesh="cap"/></sensor></mujoco>""")

    def elements(self, forces):
        return abs(float(self.data.sensor("grid").data[:256].sum()))

    def read(self):
        depths = self.data.sensor("tactile").data[:400]
        return {**super().read(), "sum_of_depths": float(depths.sum())}


def fitted():
    """Contact stiffness (1/s^2) for Hertz's force at the last depth. The force is proportional to it."""
    tip = Sphere(0.001, 1e6)
    for n in range(500):
        tip.advance(min(scene.DEPTH, 1e-5 * n), 0.0, 0.0)
    return 1e6 * scene.hertz_force(scene.DEPTH) / tip.read()["load"]


class Flex(Tip):
    def __init__(self, step):
        points, tetrahedra, bonded = mesh.tip(ACROSS, LAYERS)
        contact = f'condim="3" friction="{scene.FRICTION} 0 0" solref="{2 * step} 1" solimp="0.9999 0.9999 0.001"'
        super().__init__(f"""<mujoco><option timestep="{step}" gravity="0 0 0" cone="elliptic" integrator="discrete"
solver="{SOLVER}" impratio="100" tolerance="1e-8" iterations="300"/>
<worldbody>{PLATE.format(contact=contact)}
<flexcomp name="tip" type="direct" dim="3" radius="1e-5" mass="{MASS_OF_TIP}" point="{text(points)}"
element="{' '.join(map(str, tetrahedra.flatten()))}">
<elasticity young="{scene.YOUNG}" poisson="{scene.POISSON}" damping="0.002"/>
<contact selfcollide="none" {contact}/>
<pin id="{' '.join(map(str, bonded))}"/></flexcomp></worldbody></mujoco>""")

    def elements(self, forces):
        return -float(forces[:, 2].sum())


if __name__ == "__main__":
    peer, steps = {"sphere": (Sphere, scene.STEPS), "flex": (Flex, [0.005, 0.0025, 0.00125])}[sys.argv[2]]
    scene.main(f"MuJoCo, {sys.argv[2]}", mujoco.__version__, peer, steps)
