//! The thread that loads segments ahead of the reader.
//!
//! It loads them in the given order and stops when [`AHEAD_COUNT`] segments or [`AHEAD_BYTES`] bytes are waiting; a larger segment is loaded only
//! when it is requested. Dropping the [`Reader`] ends the thread.

use std::collections::VecDeque;
use std::fs::File;
use std::io;
use std::path::PathBuf;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use super::error::RecordingError;
use super::load::{Loaded, Loader};
use super::segment::Segment;

/// Maximum number of waiting segments.
const AHEAD_COUNT: usize = 2;
/// Maximum number of waiting decompressed bytes, including the segment being loaded.
pub(super) const AHEAD_BYTES: u64 = 8 * 1024 * 1024;
/// Maximum number of kept buffers, and their maximum size.
const SPARE_COUNT: usize = 3;
const SPARE_LEN: usize = 4 * 1024 * 1024;

/// A file of the recording.
pub(crate) struct SourceFile {
    pub(crate) path: PathBuf,
    pub(crate) file: File,
    pub(crate) len: u64,
}

impl SourceFile {
    pub(super) fn read_error(&self, offset_bytes: u64, source: io::Error) -> RecordingError {
        RecordingError::Read { path: self.path.clone(), offset_bytes, source }
    }
}

#[derive(Default)]
struct State {
    ready: VecDeque<io::Result<Loaded>>,
    /// Stated sizes of the segments that are ready or being loaded.
    ahead_lens: VecDeque<u64>,
    is_wanted: bool,
    is_stopped: bool,
    has_ended: bool,
    spare: Vec<Vec<u8>>,
}

struct Shared {
    state: Mutex<State>,
    for_thread: Condvar,
    for_owner: Condvar,
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        // The state is valid between any two statements, so a panic elsewhere does not matter.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Notifies the owner that the thread has ended, for whatever reason.
struct EndNotice(Arc<Shared>);

impl Drop for EndNotice {
    fn drop(&mut self) {
        self.0.lock().has_ended = true;
        self.0.for_owner.notify_all();
    }
}

/// The owner's side of the thread.
pub(super) struct Reader {
    shared: Arc<Shared>,
    thread: Option<JoinHandle<()>>,
}

impl Reader {
    pub(super) fn start(files: Arc<[SourceFile]>, segments: Arc<[Segment]>) -> Result<Self, RecordingError> {
        let shared =
            Arc::new(Shared { state: Mutex::default(), for_thread: Condvar::new(), for_owner: Condvar::new() });
        let notice = EndNotice(Arc::clone(&shared));
        let thread = std::thread::Builder::new()
            .name("fric-log-reader".to_owned())
            .spawn(move || load_all(&notice.0, &files, &segments))
            .map_err(|source| RecordingError::StartReader { source })?;
        Ok(Self { shared, thread: Some(thread) })
    }

    /// Returns the next segment and waits for it if necessary. Returns `None` if the thread ended without it.
    pub(super) fn take(&self) -> Option<io::Result<Loaded>> {
        let mut state = self.shared.lock();
        loop {
            if let Some(loaded) = state.ready.pop_front() {
                state.ahead_lens.pop_front();
                state.is_wanted = false;
                self.shared.for_thread.notify_one();
                return Some(loaded);
            }
            if state.has_ended {
                return None;
            }
            if !state.is_wanted {
                state.is_wanted = true;
                self.shared.for_thread.notify_one();
            }
            state = self.shared.for_owner.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Returns a buffer for reuse.
    pub(super) fn give_back(&self, buffer: Vec<u8>) {
        let mut state = self.shared.lock();
        if state.spare.len() < SPARE_COUNT && buffer.capacity() <= SPARE_LEN {
            state.spare.push(buffer);
        }
    }
}

impl Drop for Reader {
    fn drop(&mut self) {
        self.shared.lock().is_stopped = true;
        self.shared.for_thread.notify_all();
        if let Some(thread) = self.thread.take() {
            // A panic of the thread was reported by `take`, or nobody waited for its result.
            let _ = thread.join();
        }
    }
}

fn load_all(shared: &Shared, files: &[SourceFile], segments: &[Segment]) {
    let mut loader = Loader::new();
    for (place, segment) in segments.iter().enumerate() {
        let Some(buffer) = wait_for_room(shared, segment.memory_len()) else {
            return;
        };
        let result = match files.get(segment.file as usize) {
            Some(source) => loader.load(&source.file, place, segment, buffer),
            None => Err(io::ErrorKind::NotFound.into()),
        };
        shared.lock().ready.push_back(result);
        shared.for_owner.notify_one();
    }
}

/// Waits until a segment may be loaded and returns a buffer for it; `None` if the thread must stop.
fn wait_for_room(shared: &Shared, content_len: u64) -> Option<Vec<u8>> {
    let mut state = shared.lock();
    loop {
        if state.is_stopped {
            return None;
        }
        let ahead = state.ahead_lens.iter().fold(content_len, |sum, len| sum.saturating_add(*len));
        let has_room = state.ahead_lens.len() < AHEAD_COUNT && ahead <= AHEAD_BYTES;
        if has_room || (state.is_wanted && state.ready.is_empty()) {
            state.ahead_lens.push_back(content_len);
            return Some(state.spare.pop().unwrap_or_default());
        }
        state = shared.for_thread.wait(state).unwrap_or_else(PoisonError::into_inner);
    }
}
