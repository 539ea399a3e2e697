//! What a simulated run does around each control step.

use super::truth::SlipMeter;
use super::{Instruments, Sensor, SimulatedLoop, is_finished};
use feeler::control::control_loop::Supervisor;
use feeler::pace::Tick;
use feeler_sim::rig::{SimHand, SimRig};
use std::ops::ControlFlow;

/// Reads the instruments before every step and hands them on after it, until the run is finished.
pub(super) struct InstrumentedRun<'a, F> {
    pub rig: &'a SimRig,
    pub cap: Option<usize>,
    pub slip: &'a mut SlipMeter,
    /// What the instruments read before the step under way.
    pub instruments: Option<Instruments>,
    pub time_limit: f64,
    pub each_step: F,
}

impl<B, F> Supervisor<Sensor, SimHand> for InstrumentedRun<'_, F>
where
    F: FnMut(&mut SimulatedLoop, &Instruments, &Tick) -> ControlFlow<B>,
{
    /// What `each_step` broke with; none where the run was finished.
    type Break = Option<B>;

    fn before_step(&mut self, _: &mut SimulatedLoop, _: &Tick) {
        self.instruments = Some(Instruments::read(self.rig, self.cap, self.slip));
    }

    fn after_step(
        &mut self,
        control_loop: &mut SimulatedLoop,
        tick: &Tick,
    ) -> ControlFlow<Self::Break> {
        if let Some(instruments) = self.instruments.take() {
            (self.each_step)(control_loop, &instruments, tick).map_break(Some)?;
        }
        match is_finished(control_loop, self.time_limit) {
            true => ControlFlow::Break(None),
            false => ControlFlow::Continue(()),
        }
    }
}
