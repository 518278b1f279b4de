//! Logs that are cut off or have wrong bytes: used as far as they go, and never silently wrong.

use mcap::read::{ChunkReader, LinearReader};
use mcap::records::{Record, op};

use super::cdr::{JointState, joint_state, wrench};
use super::logs::{Storage, on_topic, rewrite};
use super::support::{Place, Random, Run, example_robot, short_log, unwrapped};

const STORAGES: [Storage; 3] = [Storage::Zstd, Storage::Plain, Storage::Unchunked];
const CUTS: usize = 20;
const FLIPS: usize = 20;
/// Header of a chunk record in an uncompressed file, up to the records in it.
const PLAIN_CHUNK_HEADER: usize = 9 + 40;

/// The cables' channel in the logs stored here: the first.
const CABLES: u16 = 1;

/// Replays a log; gives the output, if there is one.
fn replay(log: &[u8]) -> (Run, Option<Vec<u8>>, usize) {
    let place = Place::empty();
    place.write("log.mcap", log);
    let run = place.run(&["replay", "log.mcap", "-o", "out.mcap", "--json", "j.json"]);
    if run.code == Some(0) {
        assert!(run.stderr.lines().all(|line| line.starts_with("warning: ")), "{run:#?}");
        assert_eq!(place.names(), ["j.json", "log.mcap", "out.mcap"]);
        let count = place.json("j.json")["cycle"]["count"].as_u64().unwrap();
        return (run, Some(place.read("out.mcap")), usize::try_from(count).unwrap());
    }
    assert_eq!(place.names(), ["log.mcap"], "{run:#?}");
    (run.fails(1, &[]), None, 0)
}

/// How many records are messages of the cables.
fn count_cables<'a>(records: impl Iterator<Item = mcap::McapResult<Record<'a>>>) -> usize {
    let records = records.map_while(Result::ok);
    records.filter(|record| matches!(record, Record::Message { header, .. } if header.channel_id == CABLES)).count()
}

/// End of the last complete record.
fn end_of_records(bytes: &[u8]) -> usize {
    let mut at = mcap::MAGIC.len();
    while let Some(header) = bytes.get(at..at + 9) {
        let length = u64::from_le_bytes(header[1..].try_into().unwrap());
        let end = at + 9 + usize::try_from(length).unwrap();
        if end > bytes.len() {
            break;
        }
        at = end;
    }
    at
}

/// How many cable messages are complete in a log cut off, and whether a compressed chunk at the cut may have more.
fn complete(bytes: &[u8], storage: Storage) -> (usize, bool) {
    let whole = mcap::MAGIC.len().min(bytes.len());
    let end = end_of_records(bytes).max(whole).min(bytes.len());
    let all = || LinearReader::sans_magic(&bytes[whole..end]);
    let mut count = count_cables(all());
    for record in all().map_while(Result::ok) {
        if let Record::Chunk { header, data } = record {
            count += count_cables(ChunkReader::new(header, &data).unwrap());
        }
    }
    let is_in_chunk = bytes.get(end) == Some(&op::CHUNK);
    if is_in_chunk && storage == Storage::Plain {
        let content = bytes.get(end + PLAIN_CHUNK_HEADER..).unwrap_or_default();
        count += count_cables(LinearReader::sans_magic(content));
    }
    (count, is_in_chunk && storage == Storage::Zstd)
}

fn stored(storage: Storage) -> Vec<u8> {
    rewrite(short_log(), storage, Some(&example_robot()), |_, _| true)
}

fn forces(output: &[u8]) -> Vec<JointState> {
    on_topic(output, "/fric/cable_forces", joint_state)
}

