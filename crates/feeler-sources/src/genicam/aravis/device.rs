//! An open camera, with its capabilities and settings.

use super::{Aravis, Failure, Functions, Object, text};
use std::ffi::{CString, c_char, c_int, c_uint, c_void};
use std::ptr::{NonNull, null};
use std::sync::PoisonError;

/// `ARV_AUTO_OFF`.
const AUTO_OFF: c_int = 0;
/// `ARV_ACQUISITION_MODE_CONTINUOUS`.
const CONTINUOUS: c_int = 0;

/// A numeric camera setting.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in super::super) enum Quantity {
    /// Exposure time, µs.
    Exposure,
    /// Gain, in the camera's unit.
    Gain,
    /// Frames per second, Hz.
    FrameRate,
}

/// Aravis functions that set one quantity of a camera and query its bounds.
struct QuantityFunctions {
    is_available: unsafe extern "C" fn(Object, Failure) -> c_int,
    bounds: unsafe extern "C" fn(Object, *mut f64, *mut f64, Failure),
    set: unsafe extern "C" fn(Object, f64, Failure),
    /// Checks whether the camera has an automatic mode for the quantity, and sets that mode. `None` if no camera has
    /// one.
    automatic: Option<(
        unsafe extern "C" fn(Object, Failure) -> c_int,
        unsafe extern "C" fn(Object, c_int, Failure),
    )>,
}

/// An open camera.
pub(in super::super) struct Device {
    aravis: &'static Aravis,
    camera: NonNull<c_void>,
}

// SAFETY: Aravis' objects are not bound to a thread. `&mut` and the absence of `Sync` let only one thread at a time
// call them.
unsafe impl Send for Device {}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: releases the reference obtained on opening, once.
        unsafe { (self.functions().g_object_unref)(self.camera.as_ptr()) }
    }
}

impl Device {
    /// Opens the camera with this id, serial number or address, or the first camera if `None`.
    pub(in super::super) fn open(
        aravis: &'static Aravis,
        id: Option<&str>,
    ) -> Result<Self, String> {
        let id = id
            .map(CString::new)
            .transpose()
            .map_err(|e| e.to_string())?;
        let id = id.as_ref().map_or(null(), |id| id.as_ptr());
        let _one = aravis
            .devices
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        // SAFETY: `id` is null or a zero-terminated text that outlives the call.
        let camera =
            aravis.checked(|failure| unsafe { (aravis.functions.arv_camera_new)(id, failure) })?;
        let camera = NonNull::new(camera).ok_or("no camera")?;
        Ok(Self { aravis, camera })
    }

