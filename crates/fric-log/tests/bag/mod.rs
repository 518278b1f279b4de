//! Bags of rosbag2 in SQLite: whole, compressed, in parts, without metadata, damaged. (Bags as other programs write them are read in `tests/python`.)

use std::fs;
use std::path::{Path, PathBuf};

use fric_log::log::Log;
use fric_log::signals::{Role, SignalPaths, SignalReader};
use rusqlite::Connection;
use tempfile::TempDir;

use crate::signals::support::{JOINT_STATES, MS, cable};

/// Writes cable messages of these times, in this order, as the recorder lays out its files.
fn write(path: &Path, stamps: impl IntoIterator<Item = i64>, pack: impl Fn(&[u8]) -> Vec<u8>, with_definition: bool) {
    let mut connection = Connection::open(path).unwrap();
    connection
        .execute_batch(
            "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT NULL,
                offered_qos_profiles TEXT NOT NULL);
             CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB NOT NULL);
             CREATE INDEX timestamp_idx ON messages (timestamp ASC);
             INSERT INTO topics VALUES (7, '/cables', 'sensor_msgs/msg/JointState', 'cdr', '');",
        )
        .unwrap();
    if with_definition {
        let (name, encoding, text, _) = JOINT_STATES;
        connection
            .execute_batch(
                "CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT NULL,
                    encoded_message_definition TEXT NOT NULL);",
            )
            .unwrap();
        let text = std::str::from_utf8(text).unwrap();
        connection.execute("INSERT INTO message_definitions VALUES (1, ?1, ?2, ?3)", (name, encoding, text)).unwrap();
    }
    let transaction = connection.transaction().unwrap();
    for stamp in stamps {
        let data = pack(&message(stamp));
        transaction
            .execute("INSERT INTO messages(topic_id, timestamp, data) VALUES (7, ?1, ?2)", (stamp, data))
            .unwrap();
    }
    transaction.commit().unwrap();
}

/// Force and length are functions of the time.
fn message(stamp: i64) -> Vec<u8> {
    cable(stamp, force_n(stamp), 0.5)
}

#[expect(clippy::cast_precision_loss, reason = "small numbers")]
fn force_n(stamp: i64) -> f64 {
    10.0 + (stamp / MS % 100) as f64 / 7.0
}

fn plain(data: &[u8]) -> Vec<u8> {
    data.to_vec()
}

fn packed(data: &[u8]) -> Vec<u8> {
    zstd::bulk::compress(data, 3).unwrap()
}

fn every_ms(from: i64, to: i64) -> impl Iterator<Item = i64> {
    (from..to).map(|at| at * MS)
}

/// The rows' times, after their values have been compared, and what is warned of.
fn read(paths: &[PathBuf]) -> Result<(Vec<i64>, Vec<String>), String> {
    let log = Log::open(paths).map_err(|error| error.to_string())?;
    let topics = SignalPaths::default().with(Role::Cable, Some("/cables".parse().unwrap()));
    let mut reader = SignalReader::new(log, topics, &["a"]);
    let mut times = Vec::new();
    while let Some(row) = reader.next_row().map_err(|error| error.to_string())? {
        assert_eq!(row.cables[0].sensor_force_n.to_bits(), force_n(row.stamp_nanos).to_bits());
        times.push(row.stamp_nanos / MS);
    }
    assert_eq!(reader.log().bytes_read(), reader.log().total_bytes());
    Ok((times, reader.log().warnings()))
}

struct Folder(TempDir);