#[test]
fn a_log_cut_off_is_used_up_to_the_cut() {
    let mut random = Random(11);
    for storage in STORAGES {
        let log = stored(storage);
        assert_eq!(mcap::Summary::read(&log).unwrap().unwrap().channels[&CABLES].topic, "/cable_states");
        let (_, whole, _) = replay(&log);
        let whole = forces(&whole.unwrap());
        let robot_end = 200 + example_robot().len();
        let mut cuts: Vec<usize> = (0..CUTS).map(|_| random.below(log.len())).collect();
        // Within the magic bytes, within the robot file, just behind it, just before the end.
        cuts.extend([1, 8, 9, 1000, robot_end, log.len() - 1, log.len() - 9]);
        for cut in cuts {
            let label = format!("{storage:?} cut at {cut} of {}", log.len());
            let (run, output, count) = replay(&log[..cut]);
            let (expected, may_have_more) = complete(&log[..cut], storage);
            let Some(output) = output else {
                assert!(expected == 0 || cut < robot_end, "{label}: {run:#?}");
                continue;
            };
            assert!(run.stderr.contains("warning: `log.mcap` is cut off"), "{label}: {run:#?}");
            assert!(count == expected || may_have_more && count > expected, "{label}: {count} of {expected}");
            // Past the last pose the wrap is not known; up to there nothing may differ.
            let last_pose = on_topic(&output, "/fric/wrench", wrench).last().map_or(0, |(stamp, _)| *stamp);
            let found = forces(&output);
            assert_eq!(found.len(), count, "{label}");
            for (found, whole) in found.iter().zip(&whole) {
                assert_eq!(found.stamp_nanos, whole.stamp_nanos, "{label}");
                assert!(found.stamp_nanos > last_pose || found == whole, "{label}: {found:?} is not {whole:?}");
            }
        }
    }
}

#[test]
fn a_wrong_byte_is_told_or_does_not_matter() {
    let mut random = Random(12);
    for storage in STORAGES {
        let log = stored(storage);
        let (run, whole, _) = replay(&log);
        let (_, whole) = (run.succeeds(), whole.unwrap());
        for _ in 0..FLIPS {
            let (at, bit) = (random.below(log.len()), random.below(8));
            let mut damaged = log.clone();
            damaged[at] ^= 1 << bit;
            let (run, output, count) = replay(&damaged);
            let label = format!("{storage:?}, bit {bit} of byte {at}");
            match output {
                Some(output) if run.stderr.is_empty() => assert!(output == whole, "{label}: silently wrong, {count}"),
                Some(_) => assert!(run.stderr.contains("`log.mcap`"), "{label}: {run:#?}"),
                None => assert!(run.stderr.lines().count() <= 3, "{label}: {run:#?}"),
            }
        }
    }
}

#[test]
fn a_damaged_robot_file_is_not_trusted() {
    let mut log = stored(Storage::Zstd);
    let at = log.windows(10).position(|window| window == b"mu = 0.016").unwrap();
    log[at + 9] = b'7';
    let place = Place::with_log();
    place.write("damaged.mcap", &log);
    let arguments = ["replay", "damaged.mcap", "-o", "out.mcap"];
    let run = place.run_in_vain(&arguments).fails(1, &["attachment `fric-robot.toml`", "damaged"]);
    run.advises(&["--model"]);
    let named = place.run(&["replay", "damaged.mcap", "--model", "robot.toml", "-o", "out.mcap"]);
    assert_eq!(named.code, Some(0), "{named:#?}");
}

#[test]
fn a_tail_says_that_its_beginning_is_missing() {
    for storage in STORAGES {
        let log = stored(storage);
        let place = Place::with_log();
        place.write("tail.mcap", &log[log.len() / 2..log.len() / 4 * 3]);
        let arguments = ["replay", "tail.mcap", "--model", "robot.toml", "-o", "out.mcap"];
        let run = place.run_in_vain(&arguments).fails(1, &["beginning of `tail.mcap`", "channels", "schemas"]);
        run.advises(&["a complete copy"]);
        let info = place.run_in_vain(&["info", "tail.mcap", "--model", "robot.toml"]);
        assert!(unwrapped(&info.stdout).contains("impossible the beginning of `tail.mcap` is missing"), "{info:#?}");
    }
}
