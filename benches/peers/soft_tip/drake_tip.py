"""The soft tip in Drake: compliant hydroelastic contact of a sphere with a rigid plate.

The plate moves instead of the tip, by prescribed position and velocity, and its mass of 1 t keeps forces from moving it
within a step. The hydroelastic modulus is fitted to Hertz's force at the last depth. The contact has no tangential
elasticity: the sphere is on joints with Mindlin's shear stiffness and the stiffness in torsion, as implicit position
control. The load is the generalized contact force of the plate; the sensing elements are the triangles of the contact
surface, whose forces are pressure times area.
"""

import math
from importlib.metadata import version

import numpy as np
from pydrake.geometry import (AddCompliantHydroelasticProperties, AddContactMaterial, AddRigidHydroelasticProperties, Box,
                              HydroelasticContactRepresentation, ProximityProperties, Sphere)
from pydrake.math import RigidTransform
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, ContactModel, CoulombFriction
from pydrake.multibody.tree import PdControllerGains, PrismaticJoint, RevoluteJoint, SpatialInertia, UnitInertia
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder

import scene

AXES = {"x": [1, 0, 0], "y": [0, 1, 0], "z": [0, 0, 1]}
TIP_MASS = 1e-3


def modulus():
    """Hydroelastic modulus (Pa) for Hertz's force: integral of E (1 - r / R) over the plate at the last depth."""
    radius, height = scene.RADIUS, scene.RADIUS - scene.DEPTH
    per_modulus = 2 * math.pi * ((radius**2 - height**2) / 2 - (radius**3 - height**3) / (3 * radius))
    return scene.hertz_force(scene.DEPTH) / per_modulus


def chain(plant, instance, base, mass, inertia, axes):
    """A body on one joint per axis; returns body and joints."""
    joints, parent = [], base
    for number, (kind, axis) in enumerate(axes):
        unit = UnitInertia(inertia / mass, inertia / mass, inertia / mass)
        own = mass if number == len(axes) - 1 else 1e-3 * mass
        body = plant.AddRigidBody(f"body{number}", instance, SpatialInertia(own, np.zeros(3), unit))
        joints.append(plant.AddJoint(kind(f"joint{number}", parent.body_frame(), body.body_frame(), AXES[axis])))
        parent = body
    return parent, joints


class Tip:
    def __init__(self, step):
        builder = DiagramBuilder()
        plant, _ = AddMultibodyPlantSceneGraph(builder, step)
        plant.set_contact_model(ContactModel.kHydroelastic)
        plant.set_contact_surface_representation(HydroelasticContactRepresentation.kTriangle)
        plant.mutable_gravity_field().set_gravity_vector(np.zeros(3))
        self.plate, self.tip = (plant.AddModelInstance(name) for name in ("plate", "tip"))
        friction = CoulombFriction(scene.FRICTION, scene.FRICTION)
        body, _ = chain(plant, self.plate, plant.world_body(), 1000.0, 1000.0,
                        [(PrismaticJoint, "x"), (PrismaticJoint, "z"), (RevoluteJoint, "z")])
        rigid = ProximityProperties()
        AddRigidHydroelasticProperties(0.1, rigid)
        AddContactMaterial(1.0, None, friction, rigid)
        plant.RegisterCollisionGeometry(body, RigidTransform([0, 0, -0.01]), Box(0.1, 0.1, 0.02), "plate", rigid)
        inertia = 0.4 * TIP_MASS * scene.RADIUS**2
        body, joints = chain(plant, self.tip, plant.world_body(), TIP_MASS, inertia,
                             [(PrismaticJoint, "x"), (PrismaticJoint, "y"), (RevoluteJoint, "z")])
        soft = ProximityProperties()
        AddCompliantHydroelasticProperties(0.0007, modulus(), soft)
        AddContactMaterial(1.0, None, friction, soft)
        plant.RegisterCollisionGeometry(body, RigidTransform([0, 0, scene.RADIUS]), Sphere(scene.RADIUS), "tip", soft)
        shear, twist = scene.shear_stiffness(), scene.twist_stiffness()
        for joint, stiffness, mass in zip(joints, (shear, shear, twist), (TIP_MASS, TIP_MASS, inertia)):
            actuator = plant.AddJointActuator(joint.name(), joint)
            actuator.set_controller_gains(PdControllerGains(p=stiffness, d=2 * math.sqrt(stiffness * mass)))
        plant.Finalize()
        self.plant = plant
        self.diagram = builder.Build()
        self.simulator = Simulator(self.diagram)
        self.context = plant.GetMyMutableContextFromRoot(self.simulator.get_mutable_context())
        plant.get_desired_state_input_port(self.tip).FixValue(self.context, np.zeros(6))
        self.step, self.steps, self.before = step, 0, np.zeros(3)
        self.simulator.Initialize()

    def advance(self, depth, travel, turn):
        now = np.array([-travel, depth, -turn])
        self.plant.SetPositions(self.context, self.plate, self.before)
        self.plant.SetVelocities(self.context, self.plate, (now - self.before) / self.step)
        self.before = now
        self.steps += 1
        self.simulator.AdvanceTo(self.steps * self.step)

    def read(self):
        force = self.plant.get_generalized_contact_forces_output_port(self.plate).Eval(self.context)
        results = self.plant.get_contact_results_output_port().Eval(self.context)
        elements, radius = 0.0, None
        for number in range(results.num_hydroelastic_contacts()):
            surface = results.hydroelastic_contact_info(number).contact_surface()
            mesh, pressure = surface.tri_mesh_W(), surface.tri_e_MN()
            at = [pressure.EvaluateAtVertex(v) for v in range(mesh.num_vertices())]
            for index, triangle in enumerate(mesh.triangles()):
                corners = [triangle.vertex(c) for c in range(3)]
                elements += surface.area(index) * sum(at[c] for c in corners) / 3
            radius = max(float(np.hypot(*v[:2])) for v in mesh.vertices())
        return {"load": -force[1], "elements": elements, "shear": force[0], "moment": force[2], "radius": radius}


if __name__ == "__main__":
    scene.main("Drake, hydroelastic", version("drake"), Tip)
