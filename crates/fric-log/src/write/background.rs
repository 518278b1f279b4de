//! The thread that frames, compresses and writes messages while the next ones are produced.
//!
//! Messages are passed in batches of [`BATCH_BYTES`], of which at most [`WAITING_COUNT`] wait; used ones are returned for reuse. The thread starts
//! with the first full batch and ends with the first error, which the next batch then receives. One thread writes everything in the given order, so
//! that the file does not depend on the scheduler.

use std::io::{self, Seek, Write};
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread::JoinHandle;

use mcap::records::MessageHeader;
use mcap::{McapResult, Writer};

/// Small compared with the processor's caches, large compared with the cost of passing a batch.
const BATCH_BYTES: usize = 128 * 1024;
const WAITING_COUNT: usize = 2;

/// Consecutive messages.
#[derive(Default)]
struct Batch {
    bytes: Vec<u8>,
    /// For each message the channel, the stamp in nanoseconds, and the end of its bytes.
    messages: Vec<(u16, u64, usize)>,
}

impl Batch {
    fn write(&self, writer: &mut Writer<impl Write + Seek>) -> McapResult<()> {
        let mut start = 0;
        for &(channel_id, stamp_nanos, end) in &self.messages {
            let header = MessageHeader { channel_id, sequence: 0, log_time: stamp_nanos, publish_time: stamp_nanos };
            writer.write_to_known_channel(&header, self.bytes.get(start..end).unwrap_or_default())?;
            start = end;
        }
        Ok(())
    }

    fn clear(&mut self) {
        self.bytes.clear();
        self.messages.clear();
    }
}

/// An MCAP writer whose messages are written by a separate thread. Dropping it ends the thread.
pub(super) struct BackgroundWriter<W: Write + Seek + Send + 'static> {
    /// `None` while the thread owns it, and after an error.
    writer: Option<Writer<W>>,
    thread: Option<WriterThread<W>>,
    filling: Batch,
}

impl<W: Write + Seek + Send + 'static> BackgroundWriter<W> {
    pub(super) fn new(writer: Writer<W>) -> Self {
        Self { writer: Some(writer), thread: None, filling: Batch::default() }
    }

    /// Takes over a message, which is written sooner or later.
    ///
    /// # Errors
    /// Returns an error if an earlier message cannot be written, or no thread can be started. Nothing can be written then.
    pub(super) fn write(&mut self, channel_id: u16, stamp_nanos: u64, data: &[u8]) -> McapResult<()> {
        let Batch { bytes, messages } = &mut self.filling;
        bytes.extend_from_slice(data);
        messages.push((channel_id, stamp_nanos, bytes.len()));
        if bytes.len() < BATCH_BYTES { Ok(()) } else { self.hand_over() }
    }

    /// Returns the writer with all messages so far.
    ///
    /// # Errors
    /// Returns an error if one of them cannot be written. Nothing can be written then.
    pub(super) fn writer(&mut self) -> McapResult<&mut Writer<W>> {
        if let Some(thread) = self.thread.take() {
            self.writer = Some(thread.join()?);
        }
        let writer = self.writer.as_mut().ok_or_else(no_writer)?;
        self.filling.write(writer)?;
        self.filling.clear();
        Ok(writer)
    }

    /// Returns the errors of [`writer`](Self::writer).
    pub(super) fn into_writer(mut self) -> McapResult<Writer<W>> {
        self.writer()?;
        Ok(self.writer.take().ok_or_else(no_writer)?)
    }

    fn hand_over(&mut self) -> McapResult<()> {
        let thread = match &mut self.thread {
            Some(thread) => thread,
            None => self.thread.insert(WriterThread::start(self.writer.take().ok_or_else(no_writer)?)?),
        };
        let next = thread.used.try_recv().unwrap_or_default();
        let batch = std::mem::replace(&mut self.filling, next);
        if thread.full.as_ref().is_some_and(|full| full.send(batch).is_ok()) {
            return Ok(());
        }
        // The thread has ended by itself, because of an error.
        match self.thread.take() {
            Some(thread) => Err(thread.join().err().unwrap_or_else(|| no_writer().into())),
            None => Err(no_writer().into()),
        }
    }
}

fn no_writer() -> io::Error {
    io::Error::other("an earlier part could not be written")
}

struct WriterThread<W: Write + Seek + Send + 'static> {
    /// `None` tells the thread to end.
    full: Option<SyncSender<Batch>>,
    used: Receiver<Batch>,
    handle: Option<JoinHandle<McapResult<Writer<W>>>>,
}

