//! One SQLite file of a bag: its topics, and its messages in the order of time.
//!
//! The messages' times are read some thousands at a time, in the order of the recorder's index; the messages themselves are read one by one. If the
//! index or a page of the file is damaged, the table is read in the order of writing, skipping unreadable parts.

use std::collections::VecDeque;
use std::path::{Path, PathBuf};
use std::{fs, io};

use rusqlite::limits::Limit;
use rusqlite::{Connection, OpenFlags, OptionalExtension as _, Row};
use tempfile::{NamedTempFile, TempDir};

/// Greatest size of a message, bytes.
const MOST_BYTES: i32 = 128 << 20;
/// Number of times read at once.
const PAGE_LEN: u32 = 4096;
/// Maximum number of skips over unreadable rows, each twice as long as the one before.
const MOST_STEPS: u32 = 24;

/// Time and number of a message.
type Key = (i64, i64);

/// A topic as stored in the database.
#[derive(Debug, Clone)]
pub(super) struct StoredTopic {
    pub id: i64,
    pub name: String,
    pub type_name: String,
    pub encoding: String,
    /// Language of its definition, such as `ros2msg`, and the text; empty if the recorder stored none.
    pub definition: (String, String),
}

/// The order in which messages are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Order {
    Time,
    Number,
}

/// A temporary copy of a file.
#[derive(Debug)]
pub(super) enum TemporaryCopy {
    /// The decompressed file.
    Decompressed(NamedTempFile),
    /// The file and the writes beside it, into which SQLite writes as it reads them.
    WithWrites(TempDir),
}

/// Name of a copied file, and the ending of the file with its last writes.
const DATABASE: &str = "database";
const WRITES: &str = "-wal";

impl TemporaryCopy {
    /// Copies a file whose last writes are in a file beside it, as a recorder that was killed leaves them; `None` if there are none.
    pub fn with_writes(path: &Path) -> io::Result<Option<Self>> {
        let mut writes = path.as_os_str().to_owned();
        writes.push(WRITES);
        if !fs::metadata(&writes).is_ok_and(|writes| writes.len() > 0) {
            return Ok(None);
        }
        let folder = tempfile::tempdir()?;
        fs::copy(path, folder.path().join(DATABASE))?;
        fs::copy(writes, folder.path().join(DATABASE.to_owned() + WRITES))?;
        Ok(Some(Self::WithWrites(folder)))
    }
}

/// A file with messages.
#[derive(Debug)]
pub(super) struct Database {
    /// Path in the bag, compressed or not.
    pub path: PathBuf,
    pub len: u64,
    connection: Connection,
    /// The temporary copy that is read in place of the file, and kept meanwhile.
    _copy: Option<TemporaryCopy>,
    order: Order,
    keys: VecDeque<Key>,
    /// The last message read in the order of time, and the last number tried in the other order.
    last: Key,
    last_number: i64,
    greatest_number: i64,
    first_nanos: Option<i64>,
    pub lost_count: u64,
    /// SQLite's message about the first unreadable row.
    pub problem: Option<String>,
}

impl Database {
    /// Opens a file, or a copy of it.
    pub fn open(path: &Path, len: u64, copy: Option<TemporaryCopy>) -> rusqlite::Result<Self> {
        let connection = match &copy {
            None => connect(path),
            Some(TemporaryCopy::Decompressed(file)) => connect(file.path()),
            Some(TemporaryCopy::WithWrites(folder)) => Connection::open(folder.path().join(DATABASE)),
        }?;
        // A value that the file does not hold but lets SQLite compute may have any size.
        connection.set_limit(Limit::SQLITE_LIMIT_LENGTH, MOST_BYTES)?;
        // A file that is shorter than its header states is read as far as possible.
        connection.pragma_update(None, "writable_schema", true)?;
        let mut database = Self {
            path: path.to_owned(),
            len,
            connection,
            _copy: copy,
            order: Order::Time,
            keys: VecDeque::new(),
            last: (i64::MIN, i64::MIN),
            last_number: i64::MIN,
            greatest_number: 0,
            first_nanos: None,
            lost_count: 0,
            problem: None,
        };
        let number = |sql: &str| database.connection.query_row(sql, [], |row| row.get::<_, Option<i64>>(0));
        let has_table =
            number("SELECT count(*) FROM sqlite_master WHERE type = 'table' AND name IN ('topics', 'messages')")?;
        if has_table != Some(2) {
            return Err(rusqlite::Error::QueryReturnedNoRows);
        }
        let has_index = number("SELECT count(*) FROM sqlite_master WHERE type = 'index' AND tbl_name = 'messages'");
        let (first, greatest) = (number("SELECT min(timestamp) FROM messages"), number("SELECT max(id) FROM messages"));
        if has_index.ok().flatten().unwrap_or(0) == 0 {
            database.order = Order::Number;
        }
        database.first_nanos = first.ok().flatten();
        database.greatest_number = greatest.ok().flatten().unwrap_or(0);
        Ok(database)
    }

    /// Returns the time of the first message; the greatest value if it is unknown.
    pub fn first_nanos(&self) -> i64 {
        self.first_nanos.unwrap_or(i64::MAX)
    }

