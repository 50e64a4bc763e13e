//! Memory that several processes map, as words that are accessed by atomic operations only.

use std::fs::{File, OpenOptions};
use std::io;
use std::os::fd::AsRawFd;
use std::os::unix::fs::OpenOptionsExt;
use std::path::Path;
use std::ptr::{self, NonNull};
use std::sync::atomic::AtomicU64;

/// A mapped range of words; unmapped when dropped.
#[derive(Debug)]
pub(super) struct Mapping {
    start: NonNull<AtomicU64>,
    words: usize,
}

// SAFETY: the memory at `start` stays mapped until the mapping is dropped, and `munmap` may be called from any thread.
unsafe impl Send for Mapping {}
// SAFETY: all access to the memory goes through `words`, which returns atomics only.
unsafe impl Sync for Mapping {}

impl Mapping {
    /// Creates a file of zeros that only its owner may read or write, reserves its blocks on the disk, and maps it.
    pub fn create(path: &Path, words: usize) -> io::Result<Self> {
        let file = OpenOptions::new().read(true).write(true).create_new(true).mode(0o600).open(path)?;
        let bytes = libc::off_t::try_from(words * 8).map_err(io::Error::other)?;
        // `set_len` would leave a hole: on a full disk the first store into it would raise SIGBUS. This reports the
        // error.
        // SAFETY: the call takes no pointers, and `file` keeps the descriptor open.
        match unsafe { libc::posix_fallocate(file.as_raw_fd(), 0, bytes) } {
            0 => Self::shared(&file, words),
            error => Err(io::Error::from_raw_os_error(error)),
        }
    }

    /// Maps the whole of an existing file. The file must not become shorter while it is mapped: no process truncates a
    /// board.
    pub fn open(path: &Path) -> io::Result<Self> {
        let file = OpenOptions::new().read(true).write(true).open(path)?;
        let words = usize::try_from(file.metadata()?.len() / 8).map_err(io::Error::other)?;
        Self::shared(&file, words)
    }

    /// Memory of this process alone, all zeros.
    pub fn private(words: usize) -> io::Result<Self> {
        Self::map(words, libc::MAP_PRIVATE | libc::MAP_ANONYMOUS, -1)
    }

    fn shared(file: &File, words: usize) -> io::Result<Self> {
        Self::map(words, libc::MAP_SHARED, file.as_raw_fd())
    }

    fn map(words: usize, flags: libc::c_int, descriptor: libc::c_int) -> io::Result<Self> {
        let protection = libc::PROT_READ | libc::PROT_WRITE;
        // SAFETY: without an address hint or MAP_FIXED the system chooses an unused range, so no memory that Rust knows
        // is touched. The length fits `isize`, as the caller's layout or the file's length ensures; the system refuses
        // zero.
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
        // `AtomicU64`, and the Rust code of both processes accesses the memory through such references only.
        unsafe { std::slice::from_raw_parts(self.start.as_ptr(), self.words) }
    }
}

impl Drop for Mapping {
    fn drop(&mut self) {
        // SAFETY: this is exactly the range that `map` got, and no reference into it outlives `self`.
        let unmapped = unsafe { libc::munmap(self.start.as_ptr().cast(), self.words * 8) };
        debug_assert_eq!(unmapped, 0, "a mapping is unmapped as it was mapped");
    }
}
