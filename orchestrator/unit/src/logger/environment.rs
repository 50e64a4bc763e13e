//! The assignment of log messages to instances.
//!
//! Units get a number as their environment, not an address. Some units pass another pointer than the one they were
//! given, and some log after their instance was freed: a number is only looked up, so that neither makes us read
//! invalid memory.

use super::LogSink;
use crate::board::Note;
use crate::variable_names::VariableNames;
use fmi2::c::ComponentEnvironment;
use std::collections::BTreeMap;
use std::ptr::without_provenance_mut;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What the logger needs from an instance.
pub struct Environment {
    /// Its index.
    pub instance: usize,
    /// Its name.
    pub name: String,
    /// Holds the tick of the call in progress.
    pub note: Note,
    /// Names of its variables.
    pub names: Arc<VariableNames>,
    /// Receives its messages.
    pub sink: LogSink,
}

/// The last number used, and all live environments by number. The numbers start above small integers, which a unit
/// might pass by mistake. A lock is needed because units may log from any thread.
static LIVE: Mutex<(usize, BTreeMap<usize, Arc<Environment>>)> = Mutex::new((0x10_000, BTreeMap::new()));

fn live() -> MutexGuard<'static, (usize, BTreeMap<usize, Arc<Environment>>)> {
    // A poisoned lock is safe to use: no panic can occur between two changes that belong together.
    LIVE.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Environment {
    /// The environment with this number, else that of an instance with this name, and true. If neither exists: any
    /// environment, so that its sink receives the message, and false. `None` if there is no instance.
    pub fn find(handle: ComponentEnvironment, name: &str) -> Option<(Arc<Self>, bool)> {
        let live = live();
        let environments = &live.1;
        let exact = environments.get(&handle.addr());
        let named = || environments.values().find(|environment| environment.name == name);
        match exact.or_else(named) {
            Some(environment) => Some((Arc::clone(environment), true)),
            None => environments.values().next().map(|any| (Arc::clone(any), false)),
        }
    }
}

/// Registers an environment until it is dropped, which happens after the instance is freed.
#[derive(Debug)]
pub struct Registration(usize);

impl Registration {
    pub fn new(environment: Environment) -> Self {
        let mut live = live();
        live.0 += 1;
        let number = live.0;
        live.1.insert(number, Arc::new(environment));
        Self(number)
    }

    /// The value that the unit gets as its environment.
    pub fn handle(&self) -> ComponentEnvironment {
        without_provenance_mut(self.0)
    }
}

impl Drop for Registration {
    fn drop(&mut self) {
        live().1.remove(&self.0);
    }
}
