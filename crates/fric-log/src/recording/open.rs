//! Opens the files of a recording and combines the results of their scans.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;
use std::sync::Arc;

use super::channels::{ChannelTable, Received, Source};
use super::damage::{Damage, DamageKind, DamagedPlace};
use super::error::RecordingError;
use super::merge::Merge;
use super::reader::SourceFile;
use super::scan::{FileScan, scan};
use super::segment::Segment;
use super::{FileCount, Recording};

/// Opens and scans all files.
pub(super) fn open(paths: &[&Path]) -> Result<Recording, RecordingError> {
    if paths.is_empty() {
        return Err(RecordingError::NoFiles);
    }
    let mut files = Vec::with_capacity(paths.len());
    for path in paths {
        let (file, len) = open_file(path)?;
        files.push(SourceFile { path: path.to_path_buf(), file, len });
    }
    open_sources(files)
}

/// Scans files that are open.
pub(super) fn open_sources(files: Vec<SourceFile>) -> Result<Recording, RecordingError> {
    let mut scanned = Vec::with_capacity(files.len());
    for file in files {
        scanned.push(scan_file(file)?);
    }
    // The parts of a split recording are sorted by the time of recording; those without messages come last.
    scanned.sort_by_key(|(_, scan)| start_time(scan).unwrap_or(u64::MAX));
    let recording_start = scanned.first().and_then(|(_, scan)| start_time(scan));

    let mut channels = ChannelTable::new(scanned.len());
    let mut sources = Vec::with_capacity(scanned.len());
    let mut segments = Vec::new();
    let mut damages = Vec::new();
    let mut attachments = Vec::new();
    let mut metadata = Vec::new();
    let mut counts = Vec::new();
    for (place, (source, mut scan)) in scanned.into_iter().enumerate() {
        // More files than that cannot be open.
        let file = u32::try_from(place).unwrap_or(u32::MAX);
        for definition in scan.definitions.iter().chain(&scan.summary_definitions) {
            let received = channels.define(file, definition.opcode, &definition.body, Source::Scan, &mut Vec::new());
            let kind = match received {
                // A conflict is told where messages are delivered.
                Received::Fine | Received::Conflict => continue,
                Received::Broken => DamageKind::Definition,
                Received::TooLarge => DamageKind::TooLarge,
            };
            scan.damage.add(DamagedPlace {
                kind,
                offset_bytes: definition.offset_bytes,
                lost_bytes: definition.body.len() as u64,
                log_time_nanos: None,
            });
        }
        for mut segment in scan.segments {
            segment.file = file;
            segment.rank = u32::try_from(segments.len()).unwrap_or(u32::MAX);
            segments.push(segment);
        }
        scan.damage.set_start_time(recording_start.unwrap_or(0));
        damages.push(scan.damage);
        attachments.extend(scan.attachments.into_iter().map(|found| (place, found)));
        metadata.extend(scan.metadata);
        counts.push(FileCount { expected: scan.message_count, found: 0, is_searched: false });
        sources.push(source);
    }
    segments.sort_by_key(Segment::load_key);
    let segments: Arc<[Segment]> = segments.into();
    Ok(Recording {
        files: sources.into(),
        merge: Merge::new(Arc::clone(&segments)),
        segments,
        channels,
        attachments,
        metadata,
        counts,
        damage: Damage::new(damages),
        reader: None,
        late: super::Late::default(),
        bytes_read: 0,
    })
}

fn start_time(scan: &FileScan) -> Option<u64> {
    let starts = scan.segments.iter().filter(|segment| !segment.is_blank());
    starts.map(|segment| segment.start_time_nanos).min()
}

fn scan_file(source: SourceFile) -> Result<(SourceFile, FileScan), RecordingError> {
    let scan = scan(&source.file, source.len, source.path.clone())
        .map_err(|(offset, error)| source.read_error(offset, error))?;
    if scan.is_mcap {
        Ok((source, scan))
    } else {
        let (found, advice) = looks_like(&source.file).map_err(|error| source.read_error(0, error))?;
        Err(RecordingError::NotMcap { path: source.path, found, advice })
    }
}

/// Opens a regular, non-empty file. Also returns its size.
pub(crate) fn open_file(path: &Path) -> Result<(File, u64), RecordingError> {
    let path_buf = || path.to_path_buf();
    let failed = |source: io::Error| match source.kind() {
        io::ErrorKind::NotFound => RecordingError::Missing { path: path_buf() },
        io::ErrorKind::PermissionDenied => RecordingError::Forbidden { path: path_buf() },
        io::ErrorKind::IsADirectory => RecordingError::Directory { path: path_buf() },
        _ => RecordingError::Open { path: path_buf(), source },
    };
    // The path is checked first, because opening a pipe would wait for its writer.
    let metadata = std::fs::metadata(path).map_err(failed)?;
    if metadata.is_dir() {
        return Err(RecordingError::Directory { path: path_buf() });
    }
    if !metadata.is_file() {
        return Err(RecordingError::NotAFile { path: path_buf() });
    }
    let file = File::open(path).map_err(failed)?;
    let len = file.metadata().map_err(failed)?.len();
    if len == 0 {
        return Err(RecordingError::Empty { path: path_buf() });
    }
    Ok((file, len))
}

/// Returns what a file that is not MCAP may be, and what to do about it, a sentence.
fn looks_like(mut file: &File) -> io::Result<(&'static str, &'static str)> {
    const RIGHT_FILE: &str =
        "Name a recording (`.mcap`), a CSV table with a header and rows of numbers, or the folder of a bag.";
    let mut start = Vec::new();
    file.by_ref().take(256).read_to_end(&mut start)?;
    Ok(if start.starts_with(b"SQLite format 3\0") {
        ("it is an SQLite database, as older ROS 2 bags are", "Convert it with `ros2 bag convert`.")
    } else if start.starts_with(b"#ROSBAG") {
        ("it is a ROS 1 bag", "Convert it with `mcap convert`.")
    } else if start.starts_with(&[0x28, 0xb5, 0x2f, 0xfd]) {
        ("it is compressed as a whole with zstd", "Decompress it with `unzstd`.")
    } else if start.starts_with(&[0x1f, 0x8b]) {
        ("it is compressed as a whole with gzip", "Decompress it with `gunzip`.")
    } else if start.starts_with(b"PK\x03\x04") {
        ("it is a spreadsheet or another zip archive", "Save the sheet as CSV, or unpack it.")
    } else if start.starts_with(b"\x89HDF") || start.starts_with(b"MATLAB 5.0") {
        ("it is an HDF5 or MATLAB file", "Write its signals as CSV.")
    } else if start.starts_with(b"PAR1") {
        ("it is a Parquet file", "Write it as CSV.")
    } else if std::str::from_utf8(&start).is_ok_and(|text| !text.contains('\0')) {
        ("it is a text file without a table", RIGHT_FILE)
    } else {
        ("no MCAP record was found in it", RIGHT_FILE)
    })
}
