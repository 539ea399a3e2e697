//! Aravis 0.8, loaded when a camera is asked for, so that nothing of it is needed to build. All that is unsafe is here and in the two
//! modules below.
//!
//! The functions are those of Aravis' reference manual; their types must be those of its header files, as no compiler compares them.

#![allow(unsafe_code, reason = "a C library")]

mod device;
mod stream;

pub(super) use device::{Device, Quantity};
pub(super) use stream::Stream;

use super::list::GenicamDevice;
use libloading::Library;
use std::ffi::{CStr, CString, c_char, c_int, c_uint, c_void};
use std::ptr::{NonNull, null, null_mut};
use std::sync::{Mutex, OnceLock, PoisonError};

/// The library's name: that of its stable interface 0.8, as every distribution has it.
const LIBRARY: &str = "libaravis-0.8.so.0";

/// A `GObject` of some kind.
type Object = *mut c_void;

/// GLib's error.
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
            /// Those of `library`.
            ///
            /// # Safety
            /// `library` must be Aravis 0.8, whose functions have these types.
            unsafe fn of(library: &Library) -> Result<Self, libloading::Error> {
                Ok(Self {
                    // SAFETY: the caller says that the functions have these types.
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

/// Aravis, and what it has found.
pub(super) struct Aravis {
    functions: Functions,
    /// Aravis' list of devices is one for the whole process.
    devices: Mutex<()>,
}

impl Aravis {
    /// The library, loaded once; why it is not there.
    pub(super) fn load() -> Result<&'static Self, String> {
        static LOADED: OnceLock<Result<Aravis, String>> = OnceLock::new();
        let load = || {
            // SAFETY: loading runs the constructors of Aravis and GLib, which ask for nothing.
            let library = unsafe { Library::new(LIBRARY) }.map_err(|e| e.to_string())?;
            // SAFETY: a library of this name is Aravis with the stable interface 0.8.
            let functions = unsafe { Functions::of(&library) }.map_err(|e| e.to_string())?;
            // GLib's threads and types outlive every camera: it stays for as long as the process.
            std::mem::forget(library);
            let devices = Mutex::new(());
            Ok(Self { functions, devices })
        };
        LOADED.get_or_init(load).as_ref().map_err(Clone::clone)
    }

    /// Lets Aravis simulate a camera, `Fake_1`.
    pub(super) fn enable_fake(&self) {
        let _one = self.devices.lock().unwrap_or_else(PoisonError::into_inner);
        // SAFETY: the text ends with a zero; the lock keeps others from the list of interfaces.
        unsafe { (self.functions.arv_enable_interface)(c"Fake".as_ptr()) }
    }

    /// All cameras that answer, which takes a second.
    pub(super) fn devices(&self) -> Vec<GenicamDevice> {
        let _one = self.devices.lock().unwrap_or_else(PoisonError::into_inner);
        let functions = &self.functions;
        // SAFETY: nothing is asked for.
        let count = unsafe {
            (functions.arv_update_device_list)();
            (functions.arv_get_n_devices)()
        };
        let device = |index: c_uint| {
            // SAFETY: `index` is below the number of devices, of which nobody else makes a new list; the texts are Aravis' own
            // until then, and copied.
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

    /// Opens the camera with this id, serial number or address, or the first one.
    pub(super) fn open(&'static self, id: Option<&str>) -> Result<Device, String> {
        let id = id
            .map(CString::new)
            .transpose()
            .map_err(|e| e.to_string())?;
        let id = id.as_ref().map_or(null(), |id| id.as_ptr());
        let _one = self.devices.lock().unwrap_or_else(PoisonError::into_inner);
        // SAFETY: `id` is null or a text that ends with a zero and outlives the call.
        let camera =
            self.checked(|failure| unsafe { (self.functions.arv_camera_new)(id, failure) })?;
        let camera = NonNull::new(camera).ok_or("no camera")?;
        Ok(Device {
            aravis: self,
            camera,
        })
    }

    /// What `call` gives, or the error that it left.
    fn checked<T>(&self, call: impl FnOnce(Failure) -> T) -> Result<T, String> {
        let mut error = null_mut();
        let value = call(&raw mut error);
        let Some(error) = NonNull::new(error) else {
            return Ok(value);
        };
        // SAFETY: GLib left an error, which is the caller's to read and to free.
        unsafe {
            let message = text(error.as_ref().message);
            (self.functions.g_error_free)(error.as_ptr());
            Err(message)
        }
    }
}

/// A copy of a C text; empty where there is none.
///
/// # Safety
/// `text` must be null or end with a zero.
unsafe fn text(text: *const c_char) -> String {
    if text.is_null() {
        return String::new();
    }
    // SAFETY: the caller says so.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_string_lossy().into_owned()
}