impl Folder {
    fn new() -> Self {
        Self(TempDir::new().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn metadata(&self, files: &[&str]) {
        let files: String = files.iter().map(|file| format!("    - {file}\n")).collect();
        let text = format!(
            "rosbag2_bagfile_information:\n  version: 5\n  storage_identifier: sqlite3\n  relative_file_paths:\n{files}"
        );
        fs::write(self.path("metadata.yaml"), text).unwrap();
    }

    fn read(&self) -> (Vec<i64>, Vec<String>) {
        read(&[self.0.path().to_owned()]).unwrap()
    }
}

fn times(from: i64, to: i64) -> (Vec<i64>, Vec<String>) {
    ((from..to).collect(), Vec::new())
}

#[test]
fn a_database_is_read_in_the_order_of_time() {
    let folder = Folder::new();
    let mixed = every_ms(1000, 3000).chain(every_ms(0, 1000)).chain(every_ms(3000, 9000));
    write(&folder.path("a.db3"), mixed, plain, true);
    assert_eq!(read(&[folder.path("a.db3")]).unwrap(), times(0, 9000));
    // Older recorders kept no definitions.
    write(&folder.path("b.db3"), every_ms(0, 50), plain, false);
    assert_eq!(read(&[folder.path("b.db3")]).unwrap(), times(0, 50));
    assert_eq!(fs::read_dir(folder.0.path()).unwrap().count(), 2, "nothing is left beside them");
}

#[test]
fn compressed_messages_and_files_give_the_same() {
    let folder = Folder::new();
    write(&folder.path("bag_0.db3"), every_ms(0, 500), packed, true);
    folder.metadata(&["bag_0.db3"]);
    assert_eq!(folder.read(), times(0, 500));

    let folder = Folder::new();
    write(&folder.path("bag_0.db3"), every_ms(0, 500), plain, true);
    let compressed = packed(&fs::read(folder.path("bag_0.db3")).unwrap());
    fs::remove_file(folder.path("bag_0.db3")).unwrap();
    fs::write(folder.path("bag_0.db3.zstd"), &compressed).unwrap();
    // Recorders name the file with its ending or without.
    for name in ["bag_0.db3.zstd", "bag_0.db3"] {
        folder.metadata(&[name]);
        assert_eq!(folder.read(), times(0, 500));
    }
}

#[test]
fn parts_are_read_as_one_with_metadata_and_without() {
    let folder = Folder::new();
    write(&folder.path("bag_0.db3"), every_ms(0, 300), plain, true);
    write(&folder.path("bag_1.db3"), every_ms(300, 700), plain, true);
    fs::write(folder.path("notes.txt"), "no bag").unwrap();
    folder.metadata(&["bag_0.db3", "bag_1.db3"]);
    assert_eq!(folder.read(), times(0, 700));
    assert_eq!(read(&[folder.path("bag_1.db3"), folder.path("bag_0.db3")]).unwrap(), times(0, 700));
    fs::remove_file(folder.path("metadata.yaml")).unwrap();
    let (rows, warnings) = folder.read();
    assert_eq!(rows, times(0, 700).0);
    assert!(warnings[0].contains("no metadata.yaml") && warnings[0].contains("2 files"), "{warnings:?}");
    folder.metadata(&["bag_0.db3", "bag_2.db3"]);
    let (rows, warnings) = folder.read();
    assert_eq!(rows, times(0, 300).0);
    assert!(warnings[0].contains("no file `bag_2.db3`"), "{warnings:?}");
}

#[test]
fn a_file_that_is_cut_off_is_read_as_far_as_it_goes() {
    let folder = Folder::new();
    let path = folder.path("a.db3");
    write(&path, every_ms(0, 20_000), plain, true);
    let whole = fs::read(&path).unwrap();
    for share in [30, 60, 90] {
        fs::write(&path, &whole[..whole.len() * share / 100]).unwrap();
        let (rows, warnings) = read(std::slice::from_ref(&path)).unwrap();
        let expected = 200 * share;
        assert!((expected * 7 / 10..=expected * 11 / 10).contains(&rows.len()), "{share} %: {}", rows.len());
        assert!(rows.is_sorted_by(|one, next| one < next));
        assert!(warnings.iter().any(|text| text.contains("a.db3` is damaged")), "{warnings:?}");
    }
}

/// A file of zeros packs a hundred thousand times.
#[test]
fn a_file_that_unpacks_without_end_is_refused() {
    let folder = Folder::new();
    let mut packed = zstd::stream::write::Encoder::new(Vec::new(), 3).unwrap();
    std::io::copy(&mut std::io::Read::take(std::io::repeat(0), 300 << 20), &mut packed).unwrap();
    fs::write(folder.path("bag_0.db3.zstd"), packed.finish().unwrap()).unwrap();
    let error = Log::open(&[folder.path(".")]).unwrap_err();
    assert!(fric_log::in_full(&error).contains("unpacks to more than 256 MiB"), "{}", fric_log::in_full(&error));
}

/// What a bag says of itself neither exhausts the stack nor leads out of its folder, and is not waited for.
#[test]
fn metadata_that_mislead_are_not_followed() {
    let (folder, secret) = (Folder::new(), Folder::new());
    write(&folder.path("run.db3"), every_ms(0, 50), plain, true);
    write(&secret.path("secret.db3"), every_ms(0, 50), plain, true);
    let outside = secret.path("secret.db3").display().to_string();
    let up = format!("../{}/secret.db3", secret.path(".").canonicalize().unwrap().file_name().unwrap().display());
    folder.metadata(&["run.db3", &outside, &up]);
    let (read, warnings) = folder.read();
    assert_eq!(read, times(0, 50).0);
    assert!(
        warnings.len() == 2 && warnings.iter().all(|text| text.contains("its messages are missing")),
        "{warnings:?}"
    );
    for text in
        ["- ".repeat(30_000), "[".repeat(30_000), "{a: ".repeat(30_000), "? ".repeat(30_000), "[\n".repeat(30_000)]
    {
        fs::write(folder.path("metadata.yaml"), text).unwrap();
        assert_eq!(folder.read().0, times(0, 50).0);
    }
    fs::remove_file(folder.path("metadata.yaml")).unwrap();
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("/dev/zero", folder.path("metadata.yaml")).unwrap();
        assert_eq!(folder.read().0, times(0, 50).0);
    }
}

/// A recorder that was killed leaves its last messages beside the database. Nothing is written there.
#[test]
fn writes_beside_the_database_are_read_and_left_as_they_are() {
    let (recorded, killed) = (Folder::new(), Folder::new());
    let path = recorded.path("run.db3");
    write(&path, every_ms(0, 100), plain, true);
    let writer = Connection::open(&path).unwrap();
    writer.pragma_update(None, "journal_mode", "WAL").unwrap();
    for stamp in every_ms(100, 200) {
        let row = (stamp, message(stamp));
        writer.execute("INSERT INTO messages(topic_id, timestamp, data) VALUES (7, ?1, ?2)", row).unwrap();
    }
    let names = ["run.db3", "run.db3-wal"];
    for name in names {
        fs::copy(recorded.path(name), killed.path(name)).unwrap();
    }
    let contents = || names.map(|name| fs::read(killed.path(name)).unwrap());
    let before = contents();
    assert_eq!(killed.read().0, times(0, 200).0);
    assert_eq!(contents(), before);
    assert_eq!(fs::read_dir(killed.path(".")).unwrap().count(), 2);
}

#[test]
fn a_compressed_message_that_is_damaged_is_left_out() {
    let folder = Folder::new();
    write(&folder.path("a.db3"), every_ms(0, 20), packed, true);
    let connection = Connection::open(folder.path("a.db3")).unwrap();
    let mut damaged = packed(&message(4 * MS));
    damaged.truncate(damaged.len() - 5);
    connection.execute("UPDATE messages SET data = ?1 WHERE id = 5", [damaged]).unwrap();
    drop(connection);
    let (rows, warnings) = read(&[folder.path("a.db3")]).unwrap();
    assert_eq!(rows.len(), 19);
    assert!(warnings.iter().any(|text| text.contains("1 compressed message")), "{warnings:?}");
}

#[test]
fn what_is_no_bag_is_told_in_a_sentence() {
    let folder = Folder::new();
    let error = || read(&[folder.0.path().to_owned()]).unwrap_err();
    assert!(error().contains("is a directory"), "{}", error());
    Connection::open(folder.path("other.db3")).unwrap().execute_batch("CREATE TABLE results(value)").unwrap();
    let other = read(&[folder.path("other.db3")]).unwrap_err();
    assert!(other.contains("other.db3` cannot be read as a rosbag2 database: it has no tables"), "{other}");
    fs::write(folder.path("bad.db3"), [&b"SQLite format 3\0"[..], &[7; 5000]].concat()).unwrap();
    let bad = read(&[folder.path("bad.db3")]).unwrap_err();
    assert!(bad.contains("bad.db3` cannot be read as a rosbag2 database"), "{bad}");
}
