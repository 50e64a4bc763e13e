//! Blocks of a message: the values of one instance's ports each.

use super::{Malformed, length};
use crate::flatten::values::Values;
use crate::flatten::wiring::Ports;

/// The blocks of a received message, read one after the other.
#[derive(Debug)]
pub struct Blocks<'a> {
    rest: &'a [u8],
    left: u32,
    /// Bytes before `rest`, for padding.
    passed: usize,
}

pub(super) fn write(bytes: &mut Vec<u8>, instance: usize, ports: &Ports, values: &Values) {
    let (reals, integers) = (&values.reals[ports.reals.range()], &values.integers[ports.integers.range()]);
    let (booleans, texts) = (&values.booleans[ports.booleans.range()], &values.texts[ports.texts.range()]);
    for number in
        [length(instance), 0].into_iter().chain([reals.len(), integers.len(), booleans.len(), texts.len()].map(length))
    {
        bytes.extend(number.to_le_bytes());
    }
    // In pieces of known length, which takes several at once.
    for (piece, value) in grown(bytes, 8 * reals.len()).as_chunks_mut().0.iter_mut().zip(reals) {
        *piece = value.to_bits().to_le_bytes();
    }
    for (piece, value) in grown(bytes, 4 * integers.len()).as_chunks_mut().0.iter_mut().zip(integers) {
        *piece = value.to_le_bytes();
    }
    bytes.extend(booleans.iter().map(|&value| u8::from(value != 0)));
    pad(bytes);
    for text in texts {
        bytes.extend(length(text.len()).to_le_bytes());
        bytes.extend(text.as_bytes());
    }
    pad(bytes);
}

/// Room for so many bytes at the end.
fn grown(bytes: &mut Vec<u8>, by: usize) -> &mut [u8] {
    let before = bytes.len();
    bytes.resize(before + by, 0);
    &mut bytes[before..]
}

/// Zeros up to a multiple of 8; what comes before a block is one.
fn pad(bytes: &mut Vec<u8>) {
    bytes.resize(bytes.len().next_multiple_of(8), 0);
}

impl<'a> Blocks<'a> {
    pub(super) fn new(bytes: &'a [u8], count: u32) -> Self {
        Self { rest: bytes, left: count, passed: 0 }
    }

    /// Reads the next block, which must be of this instance and have a value for each of its ports.
    ///
    /// # Errors
    /// It is not; some of the values may have been stored.
    pub fn read(&mut self, instance: usize, ports: &Ports, values: &mut Values) -> Result<(), Malformed> {
        self.left = self.left.checked_sub(1).ok_or(Malformed::Instance { expected: instance, found: None })?;
        let found = self.word()?;
        if found as usize != instance {
            return Err(Malformed::Instance { expected: instance, found: Some(found) });
        }
        let reserved = self.word()?;
        if reserved != 0 {
            return Err(Malformed::Reserved(reserved));
        }
        for span in [&ports.reals, &ports.integers, &ports.booleans, &ports.texts] {
            if self.word()? as usize != span.references.len() {
                return Err(Malformed::Counts(instance));
            }
        }
        let reals = &mut values.reals[ports.reals.range()];
        for (value, piece) in reals.iter_mut().zip(self.slice(8 * ports.reals.references.len())?.as_chunks().0) {
            *value = f64::from_bits(u64::from_le_bytes(*piece));
        }
        let integers = &mut values.integers[ports.integers.range()];
        for (value, piece) in integers.iter_mut().zip(self.slice(4 * ports.integers.references.len())?.as_chunks().0) {
            *value = i32::from_le_bytes(*piece);
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

    /// There are no more blocks, and nothing is left over.
    ///
    /// # Errors
    /// There is more.
    pub fn end(&self) -> Result<(), Malformed> {
        if self.left == 0 && self.rest.is_empty() { Ok(()) } else { Err(Malformed::LeftOver) }
    }

    fn slice(&mut self, length: usize) -> Result<&'a [u8], Malformed> {
        let (slice, rest) = self.rest.split_at_checked(length).ok_or(Malformed::Short)?;
        self.rest = rest;
        self.passed += length;
        Ok(slice)
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], Malformed> {
        let (chunk, rest) = self.rest.split_first_chunk().ok_or(Malformed::Short)?;
        self.rest = rest;
        self.passed += N;
        Ok(*chunk)
    }

    fn word(&mut self) -> Result<u32, Malformed> {
        self.take().map(u32::from_le_bytes)
    }

    fn skip_padding(&mut self) -> Result<(), Malformed> {
        let padding = self.slice(self.passed.next_multiple_of(8) - self.passed)?;
        if padding.iter().all(|&byte| byte == 0) { Ok(()) } else { Err(Malformed::LeftOver) }
    }
}