impl<W: Write + Seek + Send + 'static> WriterThread<W> {
    fn start(writer: Writer<W>) -> io::Result<Self> {
        let (full, to_write) = sync_channel(WAITING_COUNT);
        let (give_back, used) = channel();
        let thread = std::thread::Builder::new().name("fric-log-writer".to_owned());
        let handle = thread.spawn(move || write_all(writer, &to_write, &give_back))?;
        Ok(Self { full: Some(full), used, handle: Some(handle) })
    }

    /// Waits until everything is written and returns the writer. A panic of the thread is resumed here.
    fn join(mut self) -> McapResult<Writer<W>> {
        self.full = None;
        match self.handle.take().map(JoinHandle::join) {
            Some(Ok(result)) => result,
            Some(Err(panic)) => std::panic::resume_unwind(panic),
            None => Err(no_writer().into()),
        }
    }
}

impl<W: Write + Seek + Send + 'static> Drop for WriterThread<W> {
    fn drop(&mut self) {
        self.full = None;
        if let Some(handle) = self.handle.take() {
            // The file is dropped with the thread; its result is no longer needed.
            let _ = handle.join();
        }
    }
}

fn write_all<W: Write + Seek>(
    mut writer: Writer<W>,
    to_write: &Receiver<Batch>,
    give_back: &Sender<Batch>,
) -> McapResult<Writer<W>> {
    for mut batch in to_write {
        batch.write(&mut writer)?;
        batch.clear();
        // Without a receiver no further batch will come.
        let _ = give_back.send(batch);
    }
    Ok(writer)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::io::Cursor;
    use std::panic::{AssertUnwindSafe, catch_unwind};

    use mcap::{McapError, WriteOptions};

    use super::*;

    /// A file of which only the first bytes can be written.
    struct Full {
        file: Cursor<Vec<u8>>,
        room: u64,
        panics: bool,
    }

    impl Write for Full {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            if self.file.position() + bytes.len() as u64 <= self.room {
                return self.file.write(bytes);
            }
            // Only once: the MCAP writer also writes when it is dropped.
            assert!(!std::mem::take(&mut self.panics), "a bug in the sink");
            Err(io::ErrorKind::StorageFull.into())
        }

        fn flush(&mut self) -> io::Result<()> {
            self.file.flush()
        }
    }

    impl Seek for Full {
        fn seek(&mut self, to: io::SeekFrom) -> io::Result<u64> {
            self.file.seek(to)
        }
    }

    /// Writes 4 MiB, so that the thread reaches the limit while more data arrive.
    fn fill(room: u64, panics: bool) -> (BackgroundWriter<Full>, McapResult<()>) {
        let sink = Full { file: Cursor::default(), room, panics };
        let mut writer = WriteOptions::new().compression(None).create(sink).unwrap();
        let channel_id = writer.add_channel(0, "/a", "cdr", &BTreeMap::new()).unwrap();
        let mut background = BackgroundWriter::new(writer);
        let result = (0..4096).try_for_each(|stamp_nanos| background.write(channel_id, stamp_nanos, &[7; 1024]));
        (background, result)
    }

    fn is_full(error: &McapError) -> bool {
        matches!(error, McapError::Io(error) if error.kind() == io::ErrorKind::StorageFull)
    }

    #[test]
    fn an_error_of_the_thread_is_told_once_and_nothing_hangs() {
        let (mut background, result) = fill(1 << 21, false);
        assert!(is_full(&result.unwrap_err()));
        assert!(background.writer().is_err());
        assert!(background.into_writer().is_err());
    }

    #[test]
    fn an_error_at_the_end_is_told_at_the_end() {
        let finish = |room| {
            let (background, result) = fill(room, false);
            result.unwrap();
            let mut writer = background.into_writer().unwrap();
            writer.finish().map(|_| writer.into_inner().file.position())
        };
        // Room for all but the last byte, which only the end of the file needs.
        let size = finish(u64::MAX).unwrap();
        assert!(is_full(&finish(size - 1).unwrap_err()));
    }

    #[test]
    fn a_panic_of_the_thread_goes_on_in_its_owner() {
        let panic = catch_unwind(AssertUnwindSafe(|| fill(1 << 21, true))).map(|(_, result)| result).unwrap_err();
        assert_eq!(panic.downcast_ref(), Some(&"a bug in the sink"));
    }
}