    /// Returns the readable topics.
    pub fn topics(&self) -> rusqlite::Result<Vec<StoredTopic>> {
        let definition = |type_name: &str| {
            let sql = "SELECT encoding, encoded_message_definition FROM message_definitions WHERE topic_type = ?1";
            // Older recorders have no such table.
            let found = self.connection.query_row(sql, [type_name], |row| Ok((row.get(0)?, row.get(1)?)));
            found.optional().ok().flatten().unwrap_or_default()
        };
        let mut statement =
            self.connection.prepare("SELECT id, name, type, serialization_format FROM topics ORDER BY id")?;
        let topic = |row: &Row<'_>| -> rusqlite::Result<StoredTopic> {
            let type_name: String = row.get(2)?;
            let definition = definition(&type_name);
            Ok(StoredTopic { id: row.get(0)?, name: row.get(1)?, type_name, encoding: row.get(3)?, definition })
        };
        statement.query_map([], topic)?.collect()
    }

    /// Reads the next message into `data`. Returns its time and the number of its topic, `None` at the end.
    pub fn next(&mut self, data: &mut Vec<u8>) -> Option<(i64, i64)> {
        loop {
            let Some((stamp_nanos, number)) = self.keys.pop_front() else {
                if self.read_keys() {
                    continue;
                }
                return None;
            };
            if self.order == Order::Time {
                self.last = (stamp_nanos, number);
            }
            match self.read(number, data) {
                Ok(topic) => return Some((stamp_nanos, topic)),
                Err(error) => {
                    self.lost_count += 1;
                    self.note(&error);
                }
            }
        }
    }

    /// Returns the fraction of the messages read so far.
    #[expect(clippy::cast_precision_loss, reason = "a share")]
    pub fn progress_ratio(&self) -> f64 {
        let number = if self.order == Order::Time { self.last.1 } else { self.last_number };
        (number as f64 / self.greatest_number.max(1) as f64).clamp(0.0, 1.0)
    }

    fn note(&mut self, error: &rusqlite::Error) {
        self.problem.get_or_insert_with(|| error.to_string());
    }

    fn read(&self, number: i64, data: &mut Vec<u8>) -> rusqlite::Result<i64> {
        let mut statement = self.connection.prepare_cached("SELECT topic_id, data FROM messages WHERE id = ?1")?;
        statement.query_row([number], |row| {
            let blob = row.get_ref(1)?.as_bytes_or_null().map_err(rusqlite::Error::from)?;
            data.clear();
            data.extend_from_slice(blob.unwrap_or_default());
            row.get(0)
        })
    }

    /// Reads times and numbers of messages. Returns whether there may be more.
    fn read_keys(&mut self) -> bool {
        if self.order == Order::Time {
            let sql = "SELECT timestamp, id FROM messages WHERE timestamp >= ?1 AND (timestamp > ?1 OR id > ?2) \
                       ORDER BY timestamp, id LIMIT ?3";
            let (keys, problem) = self.select(sql, self.last.0, self.last.1);
            self.keys = keys;
            if let Some(error) = problem {
                self.note(&error);
                self.order = Order::Number;
                // The rest in the order of time may be incomplete.
                self.keys.clear();
            }
            return self.order == Order::Number || !self.keys.is_empty();
        }
        let sql = "SELECT timestamp, id FROM messages WHERE id > ?1 AND ?2 = ?2 ORDER BY id LIMIT ?3";
        let mut step = 1_i64;
        for _ in 0..MOST_STEPS {
            let (keys, problem) = self.select(sql, self.last_number, 0);
            let newest = keys.back().map(|key| key.1);
            let last = self.last;
            self.keys = keys.into_iter().filter(|key| *key > last).collect();
            if let Some(newest) = newest {
                self.last_number = newest;
                return true;
            }
            let Some(error) = problem else { return false };
            self.note(&error);
            self.last_number = self.last_number.max(0).saturating_add(step);
            step *= 2;
        }
        false
    }

    /// Returns the keys as far as they can be read, and the error of the next one.
    fn select(&self, sql: &str, one: i64, other: i64) -> (VecDeque<Key>, Option<rusqlite::Error>) {
        let mut keys = VecDeque::new();
        let mut read = || -> rusqlite::Result<()> {
            let mut statement = self.connection.prepare_cached(sql)?;
            let mut rows = statement.query((one, other, PAGE_LEN))?;
            while let Some(row) = rows.next()? {
                keys.push_back((row.get(0)?, row.get(1)?));
            }
            Ok(())
        };
        let problem = read().err();
        (keys, problem)
    }
}

/// Opens a database without writing anything beside it.
fn connect(path: &Path) -> rusqlite::Result<Connection> {
    let flags = OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX;
    let Some(text) = path.to_str() else { return Connection::open_with_flags(path, flags) };
    let mut address = String::from("file:");
    for character in text.chars() {
        match character {
            '%' => address.push_str("%25"),
            '?' => address.push_str("%3f"),
            '#' => address.push_str("%23"),
            other => address.push(other),
        }
    }
    Connection::open_with_flags(address + "?immutable=1", flags | OpenFlags::SQLITE_OPEN_URI)
}
