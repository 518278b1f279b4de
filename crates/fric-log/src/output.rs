//! Files that appear completely or not at all: they are written to a temporary file beside their place and renamed when complete.
//!
//! An input is never overwritten, and another existing file only on request. A file that is never finished leaves nothing behind.

use std::fs::{self, File, Metadata};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;
use thiserror::Error;

/// The error that an output cannot be put in its place.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum OutputError {
    /// The place is taken.
    #[error("`{}` exists; choose another name, or force it to be replaced", path.display())]
    Exists {
        /// The place.
        path: PathBuf,
    },
    /// The place is taken by something other than a regular file: a device, a pipe, a symbolic link.
    #[error("`{}` is no regular file, and is never replaced; choose another name", path.display())]
    NotRegular {
        /// The place.
        path: PathBuf,
    },
    /// The place is that of an input.
    #[error("the output `{}` is the input `{}`; inputs are never overwritten, choose another name", path.display(), input.display())]
    Input {
        /// The place.
        path: PathBuf,
        /// The input, as given.
        input: PathBuf,
    },
    /// The file system reports an error.
    #[error("`{}` cannot be written", path.display())]
    File {
        /// The place.
        path: PathBuf,
        /// The cause.
        #[source]
        source: io::Error,
    },
}

/// A file under construction.
///
/// ```
/// use std::io::Write as _;
/// use fric_log::output::OutputFile;
///
/// let directory = tempfile::tempdir()?;
/// let path = directory.path().join("result.json");
/// let mut file = OutputFile::create(&path, &["run.mcap"], false)?;
/// file.write_all(b"{}")?;
/// assert!(!path.exists());
/// file.finish()?;
/// assert!(path.exists());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct OutputFile {
    path: PathBuf,
    file: NamedTempFile,
    force: bool,
}

impl OutputFile {
    /// Checks the place and opens a temporary file in the same directory.
    ///
    /// An existing file is replaced only with `force`, one of the `inputs` never: neither under its own name nor under another one (symbolic or hard
    /// link).
    ///
    /// # Errors
    /// Returns an [`OutputError`] if the place is that of an input, is taken and `force` is not set, or if its directory is not writable.
    pub fn create(path: &Path, inputs: &[impl AsRef<Path>], force: bool) -> Result<Self, OutputError> {
        let path = path.to_owned();
        if let Some(input) = inputs.iter().map(AsRef::as_ref).find(|input| is_same_file(&path, input)) {
            let input = input.to_owned();
            return Err(OutputError::Input { path, input });
        }
        match fs::symlink_metadata(&path) {
            Ok(place) if place.is_dir() => {
                return Err(OutputError::File { path, source: io::ErrorKind::IsADirectory.into() });
            }
            Ok(place) if !place.is_file() => return Err(OutputError::NotRegular { path }),
            Ok(_) if !force => return Err(OutputError::Exists { path }),
            _ => {}
        }
        // As much of the name as leaves room for the rest.
        let name: String = path
            .file_name()
            .into_iter()
            .flat_map(|name| name.to_string_lossy().chars().take(100).collect::<Vec<_>>())
            .collect();
        let prefix = format!(".fric-{name}-");
        remove_orphans(directory_of(&path), &prefix);
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix).suffix(PART);
        // Temporary files are private, but this one becomes an ordinary file, which the umask restricts.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        match builder.tempfile_in(directory_of(&path)) {
            Ok(file) => {
                // The lock lasts until the process ends in any way. A file system without locks keeps its orphans.
                let _ = file.as_file().try_lock();
                Ok(Self { path, file, force })
            }
            Err(source) => Err(OutputError::File { path, source }),
        }
    }

    /// Returns the final path of the file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes a text and puts the file in its place.
    ///
    /// # Errors
    /// Returns the errors of [`finish`](Self::finish).
    pub fn finish_with(self, text: &str) -> Result<(), OutputError> {
        self.complete_with(text)?.place()
    }

    /// Puts the file in its place.
    ///
    /// # Errors
    /// Returns an [`OutputError`] if the file cannot be fully written, or if another one has appeared in its place and `force` is not set.
    pub fn finish(self) -> Result<(), OutputError> {
        self.complete()?.place()
    }

    /// Writes a text as the whole content of the file.
    ///
    /// # Errors
    /// Returns an [`OutputError`] if the file cannot be fully written.
    pub fn complete_with(mut self, text: &str) -> Result<CompleteFile, OutputError> {
        match self.file.write_all(text.as_bytes()) {
            Ok(()) => self.complete(),
            Err(source) => Err(OutputError::File { path: self.path, source }),
        }
    }

    /// Finishes writing: the content is on the disk. Of several outputs that belong together, all are completed before the first is put in its place.
    ///
    /// # Errors
    /// Returns an [`OutputError`] if the file cannot be fully written.
    pub fn complete(self) -> Result<CompleteFile, OutputError> {
        match self.file.as_file().sync_all() {
            Ok(()) => Ok(CompleteFile(self)),
            Err(source) => Err(OutputError::File { path: self.path, source }),
        }
    }
}