    pub(super) fn functions(&self) -> &'static Functions {
        &self.aravis.functions
    }

    /// Calls a library function on the camera and returns its result or its error.
    pub(super) fn call<T>(
        &self,
        call: impl FnOnce(&Functions, Object, Failure) -> T,
    ) -> Result<T, String> {
        (self.aravis).checked(|failure| call(self.functions(), self.camera.as_ptr(), failure))
    }

    /// Returns whether this process controls the camera: a GigE Vision camera accepts settings only from the first
    /// process that opened it.
    pub(in super::super) fn obeys(&self) -> bool {
        let functions = self.functions();
        let camera = self.camera.as_ptr();
        // SAFETY: the camera is open and owns its device, which is a GigE Vision device if the second function is
        // called.
        unsafe {
            (functions.arv_camera_is_gv_device)(camera) == 0
                || (functions.arv_gv_device_is_controller)((functions.arv_camera_get_device)(
                    camera,
                )) != 0
        }
    }

    /// Vendor, model and id.
    pub(in super::super) fn names(&self) -> Result<[String; 3], String> {
        let functions = self.functions();
        let of = |get: unsafe extern "C" fn(Object, Failure) -> *const c_char| {
            // SAFETY: the camera is open; it owns the text, which is copied.
            self.call(|_, camera, failure| unsafe { text(get(camera, failure)) })
        };
        Ok([
            of(functions.arv_camera_get_vendor_name)?,
            of(functions.arv_camera_get_model_name)?,
            of(functions.arv_camera_get_device_id)?,
        ])
    }

    /// Width and height of the sensor, px.
    pub(in super::super) fn sensor_size(&self) -> Result<[i32; 2], String> {
        self.pair(self.functions().arv_camera_get_sensor_size)
    }

    /// Minimum and maximum width, and minimum and maximum height, px.
    pub(in super::super) fn size_bounds(&self) -> Result<[[i32; 2]; 2], String> {
        Ok([
            self.pair(self.functions().arv_camera_get_width_bounds)?,
            self.pair(self.functions().arv_camera_get_height_bounds)?,
        ])
    }

    fn pair(
        &self,
        get: unsafe extern "C" fn(Object, *mut c_int, *mut c_int, Failure),
    ) -> Result<[i32; 2], String> {
        let [mut a, mut b] = [0; 2];
        // SAFETY: the camera is open; both numbers outlive the call.
        self.call(|_, camera, failure| unsafe { get(camera, &raw mut a, &raw mut b, failure) })?;
        Ok([a, b])
    }

    /// Column, row, width and height of the region that is read from the sensor, px.
    pub(in super::super) fn region(&self) -> Result<[i32; 4], String> {
        let [mut x, mut y, mut width, mut height] = [0; 4];
        // SAFETY: the camera is open; the numbers outlive the call.
        self.call(|functions, camera, failure| unsafe {
            let (x, y) = (&raw mut x, &raw mut y);
            let (width, height) = (&raw mut width, &raw mut height);
            (functions.arv_camera_get_region)(camera, x, y, width, height, failure);
        })?;
        Ok([x, y, width, height])
    }

    /// Sets the region. A negative column or row leaves that offset unchanged.
    pub(in super::super) fn set_region(
        &self,
        [x, y, width, height]: [i32; 4],
    ) -> Result<(), String> {
        // SAFETY: the camera is open.
        self.call(|functions, camera, failure| unsafe {
            (functions.arv_camera_set_region)(camera, x, y, width, height, failure);
        })
    }

    /// Returns whether the region can be moved.
    pub(in super::super) fn has_offset(&self) -> bool {
        // SAFETY: the camera is open.
        let has = self.call(|functions, camera, failure| unsafe {
            (functions.arv_camera_is_region_offset_available)(camera, failure)
        });
        has.is_ok_and(|has| has != 0)
    }

    /// Names of the available pixel formats.
    pub(in super::super) fn pixel_formats(&self) -> Result<Vec<String>, String> {
        self.names_of(
            self.functions()
                .arv_camera_dup_available_pixel_formats_as_strings,
        )
    }

    /// Names of the available trigger sources.
    pub(in super::super) fn trigger_sources(&self) -> Result<Vec<String>, String> {
        self.names_of(self.functions().arv_camera_dup_available_trigger_sources)
    }

    fn names_of(
        &self,
        get: unsafe extern "C" fn(Object, *mut c_uint, Failure) -> *mut *const c_char,
    ) -> Result<Vec<String>, String> {
        let mut count = 0;
        // SAFETY: the camera is open; the count outlives the call.
        let names =
            self.call(|_, camera, failure| unsafe { get(camera, &raw mut count, failure) })?;
        if names.is_null() {
            return Ok(Vec::new());
        }
        // SAFETY: Aravis returns `count` texts that it owns, which are copied, in an array that the caller frees.
        unsafe {
            let all = std::slice::from_raw_parts(names, count as usize);
            let all = all.iter().map(|&name| text(name)).collect();
            (self.functions().g_free)(names.cast());
            Ok(all)
        }
    }

    /// Sets the pixel format.
    pub(in super::super) fn set_pixel_format(&self, name: &str) -> Result<(), String> {
        let set = self.functions().arv_camera_set_pixel_format_from_string;
        self.set_text(set, name)
    }

    /// Triggers images by the given trigger source.
    pub(in super::super) fn set_trigger(&self, source: &str) -> Result<(), String> {
        self.set_text(self.functions().arv_camera_set_trigger, source)
    }

    fn set_text(
        &self,
        set: unsafe extern "C" fn(Object, *const c_char, Failure),
        value: &str,
    ) -> Result<(), String> {
        let value = CString::new(value).map_err(|e| e.to_string())?;
        // SAFETY: the camera is open; the text ends with a zero and outlives the call.
        self.call(|_, camera, failure| unsafe { set(camera, value.as_ptr(), failure) })
    }

    /// Disables triggers: the camera runs freely.
    pub(in super::super) fn clear_triggers(&self) -> Result<(), String> {
        self.command(self.functions().arv_camera_clear_triggers)
    }

    /// Triggers one image by software.
    pub(in super::super) fn trigger(&self) -> Result<(), String> {
        self.command(self.functions().arv_camera_software_trigger)
    }

    /// Starts continuous acquisition.
    pub(in super::super) fn start(&self) -> Result<(), String> {
        // SAFETY: the camera is open.
        self.call(|functions, camera, failure| unsafe {
            (functions.arv_camera_set_acquisition_mode)(camera, CONTINUOUS, failure);
        })?;
        self.command(self.functions().arv_camera_start_acquisition)
    }

    /// Stops the acquisition.
    pub(in super::super) fn stop(&self) -> Result<(), String> {
        self.command(self.functions().arv_camera_stop_acquisition)
    }

    fn command(&self, of: unsafe extern "C" fn(Object, Failure)) -> Result<(), String> {
        // SAFETY: the camera is open.
        self.call(|_, camera, failure| unsafe { of(camera, failure) })
    }

    /// Reads a feature that every camera has, to check that the camera still responds.
    pub(in super::super) fn answers(&self) -> Result<(), String> {
        // SAFETY: the camera is open; the text ends with a zero.
        let asked = self.call(|functions, camera, failure| unsafe {
            (functions.arv_camera_get_integer)(camera, c"Width".as_ptr(), failure)
        });
        asked.map(drop)
    }

    fn of(&self, quantity: Quantity) -> QuantityFunctions {
        let functions = self.functions();
        match quantity {
            Quantity::Exposure => QuantityFunctions {
                is_available: functions.arv_camera_is_exposure_time_available,
                bounds: functions.arv_camera_get_exposure_time_bounds,
                set: functions.arv_camera_set_exposure_time,
                automatic: Some((
                    functions.arv_camera_is_exposure_auto_available,
                    functions.arv_camera_set_exposure_time_auto,
                )),
            },
            Quantity::Gain => QuantityFunctions {
                is_available: functions.arv_camera_is_gain_available,
                bounds: functions.arv_camera_get_gain_bounds,
                set: functions.arv_camera_set_gain,
                automatic: Some((
                    functions.arv_camera_is_gain_auto_available,
                    functions.arv_camera_set_gain_auto,
                )),
            },
            Quantity::FrameRate => QuantityFunctions {
                is_available: functions.arv_camera_is_frame_rate_available,
                bounds: functions.arv_camera_get_frame_rate_bounds,
                set: functions.arv_camera_set_frame_rate,
                automatic: None,
            },
        }
    }

    /// Minimum and maximum value, or `None` if the camera does not have the setting.
    pub(in super::super) fn bounds(&self, quantity: Quantity) -> Result<Option<[f64; 2]>, String> {
        let of = self.of(quantity);
        // SAFETY: the camera is open.
        let has = self.call(|_, camera, failure| unsafe { (of.is_available)(camera, failure) })?;
        if has == 0 {
            return Ok(None);
        }
        let [mut low, mut high] = [0.0; 2];
        // SAFETY: the camera is open; both numbers outlive the call.
        self.call(|_, camera, failure| unsafe {
            (of.bounds)(camera, &raw mut low, &raw mut high, failure);
        })?;
        Ok(Some([low, high]))
    }

    /// Sets the value after disabling the automatic mode, if any.
    pub(in super::super) fn set(&self, quantity: Quantity, value: f64) -> Result<(), String> {
        let of = self.of(quantity);
        if let Some((can, set)) = of.automatic {
            // SAFETY: the camera is open.
            let can = self.call(|_, camera, failure| unsafe { can(camera, failure) });
            if can.is_ok_and(|can| can != 0) {
                // SAFETY: the camera is open.
                self.call(|_, camera, failure| unsafe { set(camera, AUTO_OFF, failure) })?;
            }
        }
        // SAFETY: the camera is open.
        self.call(|_, camera, failure| unsafe { (of.set)(camera, value, failure) })
    }
}
