//! Initialization: `->` and `=>` carry values along the units' declared dependencies, then the outputs at tick 0.

use super::{Observer, State, StepLoop};
use flatten::expression::{Moment, evaluate_shared};
use flatten::wiring::InitialCall;
use unit::failure::Failure;

impl<W: Observer> StepLoop<'_, W> {
    /// Makes the calls of initialization in their order and ends it.
    ///
    /// # Errors
    /// A unit refuses, or an initial value is not finite.
    pub(super) fn initialise(&mut self) -> Result<(), Failure> {
        let Self { plan, state, workers, stack, observer, .. } = self;
        let State { visible, visible_shared, inputs, carried, unreported, .. } = state;
        for call in &plan.initialization {
            match call {
                InitialCall::Set { worker, instance, feed, shared, slots, limited } => {
                    let now = (&*visible, 0.0);
                    evaluate_shared(&plan.shared, shared.iter().copied(), now, stack, visible_shared);
                    let (outputs, rises) = (&*visible, carried.rises.as_slice());
                    feed.bring(&Moment { outputs, time_s: 0.0, rises, shared: visible_shared }, stack, inputs);
                    for (index, input) in limited.iter().map(|&index| (index, &plan.limits.all[index])) {
                        if let Some(value) = input.missed(inputs) {
                            observer.missed_limits(input, value, 0);
                            unreported.iter_mut().for_each(|group| group.retain(|&other| other != index));
                        }
                    }
                    workers[*worker].set_initial(*instance, slots, inputs)
                }
                InitialCall::Get { worker, instance, slots } => workers[*worker].get_initial(*instance, slots, visible),
                InitialCall::GetInputs { worker, instance, slots } => {
                    workers[*worker].get_initial(*instance, slots, inputs)
                }
            }
            .map_err(|lost| lost.failure)?;
        }
        state.initial_inputs.clone_from(inputs);
        for worker in workers {
            worker.start(visible).map_err(|lost| lost.failure)?;
        }
        state.latest.clone_from(&state.visible);
        self.refuse_non_finite(|_| Some(0))
    }
}
