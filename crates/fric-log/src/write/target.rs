//! Where a log goes: written beside its place, renamed when it is complete.

use std::fs::{self, Metadata};
use std::io;
use std::path::{Path, PathBuf};

use mcap::McapError;
use tempfile::NamedTempFile;

use super::error::WriteError;

/// The place of a file that does not stand there yet.
pub(super) struct Target {
    path: PathBuf,
    force: bool,
}

impl Target {
    /// Checks the place and opens a temporary file in the same directory.
    pub(super) fn open(
        path: &Path,
        inputs: &[impl AsRef<Path>],
        force: bool,
    ) -> Result<(Self, NamedTempFile), WriteError> {
        let path = path.to_owned();
        for input in inputs.iter().map(AsRef::as_ref) {
            if is_same_file(&path, input) {
                let input = input.to_owned();
                return Err(WriteError::Input { path, input });
            }
        }
        if !force && fs::symlink_metadata(&path).is_ok() {
            return Err(WriteError::Exists { path });
        }
        let target = Self { path, force };
        if target.path.is_dir() {
            return Err(target.io_error(io::ErrorKind::IsADirectory.into()));
        }
        let file = target.temporary().map_err(|source| target.io_error(source))?;
        Ok((target, file))
    }

    /// Makes the finished file stand in its place.
    pub(super) fn place(&self, file: NamedTempFile) -> Result<(), WriteError> {
        file.as_file().sync_all().map_err(|source| self.io_error(source))?;
        let placed = if self.force { file.persist(&self.path) } else { file.persist_noclobber(&self.path) };
        match placed {
            Ok(_) => Ok(()),
            Err(error) if error.error.kind() == io::ErrorKind::AlreadyExists => {
                Err(WriteError::Exists { path: self.path.clone() })
            }
            Err(error) => Err(self.io_error(error.error)),
        }
    }

    pub(super) fn io_error(&self, source: io::Error) -> WriteError {
        WriteError::File { path: self.path.clone(), source }
    }

    pub(super) fn mcap_error(&self, source: McapError) -> WriteError {
        match source {
            McapError::Io(source) => self.io_error(source),
            source => WriteError::Mcap { path: self.path.clone(), source },
        }
    }

    fn temporary(&self) -> io::Result<NamedTempFile> {
        let directory = match self.path.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent,
            _ => Path::new("."),
        };
        let mut builder = tempfile::Builder::new();
        builder.prefix(".fric-").suffix(".part");
        // Temporary files are private; this one becomes an ordinary file, which the umask restricts.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        builder.tempfile_in(directory)
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
