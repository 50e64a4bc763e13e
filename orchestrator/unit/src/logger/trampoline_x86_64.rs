//! The variadic logger callback for x86-64 with the System V calling convention.
//!
//! FMI 2.0 defines the logger as a variadic function, and Rust 1.95 cannot define one. The trampoline is a few
//! instructions of assembly: they save the registers that may hold variable arguments, build a `va_list` for them on
//! the stack as section 3.5.7 of the convention defines it, and pass its address to [`handle`] as the sixth argument.

use super::deliver;
use super::format::{self, Argument};
use fmi2::c::{CallbackLogger, ComponentEnvironment, RawStatus, Str};
use std::arch::naked_asm;
use std::ffi::{CStr, c_char, c_int, c_void};

/// The function that units get as `logger`.
// SAFETY: the convention passes the five named arguments of a variadic function in the registers in which `handle`
// expects them, and the trampoline finds the variable ones where the convention puts them.
pub const LOGGER: CallbackLogger = unsafe { std::mem::transmute(trampoline as *const c_void) };

/// `va_list` of the convention. C functions take a pointer to it and advance its offsets.
#[derive(Clone, Copy)]
#[repr(C)]
struct VaList {
    gp_offset: u32,
    fp_offset: u32,
    overflow_arg_area: *mut c_void,
    reg_save_area: *mut c_void,
}

impl VaList {
    /// The next argument, advanced past it, as section 3.5.7 of the convention defines it; 0 unless it is an integer.
    ///
    /// # Safety
    /// The list has such an argument next.
    unsafe fn next(&mut self, argument: Argument) -> c_int {
        const GENERAL_END: u32 = 48;
        const VECTOR_END: u32 = 176;
        let (size, alignment) = match argument {
            Argument::Integer if self.gp_offset < GENERAL_END => {
                let offset = self.gp_offset as usize;
                self.gp_offset += 8;
                // SAFETY: the register save area holds the general registers up to offset 48.
                return unsafe { self.reg_save_area.byte_add(offset).cast::<c_int>().read() };
            }
            Argument::Real if self.fp_offset < VECTOR_END => {
                self.fp_offset += 16;
                return 0;
            }
            Argument::Integer | Argument::Real => (8, 8),
            Argument::LongReal => (16, 16),
        };
        let at = self.overflow_arg_area;
        let at = at.wrapping_byte_add(at.cast::<u8>().align_offset(alignment));
        self.overflow_arg_area = at.wrapping_byte_add(size);
        match argument {
            // SAFETY: guaranteed by the caller.
            Argument::Integer => unsafe { at.cast::<c_int>().read() },
            Argument::Real | Argument::LongReal => 0,
        }
    }
}

unsafe extern "C" {
    fn vsnprintf(buffer: *mut c_char, length: usize, format: Str, arguments: *mut VaList) -> c_int;
}

/// On entry the stack pointer is 8 bytes off a multiple of 16, because the call pushed the return address. A frame of
/// 216 bytes aligns it again, as the `movaps` instructions and the call need. In the frame: `va_list` at 0, saved
/// registers from 32 to 208.
#[unsafe(naked)]
unsafe extern "C" fn trampoline() {
    naked_asm!(
        ".cfi_startproc",
        "sub rsp, 216",
        ".cfi_adjust_cfa_offset 216",
        // Five of the six general registers hold the named arguments; the sixth, r9, may hold a variable one. Its place
        // in the register save area is 5 * 8 bytes after the start at 32.
        "mov [rsp + 72], r9",
        // The caller sets al to an upper bound of the vector registers in use; at zero they need not be saved.
        "test al, al",
        "je 2f",
        "movaps [rsp + 80], xmm0",
        "movaps [rsp + 96], xmm1",
        "movaps [rsp + 112], xmm2",
        "movaps [rsp + 128], xmm3",
        "movaps [rsp + 144], xmm4",
        "movaps [rsp + 160], xmm5",
        "movaps [rsp + 176], xmm6",
        "movaps [rsp + 192], xmm7",
        // `va_list`: gp_offset skips the five named arguments, fp_offset is the start of the vector registers.
        "2:",
        "mov dword ptr [rsp], 40",
        "mov dword ptr [rsp + 4], 48",
        // overflow_arg_area: arguments on the caller's stack, above this frame and the return address.
        "lea rax, [rsp + 224]",
        "mov [rsp + 8], rax",
        // reg_save_area.
        "lea rax, [rsp + 32]",
        "mov [rsp + 16], rax",
        "mov r9, rsp",
        "call {handle}",
        "add rsp, 216",
        ".cfi_adjust_cfa_offset -216",
        "ret",
        ".cfi_endproc",
        handle = sym handle,
    )
}

/// # Safety
/// The texts are NULL or end in a zero byte, and `arguments` holds the arguments that the format `message` reads.
unsafe extern "C" fn handle(
    environment: ComponentEnvironment,
    name: Str,
    status: RawStatus,
    category: Str,
    message: Str,
    arguments: *mut VaList,
) {
    let text = || {
        if message.is_null() {
            return Vec::new();
        }
        // SAFETY: guaranteed by the caller.
        let (message, arguments) = unsafe { (CStr::from_ptr(message), *arguments) };
        let mut unread = arguments;
        // SAFETY: the unit guarantees that the arguments match the format.
        let read = |argument| unsafe { unread.next(argument) };
        format::fill(message, read, |buffer, length| {
            // `vsnprintf` advances the list, and `fill` may call this twice: each call gets a copy.
            let mut arguments = arguments;
            // SAFETY: the buffer has this length; the unit guarantees that the arguments match the format.
            unsafe { vsnprintf(buffer, length, message.as_ptr(), &raw mut arguments) }
        })
    };
    // SAFETY: guaranteed by the caller.
    unsafe { deliver(environment, name, status, category, text) }
}
