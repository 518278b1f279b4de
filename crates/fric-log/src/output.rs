//! Files that appear whole or not at all: written beside their place, renamed when they are complete.
//!
//! Neither an input nor, unless told so, any other existing file is overwritten; of a file that is never finished nothing
//! is left.

use std::fs::{self, Metadata};
use std::io::{self, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;
use thiserror::Error;

/// An output that cannot be put in its place.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum OutputError {
    /// The place is taken.
    #[error("`{}` exists; choose another name, or force it to be replaced", path.display())]
    Exists {
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
    /// The file system refuses.
    #[error("`{}` cannot be written", path.display())]
    File {
        /// The place.
        path: PathBuf,
        /// The cause.
        #[source]
        source: io::Error,
    },
}

/// A file in the making.
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
    /// An existing file is replaced only with `force`, one of the `inputs` never: neither under its own name nor under
    /// another one (symbolic or hard link).
    ///
    /// # Errors
    /// Where the place is an input's, or is taken and `force` is not set, or its directory cannot be written to.
    pub fn create(path: &Path, inputs: &[impl AsRef<Path>], force: bool) -> Result<Self, OutputError> {
        let path = path.to_owned();
        if let Some(input) = inputs.iter().map(AsRef::as_ref).find(|input| is_same_file(&path, input)) {
            let input = input.to_owned();
            return Err(OutputError::Input { path, input });
        }
        if !force && fs::symlink_metadata(&path).is_ok() {
            return Err(OutputError::Exists { path });
        }
        if path.is_dir() {
            return Err(OutputError::File { path, source: io::ErrorKind::IsADirectory.into() });
        }
        let mut builder = tempfile::Builder::new();
        builder.prefix(".fric-").suffix(".part");
        // Temporary files are private; this one becomes an ordinary file, which the umask restricts.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        match builder.tempfile_in(directory_of(&path)) {
            Ok(file) => Ok(Self { path, file, force }),
            Err(source) => Err(OutputError::File { path, source }),
        }
    }

    /// Where the file will be.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Writes a text and puts the file in its place.
    ///
    /// # Errors
    /// As [`finish`](Self::finish).
    pub fn finish_with(mut self, text: &str) -> Result<(), OutputError> {
        match self.file.write_all(text.as_bytes()) {
            Ok(()) => self.finish(),
            Err(source) => Err(OutputError::File { path: self.path, source }),
        }
    }

    /// Puts the file in its place.
    ///
    /// # Errors
    /// Where it cannot be written to the end, or another one has appeared in its place and `force` is not set.
    pub fn finish(self) -> Result<(), OutputError> {
        let Self { path, file, force } = self;
        if let Err(source) = file.as_file().sync_all() {
            return Err(OutputError::File { path, source });
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

/// The directory in which a path stands; the working directory for a bare name.
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
