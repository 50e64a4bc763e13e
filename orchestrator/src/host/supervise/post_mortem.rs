//! The failure of a stepping process that died.

use dsl::scenario::Scenario;
use std::os::unix::process::ExitStatusExt;
use std::process::ExitStatus;
use unit::board::InCall;
use unit::failure::{Cause, Doing, Failure};
use unit::time::seconds;

/// The failure of a process that was in this call, or in none, when it happened.
#[must_use]
pub fn failure(call: Option<InCall>, tick: u64, scenario: &Scenario, cause: Cause) -> Failure {
    let time_s = |tick| Some(seconds(tick, scenario.step_ns));
    let Some(call) = call else {
        return Failure { instance: None, doing: Doing::BetweenCalls, time_s: time_s(tick), cause };
    };
    let instance = scenario.instances.get(call.instance).map(|instance| instance.name.clone());
    let time_s = if call.doing == Doing::Load { None } else { time_s(call.tick) };
    let cause = if call.unwound { Cause::Unwound } else { cause };
    Failure { instance, doing: call.doing, time_s, cause }
}

/// What an exit status says about a process that had not said that it was done.
#[must_use]
pub fn cause_of_death(status: ExitStatus) -> Cause {
    match (status.signal(), status.code()) {
        (Some(signal), _) => Cause::Signal(signal),
        (None, Some(code)) => Cause::Exit(code),
        (None, None) => Cause::Other(format!("the stepping process ended: {status}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::example::scenario;
    use fmi2::calls::Call;

    #[test]
    fn a_process_that_dies_in_a_call_breaks_that_instance() {
        let call = InCall { tick: 1234, instance: 0, doing: Doing::Call(Call::DoStep), unwound: false, count: 99 };
        let failure = failure(Some(call), 1233, &scenario(), cause_of_death(ExitStatus::from_raw(11)));
        assert_eq!(failure.to_string(), "`quad` died of signal 11 (SIGSEGV) in fmi2DoStep at 12.34 s");
    }

    #[test]
    fn an_exit_without_a_reported_end_is_a_failure_even_with_code_0() {
        let call = InCall { tick: 0, instance: 0, doing: Doing::Load, unwound: false, count: 1 };
        let failure = failure(Some(call), 0, &scenario(), cause_of_death(ExitStatus::from_raw(0)));
        assert_eq!(failure.to_string(), "`quad` ended its process (exit code 0) in the loading of its library");
    }

    #[test]
    fn a_note_that_memory_corruption_wrote_names_no_instance() {
        let call = InCall { tick: 7, instance: 5_000_000, doing: Doing::Call(Call::DoStep), unwound: false, count: 1 };
        let failure = failure(Some(call), 7, &scenario(), Cause::Signal(6));
        assert_eq!(failure.instance, None);
    }

    #[test]
    fn a_death_between_calls_names_no_instance() {
        let failure = failure(None, 100, &scenario(), Cause::Signal(9));
        assert_eq!(failure.to_string(), "the stepping process died of signal 9 (SIGKILL) between calls at 1 s");
    }
}
