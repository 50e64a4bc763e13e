//! Blocks of a message: each has the values of one instance's ports.

use super::{Malformed, length};
use flatten::values::Values;
use flatten::wiring::Ports;

/// The blocks of a received message, read one after the other.
#[derive(Debug)]
pub struct Blocks<'a> {
    rest: &'a [u8],
    remaining: u32,
    /// Number of bytes before `rest`, from which the length of padding follows.
    consumed: usize,
}

pub(super) fn write(bytes: &mut Vec<u8>, instance: usize, ports: &Ports, values: &Values) {
    let (reals, integers) = (&values.reals[ports.reals.range()], &values.integers[ports.integers.range()]);
    let (booleans, texts) = (&values.booleans[ports.booleans.range()], &values.texts[ports.texts.range()]);
    for number in
        [length(instance), 0].into_iter().chain([reals.len(), integers.len(), booleans.len(), texts.len()].map(length))
    {
        bytes.extend(number.to_le_bytes());
    }
    // Chunks of constant length let the compiler copy several values at once.
    for (chunk, value) in append_zeros(bytes, 8 * reals.len()).as_chunks_mut().0.iter_mut().zip(reals) {
        *chunk = value.to_bits().to_le_bytes();
    }
    for (chunk, value) in append_zeros(bytes, 4 * integers.len()).as_chunks_mut().0.iter_mut().zip(integers) {
        *chunk = value.to_le_bytes();
    }
    bytes.extend(booleans.iter().map(|&value| u8::from(value != 0)));
    pad(bytes);
    for text in texts {
        bytes.extend(length(text.len()).to_le_bytes());
        bytes.extend(text.as_bytes());
    }
    pad(bytes);
}

/// Appends so many zeros and returns them, to be overwritten.
fn append_zeros(bytes: &mut Vec<u8>, by: usize) -> &mut [u8] {
    let before = bytes.len();
    bytes.resize(before + by, 0);
    &mut bytes[before..]
}

/// Appends zeros up to a multiple of 8. Every block starts at such a multiple, as the header has 40 bytes.
fn pad(bytes: &mut Vec<u8>) {
    bytes.resize(bytes.len().next_multiple_of(8), 0);
}

impl<'a> Blocks<'a> {
    pub(super) fn new(bytes: &'a [u8], count: u32) -> Self {
        Self { rest: bytes, remaining: count, consumed: 0 }
    }

    /// Reads the next block, which must belong to this instance and have a value for each variable of its ports.
    ///
    /// # Errors
    /// The block is another one or invalid. Some of its values may have been stored by then.
    pub fn read(&mut self, instance: usize, ports: &Ports, values: &mut Values) -> Result<(), Malformed> {
        self.remaining =
            self.remaining.checked_sub(1).ok_or(Malformed::Instance { expected: instance, found: None })?;
        let found = self.word()?;
        if found as usize != instance {
            return Err(Malformed::Instance { expected: instance, found: Some(found) });
        }
        let reserved = self.word()?;
        if reserved != 0 {
            return Err(Malformed::Reserved(reserved));
        }
        for range in [&ports.reals, &ports.integers, &ports.booleans, &ports.texts] {
            if self.word()? as usize != range.variables.len() {
                return Err(Malformed::Counts(instance));
            }
        }
        let reals = &mut values.reals[ports.reals.range()];
        for (value, chunk) in reals.iter_mut().zip(self.slice(8 * ports.reals.variables.len())?.as_chunks().0) {
            *value = f64::from_bits(u64::from_le_bytes(*chunk));
        }
        let integers = &mut values.integers[ports.integers.range()];
        for (value, chunk) in integers.iter_mut().zip(self.slice(4 * ports.integers.variables.len())?.as_chunks().0) {
            *value = i32::from_le_bytes(*chunk);
        }
        for value in &mut values.booleans[ports.booleans.range()] {
            let [byte] = self.take()?;
            *value = if byte <= 1 { i32::from(byte) } else { return Err(Malformed::Boolean(byte)) };
        }
        self.skip_padding()?;
        for value in &mut values.texts[ports.texts.range()] {
            let length = self.word()? as usize;
            let text = std::str::from_utf8(self.slice(length)?).map_err(|_| Malformed::Text)?;
            text.clone_into(value);
        }
        self.skip_padding()
    }

    /// Checks that all blocks and bytes were read.
    ///
    /// # Errors
    /// Some are left.
    pub fn end(&self) -> Result<(), Malformed> {
        if self.remaining == 0 && self.rest.is_empty() { Ok(()) } else { Err(Malformed::LeftOver) }
    }

    fn slice(&mut self, length: usize) -> Result<&'a [u8], Malformed> {
        let (slice, rest) = self.rest.split_at_checked(length).ok_or(Malformed::Short)?;
        self.rest = rest;
        self.consumed += length;
        Ok(slice)
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], Malformed> {
        let (chunk, rest) = self.rest.split_first_chunk().ok_or(Malformed::Short)?;
        self.rest = rest;
        self.consumed += N;
        Ok(*chunk)
    }

    fn word(&mut self) -> Result<u32, Malformed> {
        self.take().map(u32::from_le_bytes)
    }

    fn skip_padding(&mut self) -> Result<(), Malformed> {
        let padding = self.slice(self.consumed.next_multiple_of(8) - self.consumed)?;
        if padding.iter().all(|&byte| byte == 0) { Ok(()) } else { Err(Malformed::LeftOver) }
    }
}
