//! Memory that several processes map, as words that are only ever touched atomically.

use std::fs::{File, OpenOptions};
use std::io;
use std::os::fd::AsRawFd;
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;
use std::ptr::{self, NonNull};
use std::sync::atomic::AtomicU64;

/// A mapped stretch of words; unmapped when dropped.
#[derive(Debug)]
pub(super) struct Mapping {
    start: NonNull<AtomicU64>,
    words: usize,
}

// SAFETY: the memory behind `start` belongs to the mapping until it is dropped, whichever thread that happens on.
unsafe impl Send for Mapping {}
// SAFETY: all access to it goes through `words`, which hands out atomics only.
unsafe impl Sync for Mapping {}

impl Mapping {
    /// Makes a file of zeros for its owner's eyes only, with its blocks reserved, and maps it.
    pub fn create(path: &Path, words: usize) -> io::Result<Self> {
        let file = OpenOptions::new().read(true).write(true).create_new(true).mode(0o600).open(path)?;
        let bytes = libc::off_t::try_from(words * 8).map_err(io::Error::other)?;
        // A full disk must show here, not as SIGBUS at the first store.
        // SAFETY: a call without pointers, on a descriptor that `file` keeps open.
        match unsafe { libc::posix_fallocate(file.as_raw_fd(), 0, bytes) } {
            0 => Self::shared(&file, words),
            error => Err(io::Error::from_raw_os_error(error)),
        }
    }

    /// Maps the whole of an existing file.
    pub fn open(path: &Path) -> io::Result<Self> {
        let file = OpenOptions::new().read(true).write(true).open(path)?;
        let words = usize::try_from(file.metadata()?.len() / 8).map_err(io::Error::other)?;
        Self::shared(&file, words)
    }

    /// Memory of this process alone.
    pub fn private(words: usize) -> io::Result<Self> {
        Self::map(words, libc::MAP_PRIVATE | libc::MAP_ANONYMOUS, -1)
    }

    fn shared(file: &File, words: usize) -> io::Result<Self> {
        Self::map(words, libc::MAP_SHARED, file.as_raw_fd())
    }

    fn map(words: usize, flags: libc::c_int, descriptor: libc::c_int) -> io::Result<Self> {
        let protection = libc::PROT_READ | libc::PROT_WRITE;
        // SAFETY: the system picks a fresh place, so no memory that Rust knows is touched; the length fits `isize`, as
        // the caller's layout or the file's length says, and zero is refused by the system.
        let start = unsafe { libc::mmap(ptr::null_mut(), words * 8, protection, flags, descriptor, 0) };
        if start == libc::MAP_FAILED {
            return Err(io::Error::last_os_error());
        }
        let start = NonNull::new(start.cast()).ok_or_else(|| io::Error::other("mapped at address zero"))?;
        Ok(Self { start, words })
    }

    /// The words. Another process may change any of them at any time.
    #[inline]
    pub fn words(&self) -> &[AtomicU64] {
        // SAFETY: `start` is page-aligned and mapped for `words` words while `self` lives; every bit pattern is a valid
        // `AtomicU64`, and both processes access the memory through such references only.
        unsafe { std::slice::from_raw_parts(self.start.as_ptr(), self.words) }
    }
}

impl Drop for Mapping {
    fn drop(&mut self) {
        // SAFETY: exactly what `map` got, and no reference into it outlives `self`.
        let unmapped = unsafe { libc::munmap(self.start.as_ptr().cast(), self.words * 8) };
        debug_assert_eq!(unmapped, 0, "a mapping is unmapped as it was mapped");
    }
}
