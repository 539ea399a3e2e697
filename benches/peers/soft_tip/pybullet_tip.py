"""The soft tip in PyBullet: a rigid sphere with a soft contact.

The plate moves instead of the tip, by prescribed pose and velocity; its mass of 1 t keeps forces from moving it within a
step. The contact stiffness is fitted to Hertz's force at the last depth; spinning friction is Hertz's limit there. The
contact has no tangential elasticity: the sphere is on joints with springs of Mindlin's shear stiffness and of the
stiffness in torsion, applied as joint forces. The load is the normal force of the contact points, the only output.
"""

import math
from importlib.metadata import version

import numpy as np
import pybullet as p

import scene

TIP_MASS = 0.05


class Tip:
    def __init__(self, step, stiffness=None):
        stiffness = stiffness or fitted()
        p.resetSimulation()
        p.setGravity(0, 0, 0)
        p.setTimeStep(step)
        p.setPhysicsEngineParameter(numSolverIterations=200, numSubSteps=0, solverResidualThreshold=1e-12)
        box = p.createCollisionShape(p.GEOM_BOX, halfExtents=[0.05, 0.05, 0.01])
        self.plate = p.createMultiBody(1000.0, box, basePosition=[0, 0, -0.01])
        ball = p.createCollisionShape(p.GEOM_SPHERE, radius=scene.RADIUS)
        inertia = 0.4 * TIP_MASS * scene.RADIUS**2
        self.tip = p.createMultiBody(
            0.0, basePosition=[0, 0, scene.RADIUS], linkMasses=[1e-4, 1e-4, TIP_MASS],
            linkCollisionShapeIndices=[-1, -1, ball], linkVisualShapeIndices=[-1] * 3, linkPositions=[[0, 0, 0]] * 3,
            linkOrientations=[[0, 0, 0, 1]] * 3, linkInertialFramePositions=[[0, 0, 0]] * 3,
            linkInertialFrameOrientations=[[0, 0, 0, 1]] * 3, linkParentIndices=[0, 1, 2],
            linkJointTypes=[p.JOINT_PRISMATIC, p.JOINT_PRISMATIC, p.JOINT_REVOLUTE],
            linkJointAxis=[[1, 0, 0], [0, 1, 0], [0, 0, 1]])
        damping = 2 * math.sqrt(stiffness * TIP_MASS)
        torsional = 3 * math.pi / 16 * scene.FRICTION * scene.hertz_radius(scene.DEPTH)
        # Bullet multiplies the friction of both bodies, and adds spinning friction times the other body's friction.
        # Several values in one call are not all applied to a link.
        for body, link, own, spin in ((self.plate, -1, 1.0, 0.0), (self.tip, 2, scene.FRICTION, torsional)):
            p.changeDynamics(body, link, linearDamping=0, angularDamping=0)
            p.changeDynamics(body, link, lateralFriction=own)
            p.changeDynamics(body, link, spinningFriction=spin)
            p.changeDynamics(body, link, contactStiffness=2 * stiffness, contactDamping=2 * damping)
            now = p.getDynamicsInfo(body, link)
            if not (math.isclose(now[1], own) and math.isclose(now[9], 2 * stiffness)):
                raise ValueError(f"expected friction {own} and stiffness {2 * stiffness}, got {now}")
        for joint in range(3):
            p.changeDynamics(self.tip, joint, jointDamping=0)
            p.setJointMotorControl2(self.tip, joint, p.VELOCITY_CONTROL, force=0)
        springs = (scene.shear_stiffness(), scene.shear_stiffness(), scene.twist_stiffness())
        self.springs = [(k, 0.2 * math.sqrt(k * m)) for k, m in zip(springs, (TIP_MASS, TIP_MASS, inertia))]
        self.step, self.before = step, np.zeros(3)

    def advance(self, depth, travel, turn):
        now = np.array([-travel, depth, -turn])
        x, z, angle = self.before
        turned = p.getQuaternionFromEuler([0, 0, angle])
        p.resetBasePositionAndOrientation(self.plate, [x, 0, z - 0.01], turned)
        vx, vz, spin = (now - self.before) / self.step
        p.resetBaseVelocity(self.plate, [vx, 0, vz], [0, 0, spin])
        self.before = now
        self.pulled = []
        for joint, (stiffness, damping) in enumerate(self.springs):
            place, speed = p.getJointState(self.tip, joint)[:2]
            force = -stiffness * place - damping * speed
            self.pulled.append(force)
            p.setJointMotorControl2(self.tip, joint, p.TORQUE_CONTROL, force=force)
        p.stepSimulation()

    def read(self):
        load, shear = 0.0, np.zeros(3)
        for contact in p.getContactPoints(self.plate, self.tip):
            load += contact[9]
            shear += contact[10] * np.array(contact[11]) + contact[12] * np.array(contact[13])
        # At rest the springs balance friction; the contact's own moment is not reported.
        return {"load": load, "elements": None, "shear": self.pulled[0], "moment": self.pulled[2], "radius": None,
                "reported_shear": float(shear[0])}


def fitted():
    """Contact stiffness (N/m) for Hertz's force at the last depth, by two secant steps."""
    stiffness = scene.hertz_force(scene.DEPTH) / scene.DEPTH
    for _ in range(3):
        tip = Tip(0.001, stiffness)
        for n in range(400):
            tip.advance(min(scene.DEPTH, 1e-5 * n), 0.0, 0.0)
        stiffness *= scene.hertz_force(scene.DEPTH) / tip.read()["load"]
    return stiffness


if __name__ == "__main__":
    p.connect(p.DIRECT)
    STIFFNESS = fitted()
    scene.main("PyBullet", version("pybullet"), lambda step: Tip(step, STIFFNESS))
