//! Free bodies: rigid-body dynamics and contacts between bodies, by `rapier3d`.
//!
//! The feelers' forces are applied explicitly, at the pose for which they were computed. This is stable if a step is
//! short compared with the oscillation period of the lightest body on the feelers' springs, so a step is divided into
//! as many substeps as necessary.

use super::object::{FreeConfig, Motion, Object};
use super::pose::Pose;
use crate::world::model::WorldModel;
use crate::world::state::{ObjectState, State};
use glam::{DMat3, DQuat, DVec3};
use rapier3d_f64::prelude::{
    CoefficientCombineRule, ColliderBuilder, MassProperties, PhysicsWorld, Pose as LibraryPose,
    RigidBodyBuilder, RigidBodyHandle, SharedShape, SpringCoefficients,
};

/// Maximum product of a substep and the angular frequency of a body on the feelers (rad/s). The integration is stable
/// below 2. The frequency is an upper bound, typically twice the actual one.
const MAX_PHASE: f64 = 1.5;
/// Maximum number of substeps.
const MAX_PARTS: usize = 64;
/// Length unit of rapier's tolerances (m), whose defaults are for bodies of a metre. Bodies here measure a few
/// centimetres.
const LENGTH_UNIT: f64 = 0.01;

/// Softness of contacts with fixed bodies.
const CONTACT: SpringCoefficients<f64> = SpringCoefficients {
    natural_frequency: 1000.0,
    damping_ratio: 5.0,
};

/// The free bodies of a world, and the fixed ones under them.
pub struct FreeBodies {
    world: PhysicsWorld,
    /// Bodies by object; `None` for objects that are not free.
    free: Vec<Option<FreeBody>>,
    /// Objects that turn, with which free bodies collide.
    turning: Vec<(usize, RigidBodyHandle)>,
    /// Fixed objects that the hand's arm moves past the hand.
    passing: Vec<(usize, RigidBodyHandle)>,
}

struct FreeBody {
    handle: RigidBodyHandle,
    /// Mass properties at the start.
    properties: MassProperties,
    /// Current mass (kg).
    mass: f64,
    inverse_mass: f64,
    /// Maximum of the inverse principal moments of inertia (1/(kg m²)).
    inverse_inertia: f64,
}

impl FreeBodies {
    /// Creates the free bodies of `model`, at rest at their start poses. `None` if there are no free objects, as an
    /// empty rapier world takes 40 kB.
    pub fn new(model: &WorldModel) -> Option<Box<Self>> {
        let is_free = |object: &Object| matches!(object.motion, Motion::Free(_));
        if !model.objects.iter().any(is_free) {
            return None;
        }
        let mut world = PhysicsWorld::new();
        world.gravity = model.gravity;
        let parameters = &mut world.integration_parameters;
        parameters.length_unit = LENGTH_UNIT;
        // Recomputes contact points in each step; recycled ones may be off by half a millimetre.
        parameters.contact_recycling = false;
        // Stiff contacts, so that a body neither sinks by a tenth of a millimetre into its table nor creeps along it.
        parameters.static_contact_softness = CONTACT;
        parameters.friction_in_bias_pass = true;
        // One solver iteration per substep. With more, rapier would assume constant feeler forces within a substep,
        // which adds energy; symplectic Euler integration does not.
        parameters.num_solver_iterations = 1;
        parameters.num_internal_stabilization_iterations = 2;
        parameters.normalized_max_linear_velocity = f64::MAX;
        let mut bodies = Box::new(Self {
            world,
            free: Vec::new(),
            turning: Vec::new(),
            passing: Vec::new(),
        });
        for (index, object) in model.objects.iter().enumerate() {
            let free = bodies.add(index, object, !model.arm.is_empty());
            bodies.free.push(free);
        }
        Some(bodies)
    }

    /// Adds an object. Fixed objects move with the arm if `has_arm`.
    fn add(&mut self, index: usize, object: &Object, has_arm: bool) -> Option<FreeBody> {
        let (shape, within) = collider(object);
        let place = LibraryPose::from_translation(object.offset) * within;
        let collider = ColliderBuilder::new(shape).position(place).density(0.0);
        let start = to_library(&object.start);
        let Motion::Free(config) = &object.motion else {
            let turns = matches!(object.motion, Motion::Turns(_));
            let body = match turns || has_arm {
                true => RigidBodyBuilder::kinematic_position_based(),
                false => RigidBodyBuilder::fixed(),
            };
            // The coefficient of the pair equals the free body's.
            let collider = collider
                .friction(1.0)
                .friction_combine_rule(CoefficientCombineRule::Multiply);
            let (handle, _) = self.world.insert(body.pose(start), collider);
            if turns {
                self.turning.push((index, handle));
            } else if has_arm {
                self.passing.push((index, handle));
            }
            return None;
        };
        let mass = mass_properties(object, config);
        let body = RigidBodyBuilder::dynamic()
            .pose(start)
            .can_sleep(false)
            .additional_mass_properties(mass);
        let collider = collider.friction(config.friction);
        let (handle, _) = self.world.insert(body, collider);
        Some(FreeBody {
            handle,
            properties: mass,
            mass: mass.mass(),
            inverse_mass: mass.inv_mass,
            inverse_inertia: mass.inv_principal_inertia.max_element(),
        })
    }

