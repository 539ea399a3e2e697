//! Mechanisms moved by emulated servos.

/// Position and velocity of a servo's horn.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Motion {
    /// Angle from the servo's position 0, rad.
    pub angle: f64,
    /// Angular velocity, rad/s.
    pub velocity: f64,
}

/// Mechanism moved by emulated servos, which are identified by index.
pub trait Plant: Send {
    /// Advances to the time `now`, s. `goals` are the goal velocities of the servos' horns, rad/s.
    fn advance(&mut self, now: f64, goals: &[f64]);

    /// Current motion of the servo with index `servo`.
    fn motion(&self, servo: usize) -> Motion;

    /// Current torque of the mechanism on the horn of the servo with index `servo`, against positive motion, N m. Zero
    /// by default.
    fn load(&self, servo: usize) -> f64 {
        let _ = servo;
        0.0
    }
}

/// A plant with loads that depend on its motion, such as obstacles and weights.
#[derive(Debug, Clone)]
pub struct LoadedPlant<P, F> {
    plant: P,
    load: F,
}

impl<P: Plant, F: Fn(usize, Motion) -> f64 + Send> LoadedPlant<P, F> {
    /// Adds loads to `plant`: the torque of `load` on the horn of the servo with this index, against positive motion, N m.
    pub fn new(plant: P, load: F) -> Self {
        Self { plant, load }
    }
}

impl<P: Plant, F: Fn(usize, Motion) -> f64 + Send> Plant for LoadedPlant<P, F> {
    fn advance(&mut self, now: f64, goals: &[f64]) {
        self.plant.advance(now, goals);
    }

    fn motion(&self, servo: usize) -> Motion {
        self.plant.motion(servo)
    }

    fn load(&self, servo: usize) -> f64 {
        self.plant.load(servo) + (self.load)(servo, self.plant.motion(servo))
    }
}

/// Unloaded servos with a first-order lag.
#[derive(Debug, Clone)]
pub struct LagPlant {
    lag: f64,
    time: f64,
    motions: Vec<Motion>,
}

impl LagPlant {
    /// Creates servos at rest at `angles` (rad), whose velocity follows its goal with the time constant `lag` > 0 (s).
    pub fn new(lag: f64, angles: &[f64]) -> Self {
        let at_rest = |&angle: &f64| Motion {
            angle,
            velocity: 0.0,
        };
        Self {
            lag,
            time: 0.0,
            motions: angles.iter().map(at_rest).collect(),
        }
    }
}

impl Plant for LagPlant {
    fn advance(&mut self, now: f64, goals: &[f64]) {
        let step = (now - self.time).max(0.0);
        self.time = self.time.max(now);
        let remaining = (-step / self.lag).exp();
        for (motion, goal) in self.motions.iter_mut().zip(goals) {
            let error = motion.velocity - goal;
            motion.angle += goal * step + self.lag * (1.0 - remaining) * error;
            motion.velocity = goal + remaining * error;
        }
    }

    fn motion(&self, servo: usize) -> Motion {
        self.motions.get(servo).copied().unwrap_or_default()
    }
}
