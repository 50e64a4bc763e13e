//! Get and set calls: all value references and values are checked before any is written.

use crate::instance::Instance;
use crate::refusal::Refusal;
use crate::slots::{IntegerAccess, IntegerSlot, RealSlot, Settable};
use fmi2::c::{self, Status};
use fmi2::calls::State;
use std::ffi::{CStr, CString};
use std::mem::MaybeUninit;

impl Instance {
    pub(crate) fn get_reals(&mut self, references: &[u32], values: &mut [MaybeUninit<f64>]) -> Result<Status, Refusal> {
        let status = self.refresh()?;
        check(references, "Real", self.body.slots().reals.len())?;
        for (&reference, value) in references.iter().zip(values) {
            value.write(self.body.real(reference as usize));
        }
        Ok(status)
    }

    pub(crate) fn get_integers(
        &mut self,
        references: &[u32],
        values: &mut [MaybeUninit<i32>],
    ) -> Result<Status, Refusal> {
        let status = self.refresh()?;
        check(references, "Integer", self.body.slots().integers.len())?;
        for (&reference, value) in references.iter().zip(values) {
            value.write(self.body.integer(reference as usize));
        }
        Ok(status)
    }

    pub(crate) fn get_booleans(
        &mut self,
        references: &[u32],
        values: &mut [MaybeUninit<c::Boolean>],
    ) -> Result<Status, Refusal> {
        let status = self.refresh()?;
        check(references, "Boolean", self.body.slots().booleans.len())?;
        for (&reference, value) in references.iter().zip(values) {
            value.write(c::Boolean::from(self.body.boolean(reference as usize)));
        }
        Ok(status)
    }

    /// The texts are valid until the next get of the same String or until the instance is freed.
    pub(crate) fn get_strings(
        &mut self,
        references: &[u32],
        values: &mut [MaybeUninit<c::Str>],
    ) -> Result<Status, Refusal> {
        let status = self.refresh()?;
        check(references, "String", self.body.slots().strings.len())?;
        for &reference in references {
            let text = self.body.string(reference as usize).replace('\0', "");
            let Ok(text) = CString::new(text) else { unreachable!("all zero bytes were taken out") };
            let held = &mut self.texts[reference as usize];
            if *held != text {
                *held = text;
            }
        }
        for (&reference, value) in references.iter().zip(values) {
            value.write(self.texts[reference as usize].as_ptr());
        }
        Ok(status)
    }

    pub(crate) fn set_reals(&mut self, references: &[u32], values: &[f64]) -> Result<Status, Refusal> {
        let (slots, state) = (self.body.slots(), self.progress.state);
        check(references, "Real", slots.reals.len())?;
        for (&reference, &value) in references.iter().zip(values) {
            let slot = &slots.reals[reference as usize];
            // A slot without declared bounds has those of the finite numbers, so that NaN and infinities fail here.
            if !(slot.settable.in_state(state) && slot.min <= value && value <= slot.max) {
                return Err(why_not_real(slot, value, state));
            }
        }
        for (&reference, &value) in references.iter().zip(values) {
            self.body.set_real(reference as usize, value);
        }
        Ok(self.touched())
    }

    pub(crate) fn set_integers(&mut self, references: &[u32], values: &[i32]) -> Result<Status, Refusal> {
        let (slots, state) = (self.body.slots(), self.progress.state);
        check(references, "Integer", slots.integers.len())?;
        for (&reference, &value) in references.iter().zip(values) {
            check_integer(&slots.integers[reference as usize], value, state)?;
        }
        for (&reference, &value) in references.iter().zip(values) {
            self.body.set_integer(reference as usize, value);
        }
        Ok(self.touched())
    }

    pub(crate) fn set_booleans(&mut self, references: &[u32], values: &[c::Boolean]) -> Result<Status, Refusal> {
        let slots = self.body.slots();
        check(references, "Boolean", slots.booleans.len())?;
        for &reference in references {
            let slot = &slots.booleans[reference as usize];
            self.check_settable(slot.settable, &slot.name)?;
        }
        for (&reference, &value) in references.iter().zip(values) {
            self.body.set_boolean(reference as usize, value != c::FALSE);
        }
        Ok(self.touched())
    }

    pub(crate) fn set_strings(&mut self, references: &[u32], values: &[&CStr]) -> Result<Status, Refusal> {
        let slots = self.body.slots();
        check(references, "String", slots.strings.len())?;
        let mut texts = Vec::with_capacity(values.len());
        for (&reference, value) in references.iter().zip(values) {
            let slot = &slots.strings[reference as usize];
            self.check_settable(slot.settable, &slot.name)?;
            texts.push(value.to_str().map_err(|_| Refusal::NotUtf8 { port: slot.name.clone() })?);
        }
        for (&reference, text) in references.iter().zip(texts) {
            self.body.set_string(reference as usize, text);
        }
        Ok(self.touched())
    }

    fn check_settable(&self, settable: Settable, port: &str) -> Result<(), Refusal> {
        let state = self.progress.state;
        if settable.in_state(state) { Ok(()) } else { Err(Refusal::NotSettable { port: port.to_owned(), state }) }
    }

    /// Marks the outputs as outdated where they follow the values that are set.
    #[inline]
    fn touched(&mut self) -> Status {
        self.progress.stale = matches!(self.progress.state, State::InitializationMode | State::StepComplete);
        Status::Ok
    }
}

#[inline]
fn check(references: &[u32], base_type: &'static str, count: usize) -> Result<(), Refusal> {
    match references.iter().find(|&&reference| reference as usize >= count) {
        None => Ok(()),
        Some(&reference) => Err(Refusal::NoSuchPort { base_type, reference, count }),
    }
}

#[cold]
fn why_not_real(slot: &RealSlot, value: f64, state: State) -> Refusal {
    let &RealSlot { min, max, settable, .. } = slot;
    let port = slot.name.clone();
    if !settable.in_state(state) {
        Refusal::NotSettable { port, state }
    } else if !value.is_finite() {
        Refusal::NotFinite { port, value }
    } else {
        Refusal::OutOfBounds { port, value, min, max }
    }
}

fn check_integer(slot: &IntegerSlot, value: i32, state: State) -> Result<(), Refusal> {
    let port = || slot.name.clone();
    if !slot.settable.in_state(state) {
        return Err(Refusal::NotSettable { port: port(), state });
    }
    match &slot.access {
        IntegerAccess::Plain { min, max } if !(min..=max).contains(&&value) => {
            let [value, min, max] = [value, *min, *max].map(f64::from);
            Err(Refusal::OutOfBounds { port: port(), value, min, max })
        }
        IntegerAccess::Enumeration(access) if !(access.is_item)(value) => {
            Err(Refusal::NoSuchItem { port: port(), value })
        }
        _ => Ok(()),
    }
}
