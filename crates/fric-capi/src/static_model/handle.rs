//! The opaque handle of a static model: creation, queries, reset, copy, release.

use std::ffi::{CString, c_char};
use std::path::Path;
use std::ptr;

use fric_tendon::file::ManipulatorFile;
use fric_tendon::{AnyStaticModel, Drive, DriveOptions};

use crate::cycle::usable;
use crate::load::{load, text};
use crate::outcome::Outcome;
use crate::text_buffer::TextBuffer;

/// Static model of one continuum manipulator: created by fric_static_model_load_file or fric_static_model_load_text, freed by fric_static_model_free.
///
/// Tensions are those of the tendons at the base plate, and positions are in the base frame. The tables `[base_sensor]` and `[markers]` of the
/// manipulator file are not applied: a signal of such a sensor becomes a tension by (shown − offset_n)/gain. Only one thread at a time may use a
/// model. Others may query its name and its number of disks meanwhile. Several models are independent of each other.
pub struct ModelHandle {
    pub(crate) work: Work,
    description: Description,
}

/// The data of a call in the loop.
pub(crate) struct Work {
    pub model: AnyStaticModel,
    pub drive: Drive,
}

/// The data that do not change after set-up.
struct Description {
    name: CString,
    disk_count: usize,
}

impl ModelHandle {
    /// Creates a relaxed model of the manipulator of a file, driven by the first tendon alone.
    fn new(file: &ManipulatorFile) -> Result<Self, (Outcome, String)> {
        let params = file.params();
        let refused = |error: &dyn std::error::Error| (Outcome::RobotFile, error.to_string());
        let model = AnyStaticModel::new(params).map_err(|error| refused(&error))?;
        let drive = Drive::new(params, &DriveOptions::first_tendon(params)).map_err(|error| refused(&error))?;
        let name = CString::new(file.tables().name.as_str()).map_err(|error| {
            (Outcome::RobotFile, format!("`name` has a zero in it, which no C string can: {error}"))
        })?;
        let description = Description { name, disk_count: params.disk_count() };
        Ok(Self { work: Work { model, drive }, description })
    }
}

/// Creates a static model of the manipulator of a manipulator file (TOML, `format = "fric-continuum/1"`): straight, without tension, with relaxed
/// holes.
///
/// `path` is UTF-8. On FRIC_RESULT_OK `*model` is the new model, else null. `error` is as in fric_load_file. Not for the loop: it reads a file and
/// allocates. The optimised library uses at most 256 KiB of stack, as all functions of a static model do.
///
/// # Safety
/// `path` is null or a zero-terminated string; `model` is null or writable; `error` is null or points to `error_size` writable bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_static_model_load_file(
    path: *const c_char,
    model: *mut *mut ModelHandle,
    error: *mut c_char,
    error_size: usize,
) -> Outcome {
    // SAFETY: the caller of this function promises the same.
    let error = unsafe { TextBuffer::new(error, error_size) };
    // SAFETY: the caller of this function promises the same.
    let path = unsafe { text(path, "path") };
    let set_up = || {
        let file = ManipulatorFile::read(Path::new(path?));
        ModelHandle::new(&file.map_err(|error| (Outcome::RobotFile, error.to_string()))?)
    };
    // SAFETY: the caller of this function promises the same.
    unsafe { load(set_up, model, "model", error) }
}

/// Does the same as fric_static_model_load_file with the text of a manipulator file, which has no path: errors name line and key.
///
/// # Safety
/// `toml` is null or a zero-terminated string; the rest as for fric_static_model_load_file.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_static_model_load_text(
    toml: *const c_char,
    model: *mut *mut ModelHandle,
    error: *mut c_char,
    error_size: usize,
) -> Outcome {
    // SAFETY: the caller of this function promises the same.
    let error = unsafe { TextBuffer::new(error, error_size) };
    // SAFETY: the caller of this function promises the same.
    let toml = unsafe { text(toml, "toml") };
    let set_up = || {
        let file = ManipulatorFile::parse(toml?, "manipulator file");
        ModelHandle::new(&file.map_err(|error| (Outcome::RobotFile, error.to_string()))?)
    };
    // SAFETY: the caller of this function promises the same.
    unsafe { load(set_up, model, "model", error) }
}

/// Returns the description behind a handle; `None` if the pointer cannot be one.
///
/// # Safety
/// `model` is null or a handle that has not been freed.
unsafe fn description<'a>(model: *const ModelHandle) -> Option<&'a Description> {
    if !usable(model) {
        return None;
    }
    // SAFETY: a live handle. Nothing writes to its description, and no reference to the rest is made.
    Some(unsafe { &(*model).description })
}

/// Returns the manipulator's number of disks without the base plate, which is also the number of segments and of a tendon's holes; 0 for a null
/// pointer.
///
/// # Safety
/// `model` is null or a model that has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_static_model_disk_count(model: *const ModelHandle) -> usize {
    // SAFETY: the caller of this function promises the same.
    unsafe { description(model) }.map_or(0, |description| description.disk_count)
}

/// Returns the name of the manipulator in UTF-8; null for a null pointer. The text is valid until fric_static_model_free.
///
/// # Safety
/// `model` is null or a model that has not been freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_static_model_name(model: *const ModelHandle) -> *const c_char {
    // SAFETY: the caller of this function promises the same.
    unsafe { description(model) }.map_or(ptr::null(), |description| description.name.as_ptr())
}

/// Resets to the state after set-up: straight, without tension, with relaxed holes. The drive is kept. It does not allocate, lock or wait.
///
/// # Safety
/// `model` is null or a model that has not been freed and that nobody else uses now.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_static_model_reset(model: *mut ModelHandle) -> Outcome {
    if !usable(model) {
        return Outcome::BadPointer;
    }
    // SAFETY: a live handle that nobody else uses; no other reference to its data exists.
    unsafe { &mut (*model).work }.model.reset();
    Outcome::Ok
}

/// Copies the state of another model of the same manipulator: its shape and the memory of its holes. The drive is kept. With it, a second model can
/// store a state to return to, or look ahead while the first one stays. It does not allocate, lock or wait.
///
/// FRIC_RESULT_WRONG_SIZE, with nothing changed, if the other manipulator has another number of disks.
///
/// # Safety
/// `model` and `from` are each null or a model that has not been freed and that nobody else uses now; they may be the same.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_static_model_copy_state(model: *mut ModelHandle, from: *const ModelHandle) -> Outcome {
    if !(usable(model) && usable(from)) {
        return Outcome::BadPointer;
    }
    if ptr::eq(model, from) {
        return Outcome::Ok;
    }
    // SAFETY: a live handle that nobody else uses, different from `from`; no other reference to its data exists.
    let to = unsafe { &mut (*model).work };
    // SAFETY: a live handle that nobody else uses.
    let from = unsafe { &(*from).work };
    to.model.copy_state(&from.model).map_or(Outcome::WrongSize, |()| Outcome::Ok)
}

/// Frees a model. Null does nothing. Not for the loop: it frees memory.
///
/// # Safety
/// `model` is null or a model that has not been freed; it must not be used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_static_model_free(model: *mut ModelHandle) {
    if usable(model) {
        // SAFETY: it came from `Box::into_raw` in `load`, and is freed once.
        drop(unsafe { Box::from_raw(model) });
    }
}