/// A complete file that is not in its place yet.
#[derive(Debug)]
pub struct CompleteFile(OutputFile);

impl CompleteFile {
    /// Returns the final path of the file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.0.path
    }

    /// Puts the file in its place.
    ///
    /// # Errors
    /// Returns an [`OutputError`] if the file system reports an error, if another file has appeared in its place and `force` is not set, or if that is no regular file.
    pub fn place(self) -> Result<(), OutputError> {
        let OutputFile { path, file, force } = self.0;
        // It may have appeared since the file was begun.
        if fs::symlink_metadata(&path).is_ok_and(|place| !place.is_file()) {
            return Err(OutputError::NotRegular { path });
        }
        let placed = if force { file.persist(&path) } else { file.persist_noclobber(&path) };
        match placed.map_err(|error| error.error) {
            Ok(_) => Ok(()),
            Err(source) if source.kind() == io::ErrorKind::AlreadyExists => Err(OutputError::Exists { path }),
            Err(source) => Err(OutputError::File { path, source }),
        }
    }
}

impl Write for OutputFile {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.file.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

impl Seek for OutputFile {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.file.seek(to)
    }
}

/// Suffix of the name of an unfinished file.
const PART: &str = ".part";

/// Removes unfinished files of killed processes, whose lock nobody holds.
fn remove_orphans(directory: &Path, prefix: &str) {
    for entry in fs::read_dir(directory).into_iter().flatten().flatten() {
        let is_part = |name: &str| name.starts_with(prefix) && name.ends_with(PART);
        let is_part = entry.file_name().to_str().is_some_and(is_part)
            && entry.file_type().is_ok_and(|file_type| file_type.is_file());
        let is_orphan = || File::open(entry.path()).is_ok_and(|file| file.try_lock().is_ok());
        if is_part && is_orphan() {
            // A file that cannot be removed does no harm.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Returns the directory of a path; the working directory for a bare name.
#[must_use]
pub fn directory_of(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// Whether both paths lead to the same existing file.
fn is_same_file(one: &Path, other: &Path) -> bool {
    let same_path = match (fs::canonicalize(one), fs::canonicalize(other)) {
        (Ok(one), Ok(other)) => one == other,
        _ => return false,
    };
    same_path
        || match (fs::metadata(one), fs::metadata(other)) {
            (Ok(one), Ok(other)) => is_same_inode(&one, &other),
            _ => false,
        }
}

#[cfg(unix)]
fn is_same_inode(one: &Metadata, other: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    (one.dev(), one.ino()) == (other.dev(), other.ino())
}

#[cfg(not(unix))]
fn is_same_inode(_: &Metadata, _: &Metadata) -> bool {
    false
}