    /// Number of substeps for a step of `model` from `state`.
    ///
    /// The squared highest frequency of a body on springs is at most the sum, over the springs, of the stiffness
    /// divided by the effective mass at the spring.
    pub fn parts(&self, model: &WorldModel, state: &State) -> usize {
        let mut most = 0.0_f64;
        for (index, body) in self.free.iter().enumerate() {
            let Some(body) = body else { continue };
            let centre = state.objects[index].pose.rotation.transpose()
                * (self.world.bodies[body.handle].center_of_mass()
                    - state.objects[index].pose.position);
            let mut sum = 0.0;
            for (finger, own) in model.fingers.iter().zip(&state.fingers) {
                for contact in own.contacts.iter().filter(|c| c.object == index) {
                    let feeler = &finger.feelers[contact.element];
                    let lever = contact.anchor.position - centre;
                    let inverse_mass =
                        body.inverse_mass + body.inverse_inertia * lever.length_squared();
                    // In one substep a damper acts like a spring.
                    let stiffness = feeler.normal_stiffness.max(feeler.shear_stiffness)
                        + 2.0 * feeler.normal_damping.max(feeler.shear_damping) / model.step;
                    sum += inverse_mass * stiffness;
                }
            }
            most = most.max(sum);
        }
        let parts = (model.step * most.sqrt() / MAX_PHASE).ceil();
        (parts as usize).clamp(1, MAX_PARTS)
    }

    /// Updates the bodies' masses to those of `objects`.
    pub fn weigh(&mut self, objects: &[ObjectState]) {
        for (body, object) in self.free.iter_mut().zip(objects) {
            let Some(body) = body else { continue };
            if object.mass == body.mass {
                continue;
            }
            let start = &body.properties;
            let share = object.mass / start.mass();
            let now = MassProperties::with_principal_inertia_frame(
                start.local_com,
                object.mass,
                start.principal_inertia() * share,
                start.principal_inertia_local_frame,
            );
            self.world.bodies[body.handle].set_additional_mass_properties(now, false);
            body.mass = object.mass;
            body.inverse_mass = now.inv_mass;
            body.inverse_inertia = now.inv_principal_inertia.max_element();
        }
    }

    /// Sets the force (N) on a free body and the torque about the object's origin (N·m), both in W.
    pub fn push(&mut self, object: usize, force: DVec3, torque: DVec3) {
        let Some(Some(body)) = self.free.get(object) else {
            return;
        };
        let body = &mut self.world.bodies[body.handle];
        let lever = body.translation() - body.center_of_mass();
        body.reset_forces(false);
        body.reset_torques(false);
        body.add_force(force, true);
        body.add_torque(torque + lever.cross(force), true);
    }

    /// Sets the motion relative to the arm for the next [`advance`](Self::advance): fixed objects move to their poses
    /// in `objects`, and the acceleration `gravity` (m/s², in W) acts on free bodies.
    pub fn carry(&mut self, objects: &[ObjectState], gravity: DVec3) {
        self.world.gravity = gravity;
        for &(index, handle) in &self.passing {
            let pose = to_library(&objects[index].pose);
            self.world.bodies[handle].set_next_kinematic_position(pose);
        }
    }

    /// Integrates the bodies over `duration` (s).
    pub fn advance(&mut self, duration: f64) {
        self.world.integration_parameters.dt = duration;
        self.world.step();
    }

    /// Copies poses of turning objects into rapier, and poses and velocities of free bodies into `objects`.
    pub fn read(&mut self, objects: &mut [ObjectState]) {
        for &(index, handle) in &self.turning {
            let pose = to_library(&objects[index].pose);
            self.world.bodies[handle].set_next_kinematic_position(pose);
        }
        for (body, object) in self.free.iter().zip(objects) {
            let Some(body) = body else { continue };
            let body = &self.world.bodies[body.handle];
            object.pose = Pose {
                position: body.translation(),
                rotation: DMat3::from_quat(*body.rotation()),
            };
            object.velocity = body.linvel();
            object.angular_velocity = body.angvel();
        }
    }
}

/// Collision shape of an object, and its pose in the shape's frame.
///
/// A free mesh collides as its convex hull, as rapier's meshes are surfaces without an inside, which bodies can
/// penetrate. Contacts with feelers use the mesh itself.
pub(crate) fn collider(object: &Object) -> (SharedShape, LibraryPose) {
    let (shape, within) = object.shape.collider();
    let free = matches!(object.motion, Motion::Free(_));
    let mesh = shape.as_trimesh().filter(|_| free);
    let hull = mesh.and_then(|mesh| SharedShape::convex_hull(mesh.vertices()));
    (hull.unwrap_or(shape), within)
}

pub(crate) fn to_library(pose: &Pose) -> LibraryPose {
    LibraryPose::from_parts(pose.position, DQuat::from_mat3(&pose.rotation))
}

/// Mass, centre of mass and inertia of a free body, in the object's frame.
fn mass_properties(object: &Object, config: &FreeConfig) -> MassProperties {
    let at_density = object.shape.mass_properties(config.density);
    let own_mass = at_density.mass();
    let mass = config.mass.unwrap_or(own_mass);
    let centre = at_density.local_com + object.offset;
    match config.inertia {
        Some(inertia) => MassProperties::new(centre, mass, inertia.into()),
        None => MassProperties::with_principal_inertia_frame(
            centre,
            mass,
            at_density.principal_inertia() * (mass / own_mass),
            at_density.principal_inertia_local_frame,
        ),
    }
}
