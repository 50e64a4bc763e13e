//! Which instance a log message belongs to.
//!
//! Units get a number as their environment, never an address: some hand back another pointer than they were given, some
//! log after their instance is gone, and neither may make us read where nothing is.

use super::LogSink;
use crate::board::Note;
use crate::variable_names::VariableNames;
use fmi2::c::ComponentEnvironment;
use std::collections::BTreeMap;
use std::ptr::without_provenance_mut;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What the logger needs to know about an instance.
pub struct Environment {
    /// Its index.
    pub instance: usize,
    /// Its name.
    pub name: String,
    /// Tells the tick.
    pub note: Note,
    /// Names of its variables.
    pub names: Arc<VariableNames>,
    /// Where its messages go.
    pub sink: LogSink,
}

/// All live environments by number; the numbers start beyond what a unit might hand back by accident.
static LIVE: Mutex<(usize, BTreeMap<usize, Arc<Environment>>)> = Mutex::new((0x10_000, BTreeMap::new()));

fn live() -> MutexGuard<'static, (usize, BTreeMap<usize, Arc<Environment>>)> {
    // Nothing panics between two statements that belong together.
    LIVE.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Environment {
    /// The environment of this number, else that of an instance of this name; if there is none either, any, which still
    /// knows where messages go, and false.
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

/// Keeps an environment findable; dropped after the instance is freed.
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

    /// What the unit gets as its environment.
    pub fn handle(&self) -> ComponentEnvironment {
        without_provenance_mut(self.0)
    }
}

impl Drop for Registration {
    fn drop(&mut self) {
        live().1.remove(&self.0);
    }
}
