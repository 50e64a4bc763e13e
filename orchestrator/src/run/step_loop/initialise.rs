//! Initialization: `->` and `=>` carry values along the units' declared dependencies, then the outputs at the first tick.

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
        let start_s = plan.seconds(plan.start_tick);
        for call in &plan.initialization {
            match call {
                InitialCall::Set { worker, instance, feed, shared, slots, limited } => {
                    let now = (&*visible, start_s);
                    evaluate_shared(&plan.shared, shared.iter().copied(), now, stack, visible_shared);
                    let (outputs, rises) = (&*visible, carried.conditions.rises());
                    feed.bring(&Moment { outputs, time_s: start_s, rises, shared: visible_shared }, stack, inputs);
                    for (index, input) in limited.iter().map(|&index| (index, &plan.limits.all[index])) {
                        if let Some(value) = input.missed(inputs) {
                            observer.missed_limits(input, value, plan.start_tick);
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
        plan.events.begin(&mut carried.events, inputs);
        for worker in workers {
            worker.start(visible).map_err(|lost| lost.failure)?;
        }
        state.latest.clone_from(&state.visible);
        self.refuse_non_finite(|_| Some(self.plan.start_tick))
    }
}
