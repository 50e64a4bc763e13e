//! A unit's memory: reads and writes its scalars through their offsets.
//!
//! This is where the export layer relies on the contract of [`Port`](crate::port::Port); everything above it is
//! checked.
#![allow(unsafe_code, reason = "scalars are reached through offsets, one table look-up each")]

use crate::describe::Described;
use crate::library::{Library, SharedDescription, Unit};
use crate::model::{Context, Fault};
use crate::port::FmiEnum;
use crate::slots::{IntegerAccess, Slots};
use crate::visitor::EnumerationAccess;

/// A unit at a fixed address in memory, with the table of its scalars.
pub(crate) struct Body {
    /// From `Box::into_raw`; freed in `drop`.
    unit: *mut dyn Unit,
    described: SharedDescription,
}

impl Body {
    /// A new unit at its start values.
    pub(crate) fn new(library: &'static Library) -> Self {
        let described = library.described();
        let unit = library.make();
        assert!(unit.size() == described.slots.size, "the table of slots belongs to another unit");
        Self { unit: Box::into_raw(unit), described }
    }

    pub(crate) fn described(&self) -> &Described {
        &self.described
    }

    #[inline]
    pub(crate) fn slots(&self) -> &Slots {
        &self.described.slots
    }

    /// Initializes the unit and computes its outputs.
    pub(crate) fn init(&mut self, context: &mut Context) -> Result<(), Fault> {
        self.unit_mut().init(context)?;
        self.outputs(context.start_s)
    }

    /// Computes the outputs and checks that they are finite.
    pub(crate) fn outputs(&mut self, time_s: f64) -> Result<(), Fault> {
        self.unit_mut().outputs(time_s)?;
        let slots = self.slots();
        match slots.computed_reals.iter().find(|&&index| !self.real(index).is_finite()) {
            None => Ok(()),
            Some(&index) => Err(Fault::new(format!("`{}` became {}", slots.reals[index].name, self.real(index)))),
        }
    }

    pub(crate) fn unit(&self) -> &dyn Unit {
        // SAFETY: the pointer owns a live unit; `&self` excludes writers.
        unsafe { &*self.unit }
    }

    pub(crate) fn unit_mut(&mut self) -> &mut dyn Unit {
        // SAFETY: the pointer owns a live unit; `&mut self` excludes other accesses.
        unsafe { &mut *self.unit }
    }

    /// The address of a scalar.
    fn place(&self, offset: usize) -> *mut u8 {
        // SAFETY: `Visitor::note` made sure that the offset lies inside the unit's struct.
        unsafe { self.unit.cast::<u8>().add(offset) }
    }

    #[inline]
    pub(crate) fn real(&self, index: usize) -> f64 {
        // SAFETY: by the contract of `Port` a live `f64` lies at the offset of a Real.
        unsafe { self.place(self.slots().reals[index].offset).cast::<f64>().read() }
    }

    #[inline]
    pub(crate) fn set_real(&mut self, index: usize, value: f64) {
        // SAFETY: as in `real`; `&mut self` excludes other accesses.
        unsafe { self.place(self.slots().reals[index].offset).cast::<f64>().write(value) }
    }

    #[inline]
    pub(crate) fn integer(&self, index: usize) -> i32 {
        let slot = &self.slots().integers[index];
        let place = self.place(slot.offset);
        match &slot.access {
            // SAFETY: by the contract of `Port` a live `i32` lies at the offset of an Integer.
            IntegerAccess::Plain { .. } => unsafe { place.cast::<i32>().read() },
            // SAFETY: by the contract of `Port` a live value of the enumeration lies at its offset.
            IntegerAccess::Enumeration(access) => unsafe { (access.get)(place) },
        }
    }

    /// The caller has checked that the value is one of the slot's.
    #[inline]
    pub(crate) fn set_integer(&mut self, index: usize, value: i32) {
        let slot = &self.slots().integers[index];
        let place = self.place(slot.offset);
        match &slot.access {
            // SAFETY: as in `integer`; `&mut self` excludes other accesses.
            IntegerAccess::Plain { .. } => unsafe { place.cast::<i32>().write(value) },
            IntegerAccess::Enumeration(access) => {
                // SAFETY: as in `integer`; `&mut self` excludes other accesses.
                let written = unsafe { (access.set)(place, value) };
                assert!(written, "{value} was found to be an item of the enumeration before");
            }
        }
    }

    #[inline]
    pub(crate) fn boolean(&self, index: usize) -> bool {
        // SAFETY: by the contract of `Port` a live `bool` lies at the offset of a Boolean.
        unsafe { self.place(self.slots().booleans[index].offset).cast::<bool>().read() }
    }

    #[inline]
    pub(crate) fn set_boolean(&mut self, index: usize, value: bool) {
        // SAFETY: as in `boolean`; `&mut self` excludes other accesses.
        unsafe { self.place(self.slots().booleans[index].offset).cast::<bool>().write(value) }
    }

    pub(crate) fn string(&self, index: usize) -> &str {
        // SAFETY: by the contract of `Port` a live `String` lies at the offset of a String.
        unsafe { &*self.place(self.slots().strings[index].offset).cast::<String>() }
    }

    pub(crate) fn set_string(&mut self, index: usize, value: &str) {
        // SAFETY: as in `string`; `&mut self` excludes other accesses.
        let text = unsafe { &mut *self.place(self.slots().strings[index].offset).cast::<String>() };
        value.clone_into(text);
    }
}

impl Drop for Body {
    fn drop(&mut self) {
        // SAFETY: the pointer came from `Box::into_raw` and is freed once.
        drop(unsafe { Box::from_raw(self.unit) });
    }
}

/// Functions that read and write an enumeration without knowledge of its type.
pub(crate) fn enumeration_access<E: FmiEnum>() -> EnumerationAccess {
    unsafe fn get<E: FmiEnum>(place: *const u8) -> i32 {
        // SAFETY: the caller promises a live value of this type.
        unsafe { place.cast::<E>().read() }.value()
    }
    unsafe fn set<E: FmiEnum>(place: *mut u8, value: i32) -> bool {
        let item = E::from_value(value);
        if let Some(item) = item {
            // SAFETY: the caller promises a live value of this type.
            unsafe { place.cast::<E>().write(item) };
        }
        item.is_some()
    }
    EnumerationAccess { get: get::<E>, set: set::<E>, is_item: |value| E::from_value(value).is_some() }
}
