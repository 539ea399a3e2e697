//! Bindings to Aravis 0.8, which is loaded when a camera is opened, so that builds do not need it. All unsafe code of
//! the module `genicam` is here and in the two submodules.
//!
//! The functions are documented in Aravis' reference manual. Their types must match its header files, which no
//! compiler checks.

#![allow(unsafe_code, reason = "a C library")]

pub(super) mod device;
pub(super) mod stream;

use super::info::GenicamDevice;
use libloading::Library;
use std::ffi::{CStr, c_char, c_int, c_uint, c_void};
use std::ptr::{NonNull, null_mut};
use std::sync::{Mutex, OnceLock, PoisonError};

/// Name of the shared library with the stable interface 0.8, the same in all distributions.
const LIBRARY: &str = "libaravis-0.8.so.0";

/// Prefix of the ids of cameras that Aravis simulates.
pub(super) const FAKE: &str = "Fake_";

/// Pointer to a `GObject`.
type Object = *mut c_void;

/// GLib's `GError`.
#[repr(C)]
pub(super) struct GError {
    domain: u32,
    code: c_int,
    message: *mut c_char,
}

type Failure = *mut *mut GError;

macro_rules! functions {
    ($($name:ident($($argument:ty),*) $(-> $result:ty)?;)*) => {
        /// The library's functions.
        struct Functions {
            $($name: unsafe extern "C" fn($($argument),*) $(-> $result)?,)*
        }

        impl Functions {
            /// Looks up the functions in `library`.
            ///
            /// # Safety
            /// `library` must be Aravis 0.8, whose functions have these types.
            unsafe fn of(library: &Library) -> Result<Self, libloading::Error> {
                Ok(Self {
                    // SAFETY: the caller guarantees that the functions have these types.
                    $($name: *unsafe { library.get(concat!(stringify!($name), "\0").as_bytes()) }?,)*
                })
            }
        }
    };
}

functions! {
    arv_enable_interface(*const c_char);
    arv_update_device_list();
    arv_get_n_devices() -> c_uint;
    arv_get_device_id(c_uint) -> *const c_char;
    arv_get_device_vendor(c_uint) -> *const c_char;
    arv_get_device_model(c_uint) -> *const c_char;
    arv_get_device_serial_nbr(c_uint) -> *const c_char;
    arv_get_device_protocol(c_uint) -> *const c_char;
    arv_get_device_address(c_uint) -> *const c_char;
    arv_camera_new(*const c_char, Failure) -> Object;
    arv_camera_is_gv_device(Object) -> c_int;
    arv_camera_get_device(Object) -> Object;
    arv_gv_device_is_controller(Object) -> c_int;
    arv_camera_get_vendor_name(Object, Failure) -> *const c_char;
    arv_camera_get_model_name(Object, Failure) -> *const c_char;
    arv_camera_get_device_id(Object, Failure) -> *const c_char;
    arv_camera_get_sensor_size(Object, *mut c_int, *mut c_int, Failure);
    arv_camera_get_width_bounds(Object, *mut c_int, *mut c_int, Failure);
    arv_camera_get_height_bounds(Object, *mut c_int, *mut c_int, Failure);
    arv_camera_get_region(Object, *mut c_int, *mut c_int, *mut c_int, *mut c_int, Failure);
    arv_camera_set_region(Object, c_int, c_int, c_int, c_int, Failure);
    arv_camera_is_region_offset_available(Object, Failure) -> c_int;
    arv_camera_dup_available_pixel_formats_as_strings(Object, *mut c_uint, Failure) -> *mut *const c_char;
    arv_camera_set_pixel_format_from_string(Object, *const c_char, Failure);
    arv_camera_is_exposure_time_available(Object, Failure) -> c_int;
    arv_camera_get_exposure_time_bounds(Object, *mut f64, *mut f64, Failure);
    arv_camera_set_exposure_time(Object, f64, Failure);
    arv_camera_is_exposure_auto_available(Object, Failure) -> c_int;
    arv_camera_set_exposure_time_auto(Object, c_int, Failure);
    arv_camera_is_gain_available(Object, Failure) -> c_int;
    arv_camera_get_gain_bounds(Object, *mut f64, *mut f64, Failure);
    arv_camera_set_gain(Object, f64, Failure);
    arv_camera_is_gain_auto_available(Object, Failure) -> c_int;
    arv_camera_set_gain_auto(Object, c_int, Failure);
    arv_camera_is_frame_rate_available(Object, Failure) -> c_int;
    arv_camera_get_frame_rate_bounds(Object, *mut f64, *mut f64, Failure);
    arv_camera_set_frame_rate(Object, f64, Failure);
    arv_camera_dup_available_trigger_sources(Object, *mut c_uint, Failure) -> *mut *const c_char;
    arv_camera_set_trigger(Object, *const c_char, Failure);
    arv_camera_clear_triggers(Object, Failure);
    arv_camera_software_trigger(Object, Failure);
    arv_camera_set_acquisition_mode(Object, c_int, Failure);
    arv_camera_start_acquisition(Object, Failure);
    arv_camera_stop_acquisition(Object, Failure);
    arv_camera_get_payload(Object, Failure) -> c_uint;
    arv_camera_get_integer(Object, *const c_char, Failure) -> i64;
    arv_camera_create_stream(Object, *const c_void, *const c_void, Failure) -> Object;
    arv_stream_push_buffer(Object, Object);
    arv_stream_timeout_pop_buffer(Object, u64) -> Object;
    arv_buffer_new_allocate(usize) -> Object;
    arv_buffer_get_status(Object) -> c_int;
    arv_buffer_get_timestamp(Object) -> u64;
    arv_buffer_get_frame_id(Object) -> u64;
    arv_buffer_get_image_pixel_format(Object) -> u32;
    arv_buffer_get_image_width(Object) -> c_int;
    arv_buffer_get_image_height(Object) -> c_int;
    arv_buffer_get_data(Object, *mut usize) -> *const u8;
    g_object_unref(Object);
    g_free(*mut c_void);
    g_error_free(*mut GError);
}

