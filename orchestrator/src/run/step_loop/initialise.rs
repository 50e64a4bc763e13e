//! Initialization: both arrows carry values along the units' declared dependencies, then the outputs at tick 0.

use super::{Observer, StepLoop};
use crate::flatten::expression::Moment;
use crate::flatten::wiring::InitialCall;
use unit::failure::Failure;

impl<W: Observer> StepLoop<'_, W> {
    /// Takes the turns of initialization in order and ends it.
    ///
    /// # Errors
    /// A unit refuses, or an initial value is no number.
    pub(super) fn initialise(&mut self) -> Result<(), Failure> {
        for turn in &mut self.wiring.initialization {
            match turn {
                InitialCall::Set { worker, instance, feed, picks } => {
                    feed.bring(&Moment { outputs: &self.visible, time_s: 0.0, rises: &self.rises }, &mut self.inputs);
                    self.workers[*worker].set_initial(*instance, picks, &self.inputs)
                }
                InitialCall::Get { worker, instance, picks } => {
                    self.workers[*worker].get_initial(*instance, picks, &mut self.visible)
                }
            }
            .map_err(|lost| lost.failure)?;
        }
        for worker in &mut self.workers {
            worker.start(&mut self.visible).map_err(|lost| lost.failure)?;
        }
        self.latest.clone_from(&self.visible);
        self.refuse_non_finite(|_| Some(0))
    }
}
