"""The soft tip in Newton: tetrahedra in the solver VBD, on the CPU.

The bonded points move as the holder does; the plate is fixed. The load is the sum of the contact wrenches that the
solver exports per contact; a second, independent sum is not available. Friction is regularized below the speed
`FRICTION_SPEED`.
"""

from importlib.metadata import version

import newton
import numpy as np
import warp as wp

import mesh
import scene

DENSITY = 1000.0
CONTACT_STIFFNESS = 1e4
FRICTION_SPEED = 1e-4
PARTICLE_RADIUS = 1e-4
ITERATIONS = 30


class Tip:
    def __init__(self, step, across=13, layers=6):
        points, tetrahedra, self.bonded = mesh.tip(across, layers)
        points = points + [0, 0, PARTICLE_RADIUS]
        shear = scene.SHEAR_MODULUS
        lame = scene.YOUNG * scene.POISSON / ((1 + scene.POISSON) * (1 - 2 * scene.POISSON))
        builder = newton.ModelBuilder()
        material = newton.ModelBuilder.ShapeConfig(mu=scene.FRICTION, ke=CONTACT_STIFFNESS, kd=0.0)
        builder.add_shape_box(-1, xform=wp.transform((0, 0, -0.01), wp.quat_identity()), hx=0.05, hy=0.05, hz=0.01, cfg=material)
        builder.add_soft_mesh(pos=wp.vec3(0), rot=wp.quat_identity(), scale=1.0, vel=wp.vec3(0),
                              vertices=[wp.vec3(*p) for p in points], indices=tetrahedra.flatten().tolist(), density=DENSITY,
                              k_mu=shear, k_lambda=lame, k_damp=1e-3, particle_radius=PARTICLE_RADIUS)
        for point in self.bonded:
            builder.particle_mass[point] = 0.0
            builder.particle_flags[point] = int(builder.particle_flags[point]) & ~int(newton.ParticleFlags.ACTIVE)
        builder.color()
        self.model = builder.finalize(device="cpu")
        self.model.set_gravity((0.0, 0.0, 0.0))
        self.model.soft_contact_ke, self.model.soft_contact_kd = CONTACT_STIFFNESS, 0.0
        self.model.soft_contact_mu = scene.FRICTION
        self.pipeline = newton.CollisionPipeline(self.model)
        self.contacts = self.pipeline.contacts()
        self.solver = newton.solvers.SolverVBD(self.model, iterations=ITERATIONS, particle_enable_self_contact=False,
                                               friction_epsilon=FRICTION_SPEED)
        self.seen = self.solver.observables({"contact_f"}, contacts=self.contacts)
        self.states = [self.model.state(), self.model.state()]
        self.rest, self.step, self.travel = points[self.bonded], step, 0.0
        self.control = self.model.control()

    def advance(self, depth, travel, turn):
        now, after = self.states
        places = now.particle_q.numpy()
        c, s = np.cos(turn), np.sin(turn)
        x, y, z = self.rest.T
        places[self.bonded] = np.column_stack([c * x - s * y + travel, s * x + c * y, z - depth])
        now.particle_q.assign(places)
        self.travel = travel
        self.pipeline.collide(now, self.contacts)
        self.solver.step(now, after, self.control, self.contacts, self.step, observables=self.seen)
        self.states = [after, now]

    def read(self):
        first = self.contacts.rigid_contact_max
        wrench = self.seen.contact_f.numpy()[first:]
        force, torque = wrench[:, :3].astype(float), wrench[:, 3:].astype(float)
        total = force.sum(0)
        touching = force[:, 2] < 0
        points = self.contacts.soft_contact_indices.numpy()[: len(force)][touching, 0]
        places = self.states[0].particle_q.numpy()[points]
        radius = np.hypot(places[:, 0] - self.travel, places[:, 1]).max() if touching.any() else None
        return {"load": float(-total[2]), "elements": None, "shear": float(total[0]),
                "moment": float(torque[:, 2].sum() - self.travel * total[1]), "radius": None if radius is None else float(radius)}


if __name__ == "__main__":
    scene.main("Newton, VBD", version("newton"), Tip, scene.COARSE_STEPS)
