//! Readings of the instruments around each control step of a simulated run.

use super::truth::SlipMeter;
use crate::experiment::{AnyHand, Instruments, Sensor, SimulatedLoop, is_finished};
use feeler::control::Supervisor;
use feeler::pace::Tick;
use feeler_sim::rig::SimRig;
use std::ops::ControlFlow;

/// Reads the instruments before every step, or after it if the world advances independently, and passes them to
/// `each_step` until the run is finished.
pub(super) struct InstrumentedRun<'a, F> {
    pub rig: &'a SimRig,
    pub cap: Option<usize>,
    pub slip: &'a mut SlipMeter,
    /// `true` if the world advances independently. The readings then match the time of the forces only right after
    /// these were measured.
    pub is_driven: bool,
    /// Readings before the current step.
    pub instruments: Option<Instruments>,
    pub time_limit: f64,
    pub each_step: F,
}

impl<B, F> Supervisor<Sensor, AnyHand> for InstrumentedRun<'_, F>
where
    F: FnMut(&mut SimulatedLoop, &Instruments, &Tick) -> ControlFlow<B>,
{
    /// Value with which `each_step` broke. `None` if the run was finished.
    type Break = Option<B>;

    fn before_step(&mut self, _: &mut SimulatedLoop, _: &Tick) {
        if !self.is_driven {
            self.instruments = Some(Instruments::read(self.rig, self.cap, self.slip));
        }
    }

    fn after_step(
        &mut self,
        control_loop: &mut SimulatedLoop,
        tick: &Tick,
    ) -> ControlFlow<Self::Break> {
        if self.is_driven {
            self.instruments = Some(Instruments::read(self.rig, self.cap, self.slip));
        }
        if let Some(instruments) = self.instruments.take() {
            (self.each_step)(control_loop, &instruments, tick).map_break(Some)?;
        }
        match is_finished(control_loop, self.time_limit) {
            true => ControlFlow::Break(None),
            false => ControlFlow::Continue(()),
        }
    }
}