/// The loaded library.
pub(super) struct Aravis {
    functions: Functions,
    /// Guards Aravis' list of devices, which is global in the process.
    devices: Mutex<()>,
}

impl Aravis {
    /// Loads the library once; returns the reason if that fails.
    pub(super) fn load() -> Result<&'static Self, String> {
        static LOADED: OnceLock<Result<Aravis, String>> = OnceLock::new();
        let load = || {
            // SAFETY: loading runs the constructors of Aravis and GLib, which have no preconditions.
            let library = unsafe { Library::new(LIBRARY) }.map_err(|e| e.to_string())?;
            // SAFETY: a library of this name is Aravis with the stable interface 0.8.
            let functions = unsafe { Functions::of(&library) }.map_err(|e| e.to_string())?;
            // GLib's threads and types outlive every camera, so the library is never unloaded.
            std::mem::forget(library);
            let devices = Mutex::new(());
            Ok(Self { functions, devices })
        };
        LOADED.get_or_init(load).as_ref().map_err(Clone::clone)
    }

    /// Enables the camera `Fake_1`, which Aravis simulates.
    pub(super) fn enable_fake(&self) {
        let _one = self.devices.lock().unwrap_or_else(PoisonError::into_inner);
        // SAFETY: the text is zero-terminated; the lock guards the list of interfaces.
        unsafe { (self.functions.arv_enable_interface)(c"Fake".as_ptr()) }
    }

    /// Lists all cameras that respond. Takes a second.
    pub(super) fn devices(&self) -> Vec<GenicamDevice> {
        let _one = self.devices.lock().unwrap_or_else(PoisonError::into_inner);
        let functions = &self.functions;
        // SAFETY: the functions have no preconditions.
        let count = unsafe {
            (functions.arv_update_device_list)();
            (functions.arv_get_n_devices)()
        };
        let device = |index: c_uint| {
            // SAFETY: `index` is below the number of devices, and the lock keeps the list unchanged. The texts belong
            // to Aravis and are copied.
            let text =
                |of: unsafe extern "C" fn(c_uint) -> *const c_char| unsafe { text(of(index)) };
            GenicamDevice {
                id: text(functions.arv_get_device_id),
                vendor: text(functions.arv_get_device_vendor),
                model: text(functions.arv_get_device_model),
                serial: text(functions.arv_get_device_serial_nbr),
                protocol: text(functions.arv_get_device_protocol),
                address: text(functions.arv_get_device_address),
            }
        };
        (0..count).map(device).collect()
    }

    /// Returns the result of `call`, or the message of the error that it sets.
    fn checked<T>(&self, call: impl FnOnce(Failure) -> T) -> Result<T, String> {
        let mut error = null_mut();
        let value = call(&raw mut error);
        let Some(error) = NonNull::new(error) else {
            return Ok(value);
        };
        // SAFETY: GLib has set an error, which the caller may read and must free.
        unsafe {
            let message = text(error.as_ref().message);
            (self.functions.g_error_free)(error.as_ptr());
            Err(message)
        }
    }
}

/// Copies a C string; a null pointer gives an empty string.
///
/// # Safety
/// `text` must be null or zero-terminated.
unsafe fn text(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: guaranteed by the caller.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_string_lossy().into_owned()
}
