//! One unit's library: its properties that do not need an instance.

use crate::describe::{self, Described};
use crate::model::{Context, Fault, Model, Outcome};
use crate::step::Step;
use crate::visitor::{Scalar, Visitor};
use std::any::Any;
use std::ops::Deref;
use std::sync::{Arc, Mutex, PoisonError, Weak};

/// Cargo metadata of the unit's crate; [`export!`](crate::export) fills it in.
#[derive(Clone, Copy, Debug)]
pub struct Package {
    /// Name of the library file without extension.
    pub identifier: &'static str,
    /// Version of the crate.
    pub version: &'static str,
    /// Authors of the crate, separated by colons.
    pub authors: &'static str,
    /// Licence of the crate.
    pub license: &'static str,
}

/// A unit's library: how to create a unit, and its description.
///
/// The description is built for the first instance and freed with the last one, so that nothing of it remains when an
/// importer unloads the library.
#[derive(Debug)]
pub struct Library {
    package: Package,
    make: fn() -> Box<dyn Unit>,
    describe: fn(&Package) -> Described,
    scalars: fn() -> Vec<Scalar>,
    described: Mutex<Weak<Described>>,
}

impl Library {
    /// The library of this model.
    #[must_use]
    pub const fn of<M: Model>(package: Package) -> Self {
        Self {
            package,
            make: || Box::new(M::at_start()),
            describe: describe::describe::<M>,
            scalars: scalars::<M>,
            described: Mutex::new(Weak::new()),
        }
    }

    /// A unit at its start values.
    pub(crate) fn make(&self) -> Box<dyn Unit> {
        (self.make)()
    }

    /// Everything that follows from the declarations.
    pub(crate) fn described(&'static self) -> SharedDescription {
        let mut known = self.described.lock().unwrap_or_else(PoisonError::into_inner);
        let described = known.upgrade().unwrap_or_else(|| {
            let described = Arc::new((self.describe)(&self.package));
            *known = Arc::downgrade(&described);
            described
        });
        SharedDescription { described, _release: Release(self) }
    }

    /// The scalars of the unit, in the order of its description.
    pub(crate) fn scalars(&self) -> Vec<Scalar> {
        (self.scalars)()
    }

    /// `modelDescription.xml`.
    #[must_use]
    pub fn xml(&'static self) -> String {
        self.described().xml.clone()
    }
}

/// A description that is shared by all who hold it.
#[derive(Debug)]
pub(crate) struct SharedDescription {
    // Dropped in this order.
    described: Arc<Described>,
    _release: Release,
}

impl Deref for SharedDescription {
    type Target = Described;

    #[inline]
    fn deref(&self) -> &Described {
        &self.described
    }
}

/// Gives up the memory of a description that nobody holds any more: a `Weak` alone would keep its place.
#[derive(Debug)]
struct Release(&'static Library);

impl Drop for Release {
    fn drop(&mut self) {
        let mut known = self.0.described.lock().unwrap_or_else(PoisonError::into_inner);
        if known.strong_count() == 0 {
            *known = Weak::new();
        }
    }
}

/// A model behind a type-erased interface, so that the C interface is compiled once and not for each unit.
pub(crate) trait Unit: Any + Send {
    fn init(&mut self, context: &mut Context) -> Result<(), Fault>;
    fn step(&mut self, step: Step, context: &mut Context) -> Result<Outcome, Fault>;
    fn outputs(&mut self, time_s: f64) -> Result<(), Fault>;
    fn duplicate(&self) -> Box<dyn Unit>;
    /// Copies the values of another unit of the same type.
    fn copy_from(&mut self, other: &dyn Unit);
    fn to_bytes(&self) -> Result<Vec<u8>, postcard::Error>;
    /// A unit of the same type with these values.
    fn read_from(&self, bytes: &[u8]) -> Result<Box<dyn Unit>, postcard::Error>;
    fn size(&self) -> usize;
}

impl<M: Model> Unit for M {
    fn init(&mut self, context: &mut Context) -> Result<(), Fault> {
        Model::init(self, context)
    }

    fn step(&mut self, step: Step, context: &mut Context) -> Result<Outcome, Fault> {
        Model::step(self, step, context)
    }

    fn outputs(&mut self, time_s: f64) -> Result<(), Fault> {
        Model::outputs(self, time_s)
    }

    fn duplicate(&self) -> Box<dyn Unit> {
        Box::new(self.clone())
    }

    fn copy_from(&mut self, other: &dyn Unit) {
        let other = (other as &dyn Any).downcast_ref::<M>();
        assert!(other.is_some(), "a state holds another type of unit");
        if let Some(other) = other {
            self.clone_from(other);
        }
    }

    fn to_bytes(&self) -> Result<Vec<u8>, postcard::Error> {
        postcard::to_stdvec(self)
    }

    fn read_from(&self, bytes: &[u8]) -> Result<Box<dyn Unit>, postcard::Error> {
        let (model, rest) = postcard::take_from_bytes::<M>(bytes)?;
        if rest.is_empty() { Ok(Box::new(model)) } else { Err(postcard::Error::DeserializeBadEncoding) }
    }

    fn size(&self) -> usize {
        size_of::<M>()
    }
}

/// The scalars of a model, in the order of declaration.
pub(crate) fn scalars<M: Model>() -> Vec<Scalar> {
    Visitor::scalars_of(&mut M::at_start())
}
