//! The opaque handle of a static model: made, asked, reset, copied, given back.

use std::ffi::{CString, c_char};
use std::path::Path;
use std::ptr;

use fric_tendon::file::ManipulatorFile;
use fric_tendon::{AnyStaticModel, Drive, DriveOptions};

use crate::cycle::usable;
use crate::error_text::ErrorText;
use crate::load::{load, text};
use crate::outcome::Outcome;

/// Static model of one continuum manipulator: made by fric_static_model_load_file or fric_static_model_load_text, given back by
/// fric_static_model_free.
///
/// Tensions are those of the tendons at the base plate, and positions stand in the base frame. The tables `[base_sensor]` and `[markers]` of
/// the manipulator file are not applied: what such a sensor shows becomes a tension by (shown − offset_n)/gain. One thread at a time may
/// use a model. Others may ask for its name and its number of disks meanwhile. Several models are independent of each other.
pub struct ModelHandle {
    pub(crate) work: Work,
    description: Description,
}

/// What a call in the loop works on.
pub(crate) struct Work {
    pub model: AnyStaticModel,
    pub drive: Drive,
}

/// What does not change after set-up.
struct Description {
    name: CString,
    disk_count: usize,
}

impl ModelHandle {
    /// A relaxed model of the manipulator of a file, driven by the first tendon alone.
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

/// Makes a static model of the manipulator of a manipulator file (TOML, `format = "fric-continuum/1"`): straight, without tension, with
/// relaxed holes.
///
/// `path` is UTF-8. On FRIC_RESULT_OK `*model` is the new model, else null. `error` is as in fric_load_file. Not for the loop: it reads a file
/// and allocates. The optimised library takes at most 256 KiB of stack, as all functions of a static model do.
///
/// # Safety
/// `path` is null or a string that ends with zero; `model` is null or may be written to; `error` is null or `error_size` bytes
/// may be written to there.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_static_model_load_file(
    path: *const c_char,
    model: *mut *mut ModelHandle,
    error: *mut c_char,
    error_size: usize,
) -> Outcome {
    // SAFETY: the same is promised here.
    let error = unsafe { ErrorText::new(error, error_size) };
    // SAFETY: the same is promised here.
    let path = unsafe { text(path, "path") };
    let set_up = || {
        let file = ManipulatorFile::read(Path::new(path?));
        ModelHandle::new(&file.map_err(|error| (Outcome::RobotFile, error.to_string()))?)
    };
    // SAFETY: the same is promised here.
    unsafe { load(set_up, model, "model", error) }
}

/// The same for the text of a manipulator file, which has no place of its own: errors name line and key.
///
/// # Safety
/// `toml` is null or a string that ends with zero; the rest as for fric_static_model_load_file.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_static_model_load_text(
    toml: *const c_char,
    model: *mut *mut ModelHandle,
    error: *mut c_char,
    error_size: usize,
) -> Outcome {
    // SAFETY: the same is promised here.
    let error = unsafe { ErrorText::new(error, error_size) };
    // SAFETY: the same is promised here.
    let toml = unsafe { text(toml, "toml") };
    let set_up = || {
        let file = ManipulatorFile::parse(toml?, "manipulator file");
        ModelHandle::new(&file.map_err(|error| (Outcome::RobotFile, error.to_string()))?)
    };
    // SAFETY: the same is promised here.
    unsafe { load(set_up, model, "model", error) }
}

/// The description behind a handle; `None` where the pointer cannot be one.
///
/// # Safety
/// `model` is null or a handle that has not been given back.
unsafe fn description<'a>(model: *const ModelHandle) -> Option<&'a Description> {
    if !usable(model) {
        return None;
    }
    // SAFETY: a handle that lives. Nothing writes to its description, and no reference to the rest is made.
    Some(unsafe { &(*model).description })
}

/// How many disks the manipulator has beyond the base plate, as many segments, and holes of a tendon; 0 for a null pointer.
///
/// # Safety
/// `model` is null or a model that has not been given back.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_static_model_disk_count(model: *const ModelHandle) -> usize {
    // SAFETY: the same is promised here.
    unsafe { description(model) }.map_or(0, |description| description.disk_count)
}

/// Name of the manipulator in UTF-8; null for a null pointer. The text lives until fric_static_model_free.
///
/// # Safety
/// `model` is null or a model that has not been given back.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_static_model_name(model: *const ModelHandle) -> *const c_char {
    // SAFETY: the same is promised here.
    unsafe { description(model) }.map_or(ptr::null(), |description| description.name.as_ptr())
}

/// Back to the state after set-up: straight, without tension, with relaxed holes. The drive stays. It does not allocate, lock or wait.
///
/// # Safety
/// `model` is null or a model that has not been given back and that nobody else uses now.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_static_model_reset(model: *mut ModelHandle) -> Outcome {
    if !usable(model) {
        return Outcome::BadPointer;
    }
    // SAFETY: a live handle that nobody else uses; no other reference to what it works on exists.
    unsafe { &mut (*model).work }.model.reset();
    Outcome::Ok
}

/// Brings a model into the state of another one of the same manipulator: its shape and what its holes remember. The drive stays. So a second model
/// keeps a state to come back to, or looks ahead while the first one stays. It does not allocate, lock or wait.
///
/// FRIC_RESULT_WRONG_SIZE, and nothing is changed, where the other manipulator has another number of disks.
///
/// # Safety
/// `model` and `from` are each null or a model that has not been given back and that nobody else uses now; they may be the same.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_static_model_copy_state(model: *mut ModelHandle, from: *const ModelHandle) -> Outcome {
    if !(usable(model) && usable(from)) {
        return Outcome::BadPointer;
    }
    if ptr::eq(model, from) {
        return Outcome::Ok;
    }
    // SAFETY: a live handle that nobody else uses, and another one than `from`; no other reference to what it works on exists.
    let to = unsafe { &mut (*model).work };
    // SAFETY: a live handle that nobody else uses.
    let from = unsafe { &(*from).work };
    to.model.copy_state(&from.model).map_or(Outcome::WrongSize, |()| Outcome::Ok)
}

/// Gives a model back. Null does nothing. Not for the loop: it frees memory.
///
/// # Safety
/// `model` is null or a model that has not been given back; it is not used afterwards.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fric_static_model_free(model: *mut ModelHandle) {
    if usable(model) {
        // SAFETY: it came from `Box::into_raw` in `load`, and is given back once.
        drop(unsafe { Box::from_raw(model) });
    }
}
