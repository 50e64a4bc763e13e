//! Initialization: `->` and `=>` carry values along the units' declared dependencies, then the outputs at tick 0.

use super::{Observer, StepLoop};
use crate::flatten::expression::{Moment, evaluate_shared};
use crate::flatten::wiring::InitialCall;
use unit::failure::Failure;

impl<W: Observer> StepLoop<'_, W> {
    /// Makes the calls of initialization in their order and ends it.
    ///
    /// # Errors
    /// A unit refuses, or an initial value is not finite.
    pub(super) fn initialise(&mut self) -> Result<(), Failure> {
        let values = &mut self.visible_shared;
        for call in &self.wiring.initialization {
            match call {
                InitialCall::Set { worker, instance, feed, shared, slots } => {
                    let (slots_used, now) = (shared.iter().copied(), (&self.visible, 0.0));
                    evaluate_shared(&self.wiring.shared, slots_used, now, &mut self.stack, values);
                    let (outputs, rises) = (&self.visible, &self.rises);
                    let moment = Moment { outputs, time_s: 0.0, rises, shared: values };
                    feed.bring(&moment, &mut self.stack, &mut self.inputs);
                    self.workers[*worker].set_initial(*instance, slots, &self.inputs)
                }
                InitialCall::Get { worker, instance, slots } => {
                    self.workers[*worker].get_initial(*instance, slots, &mut self.visible)
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
