//! `export!`: the functions of the standard under their own names, each one line around [`abi`](crate::abi).

/// Exports a unit: all functions of FMI 2.0 for co-simulation, its description for the packager, and its tests.
///
/// Write it once in a library, for the struct that derives [`Fmu`](crate::Fmu) and implements
/// [`Model`](crate::Model). The tests check the declared dependencies, the rules of the standard and the contract of
/// [`Model::init`](crate::Model::init).
#[macro_export]
macro_rules! export {
    ($model:ty) => {
        /// The library of this unit.
        static LIBRARY: $crate::Library = $crate::Library::of::<$model>($crate::Package {
            identifier: env!("CARGO_CRATE_NAME"),
            version: env!("CARGO_PKG_VERSION"),
            authors: env!("CARGO_PKG_AUTHORS"),
            license: env!("CARGO_PKG_LICENSE"),
        });

        $crate::export_functions! { LIBRARY
            fmi2SetDebugLogging(on: i32, count: usize, categories: *const *const c_char) = set_debug_logging(on, count, categories);
            fmi2SetupExperiment(_tolerance_defined: i32, _tolerance: f64, start: f64, stop_defined: i32, stop: f64)
                = set_up_experiment(start, stop_defined, stop);
            fmi2EnterInitializationMode() = enter_initialization_mode();
            fmi2ExitInitializationMode() = exit_initialization_mode();
            fmi2Terminate() = terminate();
            fmi2Reset() = reset();
            fmi2GetReal(vr: *const u32, count: usize, value: *mut f64) = get_real(vr, count, value);
            fmi2GetInteger(vr: *const u32, count: usize, value: *mut i32) = get_integer(vr, count, value);
            fmi2GetBoolean(vr: *const u32, count: usize, value: *mut i32) = get_boolean(vr, count, value);
            fmi2GetString(vr: *const u32, count: usize, value: *mut *const c_char) = get_string(vr, count, value);
            fmi2SetReal(vr: *const u32, count: usize, value: *const f64) = set_real(vr, count, value);
            fmi2SetInteger(vr: *const u32, count: usize, value: *const i32) = set_integer(vr, count, value);
            fmi2SetBoolean(vr: *const u32, count: usize, value: *const i32) = set_boolean(vr, count, value);
            fmi2SetString(vr: *const u32, count: usize, value: *const *const c_char) = set_string(vr, count, value);
            fmi2GetFMUstate(state: *mut *mut c_void) = get_state(state);
            fmi2SetFMUstate(state: *mut c_void) = set_state(state);
            fmi2FreeFMUstate(state: *mut *mut c_void) = free_state(state);
            fmi2SerializedFMUstateSize(state: *mut c_void, size: *mut usize) = serialized_state_size(state, size);
            fmi2SerializeFMUstate(state: *mut c_void, bytes: *mut c_char, size: usize) = serialize_state(state, bytes, size);
            fmi2DeSerializeFMUstate(bytes: *const c_char, size: usize, state: *mut *mut c_void)
                = deserialize_state(bytes, size, state);
            fmi2GetDirectionalDerivative(
                _unknown: *const u32, _unknowns: usize, _known: *const u32, _knowns: usize, _seed: *const f64, _value: *mut f64
            ) = not_supported(Call::GetDirectionalDerivative, "providesDirectionalDerivative is false");
            fmi2SetRealInputDerivatives(_vr: *const u32, _count: usize, _order: *const i32, _value: *const f64)
                = not_supported(Call::SetRealInputDerivatives, "canInterpolateInputs is false");
            fmi2GetRealOutputDerivatives(_vr: *const u32, _count: usize, _order: *const i32, _value: *mut f64)
                = not_supported(Call::GetRealOutputDerivatives, "maxOutputDerivativeOrder is 0");
            fmi2DoStep(point: f64, length: f64, _no_set_state_prior: i32) = do_step(point, length);
            fmi2CancelStep() = not_supported(Call::CancelStep, "canRunAsynchronuously is false");
            fmi2GetStatus(kind: i32, value: *mut i32) = status(kind, value);
            fmi2GetRealStatus(kind: i32, value: *mut f64) = real_status(kind, value);
            fmi2GetIntegerStatus(kind: i32, value: *mut i32) = integer_status(kind, value);
            fmi2GetBooleanStatus(kind: i32, value: *mut i32) = boolean_status(kind, value);
            fmi2GetStringStatus(kind: i32, value: *mut *const c_char) = string_status(kind, value);
        }
        $crate::export_tests! { LIBRARY:
            outputs_depend_on_what_they_declare
            the_description_keeps_every_rule_of_the_standard
            finite_values_give_finite_outputs_or_a_fault
            init_can_be_repeated
            a_saved_state_goes_on_bit_for_bit
        }
    };
}

/// The exported functions: all those above, which take a component and return a status, and the five that do not.
#[doc(hidden)]
#[macro_export]
macro_rules! export_functions {
    ($library:ident $($name:ident($($argument:ident: $type:ty),*) = $function:ident($($passed:expr),*);)*) => {
        /// The functions of FMI 2.0 for co-simulation; `fmu::abi` documents the obligations of their callers.
        #[allow(missing_docs, non_snake_case, clippy::missing_safety_doc, reason = "all three are the standard's")]
        pub mod exported {
            use $crate::abi;
            use $crate::fmi2::c::CallbackFunctions;
            #[allow(unused_imports, reason = "the functions that no unit supports name their call")]
            use $crate::fmi2::calls::Call;
            use ::std::ffi::{c_char, c_void};

            $(
                #[unsafe(no_mangle)]
                pub unsafe extern "C" fn $name(component: *mut c_void, $($argument: $type),*) -> i32 {
                    // SAFETY: the importer keeps the contract of `fmu::abi`.
                    unsafe { abi::$function(component, $($passed),*) }
                }
            )*

            #[unsafe(no_mangle)]
            pub extern "C" fn fmi2GetTypesPlatform() -> *const c_char {
                abi::types_platform()
            }

            #[unsafe(no_mangle)]
            pub extern "C" fn fmi2GetVersion() -> *const c_char {
                abi::version()
            }

            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn fmi2Instantiate(
                name: *const c_char, kind: i32, guid: *const c_char, _resources: *const c_char,
                callbacks: *const CallbackFunctions, _visible: i32, logging_on: i32,
            ) -> *mut c_void {
                // SAFETY: the importer keeps the contract of `fmu::abi`.
                unsafe { abi::instantiate(&super::$library, name, kind, guid, callbacks, logging_on) }
            }

            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn fmi2FreeInstance(component: *mut c_void) {
                // SAFETY: the importer keeps the contract of `fmu::abi`.
                unsafe { abi::free(component) }
            }

            /// The library's `modelDescription.xml`, for the packager.
            #[unsafe(no_mangle)]
            pub unsafe extern "C" fn lockstep_fmu_description(length: *mut usize) -> *const u8 {
                // SAFETY: the caller passes null or a pointer that is valid for writing the length.
                unsafe { abi::description(&super::$library, length) }
            }
        }
    };
}
