//! The variadic entry of the logger for x86-64 with the System V calling convention.
//!
//! Rust 1.95 cannot define a variadic function. This one is a few instructions that save the registers in which variable
//! arguments may travel, lay out a `va_list` over them on the stack as the convention's section 3.5.7 says, and hand it to
//! [`handle`] as a sixth argument.

use super::{deliver, format};
use fmi2::c::{CallbackLogger, ComponentEnvironment, RawStatus, Str};
use std::arch::naked_asm;
use std::ffi::{CStr, c_char, c_int, c_void};

/// What units get as `logger`.
// SAFETY: the trampoline takes the five named arguments where the convention has them for a variadic function too, and
// keeps to the convention with whatever follows.
pub const LOGGER: CallbackLogger = unsafe { std::mem::transmute(trampoline as *const c_void) };

/// `va_list` of the convention. C functions take a pointer to it and move its offsets on.
#[derive(Clone, Copy)]
#[repr(C)]
struct VaList {
    gp_offset: u32,
    fp_offset: u32,
    overflow_arg_area: *mut c_void,
    reg_save_area: *mut c_void,
}

unsafe extern "C" {
    fn vsnprintf(buffer: *mut c_char, length: usize, format: Str, arguments: *mut VaList) -> c_int;
}

/// On entry the stack is 8 bytes off a multiple of 16. Below it: `va_list` at 0, saved registers from 32 to 208.
#[unsafe(naked)]
unsafe extern "C" fn trampoline() {
    naked_asm!(
        ".cfi_startproc",
        "sub rsp, 216",
        ".cfi_adjust_cfa_offset 216",
        // Five of the six general registers hold the named arguments; the sixth may hold a variable one.
        "mov [rsp + 72], r9",
        // al says whether vector registers are in use.
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
        "2:",
        "mov dword ptr [rsp], 40",
        "mov dword ptr [rsp + 4], 48",
        // Behind our frame and the return address.
        "lea rax, [rsp + 224]",
        "mov [rsp + 8], rax",
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
/// The texts are NULL or end in a zero byte, and `arguments` holds what the format `message` asks for.
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
        // SAFETY: the caller says so.
        let (message, arguments) = unsafe { (CStr::from_ptr(message), *arguments) };
        format::fill(message, |buffer, length| {
            // A copy for each pass, since a pass uses it up.
            let mut arguments = arguments;
            // SAFETY: the buffer has this length; that the arguments fit the format is the unit's promise.
            unsafe { vsnprintf(buffer, length, message.as_ptr(), &raw mut arguments) }
        })
    };
    // SAFETY: the caller says so.
    unsafe { deliver(environment, name, status, category, text) }
}
