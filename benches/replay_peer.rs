//! The programs that `benches/peers/replay/run.sh` sets beside `fric-cli replay`: a log made long, and the `mcap` crate alone.
//!
//! `replay_peer repeat LOG BYTES OUT`: LOG over and over, the times going on, until OUT has BYTES bytes.
//! `replay_peer copy LOG OUT THREADS`: all messages of LOG to OUT as the `mcap` crate's documentation shows, with its writer's own options
//! (chunks of 1 MiB, zstd at its standard level) and THREADS compression threads, `default` for the crate's own number. Prints
//! `messages`, and `seconds` without the reading of LOG into memory.

#![allow(clippy::unwrap_used, clippy::print_stdout, reason = "a benchmark that cannot start has nothing else to do")]

use std::borrow::Cow;
use std::fs::{self, File};
use std::io::BufWriter;
use std::time::Instant;

use mcap::{Message, MessageStream, WriteOptions, Writer};

const NANOS_PER_S: u64 = 1_000_000_000;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        ["repeat", log, bytes, out] => repeat(&fs::read(log).unwrap(), bytes.parse().unwrap(), out),
        ["copy", log, out, threads] => copy(&fs::read(log).unwrap(), out, threads.parse().ok()),
        _ => std::process::exit(2),
    }
}

fn copy(log: &[u8], out: &str, threads: Option<u32>) {
    let options = match threads {
        Some(threads) => WriteOptions::default().compression_threads(threads),
        None => WriteOptions::default(),
    };
    let start = Instant::now();
    let mut writer = options.create(BufWriter::new(File::create(out).unwrap())).unwrap();
    let mut message_count = 0_u64;
    for message in MessageStream::new(log).unwrap() {
        writer.write(&message.unwrap()).unwrap();
        message_count += 1;
    }
    writer.finish().unwrap();
    writer.into_inner().into_inner().unwrap().sync_all().unwrap();
    println!("messages {message_count}\nseconds {}", start.elapsed().as_secs_f64());
}

fn repeat(log: &[u8], bytes: u64, out: &str) {
    let messages: Vec<Message<'_>> = MessageStream::new(log).unwrap().map(Result::unwrap).collect();
    let first_nanos = messages.iter().map(|message| message.log_time).min().unwrap();
    let last_nanos = messages.iter().map(|message| message.log_time).max().unwrap();
    // What follows comes as long after the end as any two messages follow one another.
    let times = messages.iter().map(|message| message.log_time);
    let interval_nanos = times.filter(|time| *time > first_nanos).min().unwrap() - first_nanos;
    let period_nanos = last_nanos - first_nanos + interval_nanos;
    let mut writer = Writer::new(BufWriter::new(File::create(out).unwrap())).unwrap();
    let mut shift_nanos = 0;
    while fs::metadata(out).unwrap().len() < bytes {
        for message in &messages {
            let log_time = message.log_time + shift_nanos;
            let publish_time = message.publish_time + shift_nanos;
            let data = Cow::from(shifted(&message.data, shift_nanos));
            writer.write(&Message { log_time, publish_time, data, ..message.clone() }).unwrap();
        }
        shift_nanos += period_nanos;
        writer.flush().unwrap();
    }
    writer.finish().unwrap();
}

/// A message in little-endian CDR that begins with a header, its stamp later.
fn shifted(data: &[u8], shift_nanos: u64) -> Vec<u8> {
    assert_eq!(data.first_chunk(), Some(&[0, 1, 0, 0]), "little-endian CDR");
    let word = |at: usize| u64::from(u32::from_le_bytes(data[at..at + 4].try_into().unwrap()));
    let stamp_nanos = word(4) * NANOS_PER_S + word(8) + shift_nanos;
    let mut shifted = data.to_vec();
    shifted[4..8].copy_from_slice(&u32::try_from(stamp_nanos / NANOS_PER_S).unwrap().to_le_bytes());
    shifted[8..12].copy_from_slice(&u32::try_from(stamp_nanos % NANOS_PER_S).unwrap().to_le_bytes());
    shifted
}
